//! The tables `[symmetry]`, `[[taught]]` and `[program]`.

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;

use super::check_direction;
use super::spec::{Carrier, DialectSpec, ProgramSpec, SymmetrySpec, TaughtSpec, TaughtWhen};
use super::tables::place;
use crate::check::Check;
use crate::document::Fault;
use crate::units::{from_deg, from_mm};

/// What brings the copies to the wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum CarriedBy {
    /// The arm goes to each copy.
    Arm,
    /// A turntable brings each copy to where the first one was.
    Turntable,
}

/// Copies of the face about an axis.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SymmetryTable {
    /// Number of copies, the first included.
    #[schemars(range(min = 2, max = 1000), extend("x-rule" = "a part that stands alone has no symmetry"))]
    count: usize,
    /// A point of the axis, world.
    centre_mm: [f64; 3],
    /// Direction of the axis, world, of any length but zero. Copies follow one another right-handed about it. Default: [0, 0, 1].
    axis: Option<[f64; 3]>,
    /// What brings the copies to the wheel.
    carried_by: CarriedBy,
    /// Pulses per degree of the turntable; jobs hold its angle in pulses.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "pulses count up with the axis"))]
    pulses_per_deg: Option<f64>,
}

/// Postures recorded on the arm.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct TaughtTable {
    /// CSV file with a column j1, j2, … for each joint (degrees; mm for prismatic joints), relative to this file.
    file: String,
    /// Played before or after the lines of each copy.
    when: TaughtWhen,
}

/// The language of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Dialect {
    /// Motoman job, NX100.
    Jbi,
    /// ABB module in RAPID.
    Rapid,
}

/// How a job holds positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Positions {
    /// Poses in the base frame.
    Rectangular,
    /// Encoder pulses; robot.toml must give pulses_per_deg.
    Pulse,
}

/// The robot program.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ProgramTable {
    /// The language.
    dialect: Dialect,
    /// Name of the program, and of its file.
    name: String,
    /// A remark in its head. Default: none.
    comment: Option<String>,
    /// Date in a job's head, "2026-01-31 12:00". For jbi.
    date: Option<String>,
    /// How a job holds positions. Default: "rectangular". For jbi.
    positions: Option<Positions>,
    /// Number of the tool in the controller's table. Default: 0. For jbi.
    #[schemars(range(min = 0, max = 255))]
    tool_number: Option<u8>,
    /// Name of the tool. Default: "wheel". For rapid.
    tool_name: Option<String>,
    /// Zone of the points between first and last. Default: "z1". For rapid.
    zone: Option<String>,
    /// Speed of moves by joints, a fraction of the top speed. Default: 0.25.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0, "x-rule" = "a fraction of the top speed"))]
    joint_speed: Option<f64>,
    /// Largest motion of one joint from point to point on a line. Default: 10.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "joints move along a line"))]
    largest_step_deg: Option<f64>,
    /// Where the controller's base frame stands in the world. Default: [0, 0, 0].
    base_xyz_mm: Option<[f64; 3]>,
    /// Its roll, pitch and yaw. Default: [0, 0, 0].
    base_rpy_deg: Option<[f64; 3]>,
}

impl SymmetryTable {
    /// `None` after recording a fault.
    pub(super) fn resolve(&self, check: &mut Check) -> Option<SymmetrySpec> {
        let axis = self.axis.unwrap_or([0.0, 0.0, 1.0]);
        check_direction("symmetry.axis", axis, check);
        let carrier = match self.carried_by {
            CarriedBy::Arm => {
                let because = "carried_by = \"arm\" needs no turntable";
                check.ignored("symmetry", &["pulses_per_deg"], because);
                Carrier::Arm
            }
            CarriedBy::Turntable => Carrier::Turntable {
                pulses_per_deg: self.pulses_per_deg,
            },
        };
        Some(SymmetrySpec {
            count: self.count,
            centre_m: self.centre_mm.map(from_mm),
            axis,
            carrier,
        })
    }
}

impl TaughtTable {
    pub(super) fn resolve(self, folder: &Path) -> TaughtSpec {
        TaughtSpec {
            file: folder.join(self.file),
            when: self.when,
        }
    }
}

impl ProgramTable {
    /// `None` after recording a fault. `turntable` holds the pulses of a turntable, if there is one.
    pub(super) fn resolve(
        self,
        turntable: Option<Option<f64>>,
        check: &mut Check,
    ) -> Option<ProgramSpec> {
        let dialect = match self.dialect {
            Dialect::Jbi => {
                let because = "dialect = \"jbi\" has no such thing";
                check.ignored("program", &["tool_name", "zone"], because);
                if let Some(pulses) = turntable {
                    let who = "a job with a turntable";
                    check.needed("symmetry", "pulses_per_deg", pulses, who);
                }
                let who = "dialect = \"jbi\"";
                let date = check.needed("program", "date", self.date, who)?;
                let Some(date) = read_date(&date) else {
                    let message = format!(
                        "`program.date` is \"{date}\", but must be written like \"2026-01-31 12:00\""
                    );
                    check.refuse(Fault::value("program.date", message, "no date"));
                    return None;
                };
                DialectSpec::Jbi {
                    date,
                    pulses: self.positions == Some(Positions::Pulse),
                    tool_number: self.tool_number.unwrap_or(0),
                }
            }
            Dialect::Rapid => {
                let because = "dialect = \"rapid\" has no such thing";
                check.ignored("program", &["date", "positions", "tool_number"], because);
                let because = "dialect = \"rapid\" holds the turntable's angle in degrees";
                check.ignored("symmetry", &["pulses_per_deg"], because);
                DialectSpec::Rapid {
                    zone: self.zone,
                    tool_name: self.tool_name.unwrap_or_else(|| "wheel".to_owned()),
                }
            }
        };
        Some(ProgramSpec {
            name: self.name,
            comment: self.comment.unwrap_or_default(),
            dialect,
            joint_share: self.joint_speed.unwrap_or(0.25),
            largest_step_rad: from_deg(self.largest_step_deg.unwrap_or(10.0)),
            base: place(self.base_xyz_mm, self.base_rpy_deg),
        })
    }
}

/// Year, month, day, hour, minute.
fn read_date(text: &str) -> Option<[u16; 5]> {
    let (day, time) = text.trim().split_once(' ')?;
    let parts = day.split('-').chain(time.trim().split(':'));
    let numbers: Vec<u16> = (parts.map(|part| part.parse().ok())).collect::<Option<_>>()?;
    numbers.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::read_date;

    #[test]
    fn dates_have_five_parts() {
        assert_eq!(read_date("2026-01-31 12:05"), Some([2026, 1, 31, 12, 5]));
        for wrong in [
            "2026-01-31",
            "2026-01 12:00",
            "31.1.2026 12:00",
            "2026-01-31 12:00:00",
        ] {
            assert_eq!(read_date(wrong), None, "{wrong}");
        }
    }
}
