//! Where a path from CAM begins: branch and whole turns of its first posture.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use truecut_arm::{BranchOptions, Elbow, FrameId, PathOptions, Robot, Shoulder};
use truecut_plan::SingularityLimits;
use truecut_plan::cam::{Attitude, CamPath, CamPoint};
use truecut_plan::program::{FindingKind, Program, ProgramError, ReplayOptions, Start};

use crate::assets;
use crate::cam_run;

/// The arms of the tree, and one with the ranges of a published GP25: of six joints three may turn
/// by more than a whole turn, and middles lie off zero.
fn arm(which: usize) -> Robot {
    let mut robot = assets::robot(["hp20", "irb6600_175_255", "hp20"][which]);
    if which == 2 {
        let ranges = [
            [-180.0, 180.0],
            [-105.0, 155.0],
            [-86.0, 160.0],
            [-200.0, 200.0],
            [-155.0, 150.0],
            [-455.0, 455.0],
        ];
        for (joint, range) in robot.chain.joints.iter_mut().zip(ranges) {
            let limits = joint.limits.as_mut().expect("a rotary joint with limits");
            [limits.lower, limits.upper] = range.map(f64::to_radians);
        }
    }
    robot
}

fn followed(
    robot: &Robot,
    poses: &[Isometry3<f64>],
    start: Start<'_>,
) -> Result<Program, ProgramError> {
    let point = |(i, pose): (usize, &Isometry3<f64>)| CamPoint {
        line: i + 2,
        place_m: pose.translation.vector,
        attitude: Attitude::Whole(pose.rotation),
        feed_m_per_s: Some(0.02),
        stops: false,
    };
    let path = CamPath {
        points: poses.iter().enumerate().map(point).collect(),
        ..CamPath::default()
    };
    let file = Path::new("poses.csv");
    cam_run::follow(start, robot, &path, file, Isometry3::identity())
}

/// A posture by shares of the joints' ranges, and lines from there: the tool moves by centimetres
/// and turns about its own axis, one way, so that joint 6 winds.
fn drawn_path(
    robot: &Robot,
    shares: &[f64],
    steps: &[[f64; 5]],
    winding: f64,
) -> Vec<Isometry3<f64>> {
    let joints = robot.chain.joints.iter().zip(shares);
    let posture: Vec<f64> = joints
        .map(|(joint, share)| {
            let limits = joint.limits.expect("limits");
            limits.lower + share * (limits.upper - limits.lower)
        })
        .collect();
    let mut pose = robot.world_from_frame(&posture, FrameId::Tool);
    let mut poses = vec![pose];
    for step in steps {
        let way = Translation3::new(step[0], step[1], step[2]);
        let tilt = UnitQuaternion::from_euler_angles(2.0 * step[3], 2.0 * step[4], winding);
        pose = Isometry3::from_parts(way * pose.translation, pose.rotation * tilt);
        poses.push(pose);
    }
    poses
}

/// The path from place to place, and which of these are its points.
fn finely(poses: &[Isometry3<f64>]) -> (Vec<Isometry3<f64>>, Vec<usize>) {
    const PARTS: usize = 100;
    let mut fine = vec![poses[0]];
    let mut points = vec![0];
    for pair in poses.windows(2) {
        let place = |k: usize| pair[0].lerp_slerp(&pair[1], k as f64 / PARTS as f64);
        fine.extend((1..=PARTS).map(place));
        points.push(fine.len() - 1);
    }
    (fine, points)
}

/// Whether the arm follows a path from a posture, by the follower of `truecut_arm`: on one branch,
/// within limits, its points clear of singularities.
fn can_follow(robot: &Robot, poses: &[Isometry3<f64>], start: &[f64]) -> bool {
    let solver = robot.ik_solver(&BranchOptions::default());
    let (fine, points) = finely(poses);
    let Ok(way) = solver.follow(&fine, FrameId::Tool, start, &PathOptions::default()) else {
        return false;
    };
    // The nearest posture within limits may be another than that of the start.
    let begins_there = way[0].iter().zip(start).all(|(a, b)| (a - b).abs() < 1e-6);
    let geometry = solver.geometry().expect("a closed form");
    let limits = SingularityLimits::default();
    let is_clear = |at: &usize| {
        let distance = geometry.singularity_distance(&way[*at]);
        distance.wrist_rad >= limits.wrist_rad
            && distance.elbow_rad >= limits.elbow_rad
            && distance.shoulder_m >= limits.shoulder_m
    };
    begins_there && points.iter().all(is_clear)
}

