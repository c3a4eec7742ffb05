//! From a scenario to everything that a cell is made of.

mod place;
mod start;

use self::place::place_note;
use self::start::at_start;
use crate::command::JointCommand;
use crate::effect::{self, Altered, Effects};
use crate::engine::Engine;
use crate::error::SimError;
use crate::estimates;
use crate::measurement::Sensors;
use crate::plant::{Drive, JointLaw};
use crate::posture::check_limits;

use crate::process::{self, Process, ReadPart, SetupContext, Start};
use crate::robots::Robots;
use crate::scene::{DrawWorkpiece, Tooling};
use crate::step_size::{self, Scheme};
use nalgebra::{DMatrix, Isometry3, Vector3};
use std::sync::Arc;
use truecut_arm::{FrameId, Load, Masses, Robot};
use truecut_core::joint_law::{LinkFriction, beyond_gap};
use truecut_recording::{Measured, Scalar, Unit};
use truecut_scenario::{DriveKind, RobotSpec, RunSpec, Scenario};

/// What a run says of an arm with joints that others take along.
pub(crate) const NO_FOLLOWERS: &str = "a run moves every joint by itself and does not take such \
     an arm; truecut robot, path, program, posture and lobes do";

/// A scenario resolved against its robot, before any engine is built.
pub(crate) struct Prepared {
    /// The robot with the effects built in, joints of the base first.
    pub robot: Arc<Robot>,
    /// How many joints of the base there are.
    pub base_joints: usize,
    pub laws: Vec<JointLaw>,
    /// Damping between all motors and links, if the scenario gives that of modes.
    pub coupled_damping: Option<DMatrix<f64>>,
    /// Friction of every joint.
    pub friction: Vec<LinkFriction>,
    /// Channels that are not recorded as they are.
    pub sensors: Sensors,
    pub kind: DriveKind,
    pub gravity_m_s2: Vector3<f64>,
    /// Posture at rest after touch-down: the start of the run.
    pub start: Vec<f64>,
    pub world_from_process: Isometry3<f64>,
    pub command: JointCommand,
    pub process: Box<dyn Process>,
    pub workpiece: DrawWorkpiece,
    pub tooling: Tooling,
    pub part: ReadPart,
    /// Whether the arm follows a path that was solved as a whole, and over which normal.
    pub is_path: bool,
    pub surface_normal: Option<Vector3<f64>>,
    pub duration_s: f64,
    pub dt_s: f64,
    pub notes: Vec<String>,
}

