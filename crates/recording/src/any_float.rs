//! Floats in a text format that knows numbers only: what is none is `null`, and a status beside it
//! says whether it is missing or infinite. Words in a number's place (`NaN`, `inf`, `-inf`), as
//! earlier versions wrote them, are read.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Why there is no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NumberStatus {
    /// There is none.
    Missing,
    /// It is beyond all bounds.
    Infinite,
    /// It is below all bounds.
    NegativeInfinite,
}

impl NumberStatus {
    /// `None` of a number.
    #[must_use]
    pub fn of(value: f64) -> Option<NumberStatus> {
        match value {
            f64::INFINITY => Some(NumberStatus::Infinite),
            f64::NEG_INFINITY => Some(NumberStatus::NegativeInfinite),
            value if value.is_nan() => Some(NumberStatus::Missing),
            _ => None,
        }
    }

    /// The number that it stands for.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            NumberStatus::Missing => f64::NAN,
            NumberStatus::Infinite => f64::INFINITY,
            NumberStatus::NegativeInfinite => f64::NEG_INFINITY,
        }
    }
}

fn number(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

#[derive(Deserialize)]
#[serde(untagged)]
enum AnyFloat {
    Number(Option<f64>),
    Word(String),
}

impl AnyFloat {
    fn value<E: serde::de::Error>(self) -> Result<f64, E> {
        match self {
            AnyFloat::Number(value) => Ok(value.unwrap_or(f64::NAN)),
            AnyFloat::Word(word) => word.parse().map_err(E::custom),
        }
    }
}

/// A module for a flattened field of type `f64`: the number and, if it is none, its status.
macro_rules! stated {
    ($module:ident, $name:literal, $status:literal) => {
        pub(crate) mod $module {
            use super::{AnyFloat, NumberStatus, number};
            use serde::{Deserialize, Deserializer, Serialize, Serializer};

            #[derive(Serialize)]
            struct Written {
                #[serde(rename = $name)]
                value: Option<f64>,
                #[serde(rename = $status, skip_serializing_if = "Option::is_none")]
                status: Option<NumberStatus>,
            }

            #[derive(Deserialize)]
            struct Read {
                #[serde(rename = $name)]
                value: AnyFloat,
                #[serde(rename = $status)]
                status: Option<NumberStatus>,
            }

            pub(crate) fn serialize<S: Serializer>(
                value: &f64,
                serializer: S,
            ) -> Result<S::Ok, S::Error> {
                let (value, status) = (number(*value), NumberStatus::of(*value));
                Written { value, status }.serialize(serializer)
            }

            pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
                deserializer: D,
            ) -> Result<f64, D::Error> {
                let read = Read::deserialize(deserializer)?;
                match read.status {
                    Some(status) => Ok(status.value()),
                    None => read.value.value(),
                }
            }
        }
    };
}

stated!(value, "value", "value_status");
stated!(limit, "limit", "limit_status");
stated!(share, "share", "share_status");
stated!(amplitude, "amplitude_m", "amplitude_status");

/// As [`value`], of type `Option<f64>`; `None` is missing.
pub(crate) mod option {
    use serde::{Deserializer, Serializer};

