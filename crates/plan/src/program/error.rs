//! What can be wrong with a robot program or its file.

use std::fmt::Display;

use nalgebra::{Isometry3, Vector3};
use thiserror::Error;
use truecut_arm::{Placed, Robot};

use crate::bounds::OutOfBounds;
use crate::motion::follow::FollowError;

/// Most points of a path: what postures are planned for in bounded memory.
pub const MOST_POINTS: usize = 500_000;
/// Largest speed of a tool that is read or written, m/s: the tools of the fastest arms reach it.
pub const FASTEST_M_PER_S: f64 = 10.0;
/// Least speed of a tool that is read, m/s, and least share of a joint's top speed: a
/// thousandth of what controllers take. A path of a metre takes a week and a half.
pub const SLOWEST: f64 = 1e-6;
/// Farthest that a path may lie from its origin.
const FARTHEST_M: f64 = 1000.0;
/// Largest radius of a circle: rounding moves its places by 0.2 nm.
const LARGEST_RADIUS_M: f64 = 1e6;

/// A fault with the place it was found at.
pub type ProgramError = Placed<ProgramErrorKind>;

/// An option that a dialect cannot take.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum OptionFault {
    #[error("option `{key}` is missing")]
    Missing { key: &'static str },
    #[error("option `{key}` is {value}; it must be {rule}")]
    Value {
        key: &'static str,
        value: String,
        rule: String,
    },
    #[error("option `{key}` is none of this dialect, which has {known}")]
    Unknown { key: String, known: String },
    #[error("the options cannot be read: {0}")]
    Table(String),
}

/// The faults of programs and their files.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ProgramErrorKind {
    #[error("{0}")]
    Unreadable(#[from] std::io::Error),
    #[error("{0}")]
    Option(#[from] OptionFault),
    #[error("`{found}` stands where {wanted} is wanted")]
    Unexpected { found: String, wanted: String },
    #[error("`{found}` is not read: it is {why}")]
    NotRead { found: String, why: String },
    #[error("the file ends here, before {missing}")]
    Truncated { missing: String },
    #[error("{what} has {found} fields; {wanted} are wanted")]
    Fields {
        what: String,
        found: usize,
        wanted: String,
    },
    #[error(transparent)]
    OutOfBounds(#[from] OutOfBounds),
    #[error(
        "position type {found} is unknown; the dialect has PULSE, BASE, ROBOT, TOOL, USER and MTOOL"
    )]
    UnknownPositionType { found: String },
    #[error(
        "positions of type {found} need frames that the file does not hold; BASE and PULSE are read"
    )]
    ForeignPositionType { found: String },
    #[error("{what} is given twice, first in line {first_line}")]
    Twice { what: String, first_line: usize },
    #[error("{what} says {said} positions, but {found} follow")]
    Count {
        what: &'static str,
        said: usize,
        found: usize,
    },
    #[error("no move goes to {name}")]
    UnusedPosition { name: String },
    #[error("there is no {name} to move to")]
    MissingPosition { name: String },
    #[error("{what} holds {found} joints; the robot has {wanted}")]
    JointCount {
        what: String,
        found: usize,
        wanted: usize,
    },
    #[error("pulses need `pulses_per_deg` of joint \"{joint}\", which robot.toml does not give")]
    NoPulses { joint: String },
    #[error(
        "a turntable is written in pulses, but the pulses per degree of the station are not given"
    )]
    NoStationPulses,
    #[error("path point {path_point}: the turntable is given for some moves and not for others")]
    TurntableInSome { path_point: usize },
    #[error(
        "the arm \"{robot}\" is not one with an ortho-parallel basis and a spherical wrist, whose branches the \
         dialect names; urscript and jbi with positions = pulse name none"
    )]
    NotOrthoParallel { robot: String },
    #[error(
        "path point {path_point}: the posture puts the tool {apart_mm:.4} mm and {apart_deg:.4} deg from the pose of the move"
    )]
    PostureMissesPose {
        path_point: usize,
        apart_mm: f64,
        apart_deg: f64,
    },
    #[error("path point {path_point}: joint \"{joint}\" stands at {value_deg:.4} deg; {rule}")]
    Unspeakable {
        path_point: usize,
        joint: String,
        value_deg: f64,
        rule: &'static str,
    },
    #[error(
        "path point {path_point}: no posture reaches the pose with {flags}; the nearest misses them by {excess_deg:.3} deg in all"
    )]
    NoPostureWithFlags {
        path_point: usize,
        flags: String,
        excess_deg: f64,
    },
    #[error(
        "path point {path_point}: the pose is out of the arm's reach; the flange would be at ({:.1}, {:.1}, {:.1}) mm in the world",
        .flange_mm[0], .flange_mm[1], .flange_mm[2]
    )]
    OutOfReach {
        path_point: usize,
        flange_mm: [f64; 3],
    },
    #[error(
        "path point {path_point}: every posture breaks joint limits; the nearest breaks those of joint \"{joint}\" by {excess_deg:.3} deg"
    )]
    OutsideLimits {
        path_point: usize,
        joint: String,
        excess_deg: f64,
    },
    #[error(
        "path point {path_point}: every posture is near a singularity; the furthest is {distance} from that of the {kind} (joint \"{joint}\"), at least {least} are asked"
    )]
    Singular {
        path_point: usize,
        kind: &'static str,
        joint: String,
        distance: String,
        least: String,
    },
    #[error(
        "path point {path_point}: the arm would have to jump on a line: joint \"{joint}\" by {jump_deg:.2} deg, {largest_deg:.2} deg are allowed; the tool itself turns by {turn_deg:.2} deg there"
    )]
    Jump {
        path_point: usize,
        joint: String,
        jump_deg: f64,
        largest_deg: f64,
        /// What the tool turns by from the point before.
        turn_deg: f64,
    },
    #[error("path point {path_point}: {error}")]
    NotLed {
        path_point: usize,
        error: FollowError,
    },
    #[error(
        "path point {path_point}: a turntable turns the workpiece, but must stand still where an arm is led along a file"
    )]
    TurntableMoves { path_point: usize },
    #[error("the path holds one place, but must lead from one place to another")]
    StandsStill,
}