/// Something that a process is asked for before any run, with the nominal robot.
pub(crate) fn in_context<T>(
    scenario: &Scenario,
    robots: &Robots,
    ask: impl FnOnce(&SetupContext<'_>) -> Result<T, SimError>,
) -> Result<T, SimError> {
    let nominal = robots.robot(&scenario.robot)?;
    nominal.refuse_followers(NO_FOLLOWERS)?;
    let effects = Effects::of(scenario, &nominal)?;
    let context = SetupContext {
        scenario,
        robot: &nominal,
        robots,
        kind: drive_kind(&scenario.robot, &nominal)?,
        effects: &effects,
        measured: None,
    };
    ask(&context)
}

impl Prepared {
    /// `measured` drives a replay; other processes make no use of it. Robots that have been read
    /// are not read again; the step is chosen for the engine.
    pub(crate) fn new(
        scenario: &Scenario,
        measured: Option<&Measured>,
        robots: &Robots,
        engine: Engine,
    ) -> Result<Self, SimError> {
        let spec = &scenario.robot;
        let nominal = robots.robot(spec)?;
        nominal.refuse_followers(NO_FOLLOWERS)?;
        let kind = drive_kind(spec, &nominal)?;
        let effects = Effects::of(scenario, &nominal)?;
        let level_m_s2 = gravity_m_s2(spec);
        let gravity_m_s2 = effects.gravity_on_base(level_m_s2);
        let made = process::set_up(&SetupContext {
            scenario,
            robot: &nominal,
            robots,
            kind,
            effects: &effects,
            measured,
        })?;
        let mut world_from_process = nominal.world_from_process(&made.posture);
        let duration_s = made.duration_s(scenario.run.duration_s);
        let gravity = Load::gravity(gravity_m_s2);
        // The controller knows the nominal robot only, on a level base; what it does not know shows
        // in the run.
        let level = Load::gravity(level_m_s2);
        let sag = (spec.hold_against_sag && kind != DriveKind::Force).then_some(&level);
        let command = made.command(&nominal, &world_from_process, duration_s, sag)?;
        check_limits(&nominal, &command)?;
        let mut altered = effect::alter(&nominal, &effects)?;
        let coupled_damping = coupled_damping(&nominal, &mut altered, &made.posture)?;
        let mut command = command.behind(altered.base_joints);
        let start = at_start(
            kind,
            &made,
            &altered,
            &mut command,
            &world_from_process,
            &gravity,
        )?;
        let path_note = made.note();
        let unfinished = made.unfinished(scenario.run.duration_s);
        let is_path = made.follows_path();
        let (tooling, surface_normal) = (made.tooling, made.surface_normal);
        let (mut process, workpiece, part) = (made.process, made.workpiece, made.part);
        let touched = altered.robot.world_from_frame(&start, FrameId::Tool);
        let unloaded = world_from_process.translation;
        world_from_process.translation = touched.translation;
        let dt_s = time_step(
            scenario,
            duration_s,
            engine,
            &altered,
            &start,
            &command,
            process.as_ref(),
        )?;
        process.begin(&Start {
            time_step_s: dt_s,
            tool_offset_m: world_from_process.rotation.inverse()
                * (touched.translation.vector - unloaded.vector),
        });
        let mut notes = altered.robot.chain.notes.clone();
        notes.extend(estimates::acting(spec, &nominal));
        notes.extend(scenario.notes());
        notes.extend(place_note(scenario, &nominal, &unloaded.vector));
        notes.extend(path_note);
        notes.extend(unfinished);
        notes.extend(process.notes());
        Ok(Self {
            friction: friction(&altered, kind),
            robot: Arc::new(altered.robot),
            base_joints: altered.base_joints,
            laws: altered.laws,
            coupled_damping,
            sensors: effects.sensors,
            kind,
            gravity_m_s2,
            start,
            world_from_process,
            command,
            process,
            workpiece,
            tooling,
            part,
            is_path,
            surface_normal,
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
        .with_coupled_damping(self.coupled_damping.clone())
        .holding(&self.first_command(), &self.start)
    }
}

/// Damping matrix of the modes that the scenario gives damping ratios, at a posture of the arm, in
/// place of the transmissions' damping; joints of the base keep theirs. Effects on the damping of
/// joints scale it from both sides.
fn coupled_damping(
    nominal: &Robot,
    altered: &mut Altered,
    posture: &[f64],
) -> Result<Option<DMatrix<f64>>, SimError> {
    if nominal.damping_ratios.is_empty() {
        return Ok(None);
    }
    let linear = nominal.linearised(posture, FrameId::Tool, &Load::none())?;
    let (n, base) = (altered.robot.dof(), altered.base_joints);
    altered.robot.damping_ratios.clear();
    let mut factors = Vec::with_capacity(nominal.dof());
    for (own, joint) in (nominal.chain.joints.iter()).zip(&mut altered.robot.chain.joints[base..]) {
        let before = own.transmission.damping;
        let now = std::mem::take(&mut joint.transmission.damping);
        let factor = if before > 0.0 { now / before } else { 1.0 };
        factors.push(factor.sqrt());
    }
    Ok(Some(DMatrix::from_fn(n, n, |r, c| {
        match (r.checked_sub(base), c.checked_sub(base)) {
            (Some(r), Some(c)) => factors[r] * factors[c] * linear.damping[(r, c)],
            _ => 0.0,
        }
    })))
}

pub(crate) fn gravity_m_s2(spec: &RobotSpec) -> Vector3<f64> {
    if spec.gravity {
        truecut_arm::standard_gravity_m_s2()
    } else {
        Vector3::zeros()
    }
}

fn first_of(command: &JointCommand, dof: usize) -> Vec<f64> {
    let (mut position, mut velocity) = (vec![0.0; dof], vec![0.0; dof]);
    command.at(0.0, &mut position, &mut velocity);
    position
}

/// Friction of every joint: `robot.toml`'s dry friction, which belongs to the drive, and the
/// effects'.
fn friction(altered: &Altered, kind: DriveKind) -> Vec<LinkFriction> {
    (altered.robot.chain.joints.iter().zip(&altered.friction))
        .map(|(joint, effect)| {
            let of_drive = match kind {
                DriveKind::Force => 0.0,
                _ => joint.transmission.dry_friction,
            };
            LinkFriction {
                dry: effect.dry.map(|dry| of_drive + dry),
                ..effect.clone()
            }
        })
        .collect()
}

/// The time step of a run of `duration_s` from these joints, s.
fn time_step(
    scenario: &Scenario,
    duration_s: f64,
    engine: Engine,
    altered: &Altered,
    start: &[f64],
    command: &JointCommand,
    process: &dyn Process,
) -> Result<f64, SimError> {
    let kind = scenario.robot.drive;
    let fastest = match kind {
        DriveKind::Force => None,
        _ => Some(step_size::fastest_mode(
            &stiffest(&altered.robot, &altered.laws, start, command),
            start,
            process,
            altered.base_joints,
            kind == DriveKind::Servo,
        )?),
    };
    let has_play = altered.laws.iter().any(|law| law.gap > 0.0);
    let scheme = Scheme::of(engine, has_play);
    let run = RunSpec {
        duration_s,
        ..scenario.run
    };
    step_size::choose(scheme, &run, fastest, process)
}

/// The robot with its transmissions as stiff as they get at the start, for choosing the step.
fn stiffest(robot: &Robot, laws: &[JointLaw], start: &[f64], command: &JointCommand) -> Robot {
    let mut stiff = robot.clone();
    let command = first_of(command, robot.dof());
    for (i, (joint, law)) in stiff.chain.joints.iter_mut().zip(laws).enumerate() {
        let windup = law.seen(command[i]) - start[i];
        let beyond = beyond_gap(windup, law.gap);
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
    let robot = Robot::read(&spec.urdf, &spec.reading(Masses::Needed))?;
    crate::adjust::adjusted(&robot, spec)
}

fn drive_kind(spec: &RobotSpec, robot: &Robot) -> Result<DriveKind, SimError> {
    let kind = spec.drive;
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
