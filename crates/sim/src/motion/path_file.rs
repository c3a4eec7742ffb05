//! The motion along a path from a file.

use super::{KNOT_INTERVAL_S, PlannedMotion, Target};
use crate::error::SimError;
use crate::posture;
use std::borrow::Cow;
use std::path::Path;
use truecut_arm::Robot;
use truecut_plan::path_file::{LaidPath, PathFile, PathFileMotion, Way};
use truecut_plan::program::{ProgramError, Start};
use truecut_scenario::{LONGEST_S, RobotSpec};

/// Corners that are rounded by less are not told, m.
const LEAST_ROUNDED_M: f64 = 1e-6;

/// Where the arm of a path may start.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StartNear {
    /// The posture that the scenario gives, of all joints; zero where it gives none.
    pub posture: Vec<f64>,
    /// Whether it gives one of the rotary joints.
    pub is_given: bool,
}

impl StartNear {
    /// As a scenario gives it.
    pub fn of(spec: &RobotSpec, robot: &Robot) -> Result<Self, SimError> {
        let gives_none = spec.posture_rad.is_empty() && spec.posture_m.is_empty();
        Ok(StartNear {
            posture: match gives_none {
                true => vec![0.0; robot.dof()],
                false => posture::posture(spec, robot)?,
            },
            is_given: !spec.posture_rad.is_empty(),
        })
    }

    /// What tells starts apart: no posture is another one than a posture of zeros.
    pub fn key(&self) -> Vec<f64> {
        let mut key = self.posture.clone();
        key.push(f64::from(u8::from(self.is_given)));
        key
    }
}

/// An arm led along a file.
pub(crate) struct LedAlong {
    pub knots: Vec<Vec<f64>>,
    pub duration_s: f64,
    /// What there is to tell of it.
    pub told: String,
    /// The path as written.
    pub way: Option<Way>,
}

/// The motion of an arm that only follows a path; `key` names the file in the scenario.
pub(crate) fn solve(
    path: &PathFile,
    key: &str,
    robot: &Robot,
    start: &StartNear,
) -> Result<PlannedMotion, SimError> {
    let led = lead(path, key, robot, start)?;
    Ok(PlannedMotion {
        knots: led.knots,
        duration_s: led.duration_s,
        note: Some(format!("path: {}, {:.2} s", led.told, led.duration_s)),
        target: led.way.map_or(Target::Nothing, Target::Way),
    })
}

/// Leads an arm along a file, its slides where it starts.
pub(crate) fn lead(
    path: &PathFile,
    key: &str,
    robot: &Robot,
    start: &StartNear,
) -> Result<LedAlong, SimError> {
    let find =
        |robot: &Robot, from: Start<'_>| path.motion(robot, from, KNOT_INTERVAL_S, LONGEST_S);
    let refused =
        |error: &ProgramError, held: &str| SimError::scenario(key, format!("{error}{held}"));
    lead_by(
        &find,
        [&path.file, Path::new("line")],
        robot,
        start,
        &refused,
    )
}

/// The same of a path that was laid on a part: what a line of it is called, which key of the
/// scenario a line comes from, and what helps where the arm cannot follow it.
pub(crate) fn lead_along(
    path: &LaidPath<'_>,
    line_word: &str,
    (key, otherwise): (&dyn Fn(usize) -> String, &str),
    robot: &Robot,
    start: &StartNear,
) -> Result<LedAlong, SimError> {
    let find =
        |robot: &Robot, from: Start<'_>| path.motion(robot, from, KNOT_INTERVAL_S, LONGEST_S);
    let refused = |error: &ProgramError, held: &str| {
        let line = error.line().unwrap_or(1) - 1;
        let message = error.message();
        SimError::scenario(key(line), format!("{message}{held}; {otherwise}"))
    };
    lead_by(
        &find,
        [path.file, Path::new(line_word)],
        robot,
        start,
        &refused,
    )
}

/// Leads an arm, its slides where it starts; the file is told with what a line of it is called.
fn lead_by(
    find: &dyn Fn(&Robot, Start<'_>) -> Result<PathFileMotion, ProgramError>,
    named: [&Path; 2],
    robot: &Robot,
    start: &StartNear,
    refused: &dyn Fn(&ProgramError, &str) -> SimError,
) -> Result<LedAlong, SimError> {
    let slides: Vec<usize> = robot.slides().collect();
    let turning: Vec<usize> = (0..robot.dof()).filter(|at| !slides.contains(at)).collect();
    let held = match slides.is_empty() {
        true => Cow::Borrowed(robot),
        false => {
            let places: Vec<f64> = slides.iter().map(|&at| start.posture[at]).collect();
            Cow::Owned(robot.with_slides_at(&places)?)
        }
    };
    let near: Vec<f64> = turning.iter().map(|&at| start.posture[at]).collect();
    let from = match start.is_given {
        true => Start::Near(&near),
        false => Start::AtRest,
    };
    let found = find(&held, from).map_err(|error| {
        let held = slides_held(robot, &slides, &start.posture);
        refused(&error, &held)
    })?;
    let told = told(named, &found);
    let whole = |knot: Vec<f64>| {
        let mut posture = start.posture.clone();
        (turning.iter().zip(knot)).for_each(|(&at, value)| posture[at] = value);
        posture
    };
    let way = found.way;
    let knots: Vec<Vec<f64>> = found.motion.knots.into_iter().map(whole).collect();
    Ok(LedAlong {
        duration_s: (knots.len() - 1) as f64 * KNOT_INTERVAL_S,
        knots,
        told,
        way: Some(way),
    })
}

/// Where slides stand that a path along a file does not move, as the end of a sentence.
fn slides_held(robot: &Robot, slides: &[usize], posture: &[f64]) -> String {
    if slides.is_empty() {
        return String::new();
    }
    let place = |&at: &usize| {
        let name = &robot.chain.joints[at].name;
        format!("\"{name}\" at {:.1} mm", 1e3 * posture[at])
    };
    let places: Vec<String> = slides.iter().map(place).collect();
    format!(
        "; the path moves the joints that turn, alone: its slides stay where robot.posture_mm has them ({})",
        places.join(", ")
    )
}

/// What there is to tell of a path.
fn told([file, line_word]: [&Path; 2], found: &PathFileMotion) -> String {
    let place = |point: usize| match found.lines.get(point) {
        Some(line) => format!("{} {line}", line_word.display()),
        None => format!("path point {point}"),
    };
    let motion = &found.motion;
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let length_mm = motion.length_m * 1e3;
    let mut told = format!(
        "{name}: {} points, {length_mm:.1} mm on lines",
        found.points
    );
    let (off_m, at) = motion.off;
    if off_m > LEAST_ROUNDED_M {
        let off_mm = off_m * 1e3;
        told.push_str(&format!(
            ", corners rounded, or turned short of, by up to {off_mm:.3} mm at {}",
            place(at)
        ));
    }
    if let Some((count, first)) = motion.slowed {
        told.push_str(&format!(
            ", {count} lines slower than their feed for the speed of a joint, the first at {}",
            place(first)
        ));
    }
    for note in &found.notes {
        told.push_str(&format!("; {note}"));
    }
    told
}
