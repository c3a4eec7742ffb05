//! Measured motion in, drive forces out.
//!
//! The coordinates go through a zero-phase Butterworth filter of fourth order and are
//! differentiated twice by differences: of a polynomial of fourth degree through nine samples,
//! through seven where a period of the cutoff has fewer than ten, of sixth order where it has
//! fewer than five. The rigid arm's inverse dynamics, its rotors and its friction give the drive
//! forces; these and the measured ones go through one and the same second filter, so that neither
//! leads nor lags. The practice is that of `gautier1997` and `janot2014`.

mod limits;
mod set_ups;

use super::drive_forces::{FILTER_ORDER, filtered};
use super::inputs::{JointQuantity, Source, joint_channel};
use super::motion::Motion;
use super::regressors::BodyRegressors;
use super::rigid::{Forces, nominal, without_friction};
use super::{check_part, in_force, refused, sense};
use crate::channels::drive_spec;
use crate::effect::{Effects, JointEffects, Payload};
use crate::error::SimError;
use crate::robots::Robots;
use nalgebra::{Point3, Vector3};
use std::sync::Arc;
use truecut_arm::{FrameId, Robot};
use truecut_core::joint_law::LinkFriction;
use truecut_plan::motion::excitation::SampledMotion;
use truecut_recording::filter::Butterworth;
use truecut_recording::{ChannelSpec, Measured, Role, short_number};
use truecut_scenario::effect::{Effect, Target};
use truecut_scenario::{ProcessSpec, ReplayMode, RobotSpec, Scenario};

/// Predicts drive forces from measured motion, for any set of effects, without integrating
/// anything.
#[derive(Debug, Clone)]
pub struct InverseModel {
    robot: Arc<Robot>,
    /// Joints whose drive force is predicted, in the order of `measured.channels`.
    joints: Vec<usize>,
    measured: Measured,
    specs: Vec<ChannelSpec>,
    filter: Butterworth,
    motion: Motion,
    nominal: Forces,
    body: BodyRegressors,
    scenario: Scenario,
}

impl InverseModel {
    /// Filters and differentiates the motion and prepares everything that does not depend on
    /// effects.
    ///
    /// # Errors
    /// A robot that cannot be loaded; a scenario that does not replay in mode "inverse"; an input
    /// that is missing, incomplete or in a wrong unit; no measured drive force; effects that play
    /// no part here.
    pub fn new(scenario: &Scenario, measured: &Measured) -> Result<InverseModel, SimError> {
        let (differentiate_hz, compare_hz) = cutoffs(scenario)?;
        let robot = Arc::new(crate::build::load_robot(&scenario.robot)?);
        let source = Source { scenario, measured };
        let joints = outputs(&robot, &source)?;
        let rate = measured.rate_hz();
        check_cutoff(&source, "differentiate_cutoff_hz", differentiate_hz)?;
        check_cutoff(&source, "compare_cutoff_hz", compare_hz)?;
        let filter = InverseModel::filter_of(compare_hz, rate);
        let motion = Motion::new(&robot, &source, differentiate_hz)?;
        let model = InverseModel {
            nominal: nominal(&robot, &motion, &joints, &filter),
            body: BodyRegressors::new(&robot, &motion, &joints, &filter, robot.dof() - 1),
            specs: (joints.iter())
                .map(|&joint| drive_spec(joint + 1, &robot.chain.joints[joint]))
                .collect(),
            measured: filtered(
                measured,
                &robot,
                &joints,
                &filter,
                [differentiate_hz, compare_hz],
            ),
            scenario: scenario.clone(),
            joints,
            motion,
            filter,
            robot,
        };
        model.predict(&[])?;
        Ok(model)
    }

    /// The filter of drive forces, run forward and backward.
    pub fn filter_of(cutoff_hz: f64, rate_hz: f64) -> Butterworth {
        Butterworth::low_pass(FILTER_ORDER, cutoff_hz, rate_hz)
    }

    /// Part of the standard deviation of white noise that this filter leaves.
    pub fn white_share(cutoff_hz: f64, rate_hz: f64) -> f64 {
        Butterworth::white_share(FILTER_ORDER, cutoff_hz, rate_hz)
    }

    /// Gain of this filter; cutoff and frequency in cycles per sample, below a half.
    pub fn filter_gain(cutoff: f64, cycles: f64) -> f64 {
        Butterworth::zero_phase_gain(FILTER_ORDER, cutoff, cycles)
    }

    /// Forces without effects, for the same motion and a robot with other masses and rotors; for
    /// [`InverseModel::predict_from`].
    ///
    /// # Errors
    /// A robot that cannot be loaded.
    pub fn nominal_for(&self, spec: &RobotSpec, robots: &Robots) -> Result<Forces, SimError> {
        let robot = robots.robot(spec)?;
        robot.refuse_followers(crate::build::NO_FOLLOWERS)?;
        Ok(nominal(&robot, &self.motion, &self.joints, &self.filter))
    }

