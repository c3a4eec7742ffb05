//! What the slip conditions of the core say of a chamfering pass on a given arm.

use crate::process::SlipTheory;
use truecut_core::cutting::slip_condition::{
    ArmCoupling, Cut, first_slip_depth_m, general_threshold_pa,
};
use truecut_core::friction::FootFriction;
use truecut_core::pressure_foot::{Cylinders, PressureFoot};

/// No foot presses harder than this; thresholds above it are not reported, Pa.
const HIGHEST_PRESSURE_PA: f64 = 1e8;

/// Prediction for one pass.
///
/// `foot_at` gives the foot at a pressure (its gas grows stiffer with it).
pub(crate) fn predict(
    cut: &Cut,
    cylinders: &Cylinders,
    foot_at: impl Fn(f64) -> PressureFoot,
    friction: &FootFriction,
    arm: &ArmCoupling,
    depth_m: f64,
) -> Option<SlipTheory> {
    let mu = match friction {
        FootFriction::Law(law) => law.holding_coefficient(),
        FootFriction::Equivalent(e) => e.mu,
    };
    if mu <= 0.0 {
        return None;
    }
    let foot = foot_at(cylinders.pressure_pa);
    let area = cylinders.count * cylinders.piston_area_m2();
    let axial = cut.axial_sign * cut.axial_force_n(depth_m);
    let (carried, _) = foot.share_of_axial_force(axial, arm.axial_stiffness_n_per_m);
    let axial_share = carried / axial;
    Some(SlipTheory {
        // The rule is about an axial force that presses the foot on; it says nothing of forward
        // feed.
        paper_threshold_pa: if cut.axial_sign > 0.0 {
            cut.paper_threshold_pa(depth_m, mu, area).max(0.0)
        } else {
            f64::NAN
        },
        exact_threshold_pa: (cut.exact_threshold_pa(depth_m, mu, axial_share, area)).max(0.0),
        general_threshold_pa: general_threshold_pa(
            cut,
            foot_at,
            arm,
            mu,
            depth_m,
            HIGHEST_PRESSURE_PA,
        )
        .unwrap_or(f64::NAN),
        slip_depth_m: first_slip_depth_m(cut, &foot, arm, mu, depth_m).unwrap_or(f64::NAN),
        axial_share,
        lateral_per_axial: arm.lateral_per_axial.norm(),
    })
}
