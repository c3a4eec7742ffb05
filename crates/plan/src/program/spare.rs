//! Postures along points of an arm with more joints than a pose asks for.
//!
//! A pose has a continuum of postures of such an arm, of which a search has samples: a chain
//! through samples leads from one to another where a line goes on. So the arm is led along every
//! line, place by place, by steps of least length, from a start that lies as near as it can to what
//! is asked for.

use std::ops::Range;

use nalgebra::Isometry3;
use truecut_arm::{ArmError, FrameId, IkOptions, IkSolver, PathOptions};

use super::error::{ProgramError, ProgramErrorKind};
use super::moves::PathPoint;
use super::replay::ReplayOptions;
use super::start::{OTHER_BRANCH_RAD, Start, is_line};
use super::travel::{TravelOptions, candidates, distance, flange_at};
use crate::motion::follow::leaves;

/// Starts from which a run of lines is looked at.
const TRIED: usize = 6;

/// Postures along points: on lines each comes of the one before. The first one is that of least
/// [cost](Start::cost), and one that is reached by joints that nearest to the one before, of those
/// from which the lines behind it can be followed. `frames` are the tool in the flange and the base
/// in the world.
///
/// # Errors
/// At the first point that is out of reach or limits, or to which the arm cannot be led on a line.
pub(super) fn led_along(
    solver: &IkSolver<'_>,
    frames: [&Isometry3<f64>; 2],
    points: &[PathPoint],
    start: Start<'_>,
    options: &TravelOptions,
) -> Result<Vec<Vec<f64>>, ProgramError> {
    let lead = Lead {
        solver,
        frames,
        points,
        options,
    };
    let mut found: Vec<Vec<f64>> = Vec::with_capacity(points.len());
    while found.len() < points.len() {
        let from = found.len();
        let lines = points[from + 1..].iter().take_while(|point| is_line(point));
        let run = from..from + 1 + lines.count();
        let postures = match found.last() {
            Some(before) => lead.run_near(run, before)?,
            None => lead.run_from(run, start)?,
        };
        found.extend(postures);
    }
    Ok(found)
}

/// Where a line between two poses of the tool leads the arm from a posture at its first, place by
/// place as a program is run through.
pub(super) fn line_end(
    solver: &IkSolver<'_>,
    frames: [&Isometry3<f64>; 2],
    [from, to]: [&Isometry3<f64>; 2],
    posture: &[f64],
) -> Result<Vec<f64>, ArmError> {
    let count = places(from, to);
    let pose = |k: usize| {
        let between = from.try_lerp_slerp(to, k as f64 / count as f64, 1e-9);
        // Half a turn has no shortest way: its end is looked at then.
        flange_at(frames, &between.filter(|_| k < count).unwrap_or(*to))
    };
    let poses: Vec<Isometry3<f64>> = (0..=count).map(pose).collect();
    let followed = solver.follow(&poses, FrameId::Flange, posture, &PathOptions::default());
    followed.map(|way| way.last().cloned().unwrap_or_default())
}

fn places(from: &Isometry3<f64>, to: &Isometry3<f64>) -> usize {
    ReplayOptions::default().places(from, to)
}

/// What is needed to lead an arm along points.
struct Lead<'a> {
    solver: &'a IkSolver<'a>,
    frames: [&'a Isometry3<f64>; 2],
    points: &'a [PathPoint],
    options: &'a TravelOptions,
}

