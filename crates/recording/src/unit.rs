//! Units: SI inside, what an engineer writes outside.

mod words;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The unit of a channel, scalar or axis. Values are always SI; `Display` gives the symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Unit {
    /// Dimensionless.
    One,
    /// Length.
    Metre,
    /// Plane angle.
    Radian,
    /// Time.
    Second,
    /// Mass.
    Kilogram,
    /// Frequency.
    Hertz,
    /// Area.
    SquareMetre,
    /// Volume.
    CubicMetre,
    /// Velocity.
    MetrePerSecond,
    /// Acceleration.
    MetrePerSecondSquared,
    /// Angular velocity.
    RadianPerSecond,
    /// Angular acceleration.
    RadianPerSecondSquared,
    /// Force.
    Newton,
    /// Moment.
    NewtonMetre,
    /// Pressure, or cutting force per chip area.
    Pascal,
    /// Energy.
    Joule,
    /// Power.
    Watt,
    /// Translational stiffness, or edge force per length.
    NewtonPerMetre,
    /// Translational damping.
    NewtonSecondPerMetre,
    /// Rotary stiffness.
    NewtonMetrePerRadian,
    /// Rotary damping.
    NewtonMetreSecondPerRadian,
    /// Rotary inertia.
    KilogramSquareMetre,
    /// Translational compliance.
    MetrePerNewton,
    /// Rotary compliance.
    RadianPerNewtonMetre,
    /// Translational force per cube of a displacement.
    NewtonPerCubicMetre,
    /// Moment per cube of an angle.
    NewtonMetrePerCubicRadian,
    /// Relative growth per length.
    PerMetre,
    /// Relative change per time that is not a frequency.
    PerSecond,
    /// Absolute temperature.
    Kelvin,
    /// Electric current.
    Ampere,
}

/// What may be written for each unit: symbol, unit, factor to SI. The first symbol of a unit that
/// has the factor 1 is its own.
const SYMBOLS: &[(&str, Unit, f64)] = &[
    ("1", Unit::One, 1.0),
    ("%", Unit::One, 1e-2),
    ("m", Unit::Metre, 1.0),
    ("cm", Unit::Metre, 1e-2),
    ("mm", Unit::Metre, 1e-3),
    ("um", Unit::Metre, 1e-6),
    ("µm", Unit::Metre, 1e-6), // U+00B5, the micro sign
    ("μm", Unit::Metre, 1e-6), // U+03BC, the Greek letter
    ("nm", Unit::Metre, 1e-9),
    ("rad", Unit::Radian, 1.0),
    ("mrad", Unit::Radian, 1e-3),
    ("deg", Unit::Radian, std::f64::consts::PI / 180.0),
    ("°", Unit::Radian, std::f64::consts::PI / 180.0),
    ("s", Unit::Second, 1.0),
    ("ms", Unit::Second, 1e-3),
    ("us", Unit::Second, 1e-6),
    ("ns", Unit::Second, 1e-9),
    ("min", Unit::Second, 60.0),
    ("kg", Unit::Kilogram, 1.0),
    ("g", Unit::Kilogram, 1e-3),
    ("Hz", Unit::Hertz, 1.0),
    ("kHz", Unit::Hertz, 1e3),
    ("m^2", Unit::SquareMetre, 1.0),
    ("mm^2", Unit::SquareMetre, 1e-6),
    ("m^3", Unit::CubicMetre, 1.0),
    ("mm^3", Unit::CubicMetre, 1e-9),
    ("m/s", Unit::MetrePerSecond, 1.0),
    ("mm/s", Unit::MetrePerSecond, 1e-3),
    ("um/s", Unit::MetrePerSecond, 1e-6),
    ("µm/s", Unit::MetrePerSecond, 1e-6),
    ("m/min", Unit::MetrePerSecond, 1.0 / 60.0),
    ("m/s^2", Unit::MetrePerSecondSquared, 1.0),
    ("rad/s", Unit::RadianPerSecond, 1.0),
    ("deg/s", Unit::RadianPerSecond, std::f64::consts::PI / 180.0),
    ("rpm", Unit::RadianPerSecond, std::f64::consts::PI / 30.0),
    ("rad/s^2", Unit::RadianPerSecondSquared, 1.0),
    (
        "deg/s^2",
        Unit::RadianPerSecondSquared,
        std::f64::consts::PI / 180.0,
    ),
    ("N", Unit::Newton, 1.0),
    ("mN", Unit::Newton, 1e-3),
    ("kN", Unit::Newton, 1e3),
    ("kgf", Unit::Newton, 9.806_65),
    ("N m", Unit::NewtonMetre, 1.0),
    ("N*m", Unit::NewtonMetre, 1.0),
    ("Nm", Unit::NewtonMetre, 1.0),
    ("kN m", Unit::NewtonMetre, 1e3),
    ("kgf m", Unit::NewtonMetre, 9.806_65),
    ("Pa", Unit::Pascal, 1.0),
    ("kPa", Unit::Pascal, 1e3),
    ("MPa", Unit::Pascal, 1e6),
    ("GPa", Unit::Pascal, 1e9),
    ("bar", Unit::Pascal, 1e5),
    ("N/mm^2", Unit::Pascal, 1e6),
    ("J", Unit::Joule, 1.0),
    ("mJ", Unit::Joule, 1e-3),
    ("kJ", Unit::Joule, 1e3),
    ("W", Unit::Watt, 1.0),
    ("kW", Unit::Watt, 1e3),
    ("N/m", Unit::NewtonPerMetre, 1.0),
    ("N/mm", Unit::NewtonPerMetre, 1e3),
    ("N/um", Unit::NewtonPerMetre, 1e6),
    ("N/µm", Unit::NewtonPerMetre, 1e6),
    ("N s/m", Unit::NewtonSecondPerMetre, 1.0),
    ("N m/rad", Unit::NewtonMetrePerRadian, 1.0),
    ("N m s/rad", Unit::NewtonMetreSecondPerRadian, 1.0),
    ("kg m^2", Unit::KilogramSquareMetre, 1.0),
    ("m/N", Unit::MetrePerNewton, 1.0),
    ("um/N", Unit::MetrePerNewton, 1e-6),
    ("µm/N", Unit::MetrePerNewton, 1e-6),
    ("rad/(N m)", Unit::RadianPerNewtonMetre, 1.0),
    ("N/m^3", Unit::NewtonPerCubicMetre, 1.0),
    ("N m/rad^3", Unit::NewtonMetrePerCubicRadian, 1.0),
    ("1/m", Unit::PerMetre, 1.0),
    ("1/s", Unit::PerSecond, 1.0),
    ("K", Unit::Kelvin, 1.0),
    ("A", Unit::Ampere, 1.0),
    ("mA", Unit::Ampere, 1e-3),
];

