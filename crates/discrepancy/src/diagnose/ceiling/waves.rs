//! Waves of the residual over a place: cogging, teeth, the turns of a screw.

use std::f64::consts::TAU;

use rayon::prelude::*;
use truecut_recording::{Unit, fft, significant};
use truecut_scenario::effect::Target as On;

use super::Target;
use crate::diagnose::data::Observation;
use crate::diagnose::features::Group;
use crate::diagnose::moments::explained;
use crate::diagnose::noise::dot;
use crate::diagnose::problem::Problem;
use crate::model::Columns;
use crate::stats::{centred, mean};

/// Parts of a signal's range on which the residual is gathered, and the length of their transform.
const PARTS: usize = 2048;
const LENGTH: usize = 4 * PARTS;
/// Periods over the range: fewer are bins and half waves.
const FEWEST: f64 = 1.5;
/// Periods that pass by between two samples at most, in the mean.
const PER_SAMPLE: f64 = 0.35;
/// The background of a wave is what is around it within this factor.
const AROUND: f64 = 1.5;
/// Sections by which the best fit is found about a peak.
const SECTIONS: usize = 8;

impl Target<'_> {
    /// For each known signal the strongest wave of the residual over it, and the strongest that
    /// turns its sign with the direction.
    pub(super) fn waves(&self, predicted: &Columns) -> Vec<Group> {
        let data = self.problem.data;
        let places = places(self.problem, predicted);
        let left: Vec<f64> = self.rows.iter().map(|&t| self.residual[t]).collect();
        let tried: Vec<(&Place, bool)> = (places.iter())
            .flat_map(|place| [false, true].map(|with_direction| (place, with_direction)))
            .collect();
        let found = tried.par_iter().filter_map(|(place, with_direction)| {
            let (_, waves) = place.best_wave(data, self.rows, &left, *with_direction)?;
            let direction = if *with_direction {
                " and its direction"
            } else {
                ""
            };
            let period = significant(1.0 / waves, 3);
            Some(Group {
                chosen: 1,
                ..Group::of_signal(
                    format!(
                        "a wave over {}{direction}, a period each {period} {}",
                        place.name, place.unit
                    ),
                    place.features(data, waves, *with_direction),
                )
            })
        });
        found.collect()
    }
}

/// The place within a width of one at which a function is greatest, and its value: by so many
/// sections of a third.
pub(super) fn refined(
    middle: f64,
    width: f64,
    sections: usize,
    value: &impl Fn(f64) -> f64,
) -> (f64, f64) {
    let (mut low, mut high) = (middle - width, middle + width);
    for _ in 0..sections {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if value(a) > value(b) {
            high = b;
        } else {
            low = a;
        }
    }
    let best = 0.5 * (low + high);
    (value(best), best)
}

/// The wave of a residual over a joint's place that explains most: which part of it, and how many
/// periods it has per unit.
pub(in crate::diagnose) fn wave_over(
    problem: &Problem,
    predicted: &Columns,
    joint: usize,
    residual: &[f64],
    rows: &[usize],
) -> Option<(f64, f64)> {
    let left: Vec<f64> = rows.iter().map(|&t| residual[t]).collect();
    let whole = dot(&left, &left);
    let own = format!("joint{}.", joint + 1);
    let places = places(problem, predicted);
    let found = (places.iter().filter(|place| place.name.starts_with(&own)))
        .filter_map(|place| place.best_wave(problem.data, rows, &left, false));
    let (gain, waves) = found.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (whole > 0.0).then(|| (gain / whole, waves))
}

/// A signal over which waves may lie, at all its samples: those of the data, or finer ones.
struct Place<'a> {
    name: &'a str,
    unit: Unit,
    values: &'a [f64],
    is_fine: bool,
}

fn places<'a>(problem: &'a Problem, predicted: &'a Columns) -> Vec<Place<'a>> {
    let data = problem.data;
    let is_place = |name: &str| {
        [".angle", ".position", ".command"]
            .iter()
            .any(|end| name.contains(end))
            && !name.starts_with("rate of")
    };
    let of = |name: &'a str, values: &'a [f64], is_fine| Place {
        name,
        unit: unit(problem, name),
        values,
        is_fine,
    };
    if let Some(fine) = &data.fine {
        let signals = fine.signals.iter();
        return signals
            .map(|one| of(&one.name, &one.values, true))
            .collect();
    }
    let known = data.regressors.iter().filter(|one| !one.is_angle);
    let known = known.map(|one| (one.name.as_str(), &one.values));
    let outputs = (problem.model.channels().iter()).map(|spec| spec.name.as_str());
    known
        .chain(outputs.zip(predicted))
        .filter(|(name, _)| is_place(name))
        .map(|(name, values)| of(name, values, false))
        .collect()
}

/// The unit of a place: that of the output, or of the joint's coordinate.
fn unit(problem: &Problem, name: &str) -> Unit {
    let mut outputs = problem.model.channels().iter();
    if let Some(spec) = outputs.find(|spec| spec.name == name) {
        return spec.unit;
    }
    let joint = |index: usize| name.starts_with(&format!("joint{}.", index + 1));
    let rotary = (problem.candidates.iter()).any(|one| match one.target {
        On::Joint(index) => one.rotary && joint(index),
        _ => false,
    });
    match rotary || name.ends_with(".angle") {
        true => Unit::Radian,
        false => Unit::Metre,
    }
}

