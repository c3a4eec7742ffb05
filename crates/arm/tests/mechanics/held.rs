//! Slides that stand still: an arm on a track is the same arm, moved.

use std::path::Path;

use nalgebra::Isometry3;
use proptest::prelude::*;
use truecut_arm::{
    ArmErrorKind, BranchOptions, FrameId, Joint, JointKind, Limits, PathOptions, Robot,
    Transmission, standard_gravity_m_s2,
};

use super::random_chain::{axis, case, pose};

fn turning(robot: &Robot) -> Vec<usize> {
    let joints = robot.chain.joints.iter().enumerate();
    let rotary = joints.filter(|(_, joint)| joint.kind == JointKind::Revolute);
    rotary.map(|(at, _)| at).collect()
}

fn take<T: Copy>(all: &[T], which: &[usize]) -> Vec<T> {
    which.iter().map(|&at| all[at]).collect()
}

/// The HP20 on a track of any direction, with room to both sides.
fn on_a_track(pose: Isometry3<f64>, along: nalgebra::Unit<nalgebra::Vector3<f64>>) -> Robot {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/hp20/robot.urdf");
    let mut robot = Robot::load(&file, None, None).expect("the asset loads");
    let track = Joint {
        name: "track".to_owned(),
        kind: JointKind::Prismatic,
        parent_from_joint: pose,
        axis: along,
        limits: Some(Limits {
            lower: -1.0,
            upper: 5.0,
            ..robot.chain.joints[0].limits.expect("limits")
        }),
        transmission: Transmission::default(),
        urdf_damping: 0.0,
        urdf_friction: 0.0,
    };
    let carriage = robot.chain.base.clone();
    robot.chain.joints.insert(0, track);
    robot.chain.links.insert(0, carriage);
    robot
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Poses, masses felt by the joints that are left, and what gravity asks of them are those of
    /// the whole chain with its slides at rest.
    #[test]
    fn verify_an_arm_with_its_slides_held_moves_as_the_whole(case in case()) {
        prop_assume!(case.robot.chain.followers.is_empty());
        let rotary = turning(&case.robot);
        prop_assume!(!rotary.is_empty());
        let slides: Vec<usize> = case.robot.slides().collect();
        let held = case.robot.with_slides_at(&take(&case.q, &slides)).expect("no limits");
        prop_assert_eq!(held.dof(), rotary.len());
        let q = take(&case.q, &rotary);
        for frame in [FrameId::Flange, FrameId::Tool, FrameId::Foot] {
            let whole = case.robot.world_from_frame(&case.q, frame);
            let apart = held.world_from_frame(&q, frame).inverse() * whole;
            prop_assert!(apart.translation.vector.norm() < 1e-12 && apart.rotation.angle() < 1e-7);
        }
        let (own, whole) = (held.mass_matrix(&q), case.robot.mass_matrix(&case.q));
        let scale = whole.amax();
        for (r, &at_r) in rotary.iter().enumerate() {
            for (c, &at_c) in rotary.iter().enumerate() {
                let apart = own[(r, c)] - whole[(at_r, at_c)];
                prop_assert!(apart.abs() < 1e-11 * scale, "{apart}");
            }
        }
        let gravity = truecut_arm::Load::gravity(standard_gravity_m_s2());
        let of = |robot: &Robot, q: &[f64]| robot.holding_command(q, &gravity).expect("stiff");
        let (own, whole) = (of(&held, &q), of(&case.robot, &case.q));
        for (command, expected) in own.iter().zip(take(&whole, &rotary)) {
            prop_assert!((command - expected).abs() < 1e-10, "{command} {expected}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A path is followed with the track where it stands, by the postures of the arm without one.
    #[test]
    fn verify_a_track_stands_still_along_a_path(
        foot in pose(), along in axis(), place_m in -0.9..4.9_f64,
        q in prop::array::uniform6(-0.4..0.4_f64), way in prop::array::uniform3(-0.1..0.1_f64),
    ) {
        let robot = on_a_track(foot, along);
        let mut start = vec![place_m];
        start.extend(q);
        start[5] -= 0.9; // away from the singularity of the wrist
        let from = robot.world_from_frame(&start, FrameId::Tool);
        let step = |k: u32| {
            let mut pose = from;
            pose.translation.vector += nalgebra::Vector3::from(way) * (f64::from(k) / 20.0);
            pose
        };
        let poses: Vec<_> = (0..=20).map(step).collect();
        let held = robot.with_slides_at(&[place_m]).expect("within the limits");
        let options = PathOptions::default();
        let alone = held.ik_solver(&BranchOptions::default());
        let alone = alone.follow(&poses, FrameId::Tool, &start[1..], &options);
        prop_assume!(alone.is_ok());
        let solver = robot.ik_solver(&BranchOptions::default());
        let followed = solver.follow(&poses, FrameId::Tool, &start, &options).expect("a path");
        for ((whole, own), pose) in followed.iter().zip(alone.expect("a path")).zip(&poses) {
            prop_assert_eq!(whole[0], place_m);
            prop_assert_eq!(&whole[1..], &own[..]);
            let reached = robot.world_from_frame(whole, FrameId::Tool);
            let apart = (reached.translation.vector - pose.translation.vector).norm();
            prop_assert!(apart < 1e-9, "{apart} m");
        }
    }
}

#[test]
fn a_slide_beyond_its_travel_or_without_a_place_is_refused() {
    let robot = on_a_track(Isometry3::identity(), nalgebra::Vector3::x_axis());
    let beyond = robot.with_slides_at(&[5.2]).expect_err("5 m are all");
    assert!(
        matches!(beyond.kind(), ArmErrorKind::OutsideLimits { joint, .. } if joint == "track"),
        "{beyond}"
    );
    for places in [&[][..], &[0.0, 0.0]] {
        let error = robot.with_slides_at(places).expect_err("one slide");
        assert!(matches!(
            error.kind(),
            ArmErrorKind::PostureLength { expected: 1, .. }
        ));
    }
    let notes = robot.with_slides_at(&[1.25]).expect("a place").chain.notes;
    assert!(
        notes
            .iter()
            .any(|note| note.contains("\"track\" stands still at 1250.0 mm"))
    );
}
