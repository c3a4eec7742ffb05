//! Numbers as program files hold them.

use super::ProgramErrorKind;

/// A value with a fixed number of decimals, zero without a sign.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    if zero {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

/// A finite number.
pub(crate) fn finite(text: &str, what: &str) -> Result<f64, ProgramErrorKind> {
    let value: Option<f64> = text.trim().parse().ok();
    value
        .filter(|value| value.is_finite())
        .ok_or_else(|| ProgramErrorKind::value(what, text.trim(), "a finite number"))
}

/// A whole number.
pub(super) fn whole<T: std::str::FromStr>(text: &str, what: &str) -> Result<T, ProgramErrorKind> {
    let parsed = text.trim().parse();
    parsed.map_err(|_| ProgramErrorKind::value(what, text.trim(), "a whole number in range"))
}
