//! KUKA programs in KRL: a `.src` with the moves, a `.dat` with the positions.
//!
//! Fields, and where they are documented, stand in `docs/robot_program_formats.md`. Positions are
//! millimetres with three decimals and degrees with four.

mod dialect;
mod inline;
mod motion;
mod read;
mod settings;
mod structures;
mod write;

use truecut_arm::{Elbow, OpwGeometry, Shoulder, Wrist};

use super::ProgramErrorKind;
use super::flags::{Flags, branch_excess, outside_rad};
use super::source::Syntax;

#[cfg(test)]
pub(super) use dialect::sample_options;
pub use dialect::{DIALECT, Krl};

/// Longest name, characters.
const NAME_CHARS: usize = 24;
const SYNTAX: Syntax = Syntax {
    comment: ';',
    marks: "[],(){}:=",
    in_words: "$#&'<>*/",
    lines: true,
};
/// Mass by which `$LOAD` says that the load is not known.
const NO_LOAD_KG: f64 = -1.0;

/// Status and turn of a position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StatusTurn {
    /// 1 if the wrist centre is behind axis 1, plus 2 for the elbow up, plus 4 for a negative axis
    /// 5.
    pub status: u8,
    /// A bit for each axis whose angle is negative; `None` if the file does not say.
    pub turn: Option<u8>,
}

impl StatusTurn {
    /// Those of a posture.
    #[must_use]
    pub fn of(geometry: &OpwGeometry, q: &[f64]) -> Self {
        let branch = geometry.branch(q);
        let bit = |joint: usize| u8::from(q[joint] < 0.0) << joint;
        Self {
            status: u8::from(branch.shoulder == Shoulder::Rear)
                + 2 * u8::from(branch.elbow == Elbow::Upper)
                + 4 * u8::from(branch.wrist == Wrist::Negative),
            turn: Some((0..6).map(bit).sum()),
        }
    }
}

impl Flags for StatusTurn {
    fn joint_excess(&self, joint: usize, q: f64) -> f64 {
        match self.turn {
            Some(turn) if turn >> joint & 1 == 1 => outside_rad(q, &[(-360.0, 0.0)]),
            Some(_) => outside_rad(q, &[(0.0, 360.0)]),
            None => 0.0,
        }
    }

    fn branch_excess(&self, geometry: &OpwGeometry, q: &[f64]) -> f64 {
        let bit = |bit: u8| self.status & bit != 0;
        branch_excess(geometry, q, [Some(bit(1)), Some(!bit(2)), Some(bit(4))])
    }

    fn text(&self) -> String {
        match self.turn {
            Some(turn) => format!("S {}, T {turn}", self.status),
            None => format!("S {}", self.status),
        }
    }
}

fn check_name(name: &str) -> Result<(), ProgramErrorKind> {
    let first = name.chars().next().is_some_and(|c| c.is_ascii_alphabetic());
    let rest = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let fits = first && rest && name.len() <= NAME_CHARS;
    let rule = format!("a letter, then letters, digits and underscores, {NAME_CHARS} at most");
    ProgramErrorKind::unless(fits, "the program's name", format!("\"{name}\""), rule)
}
