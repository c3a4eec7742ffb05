//! The `[process]` table: exactly one of the processes.

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::belt::{BeltSpec, BeltTable};
use crate::brush::{BrushSpec, BrushTable};
use crate::chamfer::{ChamferSpec, ChamferTable};
use crate::check::Check;
use crate::document::Fault;
use crate::load::{LoadSpec, LoadTable};
use crate::milling::{MillingSpec, MillingTable};
use crate::polish::{PolishSpec, PolishTable};
use crate::replay::{ReplaySpec, ReplayTable};
use crate::wheel::{WheelSpec, WheelTable};

/// What the tool does to the workpiece.
#[derive(Debug, Clone, PartialEq)]
pub enum ProcessSpec {
    /// Chamfering the rim of a hole.
    Chamfer(ChamferSpec),
    /// Polishing a strip with a compliant wheel.
    Wheel(WheelSpec),
    /// Milling along a straight line.
    Milling(MillingSpec),
    /// Polishing a face with a soft wheel in precession.
    Polish(Box<PolishSpec>),
    /// Finishing the face of a path job with a belt over a contact wheel.
    Belt(Box<BeltSpec>),
    /// Deburring edges with a wheel brush along taught postures.
    Brush(Box<BrushSpec>),
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
            ProcessSpec::Milling(_) => "milling",
            ProcessSpec::Polish(_) => "polish",
            ProcessSpec::Belt(_) => "belt",
            ProcessSpec::Brush(_) => "brush",
            ProcessSpec::Load(_) => "load",
            ProcessSpec::Replay(_) => "replay",
        }
    }

    /// How long the process takes by itself, infinite if its data or the plan of its path says; `None` if it does not end by itself.
    pub fn natural_duration_s(&self) -> Option<f64> {
        match self {
            ProcessSpec::Chamfer(chamfer) => Some(chamfer.cycle_s()),
            ProcessSpec::Wheel(wheel) => Some(wheel.pass_s()),
            ProcessSpec::Milling(milling) => Some(milling.pass_s()),
            ProcessSpec::Load(_) => None,
            ProcessSpec::Polish(_)
            | ProcessSpec::Belt(_)
            | ProcessSpec::Brush(_)
            | ProcessSpec::Replay(_) => Some(f64::INFINITY),
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
    /// Milling along a straight line.
    milling: Option<MillingTable>,
    /// Polishing a face with a soft wheel in precession.
    polish: Option<PolishTable>,
    /// Finishing the face of a path job with a belt over a contact wheel.
    belt: Option<BeltTable>,
    /// Deburring edges with a wheel brush along taught postures.
    brush: Option<BrushTable>,
    /// Given forces at the tool.
    load: Option<LoadTable>,
    /// Measured inputs.
    replay: Option<ReplayTable>,
}

impl ProcessTable {
    /// `None` after recording a fault if there is not exactly one process. `folder` is that of the scenario file.
    pub(crate) fn resolve(self, folder: &Path, check: &mut Check) -> Option<ProcessSpec> {
        let given = [
            self.chamfer.is_some().then_some("chamfer"),
            self.wheel.is_some().then_some("wheel"),
            self.milling.is_some().then_some("milling"),
            self.polish.is_some().then_some("polish"),
            self.belt.is_some().then_some("belt"),
            self.brush.is_some().then_some("brush"),
            self.load.is_some().then_some("load"),
            self.replay.is_some().then_some("replay"),
        ];
        let given: Vec<&str> = given.into_iter().flatten().collect();
        if given.len() != 1 {
            check.refuse(not_one(&given));
            return None;
        }
        let chamfer = (self.chamfer).map(|one| ProcessSpec::Chamfer(one.resolve(check)));
        let wheel = self.wheel.map(|one| ProcessSpec::Wheel(one.resolve()));
        let milling = (self.milling)
            .and_then(|one| one.resolve(folder, check))
            .map(ProcessSpec::Milling);
        let polish = (self.polish)
            .and_then(|one| one.resolve(check))
            .map(|one| ProcessSpec::Polish(Box::new(one)));
        let belt = (self.belt)
            .and_then(|one| one.resolve(folder, check))
            .map(|one| ProcessSpec::Belt(Box::new(one)));
        let load = self.load.map(|one| ProcessSpec::Load(one.resolve(check)));
        let replay = (self.replay).map(|one| ProcessSpec::Replay(one.resolve(check)));
        let brush = (self.brush)
            .and_then(|one| one.resolve(folder, check))
            .map(|one| ProcessSpec::Brush(Box::new(one)));
        let pressed = polish.or(belt).or(brush);
        chamfer
            .or(wheel)
            .or(milling)
            .or(pressed)
            .or(load)
            .or(replay)
    }
}

fn not_one(given: &[&str]) -> Fault {
    let known = "[process.chamfer], [process.wheel], [process.milling], [process.polish], [process.belt], [process.brush], [process.load] and [process.replay]";
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
