//! Tangent stiffnesses against differences of the torques that they are derivatives of. Step 1e-6:
//! error h² and rounding/h are both near 1e-9 of the torques.

use nalgebra::{DVector, Vector3, Vector6};
use proptest::prelude::*;
use truecut_arm::{FrameId, Load};

use super::random_chain::{case, vector};

const GRAVITY: Vector3<f64> = Vector3::new(0.4, 1.1, -9.7);
const STEP: f64 = 1e-6;

fn wrench() -> impl Strategy<Value = Vector6<f64>> {
    (vector(500.0), vector(200.0)).prop_map(|(force, moment)| {
        Vector6::from_iterator(force.iter().chain(moment.iter()).copied())
    })
}

fn difference(q: &[f64], i: usize, torque: impl Fn(&[f64]) -> DVector<f64>) -> DVector<f64> {
    let (mut plus, mut minus) = (q.to_vec(), q.to_vec());
    plus[i] += STEP;
    minus[i] -= STEP;
    (torque(&plus) - torque(&minus)) / (2.0 * STEP)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn verify_gravity_stiffness_is_the_derivative_of_gravity_torques(case in case()) {
        let tangent = case.robot.gravity_stiffness(&case.q, &GRAVITY);
        let scale = tangent.amax().max(1.0);
        for i in 0..case.robot.dof() {
            let column = difference(&case.q, i, |q| case.robot.load_torques(q, &Load::gravity(GRAVITY)));
            prop_assert!((tangent.column(i) - column).amax() <= 1e-6 * scale);
        }
    }

    #[test]
    fn verify_preload_stiffness_is_the_derivative_of_wrench_torques(case in case(), wrench in wrench()) {
        let tangent = case.robot.preload_stiffness(&case.q, FrameId::Tool, &wrench);
        let scale = tangent.amax().max(1.0);
        for i in 0..case.robot.dof() {
            let column = difference(&case.q, i, |q| {
                case.robot.jacobian(q, FrameId::Tool).tr_mul(&wrench)
            });
            prop_assert!((tangent.column(i) - column).amax() <= 1e-6 * scale);
        }
    }

    #[test]
    fn tangent_stiffness_is_the_sum_of_its_parts(case in case(), wrench in wrench()) {
        let load = Load::gravity(GRAVITY).with_wrench(FrameId::Foot, wrench);
        let springs = case.robot.transmission_stiffness("a test").expect("given");
        let sum = springs + case.robot.gravity_stiffness(&case.q, &GRAVITY)
            - case.robot.preload_stiffness(&case.q, FrameId::Foot, &wrench);
        prop_assert_eq!(case.robot.tangent_stiffness(&case.q, &load).expect("given"), sum);
    }
}
