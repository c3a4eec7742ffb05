//! Outputs of measured data that stand at an end of what they read, as those of a sensor at the end
//! of its range do.

use truecut_recording::measured::{ChannelMapping, Role, Tables, column_facts};
use truecut_recording::{Unit, short_number};

/// Least part of a column's rows that is told.
const PART: f64 = 0.005;
/// And so many times as many as at the reading next to it: a peak in steps stands at its top some
/// 2.4 times as long as at the step below.
const PILED: usize = 5;

/// A sentence on each column of an output that may be saturated and of which the scenario does not
/// say so. Coordinates are none: they stand where a joint does. Nothing is left out for it.
pub(crate) fn notes(tables: &Tables, channels: &[ChannelMapping]) -> Vec<String> {
    let may_be = |one: &&ChannelMapping| {
        let is_coordinate = [Unit::Radian, Unit::Metre].contains(&one.unit.unit);
        one.role == Role::Output && one.saturation.is_none() && !is_coordinate
    };
    let columns = channels.iter().filter(may_be).flat_map(|channel| {
        let terms = channel.terms.iter();
        terms.map(|term| (channel.channel.as_str(), term.column.as_str()))
    });
    let told = columns.filter_map(|(channel, column)| {
        let table = &tables.tables[tables.index_of(column).ok()?];
        note(channel, column, table.column(column).ok()?)
    });
    told.collect()
}

fn note(channel: &str, column: &str, values: &[f64]) -> Option<String> {
    let found = column_facts(column, values, None);
    let [low, high] = found.range?;
    let [at_low, at_high] = found.at_ends;
    let next = |side: f64, end: f64| {
        let inner = values.iter().filter(|value| side * **value < side * end);
        let next = inner.fold(f64::NEG_INFINITY, |next, value| next.max(side * value));
        values.iter().filter(|value| side * **value == next).count()
    };
    let least = PART * values.len() as f64;
    let is_end = |rows: usize, side: f64, end: f64| {
        // Nothing measured is no end of a range.
        end != 0.0 && rows as f64 >= least && rows > PILED * next(side, end)
    };
    let ends = [is_end(at_low, -1.0, low), is_end(at_high, 1.0, high)];
    // The other end is not known: as far off, where that is beyond what was read.
    let keys = match ends {
        [true, true] => [low, high],
        [true, false] => [low, high.max(-low)],
        [false, true] => [low.min(-high), high],
        [false, false] => return None,
    };
    let pairs = ends.into_iter().zip([(at_low, low), (at_high, high)]);
    let (rows, at): (Vec<usize>, Vec<String>) = pairs
        .filter(|(is_end, _)| *is_end)
        .map(|(_, (rows, end))| (rows, short_number(end)))
        .unzip();
    Some(format!(
        "{channel}: {} of {} rows of column \"{column}\" stand at {}, beyond which it reads nothing: if that is the end \
         of its range they are no measurements, and saturation = [{:?}, {:?}] in its [[data.channel]] leaves them out",
        rows.iter().sum::<usize>(),
        values.len(),
        at.join(" and "),
        keys[0],
        keys[1]
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use truecut_recording::UserUnit;
    use truecut_recording::measured::{Column, Table, Term};

    fn told(unit: &str, saturation: Option<[f64; 2]>, reading: &dyn Fn(f64) -> f64) -> Vec<String> {
        let values = (0..2000).map(|k| reading(800.0 * (0.013 * f64::from(k)).sin()));
        let table = Table {
            columns: vec![Column {
                name: "M 2".into(),
                values: values.collect(),
            }],
            ..Table::default()
        };
        let channel = ChannelMapping {
            terms: vec![Term::from("M 2")],
            channel: "joint2.drive_torque".into(),
            unit: UserUnit::parse(unit).unwrap(),
            scale: 1.0,
            offset: 0.0,
            role: Role::Output,
            noise: None,
            saturation,
        };
        notes(&Tables::from(table), &[channel])
    }

    #[test]
    fn a_torque_that_stands_at_an_end_is_told_with_the_key_that_leaves_it_out() {
        let found = told("N m", None, &|x| x.max(-600.0));
        let [note] = &found[..] else {
            panic!("{found:?}")
        };
        assert!(note.starts_with("joint2.drive_torque: "), "{note}");
        assert!(
            note.contains("of 2000 rows of column \"M 2\" stand at -600,"),
            "{note}"
        );
        // 800 was read: the other end is beyond it.
        let largest = (0..2000).map(|k| 800.0 * (0.013 * f64::from(k)).sin());
        let largest = largest.fold(0.0, f64::max);
        assert!(
            note.contains(&format!("saturation = [-600.0, {largest:?}]")),
            "{note}"
        );
        let found = told("N m", None, &|x| x.clamp(-700.0, 500.0));
        assert!(found[0].contains("stand at -700 and 500,"), "{found:?}");
        assert!(
            found[0].contains("saturation = [-700.0, 500.0]"),
            "{found:?}"
        );
        // Less than that was read: the other end is taken to be as far off.
        let found = told("N m", None, &|x| (x + 500.0).min(900.0));
        assert!(
            found[0].contains("saturation = [-900.0, 900.0]"),
            "{found:?}"
        );
    }

    /// Peaks as they are and in steps, a sensor that rests at zero, a joint that stands at the end
    /// of its motion, and what the scenario says itself.
    #[test]
    fn what_is_no_end_of_a_range_is_not_told() {
        assert!(told("N m", None, &|x| x).is_empty());
        assert!(told("N m", None, &|x| 40.0 * (x / 40.0).round()).is_empty());
        assert!(told("N", None, &|x| x.max(0.0)).is_empty());
        assert!(told("deg", None, &|x| x.max(-600.0)).is_empty());
        let said = Some([-600.0, 1000.0]);
        assert!(told("N m", said, &|x| x.max(-600.0)).is_empty());
    }
}
