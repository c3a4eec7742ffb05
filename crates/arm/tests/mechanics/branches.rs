//! All branches of the inverse kinematics, and paths that stay on one.

use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::{
    ArmBranch, ArmErrorKind, BranchOptions, FrameId, Limits, OpwGeometry, PathOptions, Robot,
    Shoulder, tool_pose,
};

use super::ortho_parallel::{HP20, IRB6600, OFFSET, apart, spread};

/// Distance of poses: metres and radians together.
fn off(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    let turned = (a.rotation * b.rotation.inverse()).scaled_axis().norm();
    (a.translation.vector - b.translation.vector).norm() + turned
}

/// 10 000 poses of two robots: every posture found puts the tool there to 1e-9, and the postures
/// are those of the printed formulas, all of them and no others. Near singularities joint values
/// lose digits; FK does not.
#[test]
fn verify_all_branches_of_two_robots() {
    for opw in [IRB6600, HP20] {
        let robot = opw.robot(0.0);
        let solver = robot.ik_solver(&BranchOptions::default());
        assert!(solver.geometry().is_some());
        let mut counts = [0_usize; 9];
        for q in spread(10_000) {
            let flange = robot.world_from_frame(&q, FrameId::Flange);
            let found = solver.branches(&flange, FrameId::Flange);
            for posture in &found {
                let pose = robot.world_from_frame(posture, FrameId::Flange);
                assert!(off(&pose, &flange) <= 1e-9, "{posture:?}");
            }
            let matrix = flange.rotation.to_rotation_matrix();
            let printed = opw.printed_inverse(&flange.translation.vector, matrix.matrix());
            assert_eq!(found.len(), printed.len(), "{q:?}");
            let digits = 1e-6;
            for expected in printed.iter().chain([&q]) {
                assert!(
                    found.iter().any(|f| apart(f, expected) <= digits),
                    "{expected:?} is missing"
                );
            }
            counts[found.len()] += 1;
        }
        assert_eq!(counts[4] + counts[8], 10_000, "{counts:?}");
        assert!(counts[4] > 1000 && counts[8] > 1000, "{counts:?}");
    }
}

/// Limits in degrees that a file gives as radians: five joints have 111 turns each, more postures
/// than any memory holds. Those with the fewest turns are given, the posture asked for among them;
/// of a joint that is two turns or three off in any case, those.
#[test]
fn limits_of_hundreds_of_turns_give_few_postures() {
    let mut robot = HP20.robot(0.0);
    for (index, joint) in robot.chain.joints.iter_mut().enumerate() {
        joint.limits = Some(Limits {
            lower: if index == 0 { 13.0 } else { -349.0 },
            upper: if index == 0 { 20.0 } else { 349.0 },
            velocity: f64::INFINITY,
            effort: f64::INFINITY,
        });
    }
    let solver = robot.ik_solver(&BranchOptions::default());
    for mut q in spread(20) {
        q[0] += std::f64::consts::TAU * ((13.0 - q[0]) / std::f64::consts::TAU).ceil();
        let flange = robot.world_from_frame(&q, FrameId::Flange);
        let found = solver.branches(&flange, FrameId::Flange);
        assert!(found.len() <= 8 * 1024, "{}", found.len());
        assert!(found.iter().any(|f| apart(f, &q) <= 1e-6), "{q:?}");
    }
}

/// Frames of the file have no part in it: the same axes under other joint frames and on a tilted
/// base are the same arm.
#[test]
fn verify_geometry_is_read_off_the_axes() {
    for opw in [IRB6600, HP20, OFFSET] {
        for shift in [0.0, 1.0, -0.6] {
            let robot = opw.robot(shift);
            let geometry = OpwGeometry::of(&robot).expect("ortho-parallel");
            let [a1, a2, b, _, c2, c3, _] = opw.lengths_m;
            let found = [geometry.a1_m, geometry.a2_m, geometry.c2_m, geometry.c3_m];
            for (found, expected) in found.iter().zip([a1, a2, c2, c3]) {
                assert!((found - expected).abs() < 1e-12, "{geometry:?}");
            }
            assert!((geometry.b_m - b).abs() < 1e-12);
            let solver = robot.ik_solver(&BranchOptions::default());
            for q in spread(300) {
                let tool = robot.world_from_frame(&q, FrameId::Tool);
                let found = solver.branches(&tool, FrameId::Tool);
                assert!(found.iter().any(|f| apart(f, &q) <= 1e-6), "{q:?}");
                for posture in &found {
                    let pose = robot.world_from_frame(posture, FrameId::Tool);
                    assert!(off(&pose, &tool) <= 1e-9);
                }
                let mut kinds: Vec<ArmBranch> = found.iter().map(|f| geometry.branch(f)).collect();
                kinds.sort();
                kinds.dedup();
                assert_eq!(kinds.len(), found.len(), "branches have distinct names");
            }
        }
    }
}

