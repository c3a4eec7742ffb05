//! Paths from CAM: G-code, APT cutter locations, and poses in CSV.
//!
//! A [`CamPath`] holds points of the tool's tip in the work frame, with the tool's axis, the feed
//! and the line that each came from; arcs are points on them between which chords keep to a
//! tolerance. [`follow`] puts it before an arm. What is read of each format, and what is refused,
//! stands in `docs/cam_files.md`.

mod apt;
mod apt_words;
mod follow;
mod gap;
pub mod gcode;
mod poses;
mod spindle;

use std::path::Path;

use nalgebra::{UnitQuaternion, UnitVector3, Vector3};

pub use follow::{Rapid, WorkSetup, follow};
pub use spindle::{SpindleAtCuts, SpindleSpeed, SpindleTurn, SpindleWord};

use crate::program::{FASTEST_M_PER_S, ProgramError, ProgramErrorKind, SLOWEST};

const INCH_M: f64 = 0.0254;
/// Endings of files and what reads them.
const GCODE: [&str; 7] = ["nc", "gcode", "ngc", "tap", "cnc", "mpf", "eia"];
const APT: [&str; 4] = ["apt", "cls", "cl", "aptsource"];

/// How the tool stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Attitude {
    /// Its axis, from the tip to the spindle; the turn about it is free.
    Axis(UnitVector3<f64>),
    /// All of it: the work frame's axes turned into the tool's, z into the workpiece.
    Whole(UnitQuaternion<f64>),
}

/// A point of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CamPoint {
    /// Line of the file that it came from.
    pub line: usize,
    /// Of the tip in the work frame.
    pub place_m: Vector3<f64>,
    pub attitude: Attitude,
    /// On the way there; `None` in rapid traverse.
    pub feed_m_per_s: Option<f64>,
    /// The tool stops there. Points within an arc are no ends of a block: it passes them.
    pub stops: bool,
}

/// A path as a CAM file says it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CamPath {
    pub points: Vec<CamPoint>,
    /// What is said of the spindle, in order.
    pub spindle: Vec<SpindleWord>,
    /// What was left aside, with lines.
    pub notes: Vec<String>,
}

impl CamPath {
    /// Whether the turn about the tool's axis is free at any point.
    #[must_use]
    pub fn leaves_turn_free(&self) -> bool {
        let free = |point: &CamPoint| matches!(point.attitude, Attitude::Axis(_));
        self.points.iter().any(free)
    }
}

/// How a file is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CamOptions {
    /// Unit of lengths where the file does not say it.
    pub unit_m: f64,
    /// How far chords may lie off an arc.
    pub chord_m: f64,
}

impl Default for CamOptions {
    /// Millimetres, 0.01 mm.
    fn default() -> Self {
        Self {
            unit_m: 1e-3,
            chord_m: 1e-5,
        }
    }
}

/// Whether a file's ending is one of those that are read as paths from CAM.
#[must_use]
pub fn is_cam(file: &Path) -> bool {
    ending(file).is_some_and(|ending| {
        ending == "csv" || GCODE.contains(&ending.as_str()) || APT.contains(&ending.as_str())
    })
}

/// Endings that are read, for messages.
#[must_use]
pub fn endings() -> String {
    let all = GCODE.iter().chain(&APT).chain(&["csv"]);
    let all: Vec<String> = all.map(|ending| format!(".{ending}")).collect();
    all.join(", ")
}

fn ending(file: &Path) -> Option<String> {
    Some(file.extension()?.to_str()?.to_lowercase())
}

/// Reads a path in the format of its file's ending.
///
/// # Errors
/// At the first line that is not understood, with its word and the rule.
pub fn read(text: &str, file: &Path, options: &CamOptions) -> Result<CamPath, ProgramError> {
    let ending = ending(file).unwrap_or_default();
    let path = match ending.as_str() {
        "csv" => poses::read(text, file)?,
        _ if APT.contains(&ending.as_str()) => apt::read(text, file, options)?,
        _ => gcode::read(text, file, options)?,
    };
    if path.points.is_empty() {
        let missing = "any point of a path".to_owned();
        let last = text.lines().count().max(1);
        let kind = ProgramErrorKind::Truncated { missing };
        return Err(ProgramError::in_file(file, last, kind));
    }
    for point in &path.points {
        ProgramErrorKind::unless_too_far(&point.place_m)
            .map_err(|kind| ProgramError::in_file(file, point.line, kind))?;
    }
    Ok(path)
}

/// A feed, m/s, that was given as a value of a file's.
fn checked_feed(
    what: &str,
    given: impl std::fmt::Display + Copy,
    m_per_s: f64,
) -> Result<f64, ProgramErrorKind> {
    ProgramErrorKind::unless(m_per_s > 0.0, what, given, "above zero")?;
    let in_both = |m_per_s: f64| {
        let mm = m_per_s * 1e3;
        format!("{mm} mm/s ({} mm/min)", mm * 60.0)
    };
    let rule = format!(
        "at most {}: no arm leads a tool faster",
        in_both(FASTEST_M_PER_S)
    );
    ProgramErrorKind::unless(m_per_s <= FASTEST_M_PER_S, what, given, rule)?;
    let rule = format!("at least {}: the move would not end", in_both(SLOWEST));
    ProgramErrorKind::unless(m_per_s >= SLOWEST, what, given, rule)?;
    Ok(m_per_s)
}

/// A note where a unit was asked for that the file contradicts.
fn unit_without_effect(options: &CamOptions, unit_m: f64, word: &str) -> Option<String> {
    let asked = options.unit_m != CamOptions::default().unit_m && options.unit_m != unit_m;
    asked.then(|| {
        format!(
            "{word} says the unit: the one that was given, {} mm, has no effect",
            options.unit_m * 1e3
        )
    })
}

/// The direction of a vector that has a length.
fn direction(vector: Vector3<f64>) -> Result<UnitVector3<f64>, ProgramErrorKind> {
    let length = vector.norm();
    let rule = "above zero: a direction";
    ProgramErrorKind::unless(length > 1e-6, "the length of the tool's axis", length, rule)?;
    Ok(UnitVector3::new_normalize(vector))
}
