//! Motoman jobs (`.JBI`), dialect of the NX100.
//!
//! Fields, ranges and where they are documented stand in `docs/robot_program_formats.md`. Positions
//! are millimetres with three decimals and degrees with four; a station's turntable is written in
//! pulses.

mod calls;
mod dialect;
mod fields;
mod job;
mod read;
mod write;

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_arm::{Elbow, Joint, OpwGeometry, Shoulder};

use super::flags::{Flags, branch_excess, outside_rad};
use super::{ProgramError, ProgramErrorKind};

#[cfg(test)]
pub(super) use dialect::sample_options;
pub use dialect::{DIALECT, Jbi};
pub use job::{JbiCall, JbiJob, JbiMove, JbiPosition, JbiPositionValue};
pub use write::write;

/// Longest name of a job that is written, and of those of later controllers that is read; longest
/// comment, characters.
const NAME_CHARS: usize = 8;
const READ_NAME_CHARS: usize = 32;
const COMMENT_CHARS: usize = 32;
/// Largest number of a tool.
const LAST_TOOL: u8 = 23;
/// Largest position level.
const LAST_LEVEL: u8 = 8;
/// Speeds that an instruction can hold: V in mm/s, VJ in percent.
const V_MM_PER_S: (f64, f64) = (0.1, 1500.0);
const VJ_PERCENT: (f64, f64) = (0.01, 100.0);

/// How a job holds positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PositionFormat {
    /// Poses in the base frame.
    // `///POSTYPE BASE`, `///RECTAN`, with the manipulator type.
    Rectangular,
    /// Encoder pulses; robot.toml must give pulses_per_deg.
    // `///POSTYPE PULSE`.
    Pulse,
}

/// Date and time in a job's head.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JobDate {
    year: u16,
    month: u8,
    day: u8,
    hour: u8,
    minute: u8,
}

impl JobDate {
    /// # Errors
    /// If a part is out of its range. Lengths of months are not looked at.
    pub fn new(year: u16, month: u8, day: u8, hour: u8, minute: u8) -> Result<Self, ProgramError> {
        let ranges = [
            ("year", year, 1980, 2099),
            ("month", u16::from(month), 1, 12),
            ("day", u16::from(day), 1, 31),
            ("hour", u16::from(hour), 0, 23),
            ("minute", u16::from(minute), 0, 59),
        ];
        for (what, value, low, high) in ranges {
            let what = format!("the {what} of the job's date");
            let rule = format!("from {low} to {high}");
            ProgramErrorKind::unless((low..=high).contains(&value), what, value, rule)?;
        }
        Ok(Self {
            year,
            month,
            day,
            hour,
            minute,
        })
    }
}

impl std::fmt::Display for JobDate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (year, month, day) = (self.year, self.month, self.day);
        write!(
            f,
            "{year:04}/{month:02}/{day:02} {:02}:{:02}",
            self.hour, self.minute
        )
    }
}

/// How a program is written as jobs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JbiOptions {
    pub format: PositionFormat,
    pub date: JobDate,
    /// Pulses per degree of the turntable; needed if the program has one.
    pub station_pulses_per_deg: Option<f64>,
    /// Speed of the turntable beside a move of the robot, share of its top speed.
    pub station_share: f64,
    /// Number of the output that runs the spindle.
    pub spindle_output: Option<u32>,
    /// Most instruction lines in a job; a longer program is split and called from a job of its
    /// name.
    pub lines_per_job: usize,
}

impl JbiOptions {
    /// Rectangular positions, 9999 lines a job, turntable at full speed with pulses not known.
    #[must_use]
    pub fn new(date: JobDate) -> Self {
        Self {
            format: PositionFormat::Rectangular,
            spindle_output: None,
            date,
            station_pulses_per_deg: None,
            station_share: 1.0,
            lines_per_job: 9999,
        }
    }
}

/// Manipulator type (`///RCONF`): which of the postures that reach a pose is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rconf {
    /// The R axis (joint 4) lies in (90°, 270°] or (−270°, −90°]; else in (−90°, 90°] or beyond
    /// ±270°: *flip*.
    pub no_flip: bool,
    /// The elbow is bent downwards.
    pub lower_arm: bool,
    /// The wrist centre lies behind axis 1.
    pub rear: bool,
    /// Joints 4 (R), 6 (T), 1 (S) lie beyond (−180°, 180°].
    pub r_over: bool,
    pub t_over: bool,
    pub s_over: bool,
}

