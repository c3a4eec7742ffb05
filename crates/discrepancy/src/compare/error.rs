//! Why measured data cannot be compared with a simulation.

use truecut_recording::{UnknownName, significant};

use super::suspicion::UnitSuspicion;

/// Data that cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// Nothing is measured that could be compared.
    #[error("no channel has the role \"output\": there is nothing to compare")]
    NoOutput,
    /// A measured channel that the simulation lacks.
    #[error("{error}")]
    Unknown {
        /// The channel.
        channel: String,
        /// What it may have been.
        error: UnknownName,
    },
    /// A channel measured in another dimension than simulated.
    #[error("channel \"{channel}\" is measured in {measured}, but simulated in {simulated}")]
    Dimension {
        /// The channel.
        channel: String,
        /// Unit of the measured values.
        measured: truecut_recording::Unit,
        /// Unit of the simulated values.
        simulated: truecut_recording::Unit,
    },
    /// The run ends before the data begin to say anything.
    #[error(
        "the run covers {} s of the {} s of data; it must cover at least half",
        significant(*.simulated_s, 4),
        significant(*.measured_s, 4)
    )]
    NoCommonTime {
        /// How long the run is, s.
        simulated_s: f64,
        /// How long the data are, s.
        measured_s: f64,
    },
    /// Too few samples.
    #[error("channel \"{channel}\" has {counted} samples that count; at least {least} are needed")]
    TooFew {
        /// The channel.
        channel: String,
        /// How many count.
        counted: usize,
        /// How many are needed.
        least: usize,
    },
    /// Values that are not numbers.
    #[error("channel \"{channel}\": a {whose} value is not finite")]
    NotFinite {
        /// The channel.
        channel: String,
        /// Measured or simulated.
        whose: &'static str,
    },
    /// A sensor that shows nothing.
    #[error("channel \"{channel}\" never changes: it is {value} throughout; check the column")]
    Constant {
        /// The channel.
        channel: String,
        /// Its value.
        value: String,
    },
    /// A residual so absurd that the unit must be wrong.
    #[error("channel \"{channel}\": {suspicion}")]
    Unit {
        /// The channel.
        channel: String,
        /// The factor that would fit.
        suspicion: UnitSuspicion,
    },
}

impl CompareError {
    /// The measured channel that it is about, if it is one.
    pub fn channel(&self) -> Option<&str> {
        match self {
            CompareError::NoOutput | CompareError::NoCommonTime { .. } => None,
            CompareError::Unknown { channel, .. }
            | CompareError::Dimension { channel, .. }
            | CompareError::TooFew { channel, .. }
            | CompareError::NotFinite { channel, .. }
            | CompareError::Constant { channel, .. }
            | CompareError::Unit { channel, .. } => Some(channel),
        }
    }
}
