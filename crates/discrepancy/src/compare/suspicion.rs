//! Residuals so large that the unit must be wrong, or the column.

use thiserror::Error;
use truecut_recording::significant;

use super::series::{Pair, centred, rms};
use crate::stats::ratio;

/// A factor with which the measured channel would fit.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "measured and simulated differ by {} % of the larger, but by {} % if the measured values are \
     multiplied by {} ({meaning}); check its \
     unit and scale",
    significant(100.0 * error, 3),
    significant(100.0 * error_with_factor, 3),
    significant(*factor, 6)
)]
pub struct UnitSuspicion {
    /// Multiply the measured values by this.
    pub factor: f64,
    /// Meaning of the factor.
    pub meaning: String,
    /// Error as is, over the larger RMS of the two channels, without their means.
    pub error: f64,
    /// The same with the factor.
    pub error_with_factor: f64,
}

/// Above this error the channels are unrelated as they are.
const ABSURD: f64 = 0.6;
/// The factor must reduce the error to below this fraction of it, and below this value.
const FAR_BETTER: f64 = 0.4;
const FITTING: f64 = 0.5;
/// Where another factor leaves less than this part of what a unit's leaves, and that is more than a
/// machine that is not quite as it is modelled explains, the channel has that factor: a gain.
const AS_GOOD: f64 = 0.5;
const NOT_QUITE: f64 = 0.15;

/// Looks for a factor (powers of ten, degrees, turns, rpm, standard gravity, inches, pounds, the
/// sign) that removes most of such a residual.
pub fn unit_suspicion(pair: &Pair<'_>) -> Option<UnitSuspicion> {
    let sizes = Sizes::of(pair, pair.simulated)?;
    let error = |factor: f64| sizes.error(factor);
    let now = error(1.0);
    if now < ABSURD {
        return None;
    }
    let tried = factors()
        .into_iter()
        .map(|(factor, meaning)| UnitSuspicion {
            factor,
            meaning,
            error: now,
            error_with_factor: error(factor),
        });
    let best = tried.min_by(|a, b| a.error_with_factor.total_cmp(&b.error_with_factor))?;
    let is_unit = best.error_with_factor <= NOT_QUITE
        || AS_GOOD * best.error_with_factor <= error(sizes.likeliest());
    (is_unit && best.error_with_factor < (FAR_BETTER * now).min(FITTING)).then_some(best)
}

/// A measured and a simulated series without their means, both of some size.
struct Sizes<'a> {
    measured: Vec<f64>,
    simulated: Vec<f64>,
    valid: &'a [bool],
    rms: [f64; 2],
}

impl Sizes<'_> {
    fn of<'a>(pair: &Pair<'a>, simulated: &[f64]) -> Option<Sizes<'a>> {
        let [measured, simulated] =
            [pair.measured, simulated].map(|values| centred(values, pair.valid));
        let rms = [&measured, &simulated].map(|values| rms(values, pair.valid));
        let has_size = rms.iter().all(|size| *size > 0.0);
        has_size.then_some(Sizes {
            measured,
            simulated,
            valid: pair.valid,
            rms,
        })
    }

    /// The factor on the measured values that leaves least.
    fn likeliest(&self) -> f64 {
        let rows = self.measured.iter().zip(&self.simulated).zip(self.valid);
        let (mut both, mut own) = (0.0, 0.0);
        for ((m, s), _) in rows.filter(|(_, valid)| **valid) {
            both += m * s;
            own += m * m;
        }
        ratio(both, own)
    }

    /// What is left with a factor on the measured values, over the larger RMS of the two.
    fn error(&self, factor: f64) -> f64 {
        let rows = self.measured.iter().zip(&self.simulated);
        let apart: Vec<f64> = rows.map(|(m, s)| factor * m - s).collect();
        rms(&apart, self.valid) / (factor.abs() * self.rms[0]).max(self.rms[1])
    }
}