impl Unit {
    /// The SI symbol: `"m"`, `"N m"`, `"1"`.
    pub fn symbol(self) -> &'static str {
        SYMBOLS
            .iter()
            .find(|(_, unit, factor)| *unit == self && *factor == 1.0)
            .map_or("?", |entry| entry.0)
    }

    /// Understands a unit as an engineer writes it and returns it with the factor that turns a
    /// value into SI: `"mm"` gives `(Metre, 1e-3)`.
    ///
    /// # Errors
    /// A unit that is not in the table; the nearest one is named.
    pub fn parse_user(text: &str) -> Result<(Unit, f64), UnitError> {
        Unit::known(text).ok_or_else(|| UnitError {
            text: text.to_owned(),
            nearest: words::meant(text.trim()).map(str::to_owned),
        })
    }

    /// As [`Unit::parse_user`], `None` where that is an error: no nearest one is looked for, which
    /// takes a thousand times as long.
    pub fn known(text: &str) -> Option<(Unit, f64)> {
        let wanted = text.trim();
        let found = SYMBOLS.iter().find(|entry| entry.0 == wanted);
        found.map(|&(_, unit, factor)| (unit, factor))
    }

    /// The symbol of a unit as files of other programs write it, if that can mean nothing else:
    /// `"m/s²"` gives `"m/s^2"`, `"1/min"` gives `"rpm"`.
    pub fn symbol_in_files(text: &str) -> Option<&'static str> {
        words::in_files(text)
    }

    /// Every symbol that [`Unit::parse_user`] accepts for this unit, its own first.
    pub fn accepted_symbols(self) -> impl Iterator<Item = &'static str> {
        SYMBOLS
            .iter()
            .filter(move |entry| entry.1 == self)
            .map(|entry| entry.0)
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.symbol())
    }
}

impl FromStr for Unit {
    type Err = UnitError;

    /// Only SI symbols: `"mm"` is an error here, since its factor would be lost.
    fn from_str(text: &str) -> Result<Unit, UnitError> {
        match Unit::parse_user(text)? {
            (unit, 1.0) => Ok(unit),
            (unit, _) => Err(UnitError {
                text: text.to_owned(),
                nearest: Some(unit.symbol().to_owned()),
            }),
        }
    }
}

