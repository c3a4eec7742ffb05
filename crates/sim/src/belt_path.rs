//! The way of a belt's contact wheel over the face of a path job, and the command that leads the arm along it.
//!
//! Lines, branch and checks are the planner's (`truecut_plan::surface_path`). Down, along and up is one course at the feed from
//! rest to rest ([`crate::course`]), its poses exactly over the face; from line to line all joints move together as 10x³ - 15x⁴ + 6x⁵ of the
//! way. A turntable turns, or the arm goes on to the next copy, during the move between copies.

use crate::course::Course;
use crate::error::SimError;
use crate::led_path::{KNOT_INTERVAL_S, LedPath, Over, check_duration, check_speeds};
use crate::path_job;
use crate::process::Copied;
use crate::tool_path::{Along, check_singularities, leaves};
use nalgebra::{Isometry3, SVector, Unit, Vector3};
use std::sync::Arc;
use truecut_arm::{BranchOptions, FrameId, IkSolver, PathOptions, Robot};
use truecut_plan::program::TravelOptions;
use truecut_plan::surface::{Forms, PatchFile, Surface};
use truecut_plan::surface_path::{
    self, Contact, Segment, SurfacePath, copies, parts_of, wheel_pose,
};
use truecut_scenario::{BeltJob, BeltSpec};

const JOB: &str = "process.belt.job";

/// Shortest move by joints between two lines, s: a faster one would leave the arm swinging.
const LEAST_LINK_S: f64 = 0.6;
/// Greatest rate of 10x³ - 15x⁴ + 6x⁵.
const PEAK_RATE: f64 = 1.875;

/// What a belt follows, and where.
#[derive(Debug)]
pub(crate) struct BeltLines {
    pub patch: Arc<PatchFile>,
    /// The lines on the patch, in its frame.
    pub lines: SurfacePath,
    /// The copies, in the order in which they are finished.
    pub copies: Vec<Copied>,
}

/// The way of a belt's wheel along the lines of its job; `posture` is where the arm comes from.
pub(crate) fn solve(spec: &BeltSpec, robot: &Robot, posture: &[f64]) -> Result<LedPath, SimError> {
    let job = &spec.job;
    let refused = |error: &dyn std::fmt::Display| {
        SimError::scenario(JOB, format!("{}: {error}", job.file.display()))
    };
    let patch = PatchFile::load(&job.surface.patch).map_err(|error| refused(&error))?;
    let lines = path_job::lines(&job.path, &job.wheel, &patch).map_err(|e| refused(&e))?;
    let segments = segments(job, &lines);
    let symmetry = job.symmetry.as_ref().map(path_job::symmetry);
    let mut parts = parts_of(&segments, symmetry.as_ref()).map_err(|e| refused(&e))?;
    parts.retain(|part| part.copy < spec.copies);
    let segments: Vec<Segment> = parts.iter().map(|part| part.segment.clone()).collect();
    let options = TravelOptions {
        largest_step: job.largest_step_rad,
        ..TravelOptions::default()
    };
    let solved =
        surface_path::solve(robot, &segments, posture, &options).map_err(|e| refused(&e))?;
    let stands = faces(job, spec.copies);
    let guide = Guide {
        robot,
        solver: robot.ik_solver(&BranchOptions::default()),
        surface: patch.surface.as_ref(),
        job,
    };
    let mut way = Way::default();
    for (part, planned) in parts.iter().zip(&solved.segments) {
        let course = course(guide.surface, &lines.lines[part.index], job);
        check_duration(
            JOB,
            course.duration_s(),
            "raise the job's path.feed_mm_per_s",
        )?;
        let places: Vec<Place> = (course.sampled(KNOT_INTERVAL_S).into_iter())
            .map(Place)
            .collect();
        let line = guide.postures(&places, &stands[part.copy], &planned[0])?;
        way.add(part.copy, line, &guide);
    }
    let copies = way.from_s.into_iter().zip(stands);
    let copies: Vec<Copied> = copies
        .map(|(from_s, world_from_patch)| Copied {
            from_s,
            world_from_patch,
        })
        .collect();
    let duration_s = (way.postures.len() - 1) as f64 * KNOT_INTERVAL_S;
    let note = format!(
        "belt: {} lines on {} of the job's copies, {duration_s:.2} s",
        lines.lines.len(),
        copies.len()
    );
    Ok(LedPath {
        postures: way.postures,
        duration_s,
        note: Some(note),
        over: Over::Lines(BeltLines {
            patch: Arc::new(patch),
            lines,
            copies,
        }),
    })
}

/// Poses of the tool along each line of the first copy, lifted ones before and after, world.
fn segments(job: &BeltJob, lines: &SurfacePath) -> Vec<Segment> {
    let world_from_patch = path_job::pose(&job.surface.place);
    let line = |poses: Vec<Isometry3<f64>>| {
        Segment::Planned(poses.iter().map(|pose| world_from_patch * pose).collect())
    };
    lines.poses(job.path.lift_m).into_iter().map(line).collect()
}

/// Where the patch of each copy stands while it is finished: a turntable brings all to where the first one is.
fn faces(job: &BeltJob, count: usize) -> Vec<Isometry3<f64>> {
    let first = path_job::pose(&job.surface.place);
    match job.symmetry.as_ref().map(path_job::symmetry) {
        Some(about) if !about.turntable => {
            let turned = copies(&[first], &about.centre_m, &about.axis, about.count);
            turned.into_iter().flatten().take(count).collect()
        }
        _ => vec![first; count],
    }
}

/// A place of the wheel: distance along the course (m), u, v, turn of the axis from r_u in the tangent plane (rad), lift (m). The course is taken
/// of these and not of joints: the wheel's height over the face stays exact.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place(SVector<f64, 5>);

