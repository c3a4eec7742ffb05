//! Static equilibrium and compliance.

use std::path::Path;

use nalgebra::{Matrix3, Unit, Vector3, Vector6};
use proptest::prelude::*;
use truecut_arm::{
    ArmErrorKind, FrameId, Load, Robot, directional_stiffness, planar_principal,
    standard_gravity_m_s2,
};

use super::random_chain::{axis, case, vector};

const POSTURE_DEG: [f64; 6] = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95];

fn asset(name: &str) -> Robot {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    Robot::load(&root.join(name).join("robot.urdf"), None, None).expect("the asset loads")
}

fn wrench(force_n: [f64; 3], moment_nm: [f64; 3]) -> Vector6<f64> {
    Vector6::from_iterator(force_n.into_iter().chain(moment_nm))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// What the holding command holds, the static posture finds again.
    #[test]
    fn verify_holding_command_and_static_posture_are_inverse(case in case(), force in vector(20.0)) {
        let load = Load::gravity(standard_gravity_m_s2() * 0.1)
            .with_wrench(FrameId::Tool, wrench(force.into(), [1.0, -2.0, 3.0]));
        // Ten times as stiff as the softest that the strategy makes, so that Newton starts near the
        // answer.
        let robot = case.robot.scaled(1.0, 100.0, 1.0);
        let command = robot.holding_command(&case.q, &load).expect("stiff joints");
        let q = robot.static_posture(&command, &load).expect("reached");
        for (found, expected) in q.iter().zip(&case.q) {
            prop_assert!((found - expected).abs() <= 1e-10);
        }
    }

    /// The stiffness along any direction lies between the principal stiffnesses of a plane that
    /// holds it.
    #[test]
    fn verify_planar_principal_bounds_every_direction(case in case(), first in axis(), other in axis(), angle in 0.0..6.3_f64) {
        let second = first.cross(&other);
        prop_assume!(second.norm() > 0.1);
        let second = Unit::new_normalize(second);
        let j = case.robot.jacobian(&case.q, FrameId::Tool);
        let linear = j.fixed_rows::<3>(0);
        let compliance = linear * linear.transpose() + Matrix3::identity() * 0.1;
        let planar = planar_principal(&compliance, &first, &second);
        let along = |angle: f64| {
            let direction = first.into_inner() * angle.cos() + second.into_inner() * angle.sin();
            directional_stiffness(&compliance, &Unit::new_normalize(direction))
        };
        let k = along(angle);
        prop_assert!(k >= planar.k_min_n_per_m * (1.0 - 1e-9) && k <= planar.k_max_n_per_m * (1.0 + 1e-9));
        prop_assert!((along(planar.k_max_angle_rad) / planar.k_max_n_per_m - 1.0).abs() <= 1e-9);
    }
}

/// The compliance under gravity and a kilonewton of preload is the derivative of the true static
/// posture, which is found by Newton's method and knows nothing of tangents at its end. 10 N either
/// way keep the quadratic term below 1e-6 and the rounding of 1e-15 m over 1e-5 m below 1e-8.
#[test]
fn verify_compliance_is_the_derivative_of_static_displacement() {
    let robot = asset("irb6600_175_255");
    let q = POSTURE_DEG.map(f64::to_radians);
    let preload = wrench([300.0, -700.0, 650.0], [40.0, -60.0, 80.0]);
    let load_with = |extra: Vector6<f64>| {
        Load::gravity(standard_gravity_m_s2()).with_wrench(FrameId::Tool, preload + extra)
    };
    let load = load_with(Vector6::zeros());
    let command = robot.holding_command(&q, &load).expect("stiff joints");
    let compliance = robot
        .cartesian_compliance(&q, FrameId::Tool, &load)
        .expect("regular");
    let unloaded = robot
        .cartesian_compliance(&q, FrameId::Tool, &Load::none())
        .expect("regular");
    for column in 0..6 {
        let mut extra = Vector6::zeros();
        extra[column] = 10.0;
        let at = |load: &Load| {
            let rest = robot.static_posture(&command, load).expect("reached");
            robot.world_from_frame(&rest, FrameId::Tool)
        };
        let (plus, minus) = (at(&load_with(extra)), at(&load_with(-extra)));
        let linear = (plus.translation.vector - minus.translation.vector) / 20.0;
        let angular = (plus.rotation * minus.rotation.inverse()).scaled_axis() / 20.0;
        let scale = compliance.column(column).amax();
        let error = (compliance.fixed_view::<3, 1>(0, column) - linear)
            .amax()
            .max((compliance.fixed_view::<3, 1>(3, column) - angular).amax());
        assert!(error <= 1e-6 * scale, "column {column}: {error} of {scale}");
        // The control: gravity and preload really change the compliance by more than that.
        let change = (compliance.column(column) - unloaded.column(column)).amax();
        assert!(
            change >= 1e-5 * scale,
            "column {column}: {change} of {scale}"
        );
    }
}