impl Place<'_> {
    /// The wave that explains most of what is left at the rows: how much, and its periods per unit.
    fn best_wave(
        &self,
        data: &Observation,
        rows: &[usize],
        left: &[f64],
        with_direction: bool,
    ) -> Option<(f64, f64)> {
        let values = self.at_samples(data);
        let signed: Vec<f64> = match with_direction {
            true => {
                let signs = directions(&values);
                let rows = rows.iter().zip(left);
                rows.map(|(&t, r)| r * signs[t]).collect()
            }
            false => left.to_vec(),
        };
        let peaks = strongest(&values, rows, &centred(&signed))?;
        let explains = |waves: f64| {
            let features = self.features(data, waves, with_direction);
            let picked: Vec<Vec<f64>> = (features.iter())
                .map(|x| rows.iter().map(|&t| x[t]).collect())
                .collect();
            explained(left, &picked)
        };
        let refined = peaks
            .places
            .map(|peak| refined(peak, peaks.width, SECTIONS, &explains));
        refined.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))
    }

    fn at_samples(&self, data: &Observation) -> Vec<f64> {
        match (&data.fine, self.is_fine) {
            (Some(fine), true) => self.values.iter().step_by(fine.every).copied().collect(),
            _ => self.values.to_vec(),
        }
    }

    /// Cosine and sine, through the filter that the data have gone through.
    fn features(&self, data: &Observation, waves: f64, with_direction: bool) -> Vec<Vec<f64>> {
        let signs = match with_direction {
            true => directions(self.values),
            false => vec![1.0; self.values.len()],
        };
        let features = [f64::cos, f64::sin].map(|wave: fn(f64) -> f64| -> Vec<f64> {
            let pairs = self.values.iter().zip(&signs);
            let whole: Vec<f64> = pairs
                .map(|(x, sign)| sign * wave(TAU * waves * x))
                .collect();
            match (&data.fine, self.is_fine) {
                (Some(fine), true) => (fine.filter.zero_phase(&whole).into_iter())
                    .step_by(fine.every)
                    .collect(),
                _ => whole,
            }
        });
        features.into()
    }
}

fn directions(values: &[f64]) -> Vec<f64> {
    let last = values.len() - 1;
    let rate = |t: usize| values[(t + 1).min(last)] - values[t.saturating_sub(1)];
    (0..values.len()).map(|t| rate(t).signum()).collect()
}

/// Waves, in periods per unit of the signal.
struct Peaks {
    /// The strongest, and that which stands out most of those around it.
    places: [f64; 2],
    /// Half a period over the range.
    width: f64,
}

fn strongest(values: &[f64], rows: &[usize], left: &[f64]) -> Option<Peaks> {
    let picked: Vec<f64> = rows.iter().map(|&t| values[t]).collect();
    let low = picked.iter().copied().fold(f64::INFINITY, f64::min);
    let range = picked.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low;
    let moved: Vec<f64> = (rows.iter().filter(|&&t| t > 0))
        .map(|&t| (values[t] - values[t - 1]).abs())
        .collect();
    let most = (PER_SAMPLE * range / mean(&moved)).min(0.4 * PARTS as f64);
    if !(range > 0.0 && most > 2.0 * FEWEST) {
        return None;
    }
    let mut gathered = vec![0.0; PARTS + 1];
    for (x, r) in picked.iter().zip(left) {
        let place = (x - low) / range * (PARTS - 1) as f64;
        let part = place.floor() as usize;
        gathered[part] += r * (1.0 - place.fract());
        gathered[part + 1] += r * place.fract();
    }
    let parts_per_range = (PARTS - 1) as f64;
    let power: Vec<f64> = (fft::forward(gathered, LENGTH).iter())
        .map(|z| z.norm_sqr())
        .collect();
    let bin_of = |periods: f64| periods * LENGTH as f64 / parts_per_range;
    let first = bin_of(FEWEST).ceil() as usize;
    let last = (bin_of(most) as usize).min(power.len() - 1);
    let background = |k: usize| {
        let from = ((k as f64 / AROUND) as usize).max(1);
        let to = ((k as f64 * AROUND) as usize).min(power.len() - 1);
        let mut around = power[from..=to].to_vec();
        around.sort_by(f64::total_cmp);
        around[around.len() / 2]
    };
    let whole = dot(left, left);
    let best = (first..=last).max_by(|a, b| power[*a].total_cmp(&power[*b]))?;
    // The strongest of all may be the flank of something slow.
    let peaks = (first..=last).filter(|&k| power[k] >= 0.1 * power[best]);
    let ratios = peaks.map(|k| (power[k] / background(k).max(1e-12 * whole), k));
    let (_, peak) = ratios.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let per_unit = |k: usize| k as f64 * parts_per_range / (LENGTH as f64 * range);
    Some(Peaks {
        places: [per_unit(best), per_unit(peak)],
        width: 0.5 / range,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, noise};

    #[test]
    fn verify_waves_over_a_place_are_found_wherever_the_place_goes() {
        for seed in 0..30 {
            let per_rad = 3.0 + 0.4 * seed as f64;
            let place = |t: usize| {
                let turn = t as f64 * 0.02;
                turn.sin() + 0.6 * (1.7 * turn + seed as f64).sin()
            };
            let values: Vec<f64> = (0..1500).map(place).collect();
            let drawn = noise(Colour::Ar1(0.8), 1500, seed);
            let pairs = values.iter().zip(&drawn);
            let left: Vec<f64> = pairs
                .map(|(x, n)| (TAU * per_rad * x + 1.0).sin() + 0.5 * n)
                .collect();
            let rows: Vec<usize> = (10..1400).collect();
            let picked: Vec<f64> = rows.iter().map(|&t| left[t]).collect();
            let found = strongest(&values, &rows, &centred(&picked)).unwrap();
            for place in found.places {
                assert!((place - per_rad).abs() < found.width, "{place} {per_rad}");
            }
        }
    }
}
