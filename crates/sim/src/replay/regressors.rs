//! Columns that drive forces are linear in, filtered once.

use super::motion::Motion;
use crate::effect::point_inertia;
use nalgebra::{Matrix3, Vector3};
use truecut_arm::{Dynamics, Robot};
use truecut_recording::filter::Butterworth;

/// Columns of a body fixed to one link, for each of its ten inertial parameters about that link's
/// origin: mass, three first moments, and the inertia's xx, yy, zz, xy, xz, yz.
#[derive(Debug, Clone)]
pub(super) struct BodyRegressors {
    /// `[parameter][joint][sample]`, filtered.
    pub columns: Vec<Vec<Vec<f64>>>,
    /// The same without a filter.
    pub raw: Vec<Vec<Vec<f64>>>,
}

impl BodyRegressors {
    pub fn new(
        robot: &Robot,
        motion: &Motion,
        joints: &[usize],
        filter: &Butterworth,
        link: usize,
    ) -> BodyRegressors {
        let mut bare = robot.clone();
        for link in &mut bare.chain.links {
            link.mass_kg = 0.0;
            link.inertia_about_com_kg_m2 = Matrix3::zeros();
        }
        let run = |mass: f64, center: Vector3<f64>, inertia: Matrix3<f64>| {
            let mut robot = bare.clone();
            let body = &mut robot.chain.links[link];
            body.mass_kg = mass;
            body.com_m = center;
            body.inertia_about_com_kg_m2 = inertia;
            motion.inverse_dynamics(&mut Dynamics::new(&robot), &motion.gravity_m_s2, joints)
        };
        let zero = Matrix3::zeros();
        let mut columns = vec![run(1.0, Vector3::zeros(), zero)];
        for axis in 0..3 {
            // The second moments of a mass at +e and at -e are the same, so half the difference has
            // none.
            let e = Vector3::ith(axis, 1.0);
            let mut ahead = run(1.0, e, zero);
            for (a, b) in ahead
                .iter_mut()
                .flatten()
                .zip(run(1.0, -e, zero).iter().flatten())
            {
                *a = 0.5 * (*a - b);
            }
            columns.push(ahead);
        }
        for (i, j) in MOMENTS {
            let mut inertia = zero;
            inertia[(i, j)] = 1.0;
            inertia[(j, i)] = 1.0;
            columns.push(run(0.0, Vector3::zeros(), inertia));
        }
        let raw = columns.clone();
        for column in columns.iter_mut().flatten() {
            *column = filter.zero_phase(column);
        }
        BodyRegressors { columns, raw }
    }

    /// Adds a mass at `center_m` in the link's frame to the columns of all joints, filtered.
    pub fn add_point_mass(&self, mass_kg: f64, center_m: &Vector3<f64>, columns: &mut [Vec<f64>]) {
        for (factor, regressor) in point_mass(mass_kg, center_m).zip(&self.columns) {
            for (column, regressor) in columns.iter_mut().zip(regressor) {
                axpy(factor, regressor, column);
            }
        }
    }

    /// The same for one joint, without a filter.
    pub fn add_raw(&self, mass_kg: f64, center_m: &Vector3<f64>, at: usize, column: &mut [f64]) {
        for (factor, regressor) in point_mass(mass_kg, center_m).zip(&self.raw) {
            axpy(factor, &regressor[at], column);
        }
    }
}

/// The ten inertial parameters of a mass at `center_m`.
fn point_mass(mass_kg: f64, center_m: &Vector3<f64>) -> impl Iterator<Item = f64> {
    let inertia = point_inertia(mass_kg, center_m);
    let first: [f64; 3] = (center_m * mass_kg).into();
    std::iter::once(mass_kg)
        .chain(first)
        .chain(MOMENTS.map(|place| inertia[place]))
}

/// Places of the six moments of inertia.
const MOMENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

fn axpy(factor: f64, column: &[f64], into: &mut [f64]) {
    for (sum, value) in into.iter_mut().zip(column) {
        *sum += factor * value;
    }
}