impl Serialize for Unit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.symbol())
    }
}

impl<'de> Deserialize<'de> for Unit {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Unit, D::Error> {
        String::deserialize(deserializer)?
            .parse()
            .map_err(serde::de::Error::custom)
    }
}

/// A unit together with the way a person wrote it; values are kept in SI and shown in this.
#[derive(Clone, Debug, PartialEq)]
pub struct UserUnit {
    /// As written: `"mm"`.
    pub symbol: String,
    /// The SI unit of the same dimension.
    pub unit: Unit,
    /// Multiply a value in `symbol` by this to get SI.
    pub si_factor: f64,
}

impl UserUnit {
    /// # Errors
    /// As [`Unit::parse_user`].
    pub fn parse(text: &str) -> Result<UserUnit, UnitError> {
        let (unit, si_factor) = Unit::parse_user(text)?;
        Ok(UserUnit {
            symbol: text.trim().to_owned(),
            unit,
            si_factor,
        })
    }

    /// A value given in SI, in this unit.
    pub fn from_si(&self, value: f64) -> f64 {
        value / self.si_factor
    }

    /// Four significant digits and the symbol: `0.0190 mm`, `44.10 %`, `1.390` if dimensionless.
    pub fn show(&self, value_si: f64) -> String {
        let value = match value_si {
            f64::INFINITY => return "infinite".to_owned(),
            f64::NEG_INFINITY => return "below all bounds".to_owned(),
            value_si => significant(self.from_si(value_si), 4),
        };
        if self.symbol == "1" {
            value
        } else {
            format!("{value} {}", self.symbol)
        }
    }
}

impl From<Unit> for UserUnit {
    fn from(unit: Unit) -> UserUnit {
        UserUnit {
            symbol: unit.symbol().to_owned(),
            unit,
            si_factor: 1.0,
        }
    }
}

/// A number with so many significant digits, plain where that stays short, else with an exponent.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-4..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.*e}", digits - 1)
    }
}

/// A number with four significant digits, without zeros at the end.
pub fn short_number(value: f64) -> String {
    let text = significant(value, 4);
    if text.contains('.') && !text.contains('e') {
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    text
}

/// A unit that is not known, or not SI where only SI will do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown unit \"{text}\"{}", suggestion(.nearest.as_deref()))]
pub struct UnitError {
    /// As written.
    pub text: String,
    /// The nearest unit that would be understood.
    pub nearest: Option<String>,
}

pub(crate) fn suggestion(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!("; did you mean \"{name}\"?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_numbers_have_no_zeros_at_the_end() {
        assert_eq!([0.2, 300.0].map(short_number), ["0.2", "300"]);
    }

    #[test]
    fn every_unit_has_its_own_symbol_and_reads_back() {
        for &(symbol, unit, factor) in SYMBOLS {
            assert_eq!(Unit::parse_user(symbol), Ok((unit, factor)));
            assert_eq!(unit.symbol().parse(), Ok(unit), "{symbol}");
            assert_ne!(unit.symbol(), "?");
        }
    }

    #[test]
    fn engineers_units_become_si() {
        assert_eq!(Unit::parse_user("µm"), Ok((Unit::Metre, 1e-6)));
        assert_eq!(Unit::parse_user("μm"), Ok((Unit::Metre, 1e-6)));
        assert_eq!(Unit::parse_user(" MPa "), Ok((Unit::Pascal, 1e6)));
        let (unit, factor) = Unit::parse_user("rpm").unwrap();
        assert_eq!(unit, Unit::RadianPerSecond);
        assert!((300.0 * factor - 10.0 * std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(Unit::NewtonMetre.to_string(), "N m");
    }

    #[test]
    fn an_unknown_unit_names_the_nearest() {
        let error = Unit::parse_user("Mpa").unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown unit \"Mpa\"; did you mean \"MPa\"?"
        );
        assert!(
            "mm".parse::<Unit>().is_err(),
            "only SI where the factor would be lost"
        );
    }

    #[test]
    fn numbers_are_shown_with_four_digits() {
        let millimetre = UserUnit::parse("mm").unwrap();
        assert_eq!(millimetre.show(1.9e-5), "0.01900 mm");
        assert_eq!(UserUnit::from(Unit::One).show(0.73575), "0.7358");
        assert_eq!(significant(0.0, 4), "0");
        assert_eq!(significant(1.96e9, 4), "1.960e9");
        assert_eq!(significant(f64::NAN, 4), "NaN");
    }
}
