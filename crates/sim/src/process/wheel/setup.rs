//! From the table of a wheel to the process that runs.

use super::Wheel;
use crate::effect::WheelEffects;
use crate::error::SimError;
use crate::process::{ProcessSetup, SetupContext};
use crate::scene::{Tooling, shapes};
use truecut_core::wheel::WheelContact;
use truecut_scenario::WheelSpec;

/// The process of a scenario, and its workpiece.
pub(crate) fn setup(
    spec: &WheelSpec,
    context: &SetupContext<'_>,
) -> Result<ProcessSetup, SimError> {
    let process = Wheel::new(wheel(spec, &context.effects.wheel));
    let length_m = spec.strip_length_m;
    let wheel = [spec.contact.radius_m, spec.contact.width_m];
    let made = ProcessSetup::new(process, context.posture()?).holding(Tooling::disc(wheel));
    Ok(made.on(move || shapes::strip(length_m)))
}

fn wheel(spec: &WheelSpec, effects: &WheelEffects) -> WheelSpec {
    let [at_start, quarter_later] = effects.eccentricity_m;
    WheelSpec {
        contact: WheelContact {
            stiffness_n_per_m: spec.contact.stiffness_n_per_m * effects.stiffness_factor,
            mu: spec.contact.mu * effects.friction_factor,
            eccentricity_m: spec.contact.eccentricity_m + quarter_later,
            eccentricity_at_start_m: at_start,
            ..spec.contact
        },
        preston_per_pa: spec.preston_per_pa * effects.removal_factor,
        ..*spec
    }
}