/// A slide on a spring under its own weight sags by m g / k.
#[test]
fn verify_sag_of_a_spring() {
    let robot = asset("rig_1dof");
    let load = Load::gravity(Vector3::new(9.81, 0.0, 0.0));
    let sag_m = 100.0 * 9.81 / 1e6;
    let rest = robot.static_posture(&[0.0], &load).expect("reached");
    assert!((rest[0] / sag_m - 1.0).abs() <= 1e-12);
    let command = robot.holding_command(&[0.0], &load).expect("stiff");
    assert!((command[0] / -sag_m - 1.0).abs() <= 1e-12);
    let place_m = |q: &[f64]| robot.world_from_frame(q, FrameId::Tool).translation.vector;
    let moved_m = place_m(&rest) - place_m(&[0.0]);
    assert!((moved_m - Vector3::new(sag_m, 0.0, 0.0)).amax() <= 1e-15);
}

/// Symmetric stiffness [[1, .3, .5], [.3, 1.6, .2], [.5, .2, 2.5]]: with the third direction free
/// the plane of the first two has the principal stiffnesses .812 and 1.672.
#[test]
fn verify_planar_principal_leaves_the_third_direction_free() {
    let stiffness = Matrix3::new(1.0, 0.3, 0.5, 0.3, 1.6, 0.2, 0.5, 0.2, 2.5);
    let compliance = stiffness.try_inverse().expect("regular");
    let planar = planar_principal(&compliance, &Vector3::x_axis(), &Vector3::y_axis());
    assert!((planar.k_min_n_per_m - 0.812).abs() <= 5e-4, "{planar:?}");
    assert!((planar.k_max_n_per_m - 1.672).abs() <= 5e-4, "{planar:?}");
}

/// Three springs at right angles are what they are; rotation cannot be clamped on three slides.
#[test]
fn verify_planar_rig_is_three_springs() {
    let robot = asset("rig_planar");
    let compliance = robot
        .process_compliance(&[0.0; 3], FrameId::Tool)
        .expect("stiff");
    for (axis, k) in [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()]
        .iter()
        .zip([8.646e5, 1.078e6, 1.394e6])
    {
        assert!((directional_stiffness(&compliance, axis) / k - 1.0).abs() <= 1e-12);
    }
    let full = robot
        .cartesian_compliance(&[0.0; 3], FrameId::Tool, &Load::none())
        .expect("stiff");
    let error = truecut_arm::clamped(&full).expect_err("no rotation at all");
    assert!(
        matches!(error.kind(), ArmErrorKind::SingularCompliance),
        "{error}"
    );
}

#[test]
fn without_stiffness_the_joint_is_named() {
    let mut robot = asset("irb6600_175_255");
    robot.chain.joints[3].transmission.stiffness = None;
    let error = robot.modes(&[0.0; 6], None).expect_err("joint 4 has none");
    let message = error.to_string();
    assert!(
        message.contains("\"joint_4\"") && message.contains("stiffness_nm_per_rad"),
        "{message}"
    );
}

/// Springs too soft for the weight: there are no modes at the posture, and Newton's method runs
/// away, or ends where the arm would stand on its head. All say so, with the spring that is wound
/// up most: sheets give stiffness in N m/arcmin.
#[test]
fn springs_too_soft_for_the_weight_are_refused() {
    let q = [0.0, -0.3, 0.0, 0.0, 0.5, 0.0];
    let gravity = standard_gravity_m_s2();
    let soft = |factor: f64| asset("irb6600_175_255").scaled(1.0, factor, 1.0);
    let topples = soft(1e-5)
        .modes(&q, Some(&gravity))
        .expect_err("it topples");
    assert!(
        topples.to_string().contains("not stable at this posture"),
        "{topples}"
    );

    let load = Load::gravity(gravity);
    let runs_away = soft(1e-3).static_posture(&q, &load).expect_err("no rest");
    assert!(
        matches!(runs_away.kind(), ArmErrorKind::NoEquilibrium { .. }),
        "{runs_away}"
    );
    let on_its_head = soft(1e-5).static_posture(&q, &load).expect_err("no rest");
    assert!(
        matches!(on_its_head.kind(), ArmErrorKind::UnstableEquilibrium { .. }),
        "{on_its_head}"
    );
    for error in [runs_away, on_its_head] {
        let told = error.to_string();
        for of_spring in [
            " N m wind the joint \"joint_",
            "robot.toml",
            "if it is one in N m/arcmin",
        ] {
            assert!(told.contains(of_spring), "{of_spring}: {told}");
        }
    }
}