/// Measured channels of which each fits the simulation of another of them, and none its own.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "{}; look whether their columns are exchanged",
    moved.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
)]
pub struct Exchange {
    /// In a ring: each fits the simulation of the one after it, the last that of the first.
    pub moved: Vec<Moved>,
}

/// A measured channel that fits another's simulation.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "measured \"{channel}\" differs from the simulated by {} % of the larger, but from the simulated \
     \"{fits}\" by {} %",
    significant(100.0 * error, 3),
    significant(100.0 * error_of_fit, 3)
)]
pub struct Moved {
    /// The measured channel.
    pub channel: String,
    /// The simulated one that it fits.
    pub fits: String,
    /// Error to its own simulation, over the larger RMS of the two, without their means.
    pub error: f64,
    /// The same to the one that it fits.
    pub error_of_fit: f64,
}

/// Looks for channels of one unit that are each other's: all of a ring must be as far from their
/// own simulation, and as near to another's, as a unit is asked to be.
pub fn exchange(pairs: &[Pair<'_>]) -> Option<Exchange> {
    let fitting: Vec<Option<(usize, f64, f64)>> = (0..pairs.len())
        .map(|index| fits_another(pairs, index))
        .collect();
    (0..pairs.len()).find_map(|first| {
        let mut ring = vec![first];
        loop {
            let (next, ..) = fitting[*ring.last()?]?;
            if next == first {
                break;
            }
            // One that leads into another's ring is not part of it.
            if ring.contains(&next) {
                return None;
            }
            ring.push(next);
        }
        let name = |index: usize| pairs[index].spec.name.clone();
        let moved = ring.iter().filter_map(|index| {
            let (fits, error, error_of_fit) = fitting[*index]?;
            Some(Moved {
                channel: name(*index),
                fits: name(fits),
                error,
                error_of_fit,
            })
        });
        Some(Exchange {
            moved: moved.collect(),
        })
    })
}

/// The other channel whose simulation a measured one fits, with the errors to its own and to that.
fn fits_another(pairs: &[Pair<'_>], index: usize) -> Option<(usize, f64, f64)> {
    let pair = &pairs[index];
    let now = Sizes::of(pair, pair.simulated)?.error(1.0);
    if now < ABSURD {
        return None;
    }
    let others = pairs
        .iter()
        .enumerate()
        .filter(|(other, one)| *other != index && one.spec.unit == pair.spec.unit);
    let errors =
        others.filter_map(|(other, one)| Some((other, Sizes::of(pair, one.simulated)?.error(1.0))));
    let (other, error) = errors.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (error < (FAR_BETTER * now).min(FITTING)).then_some((other, now, error))
}

fn factors() -> Vec<(f64, String)> {
    let turn = std::f64::consts::TAU;
    let named = [
        (
            turn / 360.0,
            "degrees taken for radians",
            "radians taken for degrees",
        ),
        (turn / 60.0, "rpm taken for rad/s", "rad/s taken for rpm"),
        (
            turn,
            "turns taken for radians, or Hz for rad/s",
            "radians taken for turns, or rad/s for Hz",
        ),
        (
            9.806_65,
            "kilograms of force taken for newtons",
            "newtons taken for kilograms of force",
        ),
        (
            25.4,
            "inches taken for millimetres",
            "millimetres taken for inches",
        ),
        (0.0254, "inches taken for metres", "metres taken for inches"),
        (
            4.448_222,
            "pounds of force taken for newtons",
            "newtons taken for pounds of force",
        ),
    ];
    let mut factors = vec![(-1.0, "the sign is reversed".to_owned())];
    for (factor, taken, reverse) in named {
        factors.push((factor, taken.to_owned()));
        factors.push((1.0 / factor, reverse.to_owned()));
    }
    for power in (-9..=9).filter(|power| *power != 0) {
        let factor = 10_f64.powi(power);
        factors.push((factor, format!("a power of ten: 1e{power}")));
    }
    factors
}
