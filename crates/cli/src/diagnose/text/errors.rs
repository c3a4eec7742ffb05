//! Errors on held-out data, as a table.

use std::collections::BTreeMap;

use truecut_discrepancy::diagnose::{ChannelErrors, Diagnosis, NoiseSource};
use truecut_recording::{Unit, significant};

use super::{SURELY, titled, with_unit};
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

/// Noise that may be so many times smaller than what is left is as good as unknown.
const HARDLY_KNOWN: f64 = 3.0;

/// The channel whose noise is known least: by how much what is left of it exceeds the noise at
/// least and at most.
pub fn unbounded(diagnosis: &Diagnosis) -> String {
    let bound = (diagnosis.channels.iter()).filter(|(_, errors)| {
        errors.noise_source == NoiseSource::Bound && errors.noise_without_memory > 0.0
    });
    let ratios = bound.map(|one| (one.1.after / one.1.noise_without_memory, one));
    let Some((most, (name, errors))) = ratios.max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return String::new();
    };
    if most <= HARDLY_KNOWN {
        return String::new();
    }
    let least = errors.after / errors.noise_floor.max(f64::MIN_POSITIVE);
    let most = significant(most, 2);
    if least <= SURELY {
        return format!(
            "; of {name} the noise is not known: what is left may be all noise, or {most} times it"
        );
    }
    let unit = errors.unit.parse().unwrap_or(Unit::One);
    let unit = reading_unit(unit, errors.noise_floor);
    format!(
        "; of {name} the noise is at most {} {}: what is left is {} to {most} times it",
        significant(unit.from_si(errors.noise_floor), 3),
        unit.symbol,
        significant(least, 2)
    )
}