impl ProgramErrorKind {
    pub(crate) fn value(what: impl Display, value: impl Display, rule: impl Display) -> Self {
        OutOfBounds::new(what, value, rule).into()
    }

    /// Refuses more points than are planned for.
    pub(crate) fn unless_too_many(count: usize) -> Result<(), Self> {
        let rule = format!("at most {MOST_POINTS}: cut the file, or allow longer chords");
        Self::unless(count <= MOST_POINTS, "the number of points", count, rule)
    }

    /// Refuses a place that no arm reaches.
    pub(crate) fn unless_too_far(place_m: &Vector3<f64>) -> Result<(), Self> {
        let far_m = place_m.amax();
        let rule = format!("at most {} mm: no arm reaches that far", FARTHEST_M * 1e3);
        let is_near = far_m <= FARTHEST_M;
        Self::unless(is_near, "a coordinate in mm", far_m * 1e3, rule)
    }

    /// Refuses the radius of a circle whose places would be lost in rounding.
    pub(crate) fn unless_too_large(radius_m: f64) -> Result<(), Self> {
        let what = "the radius of a circle in mm";
        let rule = format!("at most {:e}: write a line", LARGEST_RADIUS_M * 1e3);
        Self::unless(radius_m <= LARGEST_RADIUS_M, what, radius_m * 1e3, rule)
    }

    /// Refuses a value that does not hold to a rule.
    pub(crate) fn unless(
        holds: bool,
        what: impl Display,
        value: impl Display,
        rule: impl Display,
    ) -> Result<(), Self> {
        Ok(OutOfBounds::unless(holds, what, value, rule)?)
    }

    /// The path point that a fault of a posture belongs to.
    #[must_use]
    pub fn path_point(&self) -> Option<usize> {
        match self {
            Self::OutOfReach { path_point, .. }
            | Self::OutsideLimits { path_point, .. }
            | Self::Singular { path_point, .. }
            | Self::Jump { path_point, .. }
            | Self::NotLed { path_point, .. }
            | Self::TurntableMoves { path_point }
            | Self::Unspeakable { path_point, .. } => Some(*path_point),
            _ => None,
        }
    }

    pub(crate) fn out_of_reach(path_point: usize, world_from_flange: &Isometry3<f64>) -> Self {
        let flange_mm = (world_from_flange.translation.vector * 1e3).into();
        Self::OutOfReach {
            path_point,
            flange_mm,
        }
    }

    pub(crate) fn not_ortho_parallel(robot: &Robot) -> Self {
        let robot = robot.name.clone();
        Self::NotOrthoParallel { robot }
    }

    pub(crate) fn unexpected(found: &str, wanted: &str) -> Self {
        Self::Unexpected {
            found: found.to_owned(),
            wanted: wanted.to_owned(),
        }
    }

    pub(crate) fn not_read(found: &str, why: &str) -> Self {
        Self::NotRead {
            found: found.to_owned(),
            why: why.to_owned(),
        }
    }

    pub(crate) fn at_point(path_point: usize, what: &str, value: f64, rule: &str) -> Self {
        Self::value(format!("path point {path_point}: the {what}"), value, rule)
    }
}
