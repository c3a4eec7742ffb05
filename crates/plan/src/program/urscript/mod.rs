//! Universal Robots programs in URScript.
//!
//! Functions, and where they are documented, stand in `docs/robot_program_formats.md`. Poses are
//! metres with seven decimals and rotation vectors with eight; joints radians with eight.

mod dialect;
mod eval;
mod read;
mod write;

use super::ProgramErrorKind;
use super::source::Syntax;

#[cfg(test)]
pub(super) use dialect::sample_options;
pub use dialect::{DIALECT, UrScript};

const SYNTAX: Syntax = Syntax {
    comment: '#',
    marks: "[],():=",
    in_words: "",
    lines: true,
};
/// What comes before the number of a path point, in a comment of its own.
const POINT: &str = "# point ";
/// Speed of the leading joint that stands for a joint move at full speed.
const JOINT_TOP_RAD_PER_S: f64 = std::f64::consts::PI;
/// Accelerations that are written: those that the language takes where none are given.
const JOINT_RAD_PER_S2: f64 = 1.4;
const LINE_M_PER_S2: f64 = 1.2;
/// A posture is that of a pose if all joints agree to this, rad.
const SAME_POSTURE_RAD: f64 = 1e-4;

fn check_name(name: &str) -> Result<(), ProgramErrorKind> {
    let first = name.chars().next().is_some_and(|c| c.is_ascii_alphabetic());
    let rest = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let rule = "a letter, then letters, digits and underscores";
    ProgramErrorKind::unless(
        first && rest,
        "the program's name",
        format!("\"{name}\""),
        rule,
    )
}
