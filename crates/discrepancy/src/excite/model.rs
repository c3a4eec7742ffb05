//! What outputs change by with each unknown along a motion: by inverse dynamics, or by runs.

use truecut_plan::motion::excitation::SampledMotion;
use truecut_recording::{ChannelSpec, Measured, MeasuredChannel, Role};
use truecut_scenario::effect::Effect;
use truecut_scenario::{ReplayMode, Scenario};
use truecut_sim::{InverseModel, PlannedArm, Robots, SimError};

use super::channels::{inputs, mode, output};
use super::unknowns::{Extra, Unknowns, What, refused};
use crate::fit::base::any_state;
use crate::fit::columns::columns;
use crate::model::Model as _;
use crate::trial::Trial;
use crate::trial::parallel::{picked, spacing};

/// Derivatives of all outputs by all unknowns along one motion.
#[derive(Debug, Clone)]
pub(super) struct Jacobian {
    /// `[unknown][channel][row]`.
    pub columns: Vec<Vec<Vec<f64>>>,
    /// Whether a row counts, `[channel][row]`.
    pub counts: Vec<Vec<bool>>,
    /// What is predicted, `[channel][row]`.
    pub outputs: Vec<Vec<f64>>,
    /// Rows are taken independent of each other; part of the noise of a sample that each has.
    pub noise_share: f64,
}

/// Who says what the outputs are.
pub(super) enum Kind {
    /// Drive forces of a measured motion.
    Inverse(Box<InverseModel>),
    /// Runs of the reduced plant that follow a command.
    Forward,
}

/// A scenario with its unknowns.
pub(super) struct Model {
    pub kind: Kind,
    pub scenario: Scenario,
    pub unknowns: Unknowns,
    /// Names, units and values of all unknowns: those of `[fit]`, then the others.
    pub names: Vec<String>,
    pub units: Vec<String>,
    pub values: Vec<f64>,
    /// Number of those of `[fit]`.
    pub of_fit: usize,
    pub robots: Robots,
    /// Channels of the coordinates or commands that move.
    inputs: Vec<(usize, ChannelSpec)>,
    pub outputs: Vec<MeasuredChannel>,
    rotary: Vec<bool>,
    /// Steps of the differences for the unknowns beside those of `[fit]`.
    pub steps: Vec<f64>,
}

/// Part of a typical size by which a run is varied.
const OF_TYPICAL: f64 = 0.02;
/// Step of a difference of drive forces, which are linear in nearly all: part of the value, or in
/// SI where that is 0.
const OF_VALUE: f64 = 1e-3;
/// Part of its deviation by which an uncertain value is varied.
const OF_SIGMA: f64 = 0.05;

impl Model {
    /// `motion` is any motion at `times_s`.
    ///
    /// # Errors
    /// A scenario that replays no motion of joints; data that name no output; whatever makes it
    /// unfit to run.
    pub fn new(
        scenario: &Scenario,
        arm: &PlannedArm,
        unknowns: Unknowns,
        motion: &SampledMotion,
        times_s: &[f64],
    ) -> Result<Model, SimError> {
        let mode = mode(scenario)?;
        let is_inverse = matches!(mode, ReplayMode::Inverse { .. });
        let mapped = scenario
            .data
            .as_ref()
            .map_or(&[][..], |data| &data.mapping.channels);
        let rotary: Vec<bool> = (0..motion.position.len())
            .map(|joint| arm.joint(joint).1 == "rad")
            .collect();
        let mut model = Model {
            kind: Kind::Forward,
            names: unknowns.extra.iter().map(|one| one.name.clone()).collect(),
            units: unknowns.extra.iter().map(|one| one.unit.clone()).collect(),
            values: unknowns.extra.iter().map(|one| one.value).collect(),
            steps: Vec::new(),
            of_fit: 0,
            robots: Robots::new(),
            inputs: inputs(mapped, &rotary, is_inverse),
            outputs: mapped
                .iter()
                .filter(|one| one.role == Role::Output)
                .map(output)
                .collect(),
            scenario: scenario.clone(),
            unknowns,
            rotary,
        };
        if model.outputs.is_empty() {
            let message = "no column is mapped to an output: say what will be measured";
            return Err(SimError::scenario("data.channel", message));
        }
        if !is_inverse && model.inputs.is_empty() {
            let message = "no column is mapped to a command (joint1.command, role \"input\"): nothing would move";
            return Err(SimError::scenario("data.channel", message));
        }
        let measured = model.measured(motion, times_s);
        if is_inverse {
            let inverse = InverseModel::new(scenario, &measured)?;
            model.add_fit(&inverse)?;
            model.kind = Kind::Inverse(Box::new(inverse));
        } else {
            model.take_typical_sizes(&measured, motion)?;
        }
        model.steps = model
            .unknowns
            .extra
            .iter()
            .map(|one| model.step(one))
            .collect();
        Ok(model)
    }

