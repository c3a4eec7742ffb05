//! From a scenario to everything that a cell is made of.

use crate::command::{JointCommand, StraightPath};
use crate::error::SimError;
use crate::loads::{Attachment, Wrench};
use crate::plant::{Drive, DriveKind};
use crate::process::Process;
use crate::replay::forward::ForwardInputs;
use crate::scene::Workpiece;
use crate::step_size;
use crate::translate::build_process;
use nalgebra::{Isometry3, Vector3, Vector6};
use truecut_arm::{FrameId, JointKind, Load, Robot};
use truecut_recording::Measured;
use truecut_scenario::{Drive as DriveSpec, RobotSpec, Scenario};

/// A scenario resolved against its robot, before any engine is built.
pub(crate) struct Prepared {
    pub robot: Robot,
    pub kind: DriveKind,
    pub gravity_m_s2: Vector3<f64>,
    /// Posture asked for, at which the process frame is taken.
    pub posture: Vec<f64>,
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
        let spec = &scenario.robot;
        let robot = load_robot(spec)?;
        let kind = drive_kind(spec, &robot)?;
        let gravity_m_s2 = if spec.gravity {
            truecut_arm::standard_gravity_m_s2()
        } else {
            Vector3::zeros()
        };
        let replay = ForwardInputs::of(scenario, measured, &robot, kind)?;
        let posture = posture(spec, &robot)?;
        let posture = replay
            .as_ref()
            .map_or(posture.clone(), |replay| replay.posture(&posture));
        let mut world_from_process = robot.world_from_process(&posture);
        let (process, workpiece) = match &replay {
            Some(replay) => (
                Box::new(replay.process()) as Box<dyn Process>,
                Workpiece::None,
            ),
            None => build_process(scenario, &robot, kind, &posture, &world_from_process)?,
        };
        let duration_s =
            (replay.as_ref()).map_or(scenario.run.duration_s, ForwardInputs::duration_s);
        let gravity = Load::gravity(gravity_m_s2);
        let sag = (spec.hold_against_sag && kind != DriveKind::Force).then_some(&gravity);
        let command = match &replay {
            Some(replay) => replay.command(&posture),
            None => command(
                &robot,
                &posture,
                &world_from_process,
                process.as_ref(),
                duration_s,
                sag,
            )?,
        };
        check_limits(&robot, &command)?;
        let start = match kind {
            DriveKind::Force => posture.clone(),
            _ => touch_down(
                &robot,
                &command,
                process.as_ref(),
                &world_from_process,
                &gravity,
            )?,
        };
        let start = replay
            .as_ref()
            .map_or(start.clone(), |replay| replay.start(&start));
        let touched = robot.world_from_frame(&start, FrameId::Tool);
        world_from_process.translation = touched.translation;
        let fastest = match kind {
            DriveKind::Force => None,
            _ => Some(step_size::fastest_mode(
                &robot,
                &start,
                process.as_ref(),
                kind == DriveKind::Servo,
            )?),
        };
        let dt_s = step_size::choose(
            scenario.run.time_step_s,
            fastest,
            process.as_ref(),
            duration_s,
        )?;
        let notes = robot.chain.notes.clone();
        Ok(Self {
            robot,
            kind,
            gravity_m_s2,
            posture,
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
        let (mut position, mut velocity) = (self.posture.clone(), self.posture.clone());
        self.command.at(0.0, &mut position, &mut velocity);
        position
    }

    pub(crate) fn drive(&self) -> Drive {
        // A servo carries the static load of the start by feed-forward; its loops see only what changes.
        let command = self.first_command();
        let feed_forward = (self
            .robot
            .chain
            .joints
            .iter()
            .zip(&self.start)
            .zip(&command))
        .map(|((joint, q), c)| joint.transmission.stiffness.unwrap_or(0.0) * (c - q))
        .collect();
        Drive::new(self.kind, &self.robot, self.dt_s, feed_forward)
    }
}

pub(crate) fn load_robot(spec: &RobotSpec) -> Result<Robot, SimError> {
    let robot = Robot::load(&spec.urdf, spec.config.as_deref(), spec.tip.as_deref())?;
    let mut robot = robot.scaled(spec.inertia_scale, spec.stiffness_scale, spec.damping_scale);
    if spec.drive == DriveSpec::Servo {
        robot.close_rigid_servos();
    }
    Ok(robot)
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

/// Joint coordinates in chain order from the lists of rotary and prismatic ones.
fn posture(spec: &RobotSpec, robot: &Robot) -> Result<Vec<f64>, SimError> {
    let mut rotary = spec.posture_rad.iter();
    let mut prismatic = spec.posture_m.iter();
    let joints = &robot.chain.joints;
    for (key, kind, given) in [
        (
            "robot.posture_deg",
            JointKind::Revolute,
            spec.posture_rad.len(),
        ),
        (
            "robot.posture_mm",
            JointKind::Prismatic,
            spec.posture_m.len(),
        ),
    ] {
        let needed = joints.iter().filter(|j| j.kind == kind).count();
        if given != 0 && given != needed {
            let what = match kind {
                JointKind::Revolute => "rotary",
                JointKind::Prismatic => "prismatic",
            };
            return Err(SimError::scenario(
                key,
                format!("has {given} values, but the chain has {needed} {what} joints"),
            ));
        }
    }
    let posture: Vec<f64> = joints
        .iter()
        .map(|joint| match joint.kind {
            JointKind::Revolute => rotary.next().copied().unwrap_or(0.0),
            JointKind::Prismatic => prismatic.next().copied().unwrap_or(0.0),
        })
        .collect();
    check_posture(robot, &posture, "posture outside the limits")?;
    Ok(posture)
}

fn check_posture(robot: &Robot, posture: &[f64], what: &str) -> Result<(), SimError> {
    for (i, (joint, q)) in robot.chain.joints.iter().zip(posture).enumerate() {
        let Some(limits) = joint.limits else { continue };
        if *q < limits.lower || *q > limits.upper {
            let (key, factor, unit) = match joint.kind {
                JointKind::Revolute => ("robot.posture_deg", 180.0 / std::f64::consts::PI, "deg"),
                JointKind::Prismatic => ("robot.posture_mm", 1e3, "mm"),
            };
            return Err(SimError::scenario(
                key,
                format!(
                    "{what}: joint {} `{}` at {:.3} {unit}, limits {:.3} to {:.3} {unit}",
                    i + 1,
                    joint.name,
                    q * factor,
                    limits.lower * factor,
                    limits.upper * factor
                ),
            ));
        }
    }
    Ok(())
}

fn check_limits(robot: &Robot, command: &JointCommand) -> Result<(), SimError> {
    (command.postures().iter())
        .try_for_each(|posture| check_posture(robot, posture, "the command leaves the limits"))
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
    robot: &Robot,
    command: &JointCommand,
    process: &dyn Process,
    world_from_process: &Isometry3<f64>,
    gravity: &Load,
) -> Result<Vec<f64>, SimError> {
    let n = robot.dof();
    let (mut position, mut velocity) = (vec![0.0; n], vec![0.0; n]);
    command.at(0.0, &mut position, &mut velocity);
    let wrenches = process.static_loads().wrenches;
    let (attachment, wrench) = combine(robot, &position, &wrenches, world_from_process);
    let load = gravity.with_wrench(attachment.into(), wrench);
    Ok(robot.static_posture(&position, &load)?)
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
