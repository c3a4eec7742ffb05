//! Outputs that are not what they should be: never changing, with spikes, or a column read twice.

use super::resample::Series;
use super::{ChannelMapping, DataError, Mapping, Role, SPIKE, replace_spikes};

/// Sentences on columns that are two channels.
pub(super) fn read_twice(mapping: &Mapping) -> impl Iterator<Item = String> + '_ {
    let channels = mapping.channels.iter().enumerate();
    channels.filter_map(|(index, channel)| {
        let mut before = mapping.channels[..index].iter();
        let first = before.find(|one| one.terms == channel.terms)?;
        Some(format!(
            "column \"{}\" is read twice, as {} and as {}: check the columns",
            channel.source(),
            first.channel,
            channel.channel
        ))
    })
}

/// An output whose samples are all the same: a sensor that is off, or steps coarser than what it
/// was to show.
pub(super) fn constant(channel: &ChannelMapping, series: &Series) -> bool {
    let first = series.values[0];
    channel.role == Role::Output && series.values.iter().all(|value| *value == first)
}

/// The sentence on it.
pub(super) fn left_out(channel: &ChannelMapping, series: &Series) -> String {
    format!(
        "{}: column \"{}\" is left out: every sample is {} {}, so that nothing was measured; check the column",
        channel.channel,
        channel.source(),
        series.values[0],
        channel.unit.unit
    )
}

/// Refuses data of which no output changes.
pub(super) fn refuse_all_constant(
    source: &str,
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
        source_name: source.to_owned(),
        column: channel.source(),
        channel: channel.channel.clone(),
        message: format!(
            "every sample is {} {}, so that nothing was measured{others}",
            series.values[0], channel.unit.unit
        ),
    })
}

/// The channel's spikes replaced; the sentence on them.
pub(super) fn without_spikes(channel: &ChannelMapping, series: &mut Series) -> Option<String> {
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
