//! What can go wrong before and during a run.

use truecut_arm::{ArmError, ArmErrorKind};
use truecut_recording::{MetricError, SinkError};
use truecut_scenario::ScenarioError;

/// An error of the simulator. A run that diverges is not one of them: it ends with a recording
/// whose outcome says so.
#[derive(Debug, thiserror::Error)]
pub enum SimError {
    /// The robot's files or what was asked of the robot.
    #[error("{0}")]
    Arm(ArmError),
    /// A value of the scenario that only shows as wrong together with the robot; `key` is its path
    /// in the file.
    #[error("`{key}`: {message}")]
    Scenario { key: String, message: String },
    /// A scenario that overrides have made invalid.
    #[error("{0}")]
    Overrides(#[from] Box<ScenarioError>),
    /// A metric that the recording does not have.
    #[error("{0}")]
    Metric(#[from] MetricError),
    /// The recording cannot be written.
    #[error("{0}")]
    Sink(#[from] SinkError),
}

impl From<ArmError> for SimError {
    fn from(error: ArmError) -> Self {
        match error.kind() {
            ArmErrorKind::ToolTooHeavy { .. } => {
                Self::too_heavy("process.milling.cutter.mode", error)
            }
            _ => Self::Arm(error),
        }
    }
}

impl From<ScenarioError> for SimError {
    fn from(error: ScenarioError) -> Self {
        Self::Overrides(Box::new(error))
    }
}

impl SimError {
    /// Tool modes, given at `key`, that weigh more than the arm; another error of the arm as it is.
    pub(crate) fn too_heavy(key: &str, error: ArmError) -> Self {
        if !matches!(error.kind(), ArmErrorKind::ToolTooHeavy { .. }) {
            return Self::Arm(error);
        }
        let lacks = "a spindle that the robot's file lacks is given with [[robot.link]]";
        Self::scenario(key, format!("`{key}`: {error}; {lacks}"))
    }

    /// A fault of a scenario's value at a dotted key.
    pub fn scenario(key: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Scenario {
            key: key.into(),
            message: message.into(),
        }
    }
}
