//! Fanuc programs as a [`Dialect`].

use std::path::Path;

use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use truecut_arm::Robot;

use crate::program::dialect::{
    Dialect, Frames, Options, ProgramFile, ReadText, Resolution, Settings, TurntableUnit,
    schema_of, table,
};
use crate::program::{OptionFault, Program, ProgramError, ProgramErrorKind, Tool};

/// The dialect of Fanuc programs.
#[derive(Debug, Clone, Copy)]
pub struct Ls;

/// The dialect, for the list.
pub static DIALECT: Ls = Ls;

/// Tool frame where no option says it: 0 is the faceplate.
const DEFAULT_TOOL: u8 = 1;

/// Options of a program.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ProgramTable {
    /// Number of the tool in the controller's table. Default: 0, of ls 1. For jbi and ls.
    #[schemars(range(min = 0, max = 255))]
    tool_number: Option<u8>,
    /// Number of the user frame. Default: 0. For ls.
    #[schemars(range(min = 0, max = 9))]
    user_frame: Option<u8>,
    /// Whether positions are joint angles. Default: false. For ls.
    joint_positions: Option<bool>,
    /// By how much of axis 2 the URDF's third joint counts more than the controller's J3: -1, 0 or
    /// 1. Default: 1. For ls.
    #[schemars(range(min = -1, max = 1))]
    j23_factor: Option<i8>,
}

/// What writer and reader take of the options.
#[derive(Debug, Clone, Copy)]
pub(super) struct LsOptions {
    pub user_frame: u8,
    pub joint_positions: bool,
    pub j23_factor: f64,
    pub spindle_output: Option<u32>,
}

impl LsOptions {
    fn of(settings: &Settings) -> Result<Self, OptionFault> {
        let table = table::<ProgramTable>(&settings.options)?;
        Ok(Self {
            user_frame: table.user_frame.unwrap_or(0),
            joint_positions: table.joint_positions.unwrap_or(false),
            j23_factor: f64::from(table.j23_factor.unwrap_or(1)),
            spindle_output: settings.spindle_number()?,
        })
    }
}

impl Dialect for Ls {
    fn name(&self) -> &'static str {
        "ls"
    }

    fn noun(&self) -> &'static str {
        "LS program"
    }

    fn about(&self) -> &'static str {
        "a Fanuc program (.LS)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["LS"]
    }

    fn makers(&self) -> &'static [&'static str] {
        &["fanuc", "lrmate"]
    }

    fn limits_note(&self) -> Option<&'static str> {
        Some(
            "limits of the third joint are the URDF's, between upper arm and forearm; those that the \
             controller sets to J3 against the horizontal are not checked",
        )
    }

    fn may_be_japanese(&self) -> bool {
        true
    }

    /// Half of the last decimals: 0.001 mm on three axes, 0.001° of three angles; speeds 0.1 mm/s
    /// and 1 %.
    fn resolution(&self) -> Resolution {
        Resolution {
            position_m: 0.5e-6 * 3_f64.sqrt(),
            attitude_rad: (0.5e-3 * 5_f64.sqrt()).to_radians(),
            turntable_rad: 0.5e-3_f64.to_radians(),
            speed_m_per_s: 0.05e-3,
            share: 0.5e-2,
            zone_m: None,
            parts_zones: false,
        }
    }

    fn turntable(&self) -> TurntableUnit {
        TurntableUnit::Degrees
    }

    fn holds_base(&self) -> bool {
        false
    }

    fn options(&self) -> Schema {
        schema_of::<ProgramTable>()
    }

    fn check(&self, options: &Options) -> Result<(), OptionFault> {
        let factor = table::<ProgramTable>(options)?.j23_factor;
        match factor.filter(|factor| !(-1..=1).contains(factor)) {
            None => Ok(()),
            Some(factor) => Err(OptionFault::Value {
                key: "j23_factor",
                value: factor.to_string(),
                rule: "-1, 0 or 1".to_owned(),
            }),
        }
    }

    fn tool(&self, robot: &Robot, options: &Options) -> Result<Tool, OptionFault> {
        let number = table::<ProgramTable>(options)?.tool_number;
        let number = number.unwrap_or(DEFAULT_TOOL);
        Ok(Tool::of(robot, "wheel", number))
    }

    fn check_name(&self, name: &str) -> Result<(), ProgramErrorKind> {
        super::check_name(name)
    }

    fn write(
        &self,
        program: &Program,
        robot: &Robot,
        settings: &Settings,
    ) -> Result<Vec<ProgramFile>, ProgramError> {
        let options = LsOptions::of(settings).map_err(ProgramErrorKind::from)?;
        super::write::write(program, robot, &options)
    }

    fn read(
        &self,
        file: &Path,
        text: &ReadText<'_>,
        robot: &Robot,
        frames: &Frames,
        settings: &Settings,
    ) -> Result<Program, ProgramError> {
        let options = LsOptions::of(settings).map_err(ProgramErrorKind::from)?;
        super::read::read(file, text, robot, frames, &options)
    }
}

/// Options with which the contract tests write.
#[cfg(test)]
pub fn sample_options() -> serde_json::Value {
    serde_json::json!({ "tool_number": 3 })
}
