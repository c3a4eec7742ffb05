//! From columns to channels: times, units, masks, checks.

use super::clocks;
use super::combination::Columns;
use super::outputs::{constant, left_out, read_twice, refuse_all_constant, without_spikes};
use super::resample::{Base, Gaps, Series, median_interval_s, missing_rows, resample};
use super::time_unit::unit_of_times;
use super::times::time_note;
use super::{
    ChannelMapping, DataError, MIN_SAMPLES, Mapping, Measured, MeasuredChannel, Pass, Role, Table,
    Tables, TimeBase,
};
use crate::recording::ChannelSpec;
use crate::unit::{UserUnit, significant};

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
    // One table is its own list, without a copy of its columns.
    let used = Used::of(table, mapping)?;
    let places = vec![0; mapping.channels.len()];
    assemble(&table.source, mapping, &[used], &places)
}

/// The same of a file with several tables, such as a log: each channel has the times of its own
/// table. The result has the rate of the slowest of those that are used, so that nothing is
/// invented between samples, unless the mapping says another.
///
/// # Errors
/// As [`measured`]; topics that cannot be read; header stamps of clocks that disagree.
pub fn measured_of(tables: &Tables, mapping: &Mapping) -> Result<Measured, DataError> {
    if let [table] = &tables.tables[..]
        && tables.unread.is_empty()
    {
        return measured(table, mapping);
    }
    let (mut found, mut places) = (Vec::new(), Vec::new());
    for channel in &mapping.channels {
        let index = place_of(tables, channel)?;
        let place = found.iter().position(|one| *one == index);
        places.push(place.unwrap_or(found.len()));
        if place.is_none() {
            found.push(index);
        }
    }
    let chosen: Vec<&Table> = found.iter().map(|index| &tables.tables[*index]).collect();
    clocks::agree(&tables.source, &chosen, mapping)?;
    let used: Result<Vec<Used>, DataError> = (chosen.iter())
        .map(|table| Used::of(table, mapping))
        .collect();
    assemble(&tables.source, mapping, &used?, &places)
}

/// The table that has the columns of a channel: all of them, since tables have times of their own.
fn place_of(tables: &Tables, channel: &ChannelMapping) -> Result<usize, DataError> {
    let mut found = None;
    for term in &channel.terms {
        let index = tables.index_of(&term.column)?;
        let first = *found.get_or_insert(index);
        if index != first {
            let [first, other] = [first, index].map(|at| &tables.tables[at].source);
            return Err(DataError::Channel {
                source_name: tables.source.clone(),
                column: channel.source(),
                channel: channel.channel.clone(),
                message: format!(
                    "its columns are of {first} and of {other}, but must be of one topic: only these have times \
                     in common"
                ),
            });
        }
    }
    // A channel has at least one column.
    Ok(found.unwrap_or_default())
}

/// The rows of a table that are used.
struct Used<'a> {
    table: &'a Table,
    rows: Vec<usize>,
    time_s: Vec<f64>,
}

impl Used<'_> {
    fn of<'a>(table: &'a Table, mapping: &Mapping) -> Result<Used<'a>, DataError> {
        table.usable_by(mapping)?;
        let (rows, time_s) = times(table, mapping)?;
        Ok(Used {
            table,
            rows,
            time_s,
        })
    }
}

/// The channels of a mapping from the tables that hold them, `places` says which.
fn assemble(
    source: &str,
    mapping: &Mapping,
    used: &[Used],
    places: &[usize],
) -> Result<Measured, DataError> {
    let mut series = Vec::new();
    for (channel, place) in mapping.channels.iter().zip(places) {
        series.push(read(&used[*place], mapping, channel)?);
    }
    let slowest = |a: &&Used, b: &&Used| {
        median_interval_s(&a.time_s).total_cmp(&median_interval_s(&b.time_s))
    };
    // A mapping has channels, each of a table: there is one.
    let empty: &[f64] = &[];
    let base_s = used.iter().max_by(slowest).map_or(empty, |one| &one.time_s);
    refuse_all_constant(source, mapping, &series)?;
    let base = Base::new(source, mapping, base_s, &series)?;
    let mut notes = base.notes(mapping);
    for one in used {
        notes.extend(one.table.notes.iter().cloned());
        notes.extend(missing_note(one, used.len()));
        let is_unit_said = mapping.is_time_unit_said;
        notes.extend(time_note(one.table, &mapping.time, is_unit_said));
    }
    notes.extend(read_twice(mapping));
    let combined = mapping.channels.iter().filter(|one| one.is_combined());
    notes.extend(combined.map(|one| format!("{} is {}", one.channel, one.whole_formula())));
    let channels = channels(mapping, &mut series, &base, &mut notes);
    let mut time_s = base.times();
    let mut passes = passes(source, mapping, &base, &time_s)?;
    let starts = passes.iter_mut().map(|pass| &mut pass.start_s);
    for time in time_s.iter_mut().chain(starts) {
        *time *= mapping.clock_rate;
    }
    if !passes.is_empty() {
        notes.push(format!(
            "{} passes, each from the process's own start",
            passes.len()
        ));
    }
    Ok(Measured {
        source: source.to_owned(),
        time_s,
        passes,
        channels,
        notes,
    })
}

