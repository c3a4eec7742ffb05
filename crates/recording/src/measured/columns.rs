//! From columns to channels: times, units, masks, checks.

use super::resample::{Base, Gaps, Series, missing_rows, resample};
use super::{
    ChannelMapping, DataError, MIN_SAMPLES, Mapping, Measured, MeasuredChannel, Pass, Role, SPIKE,
    Table, TimeBase, replace_spikes,
};
use crate::recording::ChannelSpec;
use crate::unit::significant;

/// Maps the columns of `table` to channels on one uniform time base.
///
/// Samples are masked where the file has no number and where the sensor is at its end. Gaps up to
/// `max_gap_s` are bridged; in longer ones the result is not valid. An output that never changes is
/// left out. A channel that is sampled faster than the result is smoothed first, without delay, so
/// that nothing folds back.
///
/// # Errors
/// A missing column, times that do not rise, too few samples, outputs of which none changes.
pub fn measured(table: &Table, mapping: &Mapping) -> Result<Measured, DataError> {
    let (rows, time_s) = times(table, mapping)?;
    let mut series = Vec::new();
    for channel in &mapping.channels {
        series.push(read(table, mapping, channel, &rows, &time_s)?);
    }
    refuse_all_constant(table, mapping, &series)?;
    let base = Base::new(table, mapping, &time_s, &series)?;
    let mut notes = base.notes(mapping);
    let missing = missing_rows(&time_s);
    if missing > 0 {
        notes.push(format!(
            "{missing} rows seem to be missing: what drives the model is bridged there by cubics, what is compared \
             by lines"
        ));
    }
    notes.extend(read_twice(mapping));
    let mut channels = Vec::new();
    for (channel, series) in mapping.channels.iter().zip(&mut series) {
        if constant(channel, series) {
            notes.push(left_out(channel, series));
            continue;
        }
        if mapping.bridge_spikes && channel.role == Role::Output && series.is_smoothed(&base) {
            notes.extend(without_spikes(channel, series));
        }
        let gaps = Gaps {
            bridged_s: mapping.max_gap_s,
            smoothly_s: match channel.role {
                Role::Input => mapping.max_gap_s,
                Role::Output => 0.0,
            },
        };
        let (values, valid) = resample(series, &base, gaps);
        notes.extend(series.note(channel));
        let masked = valid.iter().filter(|valid| !**valid).count();
        if masked > 0 {
            notes.push(format!(
                "{}: {masked} of {} samples have no measurement within {} s and are left out",
                channel.channel,
                valid.len(),
                significant(mapping.max_gap_s, 3)
            ));
        }
        channels.push(MeasuredChannel {
            spec: ChannelSpec::new(
                channel.channel.clone(),
                channel.unit.unit,
                format!("Measured: column {}", channel.column),
            ),
            role: channel.role,
            values,
            valid,
            noise: channel.noise.map(|noise| noise * series.white_share(&base)),
            white_kept: series.white_kept(&base),
        });
    }
    let time_s = base.times();
    let passes = passes(table, mapping, &base, &time_s)?;
    if !passes.is_empty() {
        notes.push(format!(
            "{} passes, each from the process's own start",
            passes.len()
        ));
    }
    Ok(Measured {
        source: table.source.clone(),
        time_s,
        passes,
        channels,
        notes,
    })
}

/// Fewest samples of a pass.
const MIN_PASS: usize = 60;

/// The passes that begin at the mapping's starts; each ends where the next begins.
fn passes(
    table: &Table,
    mapping: &Mapping,
    base: &Base,
    time_s: &[f64],
) -> Result<Vec<Pass>, DataError> {
    let starts: Vec<f64> = (mapping.starts_s.iter())
        .map(|start| start - base.start_s())
        .collect();
    let slack = 1e-6 * base.interval_s();
    let first = |start: f64| time_s.partition_point(|time| *time < start - slack);
    let mut passes = Vec::new();
    for (index, start_s) in starts.iter().enumerate() {
        let end = starts
            .get(index + 1)
            .map_or(time_s.len(), |next| first(*next));
        let samples = first(*start_s)..end;
        if samples.len() < MIN_PASS {
            return Err(DataError::File {
                source_name: table.source.clone(),
                message: format!(
                    "the pass that starts at {} s has {} samples, but at least {MIN_PASS} are needed",
                    mapping.starts_s[index],
                    samples.len()
                ),
            });
        }
        passes.push(Pass {
            samples,
            start_s: *start_s,
        });
    }
    Ok(passes)
}

/// Rows inside the window and their times, which rise strictly.
fn times(table: &Table, mapping: &Mapping) -> Result<(Vec<usize>, Vec<f64>), DataError> {
    let all: Vec<f64> = match &mapping.time {
        TimeBase::Rate { hz } => (0..table.rows()).map(|row| row as f64 / hz).collect(),
        TimeBase::Column { column, unit } => {
            let column = table.column(column)?;
            column.iter().map(|t| t * unit.si_factor).collect()
        }
    };
    let fail = |row: usize, message: String| {
        Err(DataError::Time {
            source_name: table.source.clone(),
            place: table.place(row),
            message,
        })
    };
    let mut before: Option<f64> = None;
    let (mut rows, mut time_s) = (Vec::new(), Vec::new());
    for (row, &t) in all.iter().enumerate() {
        if !t.is_finite() {
            return fail(row, "the time is not a finite number".into());
        }
        if let Some(before) = before.filter(|before| t <= *before) {
            let message = format!("the time is {t} s after {before} s, but times must rise");
            return fail(row, message);
        }
        before = Some(t);
        // Times are rounded; the ends belong to the window.
        let slack = 1e-9 * (1.0 + t.abs());
        if t >= mapping.window_s[0] - slack && t <= mapping.window_s[1] + slack {
            rows.push(row);
            time_s.push(t);
        }
    }
    if rows.len() < MIN_SAMPLES {
        let message = format!(
            "{} rows lie in the part that is used, but at least {MIN_SAMPLES} are needed",
            rows.len()
        );
        return Err(DataError::File {
            source_name: table.source.clone(),
            message,
        });
    }
    Ok((rows, time_s))
}

