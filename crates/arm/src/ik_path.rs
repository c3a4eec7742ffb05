//! Joint paths that stay on one branch.

use nalgebra::Isometry3;

use crate::error::{ArmError, ArmErrorKind};
use crate::ik::IkOptions;
use crate::ik_branches::IkSolver;
use crate::model::FrameId;

/// When a joint path counts as continuous.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathOptions {
    /// Largest motion of one joint (rad or m) from one pose to the next.
    pub largest_step: f64,
}

impl Default for PathOptions {
    /// A tenth of a radian: poses of a path must be close enough for that.
    fn default() -> Self {
        Self { largest_step: 0.1 }
    }
}

impl IkSolver<'_> {
    /// Postures along a path of poses, each the nearest to the one before, from a start posture
    /// that need not be on it. Of an arm with joints to spare each comes of the one before by steps
    /// of least length, in which joints slow down before their limits; from a start at the first
    /// pose, or a tenth of a radian from it, it goes on so, too.
    ///
    /// # Errors
    /// At the first pose that is out of reach or limits, or to which a joint would have to jump:
    /// the arm would change its branch there.
    pub fn follow(
        &self,
        poses: &[Isometry3<f64>],
        frame: FrameId,
        start: &[f64],
        options: &PathOptions,
    ) -> Result<Vec<Vec<f64>>, ArmError> {
        self.robot().check_length(start)?;
        if let Some(path) = self.with_slides_still(poses, frame, start, options) {
            return Ok(path);
        }
        let mut path: Vec<Vec<f64>> = Vec::with_capacity(poses.len());
        for (index, pose) in poses.iter().enumerate() {
            let before = path.last().map_or(start, Vec::as_slice);
            let next = match self.continued(pose, frame, before, options) {
                Some(next) => next,
                None => self
                    .nearest_kind(pose, frame, before)
                    .map_err(|kind| on_path(index, kind))?,
            };
            if index > 0 {
                self.check_step(index, before, &next, options)?;
            }
            path.push(next);
        }
        Ok(path)
    }

    /// The same of an arm with more joints than a pose asks for, with its slides where the start
    /// has them; `None` if there are none to spare, or the arm cannot follow so. A step of least
    /// length would weigh metres against radians.
    fn with_slides_still(
        &self,
        poses: &[Isometry3<f64>],
        frame: FrameId,
        start: &[f64],
        options: &PathOptions,
    ) -> Option<Vec<Vec<f64>>> {
        let robot = self.robot();
        let slides: Vec<usize> = robot.slides().collect();
        if slides.is_empty() || robot.dof() < slides.len() + 6 {
            return None;
        }
        let places: Vec<f64> = slides.iter().map(|&at| start[at]).collect();
        let held = robot.with_slides_at(&places).ok()?;
        let is_slide = |at: &usize| slides.contains(at);
        let turning: Vec<usize> = (0..robot.dof()).filter(|at| !is_slide(at)).collect();
        let rest: Vec<f64> = turning.iter().map(|&at| start[at]).collect();
        let solver = held.ik_solver(self.options());
        let path = solver.follow(poses, frame, &rest, options).ok()?;
        let whole = path.iter().map(|found| {
            let mut q = start.to_vec();
            turning
                .iter()
                .zip(found)
                .for_each(|(&at, value)| q[at] = *value);
            q
        });
        Some(whole.collect())
    }

    /// Where branches are found by a search over the joints' ranges only, the posture to which the
    /// one before leads without a jump. That goes for the start, too: the search may not find it
    /// again, and of a continuum of postures it has samples.
    fn continued(
        &self,
        pose: &Isometry3<f64>,
        frame: FrameId,
        before: &[f64],
        options: &PathOptions,
    ) -> Option<Vec<f64>> {
        if self.geometry().is_some() {
            return None;
        }
        let robot = self.robot();
        let is_near = |found: &Vec<f64>| {
            let steps = found.iter().zip(before).map(|(a, b)| (a - b).abs());
            steps.fold(0.0, f64::max) <= options.largest_step
        };
        if robot.has_joints_to_spare()
            && let Some(found) = robot.least_change(pose, frame, before).filter(is_near)
        {
            return Some(found);
        }
        let numeric = IkOptions::default();
        let found = robot.inverse_kinematics(pose, frame, before, &numeric);
        found.ok().filter(is_near)
    }

    fn check_step(
        &self,
        index: usize,
        before: &[f64],
        next: &[f64],
        options: &PathOptions,
    ) -> Result<(), ArmError> {
        let joints = self.robot().chain.joints.iter();
        let steps = joints
            .zip(before.iter().zip(next))
            .map(|(j, (a, b))| (j, (a - b).abs()));
        let largest = steps.max_by(|a, b| a.1.total_cmp(&b.1));
        match largest {
            Some((joint, jump)) if jump > options.largest_step => Err(ArmErrorKind::PathBreaks {
                index,
                joint: joint.name.clone(),
                jump,
                limit: options.largest_step,
                unit: joint.kind.coordinate_unit(),
            }
            .into()),
            _ => Ok(()),
        }
    }
}

fn on_path(index: usize, kind: ArmErrorKind) -> ArmError {
    ArmErrorKind::OnPath {
        index,
        source: Box::new(kind),
    }
    .into()
}
