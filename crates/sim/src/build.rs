//! From a scenario to everything that a cell is made of.

use crate::command::{JointCommand, StraightPath};
use crate::error::SimError;
use crate::loads::{Attachment, Wrench};
use crate::plant::{Drive, DriveKind};
use crate::process::{
    Chamfer, ChamferParameters, FootFriction, FootParameters, Load as GivenLoad, LoadParameters,
    Process, Regeneration, RotatingForce, Sweep, Wheel, WheelParameters,
};
use crate::scene::Workpiece;
use crate::{step_size, theory};
use nalgebra::{Isometry3, Matrix3, Vector3, Vector6};
use truecut_arm::{FrameId, JointKind, Load, Robot, axial_lateral_coupling};
use truecut_core::cutting::chamfer::{ChipArea, CuttingCoefficients, FeedSchedule};
use truecut_core::cutting::slip_condition::{ArmCoupling, Cut};
use truecut_core::friction::{EquivalentViscous, FrictionLaw};
use truecut_core::pressure_foot::{Cylinders, PressureFoot, stiffness_for_share};
use truecut_core::wheel::WheelContact;
use truecut_scenario::{
    ChamferSpec, Drive as DriveSpec, FeedDirection, FootSpec, FootSpring, FrictionSpec, LoadFrame,
    LoadSpec, ProcessSpec, Regeneration as RegenerationSpec, RobotSpec, Scenario, Spin, WheelSpec,
};

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
    pub(crate) fn new(scenario: &Scenario) -> Result<Self, SimError> {
        let spec = &scenario.robot;
        let robot = load_robot(spec)?;
        let kind = drive_kind(spec, &robot)?;
        let gravity_m_s2 = if spec.gravity {
            truecut_arm::standard_gravity_m_s2()
        } else {
            Vector3::zeros()
        };
        let posture = posture(spec, &robot)?;
        let mut world_from_process = robot.world_from_process(&posture);
        let (process, workpiece) =
            build_process(scenario, &robot, kind, &posture, &world_from_process)?;
        let duration_s = scenario.run.duration_s;
        let gravity = Load::gravity(gravity_m_s2);
        let sag = (spec.hold_against_sag && kind != DriveKind::Force).then_some(&gravity);
        let command = command(
            &robot,
            &posture,
            &world_from_process,
            process.as_ref(),
            duration_s,
            sag,
        )?;
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
        let touched = robot.world_from_frame(&start, FrameId::Tool);
        world_from_process.translation = touched.translation;
        let fastest = match kind {
            DriveKind::Force => None,
            _ => Some(step_size::fastest_mode_hz(
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

fn load_robot(spec: &RobotSpec) -> Result<Robot, SimError> {
    let robot = Robot::load(&spec.urdf, spec.config.as_deref(), spec.tip.as_deref())?;
    Ok(robot.scaled(spec.inertia_scale, spec.stiffness_scale, spec.damping_scale))
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

fn build_process(
    scenario: &Scenario,
    robot: &Robot,
    kind: DriveKind,
    posture: &[f64],
    world_from_process: &Isometry3<f64>,
) -> Result<(Box<dyn Process>, Workpiece), SimError> {
    let compliance = match kind {
        DriveKind::Force => None,
        _ => Some(robot.process_compliance(posture, FrameId::Foot)?),
    };
    match &scenario.process {
        ProcessSpec::Chamfer(spec) => {
            let compliance = compliance.ok_or_else(|| needs_drive("chamfer"))?;
            let workpiece = Workpiece::Hole(spec.hole_diameter_m / 2.0);
            Ok((Box::new(chamfer(spec, &compliance)?), workpiece))
        }
        ProcessSpec::Wheel(spec) => {
            compliance.ok_or_else(|| needs_drive("wheel"))?;
            let workpiece = Workpiece::Strip(spec.strip_length_m);
            Ok((Box::new(Wheel::new(wheel(spec))), workpiece))
        }
        ProcessSpec::Load(spec) => {
            if spec.foot.is_some() && compliance.is_none() {
                return Err(needs_drive("load.foot"));
            }
            let process = load(
                spec,
                scenario.run.duration_s,
                compliance.as_ref(),
                world_from_process,
            );
            Ok((Box::new(GivenLoad::new(process)), Workpiece::None))
        }
    }
}

fn needs_drive(process: &str) -> SimError {
    SimError::scenario(
        "robot.drive",
        format!(
            "drive = \"force\" leaves the joints free, but process.{process} presses against them"
        ),
    )
}

/// The foot at a pressure; `axial_n_per_m` is the arm's axial stiffness, for a foot given by its share.
fn foot_spring(spec: &FootSpec, pressure_pa: f64, axial_n_per_m: f64) -> PressureFoot {
    let cylinders = cylinders(spec, pressure_pa);
    PressureFoot {
        preload_n: cylinders.preload_n(),
        gas_stiffness_n_per_m: match spec.spring {
            FootSpring::Gas { .. } => cylinders.gas_stiffness_n_per_m(),
            FootSpring::AxialShare(share) => stiffness_for_share(share, axial_n_per_m),
        },
        seal_stiction_n: spec.seal_stiction_n,
        rod_stiffness_n_per_m: spec.rod_stiffness_n_per_m,
    }
}

fn cylinders(spec: &FootSpec, pressure_pa: f64) -> Cylinders {
    let (gas_length_m, polytropic_exponent) = match spec.spring {
        FootSpring::Gas {
            length_m,
            polytropic_exponent,
        } => (length_m, polytropic_exponent),
        FootSpring::AxialShare(_) => (f64::INFINITY, 1.0),
    };
    Cylinders {
        count: f64::from(spec.cylinders),
        bore_m: spec.bore_m,
        gas_length_m,
        pressure_pa,
        polytropic_exponent,
    }
}

fn foot(spec: &FootSpec, compliance: &Matrix3<f64>, frequency_rad_s: f64) -> FootParameters {
    FootParameters {
        spring: foot_spring(spec, spec.pressure_pa, 1.0 / compliance[(0, 0)]),
        friction: match spec.friction {
            FrictionSpec::None => FootFriction::Law(FrictionLaw::None),
            FrictionSpec::Coulomb { mu } => FootFriction::Law(FrictionLaw::Coulomb { mu }),
            FrictionSpec::Stribeck {
                mu,
                mu_static,
                stribeck_speed_m_per_s,
            } => FootFriction::Law(FrictionLaw::Stribeck {
                mu,
                mu_static,
                stribeck_speed_m_per_s,
            }),
            FrictionSpec::EquivalentViscous {
                mu,
                amplitude_floor_m,
            } => FootFriction::Equivalent(EquivalentViscous {
                mu,
                frequency_rad_s,
                amplitude_floor_m,
            }),
        },
    }
}

fn chamfer(spec: &ChamferSpec, compliance: &Matrix3<f64>) -> Result<Chamfer, SimError> {
    let c = &spec.cutting;
    let coefficients = CuttingCoefficients {
        edge_axial_n_per_m: c.edge_axial_n_per_m,
        edge_radial_n_per_m: c.edge_radial_n_per_m,
        edge_tangential_n_per_m: c.edge_tangential_n_per_m,
        ..CuttingCoefficients::from_resultant(c.axial_pa, c.in_plane_pa, c.in_plane_angle_rad)
    };
    let parameters = ChamferParameters {
        schedule: FeedSchedule {
            spindle_rad_s: spec.spindle_rad_s,
            feed_m_per_rev: spec.feed_m_per_rev,
            edges: spec.edges as usize,
            depth_m: spec.depth_m,
            dwell_revolutions: spec.dwell_revolutions,
        },
        chip: ChipArea {
            half_angle_rad: spec.half_angle_rad,
        },
        coefficients,
        axial_sign: match spec.direction {
            FeedDirection::Forward => -1.0,
            FeedDirection::Backward => 1.0,
        },
        start_angle_rad: spec.start_angle_rad,
        hole_radius_m: spec.hole_diameter_m / 2.0,
        regeneration: match spec.regeneration {
            RegenerationSpec::Off => Regeneration::Off,
            RegenerationSpec::Axial => Regeneration::Axial,
            RegenerationSpec::Full => Regeneration::Full,
        },
        foot: (spec.foot.as_ref()).map(|f| foot(f, compliance, spec.spindle_rad_s)),
    };
    let theory = match &spec.foot {
        // With several edges nothing rotates, and the conditions have nothing to say.
        Some(foot_spec) if spec.edges == 1 => slip_theory(&parameters, foot_spec, compliance)?,
        _ => None,
    };
    Ok(Chamfer::new(parameters, theory))
}

fn slip_theory(
    parameters: &ChamferParameters,
    spec: &FootSpec,
    compliance: &Matrix3<f64>,
) -> Result<Option<crate::process::SlipTheory>, SimError> {
    let Some(foot) = &parameters.foot else {
        return Ok(None);
    };
    let lateral = axial_lateral_coupling(compliance)?;
    let across = compliance.fixed_view::<1, 2>(0, 1);
    let held_compliance = compliance[(0, 0)] - (across * lateral)[0];
    let arm = ArmCoupling {
        axial_stiffness_n_per_m: 1.0 / held_compliance,
        lateral_per_axial: lateral,
        // The foot touches down with its friction unloaded.
        stored_lateral_n: nalgebra::Vector2::zeros(),
    };
    let cut = Cut {
        chip: parameters.chip,
        coefficients: parameters.coefficients,
        feed_m: parameters.schedule.feed_m_per_rev,
        axial_sign: parameters.axial_sign,
    };
    let axial = 1.0 / compliance[(0, 0)];
    Ok(theory::predict(
        &cut,
        &cylinders(spec, spec.pressure_pa),
        |pressure| foot_spring(spec, pressure, axial),
        &foot.friction,
        &arm,
        // The last tooth meets this depth already cut.
        parameters.schedule.depth_m - parameters.schedule.feed_per_tooth_m(),
    ))
}

fn wheel(spec: &WheelSpec) -> WheelParameters {
    WheelParameters {
        contact: WheelContact {
            radius_m: spec.radius_m,
            width_m: spec.width_m,
            stiffness_n_per_m: spec.stiffness_n_per_m,
            damping_n_s_per_m: spec.damping_n_s_per_m,
            mu: spec.mu,
            runout_m: spec.runout_m,
        },
        spin_rad_s: spec.spin_rad_s,
        surface_sign: match spec.spin {
            // Climb: at the contact the wheel's surface runs as the plate does under the advancing tool.
            Spin::Climb => -1.0,
            Spin::Against => 1.0,
        },
        normal_force_n: spec.normal_force_n,
        feed_m_per_s: spec.feed_m_per_s,
        strip_length_m: spec.strip_length_m,
        strip_cells: spec.strip_cells as usize,
        preston_per_pa: spec.preston_per_pa,
    }
}

fn load(
    spec: &LoadSpec,
    duration_s: f64,
    compliance: Option<&Matrix3<f64>>,
    world_from_process: &Isometry3<f64>,
) -> LoadParameters {
    let axes = |force: [f64; 3]| match spec.frame {
        LoadFrame::Process => Vector3::from(force),
        LoadFrame::World => world_from_process.rotation.inverse() * Vector3::from(force),
    };
    let turning = (spec.rotating.as_ref()).map_or(1.0, |r| std::f64::consts::TAU * r.frequency_hz);
    LoadParameters {
        constant_n: axes(spec.constant_n),
        release_n: axes(spec.release_n),
        sweep: spec.sweep.as_ref().map(|s| Sweep {
            amplitude_n: axes(s.amplitude_n),
            from_hz: s.from_hz,
            to_hz: s.to_hz,
            duration_s,
        }),
        rotating: spec.rotating.as_ref().map(|r| RotatingForce {
            amplitude_n: r.amplitude_n,
            frequency_hz: r.frequency_hz,
            start_angle_rad: r.start_angle_rad,
        }),
        foot: (spec.foot.as_ref().zip(compliance)).map(|(f, c)| foot(f, c, turning)),
    }
}
