//! From a scenario to everything that a cell is made of.

use crate::command::{JointCommand, StraightPath};
use crate::effect::{self, Altered, Effects};
use crate::error::SimError;
use crate::led_path::LedPath;
use crate::loads::{Attachment, Wrench};
use crate::measurement::ChannelModel;
use crate::plant::{Drive, DriveKind, JointLaw};
use crate::posture::{check_limits, of_job, posture};
use crate::process::{Process, Start};
use crate::replay::forward::ForwardInputs;
use crate::robots::Robots;
use crate::scene::Workpiece;
use crate::step_size::{self, Scheme};
use crate::tool_path::SolvedPath;
use crate::translate::build_process;
use nalgebra::{Isometry3, Vector3, Vector6};
use std::sync::Arc;
use truecut_arm::{FrameId, JointKind, Load, Robot};
use truecut_core::joint_law::LinkFriction;
use truecut_recording::{Measured, Scalar, Unit};
use truecut_scenario::{Drive as DriveSpec, ProcessSpec, RobotSpec, RunSpec, Scenario};

/// A scenario resolved against its robot, before any engine is built.
pub(crate) struct Prepared {
    /// The robot with the effects built in, joints of the base first.
    pub robot: Arc<Robot>,
    /// How many joints of the base there are.
    pub base_joints: usize,
    pub laws: Vec<JointLaw>,
    /// Friction of every joint.
    pub friction: Vec<LinkFriction>,
    /// Channels that are not recorded as they are.
    pub sensors: Vec<(String, ChannelModel)>,
    pub kind: DriveKind,
    pub gravity_m_s2: Vector3<f64>,
    /// Posture at rest after touch-down: the start of the run.
    pub start: Vec<f64>,
    pub world_from_process: Isometry3<f64>,
    pub command: JointCommand,
    pub process: Box<dyn Process>,
    pub workpiece: Workpiece,
    pub duration_s: f64,
    pub dt_s: f64,
    pub notes: Vec<String>,
}

impl Prepared {
    /// `measured` drives a replay; other processes make no use of it.
    pub(crate) fn new(scenario: &Scenario, measured: Option<&Measured>) -> Result<Self, SimError> {
        Self::for_scheme(scenario, measured, &Robots::new(), Scheme::Leapfrog)
    }

    /// Robots that have been read are not read again; the step is chosen for the scheme.
    pub(crate) fn for_scheme(
        scenario: &Scenario,
        measured: Option<&Measured>,
        robots: &Robots,
        scheme: Scheme,
    ) -> Result<Self, SimError> {
        let spec = &scenario.robot;
        let nominal = robots.robot(spec)?;
        let kind = drive_kind(spec, &nominal)?;
        let effects = Effects::of(scenario, &nominal, kind)?;
        let gravity_m_s2 = if spec.gravity {
            truecut_arm::standard_gravity_m_s2()
        } else {
            Vector3::zeros()
        };
        let replay = ForwardInputs::of(scenario, measured, &nominal, kind)?;
        let mut posture = match &scenario.process {
            // The way begins where it was taught.
            ProcessSpec::Brush(_) => vec![0.0; nominal.dof()],
            ProcessSpec::Belt(belt) => {
                posture(spec, &nominal).map_err(|error| of_job(error, &belt.job.file))?
            }
            _ => posture(spec, &nominal)?,
        };
        if let Some(replay) = &replay {
            replay.check_posture(spec, &nominal, &posture)?;
            posture = replay.posture(&posture);
        }
        let path = SolvedPath::of(scenario, &nominal, &posture)?;
        if let Some(path) = &path {
            posture.clone_from(&path.knots[0]);
        }
        let led = LedPath::of(scenario, &nominal, robots, &posture)?;
        if let Some(path) = &led {
            posture = path.start().to_vec();
        }
        let run_s = scenario.run.duration_s;
        let path_s = (led.as_ref()).map_or(run_s, |path| path.duration_s.min(run_s));
        let mut world_from_process = nominal.world_from_process(&posture);
        let (mut process, workpiece) = match &replay {
            Some(replay) => (
                Box::new(replay.process()) as Box<dyn Process>,
                Workpiece::None,
            ),
            None => build_process(
                scenario,
                &nominal,
                kind,
                &posture,
                &world_from_process,
                &effects,
                led.as_deref(),
            )?,
        };
        let duration_s = (replay.as_ref()).map_or(path_s, ForwardInputs::duration_s);
        let gravity = Load::gravity(gravity_m_s2);
        let sag = (spec.hold_against_sag && kind != DriveKind::Force).then_some(&gravity);
        // The controller knows the nominal robot only; what it does not know shows in the run.
        let path_note = led.as_ref().and_then(|path| path.note.clone());
        let command = match (&replay, path, &scenario.process) {
            (Some(replay), ..) => replay.command(&posture),
            _ if let Some(led) = &led => JointCommand::Replay(led.command(&nominal, sag)?),
            (None, Some(path), ProcessSpec::Milling(milling)) => {
                JointCommand::Along(StraightPath::of(&nominal, path, milling.feed_m_per_s, sag)?)
            }
            (None, ..) => command(
                &nominal,
                &posture,
                &world_from_process,
                process.as_ref(),
                duration_s,
                sag,
            )?,
        };
        check_limits(&nominal, &command)?;
        let altered = effect::alter(&nominal, &effects)?;
        let command = command.behind(altered.base_joints);
        let start = match kind {
            DriveKind::Force => {
                let mut start = vec![0.0; altered.base_joints];
                start.extend(&posture);
                effect::base_at_rest(&altered, &start, &gravity)
            }
            _ => touch_down(
                &altered,
                &command,
                process.as_ref(),
                &world_from_process,
                &gravity,
            )?,
        };
        let start = replay.as_ref().map_or(start.clone(), |replay| {
            let mut measured = start.clone();
            let arm = replay.start(&start[altered.base_joints..]);
            measured[altered.base_joints..].copy_from_slice(&arm);
            measured
        });
        let friction = friction(&altered, kind);
        let Altered {
            robot,
            base_joints,
            laws,
            ..
        } = altered;
        let touched = robot.world_from_frame(&start, FrameId::Tool);
        let unloaded = world_from_process.translation;
        world_from_process.translation = touched.translation;
        let fastest = match kind {
            DriveKind::Force => None,
            _ => Some(step_size::fastest_mode(
                &stiffest(&robot, &laws, &start, &command),
                &start,
                process.as_ref(),
                base_joints,
                kind == DriveKind::Servo,
            )?),
        };
        let run = RunSpec {
            duration_s,
            ..scenario.run
        };
        let loose = laws.iter().any(|law| law.gap > 0.0);
        let scheme = if loose { scheme.with_play() } else { scheme };
        let dt_s = step_size::choose(scheme, &run, fastest, process.as_ref())?;
        process.begin(&Start {
            time_step_s: dt_s,
            tool_offset_m: world_from_process.rotation.inverse()
                * (touched.translation.vector - unloaded.vector),
        });
        let mut notes = robot.chain.notes.clone();
        notes.extend(path_note);
        Ok(Self {
            robot: Arc::new(robot),
            base_joints,
            laws,
            friction,
            sensors: effects.sensors,
            kind,
            gravity_m_s2,
            start,
            world_from_process,
            command,
            process,
            workpiece,
            duration_s,
            dt_s,
            notes,
        })
    }

