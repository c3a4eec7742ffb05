//! Equations of motion against energy: the recursions never form an energy, so agreement is
//! evidence.

use nalgebra::{DMatrix, DVector, Matrix6xX, Vector3};
use proptest::prelude::*;
use truecut_arm::{Dynamics, Energy, FrameId, Robot};

use super::random_chain::{Case, case};

const GRAVITY: Vector3<f64> = Vector3::new(1.3, -2.1, -9.4);
const FRAMES: [FrameId; 3] = [FrameId::Flange, FrameId::Tool, FrameId::Foot];

/// Posture and velocity a time `t` later at constant acceleration.
fn later(case: &Case, t: f64) -> (Vec<f64>, Vec<f64>) {
    let n = case.q.len();
    let q = (0..n).map(|i| case.q[i] + t * case.v[i] + 0.5 * t * t * case.a[i]);
    let v = (0..n).map(|i| case.v[i] + t * case.a[i]);
    (q.collect(), v.collect())
}

fn inverse_dynamics(
    robot: &Robot,
    q: &[f64],
    v: &[f64],
    a: &[f64],
    gravity_m_s2: &Vector3<f64>,
) -> DVector<f64> {
    let mut tau = DVector::zeros(robot.dof());
    Dynamics::new(robot).inverse_dynamics_into(q, v, a, gravity_m_s2, tau.as_mut_slice());
    tau
}

fn energy(robot: &Robot, q: &[f64], v: &[f64], gravity_m_s2: &Vector3<f64>) -> Energy {
    Dynamics::new(robot).energy(q, v, gravity_m_s2)
}

fn shifted(q: &[f64], i: usize, step: f64) -> Vec<f64> {
    let mut q = q.to_vec();
    q[i] += step;
    q
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Column i of M is the torque of a unit acceleration of joint i, without velocity and gravity.
    #[test]
    fn verify_mass_matrix_is_made_of_inverse_dynamics(case in case()) {
        let n = case.robot.dof();
        let mass = case.robot.mass_matrix(&case.q);
        let zeros = vec![0.0; n];
        for i in 0..n {
            let mut unit = zeros.clone();
            unit[i] = 1.0;
            let tau = inverse_dynamics(&case.robot, &case.q, &zeros, &unit, &Vector3::zeros());
            // Rounding of sums of products, all of the size of the largest entry.
            prop_assert!((mass.column(i) - tau).amax() <= 1e-13 * mass.amax());
        }
        prop_assert!((&mass - mass.transpose()).amax() == 0.0);
        prop_assert!(mass.cholesky().is_some(), "not positive definite");
    }

    /// ½ vᵀMv is the kinetic energy.
    #[test]
    fn verify_kinetic_energy_is_the_mass_matrix_form(case in case()) {
        let v = DVector::from_column_slice(&case.v);
        let form = 0.5 * v.dot(&(case.robot.mass_matrix(&case.q) * &v));
        let kinetic = energy(&case.robot, &case.q, &case.v, &GRAVITY).kinetic_j;
        prop_assert!((form - kinetic).abs() <= 1e-12 * kinetic.max(1.0));
    }

    /// Lagrange: τ = M a + Ṁ v − ∂T/∂q + ∂V/∂q, derivatives by central differences. With step h =
    /// 1e-5 their error is of order h² and rounding/h, both some 1e-9 of the energies involved;
    /// 1e-6 leaves room for strong curvature.
    #[test]
    fn verify_inverse_dynamics_is_lagranges_equation(case in case()) {
        let (robot, n, h) = (&case.robot, case.robot.dof(), 1e-5);
        let v = DVector::from_column_slice(&case.v);
        let a = DVector::from_column_slice(&case.a);
        let ahead = robot.mass_matrix(&later(&case, h).0);
        let behind = robot.mass_matrix(&later(&case, -h).0);
        let mass_rate: DMatrix<f64> = (ahead - behind) / (2.0 * h);
        let mut expected = robot.mass_matrix(&case.q) * &a + mass_rate * &v;
        for i in 0..n {
            let plus = energy(robot, &shifted(&case.q, i, h), &case.v, &GRAVITY);
            let minus = energy(robot, &shifted(&case.q, i, -h), &case.v, &GRAVITY);
            expected[i] -= (plus.kinetic_j - minus.kinetic_j) / (2.0 * h);
            expected[i] += (plus.potential_j - minus.potential_j) / (2.0 * h);
        }
        let tau = inverse_dynamics(robot, &case.q, &case.v, &case.a, &GRAVITY);
        prop_assert!((&tau - &expected).amax() <= 1e-6 * expected.amax().max(1.0), "{tau} {expected}");
    }

    /// Power put in equals the rate of energy.
    #[test]
    fn verify_power_balance(case in case()) {
        let h = 1e-5;
        let total = |t| {
            let (q, v) = later(&case, t);
            let found = energy(&case.robot, &q, &v, &GRAVITY);
            found.kinetic_j + found.potential_j
        };
        let rate = (total(h) - total(-h)) / (2.0 * h);
        let tau = inverse_dynamics(&case.robot, &case.q, &case.v, &case.a, &GRAVITY);
        let power = tau.dot(&DVector::from_column_slice(&case.v));
        let scale = tau.norm() * DVector::from_column_slice(&case.v).norm() + 1.0;
        prop_assert!((rate - power).abs() <= 1e-6 * scale, "{rate} {power}");
    }

    /// Jacobian times velocity is the motion of the frame, by differences of forward kinematics.
    #[test]
    fn verify_jacobian_is_the_derivative_of_the_pose(case in case()) {
        let (robot, h) = (&case.robot, 1e-6);
        let mut workspace = Dynamics::new(robot);
        for frame in FRAMES {
            let jacobian = robot.jacobian(&case.q, frame);
            for i in 0..robot.dof() {
                let plus = robot.world_from_frame(&shifted(&case.q, i, h), frame);
                let minus = robot.world_from_frame(&shifted(&case.q, i, -h), frame);
                let linear = (plus.translation.vector - minus.translation.vector) / (2.0 * h);
                let angular = (plus.rotation * minus.rotation.inverse()).scaled_axis() / (2.0 * h);
                let error = (jacobian.fixed_view::<3, 1>(0, i) - linear).amax()
                    .max((jacobian.fixed_view::<3, 1>(3, i) - angular).amax());
                prop_assert!(error <= 1e-8, "{frame:?}, joint {i}: {error}");
            }
            let mut fast = Matrix6xX::zeros(robot.dof());
            workspace.jacobian_into(&case.q, frame, &mut fast);
            prop_assert!((&fast - &jacobian).amax() <= 1e-13);
        }
    }

    /// Bias and gravity torques are inverse dynamics with zeros in the right places.
    #[test]
    fn bias_and_gravity_are_parts_of_inverse_dynamics(case in case()) {
        let n = case.robot.dof();
        let (zeros, mut tau) = (vec![0.0; n], vec![0.0; n]);
        let mut workspace = Dynamics::new(&case.robot);
        workspace.bias_into(&case.q, &case.v, &GRAVITY, &mut tau);
        let expected = inverse_dynamics(&case.robot, &case.q, &case.v, &zeros, &GRAVITY);
        prop_assert_eq!(tau.as_slice(), expected.as_slice());
        workspace.gravity_torques_into(&case.q, &GRAVITY, &mut tau);
        let expected = inverse_dynamics(&case.robot, &case.q, &zeros, &zeros, &GRAVITY);
        prop_assert_eq!(tau.as_slice(), expected.as_slice());
    }
}

