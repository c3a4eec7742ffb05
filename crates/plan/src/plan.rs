//! What the planner gives.

use nalgebra::Vector3;

use crate::assessment::Assessment;
use crate::criterion::Criterion;
use crate::intervals::Interval;
use crate::reach::{Family, largest_motion_rad};

/// A part of the path with one interval of angles to be taken, that at its midpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    pub from_m: f64,
    pub to_m: f64,
    pub interval: Interval,
}

impl Segment {
    pub fn midpoint_m(&self) -> f64 {
        0.5 * (self.from_m + self.to_m)
    }

    /// Its midpoint (m), and the redundancy angle taken there (rad).
    pub(crate) fn knot(&self) -> (f64, f64) {
        (self.midpoint_m(), self.interval.middle_rad())
    }
}

/// The arm at one station of the path.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanPoint {
    pub along_m: f64,
    pub point_m: Vector3<f64>,
    /// Redundancy angle, running on over whole turns.
    pub angle_rad: f64,
    /// Joint angles, rad.
    pub posture: Vec<f64>,
    pub assessment: Assessment,
}

/// A continuous joint path.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub criterion: Criterion,
    /// Empty for a constant angle.
    pub segments: Vec<Segment>,
    pub points: Vec<PlanPoint>,
    pub family: Family,
}

impl Plan {
    /// The point with the least reserve.
    pub fn weakest(&self) -> &PlanPoint {
        let reserve = |p: &&PlanPoint| p.assessment.reserve();
        let weakest = self
            .points
            .iter()
            .min_by(|a, b| reserve(a).total_cmp(&reserve(b)));
        weakest.unwrap_or(&self.points[0])
    }

    /// Places (m) and redundancy angles (rad) between which the angle turns as 3u² − 2u³; it is
    /// constant beyond the ends.
    pub fn knots(&self) -> Vec<(f64, f64)> {
        if self.segments.is_empty() {
            return vec![(0.0, self.points[0].angle_rad)];
        }
        self.segments.iter().map(Segment::knot).collect()
    }

    /// Largest motion of one joint from one point to the next, rad.
    pub fn largest_step_rad(&self) -> f64 {
        let steps = self.points.windows(2);
        let steps = steps.map(|w| largest_motion_rad(&w[0].posture, &w[1].posture));
        steps.fold(0.0, f64::max)
    }
}

/// What a criterion says over path and angle.
#[derive(Debug, Clone, PartialEq)]
pub struct MarginMap {
    pub criterion: Criterion,
    pub along_m: Vec<f64>,
    pub angles_rad: Vec<f64>,
    /// By place, then angle; none where the family does not reach.
    pub assessments: Vec<Vec<Option<Assessment>>>,
}
