//! Comparison of a run with a measurement.

use serde::Serialize;
use truecut_recording::spectrum::resample;
use truecut_recording::{ChannelSpec, Measured, Recording, Unit};

use super::series::{Explanatory, Kind, Pair};
use super::suspicion::exchange;
use super::{ChannelComparison, CompareError, Setting, check_values, compare_channel};

/// Differences between a simulation and a measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Source of the measured data.
    pub source: String,
    /// Duration compared, s.
    pub duration_s: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Revolutions of the spindle per second, if there is one.
    pub spindle_hz: Option<f64>,
    /// Notes on preprocessing of the data.
    pub notes: Vec<String>,
    /// One for each measured output, in the order of the data.
    pub channels: Vec<ChannelComparison>,
    /// Signals that the residuals were tested against.
    #[serde(skip)]
    pub explanatory: Vec<Explanatory>,
}

/// Compares every measured output with the channel of the run that has its name, at the times of
/// the measurement; the run is interpolated linearly. Residuals are tested against the run's joint
/// coordinates and velocities and its forces, against measured inputs, spindle phase and time.
///
/// # Errors
/// As [`compare_channel`]; a channel that the run lacks or has in another dimension; a run shorter
/// than half of the data; no measured output.
pub fn compare_recordings(
    simulated: &Recording,
    measured: &Measured,
    spindle_hz: Option<f64>,
) -> Result<Comparison, CompareError> {
    let simulated_s = simulated.time_s.last().copied().unwrap_or(0.0);
    let process_s = measured.process_time_s();
    let runs: Vec<bool> = (process_s.iter())
        .map(|time| (-1e-9..=simulated_s + 1e-9).contains(time))
        .collect();
    // Nothing is simulated between passes, and nothing is compared after the last.
    let rows = runs
        .iter()
        .rposition(|runs| *runs)
        .map_or(0, |last| last + 1);
    let compared = runs.iter().filter(|runs| **runs).count();
    if 2 * compared < measured.time_s.len() || rows == 0 {
        let measured_s = measured.duration_s();
        return Err(CompareError::NoCommonTime {
            simulated_s,
            measured_s,
        });
    }
    if measured.outputs().next().is_none() {
        return Err(CompareError::NoOutput);
    }
    let time_s = &measured.time_s[..rows];
    let mut notes = measured.notes.clone();
    if rows < measured.time_s.len() {
        notes.push(format!(
            "the data after the run's end, {simulated_s} s, are left out"
        ));
    }
    if compared < rows {
        notes.push(format!(
            "{} samples outside the passes of {simulated_s} s are left out",
            rows - compared
        ));
    }
    let explanatory = explanatory(simulated, measured, &process_s[..rows], spindle_hz);
    let setting = Setting {
        interval_s: measured.interval_s(),
        explanatory: &explanatory,
        spindle_hz,
    };
    let mut series = Vec::new();
    for output in measured.outputs() {
        let column = column_of(simulated, &output.spec)?;
        let valid: Vec<bool> = (output.valid[..rows].iter().zip(&runs))
            .map(|(valid, runs)| *valid && *runs)
            .collect();
        series.push((output, valid, along(simulated, measured, column, rows)));
    }
    let pairs: Vec<Pair<'_>> = (series.iter())
        .map(|(output, valid, simulated)| Pair {
            spec: &output.spec,
            measured: &output.values[..rows],
            valid,
            simulated,
            noise: output.noise,
        })
        .collect();
    for pair in &pairs {
        check_values(pair)?;
    }
    if let Some(found) = exchange(&pairs) {
        return Err(CompareError::Exchanged(found));
    }
    let compared = pairs.iter().map(|pair| compare_channel(pair, &setting));
    let channels = compared.collect::<Result<Vec<_>, _>>()?;
    Ok(Comparison {
        source: measured.source.clone(),
        duration_s: time_s[rows - 1],
        rate_hz: measured.rate_hz(),
        spindle_hz,
        notes,
        channels,
        explanatory,
    })
}

/// The run's channel with the name and unit of a measured one.
fn column_of<'a>(
    simulated: &'a Recording,
    measured: &ChannelSpec,
) -> Result<&'a [f64], CompareError> {
    let unknown = |error| CompareError::Unknown {
        channel: measured.name.clone(),
        error,
    };
    let spec = simulated.header.channel(&measured.name).map_err(unknown)?;
    if spec.unit != measured.unit {
        return Err(CompareError::Dimension {
            channel: measured.name.clone(),
            measured: measured.unit,
            simulated: spec.unit,
        });
    }
    simulated.channel(&measured.name).map_err(unknown)
}

