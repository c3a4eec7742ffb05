//! FRFs from the signals of hammer and sensor: detection of blows, averages by H1.
//!
//! H1 = Σ F* X / Σ F* F is unbiased under noise of the sensor. An exponential window e^(−t/τ) acts
//! on force and response alike, which gives exactly H(iω + 1/τ): the fit subtracts 1/τ from its
//! decay rates.

use nalgebra::Complex;
use truecut_recording::fft;
use truecut_recording::measured::{Table, TimeBase, time_note, unit_of_times};
use truecut_recording::{short_number, significant};
use truecut_scenario::identification::ImpactSpec;

use super::frf::{Frf, noise};
use super::{IdentifyError, at_row};
use crate::stats::deviation;

mod times;

use times::{Rate, even_rate};

/// Least force of a second blow inside a window, as a fraction of the first.
const DOUBLE: f64 = 0.2;
/// A response has decayed if its last tenth is at most this fraction of its first.
const RUNG_DOWN: f64 = 0.03;

/// Hammer and response, uniformly sampled, SI.
struct HammerSignals {
    rate_hz: f64,
    force: Vec<f64>,
    response: Vec<f64>,
    /// On their times.
    note: Option<String>,
}

/// The FRF of all blows in a table.
///
/// # Errors
/// Signals that hold gaps or are not uniform beyond the rounding of their times, times in an
/// unknown unit or in another than is said, no blow, windows too short for the band.
pub fn impact(
    table: &Table,
    spec: &ImpactSpec,
    band_hz: [f64; 2],
    key: &str,
) -> Result<Frf, IdentifyError> {
    let signals = signals(table, spec, key)?;
    let fail = |at: String, message: &str| {
        Err(IdentifyError::new(
            at,
            format!("{}: {message}", table.source),
        ))
    };
    if band_hz[1] > 0.5 * signals.rate_hz {
        let message = format!(
            "the band ends at {} Hz, but must end at or below {} Hz, half of the {} samples a second: \
             they show nothing above half their rate{}",
            band_hz[1],
            short_number(0.5 * signals.rate_hz),
            short_number(signals.rate_hz),
            assumed_unit(table, spec)
        );
        return fail("modes.band_hz".to_owned(), &message);
    }
    let blows = blows(&signals, spec);
    let force = format!("{key}.force");
    let Some(length) = window(&signals, spec, &blows) else {
        return fail(force, "no blow is found that its window fits behind");
    };
    let mut notes = Vec::new();
    let before = (spec.before_s * signals.rate_hz).round() as usize;
    let windows: Vec<usize> = (blows.iter())
        .filter_map(|blow| blow.checked_sub(before))
        .filter(|start| start + length <= signals.force.len())
        .filter(|&start| single(&signals, spec, start, length, before))
        .collect();
    if windows.len() < blows.len() {
        let left_out = blows.len() - windows.len();
        notes.push(format!(
            "{left_out} of {} blows are left out: double, or cut by an end of the record",
            blows.len()
        ));
    }
    if windows.is_empty() {
        let message = "every blow is double or cut by an end of the record";
        return fail(force, message);
    }
    if let Some(left) = still_ringing(&signals, spec, &windows, length) {
        notes.push(format!(
            "the response still has {} % of its first size when the window ends: damping comes \
             out too large; \
             take a longer window_s, or exponential_s",
            significant(100.0 * left, 2)
        ));
    }
    let mut found = average(&signals, spec, &windows, length, band_hz);
    found.source = format!("{}, {}", table.source, spec.response.column);
    notes.insert(
        0,
        format!(
            "{} blows averaged, windows of {} s: {} Hz between frequencies",
            windows.len(),
            significant(length as f64 / signals.rate_hz, 3),
            significant(signals.rate_hz / length as f64, 3)
        ),
    );
    notes.extend(time_note(table, &spec.times, spec.is_time_unit_said));
    notes.extend(signals.note);
    found.notes = notes;
    found.check(band_hz, key)?;
    Ok(found)
}

