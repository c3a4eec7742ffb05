//! The tables of a scenario file.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::claim::ClaimTable;
use crate::data::DataTable;
use crate::effect::table::EffectTable;
use crate::excite::ExciteTable;
use crate::fit::FitTable;
use crate::modes::{ToolTable, WorkpieceTable};
use crate::process::ProcessTable;
use crate::robot::RobotTable;
use crate::run::RunTable;
use crate::sweep::SweepTable;
use crate::uncertain::UncertainTable;

/// A truecut scenario: a robot, a process and claims.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "truecut scenario")]
pub(crate) struct ScenarioTable {
    /// Name of the scenario.
    pub name: String,
    /// What the scenario shows.
    pub description: Option<String>,
    /// The arm, its posture and its drive. Needed but for a replay in mode "observe".
    pub robot: Option<RobotTable>,
    /// Duration, step and recording interval.
    pub run: Option<RunTable>,
    /// Exactly one of the processes.
    pub process: ProcessTable,
    /// Tool, holder and spindle, where they bend. Default: they are rigid.
    pub tool: Option<ToolTable>,
    /// The workpiece, where it bends. Default: it is rigid.
    pub workpiece: Option<WorkpieceTable>,
    /// File of the cell, relative to the scenario file: part, fixtures and what the flange carries.
    /// The run then tells how near bodies come, as the scalar `cell.clearance`. Default: none.
    pub cell: Option<String>,
    /// What must hold of the run.
    pub claim: Option<Vec<ClaimTable>>,
    /// What the nominal model leaves out.
    pub effect: Option<Vec<EffectTable>>,
    /// The same scenario at many values of its keys.
    pub sweep: Option<SweepTable>,
    /// Measured data that drives a replay or is compared with the run.
    pub data: Option<DataTable>,
    /// Nominal values that are not known exactly.
    pub uncertain: Option<Vec<UncertainTable>>,
    /// Unknowns of a least-squares fit of drive forces (`truecut fit`).
    pub fit: Option<FitTable>,
    /// A motion that makes parameters identifiable (`truecut excite`).
    pub excite: Option<ExciteTable>,
}