impl Place {
    fn new(uv: [f64; 2], turn_rad: f64, lift_m: f64) -> Self {
        Self(SVector::from([0.0, uv[0], uv[1], turn_rad, lift_m]))
    }

    /// Distance from the course's start.
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

/// Places at the feed, each with its distance (m) from the one before; those at no distance are left out.
fn at_feed(
    places: impl IntoIterator<Item = (f64, Place)>,
    feed_m_per_s: f64,
) -> Course<SVector<f64, 5>> {
    let mut along_m = 0.0;
    let mut kept = Vec::new();
    for (way_m, mut place) in places {
        if !kept.is_empty() && way_m <= 0.0 {
            continue;
        }
        along_m += way_m;
        place.0[0] = along_m;
        kept.push((along_m / feed_m_per_s, place.0));
    }
    Course::new(kept)
}

/// Down onto a line, along it at the feed of the wheel's centre, and up.
fn course(surface: &dyn Surface, line: &[Contact], job: &BeltJob) -> Course<SVector<f64, 5>> {
    let (lift_m, mut before) = (job.path.lift_m, None::<(f64, Vector3<f64>)>);
    let mut places: Vec<(f64, Place)> = Vec::with_capacity(line.len() + 2);
    for contact in line {
        let turn_rad = turn_rad(surface, contact, before.map(|(turn_rad, _)| turn_rad));
        let way_m = before.map_or(lift_m, |(_, centre)| (contact.centre_m - centre).norm());
        if before.is_none() {
            places.push((0.0, Place::new([contact.u, contact.v], turn_rad, lift_m)));
        }
        places.push((way_m, Place::new([contact.u, contact.v], turn_rad, 0.0)));
        before = Some((turn_rad, contact.centre_m));
    }
    if let Some((_, last)) = places.last().copied() {
        places.push((lift_m, Place::new(last.uv(), last.turn_rad(), lift_m)));
    }
    at_feed(places, job.path.feed_m_per_s)
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

/// What leads the arm along a course.
struct Guide<'a> {
    robot: &'a Robot,
    solver: IkSolver<'a>,
    surface: &'a dyn Surface,
    job: &'a BeltJob,
}

impl Guide<'_> {
    /// Pose of the tool over the patch.
    fn pose(&self, place: &Place) -> Result<Isometry3<f64>, SimError> {
        let [u, v] = place.uv();
        let jet = self.surface.jet(u, v);
        let forms = Forms::of(&jet).ok_or_else(|| {
            let message = format!("the patch has no normal at u = {u:.4}, v = {v:.4}");
            SimError::scenario(JOB, message)
        })?;
        let normal = forms.normal;
        let along = jet.first_m[0].normalize();
        let (sine, cosine) = place.turn_rad().sin_cos();
        let axis = Unit::new_normalize(along * cosine + normal.cross(&along) * sine);
        let wheel = &self.job.wheel;
        let height_m = wheel.radius_m - wheel.indentation_m + place.lift_m();
        let centre_m = jet.point_m + normal.into_inner() * height_m;
        Ok(wheel_pose(centre_m, &axis, &normal))
    }

    /// Postures along a course over a patch that stands there, on the branch of `near`.
    fn postures(
        &self,
        places: &[Place],
        world_from_patch: &Isometry3<f64>,
        near: &[f64],
    ) -> Result<Vec<Vec<f64>>, SimError> {
        let poses = places
            .iter()
            .map(|place| Ok(world_from_patch * self.pose(place)?));
        let poses: Vec<Isometry3<f64>> = poses.collect::<Result<_, SimError>>()?;
        let along = Along {
            key: JOB,
            at_mm: &|k| places[k].along_m() * 1e3,
        };
        let followed = (self.solver).follow(&poses, FrameId::Tool, near, &PathOptions::default());
        let postures = followed.map_err(|error| leaves(error.kind(), &along).1)?;
        check_singularities(&self.solver, &postures, &along)?;
        let advice = "lower the job's path.feed_mm_per_s";
        check_speeds(self.robot, &postures, &along, "a line", advice)?;
        Ok(postures)
    }

    /// Knots of a move by joints, its two ends left out.
    fn link(&self, from: &[f64], to: &[f64]) -> Vec<Vec<f64>> {
        let slowest_s = (self.robot.chain.joints.iter().enumerate())
            .filter_map(|(i, joint)| {
                let speed = self.job.joint_share * joint.limits?.velocity;
                Some(PEAK_RATE * (to[i] - from[i]).abs() / speed)
            })
            .fold(LEAST_LINK_S, f64::max);
        let count = (slowest_s / KNOT_INTERVAL_S).ceil() as usize;
        let knot = |k: usize| {
            let x = k as f64 / count as f64;
            let part = x.powi(3) * (10.0 + x * (6.0 * x - 15.0));
            from.iter()
                .zip(to)
                .map(|(a, b)| a + part * (b - a))
                .collect()
        };
        (1..count).map(knot).collect()
    }
}

/// The command as it grows line by line.
#[derive(Default)]
struct Way {
    postures: Vec<Vec<f64>>,
    /// From when on each copy is under the wheel, s.
    from_s: Vec<f64>,
}

impl Way {
    fn add(&mut self, copy: usize, line: Vec<Vec<f64>>, guide: &Guide<'_>) {
        let link = match (self.postures.last(), line.first()) {
            (Some(from), Some(to)) => guide.link(from, to),
            _ => Vec::new(),
        };
        if copy >= self.from_s.len() {
            // Halfway between two copies.
            let knots = self.postures.len() + link.len() / 2;
            self.from_s.push(knots as f64 * KNOT_INTERVAL_S);
        }
        self.postures.extend(link);
        self.postures.extend(line);
    }
}
