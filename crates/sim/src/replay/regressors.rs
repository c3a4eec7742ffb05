//! Columns that drive forces are linear in, filtered once.

use super::motion::{Motion, sign};
use nalgebra::{Matrix3, Vector3};
use truecut_arm::{Dynamics, Robot};
use truecut_recording::filter::Butterworth;
use truecut_scenario::effect::EffectKind;

/// Columns of one joint's own laws.
#[derive(Debug, Clone)]
pub(super) struct JointRegressors {
    /// Velocity while it is positive, else 0; and the other way round.
    velocity: [Vec<f64>; 2],
    /// 1 while the velocity is positive, -1 while it is negative, each else 0.
    sign: [Vec<f64>; 2],
    cosine: Vec<f64>,
    sine: Vec<f64>,
}

impl JointRegressors {
    pub fn new(position: &[f64], velocity: &[f64], filter: &Butterworth) -> JointRegressors {
        let of = |values: &[f64], law: &dyn Fn(f64) -> f64| {
            filter.zero_phase(&values.iter().map(|x| law(*x)).collect::<Vec<_>>())
        };
        JointRegressors {
            velocity: [of(velocity, &|v| v.max(0.0)), of(velocity, &|v| v.min(0.0))],
            sign: [
                of(velocity, &|v| sign(v).max(0.0)),
                of(velocity, &|v| sign(v).min(0.0)),
            ],
            cosine: of(position, &f64::cos),
            sine: of(position, &f64::sin),
        }
    }

    /// Adds to `column` what the drive must do against an effect on this joint. Friction opposes the motion,
    /// so the drive gives it; what pushes the link by itself the drive need not.
    pub fn add(&self, kind: EffectKind, values: &[f64], column: &mut [f64]) {
        let two = |columns: &[Vec<f64>; 2], factors: [f64; 2], into: &mut [f64]| {
            axpy(factors[0], &columns[0], into);
            axpy(factors[1], &columns[1], into);
        };
        match kind {
            EffectKind::JointViscous => two(&self.velocity, [values[0]; 2], column),
            EffectKind::JointAsymmetricViscous => {
                two(&self.velocity, [values[0], values[1]], column);
            }
            EffectKind::JointCoulomb => two(&self.sign, [values[0]; 2], column),
            EffectKind::JointAsymmetricCoulomb => two(&self.sign, [values[0], values[1]], column),
            EffectKind::JointCounterbalance => {
                axpy(-values[0], &self.cosine, column);
                axpy(-values[1], &self.sine, column);
            }
            EffectKind::JointOffset => column.iter_mut().for_each(|sum| *sum -= values[0]),
            _ => {}
        }
    }
}

/// What the transmission must pass on against an effect of one joint, at one instant; see [`JointRegressors::add`].
pub(super) fn against(kind: EffectKind, values: &[f64], position: f64, velocity: f64) -> f64 {
    let direction = usize::from(velocity < 0.0);
    match kind {
        EffectKind::JointViscous => values[0] * velocity,
        EffectKind::JointAsymmetricViscous => values[direction] * velocity,
        EffectKind::JointCoulomb => values[0] * sign(velocity),
        EffectKind::JointAsymmetricCoulomb => values[direction] * sign(velocity),
        EffectKind::JointStribeck => {
            let (excess, speed) = (values[0], values[1]);
            excess * (-(velocity / speed).powi(2)).exp() * sign(velocity)
        }
        EffectKind::JointCounterbalance => -values[0] * position.cos() - values[1] * position.sin(),
        EffectKind::JointOffset => -values[0],
        _ => 0.0,
    }
}

/// Columns of a body fixed to one link, for each of its ten inertial parameters about that link's origin:
/// mass, three first moments, and the inertia's xx, yy, zz, xy, xz, yz.
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
            motion.inverse_dynamics(&mut Dynamics::new(&robot), joints)
        };
        let zero = Matrix3::zeros();
        let mut columns = vec![run(1.0, Vector3::zeros(), zero)];
        for axis in 0..3 {
            // The second moments of a mass at +e and at -e are the same, so half the difference has none.
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
    let cross = center_m.cross_matrix();
    let inertia = -cross * cross;
    let first: [f64; 3] = (*center_m).into();
    std::iter::once(1.0)
        .chain(first)
        .chain(MOMENTS.map(|place| inertia[place]))
        .map(move |factor| mass_kg * factor)
}

/// Places of the six moments of inertia.
const MOMENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

fn axpy(factor: f64, column: &[f64], into: &mut [f64]) {
    for (sum, value) in into.iter_mut().zip(column) {
        *sum += factor * value;
    }
}
