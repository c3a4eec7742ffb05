//! From a control table to the law that moves a wheel's carrier.

use crate::effect::WheelEffects;
use truecut_core::wheel::force_control::ForceControl;
use truecut_scenario::ControlSpec;

pub(super) fn control(spec: &ControlSpec, effects: &WheelEffects) -> ForceControl {
    match *spec {
        ControlSpec::Position { .. } => ForceControl::Position,
        ControlSpec::ConstantForce {
            force_n,
            damping_n_s_per_m,
            fastest_m_per_s,
            stroke_m,
        } => ForceControl::ConstantForce {
            force_n: force_n + effects.force_offset_n,
            damping_n_s_per_m,
            fastest_m_per_s,
            stroke_m,
            stiction_n: effects.force_stiction_n,
        },
        ControlSpec::Compliant {
            force_n,
            mass_kg,
            stiffness_n_per_m,
            damping_n_s_per_m,
            stroke_m,
        } => ForceControl::Compliant {
            mass_kg,
            stiffness_n_per_m,
            damping_n_s_per_m,
            preload_n: force_n + effects.force_offset_n,
            stroke_m,
            stiction_n: effects.force_stiction_n,
        },
    }
}
