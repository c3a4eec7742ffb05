//! The motion of a contact wheel over the lines of a path job.
//!
//! Lines, branch and checks are those of [`crate::surface_path`]. Down, along and up is one
//! trajectory at the feed from rest to rest, its poses exactly over the face; from line to line all
//! joints move together by the law of least jerk. A turntable turns, or the arm goes on to the next
//! copy, during the move between copies.

use nalgebra::{Isometry3, SVector, Unit, Vector3};
use thiserror::Error;
use truecut_arm::{BranchOptions, FrameId, IkSolver, PathOptions, Robot};

use super::follow::{FollowError, check_duration, check_singularities, check_speeds, leaves};
use super::joints::move_by_joints;
use super::timing::{LeadIn, TimingLaw};
use super::trajectory::Trajectory;
use crate::program::TravelOptions;
use crate::surface::{Forms, PatchFile, Surface, SurfaceError};
use crate::surface_path::{
    self, Contact, ContactWheel, PathSetup, Segment, SurfacePath, SurfacePathError, SurfaceSetup,
    Symmetry, copies, parts_of, wheel_pose,
};

/// Time in which the wheel comes up to the feed, and in which it comes to rest, s.
const RAMP: TimingLaw = TimingLaw::RestToRest(LeadIn { duration_s: 0.3 });
/// Shortest move by joints between two lines, s: a faster one would leave the arm swinging.
const LEAST_MOVE_S: f64 = 0.6;

/// Lines on the copies of a face, and how fast they are followed.
#[derive(Debug, Clone, Copy)]
pub struct LinesTask<'a> {
    pub surface: &'a SurfaceSetup,
    pub wheel: &'a ContactWheel,
    pub path: &'a PathSetup,
    pub symmetry: Option<&'a Symmetry>,
    /// How many of the copies are finished, one after another.
    pub copies: usize,
    /// Speed of moves by joints, share of the top speed.
    pub joint_share: f64,
    /// Largest motion of one joint from point to point on a line, rad.
    pub largest_step_rad: f64,
    /// Time between knots, s.
    pub interval_s: f64,
    /// Longest time that one line may take, s.
    pub longest_s: f64,
}

/// A face at its place while it is finished.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CopyAt {
    /// From when on it is the one under the wheel, s.
    pub from_s: f64,
    pub world_from_patch: Isometry3<f64>,
}

/// A wheel led over lines.
#[derive(Debug)]
pub struct LinesMotion {
    /// Postures at even times, from rest to rest.
    pub knots: Vec<Vec<f64>>,
    pub patch: PatchFile,
    /// The lines on the patch, in its frame.
    pub lines: SurfacePath,
    /// The copies, in the order in which they are finished.
    pub copies: Vec<CopyAt>,
}

