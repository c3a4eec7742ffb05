//! Why measured data cannot be compared with a simulation.

use truecut_recording::{UnknownName, significant};

use super::suspicion::{Exchange, UnitSuspicion};

/// Data that cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// No measured output.
    #[error("no channel has the role \"output\": there is nothing to compare")]
    NoOutput,
    /// A measured channel that the simulation lacks.
    #[error("{error}")]
    Unknown {
        /// The channel.
        channel: String,
        /// Similar names.
        error: UnknownName,
    },
    /// Measured and simulated units differ in dimension.
    #[error("channel \"{channel}\" is measured in {measured}, but simulated in {simulated}")]
    Dimension {
        /// The channel.
        channel: String,
        /// Unit of the measured values.
        measured: truecut_recording::Unit,
        /// Unit of the simulated values.
        simulated: truecut_recording::Unit,
    },
    /// The run is shorter than half of the data.
    #[error(
        "the run covers {} s of the {} s of data; it must cover at least half",
        significant(*.simulated_s, 4),
        significant(*.measured_s, 4)
    )]
    NoCommonTime {
        /// Duration of the run, s.
        simulated_s: f64,
        /// Duration of the data, s.
        measured_s: f64,
    },
    /// Too few samples.
    #[error("channel \"{channel}\" has {counted} samples that count; at least {least} are needed")]
    TooFew {
        /// The channel.
        channel: String,
        /// Number of valid samples.
        counted: usize,
        /// Number needed.
        least: usize,
    },
    /// Values that are not finite.
    #[error("channel \"{channel}\": a {whose} value is not finite")]
    NotFinite {
        /// The channel.
        channel: String,
        /// Measured or simulated.
        whose: &'static str,
    },
    /// A measured channel that never changes.
    #[error("channel \"{channel}\" never changes: it is {value} throughout; check the column")]
    Constant {
        /// The channel.
        channel: String,
        /// Its value.
        value: String,
    },
    /// A residual so large that the unit must be wrong.
    #[error("channel \"{channel}\": {suspicion}")]
    Unit {
        /// The channel.
        channel: String,
        /// The factor that would fit.
        suspicion: UnitSuspicion,
    },
    /// Channels that fit each other's simulation.
    #[error("{0}")]
    Exchanged(Exchange),
}

impl CompareError {
    /// The measured channel concerned, if any.
    pub fn channel(&self) -> Option<&str> {
        match self {
            CompareError::NoOutput | CompareError::NoCommonTime { .. } => None,
            CompareError::Exchanged(exchange) => {
                exchange.moved.first().map(|one| one.channel.as_str())
            }
            CompareError::Unknown { channel, .. }
            | CompareError::Dimension { channel, .. }
            | CompareError::TooFew { channel, .. }
            | CompareError::NotFinite { channel, .. }
            | CompareError::Constant { channel, .. }
            | CompareError::Unit { channel, .. } => Some(channel),
        }
    }
}