    fn add_fit(&mut self, inverse: &InverseModel) -> Result<(), SimError> {
        let Some(fit) = &self.unknowns.fit else {
            return Ok(());
        };
        let own = columns(&self.scenario, inverse, fit, 1)?;
        self.of_fit = own.len();
        let joined = |first: Vec<String>, rest: &[String]| [&first[..], rest].concat();
        let names = own.iter().map(|column| column.name.clone()).collect();
        self.names = joined(names, &self.names);
        let units = own.iter().map(|column| column.unit.to_owned()).collect();
        self.units = joined(units, &self.units);
        let values: Vec<f64> = own.iter().map(|column| column.nominal).collect();
        self.values = [&values[..], &self.values].concat();
        Ok(())
    }

    /// Effects without a size are looked at at a typical one: play, say, shows nothing at size
    /// zero.
    fn take_typical_sizes(
        &mut self,
        measured: &Measured,
        motion: &SampledMotion,
    ) -> Result<(), SimError> {
        if self
            .unknowns
            .effects
            .iter()
            .all(|effect| !effect.is_neutral())
        {
            return Ok(());
        }
        let candidates = Trial::new(&self.placed(motion), measured)?.candidates();
        for (index, effect) in self.unknowns.effects.iter_mut().enumerate() {
            if !effect.is_neutral() {
                continue;
            }
            let same = |one: &&crate::model::Candidate| {
                one.kind == effect.kind && one.target == effect.target
            };
            let Some(typical) = candidates.iter().find(same) else {
                return Err(refused(format!(
                    "names {effect}, which no motion can show: nothing in a run of this scenario gives it a size"
                )));
            };
            let infos = effect.kind.parameters().iter();
            for ((info, value), scale) in infos.zip(&mut effect.values).zip(&typical.scale) {
                if info.is_size {
                    *value = (info.neutral + scale).clamp(info.min, info.max);
                }
            }
            let values = effect.values.clone();
            for extra in &mut self.unknowns.extra {
                if let What::Effect { effect, parameter } = extra.what
                    && effect == index
                {
                    extra.value = values[parameter];
                }
            }
        }
        self.values = self.unknowns.extra.iter().map(|one| one.value).collect();
        Ok(())
    }

    fn step(&self, extra: &Extra) -> f64 {
        match &extra.what {
            What::Key(_) => extra.sigma.map_or(OF_VALUE, |sigma| OF_SIGMA * sigma),
            What::Effect { effect, parameter } => {
                let info = &self.unknowns.effects[*effect].kind.parameters()[*parameter];
                let from = if info.is_size { info.neutral } else { 0.0 };
                let size = (extra.value - from).abs();
                match (&self.kind, size > 0.0) {
                    (Kind::Forward, _) => OF_TYPICAL * size,
                    (Kind::Inverse(_), true) => OF_VALUE * size,
                    (Kind::Inverse(_), false) => OF_VALUE,
                }
            }
        }
    }

    /// The outputs, with their noise where the scenario has it.
    pub fn noisy_outputs(&self) -> Vec<(ChannelSpec, Option<f64>)> {
        let noise = |spec: &ChannelSpec| {
            let mut own = self.outputs.iter().filter(|one| one.spec.name == spec.name);
            own.next().and_then(|one| one.noise)
        };
        let specs: Vec<ChannelSpec> = match &self.kind {
            Kind::Inverse(model) => model.channels().to_vec(),
            Kind::Forward => self.outputs.iter().map(|one| one.spec.clone()).collect(),
        };
        let with_noise = |spec: ChannelSpec| (spec.clone(), noise(&spec));
        specs.into_iter().map(with_noise).collect()
    }

    /// What moves.
    pub fn inputs(&self) -> &[(usize, ChannelSpec)] {
        &self.inputs
    }

    /// Derivatives of drive forces in unrelated states: what cannot be told apart there, no motion
    /// tells apart. `None` where the model is not of that kind.
    ///
    /// # Errors
    /// As [`Model::rough`].
    pub fn anywhere(&self) -> Result<Option<Vec<Vec<Vec<f64>>>>, SimError> {
        match &self.kind {
            Kind::Inverse(model) => {
                let states = any_state(model);
                Ok(Some(self.inverse(&states, 1, 1.0)?.columns))
            }
            Kind::Forward => Ok(None),
        }
    }

