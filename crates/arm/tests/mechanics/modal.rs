//! Modes and frequency response.

use std::f64::consts::TAU;
use std::path::Path;

use nalgebra::{Complex, DMatrix};
use proptest::prelude::*;
use truecut_arm::{FrameId, Load, Robot, translational};

use super::random_chain::case;
use super::response::{response, sum_over_modes};

fn asset(name: &str) -> Robot {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    Robot::load(&root.join(name).join("robot.urdf"), None, None).expect("the asset loads")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// φᵀMφ = 1 and φᵀKφ = ω² are the definition of mass-normalised modes.
    #[test]
    fn verify_modes_diagonalise_mass_and_stiffness(case in case()) {
        let arm = case.robot.linearised(&case.q, FrameId::Tool, &Load::none()).expect("stiff");
        let modes = arm.modes().expect("stable");
        let n = case.robot.dof();
        let mass = modes.shapes.transpose() * &arm.mass * &modes.shapes;
        prop_assert!((mass - DMatrix::identity(n, n)).amax() <= 1e-8);
        let stiffness = modes.shapes.transpose() * &arm.stiffness * &modes.shapes;
        let highest = (TAU * modes.frequency_hz[n - 1]).powi(2);
        for i in 0..n {
            let expected = (TAU * modes.frequency_hz[i]).powi(2);
            prop_assert!((stiffness[(i, i)] - expected).abs() <= 1e-8 * highest);
        }
        prop_assert!(modes.frequency_hz.is_sorted());
    }

    /// With damping proportional to stiffness the sum over modes is the full matrix inverse; at 0
    /// Hz both are the static compliance.
    #[test]
    fn verify_frequency_response_is_the_sum_of_modes(case in case(), frequency_hz in 0.1..50.0_f64) {
        let arm = case.robot.linearised(&case.q, FrameId::Tool, &Load::none()).expect("stiff");
        let modes = arm.modes().expect("stable");
        let full = response(&arm, frequency_hz);
        let sum = sum_over_modes(&arm, &modes, frequency_hz);
        let size = full.map(|c| c.norm()).amax();
        prop_assert!((full - sum).map(|c| c.norm()).amax() <= 1e-6 * size);

        let at_rest = response(&arm, 0.0);
        let compliance = case.robot.cartesian_compliance(&case.q, FrameId::Tool, &Load::none()).expect("stiff");
        let fixed = translational(&compliance).map(|c| Complex::new(c, 0.0));
        prop_assert!((at_rest - fixed).map(|c| c.norm()).amax() <= 1e-9 * compliance.amax());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Damping ratios of modes come back from the matrix that they give, and leave modes uncoupled:
    /// the full inverse is the sum over modes.
    #[test]
    fn verify_given_damping_ratios_are_those_of_the_modes(case in case(), frequency_hz in 0.1..50.0_f64) {
        let n = case.robot.dof();
        let ratios: Vec<f64> = (0..n).map(|k| 0.01 + 0.013 * k as f64).collect();
        let own = case.robot.linearised(&case.q, FrameId::Tool, &Load::none()).expect("stiff");
        for given in [ratios, vec![0.04]] {
            let mut robot = case.robot.clone();
            robot.damping_ratios = given.clone();
            let arm = robot.linearised(&case.q, FrameId::Tool, &Load::none()).expect("stiff");
            prop_assert_eq!(&arm.mass, &own.mass);
            let modes = arm.modes().expect("stable");
            for (k, found) in modes.damping_ratio.iter().enumerate() {
                prop_assert!((found - given[k.min(given.len() - 1)]).abs() <= 1e-8);
            }
            let full = response(&arm, frequency_hz);
            let sum = sum_over_modes(&arm, &modes, frequency_hz);
            let size = full.map(|c| c.norm()).amax();
            prop_assert!((full - sum).map(|c| c.norm()).amax() <= 1e-6 * size);
        }
    }
}

/// A mass on a spring: 1/(k − mω² + icω), natural frequency √(k/m)/2π, damping ratio c/(2√(km)).
#[test]
fn verify_one_degree_of_freedom() {
    let robot = asset("rig_1dof");
    let modes = robot.modes(&[0.0], None).expect("stable");
    assert!((modes.frequency_hz[0] / (100.0 / TAU) - 1.0).abs() <= 1e-12);
    assert!((modes.damping_ratio[0] - 0.02).abs() <= 1e-12);
    let arm = robot
        .linearised(&[0.0], FrameId::Tool, &Load::none())
        .expect("stiff");
    for frequency_hz in [1.0, 15.9, 40.0] {
        let omega = TAU * frequency_hz;
        let exact = Complex::new(1e6 - 100.0 * omega * omega, 400.0 * omega).inv();
        let found = response(&arm, frequency_hz)[(0, 0)];
        assert!(
            (found - exact).norm() <= 1e-12 * exact.norm(),
            "{frequency_hz} Hz"
        );
    }
}

/// Three springs, one mass: √(k/m)/2π each, with 2 % of damping. The 1e-4 kg carriages shift X by
/// 2e-7.
#[test]
fn verify_planar_rig_modes() {
    let modes = asset("rig_planar").modes(&[0.0; 3], None).expect("stable");
    for (i, k) in [8.646e5, 1.078e6, 1.394e6_f64].into_iter().enumerate() {
        let expected = (k / 557.3).sqrt() / TAU;
        assert!((modes.frequency_hz[i] / expected - 1.0).abs() <= 1e-6);
        assert!((modes.damping_ratio[i] - 0.02).abs() <= 1e-7);
    }
}

/// Factors act as physics has it: twice the stiffness at twice the inertia leaves the frequency,
/// and so on.
#[test]
fn verify_scaling_laws() {
    let robot = asset("irb6600_175_255");
    let q = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95].map(f64::to_radians);
    let plain = robot.modes(&q, None).expect("stable");
    let scaled = robot.scaled(2.0, 8.0, 3.0).modes(&q, None).expect("stable");
    for i in 0..6 {
        assert!((scaled.frequency_hz[i] / plain.frequency_hz[i] - 2.0).abs() <= 1e-9);
        // ζ = c/(2√(k m)): 3/√16.
        assert!((scaled.damping_ratio[i] / plain.damping_ratio[i] - 0.75).abs() <= 1e-9);
    }
}

/// Rotors do not take part in the modes, but they are inertia all the same.
#[test]
fn rotors_scale_with_inertia() {
    let robot = asset("irb6600_175_255");
    let scaled = robot.scaled(2.0, 8.0, 3.0);
    for (joint, before) in scaled.chain.joints.iter().zip(&robot.chain.joints) {
        let (after, before) = (&joint.transmission, &before.transmission);
        assert_eq!(after.rotor_inertia, 2.0 * before.rotor_inertia);
        assert_eq!(after.servo, before.servo);
    }
}

#[test]
fn a_singular_mass_matrix_is_refused() {
    let mut robot = asset("rig_1dof");
    robot.chain.links[0].mass_kg = 0.0;
    let message = robot.modes(&[0.0], None).expect_err("no mass").to_string();
    assert!(message.contains("mass matrix"), "{message}");
}