/// Joints of the three flags for angles beyond 180°, in the flags' order R, T, S.
const TURN_JOINTS: [usize; 3] = [3, 5, 0];

impl Rconf {
    /// The type of a posture.
    #[must_use]
    pub fn of(geometry: &OpwGeometry, q: &[f64]) -> Self {
        let branch = geometry.branch(q);
        let [r_over, t_over, s_over] = TURN_JOINTS.map(|joint| {
            let deg = q[joint].to_degrees();
            !(deg > -180.0 && deg <= 180.0)
        });
        let turned = q[3].to_degrees().rem_euclid(360.0);
        Self {
            no_flip: turned > 90.0 && turned <= 270.0,
            lower_arm: branch.elbow == Elbow::Lower,
            rear: branch.shoulder == Shoulder::Rear,
            r_over,
            t_over,
            s_over,
        }
    }

    /// In the file's order.
    #[must_use]
    pub fn fields(&self) -> [bool; 6] {
        [
            self.no_flip,
            self.lower_arm,
            self.rear,
            self.r_over,
            self.t_over,
            self.s_over,
        ]
    }

    fn from_fields([no_flip, lower_arm, rear, r_over, t_over, s_over]: [bool; 6]) -> Self {
        Self {
            no_flip,
            lower_arm,
            rear,
            r_over,
            t_over,
            s_over,
        }
    }
}

impl Flags for Rconf {
    fn joint_excess(&self, joint: usize, q: f64) -> f64 {
        const NEAR: &[(f64, f64)] = &[(-180.0, 180.0)];
        const OVER: &[(f64, f64)] = &[(180.0, 360.0), (-360.0, -180.0)];
        let turns = |over: bool| if over { OVER } else { NEAR };
        match (joint, self.r_over, self.no_flip) {
            (3, false, false) => outside_rad(q, &[(-90.0, 90.0)]),
            (3, false, true) => outside_rad(q, &[(90.0, 180.0), (-180.0, -90.0)]),
            (3, true, false) => outside_rad(q, &[(270.0, 360.0), (-360.0, -270.0)]),
            (3, true, true) => outside_rad(q, &[(180.0, 270.0), (-270.0, -180.0)]),
            (5, ..) => outside_rad(q, turns(self.t_over)),
            (0, ..) => outside_rad(q, turns(self.s_over)),
            _ => 0.0,
        }
    }

    fn branch_excess(&self, geometry: &OpwGeometry, q: &[f64]) -> f64 {
        branch_excess(geometry, q, [Some(self.rear), Some(self.lower_arm), None])
    }

    fn text(&self) -> String {
        format!("RCONF {}", rconf_text(self))
    }
}

/// Pulses per rad (m) of a joint.
fn pulses_per_unit(joint: &Joint) -> Result<f64, ProgramErrorKind> {
    let known = joint.transmission.pulses_per_unit;
    known.ok_or_else(|| ProgramErrorKind::NoPulses {
        joint: joint.name.clone(),
    })
}

fn rconf_text(rconf: &Rconf) -> String {
    let fields = rconf.fields().map(|flag| if flag { "1" } else { "0" });
    fields.join(",")
}

/// Job names: letters, digits, hyphens and underscores. The dialect gives the length only; what
/// else it may allow is refused.
fn check_name(name: &str) -> Result<(), ProgramErrorKind> {
    let good = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '-' || c == '_';
    let fits = !name.is_empty() && name.len() <= NAME_CHARS && name.chars().all(good);
    let rule = format!("1 to {NAME_CHARS} characters, each of A-Z, 0-9, `-` or `_`");
    ProgramErrorKind::unless(fits, "the job name", format!("\"{name}\""), rule)
}

/// Names that are read: longer ones and small letters, too.
fn check_read_name(name: &str) -> Result<(), ProgramErrorKind> {
    let good = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let fits = !name.is_empty() && name.len() <= READ_NAME_CHARS && name.chars().all(good);
    let rule = format!("1 to {READ_NAME_CHARS} characters, each of A-Z, a-z, 0-9, `-` or `_`");
    ProgramErrorKind::unless(fits, "the job name", format!("\"{name}\""), rule)
}

fn check_comment(comment: &str) -> Result<(), ProgramErrorKind> {
    let printable = comment.chars().all(|c| (' '..='~').contains(&c));
    let fits = comment.len() <= COMMENT_CHARS && printable;
    let rule = format!("printable ASCII, at most {COMMENT_CHARS} characters");
    ProgramErrorKind::unless(fits, "the comment", format!("\"{comment}\""), rule)
}