/// Why a wheel cannot be led over lines.
#[derive(Debug, Error)]
pub enum LinesError {
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    #[error(transparent)]
    Path(#[from] SurfacePathError),
    #[error(transparent)]
    Follow(#[from] FollowError),
    #[error("the patch has no normal at u = {u:.4}, v = {v:.4}")]
    NoNormal { u: f64, v: f64 },
}

impl LinesTask<'_> {
    /// Solves the motion; `posture` is where the arm comes from.
    ///
    /// # Errors
    /// If the patch cannot be read, lines cannot be laid on it, or the arm cannot be led along
    /// them.
    pub fn solve(&self, robot: &Robot, posture: &[f64]) -> Result<LinesMotion, LinesError> {
        let patch = self.surface.face.load()?;
        let lines = self.path.lines(self.wheel, &patch)?;
        let mut parts = parts_of(&self.segments(&lines), self.symmetry)?;
        parts.retain(|part| part.copy < self.copies);
        let segments: Vec<Segment> = parts.iter().map(|part| part.segment.clone()).collect();
        let options = TravelOptions {
            largest_step: self.largest_step_rad,
            ..TravelOptions::default()
        };
        let solved = surface_path::solve(robot, &segments, posture, &options)?;
        let stands = self.stands();
        let guide = Guide {
            robot,
            solver: robot.ik_solver(&BranchOptions::default()),
            surface: patch.surface.as_ref(),
            task: self,
        };
        let mut motion = Growing::default();
        for (part, planned) in parts.iter().zip(&solved) {
            let trajectory = self.trajectory(guide.surface, &lines.lines[part.index]);
            let advice = "raise the job's path.feed_mm_per_s";
            check_duration(trajectory.duration_s(), self.longest_s, advice)?;
            let places = trajectory.sampled(self.interval_s).into_iter();
            let places: Vec<LinePlace> = places.map(LinePlace).collect();
            let line = guide.postures(&places, &stands[part.copy], &planned[0])?;
            motion.add(part.copy, line, &guide);
        }
        let copies = motion.from_s.into_iter().zip(stands);
        let copies = copies.map(|(from_s, world_from_patch)| CopyAt {
            from_s,
            world_from_patch,
        });
        Ok(LinesMotion {
            knots: motion.knots,
            copies: copies.collect(),
            patch,
            lines,
        })
    }

    /// Poses of the tool along each line of the first copy, lifted ones before and after, world.
    fn segments(&self, lines: &SurfacePath) -> Vec<Segment> {
        let world_from_patch = self.surface.world_from_patch;
        let line = |poses: Vec<Isometry3<f64>>| {
            Segment::Planned(poses.iter().map(|pose| world_from_patch * pose).collect())
        };
        lines
            .poses(self.path.lift_m)
            .into_iter()
            .map(line)
            .collect()
    }

    /// Where the patch of each copy stands while it is finished: a turntable brings all to where
    /// the first one is.
    fn stands(&self) -> Vec<Isometry3<f64>> {
        let first = self.surface.world_from_patch;
        match self.symmetry {
            Some(about) if !about.turntable => {
                let turned = copies(&[first], &about.centre_m, &about.axis, about.count);
                turned.into_iter().flatten().take(self.copies).collect()
            }
            _ => vec![first; self.copies],
        }
    }

    /// Down onto a line, along it at the feed of the wheel's centre, and up.
    fn trajectory(&self, surface: &dyn Surface, line: &[Contact]) -> Trajectory<SVector<f64, 5>> {
        let (lift_m, mut before) = (self.path.lift_m, None::<(f64, Vector3<f64>)>);
        let mut places: Vec<(f64, LinePlace)> = Vec::with_capacity(line.len() + 2);
        for contact in line {
            let turn_rad = turn_rad(surface, contact, before.map(|(turn_rad, _)| turn_rad));
            let path_m = before.map_or(lift_m, |(_, centre)| (contact.centre_m - centre).norm());
            if before.is_none() {
                places.push((
                    0.0,
                    LinePlace::new([contact.u, contact.v], turn_rad, lift_m),
                ));
            }
            places.push((
                path_m,
                LinePlace::new([contact.u, contact.v], turn_rad, 0.0),
            ));
            before = Some((turn_rad, contact.centre_m));
        }
        if let Some((_, last)) = places.last().copied() {
            places.push((lift_m, LinePlace::new(last.uv(), last.turn_rad(), lift_m)));
        }
        at_feed(places, self.path.feed_m_per_s)
    }
}

/// A place of the wheel: distance along the trajectory (m), u, v, turn of the axis from r_u in the
/// tangent plane (rad), lift (m). The filter is taken of these and not of joints: the wheel's
/// height over the face stays exact.
#[derive(Debug, Clone, Copy, PartialEq)]
struct LinePlace(SVector<f64, 5>);

impl LinePlace {
    fn new(uv: [f64; 2], turn_rad: f64, lift_m: f64) -> Self {
        Self(SVector::from([0.0, uv[0], uv[1], turn_rad, lift_m]))
    }

    /// Distance from the trajectory's start.
    fn along_m(&self) -> f64 {
        self.0[0]
    }

    fn uv(&self) -> [f64; 2] {
        [self.0[1], self.0[2]]
    }

    fn turn_rad(&self) -> f64 {
        self.0[3]
    }

