//! Numbers of the command line.

use std::ops::RangeInclusive;

/// Any finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    number(text.trim(), |_| true, "must be a number")
}

/// A finite number above zero.
pub fn above_zero(text: &str) -> Result<f64, String> {
    number(text, |value| value > 0.0, "must be a number above 0")
}

/// A number above zero and no larger than `most`.
pub fn above_zero_to(text: &str, most: f64) -> Result<f64, String> {
    let rule = format!("must be a number above 0 and at most {most}");
    number(text, |value| value > 0.0 && value <= most, &rule)
}

/// A number in a range, its ends included.
pub fn within(text: &str, range: RangeInclusive<f64>) -> Result<f64, String> {
    let rule = format!("must be a number from {} to {}", range.start(), range.end());
    number(text, |value| range.contains(&value), &rule)
}

/// A finite number that holds to a rule.
pub fn number(text: &str, holds: impl Fn(f64) -> bool, rule: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok();
    let value = value.filter(|value| value.is_finite() && holds(*value));
    value.ok_or_else(|| rule.to_owned())
}

/// A whole number of at least 1.
pub fn count(text: &str) -> Result<std::num::NonZeroUsize, String> {
    text.parse()
        .map_err(|_| "must be a whole number of at least 1".to_owned())
}

/// Three finite numbers with commas between.
pub fn three(text: &str) -> Result<[f64; 3], String> {
    let rule = "must be three numbers with commas between, such as 900,0,350";
    let parts: Vec<&str> = text.split(',').collect();
    let parts: [&str; 3] = parts.try_into().map_err(|_| rule.to_owned())?;
    let mut numbers = [0.0; 3];
    for (value, part) in numbers.iter_mut().zip(parts) {
        *value = number(part.trim(), |_| true, rule)?;
    }
    Ok(numbers)
}

/// A number of bytes, with k, M, G or T for powers of a thousand.
pub fn bytes(text: &str) -> Result<u64, String> {
    let rule = "must be a number of bytes of at least 1, such as 2G or 500M";
    let units = [("k", 1e3), ("K", 1e3), ("M", 1e6), ("G", 1e9), ("T", 1e12)];
    let unit = units.iter().find_map(|(unit, factor)| {
        let number = text.strip_suffix(unit)?;
        Some((number, *factor))
    });
    let (digits, factor) = unit.unwrap_or((text, 1.0));
    let most = u64::MAX as f64;
    let value = number(
        digits,
        |value| (1.0..most).contains(&(value * factor)),
        rule,
    )?;
    Ok((value * factor) as u64)
}