    /// Drive forces of links and rotors alone, without friction and effects, filtered: one column
    /// for each of [`InverseModel::channels`].
    pub fn without_friction(&self) -> Vec<Vec<f64>> {
        without_friction(&self.robot, &self.motion, &self.joints, &self.filter)
    }

    /// What is predicted, in order: the drive forces that were measured.
    pub fn channels(&self) -> &[ChannelSpec] {
        &self.specs
    }

    /// The measured drive forces through the same filter; samples whose neighbourhood has a gap are
    /// not valid.
    pub fn measured(&self) -> &Measured {
        &self.measured
    }

    /// The robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// The drive forces as they depend on a link's inertial parameters about its origin, in its
    /// axes: mass, three first moments, and the inertia's xx, yy, zz, xy, xz, yz;
    /// `[parameter][channel][sample]`, filtered. The drive forces are linear in them, so that they
    /// can be identified.
    ///
    /// # Panics
    /// If there is no such link.
    pub fn inertial_columns(&self, link: usize) -> Vec<Vec<Vec<f64>>> {
        BodyRegressors::new(&self.robot, &self.motion, &self.joints, &self.filter, link).columns
    }

    /// Joints whose drive forces are predicted, counted from 0, in the order of
    /// [`InverseModel::channels`].
    pub fn joints(&self) -> &[usize] {
        &self.joints
    }

    /// Velocity of a joint at every sample.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn velocity(&self, joint: usize) -> &[f64] {
        &self.motion.velocity[joint]
    }

    /// Acceleration of a joint at every sample.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn acceleration(&self, joint: usize) -> &[f64] {
        &self.motion.acceleration[joint]
    }

    /// A drive force through the filter that measured and predicted ones have gone through.
    pub fn filtered(&self, drive: &[f64]) -> Vec<f64> {
        self.filter.zero_phase(drive)
    }

    /// The same arm in unrelated states, unfiltered: what is alike there, no motion tells apart.
    /// For what a sensor makes of a row of values they follow one another at the data's interval.
    pub fn in_any_state(&self, states: usize) -> InverseModel {
        let interval_s = self.measured.interval_s();
        let times_s = (0..states).map(|state| state as f64 * interval_s).collect();
        self.along(self.motion.of_any_states(states), times_s)
    }

    /// The same arm along another motion of all joints, at its times, unfiltered.
    pub fn in_motion(&self, motion: &SampledMotion, times_s: &[f64]) -> InverseModel {
        let motion = Motion::of(motion, self.motion.gravity_m_s2);
        self.along(motion, times_s.to_vec())
    }

    /// Passes all: its cutoff is beyond half the rate.
    fn unfiltered(&self) -> Butterworth {
        let rate_hz = self.measured.rate_hz();
        Butterworth::low_pass(FILTER_ORDER, rate_hz, rate_hz)
    }

    fn along(&self, motion: Motion, time_s: Vec<f64>) -> InverseModel {
        let (robot, joints, filter) = (&self.robot, &self.joints, self.unfiltered());
        InverseModel {
            measured: Measured {
                time_s,
                ..Measured::default()
            },
            nominal: nominal(robot, &motion, joints, &filter),
            body: BodyRegressors::new(robot, &motion, joints, &filter, robot.dof() - 1),
            motion,
            filter,
            ..self.clone()
        }
    }

    /// Drive forces with the scenario's effects and further `effects`, which replace those of the
    /// same kind and target: one filtered column for each of [`InverseModel::channels`], SI.
    ///
    /// # Errors
    /// An effect that plays no part in inverse dynamics, or whose joint or channel does not exist.
    pub fn predict(&self, effects: &[Effect]) -> Result<Vec<Vec<f64>>, SimError> {
        self.predict_from(&self.nominal, effects)
    }

    /// [`InverseModel::predict`] on other forces than the nominal ones.
    ///
    /// # Errors
    /// As [`InverseModel::predict`].
    pub fn predict_from(
        &self,
        nominal: &Forces,
        effects: &[Effect],
    ) -> Result<Vec<Vec<f64>>, SimError> {
        let all = in_force(&self.scenario.effects, effects);
        for effect in &all {
            self.check(effect)?;
        }
        let sum = Effects::sum(all, &self.robot.chain.joints);
        let retimed = sum.clock_rate.map(|rate| self.motion.faster(rate));
        let motion = retimed.as_ref().unwrap_or(&self.motion);
        let built = self.as_it_stands(nominal, &sum, motion)?;
        let nominal = built.as_ref().unwrap_or(nominal);
        let mut columns = nominal.drive.clone();
        // In an arm that stands elsewhere it is built in.
        let payload = sum.payload.as_ref().filter(|_| built.is_none());
        if let Some(payload) = payload {
            let center = self.center(payload);
            (self.body).add_point_mass(payload.mass_kg, &center, &mut columns);
        }
        for (at, &joint) in self.joints.iter().enumerate() {
            let effects = &sum.joints[joint];
            if !effects.is_built_in() {
                let against = self.against(at, effects, payload, &nominal.passed_on[at], motion);
                for (sum, force) in columns[at].iter_mut().zip(against) {
                    *sum += force;
                }
            }
        }
        // Sensors see the sum of all torques, so they come last.
        sense(&sum, &self.specs, &self.measured.time_s, &mut columns);
        Ok(columns)
    }

    /// Refuses an effect that plays no part in inverse dynamics, or is on what is not predicted.
    fn check(&self, effect: &Effect) -> Result<(), SimError> {
        check_part(&self.scenario, effect)?;
        let refuse = |key, message| Err(refused(&self.scenario, effect, key, message));
        let name = effect.kind.name();
        match &effect.target {
            Target::Joint(joint) if *joint >= self.robot.dof() => {
                let joints = self.robot.dof();
                let message = format!("\"{name}\" is on a joint that the chain of {joints} lacks");
                refuse("joint", message)
            }
            Target::Channel(channel) if self.specs.iter().all(|spec| spec.name != *channel) => {
                let known: Vec<&str> = self.specs.iter().map(|spec| spec.name.as_str()).collect();
                let message = format!(
                    "\"{name}\" is on a channel that is not predicted here; these are {}",
                    known.join(", ")
                );
                refuse("channel", message)
            }
            Target::Whole | Target::Joint(_) | Target::Axis(_) | Target::Channel(_) => Ok(()),
        }
    }

    /// What the drive gives against the effects on its joint, filtered. Friction that grows with
    /// the load does with all that the transmission passes on, the other effects included.
    fn against(
        &self,
        at: usize,
        effects: &JointEffects,
        payload: Option<&Payload>,
        passed_on: &[f64],
        motion: &Motion,
    ) -> Vec<f64> {
        let joint = self.joints[at];
        let (position, velocity) = (&motion.position[joint], &motion.velocity[joint]);
        let instants = position.iter().zip(velocity);
        let mut law: Vec<f64> = instants.map(|(q, v)| effects.against(*q, *v)).collect();
        let share = effects.friction.load_share;
        if share != 0.0 {
            let mut needed = passed_on.to_vec();
            if let Some(payload) = payload {
                let center = self.center(payload);
                (self.body).add_raw(payload.mass_kg, &center, at, &mut needed);
            }
            for ((force, needed), v) in law.iter_mut().zip(needed).zip(velocity) {
                *force += LinkFriction::of_load(share, needed + *force, *v);
            }
        }
        self.filter.zero_phase(&law)
    }

    /// The centre of a payload in the last link's frame, m.
    fn center(&self, payload: &Payload) -> Vector3<f64> {
        let flange = self.robot.last_link_from_frame(FrameId::Flange);
        (flange * Point3::from(payload.flange_from_center_m)).coords
    }
}

