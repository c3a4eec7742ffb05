//! The HP20 against inverse kinematics of `docs/physics/arm.md`, computed anew by
//! `tests/reference/arm.py`, for the belt wheel on a wheel-hub spoke.

use std::path::PathBuf;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::report::{IkRow, ik_rows};
use truecut_arm::{ArmBranch, BranchOptions, Elbow, FrameId, Robot, Shoulder, Wrist};

fn robot() -> Robot {
    let urdf =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/hp20/robot.urdf");
    Robot::load(&urdf, None, None).expect("the asset loads")
}

/// A point of the spoke z = 25 sin πu − 0.006 (1 − u/2) y² (mm) over (200u, y), at y = 0: where the
/// centre of a wheel of 40 mm pressed in by 0.5 mm stands, tool y along the wheel's axis (the
/// direction of least curvature, here that of u), tool z into the surface.
fn wheel_pose(u: f64) -> Isometry3<f64> {
    let (sine, cosine) = (std::f64::consts::PI * u).sin_cos();
    let rise = 25.0 * std::f64::consts::PI * cosine;
    let along = Vector3::new(200.0, 0.0, rise).normalize();
    let normal = Vector3::new(-rise, 0.0, 200.0).normalize();
    let centre_mm = Vector3::new(200.0 * u, 0.0, 25.0 * sine) + normal * 39.5;
    let point = Vector3::new(1.0, -0.1, 0.45) + centre_mm * 1e-3;
    let axes = Matrix3::from_columns(&[along.cross(&-normal), along, -normal]);
    let rotation = Rotation3::from_matrix_unchecked(axes);
    Isometry3::from_parts(
        Translation3::from(point),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}

/// Values printed to 1e-3 degree: half a digit of them and rounding stay within the tolerance of
/// 1e-3.
#[test]
fn verify_hp20_inverse_kinematics_on_the_spoke() {
    let robot = robot();
    let solver = robot.ik_solver(&BranchOptions::default());
    let geometry = *solver.geometry().expect("solved in closed form");
    let expected_deg = [
        (0.2, [-6.200, 6.516, -34.775, -3.616, -31.231, -80.996]),
        (0.6, [-4.896, 22.475, -12.569, 0.668, -61.852, -85.455]),
    ];
    // The elbow above the line from shoulder to wrist, θ5 > 0.
    let wanted = ArmBranch {
        shoulder: Shoulder::Front,
        elbow: Elbow::Upper,
        wrist: Wrist::Positive,
    };
    for (u, expected) in expected_deg {
        let branches = solver.branches(&wheel_pose(u), FrameId::Tool);
        let apart = |q: &Vec<f64>| {
            let differences = q.iter().zip(expected).map(|(q, e)| {
                let turned = (q.to_degrees() - e).rem_euclid(360.0);
                turned.min(360.0 - turned)
            });
            differences.fold(0.0, f64::max)
        };
        let nearest = branches
            .iter()
            .min_by(|a, b| apart(a).total_cmp(&apart(b)))
            .expect("within reach");
        assert!(apart(nearest) <= 1e-3, "u = {u}: {branches:?}");
        robot.check_posture(nearest).expect("within limits");
        assert_eq!(geometry.branch(nearest), wanted);
    }
}

/// Catalogue reach, axis 1 to the wrist centre with the arm stretched: 1717 mm, given in whole
/// millimetres.
#[test]
fn verify_hp20_reach() {
    let robot = robot();
    let geometry = *robot
        .ik_solver(&BranchOptions::default())
        .geometry()
        .expect("ortho-parallel");
    let reach_m = geometry.a1_m + geometry.c2_m + geometry.a2_m.hypot(geometry.c3_m);
    assert!((reach_m - 1.717).abs() <= 0.5e-3, "{reach_m}");
}

/// Axes whose limits pass 180 degrees: a posture beyond it is among the answers for its own pose.
#[test]
fn verify_postures_a_whole_turn_away_are_found() {
    let mut robot = robot();
    for (joint, [lower, upper]) in [(0, [100.0_f64, 440.0]), (3, [-420.0, -60.0])] {
        let limits = robot.chain.joints[joint].limits.as_mut().expect("limits");
        (limits.lower, limits.upper) = (lower.to_radians(), upper.to_radians());
    }
    let mut state = 30_u64;
    let mut share = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for _ in 0..40 {
        let posture: Vec<f64> = (robot.chain.joints.iter())
            .map(|joint| {
                let limits = joint.limits.expect("limits");
                limits.lower + (limits.upper - limits.lower) * (0.05 + 0.9 * share())
            })
            .collect();
        let pose = robot.world_from_frame(&posture, FrameId::Tool);
        let rows = ik_rows(&robot, &[pose], FrameId::Tool);
        let apart = |row: &IkRow| {
            let turns = row.posture.iter().zip(&posture).map(|(a, b)| {
                let turn = (a - b).rem_euclid(std::f64::consts::TAU);
                turn.min(std::f64::consts::TAU - turn)
            });
            turns.fold(0.0, f64::max)
        };
        let own = rows.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
        let own = own.expect("within reach");
        assert!(
            apart(own) < 1e-6 && own.within_limits,
            "{posture:?} {own:?}"
        );
    }
}
