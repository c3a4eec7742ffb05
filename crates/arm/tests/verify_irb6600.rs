//! The default robot against published and independently computed numbers.
//!
//! Geometry: an ortho-parallel basis with spherical wrist (Brandstötter, Angerer, Hofbaur 2014),
//! whose forward kinematics is written here from its own formulas, not from the URDF. Stiffness and
//! modes: the reference values of `docs/physics/arm.md` at the posture of Dong et al. 2018,
//! computed anew by `tests/reference/arm.py`.

use std::f64::consts::FRAC_PI_2;
use std::path::PathBuf;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use truecut_arm::{
    FrameId, Load, Robot, axial_lateral_coupling, clamped, directional_stiffness, in_axes,
    planar_principal, standard_gravity_m_s2, translational,
};

/// Joint angles of Dong et al. 2018, degrees.
const POSTURE_DEG: [f64; 6] = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95];
/// The asset's masses and inertias are this share of the reference model's.
const ASSET_INERTIA: f64 = 0.82;

fn robot() -> Robot {
    let urdf = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets/robots/irb6600_175_255/robot.urdf");
    Robot::load(&urdf, None, None).expect("the asset loads")
}

fn posture() -> [f64; 6] {
    POSTURE_DEG.map(f64::to_radians)
}

fn assert_close(what: &str, value: f64, expected: f64, relative: f64) {
    let error = (value / expected - 1.0).abs();
    assert!(
        error <= relative,
        "{what}: {value} instead of {expected}, {error:.2e} off (allowed {relative:.0e})"
    );
}

/// OPW forward kinematics: flange position and rotation for a1 .32, a2 −.2, b 0, c1 .78, c2 1.075,
/// c3 1.142, c4 .2 m.
fn opw_forward(q: &[f64; 6]) -> (Vector3<f64>, Matrix3<f64>) {
    let (a1, a2, b, c1, c2, c3, c4) = (0.32, -0.2, 0.0, 0.78, 1.075, 1.142, 0.2);
    let theta3 = q[2] + FRAC_PI_2;
    let psi = f64::atan2(a2, c3);
    let kappa = f64::hypot(a2, c3);
    let sum = q[1] + theta3;
    let radial = c2 * q[1].sin() + kappa * (sum + psi).sin() + a1;
    let height = c1 + c2 * q[1].cos() + kappa * (sum + psi).cos();
    let turn = |axis: Vector3<f64>, angle: f64| {
        *Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle).matrix()
    };
    let (y, z) = (Vector3::y(), Vector3::z());
    let base = turn(z, q[0]);
    let rotation = base * turn(y, sum) * turn(z, q[3]) * turn(y, q[4]) * turn(z, q[5]);
    let wrist = base * Vector3::new(radial, b, height);
    (wrist + rotation * z * c4, rotation)
}

/// The ten-digit flange pose. The numbers carry half a digit in 1e-10, so 1e-9 leaves room for
/// nothing but rounding.
#[test]
fn verify_opw_test_vector() {
    let pose = robot().world_from_frame(&posture(), FrameId::Flange);
    let matrix = pose.rotation.to_rotation_matrix();
    let position_m = Vector3::new(1.3043301285, -1.2351738406, 0.4886557433);
    let z = Vector3::new(0.1571794943, 0.9875691603, -0.0013267225);
    let x = Vector3::new(-0.6928734071, 0.1112334106, 0.7124279403);
    assert!((pose.translation.vector - position_m).amax() <= 1e-9);
    assert!((matrix.matrix().column(2) - z).amax() <= 1e-9);
    assert!((matrix.matrix().column(0) - x).amax() <= 1e-9);
}

#[test]
fn verify_flange_agrees_with_opw_formulas_over_the_workspace() {
    let robot = robot();
    for k in 0..200 {
        // Low-discrepancy postures (additive recurrence) over the whole range of each joint.
        let q = std::array::from_fn(|i| {
            let share = (0.5 + f64::from(k) * (0.618_034 + 0.1 * i as f64)).fract();
            let limits = robot.chain.joints[i].limits.expect("limited");
            limits.lower + share * (limits.upper - limits.lower)
        });
        let pose = robot.world_from_frame(&q, FrameId::Flange);
        let (position_m, rotation) = opw_forward(&q);
        assert!(
            (pose.translation.vector - position_m).amax() <= 1e-12,
            "{q:?}"
        );
        assert!(
            (pose.rotation.to_rotation_matrix().matrix() - rotation).amax() <= 1e-12,
            "{q:?}"
        );
    }
}

/// Free stiffness along X (feed), Y, Z and the principal values of the lateral plane. Tolerance:
/// the reference is given to 0.02 %.
#[test]
fn verify_irb6600_cal_free_stiffness() {
    let robot = robot();
    let compliance = robot
        .process_compliance(&posture(), FrameId::Tool)
        .expect("stiffness given");
    let along = |axis| directional_stiffness(&compliance, &axis);
    assert_close("k_X", along(Vector3::x_axis()), 0.86476e6, 2e-4);
    assert_close("k_Y", along(Vector3::y_axis()), 1.37290e6, 2e-4);
    assert_close("k_Z", along(Vector3::z_axis()), 1.09067e6, 2e-4);
    let lateral = planar_principal(&compliance, &Vector3::y_axis(), &Vector3::z_axis());
    assert_close("k2", lateral.k_min_n_per_m, 1.07780e6, 2e-4);
    assert_close("k3", lateral.k_max_n_per_m, 1.39384e6, 2e-4);
    assert_close("angle", lateral.k_max_angle_rad.to_degrees(), 13.185, 2e-4);
}