    fn lift_m(&self) -> f64 {
        self.0[4]
    }
}

/// Places at the feed, each with its distance (m) from the one before; those at no distance are
/// left out.
fn at_feed(
    places: impl IntoIterator<Item = (f64, LinePlace)>,
    feed_m_per_s: f64,
) -> Trajectory<SVector<f64, 5>> {
    let mut along_m = 0.0;
    let mut kept = Vec::new();
    for (path_m, mut place) in places {
        if !kept.is_empty() && path_m <= 0.0 {
            continue;
        }
        along_m += path_m;
        place.0[0] = along_m;
        kept.push((along_m / feed_m_per_s, place.0));
    }
    Trajectory::new(kept, RAMP)
}

/// Angle of the wheel's axis from r_u about the normal, continued from the one before.
fn turn_rad(surface: &dyn Surface, contact: &Contact, before: Option<f64>) -> f64 {
    let along = surface.jet(contact.u, contact.v).first_m[0].normalize();
    let across = contact.normal.cross(&along);
    let turn = contact.axis.dot(&across).atan2(contact.axis.dot(&along));
    let whole = std::f64::consts::TAU;
    before.map_or(turn, |before| {
        turn + whole * ((before - turn) / whole).round()
    })
}

/// What leads the arm along a line.
struct Guide<'a> {
    robot: &'a Robot,
    solver: IkSolver<'a>,
    surface: &'a dyn Surface,
    task: &'a LinesTask<'a>,
}

impl Guide<'_> {
    /// Pose of the tool over the patch.
    fn pose(&self, place: &LinePlace) -> Result<Isometry3<f64>, LinesError> {
        let [u, v] = place.uv();
        let jet = self.surface.jet(u, v);
        let forms = Forms::of(&jet).ok_or(LinesError::NoNormal { u, v })?;
        let normal = forms.normal;
        let along = jet.first_m[0].normalize();
        let (sine, cosine) = place.turn_rad().sin_cos();
        let axis = Unit::new_normalize(along * cosine + normal.cross(&along) * sine);
        let wheel = self.task.wheel;
        let height_m = wheel.radius_m - wheel.indentation_m + place.lift_m();
        let centre_m = jet.point_m + normal.into_inner() * height_m;
        Ok(wheel_pose(centre_m, &axis, &normal))
    }

    /// Postures along a line over a patch that stands there, on the branch of `near`.
    fn postures(
        &self,
        places: &[LinePlace],
        world_from_patch: &Isometry3<f64>,
        near: &[f64],
    ) -> Result<Vec<Vec<f64>>, LinesError> {
        let poses = places
            .iter()
            .map(|place| Ok(world_from_patch * self.pose(place)?));
        let poses: Vec<Isometry3<f64>> = poses.collect::<Result<_, LinesError>>()?;
        let at_mm = |k: usize| places[k].along_m() * 1e3;
        let followed = (self.solver).follow(&poses, FrameId::Tool, near, &PathOptions::default());
        let postures = followed.map_err(|error| leaves(error.kind(), &at_mm).1)?;
        check_singularities(&self.solver, &postures, &at_mm)?;
        let (interval_s, advice) = (self.task.interval_s, "lower the job's path.feed_mm_per_s");
        check_speeds(self.robot, &postures, interval_s, &at_mm, "a line", advice)?;
        Ok(postures)
    }

    /// Knots of the move from one line to the next, its two ends left out.
    fn between(&self, from: &[f64], to: &[f64]) -> Vec<Vec<f64>> {
        let (share, interval_s) = (self.task.joint_share, self.task.interval_s);
        move_by_joints(self.robot, [from, to], share, LEAST_MOVE_S, interval_s)
    }
}

/// The motion as it grows line by line.
#[derive(Default)]
struct Growing {
    knots: Vec<Vec<f64>>,
    /// From when on each copy is under the wheel, s.
    from_s: Vec<f64>,
}

impl Growing {
    fn add(&mut self, copy: usize, line: Vec<Vec<f64>>, guide: &Guide<'_>) {
        let between = match (self.knots.last(), line.first()) {
            (Some(from), Some(to)) => guide.between(from, to),
            _ => Vec::new(),
        };
        if copy >= self.from_s.len() {
            // Halfway between two copies.
            let knots = self.knots.len() + between.len() / 2;
            self.from_s.push(knots as f64 * guide.task.interval_s);
        }
        self.knots.extend(between);
        self.knots.extend(line);
    }
}
