//! Conversions from the units of scenario keys to SI. Every conversion in the project happens here,
//! once.
//!
//! Decimal prefixes below one divide rather than multiply: `0.05 / 1e3` is the double nearest to
//! 5e-5, `0.05 * 1e-3` is not.

use std::f64::consts::TAU;

use truecut_recording::{Unit, UserUnit};

use crate::effect;

/// Millimetres to metres (also mm/s to m/s and mm/rev to m/rev).
pub(crate) fn from_mm(value: f64) -> f64 {
    value / 1e3
}

/// Micrometres to metres.
pub(crate) fn from_um(value: f64) -> f64 {
    value / 1e6
}

/// Milliseconds to seconds.
pub(crate) fn from_ms(value: f64) -> f64 {
    value / 1e3
}

/// Megapascals to pascals.
pub(crate) fn from_mpa(value: f64) -> f64 {
    value * 1e6
}

/// N/mm to N/m (also N s/mm to N s/m).
pub(crate) fn from_n_per_mm(value: f64) -> f64 {
    value * 1e3
}

/// N/mm³ to N/m³.
pub(crate) fn from_n_per_mm3(value: f64) -> f64 {
    value * 1e9
}

/// N/µm to N/m.
pub(crate) fn from_n_per_um(value: f64) -> f64 {
    value * 1e6
}

/// Degrees to radians.
pub(crate) fn from_deg(value: f64) -> f64 {
    value.to_radians()
}

/// Revolutions per minute to radians per second.
pub(crate) fn from_rpm(value: f64) -> f64 {
    value * (TAU / 60.0)
}

/// Unit suffixes of scenario keys with the unit as a person says it and its symbol. Longer suffixes
/// stand before shorter ones that they end in.
const SUFFIXES: [(&str, &str, &str); 26] = [
    ("_deg_per_s2", "degrees/s²", "deg/s^2"),
    ("_deg_per_s", "degrees/s", "deg/s"),
    ("_pa_s_per_m", "Pa s/m", "Pa s/m"),
    ("_j_per_mm2", "J/mm²", "J/mm^2"),
    ("_j_per_mm3", "J/mm³", "J/mm^3"),
    ("_per_mm2", "1/mm²", "1/mm^2"),
    ("_mm_per_tooth", "mm per tooth", "mm"),
    ("_mm_per_rev", "mm per revolution", "mm"),
    ("_n_s_per_mm", "N s/mm", "N s/mm"),
    ("_mm_per_s", "mm/s", "mm/s"),
    ("_m_per_s", "m/s", "m/s"),
    ("_n_per_mm3", "N/mm³", "N/mm^3"),
    ("_n_per_mm", "N/mm", "N/mm"),
    ("_n_per_um", "N/µm", "N/um"),
    ("_fraction", "a fraction of the run", "1"),
    ("_revolutions", "revolutions", "1"),
    ("_per_pa", "1/Pa", "1/Pa"),
    ("_mpa", "MPa", "MPa"),
    ("_deg", "degrees", "deg"),
    ("_rpm", "revolutions per minute", "rpm"),
    ("_ms", "milliseconds", "ms"),
    ("_um", "µm", "um"),
    ("_mm", "mm", "mm"),
    ("_hz", "Hz", "Hz"),
    ("_n", "newtons", "N"),
    ("_s", "seconds", "s"),
];

/// Symbols of units that only keys have, with their factors to SI.
const OF_KEYS: [(&str, Unit, f64); 7] = [
    ("Pa s/m", Unit::One, 1.0),
    ("J/mm^2", Unit::One, 1e6),
    ("J/mm^3", Unit::One, 1e9),
    ("1/mm^2", Unit::One, 1e6),
    ("N s/mm", Unit::NewtonSecondPerMetre, 1e3),
    ("1/Pa", Unit::One, 1.0),
    ("N/mm^3", Unit::One, 1e9),
];

/// What people write as units in keys although the format does not, to recognise the quantity.
const FOREIGN: [&str; 13] = [
    "_pa", "_bar", "_kpa", "_psi", "_m", "_cm", "_in", "_inch", "_inches", "_rad", "_kg", "_kn",
    "_rad_s",
];

/// Splits `pressure_mpa` into `("pressure", "MPa")`; `None` for a key without a unit of the format.
pub(crate) fn split_suffix(key: &str) -> Option<(&str, &'static str)> {
    SUFFIXES
        .iter()
        .find_map(|(suffix, words, _)| Some((key.strip_suffix(suffix)?, *words)))
        .filter(|(stem, _)| !stem.is_empty())
}

/// The quantity that a key means: `pressure` of `pressure_mpa`, `pressure_bar` and `pressure`.
pub(crate) fn quantity(key: &str) -> &str {
    split_suffix(key)
        .map(|(stem, _)| stem)
        .or_else(|| {
            let foreign = FOREIGN.iter().filter_map(|suffix| key.strip_suffix(suffix));
            foreign.min_by_key(|stem| stem.len())
        })
        .filter(|stem| !stem.is_empty())
        .unwrap_or(key)
}

/// The unit of the last part of a dotted key; dimensionless if it has no unit suffix. Keys of
/// effects are SI and stand in the catalogue.
pub fn key_unit(key: &str) -> UserUnit {
    if let Some((_, last)) = key
        .strip_prefix("effect.")
        .and_then(|rest| rest.split_once('.'))
    {
        return UserUnit::from(effect::unit_of_key(last));
    }
    // An entry of a list has the unit of the list.
    let list = (key.rsplit_once('.')).filter(|(_, last)| last.bytes().all(|b| b.is_ascii_digit()));
    let key = list.map_or(key, |(list, _)| list);
    let known = SUFFIXES.iter().find(|(suffix, ..)| key.ends_with(suffix));
    let symbol = known.map_or("1", |(.., symbol)| symbol);
    let of_keys = OF_KEYS.iter().find(|(of_keys, ..)| *of_keys == symbol);
    let found = of_keys.map(|&(_, unit, si_factor)| (unit, si_factor));
    let (unit, si_factor) = found
        .or_else(|| Unit::parse_user(symbol).ok())
        .unwrap_or((Unit::One, 1.0));
    UserUnit {
        symbol: symbol.to_owned(),
        unit,
        si_factor,
    }
}

/// Symbol of the SI unit of a dotted key's value.
pub fn si_symbol(key: &str) -> String {
    let unit = key_unit(key);
    match unit.unit {
        // Units that only keys have: `Pa s/m`, `J/mm^2`.
        Unit::One => unit.symbol.replace("mm", "m"),
        known => known.to_string(),
    }
}
