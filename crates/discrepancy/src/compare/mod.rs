//! Comparison of a simulation with measured data, without naming causes.
//!
//! [`compare_recordings`] takes a run and a measurement, [`compare_channel`] one channel. The
//! residual is measured minus simulated. No colour of noise is assumed: its background is a smooth
//! function of frequency, estimated from the residual's own spectrum
//! ([`crate::stats::Background`]), and every standard error and threshold follows from it. They
//! hold for white noise as well as for drift.
//!
//! # A tour
//!
//! ```
//! use truecut_discrepancy::compare::{LineKind, Pair, Setting, compare_channel};
//! use truecut_recording::{ChannelSpec, Unit};
//!
//! // The measured force has a line once per revolution, at 5 Hz, that the simulation lacks.
//! let time_s: Vec<f64> = (0..4000).map(|row| f64::from(row) * 1e-3).collect();
//! let simulated: Vec<f64> = time_s.iter().map(|t| 100.0 * (3.0 * t).sin()).collect();
//! let mut measured = simulated.clone();
//! let mut state = 1_u32;
//! for (value, t) in measured.iter_mut().zip(&time_s) {
//!     // Noise by Knuth's generator.
//!     state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
//!     let line = 2.0 * (std::f64::consts::TAU * 5.0 * t).sin();
//!     *value += line + f64::from(state >> 8) / 16_777_216.0;
//! }
//! let spec = ChannelSpec::new("tool.force_y", Unit::Newton, "Force on the tool");
//! let pair = Pair {
//!     spec: &spec,
//!     measured: &measured,
//!     valid: &[true; 4000],
//!     simulated: &simulated,
//!     noise: None,
//! };
//! let setting = Setting { interval_s: 1e-3, explanatory: &[], spindle_hz: Some(5.0) };
//! let found = compare_channel(&pair, &setting)?;
//! let line = &found.lines[0];
//! assert_eq!((line.kind, line.per_revolution), (LineKind::Missing, Some(1)));
//! assert!((line.residual - 2.0).abs() < 0.05);
//! # Ok::<(), truecut_discrepancy::compare::CompareError>(())
//! ```

mod alignment;
mod coherence;
mod correlation;
mod dependence;
mod error;
mod level;
mod lines;
mod recordings;
mod series;
mod stretch;
mod suspicion;
mod whiteness;

pub use alignment::{Alignment, PatternLeft, align};
pub use coherence::{Band, coherence};
pub use correlation::{InputCorrelation, input_correlation};
pub use dependence::{Bin, Dependence, dependence};
pub use error::CompareError;
pub use level::{Level, level};
pub use lines::{LineKind, Spectra, SpectralLine, lines};
pub use recordings::{Comparison, along, compare_recordings};
pub use series::{Estimate, Explanatory, Kind, Pair};
pub use stretch::{Stretch, stretch};
pub use suspicion::{Exchange, Moved, UnitSuspicion, exchange, unit_suspicion};
pub use whiteness::{Whiteness, whiteness};

use serde::Serialize;
use truecut_recording::measured::MIN_SAMPLES;
use truecut_recording::{Unit, significant};

use crate::stats::distributions::family_wise;
use crate::stats::{Background, counted, deviation};

/// Findings are reported below this probability of a false alarm, counted over all signals tried.
pub const LEVEL: f64 = 0.01;

/// Context of a comparison.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a> {
    /// Time between samples, s.
    pub interval_s: f64,
    /// Signals that the residual may depend on.
    pub explanatory: &'a [Explanatory],
    /// Revolutions of the spindle per second.
    pub spindle_hz: Option<f64>,
}

/// Differences in one channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelComparison {
    /// Its name.
    pub channel: String,
    /// Unit of every value that states no other.
    pub unit: Unit,
    /// Size of the residual.
    pub level: Level,
    /// Delay and gain, if the channels can be aligned.
    pub alignment: Option<Alignment>,
    /// Lines of the residual, strongest first.
    pub lines: Vec<SpectralLine>,
    /// Coherence by band.
    pub coherence: Vec<Band>,
    /// The residual's mean over each explanatory signal, most significant first. Their p-values
    /// count all signals tried.
    pub dependence: Vec<Dependence>,
    /// Correlation with each input, most significant first; p-values count all inputs.
    pub inputs: Vec<InputCorrelation>,
    /// The residual's colour; none if there is no residual.
    pub whiteness: Option<Whiteness>,
    /// When the residual is there, if for a while only.
    pub event: Option<Event>,
    /// Spectra, for figures.
    #[serde(skip)]
    pub spectra: Option<Spectra>,
}

/// A residual that is there for a while only.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Event {
    /// When it begins and ends, s from the first sample on.
    pub from_s: f64,
    /// See [`Event::from_s`].
    pub until_s: f64,
    /// Part of the residual's square that lies between, of the record, and by chance.
    #[serde(flatten)]
    pub stretch: Stretch,
}

