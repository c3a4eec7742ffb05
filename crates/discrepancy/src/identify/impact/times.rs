//! Rate of a column of times. Those that a file gives with few digits are taken for the even grid
//! that they round: seven digits of a second leave a millionth, which is more than jitter may be of
//! a sampling interval of a ten thousandth.

use truecut_recording::measured::Table;
use truecut_recording::significant;

use super::super::{IdentifyError, at_row};

/// Allowed jitter, as a fraction of the sampling interval.
const JITTER: f64 = 0.01;
/// Digits coarser than this part of an interval would hide a sample that is missing.
const COARSEST: f64 = 0.5;
/// Deviations by which a line through rounded times may be off at its ends.
const DEVIATIONS: f64 = 4.0;

/// Samples a second, and what is to be told of them.
pub(super) struct Rate {
    pub(super) hz: f64,
    pub(super) note: Option<String>,
}

/// Rate of samples at `times`, in units of `unit_s`, which are evenly apart.
pub(super) fn even_rate(
    table: &Table,
    times: &[f64],
    unit_s: f64,
    key: &str,
) -> Result<Rate, IdentifyError> {
    let steps = (times.len().max(2) - 1) as f64;
    let span = times.last().zip(times.first()).map_or(0.0, |(b, a)| b - a);
    let interval = span / steps;
    let uneven = times
        .windows(2)
        .position(|pair| (pair[1] - pair[0] - interval).abs() > JITTER * interval);
    let Some(row) = uneven.or((span <= 0.0).then_some(0)) else {
        let hz = 1.0 / (interval * unit_s);
        return Ok(Rate { hz, note: None });
    };
    if let Some((interval, digit)) = rounded_grid(times) {
        let hz = 1.0 / (interval * unit_s);
        let note = format!(
            "{}: times are rounded to {} s, and lie within it of even ones: taken as {} samples a second",
            table.source,
            significant(digit * unit_s, 1),
            significant(hz, 6)
        );
        let note = Some(note);
        return Ok(Rate { hz, note });
    }
    let next = times.get(row + 1).map_or(0.0, |next| next - times[row]);
    let message = format!(
        "the next sample follows after {} s, but the mean interval is {} s, and the times are not such as rounding to \
         their digits leaves of even ones; a spectrum needs equal intervals: if the samples are evenly apart, give \
         their rate as `rate_hz` in place of `time`",
        significant(next * unit_s, 6),
        significant(interval * unit_s, 6)
    );
    Err(at_row(table, row, format!("{key}.time"), message))
}

/// Interval of the even grid that `times` are, rounded to their digits, and the coarsest of these.
fn rounded_grid(times: &[f64]) -> Option<(f64, f64)> {
    let (first, digit) = (*times.first()?, coarsest_digit(times)?);
    let count = times.len() as f64;
    let mean = times.iter().map(|time| time - first).sum::<f64>() / count;
    // Of each row: how far it lies from the middle one, and its time from the mean.
    let rows = (times.iter().enumerate())
        .map(|(row, time)| (row as f64 - 0.5 * (count - 1.0), time - first - mean));
    let moment: f64 = rows.clone().map(|(row, time)| row * time).sum();
    let interval = moment / (count * (count * count - 1.0) / 12.0);
    // Rounding has the deviation digit/√12, and the end of a line through n points twice that
    // over √n.
    let of_line = DEVIATIONS * 2.0 / (12.0 * count).sqrt();
    let allowed = digit * (0.5 + of_line).min(1.0);
    let mut off = rows.map(|(row, time)| (time - row * interval).abs());
    (off.all(|off| off <= allowed) && digit < COARSEST * interval).then_some((interval, digit))
}

/// The last digit of the largest times. A number may end in zeros, so that all of them say how many
/// digits there are; with as many before the point and behind it (`%.7g`) the largest have the
/// coarsest, with as many behind it the largest have the most.
fn coarsest_digit(times: &[f64]) -> Option<f64> {
    let digits = times.iter().filter_map(|time| digits_and_decade(*time));
    let (digits, decade) = digits.reduce(|most, own| (most.0.max(own.0), most.1.max(own.1)))?;
    Some(10.0_f64.powi(decade + 1 - digits))
}

/// Significant digits of a number, the fewest that give it, and the power of ten that it begins at;
/// `None` of zero.
fn digits_and_decade(value: f64) -> Option<(i32, i32)> {
    let text = format!("{:e}", value.abs());
    let (digits, decade) = text.split_once('e')?;
    let count = digits.chars().filter(char::is_ascii_digit).count();
    (value != 0.0).then_some((count as i32, decade.parse().ok()?))
}
