//! Rows of the catalogue, written short.

use super::{Family, ParameterInfo, TargetKind};
use truecut_recording::Unit;

/// One kind of effect.
pub(super) struct Entry {
    pub name: &'static str,
    pub family: Family,
    pub target: TargetKind,
    pub description: &'static str,
    pub parameters: &'static [ParameterInfo],
}

/// A size whose key does not depend on the kind of joint.
pub(super) const fn same(
    key: &'static str,
    unit: Unit,
    neutral: f64,
    min: f64,
    max: f64,
    description: &'static str,
) -> ParameterInfo {
    joint(key, unit, key, unit, neutral, min, max, description)
}

/// The size of what is so many times its nominal value.
pub(super) const fn factor(min: f64, max: f64, description: &'static str) -> ParameterInfo {
    same("factor", Unit::One, 1.0, min, max, description)
}

/// A size with one key for prismatic and one for rotary joints.
#[expect(clippy::too_many_arguments, reason = "one row of a table")]
pub(super) const fn joint(
    key: &'static str,
    unit: Unit,
    rotary_key: &'static str,
    rotary_unit: Unit,
    neutral: f64,
    min: f64,
    max: f64,
    description: &'static str,
) -> ParameterInfo {
    ParameterInfo {
        key,
        rotary_key,
        unit,
        rotary_unit,
        neutral,
        min,
        max,
        is_size: true,
        starts: &[],
        description,
    }
}

impl ParameterInfo {
    /// A parameter that only shapes the effect.
    pub(super) const fn shape(self) -> ParameterInfo {
        ParameterInfo {
            is_size: false,
            ..self
        }
    }

    /// With values worth starting a search from.
    pub(super) const fn starts(self, starts: &'static [f64]) -> ParameterInfo {
        ParameterInfo { starts, ..self }
    }
}