fn signals(table: &Table, spec: &ImpactSpec, key: &str) -> Result<HammerSignals, IdentifyError> {
    let read = |name: &str, factor: f64, part: &str| -> Result<Vec<f64>, IdentifyError> {
        let at = || format!("{key}.{part}");
        let values = table
            .column(name)
            .map_err(|error| IdentifyError::new(at(), error))?;
        if let Some(row) = values.iter().position(|value| !value.is_finite()) {
            let message =
                format!("column \"{name}\" holds no number; a spectrum needs every sample");
            return Err(at_row(table, row, at(), message));
        }
        Ok(values.iter().map(|value| value * factor).collect())
    };
    let force = read(&spec.force.column, spec.force.factor, "force")?;
    let response = read(&spec.response.column, spec.response.factor, "motion")?;
    let rate = match &spec.times {
        TimeBase::Rate { hz } => Rate {
            hz: *hz,
            note: None,
        },
        TimeBase::Column { column: name, unit } => {
            let unit = unit_of_times(table, name, unit, spec.is_time_unit_said)
                .map_err(|error| IdentifyError::new(unit_key(spec, key), error))?;
            even_rate(table, &read(name, 1.0, "time")?, unit.si_factor, key)?
        }
    };
    Ok(HammerSignals {
        rate_hz: rate.hz,
        force,
        response,
        note: rate.note,
    })
}

/// The key that is at fault where the unit of the times is.
fn unit_key(spec: &ImpactSpec, key: &str) -> String {
    match spec.is_time_unit_said {
        true => format!("{key}.time_unit"),
        false => format!("{key}.time"),
    }
}

/// What a message about the rate adds where nothing says the unit of the times.
fn assumed_unit(table: &Table, spec: &ImpactSpec) -> String {
    let TimeBase::Column { column, unit } = &spec.times else {
        return String::new();
    };
    if spec.is_time_unit_said || table.units.contains_key(column) {
        return String::new();
    }
    let taken = unit_of_times(table, column, unit, false);
    taken.map_or_else(
        |_| String::new(),
        |unit| {
            format!(
                "; the times in \"{column}\" are taken for {}, since neither the file nor `time_unit` gives \
                 their unit",
                unit.symbol
            )
        },
    )
}

/// Samples at which blows begin: the force rises through the trigger after a time below it.
fn blows(signals: &HammerSignals, spec: &ImpactSpec) -> Vec<usize> {
    let largest = signals.force.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let trigger = spec.trigger_n.unwrap_or(0.1 * largest);
    if largest < trigger || largest == 0.0 {
        return Vec::new();
    }
    // A second crossing inside a window is a double blow, treated later.
    let quiet = spec.window_s.unwrap_or(0.25) * signals.rate_hz;
    let mut found: Vec<usize> = Vec::new();
    for (i, force) in signals.force.iter().enumerate() {
        let apart = found.last().is_none_or(|last| (i - last) as f64 > quiet);
        if force.abs() >= trigger && apart {
            found.push(i);
        }
    }
    found
}

/// Samples of a window.
fn window(signals: &HammerSignals, spec: &ImpactSpec, blows: &[usize]) -> Option<usize> {
    let before = (spec.before_s * signals.rate_hz).round() as usize;
    if let Some(window_s) = spec.window_s {
        return (!blows.is_empty()).then(|| before + (window_s * signals.rate_hz).round() as usize);
    }
    let end = signals.force.len() + before;
    let ends = blows.iter().skip(1).copied().chain([end]);
    (blows.iter().zip(ends))
        .map(|(start, end)| end - start)
        .min()
        .filter(|length| *length > before)
}

