//! The motion of a polishing wheel along a raster over a rectangular face, its spin axis
//! precessing.

use nalgebra::{Isometry3, Matrix3, Rotation3, SVector, UnitQuaternion, Vector2, Vector3};
use thiserror::Error;
use truecut_arm::{ArmError, BranchOptions, FrameId, PathOptions, Robot};
use truecut_core::wheel::precession::{Boundary, EdgeRule, PrecessionWheel};

use super::follow::{FollowError, check_singularities, check_speeds, leaves};
use super::raster::{Raster, vertices};
use super::timing::{LeadIn, TimingLaw};
use super::trajectory::Trajectory;
use crate::precession::{
    ArmOnFace, PrecessionLimits, PrecessionOptions, PrecessionPlan, PrecessionPlanError,
    PrecessionPoint, PrecessionTask,
};

/// Time in which feed and turn come up to speed, s.
const LEAD_IN: TimingLaw = TimingLaw::FromRest(LeadIn { duration_s: 0.5 });

/// A rectangular face in the world. Its own frame has the origin in a corner, x along the length,
/// z along the outward normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RectangularFace {
    /// Corner at which a raster begins, m.
    pub origin_m: [f64; 3],
    /// Unit vector along the length.
    pub x_axis: [f64; 3],
    /// Outward unit normal, square to `x_axis`.
    pub normal: [f64; 3],
    /// Length, along x, m.
    pub length_m: f64,
    /// Width, along y = normal × x, m.
    pub width_m: f64,
}

impl RectangularFace {
    /// Its frame in the world.
    #[must_use]
    pub fn world_from_face(&self) -> Isometry3<f64> {
        let (x, z) = (Vector3::from(self.x_axis), Vector3::from(self.normal));
        let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]));
        Isometry3::from_parts(
            Vector3::from(self.origin_m).into(),
            UnitQuaternion::from_rotation_matrix(&axes),
        )
    }
}

/// How a wheel's spin axis turns about the normal of a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Precession {
    /// Rate of the steady turn, from the face's x axis towards its y axis, rad/s; negative: the
    /// other way.
    pub turn_rad_s: f64,
    /// Angle towards which the axis leans at the start, rad.
    pub start_rad: f64,
    /// What the angle keeps at edges, and how fast angle and feed may change for it; `None`: it
    /// turns steadily.
    pub at_edges: Option<(EdgeRule, PrecessionLimits)>,
}

/// A raster over a face, and how the wheel's spin axis turns along it. The tool's x axis is along
/// the face's length, made square to the tool axis.
#[derive(Debug)]
pub struct RasterTask<'a> {
    pub wheel: &'a PrecessionWheel,
    pub face: RectangularFace,
    pub raster: Raster,
    pub precession: Precession,
    /// Time between knots, s.
    pub interval_s: f64,
}

/// A wheel led along a raster.
#[derive(Debug)]
pub struct RasterMotion {
    /// Postures at even times, from rest on.
    pub knots: Vec<Vec<f64>>,
    pub duration_s: f64,
    /// How the angle keeps its rule at edges, where it has one.
    pub plan: Option<PrecessionPlan>,
}

/// Why a wheel cannot be led along a raster.
#[derive(Debug, Error)]
pub enum RasterError {
    #[error("{0}")]
    Face(String),
    #[error(transparent)]
    Precession(#[from] PrecessionPlanError),
    #[error(transparent)]
    Arm(#[from] ArmError),
    #[error(transparent)]
    Follow(#[from] FollowError),
}

/// A place on the raster: distance from its start (m), x and y on the face (m), precession angle
/// (rad, turns counted).
type RasterPlace = SVector<f64, 4>;

fn place(along_m: f64, point_m: &Vector2<f64>, angle_rad: f64) -> RasterPlace {
    RasterPlace::new(along_m, point_m.x, point_m.y, angle_rad)
}

impl RasterTask<'_> {
    /// Solves the motion; `posture` chooses the branch at the start.
    ///
    /// # Errors
    /// If the angle cannot keep its rule, or the arm cannot be led along the raster.
    pub fn solve(&self, robot: &Robot, posture: &[f64]) -> Result<RasterMotion, RasterError> {
        let face = &self.face;
        let vertices = vertices([face.length_m, face.width_m], &self.raster);
        let solver = robot.ik_solver(&BranchOptions::default());
        let arm = ArmOnFace {
            robot,
            solver: &solver,
            world_from_face: face.world_from_face(),
            zero_direction: face.x_axis.into(),
            start: posture,
        };
        let (knots, plan) = match &self.precession.at_edges {
            None => (self.steady(&vertices), None),
            Some((rule, limits)) => {
                let plan = self.planned(&vertices, &arm, (*rule, limits))?;
                let knot = |point: &PrecessionPoint| {
                    let place = place(point.along_m, &point.point_m, point.angle_rad);
                    (point.time_s, place)
                };
                (plan.points.iter().map(knot).collect(), Some(plan))
            }
        };
        let trajectory = Trajectory::new(knots, LEAD_IN);
        let places = trajectory.sampled(self.interval_s);
        let poses: Vec<Isometry3<f64>> = (places.iter())
            .map(|place| arm.pose(self.wheel, &Vector2::new(place[1], place[2]), place[3]))
            .collect::<Result<_, ArmError>>()?;
        let at_mm = |k: usize| places[k][0] * 1e3;
        let followed = solver.follow(&poses, FrameId::Tool, posture, &PathOptions::default());
        let knots = followed.map_err(|error| leaves(error.kind(), &at_mm).1)?;
        check_singularities(&solver, &knots, &at_mm)?;
        let advice = "lower the feed or the rate of the precession";
        check_speeds(robot, &knots, self.interval_s, &at_mm, "the path", advice)?;
        Ok(RasterMotion {
            knots,
            duration_s: trajectory.duration_s(),
            plan,
        })
    }

    /// The angle turns by the clock, the feed is that asked for.
    fn steady(&self, vertices: &[Vector2<f64>]) -> Vec<(f64, RasterPlace)> {
        let (mut along_m, mut knots) = (0.0, Vec::with_capacity(vertices.len()));
        let turn = &self.precession;
        for (k, point_m) in vertices.iter().enumerate() {
            along_m += (point_m - vertices[k.saturating_sub(1)]).norm();
            let time_s = along_m / self.raster.feed_m_per_s;
            let angle_rad = turn.start_rad + turn.turn_rad_s * time_s;
            knots.push((time_s, place(along_m, point_m, angle_rad)));
        }
        knots
    }

    /// The angle keeps a rule at edges; feed and angle are lowered to what the rule and the joints
    /// allow.
    fn planned(
        &self,
        vertices: &[Vector2<f64>],
        arm: &ArmOnFace<'_>,
        (rule, limits): (EdgeRule, &PrecessionLimits),
    ) -> Result<PrecessionPlan, RasterError> {
        let boundary = Boundary::rectangle(self.face.length_m, self.face.width_m)
            .map_err(|error| RasterError::Face(error.to_string()))?;
        let task = PrecessionTask {
            wheel: self.wheel,
            boundary: &boundary,
            rule,
            path_m: vertices,
            feed_m_per_s: self.raster.feed_m_per_s,
            turn_rad_s: self.precession.turn_rad_s,
            start_rad: self.precession.start_rad,
        };
        let options = PrecessionOptions::default();
        Ok(task.plan_for_arm(arm, limits, &options)?.plan)
    }
}
