//! Numbers of the command line.

/// A finite number above zero.
pub fn above_zero(text: &str) -> Result<f64, String> {
    number(text, |value| value > 0.0, "must be a number above 0")
}

/// A finite number that holds to a rule.
pub fn number(text: &str, holds: impl Fn(f64) -> bool, rule: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok();
    let value = value.filter(|value| value.is_finite() && holds(*value));
    value.ok_or_else(|| rule.to_owned())
}
