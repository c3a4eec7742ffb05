//! Arms with more joints than a pose asks for: continuous along lines and across stops, within
//! limits, and as near to a posture as they come with the tool at rest.

use nalgebra::{Isometry3, Vector3};
use truecut_arm::{BranchOptions, FrameId, IkSolver, PathOptions};

use crate::seven_axes::{
    CORNERS_M, Draws, SEEDS, distance, drawn, jacobian, least_singular_value, off,
};

/// Way between two poses, m.
const STEP_M: f64 = 1e-3;
/// Of [`DEG`]: what joints keep from limits where they are free to, and a hair.
const CLEAR_RAD: f64 = 0.5 * DEG;
const DEG: f64 = std::f64::consts::PI / 180.0;

/// The poses of each line, its two ends with them.
fn lines(from: &Isometry3<f64>) -> Vec<Vec<Isometry3<f64>>> {
    let line = |ends: &[[f64; 3]]| {
        let [a, b] = [0, 1].map(|k| Vector3::from(ends[k]));
        let count = ((b - a).norm() / STEP_M).round() as usize;
        let pose = |k: usize| {
            let way = a + (b - a) * (k as f64 / count as f64);
            from * Isometry3::translation(way.x, way.y, way.z)
        };
        (0..=count).map(pose).collect()
    };
    CORNERS_M.windows(2).map(line).collect()
}

/// Line by line as an arm is led that stops at each corner: every line from the end of the one
/// before. Its largest step, as a share of the step that the slowest direction of the tool asks
/// for: with the Jacobian's least singular value s no step of least length is above way over s.
fn led(solver: &IkSolver<'_>, start: &[f64]) -> (Vec<Vec<f64>>, f64) {
    let robot = solver.robot();
    let from = robot.world_from_frame(start, FrameId::Tool);
    let mut path = vec![start.to_vec()];
    let mut largest = 0.0_f64;
    for poses in lines(&from) {
        let begun = path[path.len() - 1].clone();
        let line = solver.follow(&poses, FrameId::Tool, &begun, &PathOptions::default());
        let line = line.expect("the line can be followed");
        assert!(distance(&line[0], &begun) < 1e-8, "a jump at a stop");
        for (q, pose) in line.iter().zip(&poses) {
            let reached = robot.world_from_frame(q, FrameId::Tool);
            assert!(off(&reached, pose) < 1e-9, "{q:?}");
            assert!(robot.check_posture(q).is_ok(), "{q:?}");
        }
        for pair in line.windows(2) {
            let step = distance(&pair[0], &pair[1]);
            largest = largest.max(step * least_singular_value(robot, &pair[1]) / STEP_M);
        }
        path.extend(line.into_iter().skip(1));
    }
    (path, largest)
}

/// The way that a joint goes furthest from where it began.
fn furthest(path: &[Vec<f64>], joint: usize) -> f64 {
    let each = path.iter().map(|q| q[joint] - path[0][joint]);
    each.fold(
        0.0,
        |far: f64, by| if by.abs() > far.abs() { by } else { far },
    )
}

#[test]
fn verify_joints_to_spare_go_on_across_stops_by_least_steps() {
    for seed in SEEDS {
        let (robot, start) = drawn(seed);
        assert!(robot.has_joints_to_spare());
        let solver = robot.ik_solver(&BranchOptions::default());
        let (path, largest) = led(&solver, &start);
        assert!(path.len() > 150 && largest < 1.02, "seed {seed}: {largest}");
    }
}

/// The first joint is let go half as far as it would: the others take over before it is there, and
/// none steps.
#[test]
fn verify_joints_to_spare_slow_down_before_a_limit() {
    for seed in SEEDS {
        let (mut robot, start) = drawn(seed);
        let free = led(&robot.ik_solver(&BranchOptions::default()), &start).0;
        let half = 0.5 * furthest(&free, 0);
        let limits = robot.chain.joints[0].limits.as_mut().expect("limits");
        let at = start[0] + half + half.signum() * CLEAR_RAD;
        match half > 0.0 {
            true => limits.upper = at,
            false => limits.lower = at,
        }
        let (held, largest) = led(&robot.ik_solver(&BranchOptions::default()), &start);
        assert!(largest < 5.0, "seed {seed}: {largest}");
        assert!(furthest(&held, 0).abs() < furthest(&free, 0).abs() - 1e-3);
    }
}

/// What is left of the way to the other posture has no share that moves the tool's arm at rest.
#[test]
fn verify_nearest_posture_of_an_arm_with_joints_to_spare() {
    for seed in SEEDS {
        let (robot, start) = drawn(seed);
        let pose = robot.world_from_frame(&start, FrameId::Tool);
        let mut draws = Draws(seed + 100);
        let other: Vec<f64> = start.iter().map(|q| q + draws.within(0.3)).collect();
        let solver = robot.ik_solver(&BranchOptions::default());
        let found = solver
            .nearest(&pose, FrameId::Tool, &other)
            .expect("in reach");
        assert!(off(&robot.world_from_frame(&found, FrameId::Tool), &pose) < 1e-9);
        assert!(distance(&found, &other) < distance(&start, &other) + 1e-9);
        let square = jacobian(&robot, &found).tr_mul(&jacobian(&robot, &found));
        let eigen = square.symmetric_eigen();
        let least = eigen.eigenvalues.imin();
        let free = eigen.eigenvectors.column(least);
        let left = (free.iter().zip(&found).zip(&other)).map(|((free, a), b)| free * (b - a));
        let left: f64 = left.sum();
        assert!(left.abs() < 1e-3, "seed {seed}: {left}");
        // The samples of a search are no nearer.
        let samples = solver.within_limits(&pose, FrameId::Tool);
        let nearest = samples.iter().map(|q| distance(q, &other));
        assert!(distance(&found, &other) < nearest.fold(f64::INFINITY, f64::min) + 1e-6);
    }
}

/// A joint that may not be where it stands: the arm gets it within its limits with the tool at
/// rest.
#[test]
fn joints_to_spare_bring_an_arm_within_its_limits() {
    for seed in SEEDS {
        let (mut robot, start) = drawn(seed);
        let pose = robot.world_from_frame(&start, FrameId::Tool);
        let limits = robot.chain.joints[2].limits.as_mut().expect("limits");
        (limits.lower, limits.upper) = (start[2] + 0.35, start[2] + 0.9);
        let solver = robot.ik_solver(&BranchOptions::default());
        let found = solver
            .nearest(&pose, FrameId::Tool, &start)
            .expect("within limits");
        assert!(
            robot.check_posture(&found).is_ok(),
            "seed {seed}: {found:?}"
        );
        assert!(off(&robot.world_from_frame(&found, FrameId::Tool), &pose) < 1e-9);
    }
}

/// Found again from the same start, to the last bit.
#[test]
fn joints_to_spare_move_the_same_every_time() {
    let (robot, start) = drawn(SEEDS[0]);
    let once = led(&robot.ik_solver(&BranchOptions::default()), &start);
    let again = led(&robot.ik_solver(&BranchOptions::default()), &start);
    assert_eq!(once, again);
}
