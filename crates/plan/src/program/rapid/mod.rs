//! ABB modules (`.MOD`) in RAPID.
//!
//! Fields, and where they are documented, stand in `docs/robot_program_formats.md`. Positions are
//! millimetres with three decimals, attitudes quaternions with nine, angles of the turntable
//! degrees with four.

mod dialect;
mod module;
mod read;
mod text;
mod write;

use truecut_arm::{Elbow, OpwGeometry, Shoulder, Wrist};

use super::ProgramErrorKind;
use super::flags::{Flags, branch_excess, outside_rad};

#[cfg(test)]
pub(super) use dialect::sample_options;
pub use dialect::{DIALECT, Rapid};
pub use module::{RapidModule, RapidMove, RobTarget};
pub use write::write;

/// Longest identifier, characters.
const NAME_CHARS: usize = 32;
/// What stands for an external axis that there is not.
const UNUSED_AXIS: f64 = 9e9;
/// Zones that the controller knows by name, beside `fine`.
const ZONES: [&str; 14] = [
    "z0", "z1", "z5", "z10", "z15", "z20", "z30", "z40", "z50", "z60", "z80", "z100", "z150",
    "z200",
];
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
    /// Zone of the points between the first and the last, which are `fine`.
    pub zone: String,
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

fn check_zone(zone: &str) -> Result<(), ProgramErrorKind> {
    let known = zone == "fine" || ZONES.contains(&zone);
    let rule = format!("`fine` or one of {}", ZONES.join(", "));
    ProgramErrorKind::unless(known, "the zone", format!("\"{zone}\""), rule)
}