/// Clamping the rotation makes stiffness blind to the length of the tool; left free it is not.
#[test]
fn verify_clamped_stiffness_is_independent_of_tool_length() {
    let q = posture();
    let at_length = |length_m: f64| {
        let mut robot = robot();
        robot.frames.flange_from_tool.translation.vector = Vector3::z() * length_m;
        let compliance = robot
            .cartesian_compliance(&q, FrameId::Tool, &Load::none())
            .expect("stiffness given");
        let axes = robot.world_from_process(&q);
        let held = in_axes(&clamped(&compliance).expect("regular posture"), &axes);
        (held, in_axes(&translational(&compliance), &axes))
    };
    let (held_short, free_short) = at_length(0.0);
    for length_m in [0.3, 0.5] {
        let (held, free) = at_length(length_m);
        assert!(
            (held - held_short).norm() <= 1e-9 * held.norm(),
            "clamped, {length_m} m"
        );
        assert!(
            (free - free_short).norm() >= 0.1 * free_short.norm(),
            "free, {length_m} m"
        );
        // And it overstates the stiffness in every direction.
        for axis in [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()] {
            assert!(directional_stiffness(&held, &axis) > directional_stiffness(&free, &axis));
        }
    }
}

/// A second set of joint stiffnesses, fitted with rotation clamped, gives the paper's k1, k2, k3
/// under that definition. The set is printed to three or four digits, half a unit of the coarsest
/// being 0.08 %.
#[test]
fn verify_clamped_stiffness_of_the_paper() {
    let mut robot = robot();
    let clamped_fit = [1.245e6, 1.802e6, 2.884e6, 0.880e6, 0.634e6, 1.070e6];
    for (joint, k) in robot.chain.joints.iter_mut().zip(clamped_fit) {
        joint.transmission.stiffness = Some(k);
    }
    let q = posture();
    let compliance = robot
        .cartesian_compliance(&q, FrameId::Tool, &Load::none())
        .expect("stiffness given");
    let axes = robot.world_from_process(&q);
    let held = in_axes(&clamped(&compliance).expect("regular posture"), &axes);
    let lateral = planar_principal(&held, &Vector3::y_axis(), &Vector3::z_axis());
    assert_close(
        "k1",
        directional_stiffness(&held, &Vector3::x_axis()),
        8.646e5,
        1e-3,
    );
    assert_close("k2", lateral.k_min_n_per_m, 1.078e6, 1e-3);
    assert_close("k3", lateral.k_max_n_per_m, 1.394e6, 1e-3);
}

/// Reference modes without gravity, given to a millihertz: half a unit in the last place is 0.01 %
/// of the first.
#[test]
fn verify_irb6600_cal_modes() {
    let reference = [6.042, 9.985, 19.056, 25.445, 39.275, 79.924];
    let unscaled = robot().scaled(1.0 / ASSET_INERTIA, 1.0, 1.0);
    let modes = unscaled.modes(&posture(), None).expect("stable");
    for (f, expected) in modes.frequency_hz.iter().zip(reference) {
        assert!(
            (f - expected).abs() <= 6e-4,
            "{f} Hz instead of {expected} Hz"
        );
    }
    let asset = robot().modes(&posture(), None).expect("stable");
    assert!(
        (asset.frequency_hz[0] - 6.672).abs() <= 6e-4,
        "{}",
        asset.frequency_hz[0]
    );
    // Damping proportional to stiffness: ζ = c/K · ω/2 in every mode.
    for (f, zeta) in asset.frequency_hz.iter().zip(&asset.damping_ratio) {
        assert_close(
            "damping ratio",
            *zeta,
            9.5e-4 * std::f64::consts::PI * f,
            1e-9,
        );
    }
}

/// "Gravity shifts them by less than 0.03 %."
#[test]
fn verify_gravity_hardly_shifts_the_modes() {
    let robot = robot();
    let without = robot.modes(&posture(), None).expect("stable");
    let with = robot
        .modes(&posture(), Some(&standard_gravity_m_s2()))
        .expect("stable");
    for (a, b) in without.frequency_hz.iter().zip(&with.frequency_hz) {
        assert!((b / a - 1.0).abs() < 3e-4);
        assert!((b / a - 1.0).abs() > 1e-8, "gravity must act");
    }
}

/// |S| = 0.525: half a newton across for every newton along.
#[test]
fn verify_axial_lateral_coupling() {
    let compliance = robot()
        .process_compliance(&posture(), FrameId::Tool)
        .expect("stiffness");
    let coupling = axial_lateral_coupling(&compliance).expect("compliant");
    assert!(
        (coupling.norm() - 0.525).abs() <= 5e-4,
        "{}",
        coupling.norm()
    );
}

#[test]
fn the_asset_is_read_as_meant() {
    let robot = robot();
    assert_eq!(robot.dof(), 6);
    assert_eq!(robot.chain.tip, "flange");
    assert!(robot.chain.notes.is_empty(), "{:?}", robot.chain.notes);
    assert_eq!(robot.chain.base.name, "base_link");
    let moving_kg: f64 = robot.chain.links.iter().map(|link| link.mass_kg).sum();
    assert_close("moving mass", moving_kg, ASSET_INERTIA * 1165.0, 1e-12);
    let tool = robot.world_from_frame(&posture(), FrameId::Tool);
    let flange = robot.world_from_frame(&posture(), FrameId::Flange);
    assert_close(
        "tool length",
        (tool.translation.vector - flange.translation.vector).norm(),
        0.3,
        1e-12,
    );
    // Every link has something to look at.
    assert!(
        robot
            .chain
            .links
            .iter()
            .all(|link| !link.visuals.is_empty())
    );
}
