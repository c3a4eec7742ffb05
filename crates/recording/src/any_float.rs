//! Floats in a text format that knows no NaN: such values travel as the words `NaN`, `inf`, `-inf`.

use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum AnyFloat {
    Finite(f64),
    Word(String),
}

impl From<f64> for AnyFloat {
    fn from(value: f64) -> AnyFloat {
        if value.is_finite() {
            AnyFloat::Finite(value)
        } else {
            AnyFloat::Word(value.to_string())
        }
    }
}

impl AnyFloat {
    fn value<E: serde::de::Error>(self) -> Result<f64, E> {
        match self {
            AnyFloat::Finite(value) => Ok(value),
            AnyFloat::Word(word) => word.parse().map_err(E::custom),
        }
    }
}

/// For a field of type `f64`.
pub(crate) mod one {
    use super::AnyFloat;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        AnyFloat::from(*value).serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        AnyFloat::deserialize(deserializer)?.value()
    }
}

/// For a field of type `Vec<f64>`.
pub(crate) mod many {
    use super::AnyFloat;
    use serde::{Deserialize, Deserializer, Serializer};

    pub(crate) fn serialize<S: Serializer>(
        values: &[f64],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(values.iter().copied().map(AnyFloat::from))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<f64>, D::Error> {
        Vec::<AnyFloat>::deserialize(deserializer)?
            .into_iter()
            .map(AnyFloat::value)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::{Profile, Unit};

    #[test]
    fn what_is_not_finite_survives_json() {
        let profile = Profile {
            name: "chamfer.width".into(),
            description: "by angle".into(),
            axis_name: "rim_angle".into(),
            axis_unit: Unit::Radian,
            axis: vec![0.0, 1.0, 2.0, 3.0],
            unit: Unit::Metre,
            values: vec![1e-3, f64::INFINITY, f64::NEG_INFINITY, f64::NAN],
        };
        let text = serde_json::to_string(&profile).unwrap();
        assert!(
            text.contains(r#""values":[0.001,"inf","-inf","NaN"]"#),
            "{text}"
        );
        let back: Profile = serde_json::from_str(&text).unwrap();
        assert_eq!(back.axis, profile.axis);
        assert_eq!(back.values[..3], profile.values[..3]);
        assert!(back.values[3].is_nan());
        assert!(serde_json::from_str::<Profile>(&text.replace("NaN", "none")).is_err());
    }
}
