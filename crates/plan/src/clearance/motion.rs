//! How far bodies can move against each other while joints turn.

use nalgebra::{Isometry3, Point3};
use truecut_arm::{JointKind, Robot};

use super::cell::{Cell, Pair};

impl Cell {
    /// At most so far do points of a pair move against each other from one posture to the next, m,
    /// when all joints go there evenly: each joint between the two bodies turns the second one
    /// about its axis by at most the lever of its furthest point.
    pub(super) fn motion_m(
        &self,
        robot: &Robot,
        pair: &Pair,
        frames: &[Isometry3<f64>],
        [from, to]: [&[f64]; 2],
    ) -> f64 {
        let [a, b] = pair.bodies.map(|index| &self.bodies[index]);
        let (mut moved_m, mut turned_rad) = (0.0, 0.0);
        let joints = robot.chain.moving().enumerate();
        for (index, joint) in joints.take(b.frame).skip(a.frame) {
            let by = (joint.value(to) - joint.value(from)).abs();
            match joint.kind {
                JointKind::Prismatic => moved_m += by,
                JointKind::Revolute => {
                    let frame = &frames[index + 1];
                    let axis = frame * joint.axis.into_inner();
                    let levers = b.pieces.iter().map(|piece| {
                        let centre = frames[b.frame] * Point3::from(piece.centre_m);
                        let arm = centre.coords - frame.translation.vector;
                        axis.cross(&arm).norm() + piece.radius_m
                    });
                    moved_m += by * levers.fold(0.0, f64::max);
                    turned_rad += by;
                }
            }
        }
        // Levers are those at the beginning; each grows at most by what the joints turn, times the
        // levers of that moment.
        moved_m * turned_rad.exp()
    }
}

/// The world and all links that move.
pub(super) fn frames(robot: &Robot, posture: &[f64]) -> Vec<Isometry3<f64>> {
    let links = robot.world_from_links(posture);
    std::iter::once(Isometry3::identity())
        .chain(links)
        .collect()
}
