//! Channels in the viewer: curves and states.

use super::store::{Logged, Store};
use re_sdk_types::archetypes::{Scalars, SeriesLines, StateChange, StateConfiguration};
use re_sdk_types::components::Color;
use truecut_recording::{Chunk, Header};

use super::time_column;
use crate::decimate::{BEHIND_ROWS_PER_SECOND, ROWS_PER_SECOND, rows_to_draw};
use crate::display::{Group, LIFTED, Place, SLIDING, Series};

/// Logs every curve's name and colour, once.
pub(super) fn begin(stream: &Store, groups: &[Group]) -> Logged<()> {
    for group in groups {
        let color = |series: &Series| {
            let [r, g, b] = series.color;
            Color::from_rgb(r, g, b)
        };
        let style = SeriesLines::new()
            .with_names(group.series.iter().map(|series| series.legend.as_str()))
            .with_colors(group.series.iter().map(color))
            .with_widths(group.series.iter().map(|_| 1.5_f32));
        stream.log_static(group.entity.as_str(), &style)?;
    }
    Ok(())
}

/// Logs the curves of a chunk, one call for each plot: its channels share their rows.
pub(super) fn chunk(stream: &Store, groups: &[Group], chunk: &Chunk<'_>) -> Logged<()> {
    let mut rows = Vec::new();
    for group in groups {
        let columns: Vec<&[f64]> = group
            .series
            .iter()
            .map(|series| chunk.columns[series.channel])
            .collect();
        let rate = match group.place {
            Place::Behind => BEHIND_ROWS_PER_SECOND,
            Place::Front | Place::FrontWithSpectrum => ROWS_PER_SECOND,
        };
        rows_to_draw(chunk.time_s, &columns, rate, &mut rows);
        let times = time_column(rows.iter().map(|&row| chunk.time_s[row]));
        let of_row = |row: usize| {
            let curves = group.series.iter().zip(&columns);
            curves.map(move |(series, values)| series.unit.from_si(values[row]))
        };
        let scalars = Scalars::new(rows.iter().flat_map(|&row| of_row(row)))
            .columns(std::iter::repeat_n(group.series.len(), rows.len()))?;
        stream.send_columns(group.entity.as_str(), [times], scalars)?;
    }
    Ok(())
}

/// Where the state of the foot is logged.
pub(super) const FOOT_STATE: &str = "/states/foot";

/// The foot's state over time, of which only the changes are logged.
pub(super) struct FootState {
    sliding: usize,
    lifted: Option<usize>,
    last: Option<&'static str>,
}

impl FootState {
    /// `None` if the recording has no foot.
    pub(super) fn begin(stream: &Store, header: &Header) -> Logged<Option<FootState>> {
        let Ok(sliding) = header.index_of(SLIDING) else {
            return Ok(None);
        };
        let colors = [[70, 140, 80], [215, 80, 60], [120, 120, 120]];
        let style = StateConfiguration::new()
            .with_values(["sticks", "slides", "lifted"])
            .with_labels(["sticks", "SLIDES", "lifted off"])
            .with_colors(colors.map(|[r, g, b]| Color::from_rgb(r, g, b)));
        stream.log_static(FOOT_STATE, &style)?;
        Ok(Some(FootState {
            sliding,
            lifted: header.index_of(LIFTED).ok(),
            last: None,
        }))
    }

    pub(super) fn chunk(&mut self, stream: &Store, chunk: &Chunk<'_>) -> Logged<()> {
        let lifted = self.lifted.map(|column| chunk.columns[column]);
        let mut changes: (Vec<f64>, Vec<&str>) = Default::default();
        for (row, (time_s, sliding)) in chunk
            .time_s
            .iter()
            .zip(chunk.columns[self.sliding])
            .enumerate()
        {
            let state = match lifted {
                Some(lifted) if lifted[row] > 0.5 => "lifted",
                _ if *sliding > 0.5 => "slides",
                _ => "sticks",
            };
            if self.last != Some(state) {
                self.last = Some(state);
                changes.0.push(*time_s);
                changes.1.push(state);
            }
        }
        if changes.0.is_empty() {
            return Ok(());
        }
        let columns = StateChange::new()
            .with_state(changes.1)
            .columns_of_unit_batches()?;
        stream.send_columns(FOOT_STATE, [time_column(changes.0.into_iter())], columns)
    }
}