    /// The first command.
    pub(crate) fn first_command(&self) -> Vec<f64> {
        first_of(&self.command, self.robot.dof())
    }

    /// Velocities of the joints at the start.
    pub(crate) fn start_velocity(&self) -> Vec<f64> {
        self.command.start_velocity(self.robot.dof())
    }

    pub(crate) fn drive(&self) -> Drive {
        Drive::new(
            self.kind,
            &self.robot,
            self.base_joints,
            &self.laws,
            self.dt_s,
        )
        .holding(&self.first_command(), &self.start)
    }
}

fn first_of(command: &JointCommand, dof: usize) -> Vec<f64> {
    let (mut position, mut velocity) = (vec![0.0; dof], vec![0.0; dof]);
    command.at(0.0, &mut position, &mut velocity);
    position
}

/// Friction of every joint: `robot.toml`'s dry friction, which belongs to the drive, and the effects'.
fn friction(altered: &Altered, kind: DriveKind) -> Vec<LinkFriction> {
    (altered.robot.chain.joints.iter().zip(&altered.friction))
        .map(|(joint, effect)| {
            let of_drive = match kind {
                DriveKind::Force => 0.0,
                _ => joint.transmission.dry_friction,
            };
            LinkFriction {
                dry: effect.dry.map(|dry| of_drive + dry),
                ..*effect
            }
        })
        .collect()
}

/// The robot with its transmissions as stiff as they get at the start, for choosing the step.
fn stiffest(robot: &Robot, laws: &[JointLaw], start: &[f64], command: &JointCommand) -> Robot {
    let mut stiff = robot.clone();
    let command = first_of(command, robot.dof());
    for (i, (joint, law)) in stiff.chain.joints.iter_mut().zip(laws).enumerate() {
        let windup = law.seen(command[i]) - start[i];
        let beyond = windup - windup.clamp(-0.5 * law.gap, 0.5 * law.gap);
        let added = law.hysteresis.map_or(0.0, |h| h.largest_stiffness())
            + (3.0 * law.cubic * beyond * beyond).max(0.0);
        if added > 0.0 {
            let stiffness = &mut joint.transmission.stiffness;
            *stiffness = stiffness.map(|k| k + added);
        }
    }
    stiff
}

pub(crate) fn load_robot(spec: &RobotSpec) -> Result<Robot, SimError> {
    let robot = Robot::load(&spec.urdf, spec.config.as_deref(), spec.tip.as_deref())?;
    crate::adjust::adjusted(&robot, spec)
}

