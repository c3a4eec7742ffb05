//! Errors on held-out data, as a table.

use std::collections::BTreeMap;

use truecut_discrepancy::diagnose::{ChannelErrors, NoiseSource};
use truecut_recording::{Unit, significant};

use super::{titled, with_unit};
use crate::text::{Align, reading_unit};

/// Errors under the names of what is before and after.
pub fn rows_of_errors(
    channels: &BTreeMap<String, ChannelErrors>,
    [before, after]: [&str; 2],
    refitted: bool,
) -> Vec<Vec<String>> {
    let mut rows = vec![vec!["".to_owned(), before.to_owned()]];
    rows[0].extend(refitted.then(|| "refitted alone".to_owned()));
    rows[0].extend([after, "noise", "", "noise known from"].map(str::to_owned));
    for (channel, errors) in channels {
        let unit = errors.unit.parse().unwrap_or(Unit::One);
        let unit = reading_unit(unit, errors.before.max(errors.noise_floor));
        let number = |value: f64| significant(unit.from_si(value), 4);
        let mut row = vec![channel.clone(), number(errors.before)];
        row.extend(refitted.then(|| number(errors.refitted)));
        row.extend([number(errors.after), noise(errors, &number)]);
        row.push(with_unit("", &unit.symbol).trim().to_owned());
        row.push(errors.noise_source.description().to_owned());
        rows.push(row);
    }
    rows
}

/// Errors as a table; nothing without a channel.
pub fn held_out(title: &str, rows: &[Vec<String>]) -> String {
    if rows.len() < 2 {
        return String::new();
    }
    let mut aligns = vec![Align::Right; rows[0].len()];
    let last = rows[0].len() - 1;
    for side in [0, last - 1, last] {
        aligns[side] = Align::Left;
    }
    titled(title, &aligns, rows)
}

/// The noise, or between what and what it is.
fn noise(errors: &ChannelErrors, number: &dyn Fn(f64) -> String) -> String {
    let (least, most) = (errors.noise_without_memory, errors.noise_floor);
    match errors.noise_source {
        NoiseSource::Bound if least > 0.0 && least < most => {
            format!("{} to {}", number(least), number(most))
        }
        NoiseSource::Bound => format!("<= {}", number(most)),
        _ => number(most),
    }
}
