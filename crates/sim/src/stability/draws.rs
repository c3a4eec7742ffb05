//! Arms and cuts drawn from what a scenario says is uncertain.

use rayon::prelude::*;
use sobol_burley::sample;
use statrs::distribution::{ContinuousCDF, Normal};
use truecut_plan::spread::{DRAWS, SETS, Variant};
use truecut_scenario::{Scenario, UncertainSpec};

use super::MillingStudy;
use crate::error::SimError;
use crate::robots::Robots;

/// Standard deviations at which values end on either side, as in a diagnosis.
const MOST_SIGMAS: f64 = 3.0;
/// Dimensions of a sequence; what is uncertain beyond them takes another.
const DIMENSIONS: usize = 256;

/// Arms and cuts as a scenario allows for.
#[derive(Debug, Clone)]
pub struct Draws {
    /// Keys of what is uncertain.
    pub keys: Vec<String>,
    /// Independent sets, each of which fills the space evenly.
    pub sets: Vec<Vec<Variant>>,
}

impl Draws {
    /// [`SETS`] sets of [`DRAWS`] of a milling scenario's `[[uncertain]]` values of robot and
    /// process, independent of each other and normal, but within three standard deviations and what
    /// the key may be: Sobol's sequence, scrambled after `burley2020`. `None` if nothing of them is
    /// uncertain.
    ///
    /// # Errors
    /// Values that cannot be together.
    pub fn of(scenario: &Scenario) -> Result<Option<Self>, SimError> {
        let acts =
            |one: &&UncertainSpec| one.key.starts_with("robot.") || one.key.starts_with("process.");
        let laws: Vec<Law> = (scenario.uncertain.iter().filter(acts))
            .map(|one| Law::of(one, scenario.range(&one.key)))
            .collect();
        if laws.is_empty() {
            return Ok(None);
        }
        let robots = Robots::new();
        let sets = (0..SETS).into_par_iter().map(|set| {
            let draws = (0..DRAWS).into_par_iter();
            let draws = draws.map(|index| variant(scenario, &robots, &laws, (set, index)));
            draws.collect::<Result<Vec<_>, _>>()
        });
        Ok(Some(Self {
            sets: sets.collect::<Result<_, _>>()?,
            keys: laws.into_iter().map(|law| law.key).collect(),
        }))
    }
}

fn variant(
    scenario: &Scenario,
    robots: &Robots,
    laws: &[Law],
    (set, index): (usize, usize),
) -> Result<Variant, SimError> {
    let values: Vec<(&str, f64)> = (laws.iter().enumerate())
        .map(|(number, law)| {
            let (dimension, sequence) = (number % DIMENSIONS, set + SETS * (number / DIMENSIONS));
            let at = sample(index as u32, dimension as u32, sequence as u32);
            (law.key.as_str(), law.value(f64::from(at)))
        })
        .collect();
    let refused = |error: SimError| {
        let written = values
            .iter()
            .map(|(key, value)| format!("{key} = {value:.6}"));
        let written = written.collect::<Vec<_>>().join(", ");
        let message = format!("`uncertain` allows for {written} (SI), but then {error}");
        SimError::scenario("uncertain", message)
    };
    let varied = scenario
        .with_values(&values)
        .map_err(|error| refused(error.into()))?;
    let study = MillingStudy::read(&varied, robots).map_err(refused)?;
    Ok(Variant {
        robot: study.robot,
        cut: study.cut,
    })
}

/// A normal distribution that ends on both sides.
struct Law {
    key: String,
    normal: Normal,
    /// Parts of the whole distribution below its ends.
    ends: [f64; 2],
}

impl Law {
    fn of(uncertain: &UncertainSpec, range: [f64; 2]) -> Self {
        let (middle, sigma) = (uncertain.value, uncertain.sigma);
        let normal = Normal::new(middle, sigma).unwrap_or_else(|_| Normal::standard());
        let reach = MOST_SIGMAS * sigma;
        let ends = [range[0].max(middle - reach), range[1].min(middle + reach)];
        Self {
            key: uncertain.key.clone(),
            ends: ends.map(|end| normal.cdf(end)),
            normal,
        }
    }

    /// The value below which a part, from 0 to below 1 in steps of 2⁻²⁴, of all lie.
    fn value(&self, part: f64) -> f64 {
        let middle = part + f64::from(f32::EPSILON) / 4.0;
        let [low, high] = self.ends;
        self.normal.inverse_cdf(low + (high - low) * middle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(value: f64, sigma: f64, range: [f64; 2]) -> Law {
        let key = "robot.stiffness_scale".to_owned();
        Law::of(&UncertainSpec { key, value, sigma }, range)
    }

    #[test]
    fn verify_quartiles_of_a_normal_spread() {
        let law = law(2.0, 0.1, [0.0, 1e18]);
        let quartile = 0.1 * 0.672_366;
        assert!((law.value(0.5) - 2.0).abs() < 1e-6);
        assert!(
            (law.value(0.75) - 2.0 - quartile).abs() < 1e-6,
            "{}",
            law.value(0.75)
        );
    }

    #[test]
    fn values_stay_within_three_deviations_and_their_range() {
        let last = 1.0 - f64::from(f32::EPSILON);
        let wide = law(1.0, 0.1, [0.0, 1e18]);
        assert!((wide.value(0.0) - 0.7).abs() < 1e-4 && (wide.value(last) - 1.3).abs() < 1e-4);
        let short = law(1.0, 0.6, [0.0, 1.5]);
        assert!(short.value(0.0) > 0.0 && short.value(last) < 1.5);
    }
}
