//! The rules by which a stretch of a channel becomes one number, as data.

use strum::IntoStaticStr;

use crate::unit::Unit;

/// How a stretch of a channel becomes one number.
#[derive(Clone, Copy, Debug, PartialEq, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum Reducer {
    /// Largest |x|.
    Peak,
    /// Largest x.
    Max,
    /// Smallest x.
    Min,
    /// Mean over time.
    Mean,
    /// Root mean square over time.
    Rms,
    /// The last value.
    Final,
    /// Largest minus smallest.
    Range,
    /// Half of the range.
    Amplitude,
    /// Largest length of the vector whose components are the channels.
    PeakNorm,
    /// First time from which |x| stays above a threshold.
    FirstTimeAbove {
        /// In the channel's unit, SI.
        threshold: f64,
        /// For so long.
        hold_s: f64,
    },
    /// How long |x| is above a threshold, in all.
    DurationAbove {
        /// In the channel's unit, SI.
        threshold: f64,
    },
    /// Frequency of the highest spectral line in a band.
    SpectralLine {
        /// Lower and upper end.
        band_hz: [f64; 2],
    },
    /// Amplitude of the highest spectral line in a band.
    SpectralAmplitude {
        /// Lower and upper end.
        band_hz: [f64; 2],
    },
}

impl Reducer {
    /// What a scenario writes for this one.
    pub fn name(&self) -> &'static str {
        self.into()
    }

    /// The unit of the result, given that of the channel.
    pub fn unit(&self, channel: Unit) -> Unit {
        match self {
            Reducer::FirstTimeAbove { .. } | Reducer::DurationAbove { .. } => Unit::Second,
            Reducer::SpectralLine { .. } => Unit::Hertz,
            _ => channel,
        }
    }
}
