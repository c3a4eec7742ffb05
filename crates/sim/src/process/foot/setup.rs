//! From a scenario's pressure foot to the foot that runs.

use super::{FootParameters, with_effects};
use crate::effect::FootEffects;
use nalgebra::Matrix3;
use truecut_core::friction::{EquivalentViscous, FootFriction};
use truecut_core::pressure_foot::{
    AMBIENT_PRESSURE_PA, Cylinders, PressureFoot, stiffness_for_share,
};
use truecut_scenario::FootSpec;

/// The foot at a pressure; `axial_n_per_m` is the arm's axial stiffness, for a foot given by its
/// share.
pub(crate) fn foot_spring(spec: &FootSpec, pressure_pa: f64, axial_n_per_m: f64) -> PressureFoot {
    let cylinders = Cylinders {
        pressure_pa,
        ..spec.cylinders
    };
    PressureFoot {
        preload_n: cylinders.preload_n(),
        gas_stiffness_n_per_m: match spec.axial_share {
            None => cylinders.gas_stiffness_n_per_m(),
            Some(share) => stiffness_for_share(share, axial_n_per_m),
        },
        seal_stiction_n: spec.seal_stiction_n,
        rod_stiffness_n_per_m: spec.rod_stiffness_n_per_m,
    }
}

/// The foot on an arm. What shakes it turns `spindle_factor` times as fast as the scenario says.
pub(crate) fn foot(
    spec: &FootSpec,
    compliance: &Matrix3<f64>,
    spindle_factor: f64,
    effects: &FootEffects,
) -> FootParameters {
    let pressure_pa = spec.cylinders.pressure_pa;
    let mut spring = foot_spring(spec, pressure_pa, 1.0 / compliance[(0, 0)]);
    spring.seal_stiction_n = (spring.seal_stiction_n + effects.seal_stiction_n).max(0.0);
    let friction = match spec.friction {
        FootFriction::Equivalent(law) => FootFriction::Equivalent(EquivalentViscous {
            frequency_rad_s: law.frequency_rad_s * spindle_factor,
            ..law
        }),
        law => law,
    };
    FootParameters {
        spring,
        pressure_loss_per_s: effects.pressure_loss_per_s,
        gauge_share: match spec.axial_share {
            None => pressure_pa / (pressure_pa + AMBIENT_PRESSURE_PA),
            Some(_) => 0.0,
        },
        friction: with_effects(friction, effects),
    }
}
