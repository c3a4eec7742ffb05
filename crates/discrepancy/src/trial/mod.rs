//! A scenario and its measured data as a [`Model`]: what the diagnosis simulates.
//!
//! Predictions come from the reduced plant, which is fast; [`Trial::confirm`] makes the same
//! prediction in rapier. Scenarios that replay measured motion backwards (mode "inverse") integrate
//! nothing and need neither.

mod begin;
mod bounds;
pub(crate) mod cache;
mod candidates;
mod clock;
pub(crate) mod curves;
mod experiments;
mod jumps;
mod length;
mod modes;
pub(crate) mod noise;
mod observation;
pub(crate) mod parallel;
mod predict;
pub(crate) mod sampling;
mod set_ups;
mod signals;
mod speeds;
mod steps;
mod stiff;
#[cfg(test)]
pub(crate) mod tests;
mod zeros;

use truecut_recording::ChannelSpec;
use truecut_recording::measured::Measured;
use truecut_scenario::effect::{Effect, ParameterInfo, Target};
use truecut_scenario::{ProcessSpec, ReplayMode, RobotSpec, Scenario, UncertainSpec};
use truecut_sim::facts::{RobotFacts, robot_facts};
use truecut_sim::found_start;
use truecut_sim::run::{self, Engine, Rows, StepsPerPeriod};
use truecut_sim::{Forces, InverseModel, Robots, SimError, SteadyModel, estimates};

pub use self::begin::begins_in_motion;
use self::cache::{Cache, RunKey};
pub(crate) use self::candidates::of_kinds;
use self::jumps::Jumps;
use self::length::check_length;
pub use self::parallel::{Thinning, for_comparison};
pub(crate) use self::signals::is_place;
use crate::diagnose::Observation;
use crate::model::{Candidate, Columns, CurveCandidate, Experiment, Model, PredictError, SetUp};

/// A scenario with the data that it is held against.
pub struct Trial {
    scenario: Scenario,
    /// What the scenario has beyond its file: the start that the data say.
    start: Vec<(String, String)>,
    measured: Measured,
    /// Times of the measured samples since the start of their pass.
    stretches_s: Vec<Vec<f64>>,
    /// What is kept of filtered drive forces.
    thinning: Option<Thinning>,
    facts: RobotFacts,
    channels: Vec<ChannelSpec>,
    candidates: Vec<Candidate>,
    /// Effects of the scenario itself, whose sizes another recording may have changed.
    held: Vec<Candidate>,
    /// Curves for what has no name, each with its ends.
    curves: Vec<CurveCandidate>,
    engine: Kind,
    robots: Robots,
    /// Drive forces of the arm without effects, for robots that were asked for last.
    rigid: Cache<RobotSpec, Forces>,
    /// Runs by nominal parameters and effects on the machine: what sensors make of them needs no
    /// other run.
    runs: Cache<RunKey, Rows>,
    /// Runs with a shorter step are not made, s.
    shortest_step_s: f64,
    /// Nor with a longer one, s.
    longest_step_s: f64,
    /// Steps in one period of the fastest mode.
    steps_per_period: StepsPerPeriod,
    /// Samples beside jumps of a force.
    jumps: Jumps,
    /// Of each joint, the greatest speed at which a friction's fall with speed can be told from
    /// other friction.
    fall_speeds: Vec<f64>,
    /// Base compliances below which the change is taken as proportional.
    stiff: Vec<(Target, f64)>,
    /// The arm's mass at its tool, where a mode of the tool may be found, kg.
    mass_at_tool_kg: Option<f64>,
    /// No mode of the tool is faster.
    fastest_mode_hz: f64,
    /// The data as the search sees them.
    pub observation: Observation,
}

/// A run of the search may need so many times the steps of the nominal one; what is faster is
/// beyond what the data show.
const FINEST: f64 = 4.0;
/// In milling also so many times the samples, in which modes of the tool up to two fifths of their
/// rate can be stepped, also if they move a quarter of the arm's mass.
const FINEST_OF_DATA: f64 = 75.0;
/// A mode of the tool is looked for up to this part of the rate of the samples.
const FASTEST_MODE: f64 = 0.4;

/// A run with the reduced plant, whatever step it needs.
fn reduced<'a>(scenario: &'a Scenario, measured: &'a Measured, robots: &'a Robots) -> run::Run<'a> {
    run::Run {
        measured: Some(measured),
        robots: Some(robots),
        engine: Engine::REDUCED,
        ..run::Run::of(scenario)
    }
}

/// Runs that end early go on for so long, for channels that come early, s.
const EARLIEST_S: f64 = 0.05;

/// How predictions are made.
enum Kind {
    Forward,
    Inverse {
        model: Box<InverseModel>,
        /// Samples of the data for one that the search sees.
        every: usize,
    },
    /// A steady machine of which nothing is simulated.
    Steady(Box<SteadyModel>),
}