fn cutoffs(scenario: &Scenario) -> Result<(f64, f64), SimError> {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        return Err(SimError::scenario(
            format!("process.{}", scenario.process.name()),
            "must be [process.replay] with mode \"inverse\" to predict drive forces from motion",
        ));
    };
    let ReplayMode::Inverse {
        differentiate_cutoff_hz,
        compare_cutoff_hz,
    } = replay.mode
    else {
        return Err(SimError::scenario(
            "process.replay.mode",
            "must be \"inverse\" to predict drive forces from motion",
        ));
    };
    Ok((differentiate_cutoff_hz, compare_cutoff_hz))
}

fn check_cutoff(source: &Source<'_>, key: &str, hz: f64) -> Result<(), SimError> {
    let rate_hz = source.measured.rate_hz();
    if hz < 0.5 * rate_hz {
        return Ok(());
    }
    let key = format!("process.replay.{key}");
    // A default stands nowhere in the file: its reader must know where the value comes from.
    let unsaid = match source.scenario.gives(&key) {
        true => "",
        false => " by default",
    };
    let message = format!(
        "`{key}` is {hz} Hz{unsaid}, but must be below {} Hz, half of the {} samples a second of {}: \
         they show nothing above half their rate",
        short_number(0.5 * rate_hz),
        short_number(rate_hz),
        source.measured.source
    );
    Err(SimError::scenario(key, message))
}

/// Joints whose drive force was measured.
fn outputs(robot: &Robot, source: &Source<'_>) -> Result<Vec<usize>, SimError> {
    let mut joints = Vec::new();
    for joint in 0..robot.dof() {
        let channel = source.joint(robot, joint, JointQuantity::Drive)?;
        if channel.is_some_and(|channel| channel.role == Role::Output) {
            joints.push(joint);
        }
    }
    let names: Vec<String> = (0..robot.dof())
        .map(|joint| joint_channel(robot, joint, JointQuantity::Drive))
        .collect();
    let foreign = source
        .measured
        .outputs()
        .find(|channel| !names.contains(&channel.spec.name));
    if let Some(channel) = foreign {
        let message = format!(
            "channel \"{}\" is not predicted by inverse dynamics, which gives {}; what it computes them from \
             has role = \"input\"",
            channel.spec.name,
            names.join(", ")
        );
        return Err(source.error(&channel.spec.name, message));
    }
    if joints.is_empty() {
        let message = format!("no column is mapped to any of {}", names.join(", "));
        return Err(SimError::scenario("data.channel", message));
    }
    Ok(joints)
}
