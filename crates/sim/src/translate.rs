//! From the tables of a scenario to the processes and laws that run.

mod belt;
mod brush;
mod control;
mod milling;
mod polish;

pub(crate) use milling::nominal_cut;

use crate::effect::{CuttingEffects, Effects, FootEffects, WheelEffects};
use crate::error::SimError;
use crate::led_path::{LedPath, Over};
use crate::plant::DriveKind;
use crate::process::{
    Chamfer, ChamferParameters, FootFriction, FootParameters, Load as GivenLoad, LoadParameters,
    Milling, Process, Regeneration, RotatingForce, SlipTheory, Sweep, Wheel, WheelParameters,
};
use crate::scene::Workpiece;
use crate::theory;
use nalgebra::{Isometry3, Matrix3, Vector2, Vector3};
use truecut_arm::{FrameId, Robot, axial_lateral_coupling};
use truecut_core::cutting::chamfer::{ChipArea, CuttingCoefficients, FeedSchedule};
use truecut_core::cutting::slip_condition::{ArmCoupling, Cut};
use truecut_core::friction::{EquivalentViscous, FrictionLaw};
use truecut_core::pressure_foot::{
    AMBIENT_PRESSURE_PA, Cylinders, PressureFoot, stiffness_for_share,
};
use truecut_core::roughness::Polishing;
use truecut_core::wheel::WheelContact;
use truecut_scenario::{
    ChamferSpec, CuttingSpec, FeedDirection, FootSpec, FootSpring, FrictionSpec, LoadFrame,
    LoadSpec, ProcessSpec, Regeneration as RegenerationSpec, RoughnessSpec, Scenario, Spin,
    WheelSpec,
};

