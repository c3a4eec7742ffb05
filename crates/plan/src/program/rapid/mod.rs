//! ABB modules (`.MOD`) in RAPID.
//!
//! Fields, and where they are documented, stand in `docs/robot_program_formats.md`. Positions are
//! millimetres with three decimals, attitudes quaternions with nine, angles of the turntable
//! degrees with four.

mod data;
mod dialect;
mod module;
mod read;
mod run;
mod write;

use truecut_arm::{Elbow, OpwGeometry, Shoulder, Wrist};

use super::ProgramErrorKind;
use super::flags::{Flags, branch_excess, outside_rad};
use super::source::Syntax;

#[cfg(test)]
pub(super) use dialect::sample_options;
pub use dialect::{DIALECT, Rapid};
pub use module::{RapidGoal, RapidModule, RapidMove};
pub use write::write;

/// Longest identifier, characters.
const NAME_CHARS: usize = 32;
/// What stands for an external axis that there is not.
const UNUSED_AXIS: f64 = 9e9;
/// Numbers of the zones that the controller knows by name, beside `fine`: mm, but 0.3 mm for `z0`.
const ZONES: [u32; 14] = [0, 1, 5, 10, 15, 20, 30, 40, 50, 60, 80, 100, 150, 200];
/// Speeds that it knows by name, mm/s, beside `vmax`.
const SPEEDS: [u32; 25] = [
    5, 10, 20, 30, 40, 50, 60, 80, 100, 150, 200, 300, 400, 500, 600, 800, 1000, 1500, 2000, 2500,
    3000, 4000, 5000, 6000, 7000,
];
/// What `vmax` is taken for.
const MAX_M_PER_S: f64 = 7.0;
/// Mass by which tool data say that the load is not known: that of `load0`.
const NO_LOAD_KG: f64 = 1e-3;
/// The pieces of the language.
const SYNTAX: Syntax = Syntax {
    comment: '!',
    marks: "[]{},;\\()",
    in_words: "",
    lines: false,
};
/// Words that a name may not be.
const RESERVED: [&str; 12] = [
    "MODULE",
    "ENDMODULE",
    "PROC",
    "ENDPROC",
    "PERS",
    "CONST",
    "VAR",
    "TRUE",
    "FALSE",
    "FINE",
    "MOVEL",
    "MOVEJ",
];

/// How a program is written as a module.
#[derive(Debug, Clone, PartialEq)]
pub struct RapidOptions {
    /// Zone of the points of which the program says nothing, between the first and the last, which
    /// are `fine`.
    pub zone: String,
    /// Digital output that runs the spindle.
    pub spindle_signal: Option<String>,
    /// Speed of the tool point that stands for a joint move at full speed. RAPID gives joint moves
    /// a speed of the tool point, not a share.
    pub joint_top_m_per_s: f64,
    /// Speed of reorientation in all speed data.
    pub reorientation_deg_per_s: f64,
}

impl Default for RapidOptions {
    /// Zone `z1`, 7 m/s, 500 deg/s.
    fn default() -> Self {
        Self {
            zone: "z1".to_owned(),
            spindle_signal: None,
            joint_top_m_per_s: 7.0,
            reorientation_deg_per_s: 500.0,
        }
    }
}

/// Axis configuration: quadrants of axes 1, 4 and 6, and which of the eight branches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Confdata {
    /// Quadrant of axis 1: 0 for 0° to 90°, 1 for 90° to 180°, −1 for −90° to 0°.
    pub cf1: i32,
    pub cf4: i32,
    pub cf6: i32,
    /// 4 if the wrist centre is behind axis 1, plus 2 if it is behind the lower arm, plus 1 if axis
    /// 5 is negative.
    pub cfx: i32,
}

impl Confdata {
    /// The configuration of a posture.
    #[must_use]
    pub fn of(geometry: &OpwGeometry, q: &[f64]) -> Self {
        let branch = geometry.branch(q);
        let quadrant = |joint: usize| (q[joint].to_degrees() / 90.0).floor() as i32;
        Self {
            cf1: quadrant(0),
            cf4: quadrant(3),
            cf6: quadrant(5),
            cfx: 4 * i32::from(branch.shoulder == Shoulder::Rear)
                + 2 * i32::from(branch.elbow == Elbow::Lower)
                + i32::from(branch.wrist == Wrist::Negative),
        }
    }

    fn check(&self) -> Result<(), ProgramErrorKind> {
        ProgramErrorKind::unless((0..8).contains(&self.cfx), "cfx", self.cfx, "from 0 to 7")
    }
}

impl Flags for Confdata {
    fn joint_excess(&self, joint: usize, q: f64) -> f64 {
        let quadrant = match joint {
            0 => self.cf1,
            3 => self.cf4,
            5 => self.cf6,
            _ => return 0.0,
        };
        let low = 90.0 * f64::from(quadrant);
        outside_rad(q, &[(low, low + 90.0)])
    }

    fn branch_excess(&self, geometry: &OpwGeometry, q: &[f64]) -> f64 {
        let bit = |bit: i32| Some(self.cfx & bit != 0);
        branch_excess(geometry, q, [bit(4), bit(2), bit(1)])
    }

    fn text(&self) -> String {
        format!(
            "confdata [{},{},{},{}]",
            self.cf1, self.cf4, self.cf6, self.cfx
        )
    }
}

fn check_name(what: &str, name: &str) -> Result<(), ProgramErrorKind> {
    let first = name.chars().next().is_some_and(|c| c.is_ascii_alphabetic());
    let rest = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let reserved = RESERVED.iter().any(|word| word.eq_ignore_ascii_case(name));
    let fits = first && rest && !reserved && name.len() <= NAME_CHARS;
    let rule = format!(
        "a letter, then letters, digits and underscores, {NAME_CHARS} characters at most, and no word of the language"
    );
    ProgramErrorKind::unless(fits, what, format!("\"{name}\""), rule)
}

/// Radius of a zone that the controller knows by name, m.
fn zone_radius_m(name: &str) -> Option<f64> {
    let number: u32 = name.strip_prefix('z')?.parse().ok()?;
    let mm = if number == 0 { 0.3 } else { f64::from(number) };
    ZONES.contains(&number).then_some(mm * 1e-3)
}

fn unknown_zone(name: &str) -> ProgramErrorKind {
    let known: Vec<String> = ZONES.iter().map(|zone| format!("z{zone}")).collect();
    let rule = format!("`fine` or one of {}", known.join(", "));
    ProgramErrorKind::value("the zone", format!("\"{name}\""), rule)
}

fn check_zone(zone: &str) -> Result<(), ProgramErrorKind> {
    let known = zone == "fine" || zone_radius_m(zone).is_some();
    if known {
        Ok(())
    } else {
        Err(unknown_zone(zone))
    }
}
