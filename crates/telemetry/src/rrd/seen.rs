//! What the end of a recording needs of its rows: the run does not keep all channels.

use truecut_recording::{Chunk, Header};

use super::outline::Outline;

use crate::display::{Group, Place};

/// Of all channels the outline, of those with a spectrum all values.
pub(super) struct Seen {
    outlines: Vec<Outline>,
    /// A column for each channel, empty for those without a spectrum.
    columns: Vec<Vec<f64>>,
    has_spectrum: Vec<bool>,
}

impl Seen {
    /// Before the first row.
    pub(super) fn begin(header: &Header, groups: &[Group]) -> Seen {
        let count = header.channels.len();
        let mut has_spectrum = vec![false; count];
        let with_spectrum = groups
            .iter()
            .filter(|group| group.place == Place::FrontWithSpectrum);
        for series in with_spectrum.flat_map(|group| &group.series) {
            has_spectrum[series.channel] = true;
        }
        Seen {
            outlines: vec![Outline::default(); count],
            columns: vec![Vec::new(); count],
            has_spectrum,
        }
    }

    pub(super) fn chunk(&mut self, chunk: &Chunk<'_>) {
        for (at, values) in chunk.columns.iter().enumerate() {
            self.outlines[at].extend(chunk.time_s, values);
            if self.has_spectrum[at] {
                self.columns[at].extend_from_slice(values);
            }
        }
    }

    /// Where a channel goes.
    pub(super) fn outline(&self, channel: usize) -> &Outline {
        &self.outlines[channel]
    }

    /// All values of a channel with a spectrum.
    pub(super) fn column(&self, channel: usize) -> &[f64] {
        &self.columns[channel]
    }
}