    pub(crate) fn serialize<S: Serializer>(
        value: &Option<f64>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        super::value::serialize(&value.unwrap_or(f64::NAN), serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<f64>, D::Error> {
        let value = super::value::deserialize(deserializer)?;
        Ok((!value.is_nan()).then_some(value))
    }
}

/// Infinite ones among numbers, by their places; the others that are no numbers are missing.
type Infinite = BTreeMap<String, NumberStatus>;

fn infinite(values: &[f64]) -> Infinite {
    let status = |(place, value): (usize, &f64)| {
        let status = NumberStatus::of(*value);
        let status = status.filter(|status| *status != NumberStatus::Missing)?;
        Some((place.to_string(), status))
    };
    values.iter().enumerate().filter_map(status).collect()
}

fn restored<E: serde::de::Error>(read: Vec<AnyFloat>, infinite: Infinite) -> Result<Vec<f64>, E> {
    let values: Result<Vec<f64>, E> = read.into_iter().map(AnyFloat::value).collect();
    let mut values = values?;
    for (place, status) in infinite {
        let value = place.parse().ok();
        let value = value.and_then(|at: usize| values.get_mut(at));
        let missing = || E::custom(format!("there is no number {place}, whose status is given"));
        *value.ok_or_else(missing)? = status.value();
    }
    Ok(values)
}

/// A module for a flattened field of type `Vec<f64>`: the numbers and the places of infinite ones.
macro_rules! stated_list {
    ($module:ident, $name:literal, $status:literal) => {
        pub(crate) mod $module {
            use super::{AnyFloat, Infinite, infinite, number, restored};
            use serde::{Deserialize, Deserializer, Serialize, Serializer};

            #[derive(Serialize)]
            struct Written {
                #[serde(rename = $name)]
                values: Vec<Option<f64>>,
                #[serde(rename = $status, skip_serializing_if = "Infinite::is_empty")]
                infinite: Infinite,
            }

            #[derive(Deserialize)]
            struct Read {
                #[serde(rename = $name)]
                values: Vec<AnyFloat>,
                #[serde(rename = $status, default)]
                infinite: Infinite,
            }

            pub(crate) fn serialize<S: Serializer>(
                values: &[f64],
                serializer: S,
            ) -> Result<S::Ok, S::Error> {
                let written = Written {
                    values: values.iter().copied().map(number).collect(),
                    infinite: infinite(values),
                };
                written.serialize(serializer)
            }

            pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
                deserializer: D,
            ) -> Result<Vec<f64>, D::Error> {
                let read = Read::deserialize(deserializer)?;
                restored(read.values, read.infinite)
            }
        }
    };
}

stated_list!(values, "values", "values_status");
stated_list!(axis, "axis", "axis_status");

#[cfg(test)]
mod tests {
    use crate::{Outcome, Profile, Scalar, Unit};

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
        for wanted in [
            r#""values":[0.001,null,null,null]"#,
            r#""values_status":{"1":"infinite","2":"negative_infinite"}"#,
        ] {
            assert!(text.contains(wanted), "{text}");
        }
        let back: Profile = serde_json::from_str(&text).unwrap();
        assert_eq!(back.axis, profile.axis);
        assert_eq!(back.values[..3], profile.values[..3]);
        assert!(back.values[3].is_nan());
        let beyond = text.replace(r#""2":"#, r#""9":"#);
        assert!(serde_json::from_str::<Profile>(&beyond).is_err());
        // As earlier versions wrote it.
        let words = r#""values":[0.001,"inf","-inf","NaN"]}"#;
        let words = format!("{}{words}", &text[..text.find(r#""values""#).unwrap()]);
        let back: Profile = serde_json::from_str(&words).unwrap();
        assert_eq!(back.values[..3], profile.values[..3]);
        assert!(serde_json::from_str::<Profile>(&words.replace("NaN", "none")).is_err());
    }

    #[test]
    fn infinite_and_missing_are_two_things() {
        for (value, wanted) in [
            (f64::INFINITY, r#""value":null,"value_status":"infinite""#),
            (
                f64::NEG_INFINITY,
                r#""value":null,"value_status":"negative_infinite""#,
            ),
            (f64::NAN, r#""value":null,"value_status":"missing""#),
            (0.25, r#""value":0.25,"description""#),
        ] {
            let scalar = Scalar::new("a", Unit::One, value, "");
            let text = serde_json::to_string(&scalar).unwrap();
            assert!(text.contains(wanted), "{text}");
            let back: Scalar = serde_json::from_str(&text).unwrap();
            assert!(back.value.total_cmp(&value).is_eq(), "{text}");
        }
        let outcome = Outcome::Diverged {
            time_s: 0.1,
            quantity: "coordinate".into(),
            value: f64::INFINITY,
            limit: 1.0,
            rule: "stays".into(),
        };
        let text = serde_json::to_string(&outcome).unwrap();
        assert!(
            text.contains(r#""value":null,"value_status":"infinite""#),
            "{text}"
        );
        assert_eq!(serde_json::from_str::<Outcome>(&text).unwrap(), outcome);
    }
}
