//! What the end of a recording needs of its rows: the run does not keep all channels.

use truecut_recording::{Chunk, Header};

use crate::display::{Group, Place};

/// Of all channels the largest size, of those with a spectrum all values.
pub(super) struct Seen {
    largest: Vec<f64>,
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
            largest: vec![0.0; count],
            columns: vec![Vec::new(); count],
            has_spectrum,
        }
    }

    pub(super) fn chunk(&mut self, chunk: &Chunk<'_>) {
        for (at, values) in chunk.columns.iter().enumerate() {
            let sizes = values.iter().map(|value| value.abs());
            self.largest[at] = sizes.fold(self.largest[at], f64::max);
            if self.has_spectrum[at] {
                self.columns[at].extend_from_slice(values);
            }
        }
    }

    /// The largest size of a channel; what is no number does not count.
    pub(super) fn largest(&self, channel: usize) -> f64 {
        self.largest[channel]
    }

    /// All values of a channel with a spectrum.
    pub(super) fn column(&self, channel: usize) -> &[f64] {
        &self.columns[channel]
    }
}
