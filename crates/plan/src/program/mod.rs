//! Robot programs: a path as moves of the robot, written as a Motoman job ([`jbi`]) or an ABB
//! module ([`rapid`]) and read back.
//!
//! A [`Program`] belongs to no maker. Each [`Move`] holds the tool's pose in the base frame and the
//! posture that reaches it; from the posture a dialect derives what it prints to tell the arm's
//! branches apart, and from what is printed the posture is found again ([`jbi::Rconf`],
//! [`rapid::Confdata`]).
//!
//! ```
//! use nalgebra::{Isometry3, Translation3, UnitQuaternion};
//! use truecut_arm::Robot;
//! use truecut_plan::program::{Motion, PathPoint, Program, Tool, TravelOptions, jbi};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/robots");
//! # let urdf = format!("{assets}/irb6600_175_255/robot.urdf");
//! let robot = Robot::load(urdf.as_ref(), None, None)?;
//! let down = UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.0);
//! let points: Vec<PathPoint> = (0..5)
//!     .map(|i| Translation3::new(1.5, 0.02 * f64::from(i), 0.8))
//!     .map(|place| PathPoint {
//!         base_from_tool: Isometry3::from_parts(place, down),
//!         motion: Motion::Linear { speed_m_per_s: 0.02 },
//!         turntable_rad: None,
//!     })
//!     .collect();
//! let tool = Tool::of(&robot, "wheel", 1);
//! let (world_from_base, options) = (Isometry3::identity(), TravelOptions::default());
//! let program = Program::along(&robot, "DEMO", tool, world_from_base, &points, &options)?;
//! let date = jbi::JobDate::new(2026, 1, 31, 12, 0)?;
//! let options = jbi::JbiOptions::new(date);
//! let jobs = jbi::write(&program, &robot, &options)?;
//! let job = jbi::JbiJob::parse(&jobs[0].text, "DEMO.JBI".as_ref())?;
//! let read = job.program(&robot, &program.tool, &program.world_from_base, None)?;
//! assert_eq!(read.moves.len(), 5);
//! # Ok(())
//! # }
//! ```

#[cfg(any(test, feature = "contract"))]
pub mod contract;
mod dialect;
mod encoding;
mod error;
mod euler;
mod flags;
mod inspect;
pub mod jbi;
pub mod krl;
pub mod ls;
mod moves;
pub(crate) mod number;
pub mod rapid;
pub(crate) mod reading;
mod replay;
mod setup;
#[cfg(test)]
mod shipped_dialects;
mod source;
mod spare;
mod start;
mod travel;
pub mod urscript;
mod zones;

use std::path::Path;

use truecut_arm::Robot;

pub use dialect::{
    Dialect, Frames, Options, ProgramFile, ReadText, Resolution, Settings, TurntableUnit,
};
pub use error::{
    FASTEST_M_PER_S, MOST_POINTS, OptionFault, ProgramError, ProgramErrorKind, SLOWEST,
};
pub use inspect::{Finding, FindingKind};
pub use moves::{Motion, Move, PathPoint, Program, SpindleSwitch, Tool, Zone};
pub use replay::{MOST_PLACES, Replay, ReplayOptions, ReplayRow};
pub use setup::ProgramSetup;
pub use start::{Start, along_lines, along_runs};
pub use travel::{TravelOptions, shortest_travel};
pub use zones::ZoneReport;

/// The shipped dialects, each a folder here with a `dialect.rs`: `build.rs` finds the folders.
macro_rules! dialects {
    ($($room:ident),*) => {
        /// The dialects that path jobs name and whose files are read, by name.
        pub static DIALECTS: &[&dyn Dialect] = &[$(&$room::DIALECT),*];

        #[cfg(test)]
        mod contracts {
            use super::shipped_dialects::subject;

            mod hp20 {
                use super::subject;
                $( crate::dialect_contract!($room, subject("hp20", &crate::program::$room::DIALECT,
                    crate::program::$room::sample_options())); )*
            }

            mod irb6600 {
                use super::subject;
                $( crate::dialect_contract!($room, subject("irb6600_175_255", &crate::program::$room::DIALECT,
                    crate::program::$room::sample_options())); )*
            }
        }
    };
}

include!(concat!(env!("OUT_DIR"), "/dialects.rs"));

/// The dialect of this name.
#[must_use]
pub fn dialect_named(name: &str) -> Option<&'static dyn Dialect> {
    DIALECTS.iter().copied().find(|one| one.name() == name)
}

/// The dialect in which robots of this name are programmed, if the name tells it.
#[must_use]
pub fn dialect_for(robot: &Robot) -> Option<&'static dyn Dialect> {
    let text = format!("{} {}", robot.name, robot.chain.name).to_lowercase();
    let words: Vec<&str> = text.split(|c: char| !c.is_alphanumeric()).collect();
    // A maker's name, or the first letters of its models: irb6600.
    let of = |word: &str, maker: &str| {
        let rest = word.strip_prefix(maker);
        rest.is_some_and(|rest| rest.bytes().next().is_none_or(|b| b.is_ascii_digit()))
    };
    let named = |one: &dyn Dialect| {
        let mut makers = one.makers().iter();
        makers.any(|maker| words.iter().any(|word| of(word, maker)))
    };
    DIALECTS.iter().copied().find(|one| named(*one))
}

/// What the robot's name tells against a dialect: that it is another maker's.
#[must_use]
pub fn maker_note(dialect: &dyn Dialect, robot: &Robot) -> Option<String> {
    let other = dialect_for(robot)?;
    (other.name() != dialect.name()).then(|| {
        format!(
            "{} is named as an arm that is programmed in {}, not in {}",
            robot.name,
            other.name(),
            dialect.name()
        )
    })
}

/// Text of a program's file or one from CAM: UTF-8, or else Windows-1252 (Latin-1) or Shift-JIS,
/// as controllers and CAM systems set to other languages write their comments.
///
/// # Errors
/// If the file cannot be read, or is none of these; then with the line.
pub fn read_text(file: &Path) -> std::io::Result<String> {
    let may_be_japanese = dialect_of(file).is_some_and(|one| one.may_be_japanese());
    encoding::decoded(truecut_files::read(file)?, may_be_japanese)
        .map_err(|what| std::io::Error::new(std::io::ErrorKind::InvalidData, what))
}

/// The dialect that a file's extension tells, upper or lower case.
#[must_use]
pub fn dialect_of(file: &Path) -> Option<&'static dyn Dialect> {
    let found = file.extension()?.to_str()?;
    let reads = |one: &&dyn Dialect| {
        let mut extensions = one.extensions().iter();
        extensions.any(|known| known.eq_ignore_ascii_case(found))
    };
    DIALECTS.iter().copied().find(reads)
}
