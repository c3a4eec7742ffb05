//! Residuals so large that the unit must be wrong.

use thiserror::Error;
use truecut_recording::significant;

use super::series::{Pair, centred, rms};

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

/// Looks for a factor (powers of ten, degrees, turns, rpm, standard gravity, inches, pounds, the
/// sign) that removes most of such a residual.
pub fn unit_suspicion(pair: &Pair<'_>) -> Option<UnitSuspicion> {
    let measured = centred(pair.measured, pair.valid);
    let simulated = centred(pair.simulated, pair.valid);
    let [size_measured, size_simulated] = [&measured, &simulated].map(|x| rms(x, pair.valid));
    if [size_measured, size_simulated]
        .iter()
        .any(|size| size.is_nan() || *size <= 0.0)
    {
        return None;
    }
    let error = |factor: f64| {
        let apart: Vec<f64> = measured
            .iter()
            .zip(&simulated)
            .map(|(m, s)| factor * m - s)
            .collect();
        rms(&apart, pair.valid) / (factor.abs() * size_measured).max(size_simulated)
    };
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
    (best.error_with_factor < (FAR_BETTER * now).min(FITTING)).then_some(best)
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