impl Trial {
    /// Prepares a scenario and its data: nominal run, candidates with typical sizes, known signals.
    ///
    /// # Errors
    /// Whatever makes the scenario unfit to run with these data; outputs that it does not have.
    pub fn new(scenario: &Scenario, measured: &Measured) -> Result<Trial, SimError> {
        let facts = match mode(scenario) {
            Some(ReplayMode::Observe) => RobotFacts::default(),
            _ => robot_facts(scenario)?,
        };
        let robots = Robots::new();
        let start = found_start(scenario, measured, &robots)?;
        let mut started = match start.keys.is_empty() {
            true => scenario.clone(),
            false => scenario.with_overrides(&start.keys)?,
        };
        (started.uncertain).extend(clock::unknown(&started).into_iter().chain(start.unknowns));
        let scenario = &started;
        let measured = &crate::spikes::bridged(scenario, measured);
        let mut thinning = None;
        let run_s = |measured| reduced(scenario, measured, &robots).time_step_s();
        let (jumps, bridged) = match scenario.process {
            ProcessSpec::Milling(_) => {
                Jumps::bridged(scenario, measured, &reduced(scenario, measured, &robots))?
            }
            _ => (Jumps::default(), measured.clone()),
        };
        let measured = &bridged;
        let (engine, recording, used, channels) = match mode(scenario) {
            Some(ReplayMode::Inverse { .. }) => {
                let model = Box::new(InverseModel::new(scenario, measured)?);
                thinning = Thinning::of(scenario, model.measured());
                let every = thinning.map_or(1, |thinning| thinning.every);
                let used = parallel::thinned(model.measured(), every);
                let channels = model.channels().to_vec();
                (Kind::Inverse { model, every }, None, used, channels)
            }
            Some(ReplayMode::Observe) => {
                let model = Box::new(SteadyModel::new(scenario, measured)?);
                let (used, channels) = (model.measured().clone(), model.channels().to_vec());
                (Kind::Steady(model), None, used, channels)
            }
            _ => {
                check_length(scenario, measured, &robots)?;
                let rows = reduced(scenario, measured, &robots).rows(&[], None)?;
                let channels = observation::outputs(scenario, measured, &rows)?;
                let used = crate::spikes::bridged_beside(scenario, measured, &rows);
                (Kind::Forward, Some(rows), used, channels)
            }
        };
        let measured = match &engine {
            Kind::Forward => &used,
            _ => measured,
        };
        let mut observation =
            observation::observation(scenario, &used, &channels, recording.as_ref());
        if let Kind::Inverse { model, every } = &engine {
            observation::add_motion(&mut observation, scenario, measured, model, *every);
        }
        let (whole, every) = match &engine {
            Kind::Inverse { model, every } => (model.measured(), *every),
            _ => (measured, 1),
        };
        noise::Recording::new(scenario, measured, whole, every).add(&mut observation, &channels);
        let signals = signals::Signals::new(scenario, measured, &facts, recording.as_ref());
        let shortest_step_s = match &engine {
            Kind::Inverse { .. } | Kind::Steady(_) => 0.0,
            Kind::Forward => {
                let of_data_s = match scenario.process {
                    ProcessSpec::Milling(_) => measured.interval_s() / FINEST_OF_DATA,
                    _ => f64::INFINITY,
                };
                of_data_s.min(run_s(measured)? / FINEST)
            }
        };
        let known = candidates::candidates(scenario, &signals, &channels);
        let fastest_mode_hz = FASTEST_MODE / measured.interval_s();
        let mut measured = measured.clone();
        measured.notes.extend(known.untold);
        let samples = measured.time_s.len();
        let told = [
            thinning.and_then(|thinning| thinning.told(samples)),
            observation::uncommanded(scenario, &measured, facts.joints.len()),
            begins_in_motion(scenario, &measured),
        ];
        measured.notes.extend(told.into_iter().flatten());
        measured.notes.extend(estimates(scenario, &robots)?);
        if let Kind::Inverse { model, .. } = &engine {
            measured.notes.extend(model.beyond_limits());
        }
        let mut trial = Trial {
            candidates: zeros::shown(&engine, known.absent),
            held: known.held,
            curves: curves::curves(scenario, &signals),
            scenario: scenario.clone(),
            start: start.keys,
            stretches_s: measured.stretches_s(),
            measured,
            thinning,
            facts,
            channels,
            engine,
            robots,
            rigid: Cache::default(),
            runs: Cache::default(),
            shortest_step_s,
            longest_step_s: f64::INFINITY,
            steps_per_period: StepsPerPeriod::DEFAULT,
            jumps,
            fall_speeds: signals.fall_speeds(),
            stiff: Vec::new(),
            mass_at_tool_kg: None,
            fastest_mode_hz,
            observation,
        };
        trial.find_step()?;
        trial.stiff = trial.least_compliances();
        trial.mass_at_tool_kg = trial.mass_at_tool_kg();
        Ok(trial)
    }

    /// Whether each joint of the chain is rotary: it chooses the keys of effects.
    pub fn rotary(&self) -> Vec<bool> {
        self.facts.joints.iter().map(|joint| joint.rotary).collect()
    }