/// Compares one channel.
///
/// # Errors
/// Fewer than [`MIN_SAMPLES`] valid samples, values that are not finite, a measured channel that
/// never changes, a residual so large that the unit must be wrong.
pub fn compare_channel(
    pair: &Pair<'_>,
    setting: &Setting<'_>,
) -> Result<ChannelComparison, CompareError> {
    check_values(pair)?;
    if let Some(suspicion) = unit_suspicion(pair) {
        let channel = pair.spec.name.clone();
        return Err(CompareError::Unit { channel, suspicion });
    }
    let residual = pair.residual();
    let background = Background::of(&residual, pair.valid);
    let (lines, spectra) = lines(
        pair,
        &residual,
        setting.interval_s,
        setting.spindle_hz,
        LEVEL,
    );
    let mut comparison = ChannelComparison {
        channel: pair.spec.name.clone(),
        unit: pair.spec.unit,
        level: level(pair, &residual, background.as_ref()),
        alignment: align(pair, setting),
        lines,
        coherence: coherence(pair, setting.interval_s),
        dependence: Vec::new(),
        inputs: Vec::new(),
        whiteness: None,
        event: event(&residual, pair.valid, setting),
        spectra,
    };
    if let Some(background) = &background {
        comparison.whiteness = whiteness(&residual, pair.valid, background);
        comparison.dependence = dependences(&residual, pair.valid, setting);
        comparison.inputs = inputs(&residual, pair, setting);
    }
    Ok(comparison)
}

/// What is there for a while, beyond chance.
fn event(residual: &[f64], valid: &[bool], setting: &Setting<'_>) -> Option<Event> {
    let found = stretch(residual, valid).filter(|found| found.p_value < LEVEL)?;
    let time = (setting.explanatory.iter()).find(|one| one.kind == Kind::Time);
    let at = |row: usize| match time {
        Some(time) => time.values[row],
        None => row as f64 * setting.interval_s,
    };
    Some(Event {
        from_s: at(found.from),
        until_s: at(found.until - 1),
        stretch: found,
    })
}

fn check_values(pair: &Pair<'_>) -> Result<(), CompareError> {
    let channel = pair.spec.name.clone();
    let samples = pair.valid.iter().filter(|valid| **valid).count();
    if samples < MIN_SAMPLES {
        return Err(CompareError::TooFew {
            channel,
            counted: samples,
            least: MIN_SAMPLES,
        });
    }
    let finite = |values: &[f64]| counted(values, pair.valid).all(f64::is_finite);
    for (values, whose) in [(pair.measured, "measured"), (pair.simulated, "simulated")] {
        if !finite(values) {
            return Err(CompareError::NotFinite { channel, whose });
        }
    }
    let mut values = counted(pair.measured, pair.valid);
    let first = values.next().unwrap_or(0.0);
    if values.all(|value| value == first) {
        let value = format!("{} {}", significant(first, 4), pair.spec.unit);
        return Err(CompareError::Constant { channel, value });
    }
    Ok(())
}

/// No quantity of a machine moves by less, SI; and next to the largest of its unit, such a part of
/// it is rounding.
const ROUNDING: f64 = 1e-12;
const ROUNDING_SHARE: f64 = 1e-9;

/// Signals that move by more than rounding: what a residual could follow.
fn moving<'a>(setting: &'a Setting<'_>) -> impl Iterator<Item = &'a Explanatory> {
    let all = setting.explanatory.iter();
    all.filter(|signal| {
        let alike = (setting.explanatory.iter()).filter(|one| one.spec.unit == signal.spec.unit);
        let largest = alike.map(|one| deviation(&one.values)).fold(0.0, f64::max);
        deviation(&signal.values) > ROUNDING.max(ROUNDING_SHARE * largest)
    })
}

fn dependences(residual: &[f64], valid: &[bool], setting: &Setting<'_>) -> Vec<Dependence> {
    let test = |signal: &Explanatory| dependence(residual, valid, signal);
    let mut found: Vec<Dependence> = moving(setting).filter_map(test).collect();
    let count = found.len() as f64;
    for one in &mut found {
        one.p_value = family_wise(one.p_value, count);
    }
    // Where p-values underflow, the larger fraction first.
    found.sort_by(|a, b| {
        a.p_value
            .total_cmp(&b.p_value)
            .then(b.share.total_cmp(&a.share))
    });
    found
}

fn inputs(residual: &[f64], pair: &Pair<'_>, setting: &Setting<'_>) -> Vec<InputCorrelation> {
    let test = |name: &str, signal: &[f64]| {
        let interval_s = setting.interval_s;
        input_correlation(residual, pair.valid, name, signal, interval_s)
    };
    // Phase and time grow without bound; bins and lines test for them.
    let signals = moving(setting).filter(|signal| {
        !matches!(signal.kind, Kind::SpindlePhase | Kind::Time)
            && signal.spec.name != pair.spec.name
    });
    let mut found: Vec<InputCorrelation> = signals
        .filter_map(|signal| test(&signal.spec.name, &signal.values))
        .collect();
    found.extend(test(
        &format!("{} (simulated)", pair.spec.name),
        pair.simulated,
    ));
    let count = found.len() as f64;
    found
        .iter_mut()
        .for_each(|one| one.p_value = family_wise(one.p_value, count));
    found.sort_by(|a, b| {
        a.p_value
            .total_cmp(&b.p_value)
            .then(b.correlation.abs().total_cmp(&a.correlation.abs()))
    });
    found
}

#[cfg(test)]
mod false_alarms;
#[cfg(test)]
mod tests;
