//! Numbers as messages have them.

/// A coordinate, of that unit, in the one that people give it in.
pub(crate) fn in_the_workshop(value: f64, unit: &str) -> String {
    match unit {
        "rad" => format!("{} deg", short(value.to_degrees())),
        _ => format!("{} mm", short(value * 1e3)),
    }
}

/// A number with four decimals at most.
pub(crate) fn short(value: f64) -> String {
    if value.abs() >= 1e15 {
        return told(value);
    }
    let text = format!("{value:.4}");
    match text.trim_end_matches('0').trim_end_matches('.') {
        "-0" => "0".to_owned(),
        text => text.to_owned(),
    }
}

/// A number, with an exponent where it would take a line of digits.
pub(crate) fn told(value: f64) -> String {
    match value.abs() {
        size if size >= 1e15 && size.is_finite() => format!("{value:e}"),
        _ => value.to_string(),
    }
}
