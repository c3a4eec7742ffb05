//! Processes of a user's own crate.

use super::{ProcessSetup, SetupContext};
use crate::error::SimError;
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use std::any::Any;
use std::sync::Arc;
use truecut_scenario::{BrokenRule, CustomSpec, Definition, Facts};

/// The table of a process of one's own, which is read from `[process.<name>]`, and what it says.
///
/// Field names carry the unit; schemars' attributes give ranges, and `x-rule` beside a range its
/// reason.
pub trait OwnProcess: DeserializeOwned + JsonSchema + Send + Sync + 'static {
    /// The process's name, which is also the name of its table.
    const NAME: &'static str;

    /// What the rest of the program may ask of it.
    fn facts(&self) -> Facts;

    /// The process on the arm of a scenario.
    ///
    /// # Errors
    /// What does not fit the arm.
    fn set_up(&self, context: &SetupContext<'_>) -> Result<ProcessSetup, SimError>;

    /// Rules that involve several keys.
    ///
    /// # Errors
    /// The first one that is broken.
    fn check(&self) -> Result<(), BrokenRule> {
        Ok(())
    }

    /// What [`Processes::with`](truecut_scenario::Processes::with) takes.
    #[must_use]
    fn definition() -> Definition {
        let runner = Runner(|table, context| match table.downcast_ref::<Self>() {
            Some(table) => table.set_up(context),
            None => Err(not_runnable(Self::NAME)),
        });
        Definition::new::<Self>(Self::NAME, Self::check, Self::facts, Arc::new(runner))
    }
}

/// How the table of a definition becomes a process.
struct Runner(fn(&dyn Any, &SetupContext<'_>) -> Result<ProcessSetup, SimError>);

pub(super) fn setup(
    spec: &CustomSpec,
    context: &SetupContext<'_>,
) -> Result<ProcessSetup, SimError> {
    match spec.runner().downcast_ref::<Runner>() {
        Some(Runner(set_up)) => set_up(spec.any(), context),
        None => Err(not_runnable(spec.name())),
    }
}

fn not_runnable(name: &str) -> SimError {
    let message =
        "is defined for reading only: its definition must come from `OwnProcess::definition`";
    SimError::scenario(format!("process.{name}"), message)
}