fn asset(name: &str) -> Robot {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    Robot::load(&root.join(name).join("robot.urdf"), None, None).expect("the asset loads")
}

fn radians(degrees: [f64; 6]) -> [f64; 6] {
    degrees.map(f64::to_radians)
}

/// `docs/physics/arm.md`, Kinematics: at the posture of Dong et al. the four rear branches are out
/// of reach, two of the others keep the limits, and joints 4 and 6 of each have whole turns to
/// spare.
#[test]
fn verify_branches_and_whole_turns_of_the_default_posture() {
    let robot = asset("irb6600_175_255");
    let solver = robot.ik_solver(&BranchOptions::default());
    let q = radians([-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]);
    let flange = robot.world_from_frame(&q, FrameId::Flange);
    let branches = solver.branches(&flange, FrameId::Flange);
    let geometry = solver.geometry().expect("ortho-parallel");
    assert_eq!(branches.len(), 4);
    assert!(
        branches
            .iter()
            .all(|b| geometry.branch(b).shoulder == Shoulder::Front)
    );

    let within = solver.within_limits(&flange, FrameId::Flange);
    assert!(within.iter().all(|p| robot.check_posture(p).is_ok()));
    let contains = |degrees: [f64; 6]| {
        let expected = radians(degrees);
        within
            .iter()
            .any(|p| p.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9))
    };
    assert!(contains([-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]));
    assert!(contains([-48.38, 54.82, 6.86, -125.84, -107.43, 158.05]));
    assert!(contains([-48.38, 54.82, 6.86, 234.16, -107.43, 158.05]));
    assert!(contains([-48.38, 54.82, 6.86, 234.16, -107.43, -201.95]));
    assert!(contains([-48.38, 54.82, 6.86, -125.84, -107.43, -201.95]));
    // First branch: J4 = 54.16 or -305.84 (out), J6 = -21.95 only; second: two places each for J4
    // and J6.
    assert_eq!(within.len(), 1 + 4, "{within:?}");
}

/// An arm without a spherical wrist: solutions by search are solutions, and the posture that made
/// the pose is among them.
#[test]
fn verify_numeric_search_finds_the_posture_of_an_arm_without_closed_form() {
    let robot = asset("ur10e");
    let solver = robot.ik_solver(&BranchOptions::default());
    assert!(solver.geometry().is_none());
    let mut most = 0;
    for q in spread(12) {
        let flange = robot.world_from_frame(&q, FrameId::Flange);
        let found = solver.branches(&flange, FrameId::Flange);
        assert!(found.iter().any(|f| apart(f, &q) < 1e-6), "{q:?}");
        for posture in &found {
            let pose = robot.world_from_frame(posture, FrameId::Flange);
            assert!(off(&pose, &flange) <= 1e-9);
        }
        most = most.max(found.len());
    }
    assert!((4..=8).contains(&most), "{most}");
}

/// Shortest travel: the wrist stays on its side, and a joint that has turned further than half a
/// turn is met there.
#[test]
fn verify_nearest_posture_keeps_branch_and_turn() {
    let robot = asset("irb6600_175_255");
    let solver = robot.ik_solver(&BranchOptions::default());
    for start in [
        radians([-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]),
        radians([-48.38, 54.82, 6.86, 234.16, -107.43, -201.95]),
    ] {
        let mut goal = robot.world_from_frame(&start, FrameId::Tool);
        goal.translation.vector.z += 0.01;
        let found = solver
            .nearest(&goal, FrameId::Tool, &start)
            .expect("within reach");
        let farthest = found.iter().zip(start).map(|(a, b)| (a - b).abs());
        assert!(farthest.fold(0.0, f64::max) < 0.05, "{found:?}");
        let pose = robot.world_from_frame(&found, FrameId::Tool);
        assert!(off(&pose, &goal) <= 1e-9);
    }
}

