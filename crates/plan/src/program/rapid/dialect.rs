//! Modules as a [`Dialect`].

use std::path::Path;

use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use truecut_arm::Robot;

use super::{RapidModule, RapidOptions};
use crate::program::dialect::{
    Dialect, Frames, Options, ProgramFile, ReadText, Resolution, Settings, TurntableUnit,
    schema_of, table,
};
use crate::program::{OptionFault, Program, ProgramError, ProgramErrorKind, Tool};

/// The dialect of ABB modules.
#[derive(Debug, Clone, Copy)]
pub struct Rapid;

/// The dialect, for the list.
pub static DIALECT: Rapid = Rapid;

/// Options of a module.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ModuleTable {
    /// Name of the tool. Default: "wheel". For rapid.
    tool_name: Option<String>,
    /// Zone of the points between first and last. Default: "z1". For rapid.
    zone: Option<String>,
}

impl Dialect for Rapid {
    fn name(&self) -> &'static str {
        "rapid"
    }

    fn noun(&self) -> &'static str {
        "module"
    }

    fn about(&self) -> &'static str {
        "an ABB module (.mod)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["mod"]
    }

    fn makers(&self) -> &'static [&'static str] {
        &["abb", "irb"]
    }

    /// Half of the last decimals: 0.001 mm on three axes, 1e-9 of a quaternion's four parts (the
    /// attitude turns by twice that), 0.0001° of the turntable, 0.001 mm/s.
    fn resolution(&self) -> Resolution {
        Resolution {
            position_m: 0.5e-6 * 3_f64.sqrt(),
            attitude_rad: 2e-9,
            turntable_rad: 0.5e-4_f64.to_radians(),
            speed_m_per_s: 0.5e-6,
            share: 0.5e-6 / RapidOptions::default().joint_top_m_per_s,
            zone_m: Some(0.5e-6),
            parts_zones: false,
        }
    }

    fn turntable(&self) -> TurntableUnit {
        TurntableUnit::Degrees
    }

    fn holds_base(&self) -> bool {
        true
    }

    fn options(&self) -> Schema {
        schema_of::<ModuleTable>()
    }

    fn check(&self, options: &Options) -> Result<(), OptionFault> {
        table::<ModuleTable>(options).map(drop)
    }

    fn tool(&self, robot: &Robot, options: &Options) -> Result<Tool, OptionFault> {
        let name = table::<ModuleTable>(options)?.tool_name;
        Ok(Tool::of(robot, name.as_deref().unwrap_or("wheel"), 0))
    }

    fn check_name(&self, name: &str) -> Result<(), ProgramErrorKind> {
        super::check_name("the module's name", name)
    }

    fn write(
        &self,
        program: &Program,
        robot: &Robot,
        settings: &Settings,
    ) -> Result<Vec<ProgramFile>, ProgramError> {
        let table = table::<ModuleTable>(&settings.options).map_err(ProgramErrorKind::from)?;
        let mut options = RapidOptions::default();
        options.zone = table.zone.unwrap_or(options.zone);
        options.spindle_signal.clone_from(&settings.spindle_signal);
        Ok(vec![ProgramFile {
            name: format!("{}.mod", program.name),
            text: super::write(program, robot, &options)?,
        }])
    }

    fn read(
        &self,
        file: &Path,
        text: &ReadText<'_>,
        robot: &Robot,
        _: &Frames,
        settings: &Settings,
    ) -> Result<Program, ProgramError> {
        let text = text(file).map_err(|error| ProgramError::in_file(file, None, error.into()))?;
        let options = RapidOptions {
            spindle_signal: settings.spindle_signal.clone(),
            ..RapidOptions::default()
        };
        RapidModule::parse(&text, file)?.program(robot, &options)
    }
}

/// Options with which the contract tests write.
#[cfg(test)]
pub fn sample_options() -> serde_json::Value {
    serde_json::json!({ "tool_name": "wheel", "zone": "z5" })
}
