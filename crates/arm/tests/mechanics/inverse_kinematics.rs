//! Inverse kinematics near a seed.

use std::path::Path;

use nalgebra::{Translation3, Vector3};
use proptest::prelude::*;
use truecut_arm::{ArmErrorKind, FrameId, IkOptions, Robot};

fn irb6600() -> Robot {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    Robot::load(&root.join("irb6600_175_255/robot.urdf"), None, None).expect("the asset loads")
}

fn radians(degrees: [f64; 6]) -> [f64; 6] {
    degrees.map(f64::to_radians)
}

/// Postures well inside the limits and away from the singular wrist and elbow.
fn posture() -> impl Strategy<Value = [f64; 6]> {
    let ranges = (
        [-100.0, 0.0, -20.0, -150.0, 30.0, -150.0],
        [100.0, 50.0, 30.0, 150.0, 100.0, 150.0],
    );
    prop::array::uniform6(0.0..1.0_f64).prop_map(move |share| {
        radians(std::array::from_fn(|i| {
            ranges.0[i] + share[i] * (ranges.1[i] - ranges.0[i])
        }))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// From a seed a few degrees off, the posture that made the pose is found again.
    #[test]
    fn verify_inverse_of_forward_kinematics(q in posture(), off in prop::array::uniform6(-0.06..0.06_f64)) {
        let robot = irb6600();
        for frame in [FrameId::Flange, FrameId::Tool] {
            let target = robot.world_from_frame(&q, frame);
            let seed: Vec<f64> = q.iter().zip(off).map(|(q, d)| q + d).collect();
            let found = robot.inverse_kinematics(&target, frame, &seed, &IkOptions::default())
                .map_err(|e| TestCaseError::fail(e.to_string()))?;
            for (found, q) in found.iter().zip(q) {
                prop_assert!((found - q).abs() <= 1e-8);
            }
        }
    }
}

/// The published second wrist branch of the default posture puts the flange at the same pose.
#[test]
fn verify_wrist_branches_share_a_pose() {
    let robot = irb6600();
    let first = radians([-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]);
    let second = radians([-48.38, 54.82, 6.86, -125.84, -107.43, 158.05]);
    let target = robot.world_from_frame(&first, FrameId::Flange);
    let pose = robot.world_from_frame(&second, FrameId::Flange);
    assert!((pose.translation.vector - target.translation.vector).amax() <= 1e-12);
    assert!(pose.rotation.angle_to(&target.rotation) <= 1e-7);
    // And from a seed nearby, that branch is found, not the first.
    let seed = second.map(|q| q + 0.02);
    let found = robot
        .inverse_kinematics(&target, FrameId::Flange, &seed, &IkOptions::default())
        .expect("reached");
    assert!(
        found.iter().zip(second).all(|(a, b)| (a - b).abs() <= 1e-8),
        "{found:?}"
    );
}

#[test]
fn whole_turns_are_taken_back_into_the_limits() {
    let robot = irb6600();
    let q = radians([-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]);
    let mut seed = q;
    seed[5] += std::f64::consts::TAU;
    let target = robot.world_from_frame(&q, FrameId::Tool);
    let found = robot
        .inverse_kinematics(&target, FrameId::Tool, &seed, &IkOptions::default())
        .expect("within limits after a turn back");
    assert!((found[5] - q[5]).abs() <= 1e-8, "{}", found[5]);
}

#[test]
fn a_pose_out_of_reach_is_refused_with_what_is_left() {
    let robot = irb6600();
    let seed = radians([0.0, 30.0, 0.0, 10.0, 40.0, 0.0]);
    let mut target = robot.world_from_frame(&seed, FrameId::Tool);
    target.translation = Translation3::from(Vector3::new(9.0, 0.0, 1.0));
    let error = robot
        .inverse_kinematics(&target, FrameId::Tool, &seed, &IkOptions::default())
        .expect_err("9 m away");
    let ArmErrorKind::Unreachable { position_m, .. } = error.kind() else {
        panic!("{error}");
    };
    assert!(*position_m > 5.0, "{position_m}");
}

#[test]
fn a_solution_outside_the_limits_is_refused() {
    let robot = irb6600();
    let mut q = radians([0.0, 30.0, 0.0, 10.0, 40.0, 0.0]);
    q[1] = 85_f64.to_radians();
    let target = robot.world_from_frame(&q, FrameId::Tool);
    let error = robot
        .inverse_kinematics(&target, FrameId::Tool, &q, &IkOptions::default())
        .expect_err("axis 2 ends at 80 degrees");
    let message = error.to_string();
    assert!(
        message.contains("\"joint_2\"") && message.contains("outside the limits"),
        "{message}"
    );
}

#[test]
fn postures_are_checked() {
    let robot = irb6600();
    let short = robot
        .check_posture(&[0.0; 5])
        .expect_err("one short")
        .to_string();
    assert_eq!(short, "the posture has 5 values; the chain has 6 joints");
    let nan = robot
        .check_posture(&[0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0])
        .expect_err("NaN")
        .to_string();
    assert!(
        nan.contains("\"joint_2\"") && nan.contains("not a finite number"),
        "{nan}"
    );
    let far = robot
        .check_posture(&[0.0, 0.0, 0.0, 0.0, 2.2, 0.0])
        .expect_err("2.2 rad")
        .to_string();
    assert!(
        far.starts_with(
            "joint \"joint_5\": 126.0507 deg is outside the limits -120 deg to 120 deg ("
        ),
        "{far}"
    );
}