/// Of each joint of the scenario's robot whether it is rotary; chooses the keys of
/// [`Scenario::extended_text`].
///
/// # Errors
/// Whatever is wrong with the robot's files.
pub fn rotary_joints(scenario: &Scenario) -> Result<Vec<bool>, SimError> {
    let robot = load_robot(&scenario.robot)?;
    Ok((robot.chain.joints.iter())
        .map(|joint| joint.kind == JointKind::Revolute)
        .collect())
}

fn drive_kind(spec: &RobotSpec, robot: &Robot) -> Result<DriveKind, SimError> {
    let kind = match spec.drive {
        DriveSpec::Position => DriveKind::Position,
        DriveSpec::Servo => DriveKind::Servo,
        DriveSpec::Force => DriveKind::Force,
    };
    if kind == DriveKind::Force {
        return Ok(kind);
    }
    robot.transmission_stiffness("a driven arm")?;
    for joint in &robot.chain.joints {
        let t = &joint.transmission;
        if kind == DriveKind::Servo && t.rigid_servo {
            if t.rotor_inertia > 0.0 {
                return Err(SimError::scenario(
                    "robot.drive",
                    format!(
                        "joint `{}` has a servo and no transmission stiffness, so its rotor moves with the \
                         link, but robot.toml gives a rotor inertia of {}: make it part of the link",
                        joint.name, t.rotor_inertia
                    ),
                ));
            }
            continue;
        }
        if kind == DriveKind::Servo && (t.servo.is_none() || t.rotor_inertia <= 0.0) {
            return Err(SimError::scenario(
                "robot.drive",
                format!(
                    "the drive is \"servo\", but joint `{}` has {}: robot.toml must give both a \
                     servo and a positive rotor inertia for every joint",
                    joint.name,
                    if t.servo.is_none() {
                        "no servo gains".to_string()
                    } else {
                        format!("a rotor inertia of {}", t.rotor_inertia)
                    }
                ),
            ));
        }
    }
    Ok(kind)
}

fn command(
    robot: &Robot,
    posture: &[f64],
    world_from_process: &Isometry3<f64>,
    process: &dyn Process,
    duration_s: f64,
    sag: Option<&Load>,
) -> Result<JointCommand, SimError> {
    let speed = process.feed_along_y_m_per_s();
    if speed == 0.0 {
        return Ok(JointCommand::Hold(match sag {
            Some(load) => robot.holding_command(posture, load)?,
            None => posture.to_vec(),
        }));
    }
    StraightPath::solve(robot, posture, world_from_process, speed, duration_s, sag)
        .map(JointCommand::Along)
}

/// The posture at rest under gravity and the process's static loads; friction is unloaded.
fn touch_down(
    altered: &Altered,
    command: &JointCommand,
    process: &dyn Process,
    world_from_process: &Isometry3<f64>,
    gravity: &Load,
) -> Result<Vec<f64>, SimError> {
    let robot = &altered.robot;
    let position = first_of(command, robot.dof());
    let wrenches = process.static_loads().wrenches;
    let (attachment, wrench) = combine(robot, &position, &wrenches, world_from_process);
    let load = gravity.with_wrench(attachment.into(), wrench);
    effect::at_rest(altered, &position, &load)
}

/// All wrenches as one, in world axes: at the frame they share, or at the tool.
fn combine(
    robot: &Robot,
    q: &[f64],
    wrenches: &[Wrench],
    world_from_process: &Isometry3<f64>,
) -> (Attachment, Vector6<f64>) {
    let at = |a: Attachment| robot.world_from_frame(q, a.into()).translation.vector;
    let shared = wrenches.first().map_or(Attachment::Tool, |w| w.frame);
    let target = if wrenches.iter().all(|w| w.frame == shared) {
        shared
    } else {
        Attachment::Tool
    };
    let mut total = Vector6::zeros();
    for wrench in wrenches {
        let force = world_from_process.rotation * wrench.force_n;
        let lever = at(wrench.frame) - at(target);
        let moment = world_from_process.rotation * wrench.moment_n_m + lever.cross(&force);
        let mut rows = total.fixed_rows_mut::<3>(0);
        rows += force;
        let mut rows = total.fixed_rows_mut::<3>(3);
        rows += moment;
    }
    (target, total)
}

/// What is known of the plant before the run.
pub(crate) fn plant_scalars(prepared: &Prepared) -> Vec<Scalar> {
    let mut scalars = vec![Scalar::new(
        "run.time_step",
        Unit::Second,
        prepared.dt_s,
        "Time step of the run",
    )];
    if let Ok(modes) = prepared.robot.modes(&prepared.start, None) {
        for (i, f) in modes.frequency_hz.iter().enumerate() {
            scalars.push(Scalar::new(
                format!("plant.mode{}_frequency", i + 1),
                Unit::Hertz,
                *f,
                "Natural frequency of the free arm at the start",
            ));
        }
    }
    scalars
}