impl Lead<'_> {
    fn flange(&self, at: usize) -> Isometry3<f64> {
        flange_at(self.frames, &self.points[at].base_from_tool)
    }

    /// A run of lines that the arm goes to by joints: from the posture to which the one before
    /// leads, if it is near by; a search costs as much as a thousand places of a line.
    fn run_near(
        &self,
        run: Range<usize>,
        before: &[f64],
    ) -> Result<Vec<Vec<f64>>, ProgramErrorKind> {
        let robot = self.solver.robot();
        let options = IkOptions::default();
        let near =
            robot.inverse_kinematics(&self.flange(run.start), FrameId::Flange, before, &options);
        let near = near.ok();
        if let Some(near) = near.filter(|q| distance(before, q).1 < OTHER_BRANCH_RAD)
            && let Ok(found) = self.followed(run.clone(), &near)
        {
            return Ok(found);
        }
        self.run_from(run, Start::Near(before))
    }

    fn run_from(
        &self,
        run: Range<usize>,
        start: Start<'_>,
    ) -> Result<Vec<Vec<f64>>, ProgramErrorKind> {
        let robot = self.solver.robot();
        let (first, towards) = (self.flange(run.start), start.posture(robot));
        let mut starts = (self.solver).starts_near(&first, FrameId::Flange, &towards);
        let cost = |q: &Vec<f64>| start.cost(robot, q);
        starts.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
        let mut furthest: Option<ProgramErrorKind> = None;
        for posture in starts.iter().take(TRIED) {
            match self.followed(run.clone(), posture) {
                Ok(found) => return Ok(found),
                Err(kind) => {
                    let before = furthest.as_ref().map(ProgramErrorKind::path_point);
                    if before.is_none_or(|before| kind.path_point() > before) {
                        furthest = Some(kind);
                    }
                }
            }
        }
        Err(furthest
            .or_else(|| self.unreached(run.start))
            .unwrap_or_else(|| ProgramErrorKind::out_of_reach(run.start, &first)))
    }

    /// Postures along a run of lines from one at its start.
    fn followed(
        &self,
        run: Range<usize>,
        start: &[f64],
    ) -> Result<Vec<Vec<f64>>, ProgramErrorKind> {
        let mut postures = vec![start.to_vec()];
        for at in run.skip(1) {
            let before = &postures[postures.len() - 1];
            let ends = [at - 1, at].map(|at| &self.points[at].base_from_tool);
            let here = line_end(self.solver, self.frames, ends, before)
                .map_err(|error| self.fault(at, &error))?;
            if distance(before, &here).1 > self.options.largest_step {
                return Err(self.too_far(at, before, &here));
            }
            postures.push(here);
        }
        Ok(postures)
    }

    /// Why no posture is at a point; `None` if there is one.
    fn unreached(&self, at: usize) -> Option<ProgramErrorKind> {
        let (robot, limits) = (self.solver.robot(), &self.options.singularity);
        candidates(robot, self.solver, at, &self.flange(at), limits).err()
    }

    /// Why the line to a point is not followed to its end.
    fn fault(&self, at: usize, error: &ArmError) -> ProgramErrorKind {
        let place = |at: usize| self.points[at].base_from_tool.translation.vector;
        let way_m = |at: usize| (place(at) - place(at - 1)).norm();
        let before_m: f64 = (1..at).map(way_m).sum();
        let [from, to] = [at - 1, at].map(|at| &self.points[at].base_from_tool);
        let count = places(from, to) as f64;
        let at_mm = |k: usize| (before_m + way_m(at) * k as f64 / count) * 1e3;
        self.unreached(at)
            .unwrap_or_else(|| ProgramErrorKind::NotLed {
                path_point: at,
                error: leaves(error.kind(), &at_mm).1,
            })
    }

    fn too_far(&self, at: usize, before: &[f64], here: &[f64]) -> ProgramErrorKind {
        let steps = before.iter().zip(here).map(|(a, b)| (a - b).abs());
        let widest = steps.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        let (joint, jump) = widest.unwrap_or((0, 0.0));
        let [from, to] = [at - 1, at].map(|at| &self.points[at].base_from_tool);
        ProgramErrorKind::Jump {
            path_point: at,
            joint: self.solver.robot().chain.joints[joint].name.clone(),
            jump_deg: jump.to_degrees(),
            largest_deg: self.options.largest_step.to_degrees(),
            turn_deg: from.rotation.angle_to(&to.rotation).to_degrees(),
        }
    }
}
