//! URScript as a [`Dialect`].

use std::path::Path;

use truecut_arm::Robot;

use crate::program::dialect::{
    Dialect, Frames, ProgramFile, ReadText, Resolution, Settings, TurntableUnit,
};
use crate::program::{Program, ProgramError, ProgramErrorKind};

/// The dialect of Universal Robots programs.
#[derive(Debug, Clone, Copy)]
pub struct UrScript;

/// The dialect, for the list.
pub static DIALECT: UrScript = UrScript;

impl Dialect for UrScript {
    fn name(&self) -> &'static str {
        "urscript"
    }

    fn noun(&self) -> &'static str {
        "script"
    }

    fn about(&self) -> &'static str {
        "a Universal Robots script (.script)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["script"]
    }

    fn makers(&self) -> &'static [&'static str] {
        &["ur", "universal"]
    }

    /// Half of the last decimals, and for postures what 5e-9 rad in each of six joints make at an
    /// arm's length of 3 m.
    fn resolution(&self) -> Resolution {
        Resolution {
            position_m: 1.8e-7,
            attitude_rad: 4e-8,
            turntable_rad: 0.0,
            speed_m_per_s: 0.5e-6,
            share: 0.5e-6,
            zone_m: Some(0.5e-6),
            parts_zones: true,
        }
    }

    fn turntable(&self) -> TurntableUnit {
        TurntableUnit::None
    }

    fn holds_base(&self) -> bool {
        false
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
        super::write::write(program, robot, settings)
    }

    fn read(
        &self,
        file: &Path,
        text: &ReadText<'_>,
        robot: &Robot,
        frames: &Frames,
        settings: &Settings,
    ) -> Result<Program, ProgramError> {
        super::read::read(file, text, robot, frames, settings)
    }
}

/// Options with which the contract tests write.
#[cfg(test)]
pub fn sample_options() -> serde_json::Value {
    serde_json::json!({})
}