/// Whether a window holds one blow.
fn single(
    signals: &HammerSignals,
    spec: &ImpactSpec,
    start: usize,
    length: usize,
    before: usize,
) -> bool {
    let force = &signals.force[start..start + length];
    let peak = (0..force.len()).fold(0, |best, i| {
        if force[i].abs() > force[best].abs() {
            i
        } else {
            best
        }
    });
    let largest = force[peak].abs();
    let trigger = spec.trigger_n.unwrap_or(0.1 * largest).min(0.1 * largest);
    // The first blow ends where the force falls below the trigger; then it must stay small.
    let end = (peak..force.len()).find(|&i| force[i].abs() < trigger);
    let later = end.map_or(&[][..], |end| &force[end..]);
    let early = &force[..peak.min(before.saturating_sub(1))];
    let small = |part: &[f64]| part.iter().all(|f| f.abs() < DOUBLE * largest);
    small(later) && small(early)
}

/// Remaining response at the end of its windows, if too large.
fn still_ringing(
    signals: &HammerSignals,
    spec: &ImpactSpec,
    windows: &[usize],
    length: usize,
) -> Option<f64> {
    let tenth = (length / 10).max(1);
    let decay =
        (spec.exponential_s).map_or(1.0, |tau| (-(length as f64) / signals.rate_hz / tau).exp());
    let worst = windows.iter().map(|&start| {
        let window = &signals.response[start..start + length];
        // Relative to the largest tenth: a window begins before its blow.
        let first = window.chunks(tenth).map(deviation).fold(0.0, f64::max);
        decay * deviation(&window[length - tenth..]) / first.max(f64::MIN_POSITIVE)
    });
    Some(worst.fold(0.0, f64::max)).filter(|left| *left > RUNG_DOWN)
}

fn average(
    signals: &HammerSignals,
    spec: &ImpactSpec,
    windows: &[usize],
    length: usize,
    band_hz: [f64; 2],
) -> Frf {
    let count = length / 2 + 1;
    let (mut ff, mut xx) = (vec![0.0; count], vec![0.0; count]);
    let mut fx = vec![Complex::new(0.0, 0.0); count];
    let before = (spec.before_s * signals.rate_hz).round() as usize;
    for &start in windows {
        let spectrum = |signal: &[f64]| {
            // The signal before the blow is the sensor's offset.
            let rest =
                signal[start..start + before.max(1)].iter().sum::<f64>() / before.max(1) as f64;
            let offset = if before >= 4 { rest } else { 0.0 };
            let window: Vec<f64> = (signal[start..start + length].iter().enumerate())
                .map(|(i, x)| {
                    let t = i as f64 / signals.rate_hz;
                    (x - offset) * spec.exponential_s.map_or(1.0, |tau| (-t / tau).exp())
                })
                .collect();
            fft::forward(window, length)
        };
        let (force, response) = (spectrum(&signals.force), spectrum(&signals.response));
        for k in 0..count {
            ff[k] += force[k].norm_sqr();
            xx[k] += response[k].norm_sqr();
            fx[k] += force[k].conj() * response[k];
        }
    }
    let hz = |k: usize| k as f64 * signals.rate_hz / length as f64;
    let used: Vec<usize> = (1..count)
        .filter(|&k| hz(k) >= band_hz[0] && hz(k) <= band_hz[1] && ff[k] > 0.0)
        .collect();
    let value: Vec<Complex<f64>> = used.iter().map(|&k| fx[k] / ff[k]).collect();
    // The coherence of a single blow is 1.
    let coherence: Option<Vec<f64>> = (windows.len() > 1).then(|| {
        let of = |k: usize| (fx[k].norm_sqr() / (ff[k] * xx[k]).max(f64::MIN_POSITIVE)).min(1.0);
        used.iter().map(|&k| of(k)).collect()
    });
    Frf {
        source: String::new(),
        frequency_hz: used.iter().map(|&k| hz(k)).collect(),
        noise: coherence
            .as_ref()
            .map(|one| noise(&value, one, windows.len())),
        value,
        coherence,
        kind: spec.kind,
        excitation: spec.struck,
        response: spec.observed,
        notes: Vec::new(),
    }
}
