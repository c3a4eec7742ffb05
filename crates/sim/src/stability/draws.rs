//! Arms and cuts drawn from what a scenario says is uncertain.

use rayon::prelude::*;
use sobol_burley::sample;
use truecut_plan::spread::{DRAWS, SETS, Variant};
use truecut_scenario::{Scenario, UncertainLaw, UncertainSpec};

use super::MillingStudy;
use crate::error::SimError;
use crate::robots::Robots;

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
        let laws: Vec<UncertainLaw> = (scenario.uncertain.iter().filter(acts))
            .map(|one| UncertainLaw::of(one, scenario.range(&one.key)))
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
    laws: &[UncertainLaw],
    (set, index): (usize, usize),
) -> Result<Variant, SimError> {
    let values: Vec<(&str, f64)> = (laws.iter().enumerate())
        .map(|(number, law)| {
            let (dimension, sequence) = (number % DIMENSIONS, set + SETS * (number / DIMENSIONS));
            let at = sample(index as u32, dimension as u32, sequence as u32);
            // The sequence has steps of 2⁻²⁴ and begins at 0: their middles.
            let middle = f64::from(at) + f64::from(f32::EPSILON) / 4.0;
            (law.key.as_str(), law.value_at(middle))
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
