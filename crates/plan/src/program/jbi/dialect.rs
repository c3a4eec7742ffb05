//! Jobs as a [`Dialect`].

use std::path::Path;

use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use truecut_arm::Robot;

use super::calls::Calls;
use super::{JbiJob, JbiOptions, JobDate, PositionFormat};
use crate::program::dialect::{
    Dialect, Frames, Options, ProgramFile, ReadText, Resolution, Settings, TurntableUnit,
    schema_of, table,
};
use crate::program::{OptionFault, Program, ProgramError, ProgramErrorKind, Tool};

/// The dialect of Motoman jobs.
#[derive(Debug, Clone, Copy)]
pub struct Jbi;

/// The dialect, for the list.
pub static DIALECT: Jbi = Jbi;

/// Options of a job.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct JobTable {
    /// Date in a job's head, "2026-01-31 12:00". For jbi.
    date: Option<String>,
    /// How a job holds positions. Default: "rectangular". For jbi.
    positions: Option<PositionFormat>,
    /// Number of the tool in the controller's table. Default: 0, of ls 1. For jbi and ls.
    #[schemars(range(min = 0, max = 255))]
    tool_number: Option<u8>,
}

impl JobTable {
    fn resolve(&self, settings: &Settings) -> Result<JbiOptions, OptionFault> {
        let mut options = JbiOptions::new(self.date()?);
        options.format = self.positions.unwrap_or(options.format);
        options.station_share = settings.turntable_share;
        options.station_pulses_per_deg = settings.pulses_per_deg;
        options.spindle_output = settings.spindle_number()?;
        Ok(options)
    }

    fn date(&self) -> Result<JobDate, OptionFault> {
        let text = self.date.as_ref();
        let text = text.ok_or(OptionFault::Missing { key: "date" })?;
        let wrong = |rule: String| OptionFault::Value {
            key: "date",
            value: format!("\"{text}\""),
            rule,
        };
        let parts = date_parts(text);
        let [year, month, day, hour, minute] =
            parts.ok_or_else(|| wrong("written like \"2026-01-31 12:00\"".to_owned()))?;
        let small = |value: u16| u8::try_from(value).unwrap_or(u8::MAX);
        JobDate::new(year, small(month), small(day), small(hour), small(minute))
            .map_err(|error| wrong(format!("a date: {error}")))
    }
}

/// Year, month, day, hour, minute.
fn date_parts(text: &str) -> Option<[u16; 5]> {
    let (day, time) = text.trim().split_once(' ')?;
    let parts = day.split('-').chain(time.trim().split(':'));
    let numbers: Vec<u16> = (parts.map(|part| part.parse().ok())).collect::<Option<_>>()?;
    numbers.try_into().ok()
}

impl Dialect for Jbi {
    fn name(&self) -> &'static str {
        "jbi"
    }

    fn noun(&self) -> &'static str {
        "job"
    }

    fn about(&self) -> &'static str {
        "a Motoman job (.JBI; jobs that it calls lie beside it)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["JBI"]
    }

    fn makers(&self) -> &'static [&'static str] {
        &["motoman", "yaskawa"]
    }

    fn may_be_japanese(&self) -> bool {
        true
    }

    /// Half of the last decimals: 0.001 mm on three axes, 0.0001° of three angles (√5 of half of it
    /// where two turn about one axis), 0.1 mm/s, 0.01 %.
    fn resolution(&self) -> Resolution {
        Resolution {
            position_m: 0.5e-6 * 3_f64.sqrt(),
            attitude_rad: (0.5e-4 * 5_f64.sqrt()).to_radians(),
            turntable_rad: 0.0,
            speed_m_per_s: 0.05e-3,
            share: 0.5e-4,
            zone_m: None,
            parts_zones: false,
        }
    }

    fn turntable(&self) -> TurntableUnit {
        TurntableUnit::Pulses
    }

    fn holds_base(&self) -> bool {
        false
    }

    fn options(&self) -> Schema {
        schema_of::<JobTable>()
    }

    fn check(&self, options: &Options) -> Result<(), OptionFault> {
        table::<JobTable>(options)?.date().map(drop)
    }

    fn tool(&self, robot: &Robot, options: &Options) -> Result<Tool, OptionFault> {
        let number = table::<JobTable>(options)?.tool_number.unwrap_or(0);
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
        let options = table::<JobTable>(&settings.options)
            .and_then(|table| table.resolve(settings))
            .map_err(ProgramErrorKind::from)?;
        super::write(program, robot, &options)
    }

    fn parts(&self, name: &str, caller: &str) -> Vec<String> {
        super::write::parts_called(name, caller)
    }

    /// A job, with those that it calls at the places of the calls.
    fn read(
        &self,
        file: &Path,
        text: &ReadText<'_>,
        robot: &Robot,
        frames: &Frames,
        settings: &Settings,
    ) -> Result<Program, ProgramError> {
        let load = |file: &Path| {
            let text = text(file).map_err(|error| ProgramError::in_file(file, None, error.into()));
            JbiJob::parse(&text?, file)
        };
        let spindle = settings.spindle_number();
        let spindle = spindle.map_err(ProgramErrorKind::from)?;
        let own = |job: &JbiJob| {
            let (tool, base) = (&frames.tool, &frames.world_from_base);
            job.program(robot, tool, base, settings.pulses_per_deg)
        };
        Calls::new(&load, &own, spindle).run(file)
    }
}

/// Options with which the contract tests write.
#[cfg(test)]
pub fn sample_options() -> serde_json::Value {
    serde_json::json!({ "date": "2026-01-31 12:00", "tool_number": 3 })
}

#[cfg(test)]
mod tests {
    use super::date_parts;

    #[test]
    fn dates_have_five_parts() {
        assert_eq!(date_parts("2026-01-31 12:05"), Some([2026, 1, 31, 12, 5]));
        for wrong in [
            "2026-01-31",
            "2026-01 12:00",
            "31.1.2026 12:00",
            "2026-01-31 12:00:00",
        ] {
            assert_eq!(date_parts(wrong), None, "{wrong}");
        }
    }
}