/// Squared distances from the middles of the ranges, in halves of them.
fn from_the_middle(robot: &Robot, q: &[f64]) -> f64 {
    let joints = robot.chain.joints.iter().zip(q);
    let each = joints.map(|(joint, q)| {
        let limits = joint.limits.expect("limits");
        let (middle, half) = (limits.lower + limits.upper, limits.upper - limits.lower);
        ((2.0 * q - middle) / half).powi(2)
    });
    each.sum()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// Of all branches and whole turns from which the whole path can be followed, the first posture
    /// is the one nearest to the middle of the ranges; so no joint is turned by 360 deg towards a
    /// limit without need.
    #[test]
    fn the_start_is_the_one_nearest_to_rest_that_can_follow_the_path(
        which in 0..3_usize,
        shares in prop::collection::vec(0.0..1.0, 6),
        steps in prop::collection::vec(prop::array::uniform5(-0.06..0.06), 1..5),
        winding in -1.3..1.3,
        pick in any::<prop::sample::Index>(),
    ) {
        let robot = arm(which);
        let poses = drawn_path(&robot, &shares, &steps, winding);
        let solver = robot.ik_solver(&BranchOptions::default());
        let starts = solver.within_limits(&poses[0], FrameId::Tool);
        let able: Vec<&Vec<f64>> = starts.iter().filter(|q| can_follow(&robot, &poses, q)).collect();
        prop_assume!(!able.is_empty());
        let program = followed(&robot, &poses, Start::AtRest).expect("it can be followed");
        let chosen = &program.moves[0].posture;
        let least = able.iter().map(|q| from_the_middle(&robot, q)).fold(f64::INFINITY, f64::min);
        let found = from_the_middle(&robot, chosen);
        prop_assert!(found <= least + 1e-6, "{found} {least}: {chosen:?}");
        // And it can follow the path: nothing but speed and nearness to a singularity is found.
        let replay = program.replay(&robot, &ReplayOptions::default());
        let grave = replay.findings.iter().filter(|finding| !matches!(
            finding.kind,
            FindingKind::TooFast { .. } | FindingKind::NearSingularity { .. }
        ));
        let grave: Vec<String> = grave.map(ToString::to_string).collect();
        prop_assert!(grave.is_empty(), "{grave:?}");

        // Near to a posture that can follow: that posture.
        let wanted = able[pick.index(able.len())];
        let program = followed(&robot, &poses, Start::Near(wanted)).expect("it can be followed");
        let apart = program.moves[0].posture.iter().zip(wanted).map(|(a, b)| (a - b).abs());
        prop_assert!(apart.fold(0.0, f64::max) < 1e-6);
    }

    /// A tool that points straight down before the arm, turned as one likes: held from the front,
    /// elbow up, the wrist not flipped, joint 6 within half a turn.
    #[test]
    fn a_tool_that_points_down_is_held_from_the_front(which in 0..3_usize, yaw in -PI..PI, drop_m in 0.01..0.05) {
        let robot = arm(which);
        // Beneath the flange of a posture that a programmer would take.
        let usual = [0.0, 0.3, -0.3, 0.0, [-0.97, 0.97, -0.97][which], 0.0];
        let place = robot.world_from_frame(&usual, FrameId::Tool).translation.vector;
        let down = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
        let poses = [0.0, drop_m].map(|down_m| {
            Isometry3::from_parts(Translation3::new(place.x, place.y, place.z - down_m), down)
        });
        let solver = robot.ik_solver(&BranchOptions::default());
        prop_assume!(solver.within_limits(&poses[1], FrameId::Tool).len() > 1);
        let program = followed(&robot, &poses, Start::AtRest).expect("it is reached");
        let q = &program.moves[0].posture;
        let branch = solver.geometry().expect("a closed form").branch(q);
        prop_assert_eq!(branch.shoulder, Shoulder::Front);
        prop_assert_eq!(branch.elbow, Elbow::Upper);
        prop_assert!(q[3].abs() < 0.5 * PI, "{q:?}");
        prop_assert!(q[5].abs() < 0.5 * TAU + 1e-9, "{q:?}");
    }
}