fn missing_note(used: &Used, tables: usize) -> Option<String> {
    let missing = missing_rows(&used.time_s);
    let whose = match tables {
        1 => String::new(),
        _ => format!("{}: ", used.table.source),
    };
    (missing > 0).then(|| {
        format!(
            "{whose}{missing} rows seem to be missing: what drives the model is bridged there by cubics, what is \
             compared by lines"
        )
    })
}

fn channels(
    mapping: &Mapping,
    series: &mut [Series],
    base: &Base,
    notes: &mut Vec<String>,
) -> Vec<MeasuredChannel> {
    let mut channels = Vec::new();
    for (channel, series) in mapping.channels.iter().zip(series) {
        if constant(channel, series) {
            notes.push(left_out(channel, series));
            continue;
        }
        if mapping.bridge_spikes && channel.role == Role::Output && series.is_smoothed(base) {
            notes.extend(without_spikes(channel, series));
        }
        let gaps = Gaps {
            bridged_s: mapping.max_gap_s,
            smoothly_s: match channel.role {
                Role::Input => mapping.max_gap_s,
                Role::Output => 0.0,
            },
            drives: channel.role == Role::Input,
        };
        let (values, valid) = resample(series, base, gaps);
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
                match channel.is_combined() {
                    true => format!("Measured: {}", channel.whole_formula()),
                    false => format!("Measured: column {}", channel.source()),
                },
            ),
            role: channel.role,
            values,
            valid,
            noise: (channel.noise).map(|noise| series.noise_left(noise, base, gaps)),
            white_kept: series.white_kept(base),
        });
    }
    channels
}

/// Fewest samples of a pass.
const MIN_PASS: usize = 60;

/// The passes that begin at the mapping's starts; each ends where the next begins.
fn passes(
    source: &str,
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
                source_name: source.to_owned(),
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
            let unit = unit_of_times(table, column, unit, mapping.is_time_unit_said)?;
            (table.column(column)?.iter().map(|t| t * unit.si_factor)).collect()
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
        // Times are rounded; the ends belong to the window. Seconds since 1970 are known to 0.2 µs.
        let slack = 1e-9 + 4.0 * f64::EPSILON * t.abs();
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
fn read(used: &Used, mapping: &Mapping, channel: &ChannelMapping) -> Result<Series, DataError> {
    let table = used.table;
    let columns = Columns::of(table, &channel.terms)?;
    let offset = channel.offset * channel.unit.si_factor;
    let factor = channel.scale * channel.unit.si_factor;
    let mut series = Series::default();
    let refuse = |message: String| DataError::Channel {
        source_name: table.source.clone(),
        column: channel.source(),
        channel: channel.channel.clone(),
        message,
    };
    unit_agrees(table, channel).map_err(refuse)?;
    for (&row, &t) in used.rows.iter().zip(&used.time_s) {
        let is_at_end = (channel.saturation).is_some_and(|[low, high]| {
            let mut readings = columns.readings(row);
            readings.any(|reading| reading <= low || reading >= high)
        });
        let sum = columns.sum(row);
        let value = sum * factor + offset;
        if columns.readings(row).any(|reading| !reading.is_finite()) || is_at_end {
            let count = match is_at_end {
                true => &mut series.saturated,
                false => &mut series.missing,
            };
            *count += 1;
            series.first_masked.get_or_insert_with(|| table.place(row));
        } else if value.is_nan() || value.abs() > LARGEST {
            return Err(refuse(format!(
                "{}: {sum:e} is not a measurement, which is at most {LARGEST:e} in SI units; leave the cell empty, or \
                 give `saturation`",
                table.place(row)
            )));
        } else {
            series.time_s.push(t);
            series.values.push(value);
        }
    }
    check(&series, mapping, channel).map_err(refuse)?;
    Ok(series)
}

/// A unit that the file gives its column is the one that the mapping says, where nothing scales it
/// (a sign may): columns that are added as they are must have it all.
fn unit_agrees(table: &Table, channel: &ChannelMapping) -> Result<(), String> {
    let mut terms = channel.terms.iter();
    if terms.any(|term| (term.factor * channel.scale).abs() != 1.0) {
        return Ok(());
    }
    let mut terms = channel.terms.iter();
    terms.try_for_each(|term| column_unit_agrees(table, &term.column, channel))
}

fn column_unit_agrees(table: &Table, column: &str, channel: &ChannelMapping) -> Result<(), String> {
    let Some(written) = table.units.get(column) else {
        return Ok(());
    };
    match UserUnit::parse(written) {
        Ok(found)
            if (found.unit, found.si_factor) != (channel.unit.unit, channel.unit.si_factor) =>
        {
            Err(format!(
                "the file gives its unit as \"{written}\", but the scenario as \"{}\"; \
                 give the file's, or a `scale` that makes one of the other",
                channel.unit.symbol
            ))
        }
        _ => Ok(()),
    }
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
