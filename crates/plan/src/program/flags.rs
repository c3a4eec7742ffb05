//! From a pose and what a file says of the branch back to the posture.

use std::f64::consts::TAU;

use nalgebra::Isometry3;
use truecut_arm::{Elbow, FrameId, IkSolver, OpwGeometry, Robot, Shoulder, Wrist};

use super::error::ProgramErrorKind;

/// By how much a posture may break the flags in all: the printed decimals may carry a joint over a
/// border.
const SLACK_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// Postures that break the flags equally well, to this, are told apart by the moves before and
/// after.
const EVEN_RAD: f64 = 0.01 * std::f64::consts::PI / 180.0;

/// What a file says of the branch: by how much (rad) a posture breaks it.
pub(super) trait Flags: Send + Sync {
    /// Of one joint's turns and quadrants.
    fn joint_excess(&self, joint: usize, q: f64) -> f64;
    /// Of shoulder, elbow and wrist.
    fn branch_excess(&self, geometry: &OpwGeometry, q: &[f64]) -> f64;
    fn text(&self) -> String;
}

/// Finds postures by flags for one robot.
pub(super) struct Resolver<'a> {
    robot: &'a Robot,
    solver: IkSolver<'a>,
    geometry: OpwGeometry,
}

impl<'a> Resolver<'a> {
    pub fn new(robot: &'a Robot) -> Result<Self, ProgramErrorKind> {
        let solver = robot.ik_solver(&truecut_arm::BranchOptions::default());
        let geometry = *solver
            .geometry()
            .ok_or_else(|| ProgramErrorKind::not_ortho_parallel(robot))?;
        Ok(Self {
            robot,
            solver,
            geometry,
        })
    }

    /// Postures that reach a flange pose and break `flags` least, several where they do it equally
    /// well: by how much, and the posture, the one nearest to zero first.
    pub fn postures(
        &self,
        path_point: usize,
        world_from_flange: &Isometry3<f64>,
        flags: &dyn Flags,
    ) -> Result<Vec<(f64, Vec<f64>)>, ProgramErrorKind> {
        let branches = self.solver.branches(world_from_flange, FrameId::Flange);
        let mut rated: Vec<(f64, Vec<f64>)> = Vec::new();
        for branch in &branches {
            let excess = flags.branch_excess(&self.geometry, branch);
            rated.extend(self.turned(branch, excess, flags));
        }
        let least = rated.iter().map(|(excess, _)| *excess);
        let Some(least) = least.min_by(f64::total_cmp) else {
            return Err(ProgramErrorKind::out_of_reach(
                path_point,
                world_from_flange,
            ));
        };
        if least > SLACK_RAD {
            return Err(ProgramErrorKind::NoPostureWithFlags {
                path_point,
                flags: flags.text(),
                excess_deg: least.to_degrees(),
            });
        }
        rated.retain(|(excess, _)| *excess <= least + EVEN_RAD);
        let size = |q: &[f64]| q.iter().map(|q| q * q).sum::<f64>();
        rated.sort_by(|a, b| size(&a.1).total_cmp(&size(&b.1)));
        Ok(rated)
    }

    /// A branch with every joint on every turn that breaks flags and limits by no more than the
    /// slack; if there is none, on the turns that break them least.
    fn turned(&self, branch: &[f64], excess: f64, flags: &dyn Flags) -> Vec<(f64, Vec<f64>)> {
        let mut postures = vec![(excess, Vec::new())];
        for (i, (joint, &value)) in self.robot.chain.joints.iter().zip(branch).enumerate() {
            let mut places: Vec<(f64, f64)> = (-2..=2)
                .map(|turn| {
                    let q = value + TAU * f64::from(turn);
                    let outside = joint
                        .limits
                        .map_or(0.0, |l| (q - l.upper).max(l.lower - q).max(0.0));
                    (flags.joint_excess(i, q) + outside, q)
                })
                .collect();
            places.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.abs().total_cmp(&b.1.abs())));
            let least = places[0].0;
            places.retain(|(excess, _)| *excess <= least.max(SLACK_RAD));
            postures = postures
                .iter()
                .flat_map(|(sum, posture): &(f64, Vec<f64>)| {
                    places.iter().map(move |(excess, q)| {
                        let mut longer = posture.clone();
                        longer.push(*q);
                        (sum + excess, longer)
                    })
                })
                .collect();
        }
        postures
    }
}

/// How far a value (deg) lies outside a set of intervals (deg), rad.
pub(super) fn outside_rad(value_rad: f64, intervals_deg: &[(f64, f64)]) -> f64 {
    let value = value_rad.to_degrees();
    let distances = intervals_deg
        .iter()
        .map(|(low, high)| (low - value).max(value - high).max(0.0));
    distances.fold(f64::INFINITY, f64::min).to_radians()
}

/// How far a posture is from changing to the wanted branch, rad; 0 if it is on it. The shoulder's
/// distance counts 1 m as 1 rad.
pub(super) fn branch_excess(geometry: &OpwGeometry, q: &[f64], wanted: [Option<bool>; 3]) -> f64 {
    let branch = geometry.branch(q);
    let distance = geometry.singularity_distance(q);
    let has = [
        branch.shoulder == Shoulder::Rear,
        branch.elbow == Elbow::Lower,
        branch.wrist == Wrist::Negative,
    ];
    let far = [distance.shoulder_m, distance.elbow_rad, distance.wrist_rad];
    let parts = wanted.iter().zip(has).zip(far);
    parts
        .map(|((wanted, has), far)| match wanted {
            Some(wanted) if *wanted != has => far,
            _ => 0.0,
        })
        .sum()
}
