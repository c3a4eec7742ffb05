//! What is uncertain: how limits spread, as text, curves and for other programs.

use std::time::Instant;

use serde::Serialize;
use truecut_plan::spread::{Probability, Spread};
use truecut_recording::significant;

use crate::figure::{Layer, Style};

/// Spreads by place: a speed, a distance along a path or an angle.
pub type Spreads = Vec<(f64, Spread)>;

/// A spread for other programs, in SI; values that do not exist are `null`.
#[derive(Serialize)]
pub struct SpreadJson {
    /// Values below which 5, 50 and 95 % of the draws lie; `null` where there is no limit.
    low: Option<f64>,
    median: Option<f64>,
    high: Option<f64>,
    probability_stable: f64,
    probability_stable_error: f64,
    probability_growing: f64,
    draws: usize,
}

impl From<&Spread> for SpreadJson {
    fn from(spread: &Spread) -> Self {
        let [low, median, high] = spread.quantiles.map(|x| x.is_finite().then_some(x));
        Self {
            low,
            median,
            high,
            probability_stable: spread.stable.value,
            probability_stable_error: spread.stable.standard_error,
            probability_growing: spread.grows.value,
            draws: spread.draws,
        }
    }
}

/// Names of the columns of [`column`].
pub const COLUMNS: [&str; 4] = ["low", "median", "high", "probability_stable"];

/// The `index`th of [`COLUMNS`] at places; NaN at those of which nothing is known.
pub fn column(index: usize, places: &[f64], spreads: &Spreads, scale: f64) -> Vec<f64> {
    let value = |spread: &Spread| match index {
        3 => spread.stable.value,
        index => spread.quantiles[index] * scale,
    };
    let found = places.iter().map(|place| {
        let here = spreads.iter().find(|(at, _)| at == place);
        here.map_or(f64::NAN, |(_, spread)| value(spread))
    });
    found.collect()
}

/// What lies between 5 and 95 % of the draws, up to a highest value.
pub fn band(label: &str, spreads: &Spreads, [x, y]: [f64; 2], most: f64, colour: usize) -> Layer {
    let value = |spread: &Spread, k: usize| (spread.quantiles[k] * y).min(most);
    let upper = spreads
        .iter()
        .map(|(at, spread)| (at * x, value(spread, 2)));
    let lower = spreads.iter().map(|(_, spread)| value(spread, 0));
    Layer::new(label, upper, Style::Band(lower.collect()), colour)
}

/// The probability that the cut is stable, in per cent.
pub fn probability(spreads: &Spreads, x: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
    let points = spreads.iter();
    points.map(move |(at, spread)| (at * x, 100.0 * spread.stable.value))
}

/// How likely it is that a cut is stable, with the standard error of that.
pub fn stable(found: &Spread) -> String {
    let Probability {
        value,
        standard_error,
    } = found.stable;
    let percent = |part: f64, digits| significant(100.0 * part, digits);
    if value == 0.0 || value == 1.0 {
        let which = if value == 0.0 { "none" } else { "all" };
        return format!("stable in {which} of {} draws", found.draws);
    }
    format!(
        "stable with a probability of {} % (standard error {} %)",
        percent(value, 3),
        percent(standard_error, 2)
    )
}

/// Keys of what is uncertain, the first few by name.
pub fn keys(keys: &[String]) -> String {
    const NAMED: usize = 3;
    let named = keys[..keys.len().min(NAMED)].join(", ");
    match keys.len().saturating_sub(NAMED) {
        0 => named,
        more => format!("{named} and {more} more"),
    }
}

/// How many draws were asked, and how long it took.
pub fn effort<'a>(all: impl Iterator<Item = &'a Spread>, since: Instant) -> String {
    let draws: usize = all.map(|spread| spread.draws).sum();
    format!(
        "{draws} draws in {}",
        crate::text::seconds(since.elapsed().as_secs_f64())
    )
}
