//! A motion that makes parameters identifiable: Fourier series of all joints within their limits,
//! chosen by what they are expected to tell (`swevers1997`).
//!
//! | module | what it holds |
//! | --- | --- |
//! | `unknowns` | what is asked for, by name, and what is unknown beside it |
//! | `limits` | what joints and drives may do |
//! | `channels` | what moves, and what will be measured |
//! | `model`, `runs` | derivatives of the outputs along a motion: by inverse dynamics, or by runs |
//! | `parameters` | unknowns that some motion tells apart |
//! | `information` | standard errors and criteria |
//! | `design`, `search` | by what a motion is judged, and the search among motions |
//! | `report` | what is expected of the motion |

mod channels;
mod design;
mod information;
mod limits;
mod model;
mod parameters;
mod report;
mod runs;
mod search;
mod separation;
mod unknowns;

use truecut_plan::motion::excitation::{JointSeries, SampledMotion, SeriesForm, SeriesSpace};
use truecut_recording::{ChannelSpec, Measured};
use truecut_scenario::{ReplayMode, Scenario};
use truecut_sim::SimError;

use self::channels::mode;
use self::design::Design;
use self::limits::Limits;
use self::model::Model;
use self::parameters::Parameters;
pub use self::report::{
    AssumedNoise, Condition, ExciteReport, ExpectedError, JointUse, Separation,
};
pub use self::unknowns::ASKED;
use self::unknowns::Unknowns;
use crate::diagnose::Diagnosis;

/// What is asked.
pub struct Request<'a> {
    /// A scenario that replays motions of joints, with its `excite`.
    pub scenario: &'a Scenario,
    /// Its explanations are to be told apart.
    pub diagnosis: Option<&'a Diagnosis>,
    /// Data at hand, to be compared with.
    pub present: Option<&'a Measured>,
}

/// A planned motion.
#[derive(Debug, Clone)]
pub struct Excitation {
    /// What is expected of it.
    pub report: ExciteReport,
    /// Series of all joints.
    pub series: Vec<JointSeries>,
    /// Times of the samples, s.
    pub time_s: Vec<f64>,
    /// All joints at these times.
    pub motion: SampledMotion,
    /// Channels that drive the replay, with their joints.
    pub inputs: Vec<(usize, ChannelSpec)>,
    /// Outputs with their noise and what the scenario predicts of them.
    pub outputs: Vec<(ChannelSpec, Option<f64>, Vec<f64>)>,
    /// Whether each joint is rotary.
    pub rotary: Vec<bool>,
}

/// Random motions that the planned one is held against.
const RANDOM_MOTIONS: usize = 8;
/// Least samples of a period of the highest harmonic.
const LEAST_A_WAVE: f64 = 10.0;

/// Plans a motion. `progress` is told the part done, 0 to 1.
///
/// # Errors
/// Whatever makes the scenario unfit; a limit that is missing; a parameter that no motion shows; a
/// motion too short.
pub fn excite(
    request: &Request<'_>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Excitation, SimError> {
    let scenario = request.scenario;
    let asked = scenario.excite.asked.as_deref();
    mode(scenario)?;
    let unknowns = match request.diagnosis {
        Some(diagnosis) => Unknowns::of_diagnosis(scenario, diagnosis)?,
        None => Unknowns::of(scenario, asked)?,
    };
    let limits = Limits::new(scenario)?;
    let form = form(scenario)?;
    let time_s = times(scenario);
    let space = SeriesSpace::new(form, limits.ranges.clone(), &time_s);
    let random = random_motions(scenario, &limits, &space)?;
    let model = Model::new(scenario, &limits.arm, unknowns, &random[0].1, &time_s)?;
    let design = Design::new(scenario, &limits, model, form, &random, &time_s)?;
    let numbers = design.search(&random, progress)?;
    design.answer(request, &space, numbers, time_s)
}

/// What a planned motion could do for the explanations of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outlook {
    /// No motions are planned for such a scenario.
    NotPlanned,
    /// Some motion may tell them apart.
    MayTell,
    /// They change the outputs alike in every state of the arm, or not at all.
    CannotTell,
}