/// The process of a scenario on a robot at its posture, and what its workpiece looks like. `led` is the way that it is
/// led along, if that is solved beforehand.
pub(crate) fn build_process(
    scenario: &Scenario,
    robot: &Robot,
    kind: DriveKind,
    posture: &[f64],
    world_from_process: &Isometry3<f64>,
    effects: &Effects,
    led: Option<&LedPath>,
) -> Result<(Box<dyn Process>, Workpiece), SimError> {
    let compliance = match kind {
        DriveKind::Force => None,
        _ => Some(robot.process_compliance(posture, FrameId::Foot)?),
    };
    let run_s = scenario.run.duration_s;
    let path_s = led.map_or(run_s, |path| path.duration_s.min(run_s));
    match &scenario.process {
        ProcessSpec::Chamfer(spec) => {
            let compliance = compliance.ok_or_else(|| needs_drive("chamfer"))?;
            let workpiece = Workpiece::Hole(spec.hole_diameter_m / 2.0);
            Ok((Box::new(chamfer(spec, &compliance, effects)?), workpiece))
        }
        ProcessSpec::Wheel(spec) => {
            compliance.ok_or_else(|| needs_drive("wheel"))?;
            let workpiece = Workpiece::Strip(spec.strip_length_m);
            Ok((Box::new(Wheel::new(wheel(spec, &effects.wheel))), workpiece))
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
                &effects.foot,
            );
            Ok((Box::new(GivenLoad::new(process)), Workpiece::None))
        }
        ProcessSpec::Milling(spec) => {
            compliance.ok_or_else(|| needs_drive("milling"))?;
            let (setup, workpiece) = milling::milling(spec, robot, posture, world_from_process)?;
            Ok((Box::new(Milling::new(setup)), workpiece))
        }
        ProcessSpec::Polish(spec) => {
            compliance.ok_or_else(|| needs_drive("polish"))?;
            let (process, workpiece) = polish::polish(
                spec,
                &effects.wheel,
                robot,
                posture,
                world_from_process,
                path_s,
            )?;
            Ok((Box::new(process), workpiece))
        }
        ProcessSpec::Belt(spec) => {
            compliance.ok_or_else(|| needs_drive("belt"))?;
            let Some(Over::Lines(path)) = led.map(|path| &path.over) else {
                return Err(SimError::scenario(
                    "process.belt",
                    "the lines are not solved",
                ));
            };
            let (process, workpiece) =
                belt::belt(spec, &effects.wheel, path, world_from_process, path_s)?;
            Ok((Box::new(process), workpiece))
        }
        ProcessSpec::Brush(spec) => {
            compliance.ok_or_else(|| needs_drive("brush"))?;
            let Some(Over::Edges(work)) = led.map(|path| &path.over) else {
                return Err(SimError::scenario("process.brush", "the way is not solved"));
            };
            let (process, workpiece) = brush::brush(
                spec,
                &effects.wheel,
                work,
                robot,
                posture,
                world_from_process,
                path_s,
            );
            Ok((Box::new(process), workpiece))
        }
        ProcessSpec::Replay(_) => Err(SimError::scenario(
            "process.replay",
            "a replay needs its measured data",
        )),
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

fn foot(
    spec: &FootSpec,
    compliance: &Matrix3<f64>,
    frequency_rad_s: f64,
    effects: &FootEffects,
) -> FootParameters {
    let mut spring = foot_spring(spec, spec.pressure_pa, 1.0 / compliance[(0, 0)]);
    spring.seal_stiction_n = (spring.seal_stiction_n + effects.seal_stiction_n).max(0.0);
    FootParameters {
        spring,
        pressure_loss_per_s: effects.pressure_loss_per_s,
        gauge_share: match spec.spring {
            FootSpring::Gas { .. } => spec.pressure_pa / (spec.pressure_pa + AMBIENT_PRESSURE_PA),
            FootSpring::AxialShare(_) => 0.0,
        },
        friction: foot_friction(spec, frequency_rad_s, effects),
    }
}

fn foot_friction(spec: &FootSpec, frequency_rad_s: f64, effects: &FootEffects) -> FootFriction {
    let nominal = match spec.friction {
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
    };
    nominal.with_effects(effects)
}

fn chamfer(
    spec: &ChamferSpec,
    compliance: &Matrix3<f64>,
    effects: &Effects,
) -> Result<Chamfer, SimError> {
    let nominal = chamfer_parameters(spec, compliance, &Effects::default());
    let theory = match &spec.foot {
        // With several edges nothing rotates, and the conditions have nothing to say.
        Some(foot_spec) if spec.edges == 1 => slip_theory(&nominal, foot_spec, compliance)?,
        _ => None,
    };
    Ok(Chamfer::new(
        chamfer_parameters(spec, compliance, effects),
        theory,
    ))
}

fn chamfer_parameters(
    spec: &ChamferSpec,
    compliance: &Matrix3<f64>,
    effects: &Effects,
) -> ChamferParameters {
    let cut = &effects.cutting;
    // A spindle that is off turns under a feed that is not: the feed per revolution changes.
    let spindle_rad_s = spec.spindle_rad_s * cut.spindle_factor;
    ChamferParameters {
        effects: *cut,
        schedule: FeedSchedule {
            spindle_rad_s,
            feed_m_per_rev: spec.feed_m_per_rev / cut.spindle_factor,
            edges: spec.edges as usize,
            depth_m: spec.depth_m,
            dwell_revolutions: spec.dwell_revolutions,
        },
        chip: ChipArea::new(spec.half_angle_rad),
        coefficients: coefficients(&spec.cutting, cut),
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
        foot: (spec.foot.as_ref()).map(|f| foot(f, compliance, spindle_rad_s, &effects.foot)),
    }
}

fn coefficients(spec: &CuttingSpec, effects: &CuttingEffects) -> CuttingCoefficients {
    let [axial, radial, tangential] = effects.edge_n_per_m;
    let factor = effects.coefficient_factor;
    CuttingCoefficients {
        edge_axial_n_per_m: spec.edge_axial_n_per_m + axial,
        edge_radial_n_per_m: spec.edge_radial_n_per_m + radial,
        edge_tangential_n_per_m: spec.edge_tangential_n_per_m + tangential,
        ..CuttingCoefficients::from_resultant(
            spec.axial_pa * factor,
            spec.in_plane_pa * factor,
            spec.in_plane_angle_rad,
        )
    }
}

fn slip_theory(
    parameters: &ChamferParameters,
    spec: &FootSpec,
    compliance: &Matrix3<f64>,
) -> Result<Option<SlipTheory>, SimError> {
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
        stored_lateral_n: Vector2::zeros(),
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

fn wheel(spec: &WheelSpec, effects: &WheelEffects) -> WheelParameters {
    let [at_start, quarter_later] = effects.eccentricity_m;
    WheelParameters {
        contact: WheelContact {
            radius_m: spec.radius_m,
            width_m: spec.width_m,
            stiffness_n_per_m: spec.stiffness_n_per_m * effects.stiffness_factor,
            damping_n_s_per_m: spec.damping_n_s_per_m,
            mu: spec.mu * effects.friction_factor,
            runout_m: spec.runout_m + quarter_later,
            runout_at_start_m: at_start,
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
        preston_per_pa: spec.preston_per_pa * effects.removal_factor,
    }
}

fn load(
    spec: &LoadSpec,
    duration_s: f64,
    compliance: Option<&Matrix3<f64>>,
    world_from_process: &Isometry3<f64>,
    effects: &FootEffects,
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
        foot: (spec.foot.as_ref().zip(compliance)).map(|(f, c)| foot(f, c, turning, effects)),
    }
}

/// How a surface smooths.
fn polishing(spec: &RoughnessSpec) -> Polishing {
    Polishing {
        initial_m: spec.initial_m,
        final_m: spec.final_m,
        dose_j_per_m2: spec.dose_j_per_m2,
    }
}
