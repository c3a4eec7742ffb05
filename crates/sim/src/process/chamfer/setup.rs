//! From the table of a chamfer to the process that runs.

use super::{Chamfer, ChamferParameters, SlipTheory};
use crate::effect::{CuttingEffects, Effects};
use crate::error::SimError;
use crate::process::foot::setup::{foot, foot_spring};
use crate::process::{ProcessSetup, SetupContext};
use crate::scene::{Tooling, shapes};
use crate::theory;
use nalgebra::{Matrix3, Vector2};
use truecut_arm::axial_lateral_coupling;
use truecut_core::cutting::chamfer::{CuttingCoefficients, FeedSchedule};
use truecut_core::cutting::slip_condition::{ArmCoupling, Cut};
use truecut_scenario::{ChamferSpec, FeedDirection, FootSpec};

/// The process of a scenario, and its workpiece.
pub(crate) fn setup(
    spec: &ChamferSpec,
    context: &SetupContext<'_>,
) -> Result<ProcessSetup, SimError> {
    let posture = context.posture()?;
    let compliance = context.compliance(&posture)?;
    let nominal = chamfer_parameters(spec, &compliance, &Effects::default());
    let theory = match &spec.foot {
        // With several edges nothing rotates, and the conditions have nothing to say.
        Some(foot_spec) if spec.schedule.edges == 1 => {
            slip_theory(&nominal, foot_spec, &compliance)
        }
        _ => None,
    };
    let parameters = chamfer_parameters(spec, &compliance, context.effects);
    let (hole_m, backward) = (
        spec.hole_radius_m,
        spec.direction == FeedDirection::Backward,
    );
    let process = Chamfer::new(parameters, theory);
    let mut tooling = Tooling::countersink(hole_m, spec.chip.tan(), backward);
    if spec.foot.is_some() {
        // It presses on the robot's side of the plate.
        tooling = tooling.with_foot(if backward { -shapes::THICKNESS_M } else { 0.0 });
    }
    let made = ProcessSetup::new(process, posture).holding(tooling);
    Ok(made.on(move || shapes::plate_with_hole(hole_m, backward)))
}

fn chamfer_parameters(
    spec: &ChamferSpec,
    compliance: &Matrix3<f64>,
    effects: &Effects,
) -> ChamferParameters {
    let cut = &effects.cutting;
    ChamferParameters {
        effects: *cut,
        cut: ChamferSpec {
            // A spindle that is off turns under a feed that is not: the feed per revolution
            // changes.
            schedule: FeedSchedule {
                spindle_rad_s: spec.schedule.spindle_rad_s * cut.spindle_factor,
                feed_m_per_rev: spec.schedule.feed_m_per_rev / cut.spindle_factor,
                ..spec.schedule
            },
            coefficients: coefficients(&spec.coefficients, cut),
            ..*spec
        },
        foot: (spec.foot.as_ref())
            .map(|one| foot(one, compliance, cut.spindle_factor, &effects.foot)),
    }
}

fn coefficients(nominal: &CuttingCoefficients, effects: &CuttingEffects) -> CuttingCoefficients {
    let [axial, radial, tangential] = effects.edge_n_per_m;
    let factor = effects.coefficient_factor;
    CuttingCoefficients {
        axial_pa: nominal.axial_pa * factor,
        radial_pa: nominal.radial_pa * factor,
        tangential_pa: nominal.tangential_pa * factor,
        edge_axial_n_per_m: nominal.edge_axial_n_per_m + axial,
        edge_radial_n_per_m: nominal.edge_radial_n_per_m + radial,
        edge_tangential_n_per_m: nominal.edge_tangential_n_per_m + tangential,
    }
}

fn slip_theory(
    parameters: &ChamferParameters,
    spec: &FootSpec,
    compliance: &Matrix3<f64>,
) -> Option<SlipTheory> {
    let foot = parameters.foot.as_ref()?;
    // On an arm that is rigid to one side no lateral force of a held foot is known.
    let lateral = axial_lateral_coupling(compliance).ok()?;
    let across = compliance.fixed_view::<1, 2>(0, 1);
    let held_compliance = compliance[(0, 0)] - (across * lateral)[0];
    let arm = ArmCoupling {
        axial_stiffness_n_per_m: 1.0 / held_compliance,
        lateral_per_axial: lateral,
        // The foot touches down with its friction unloaded.
        stored_lateral_n: Vector2::zeros(),
    };
    let cut = Cut {
        chip: parameters.cut.chip,
        coefficients: parameters.cut.coefficients,
        feed_m: parameters.cut.schedule.feed_m_per_rev,
        axial_sign: parameters.cut.direction.axial_sign(),
    };
    let axial = 1.0 / compliance[(0, 0)];
    theory::predict(
        &cut,
        &spec.cylinders,
        |pressure| foot_spring(spec, pressure, axial),
        &foot.friction,
        &arm,
        // The last tooth meets this depth already cut.
        parameters.cut.schedule.depth_m - parameters.cut.schedule.feed_per_tooth_m(),
    )
}
