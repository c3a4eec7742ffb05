//! The `[process]` table: exactly one of the processes.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::chamfer::{ChamferSpec, ChamferTable};
use crate::check::Check;
use crate::document::Fault;
use crate::load::{LoadSpec, LoadTable};
use crate::replay::{ReplaySpec, ReplayTable};
use crate::wheel::{WheelSpec, WheelTable};

/// What the tool does to the workpiece.
#[derive(Debug, Clone, PartialEq)]
pub enum ProcessSpec {
    /// Chamfering the rim of a hole.
    Chamfer(ChamferSpec),
    /// Polishing a strip with a compliant wheel.
    Wheel(WheelSpec),
    /// Given forces.
    Load(LoadSpec),
    /// Measured inputs.
    Replay(ReplaySpec),
}

impl ProcessSpec {
    /// The process's name, which is also the name of its table.
    pub fn name(&self) -> &'static str {
        match self {
            ProcessSpec::Chamfer(_) => "chamfer",
            ProcessSpec::Wheel(_) => "wheel",
            ProcessSpec::Load(_) => "load",
            ProcessSpec::Replay(_) => "replay",
        }
    }

    /// How long the process takes by itself, infinite if its data says; `None` if it does not end by itself.
    pub fn natural_duration_s(&self) -> Option<f64> {
        match self {
            ProcessSpec::Chamfer(chamfer) => Some(chamfer.cycle_s()),
            ProcessSpec::Wheel(wheel) => Some(wheel.pass_s()),
            ProcessSpec::Load(_) => None,
            ProcessSpec::Replay(_) => Some(f64::INFINITY),
        }
    }
}

/// Exactly one of the processes.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ProcessTable {
    /// Chamfering the rim of a hole.
    chamfer: Option<ChamferTable>,
    /// Polishing a strip with a compliant wheel.
    wheel: Option<WheelTable>,
    /// Given forces at the tool.
    load: Option<LoadTable>,
    /// Measured inputs.
    replay: Option<ReplayTable>,
}

impl ProcessTable {
    /// `None` after recording a fault if there is not exactly one process.
    pub(crate) fn resolve(self, check: &mut Check) -> Option<ProcessSpec> {
        match (self.chamfer, self.wheel, self.load, self.replay) {
            (Some(chamfer), None, None, None) => Some(ProcessSpec::Chamfer(chamfer.resolve(check))),
            (None, Some(wheel), None, None) => Some(ProcessSpec::Wheel(wheel.resolve())),
            (None, None, Some(load), None) => Some(ProcessSpec::Load(load.resolve(check))),
            (None, None, None, Some(replay)) => Some(ProcessSpec::Replay(replay.resolve(check))),
            (chamfer, wheel, load, replay) => {
                let given = [
                    chamfer.map(|_| "chamfer"),
                    wheel.map(|_| "wheel"),
                    load.map(|_| "load"),
                    replay.map(|_| "replay"),
                ];
                let given: Vec<&str> = given.into_iter().flatten().collect();
                check.refuse(not_one(&given));
                None
            }
        }
    }
}

fn not_one(given: &[&str]) -> Fault {
    let known = "[process.chamfer], [process.wheel], [process.load] and [process.replay]";
    match given.last() {
        None => Fault::key(
            "process",
            format!("no process: one of {known} is needed"),
            "empty",
        ),
        Some(last) => {
            let message = format!(
                "{} processes ({}), but a scenario has exactly one of {known}",
                given.len(),
                given.join(", ")
            );
            Fault::key(&format!("process.{last}"), message, "one too many")
        }
    }
}