/// What is larger, SI, is an error code of a logger and no measurement; its square would not be a
/// number for long.
pub const LARGEST: f64 = 1e30;

/// The valid samples of one channel, SI.
fn read(
    table: &Table,
    mapping: &Mapping,
    channel: &ChannelMapping,
    rows: &[usize],
    time_s: &[f64],
) -> Result<Series, DataError> {
    let column = table.column(&channel.column)?;
    let factor = channel.scale * channel.unit.si_factor;
    let mut series = Series::default();
    let refuse = |message: String| DataError::Channel {
        source_name: table.source.clone(),
        column: channel.column.clone(),
        channel: channel.channel.clone(),
        message,
    };
    for (&row, &t) in rows.iter().zip(time_s) {
        let reading = column[row];
        let is_at_end =
            (channel.saturation).is_some_and(|[low, high]| reading <= low || reading >= high);
        if !reading.is_finite() || is_at_end {
            let count = match is_at_end {
                true => &mut series.saturated,
                false => &mut series.missing,
            };
            *count += 1;
            series.first_masked.get_or_insert_with(|| table.place(row));
        } else if (reading * factor).abs() > LARGEST {
            return Err(refuse(format!(
                "{}: {reading:e} is not a measurement, which is at most {LARGEST:e} in SI units; leave the cell empty, or \
                 give `saturation`",
                table.place(row)
            )));
        } else {
            series.time_s.push(t);
            series.values.push(reading * factor);
        }
    }
    check(&series, mapping, channel).map_err(refuse)?;
    Ok(series)
}

fn check(series: &Series, mapping: &Mapping, channel: &ChannelMapping) -> Result<(), String> {
    let twice = mapping
        .channels
        .iter()
        .filter(|one| one.channel == channel.channel);
    if twice.count() > 1 {
        return Err("two columns are mapped to this channel".into());
    }
    if series.values.len() < MIN_SAMPLES {
        return Err(format!(
            "{} samples are left ({} without a number, {} saturated), but at least {MIN_SAMPLES} are needed",
            series.values.len(),
            series.missing,
            series.saturated
        ));
    }
    Ok(())
}

/// Sentences on columns that are two channels.
fn read_twice(mapping: &Mapping) -> impl Iterator<Item = String> + '_ {
    let channels = mapping.channels.iter().enumerate();
    channels.filter_map(|(index, channel)| {
        let mut before = mapping.channels[..index].iter();
        let first = before.find(|one| one.column == channel.column)?;
        Some(format!(
            "column \"{}\" is read twice, as {} and as {}: check the columns",
            channel.column, first.channel, channel.channel
        ))
    })
}

/// An output whose samples are all the same: a sensor that is off, or steps coarser than what it
/// was to show.
fn constant(channel: &ChannelMapping, series: &Series) -> bool {
    let first = series.values[0];
    channel.role == Role::Output && series.values.iter().all(|value| *value == first)
}

fn left_out(channel: &ChannelMapping, series: &Series) -> String {
    format!(
        "{}: column \"{}\" is left out: every sample is {} {}, so that nothing was measured; check the column",
        channel.channel, channel.column, series.values[0], channel.unit.unit
    )
}

fn refuse_all_constant(
    table: &Table,
    mapping: &Mapping,
    series: &[Series],
) -> Result<(), DataError> {
    let outputs = || {
        let pairs = mapping.channels.iter().zip(series);
        pairs.filter(|(channel, _)| channel.role == Role::Output)
    };
    let Some((channel, series)) = outputs().next() else {
        return Ok(());
    };
    if !outputs().all(|(channel, series)| constant(channel, series)) {
        return Ok(());
    }
    let others = match outputs().count() {
        1 => String::new(),
        count => format!("; none of the {count} outputs changes"),
    };
    Err(DataError::Channel {
        source_name: table.source.clone(),
        column: channel.column.clone(),
        channel: channel.channel.clone(),
        message: format!(
            "every sample is {} {}, so that nothing was measured{others}",
            series.values[0], channel.unit.unit
        ),
    })
}

/// The channel's spikes replaced; the sentence on them.
fn without_spikes(channel: &ChannelMapping, series: &mut Series) -> Option<String> {
    let samples = series.values.len();
    let found = replace_spikes(&mut series.values, &vec![true; samples]);
    (found > 0).then(|| {
        format!(
            "{}: {found} of {samples} samples are spikes, more than {SPIKE} deviations off what their \
             neighbours say, and were replaced by that before the channel was smoothed",
            channel.channel
        )
    })
}