/// The milling arm's circle of redundancy angles, tool down: one continuous path on the front
/// shoulder.
fn milling_arm() -> Robot {
    let mut robot = asset("irb6600_175_255");
    let axes = Matrix3::from_columns(&[-Vector3::z(), Vector3::y(), Vector3::x()]);
    let rotation = Rotation3::from_matrix_unchecked(axes);
    robot.frames.flange_from_tool = Isometry3::from_parts(
        Translation3::new(0.25, 0.0, 0.18),
        UnitQuaternion::from_rotation_matrix(&rotation),
    );
    robot
}

fn tool_down(angle_deg: f64) -> Isometry3<f64> {
    let point = Vector3::new(1.05, -1.45, 0.87);
    let down = -Vector3::z_axis();
    tool_pose(&point, &down, &Vector3::x(), angle_deg.to_radians()).expect("square")
}

#[test]
fn verify_redundancy_angle_turns_the_tool_about_its_axis() {
    for angle_deg in [0.0, 20.0, 137.0, 240.0] {
        let (s, c) = f64::to_radians(angle_deg).sin_cos();
        let expected = Matrix3::new(c, s, 0.0, s, -c, 0.0, 0.0, 0.0, -1.0);
        let found = tool_down(angle_deg).rotation.to_rotation_matrix();
        assert!((found.matrix() - expected).amax() < 1e-15);
    }
    let error = tool_pose(&Vector3::zeros(), &Vector3::z_axis(), &Vector3::z(), 0.0);
    assert!(
        error
            .expect_err("parallel")
            .to_string()
            .contains("zero direction")
    );
}

#[test]
fn verify_path_over_the_redundancy_angle_stays_on_its_branch() {
    let robot = milling_arm();
    let solver = robot.ik_solver(&BranchOptions::default());
    let geometry = *solver.geometry().expect("ortho-parallel");
    let poses: Vec<_> = (0..=100).map(|i| tool_down(20.0 + f64::from(i))).collect();
    let mut followed = 0;
    for start in solver.within_limits(&poses[0], FrameId::Tool) {
        let found = solver.follow(&poses, FrameId::Tool, &start, &PathOptions::default());
        let Ok(path) = found else { continue };
        followed += 1;
        assert_eq!(path.len(), poses.len());
        let branch = geometry.branch(&path[0]);
        for (posture, pose) in path.iter().zip(&poses) {
            assert_eq!(geometry.branch(posture), branch);
            assert!(robot.check_posture(posture).is_ok());
            assert!(off(&robot.world_from_frame(posture, FrameId::Tool), pose) <= 1e-9);
        }
    }
    assert!(followed > 0, "some branch leads over the whole path");
}

#[test]
fn paths_that_cannot_be_followed_say_where_and_why() {
    let robot = milling_arm();
    let solver = robot.ik_solver(&BranchOptions::default());
    let poses: Vec<_> = (0..40)
        .map(|i| {
            let mut pose = tool_down(60.0);
            pose.translation.vector.x += 0.05 * f64::from(i);
            pose
        })
        .collect();
    let options = PathOptions { largest_step: 0.5 };
    let index_of = |start: &Vec<f64>| {
        let error = solver
            .follow(&poses, FrameId::Tool, start, &options)
            .expect_err("leaves the reach");
        match error.kind() {
            ArmErrorKind::OnPath { index, .. } => (*index, true),
            ArmErrorKind::PathBreaks { index, .. } => (*index, false),
            _ => panic!("{error}"),
        }
    };
    let starts = solver.within_limits(&poses[0], FrameId::Tool);
    let furthest = starts.iter().map(index_of).max().expect("a start");
    assert!((5..39).contains(&furthest.0) && furthest.1, "{furthest:?}");
    let far = Isometry3::translation(9.0, 0.0, 1.0);
    let error = solver
        .nearest(&far, FrameId::Tool, &[0.0; 6])
        .expect_err("9 m away");
    assert!(error.to_string().contains("out of reach at (9, 0, 1) m"));
    // Poses too far apart for one branch.
    let jump = [tool_down(20.0), tool_down(60.0)];
    let start = solver.within_limits(&jump[0], FrameId::Tool)[0].clone();
    let error = solver
        .follow(&jump, FrameId::Tool, &start, &PathOptions::default())
        .expect_err("a jump");
    assert!(matches!(
        error.kind(),
        ArmErrorKind::PathBreaks { index: 1, .. }
    ));
}

