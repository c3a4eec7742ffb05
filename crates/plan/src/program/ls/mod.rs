//! Fanuc teach pendant programs as text (`.LS`).
//!
//! Fields, and where they are documented, stand in `docs/robot_program_formats.md`. Positions are
//! millimetres and degrees with three decimals, as the controller prints them.

mod dialect;
mod motion;
mod positions;
mod read;
mod write;

use truecut_arm::{Elbow, OpwGeometry, Shoulder, Wrist};

use super::ProgramErrorKind;
use super::flags::{Flags, branch_excess, outside_rad};
use super::number::whole;
use super::source::Syntax;

#[cfg(test)]
pub(super) use dialect::sample_options;
pub use dialect::{DIALECT, Ls};

/// Longest name, characters.
const NAME_CHARS: usize = 32;
/// Speeds on a line, mm/s.
const MM_PER_S: (f64, f64) = (0.1, 4000.0);
/// Axes whose whole turns the configuration holds.
const TURN_JOINTS: [usize; 3] = [3, 4, 5];
const SYNTAX: Syntax = Syntax {
    comment: '\0',
    marks: "{}:,;='[]",
    in_words: "/!",
    lines: false,
};

/// Configuration of a position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Config {
    /// N: with axis 4 at zero axis 5 bends the tool down from the forearm; F: up.
    pub flip: bool,
    /// U: the elbow up; D: down.
    pub up: bool,
    /// T: the wrist centre in front of axis 1; B: behind.
    pub front: bool,
    /// Whole turns of axes 4, 5 and 6: 0 for −180° to 180°.
    pub turns: [i32; 3],
}

impl Config {
    /// That of a posture.
    #[must_use]
    pub fn of(geometry: &OpwGeometry, q: &[f64]) -> Self {
        let branch = geometry.branch(q);
        Self {
            flip: branch.wrist == Wrist::Negative,
            up: branch.elbow == Elbow::Upper,
            front: branch.shoulder == Shoulder::Front,
            turns: TURN_JOINTS.map(|joint| (q[joint] / std::f64::consts::TAU).round() as i32),
        }
    }

    /// Reads what stands between the quotes: `N U T, 0, 0, 0`.
    fn parse(text: &str) -> Result<Self, ProgramErrorKind> {
        let wanted = "a configuration like 'N U T, 0, 0, 0'";
        let wrong = || ProgramErrorKind::unexpected(&format!("'{text}'"), wanted);
        let mut parts = text.split(',').map(str::trim);
        let mut config = Self {
            flip: false,
            up: true,
            front: true,
            turns: [0; 3],
        };
        for letter in parts.next().unwrap_or_default().split_whitespace() {
            match letter {
                "N" => config.flip = false,
                "F" => config.flip = true,
                "U" => config.up = true,
                "D" => config.up = false,
                "T" => config.front = true,
                "B" => config.front = false,
                // The side of a shoulder, which arms of six axes do not have.
                "L" | "R" => {}
                _ => return Err(wrong()),
            }
        }
        for turn in &mut config.turns {
            *turn = whole(
                parts.next().ok_or_else(wrong)?,
                "a turn of the configuration",
            )?;
        }
        if parts.next().is_some() {
            return Err(wrong());
        }
        Ok(config)
    }
}

impl Flags for Config {
    fn joint_excess(&self, joint: usize, q: f64) -> f64 {
        let turn = TURN_JOINTS.iter().position(|one| *one == joint);
        let turn = match (turn, joint) {
            (Some(k), _) => f64::from(self.turns[k]),
            (None, 0) => 0.0,
            _ => return 0.0,
        };
        outside_rad(q, &[(360.0 * turn - 180.0, 360.0 * turn + 180.0)])
    }

    fn branch_excess(&self, geometry: &OpwGeometry, q: &[f64]) -> f64 {
        branch_excess(
            geometry,
            q,
            [Some(!self.front), Some(!self.up), Some(self.flip)],
        )
    }

    fn text(&self) -> String {
        let letter = |one: bool, yes, no| if one { yes } else { no };
        let [a, b, c] = self.turns;
        format!(
            "CONFIG : '{} {} {}, {a}, {b}, {c}'",
            letter(self.flip, 'F', 'N'),
            letter(self.up, 'U', 'D'),
            letter(self.front, 'T', 'B')
        )
    }
}

fn check_name(name: &str) -> Result<(), ProgramErrorKind> {
    let first = name.chars().next().is_some_and(|c| c.is_ascii_alphabetic());
    let rest = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let fits = first && rest && name.len() <= NAME_CHARS;
    let rule = format!("a letter, then letters, digits and underscores, {NAME_CHARS} at most");
    ProgramErrorKind::unless(fits, "the program's name", format!("\"{name}\""), rule)
}