    /// The measured data.
    pub fn measured(&self) -> &Measured {
        &self.measured
    }

    /// What is kept of filtered drive forces.
    pub fn thinning(&self) -> Option<Thinning> {
        self.thinning
    }

    /// The prediction of the full model: rapier where the search used the reduced plant.
    ///
    /// # Errors
    /// A run that fails or diverges.
    pub fn confirm(&self, nominal: &[f64], effects: &[Effect]) -> Result<Columns, PredictError> {
        match &self.engine {
            Kind::Inverse { .. } | Kind::Steady(_) => self.predict(nominal, effects),
            Kind::Forward => self.forward(nominal, effects, Engine::Rapier, None),
        }
    }

    /// The nominal parameters that differ from the scenario's, as they are written in its file, and
    /// the start that it does not give.
    pub fn overrides(&self, nominal: &[f64]) -> Vec<(String, String)> {
        let changed = (self.changed(nominal))
            .map(|(parameter, value)| (parameter.key.clone(), parameter.written(value)));
        self.start.iter().cloned().chain(changed).collect()
    }

    fn changed<'a>(&'a self, nominal: &'a [f64]) -> impl Iterator<Item = (&'a UncertainSpec, f64)> {
        let pairs = self.scenario.uncertain.iter().zip(nominal.iter().copied());
        pairs.filter(|(parameter, value)| parameter.value != *value)
    }

    /// The scenario with other nominal parameters and further effects.
    fn varied(&self, nominal: &[f64], effects: &[Effect]) -> Result<Scenario, PredictError> {
        let values: Vec<(&str, f64)> = (self.changed(nominal))
            .map(|(parameter, value)| (parameter.key.as_str(), value))
            .collect();
        (self.scenario.with_values(&values))
            .and_then(|scenario| scenario.with_effects(effects))
            .map_err(|error| PredictError(error.to_string()))
    }
}

impl Model for Trial {
    fn channels(&self) -> &[ChannelSpec] {
        &self.channels
    }

    fn nominal(&self) -> &[UncertainSpec] {
        &self.scenario.uncertain
    }

    fn candidates(&self) -> Vec<Candidate> {
        self.candidates.clone()
    }

    fn parameters(&self, candidate: &Candidate) -> Vec<ParameterInfo> {
        self.bounds(candidate)
    }

    fn sizes_by_mode(&self, candidate: &Candidate, step_hz: f64) -> Vec<f64> {
        Trial::sizes_by_mode(self, candidate, step_hz)
    }

    fn slowest_mode_hz(&self) -> Option<f64> {
        self.modes_hz(&self.scenario)?.first().copied()
    }

    fn curves(&self) -> Vec<CurveCandidate> {
        self.curves.clone()
    }

    fn additive(&self) -> Vec<usize> {
        of_kinds(&self.candidates, |kind| self.adds_up(kind))
    }

    fn late(&self) -> Vec<usize> {
        of_kinds(&self.candidates, |kind| self.comes_late(kind))
    }

    fn predict(&self, nominal: &[f64], effects: &[Effect]) -> Result<Columns, PredictError> {
        self.predicted(nominal, effects, None)
    }

    fn predict_first(
        &self,
        samples: usize,
        nominal: &[f64],
        effects: &[Effect],
    ) -> Result<Columns, PredictError> {
        let times = self.stretches_s.iter().flatten().take(samples);
        let last_s = times.copied().fold(0.0, f64::max);
        self.predicted(nominal, effects, Some(last_s + EARLIEST_S))
    }

    fn may_be(&self, effects: &[Effect]) -> bool {
        Trial::may_be(self, effects)
    }

    fn is_steady(&self) -> bool {
        matches!(self.engine, Kind::Steady(_))
    }

    fn doubt(&self) -> Option<String> {
        begins_in_motion(&self.scenario, &self.measured)
    }

    fn set_ups(&self) -> Vec<SetUp> {
        match &self.engine {
            Kind::Inverse { model, every } => {
                set_ups::of_drive_forces(model, *every, &self.observation)
            }
            Kind::Forward | Kind::Steady(_) => Vec::new(),
        }
    }

    fn experiments(&self) -> Vec<Experiment> {
        experiments::experiments(&self.scenario)
    }

    fn predict_experiment(
        &self,
        experiment: &Experiment,
        nominal: &[f64],
        effects: &[Effect],
    ) -> Result<Columns, PredictError> {
        let scenario = (self.varied(nominal, effects)?)
            .with_overrides(&experiment.overrides)
            .map_err(|error| PredictError(error.to_string()))?;
        let rows = self.run(&scenario, self.reduced(), None)?;
        Ok(self.at_the_data(&rows, self.clock_rate(nominal)))
    }
}

fn mode(scenario: &Scenario) -> Option<ReplayMode> {
    match &scenario.process {
        ProcessSpec::Replay(replay) => Some(replay.mode),
        _ => None,
    }
}