#[test]
fn a_pose_that_only_limits_exclude_says_which() {
    let mut robot = asset("irb6600_175_255");
    let q = radians([-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]);
    let flange = robot.world_from_frame(&q, FrameId::Flange);
    robot.chain.joints[0].limits = Some(Limits {
        lower: -0.5,
        upper: 0.5,
        velocity: 1.0,
        effort: 0.0,
    });
    let error = robot
        .ik_solver(&BranchOptions::default())
        .nearest(&flange, FrameId::Flange, &q)
        .expect_err("joint 1 is held");
    let message = error.to_string();
    assert!(
        message.contains("4 postures") && message.contains("\"joint_1\""),
        "{message}"
    );
}

/// Distances from singularities: a straight wrist, a stretched elbow, a wrist centre above axis 1.
#[test]
fn verify_singularity_distances() {
    let robot = IRB6600.robot(0.0);
    let geometry = OpwGeometry::of(&robot).expect("ortho-parallel");
    let at = |q: [f64; 6]| geometry.singularity_distance(&q);
    assert!((at([0.3, 0.2, 0.1, 0.4, 0.25, 1.0]).wrist_rad - 0.25).abs() < 1e-12);
    assert!(at([0.3, 0.2, 0.1, 0.4, 0.0, 1.0]).wrist_rad < 1e-12);
    let psi = f64::atan2(-0.2, 1.142);
    let stretched = at([0.3, 0.2, -FRAC_PI_2 - psi, 0.4, 1.0, 1.0]);
    assert!(stretched.elbow_rad < 1e-12, "{stretched:?}");
    // Each singularity takes away rank from the Jacobian, and nothing else does.
    let rank = |q: [f64; 6]| {
        let jacobian = robot.jacobian(&q, FrameId::Flange);
        let jacobian = nalgebra::Matrix6::from_fn(|r, c| jacobian[(r, c)]);
        jacobian.singular_values().min()
    };
    assert!(rank([0.3, 0.2, 0.1, 0.4, 0.0, 1.0]) < 1e-12);
    assert!(rank([0.3, 0.2, -FRAC_PI_2 - psi, 0.4, 1.0, 1.0]) < 1e-12);
    for q in spread(400) {
        let distance = at(q);
        let near = distance
            .wrist_rad
            .min(distance.elbow_rad)
            .min(distance.shoulder_m);
        assert!(rank(q) > 0.01 * near, "{q:?}: {distance:?}");
    }
}

/// At the singularities themselves a posture is still found, and puts the flange there to 1e-9.
#[test]
fn verify_singular_poses_are_reached() {
    let psi = f64::atan2(-0.2, 1.142);
    for opw in [IRB6600, HP20] {
        let robot = opw.robot(0.0);
        let solver = robot.ik_solver(&BranchOptions::default());
        for q in spread(300) {
            let mut straight_wrist = q;
            straight_wrist[4] = 0.0;
            let mut folded_wrist = q;
            folded_wrist[4] = 1e-7;
            let mut stretched = q;
            stretched[2] = -FRAC_PI_2 - psi;
            for posture in [straight_wrist, folded_wrist, stretched] {
                let flange = robot.world_from_frame(&posture, FrameId::Flange);
                let found = solver.branches(&flange, FrameId::Flange);
                assert!(!found.is_empty(), "{posture:?}");
                for other in &found {
                    let pose = robot.world_from_frame(other, FrameId::Flange);
                    assert!(off(&pose, &flange) <= 1e-9, "{posture:?} {other:?}");
                }
            }
        }
    }
}
