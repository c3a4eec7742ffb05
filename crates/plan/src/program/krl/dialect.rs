//! KRL as a [`Dialect`].

use std::path::Path;

use truecut_arm::Robot;

use crate::program::dialect::{
    Dialect, Frames, ProgramFile, ReadText, Resolution, Settings, TurntableUnit,
};
use crate::program::{Program, ProgramError, ProgramErrorKind};

/// The dialect of KUKA programs.
#[derive(Debug, Clone, Copy)]
pub struct Krl;

/// The dialect, for the list.
pub static DIALECT: Krl = Krl;

impl Dialect for Krl {
    fn name(&self) -> &'static str {
        "krl"
    }

    fn noun(&self) -> &'static str {
        "KRL program"
    }

    fn about(&self) -> &'static str {
        "a KUKA program (.src; its .dat lies beside it)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["src", "dat"]
    }

    fn makers(&self) -> &'static [&'static str] {
        &["kuka", "kr"]
    }

    /// Half of the last decimals: 0.001 mm on three axes, 0.0001° of three angles, half a percent.
    fn resolution(&self) -> Resolution {
        Resolution {
            position_m: 0.5e-6 * 3_f64.sqrt(),
            attitude_rad: (0.5e-4 * 5_f64.sqrt()).to_radians(),
            turntable_rad: 0.5e-4_f64.to_radians(),
            speed_m_per_s: 0.5e-6,
            share: 0.5e-2,
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