fn acceleration(robot: &Robot, workspace: &mut Dynamics, q: &[f64], v: &[f64]) -> DVector<f64> {
    let mut bias = DVector::zeros(q.len());
    workspace.bias_into(q, v, &GRAVITY, bias.as_mut_slice());
    let mass = robot.mass_matrix(q).cholesky().expect("positive definite");
    -mass.solve(&bias)
}

/// One step of the classical fourth-order Runge–Kutta rule for the arm without torques.
fn runge_kutta(
    robot: &Robot,
    workspace: &mut Dynamics,
    q: &mut DVector<f64>,
    v: &mut DVector<f64>,
    h: f64,
) {
    let mut slope = |q: &DVector<f64>, v: &DVector<f64>| {
        (
            v.clone(),
            acceleration(robot, workspace, q.as_slice(), v.as_slice()),
        )
    };
    let (q1, v1) = slope(q, v);
    let (q2, v2) = slope(&(&*q + &q1 * (h / 2.0)), &(&*v + &v1 * (h / 2.0)));
    let (q3, v3) = slope(&(&*q + &q2 * (h / 2.0)), &(&*v + &v2 * (h / 2.0)));
    let (q4, v4) = slope(&(&*q + &q3 * h), &(&*v + &v3 * h));
    *q += (q1 + q2 * 2.0 + q3 * 2.0 + q4) * (h / 6.0);
    *v += (v1 + v2 * 2.0 + v3 * 2.0 + v4) * (h / 6.0);
}

/// The default arm, let go: energy stays while it falls and swings. Fourth order at 0.5 ms leaves
/// some 1e-9 of the energy that moves.
#[test]
fn verify_falling_arm_keeps_its_energy() {
    let urdf = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/robots/irb6600_175_255/robot.urdf"
    );
    let robot = Robot::load(urdf.as_ref(), None, None).expect("the asset loads");
    let mut workspace = Dynamics::new(&robot);
    let degrees = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95];
    let mut q = DVector::from_row_slice(&degrees.map(f64::to_radians));
    let mut v = DVector::zeros(6);
    let start = energy(&robot, q.as_slice(), v.as_slice(), &GRAVITY);
    let mut most_kinetic_j: f64 = 0.0;
    for _ in 0..2000 {
        runge_kutta(&robot, &mut workspace, &mut q, &mut v, 5e-4);
        let now = energy(&robot, q.as_slice(), v.as_slice(), &GRAVITY);
        most_kinetic_j = most_kinetic_j.max(now.kinetic_j);
        let drift = now.kinetic_j + now.potential_j - start.potential_j;
        assert!(
            drift.abs() <= 1e-8 * start.potential_j.abs().max(most_kinetic_j),
            "{drift} J"
        );
    }
    assert!(
        most_kinetic_j > 1e3,
        "it must really have fallen: {most_kinetic_j} J"
    );
}