    /// The motion as data: what drives the replay, and outputs of which nothing is measured yet.
    pub fn measured(&self, motion: &SampledMotion, times_s: &[f64]) -> Measured {
        let mut channels: Vec<MeasuredChannel> = (self.inputs.iter())
            .map(|(joint, spec)| MeasuredChannel {
                spec: spec.clone(),
                role: Role::Input,
                values: motion.position[*joint].clone(),
                valid: vec![true; times_s.len()],
                noise: None,
                white_kept: 1.0,
            })
            .collect();
        channels.extend(self.outputs.iter().map(|one| MeasuredChannel {
            values: vec![0.0; times_s.len()],
            valid: vec![true; times_s.len()],
            ..one.clone()
        }));
        Measured {
            source: "the planned motion".to_owned(),
            time_s: times_s.to_vec(),
            channels,
            ..Measured::default()
        }
    }

    /// The scenario in the posture in which a motion begins.
    pub fn placed(&self, motion: &SampledMotion) -> Scenario {
        let mut placed = self.scenario.clone();
        let start = |rotary: bool| {
            let own = motion.position.iter().zip(&self.rotary);
            own.filter(move |(_, is_rotary)| **is_rotary == rotary)
                .map(|(q, _)| q[0])
                .collect()
        };
        placed.robot.posture_rad = start(true);
        placed.robot.posture_m = start(false);
        placed
    }

    /// Derivatives along a motion for the search: without filters, of which the motion is slow
    /// enough not to feel any.
    ///
    /// # Errors
    /// A run that fails.
    pub fn rough(&self, motion: &SampledMotion, times_s: &[f64]) -> Result<Jacobian, SimError> {
        match &self.kind {
            Kind::Inverse(model) => self.inverse(&model.in_motion(motion, times_s), 1, 1.0),
            Kind::Forward => self.forward(&self.placed(motion), &self.measured(motion, times_s)),
        }
    }

    /// Derivatives along a motion as its data will be compared: filtered and thinned.
    ///
    /// # Errors
    /// A motion too short for the filters; a run that fails.
    pub fn whole(&self, motion: &SampledMotion, times_s: &[f64]) -> Result<Jacobian, SimError> {
        let measured = self.measured(motion, times_s);
        match &self.kind {
            Kind::Inverse(_) => self.of_data(&measured),
            Kind::Forward => self.forward(&self.placed(motion), &measured),
        }
    }

    /// Derivatives along the motion of measured data.
    ///
    /// # Errors
    /// As [`Model::whole`].
    pub fn of_data(&self, measured: &Measured) -> Result<Jacobian, SimError> {
        match (&self.kind, mode(&self.scenario)?) {
            (
                Kind::Inverse(_),
                ReplayMode::Inverse {
                    compare_cutoff_hz, ..
                },
            ) => {
                let model = InverseModel::new(&self.scenario, measured)?;
                let share = InverseModel::white_share(compare_cutoff_hz, measured.rate_hz());
                let every = spacing(&self.scenario, measured.rate_hz());
                let mut whole = self.inverse(&model, every, share)?;
                for (counts, channel) in whole.counts.iter_mut().zip(&model.measured().channels) {
                    let valid = picked(&channel.valid, every);
                    counts
                        .iter_mut()
                        .zip(valid)
                        .for_each(|(counts, valid)| *counts &= valid);
                }
                Ok(whole)
            }
            _ => self.forward(&self.scenario, measured),
        }
    }

    fn inverse(
        &self,
        model: &InverseModel,
        every: usize,
        noise_share: f64,
    ) -> Result<Jacobian, SimError> {
        let mut all = Vec::with_capacity(self.names.len());
        if let Some(fit) = &self.unknowns.fit {
            let own = columns(&self.scenario, model, fit, every)?;
            all.extend(own.into_iter().map(|column| column.values));
        }
        let predict = |scenario: &Scenario, effects: &[Effect]| {
            let columns = match scenario.robot == self.scenario.robot {
                true => model.predict(effects)?,
                false => {
                    let rigid = model.nominal_for(&scenario.robot, &self.robots)?;
                    model.predict_from(&rigid, effects)?
                }
            };
            Ok((columns.iter())
                .map(|column| picked(column, every))
                .collect())
        };
        self.differences(&self.scenario, &predict, &mut all)?;
        let outputs: Vec<Vec<f64>> = predict(&self.scenario, &self.unknowns.effects)?;
        let counts = (model.joints().iter().zip(&outputs))
            .map(|(&joint, column)| match &self.unknowns.fit {
                None => vec![true; column.len()],
                Some(fit) => {
                    let least = match self.rotary[joint] {
                        true => fit.standstill_rad_per_s,
                        false => fit.standstill_m_per_s,
                    };
                    let moves = |v: &f64| v.abs() > least;
                    picked(model.velocity(joint), every)
                        .iter()
                        .map(moves)
                        .collect()
                }
            })
            .collect();
        Ok(Jacobian {
            columns: all,
            counts,
            outputs,
            noise_share,
        })
    }
}
