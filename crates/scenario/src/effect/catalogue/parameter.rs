//! Parameters of the catalogue, written short.

use super::ParameterInfo;
use truecut_recording::Unit;

/// A size whose key does not depend on the kind of joint.
pub(super) const fn same(
    key: &'static str,
    unit: Unit,
    neutral: f64,
    min: f64,
    max: f64,
) -> ParameterInfo {
    joint(key, unit, key, unit, neutral, min, max)
}

/// The size of what is so many times its nominal value.
pub(super) const fn factor(min: f64, max: f64) -> ParameterInfo {
    same("factor", Unit::One, 1.0, min, max)
}

/// A size with one key for prismatic and one for rotary joints.
pub(super) const fn joint(
    key: &'static str,
    unit: Unit,
    rotary_key: &'static str,
    rotary_unit: Unit,
    neutral: f64,
    min: f64,
    max: f64,
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
        description: "",
    }
}

/// With its meaning.
pub(super) const fn described(info: ParameterInfo, description: &'static str) -> ParameterInfo {
    ParameterInfo {
        description,
        ..info
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

/// Values in equal ratios.
pub(super) const fn geometric<const N: usize>(first: f64, ratio: f64) -> [f64; N] {
    let mut values = [first; N];
    let mut i = 1;
    while i < N {
        values[i] = values[i - 1] * ratio;
        i += 1;
    }
    values
}
