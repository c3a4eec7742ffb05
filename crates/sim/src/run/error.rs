//! What can go wrong with a run, at its place.

use std::path::PathBuf;

use truecut_arm::{ArmError, ArmErrorKind};
use truecut_recording::{MetricError, Recording, SinkError};
use truecut_scenario::{Scenario, ScenarioError};

use crate::error::SimError;

/// Why a run could not be made or judged. A run that diverges is no error: its recording says so.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A fault of the scenario, with its place in the file.
    #[error("{0}")]
    Scenario(#[from] Box<ScenarioError>),
    /// A fault of the robot's files, with its line there.
    #[error("{error}")]
    Robot {
        /// What is wrong, and where.
        error: ArmError,
        /// The scenario whose robot it is.
        scenario: PathBuf,
    },
    /// A metric that the recording does not have.
    #[error("{}: {error}", .scenario.display())]
    Metric {
        /// What is missing.
        error: MetricError,
        /// The scenario that asks for it.
        scenario: PathBuf,
    },
    /// Measured data that cannot be had.
    #[error("{message}")]
    Data {
        /// What is wrong.
        message: String,
        /// What to do about it.
        help: Option<String>,
    },
    /// A claim that cannot be judged, of a run that has come to its end: its recording is whole.
    #[error("{error}")]
    Unjudged {
        /// What is wrong with the claim.
        error: Box<RunError>,
        /// The run.
        recording: Box<Recording>,
    },
    /// The recording cannot be written.
    #[error("{0}")]
    Sink(SinkError),
    /// [`Run::stop`](super::Run::stop) was set before there was an answer.
    #[error("stopped from outside")]
    Stopped,
}

impl From<ScenarioError> for RunError {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(Box::new(error))
    }
}

impl RunError {
    /// An error of the simulator, at the key of the scenario that it is about.
    pub fn of(scenario: &Scenario, error: SimError) -> RunError {
        match error {
            SimError::Scenario { key, message } => scenario.problem(&key, message).into(),
            SimError::Overrides(error) => RunError::Scenario(error),
            SimError::Arm(error) if error.line().is_some() => RunError::Robot {
                error,
                scenario: scenario.path().to_owned(),
            },
            SimError::Arm(error) => scenario
                .problem(&robot_key(scenario, &error), error.to_string())
                .into(),
            SimError::Metric(error) => RunError::Metric {
                error,
                scenario: scenario.path().to_owned(),
            },
            SimError::Sink(error) => RunError::Sink(error),
        }
    }
}

/// The key that a fault of the robot without a line of its own is about.
fn robot_key(scenario: &Scenario, error: &ArmError) -> String {
    match error.kind() {
        ArmErrorKind::OutsideLimits { .. } if scenario.gives("robot.posture_deg") => {
            "robot.posture_deg".to_owned()
        }
        _ => scenario.robot.key_of(error),
    }
}
