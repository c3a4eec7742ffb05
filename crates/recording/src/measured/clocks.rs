//! The clocks of a log: when a message was written down, and when its sender stamped it.

use super::{DataError, Mapping, Table, TimeBase};
use crate::unit::significant;

/// Column of the times at which messages were written down, by the recorder's clock.
pub const LOG_TIME: &str = "log_time";
/// Column of the times in the headers of the messages, by their senders' clocks.
pub const HEADER_STAMP: &str = "header_stamp";

/// Stamps of two senders count as of one clock if their delays until they are written down differ
/// by less, s: a message takes milliseconds, clocks that nobody set are minutes apart.
const AGREE_S: f64 = 0.1;

/// Refuses header stamps of topics whose clocks disagree.
pub(super) fn agree(source: &str, tables: &[&Table], mapping: &Mapping) -> Result<(), DataError> {
    let TimeBase::Column { column, .. } = &mapping.time else {
        return match tables {
            [_] => Ok(()),
            _ => Err(DataError::File {
                source_name: source.to_owned(),
                message: format!(
                    "its topics have times of their own: give `time = \"{HEADER_STAMP}\"` or \
                     \"{LOG_TIME}\" in place of `rate_hz`"
                ),
            }),
        };
    };
    if column != HEADER_STAMP {
        return Ok(());
    }
    let delays = tables
        .iter()
        .filter_map(|table| Some((*table, delay_s(table)?)));
    let mut delays: Vec<(&Table, f64)> = delays.collect();
    delays.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (Some((early, least)), Some((late, most))) = (delays.first(), delays.last()) else {
        return Ok(());
    };
    if most - least <= AGREE_S {
        return Ok(());
    }
    let seconds = |value: f64| significant(value, 4);
    Err(DataError::File {
        source_name: source.to_owned(),
        message: format!(
            "two clocks disagree: in the median a message of {} was written down {} s after its \
             header's stamp, one of {} {} s after; they may differ by {AGREE_S} s. Use \
             `time = \"{LOG_TIME}\"`, or mend the stamps",
            early.source,
            seconds(*least),
            late.source,
            seconds(*most)
        ),
    })
}

/// Median time from stamp to log, s; `None` without stamps.
pub(super) fn delay_s(table: &Table) -> Option<f64> {
    let mut delays = delays_s(table)?;
    let middle = delays.len() / 2;
    (middle < delays.len()).then(|| *delays.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Times from stamp to log, s, message by message.
pub(super) fn delays_s(table: &Table) -> Option<Vec<f64>> {
    let (log, stamp) = (
        table.column(LOG_TIME).ok()?,
        table.column(HEADER_STAMP).ok()?,
    );
    let both = log.iter().zip(stamp).map(|(log, stamp)| log - stamp);
    Some(both.filter(|delay| delay.is_finite()).collect())
}