/// The first `rows` samples of a simulated channel at the times of the measurement, pass by pass.
pub fn along(simulated: &Recording, measured: &Measured, column: &[f64], rows: usize) -> Vec<f64> {
    let stretches = measured.stretches_s();
    let mut values: Vec<f64> = (stretches.iter())
        .flat_map(|times| resample(&simulated.time_s, column, times))
        .collect();
    values.truncate(rows);
    values
}

/// All signals that residuals are tested against, at the given process times. Nearly constant
/// signals are left out.
fn explanatory(
    simulated: &Recording,
    measured: &Measured,
    time_s: &[f64],
    spindle_hz: Option<f64>,
) -> Vec<Explanatory> {
    let mut signals: Vec<Explanatory> = Vec::new();
    for input in measured.inputs() {
        let kind = kind(&input.spec).unwrap_or(Kind::Load);
        let values = input.values[..time_s.len()].to_vec();
        signals.push(Explanatory::new(input.spec.clone(), kind, values));
    }
    for (spec, column) in simulated.header.channels.iter().zip(&simulated.columns) {
        let known = signals.iter().any(|signal| signal.spec.name == spec.name);
        if let (Some(kind), false) = (kind(spec), known) {
            let values = along(simulated, measured, column, time_s.len());
            signals.push(Explanatory::new(spec.clone(), kind, values));
        }
    }
    signals.retain(|signal| moves(&signal.values));
    derive_velocities(&mut signals, measured.interval_s());
    if let Some(spindle_hz) = spindle_hz {
        let values = time_s
            .iter()
            .map(|t| std::f64::consts::TAU * spindle_hz * t)
            .collect();
        let spec = ChannelSpec::new("spindle.angle", Unit::Radian, "Angle of the spindle");
        signals.push(Explanatory::new(spec, Kind::SpindlePhase, values));
    }
    let spec = ChannelSpec::new("time", Unit::Second, "Time since the first sample");
    let values = measured.time_s[..time_s.len()].to_vec();
    signals.push(Explanatory::new(spec, Kind::Time, values));
    signals
}

/// Adds the velocity of every joint of which only the coordinate is known.
fn derive_velocities(signals: &mut Vec<Explanatory>, interval_s: f64) {
    let mut derived = Vec::new();
    for (index, position) in signals
        .iter()
        .enumerate()
        .filter(|(_, one)| one.kind == Kind::Position)
    {
        let joint = position.spec.name.split('.').next().unwrap_or_default();
        let name = format!("{joint}.velocity");
        if signals.iter().all(|one| one.spec.name != name) {
            let (unit, per_second) = match position.spec.unit {
                Unit::Metre => (Unit::MetrePerSecond, "position"),
                _ => (Unit::RadianPerSecond, "angle"),
            };
            let spec =
                ChannelSpec::new(name, unit, format!("Change of the {per_second} per second"));
            let values = velocity(&position.values, interval_s);
            derived.push((index, Explanatory::new(spec, Kind::Velocity, values)));
        }
    }
    // Each after its coordinate.
    for (index, velocity) in derived.into_iter().rev() {
        signals.insert(index + 1, velocity);
    }
}

/// Differences over ±10 ms, so that quantisation does not change the sign.
fn velocity(position: &[f64], interval_s: f64) -> Vec<f64> {
    let reach = ((0.01 / interval_s).round() as usize).max(1);
    let last = position.len() - 1;
    let slope = |row: usize| {
        let (from, to) = (row.saturating_sub(reach), (row + reach).min(last));
        (position[to] - position[from]) / ((to - from) as f64 * interval_s)
    };
    (0..=last).map(slope).collect()
}

/// Kind of a signal, by its name and unit.
fn kind(spec: &ChannelSpec) -> Option<Kind> {
    let (subject, quantity) = spec.name.split_once('.')?;
    let of_joint = subject.starts_with("joint");
    match quantity {
        "angle" | "position" if of_joint => Some(Kind::Position),
        "velocity" if of_joint => Some(Kind::Velocity),
        _ if quantity.contains("force") || quantity.contains("torque") => {
            let is_load = matches!(spec.unit, Unit::Newton | Unit::NewtonMetre);
            is_load.then_some(Kind::Load)
        }
        _ => None,
    }
}

/// Whether a signal varies by more than rounding.
fn moves(values: &[f64]) -> bool {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    high.is_finite() && low.is_finite() && high - low > 1e-9 * high.abs().max(low.abs())
}