/// Whether to plan a motion for the explanations of a diagnosis. Of runs all is thought to show: to
/// know better takes the runs.
pub fn outlook(scenario: &Scenario, diagnosis: &Diagnosis) -> Outlook {
    match mode(scenario) {
        Err(_) => Outlook::NotPlanned,
        Ok(ReplayMode::Inverse { .. }) => match in_any_state(scenario, diagnosis) {
            Ok(model) if Parameters::new(&model).is_err() => Outlook::CannotTell,
            // What else stands against a motion is told by who plans it.
            Ok(_) | Err(_) => Outlook::MayTell,
        },
        Ok(ReplayMode::Forward | ReplayMode::Observe) => Outlook::MayTell,
    }
}

fn in_any_state(scenario: &Scenario, diagnosis: &Diagnosis) -> Result<Model, SimError> {
    let unknowns = Unknowns::of_diagnosis(scenario, diagnosis)?;
    let limits = Limits::new(scenario)?;
    let time_s = times(scenario);
    let space = SeriesSpace::new(form(scenario)?, limits.ranges.clone(), &time_s);
    let random = random_motions(scenario, &limits, &space)?;
    Model::new(scenario, &limits.arm, unknowns, &random[0].1, &time_s)
}

/// Numbers and motion.
type Random = (Vec<f64>, SampledMotion);

/// Random motions that the drives can follow, each joint using as much of its limits as possible.
fn random_motions(
    scenario: &Scenario,
    limits: &Limits,
    space: &SeriesSpace,
) -> Result<Vec<Random>, SimError> {
    let mut held = f64::INFINITY;
    let mut found = Vec::new();
    // Where gravity alone is too much in some postures, others are drawn.
    for index in 0..20 * RANDOM_MOTIONS {
        let mut numbers = search::drawn(space.dimension(), scenario.excite.seed, index);
        for own in numbers.chunks_mut(space.dimension() / limits.ranges.len()) {
            let size = own.len() - 2;
            own[size] = f64::INFINITY;
        }
        match limits.within(space, space.series(&numbers)) {
            Ok((_, motion)) => {
                // Where the search starts, it may use less and more.
                numbers
                    .iter_mut()
                    .filter(|x| x.is_infinite())
                    .for_each(|x| *x = 2.0);
                found.push((numbers, motion));
            }
            Err(effort) => held = held.min(effort),
        }
        if found.len() == RANDOM_MOTIONS {
            return Ok(found);
        }
    }
    let message = format!(
        "the drives cannot hold the arm in the middle of random motions: they need {held:.2} times what they may give at least"
    );
    Err(SimError::scenario("excite.joint", message))
}

fn form(scenario: &Scenario) -> Result<SeriesForm, SimError> {
    let spec = &scenario.excite;
    let form = SeriesForm {
        duration_s: spec.duration_s,
        periods: spec.periods,
        harmonics: spec.harmonics,
    };
    let highest_hz = form.highest_hz();
    let mut most_hz = spec.rate_hz / LEAST_A_WAVE;
    let mut why = format!(
        "{LEAST_A_WAVE} samples of a wave at excite.rate_hz = {}",
        spec.rate_hz
    );
    if let ReplayMode::Inverse {
        compare_cutoff_hz, ..
    } = mode(scenario)?
        && compare_cutoff_hz < most_hz
    {
        most_hz = compare_cutoff_hz;
        why = "process.replay.compare_cutoff_hz, beyond which nothing is compared".to_owned();
    }
    if highest_hz > most_hz {
        let message = format!(
            "`excite.duration_s` is {} s: {} harmonics of {} periods in it reach {highest_hz:.3} Hz, but at most {most_hz:.3} Hz are of use ({why}): \
             take longer, or fewer harmonics or periods",
            spec.duration_s, spec.harmonics, spec.periods
        );
        return Err(SimError::scenario("excite.duration_s", message));
    }
    Ok(form)
}

/// Times of the samples of the whole motion, its end with them.
fn times(scenario: &Scenario) -> Vec<f64> {
    let spec = &scenario.excite;
    let count = (spec.duration_s * spec.rate_hz).round().max(1.0) as usize;
    (0..=count)
        .map(|k| spec.duration_s * k as f64 / count as f64)
        .collect()
}
