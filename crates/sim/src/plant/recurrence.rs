//! The exact recurrence of a linear mechanical system from step to step.
//!
//! For `M x'' + D x' = r`, `r = f - K x`, with `f` held, the solution over one step `h` forwards
//! and backwards is known through the matrix exponential. Eliminating the velocity between both
//! leaves a recurrence in positions alone, here written with `u = (x⁺ - x)/h`, the mean velocity
//! over a step:
//!
//! `u⁺ = Q u⁻ + G r`, `x⁺ = x + h u⁺`.
//!
//! It has the form of the leapfrog scheme, and is the leapfrog scheme in the limit of small steps
//! (`Q → 1`, `G → h M⁻¹`). For an oscillator without damping `G = h sinc²(ωh/2)/m`. Free motion,
//! and motion under a constant force, are met exactly whatever the step and whatever modes the
//! damping couples; modes without stiffness need no case of their own. A force of frequency `w` is
//! met to `(w h)²/12`. This is Gautschi's method (`gautschi1961`; `hairer2006`, XIII.1), carried
//! over to damped systems.
//!
//! Velocities at the instant follow from the same elimination; it is singular where a step is a
//! whole number of half periods of a mode, since positions then say nothing about that mode's
//! velocity.

use nalgebra::{DMatrix, DVector, Dyn, SMatrix, linalg::LU};

/// Matrices of the recurrence, each n×n.
#[derive(Debug, Clone)]
pub(super) struct Recurrence {
    step_s: f64,
    decay: DMatrix<f64>,
    gain: DMatrix<f64>,
    /// `gain / h`: change of `u` by an impulse.
    mobility: DMatrix<f64>,
    velocity_from_mean: DMatrix<f64>,
    velocity_from_force: DMatrix<f64>,
    next_from_velocity: DMatrix<f64>,
    next_from_force: DMatrix<f64>,
    /// Mean velocity over the step before from velocity and force.
    before_from_velocity: DMatrix<f64>,
    before_from_force: DMatrix<f64>,
}

/// First two block rows of the exponential that takes `(x, ±h v, h² M⁻¹ r)` over the step `±h`.
struct Flow {
    from_velocity: DMatrix<f64>,
    from_force: DMatrix<f64>,
    velocity_from_velocity: DMatrix<f64>,
    velocity_from_force: DMatrix<f64>,
}

impl Flow {
    /// `stiffness` is `h² M⁻¹ K`, `damping` is `± h M⁻¹ D`. Steps are short beside all periods as a
    /// rule, and a power series then takes a fifth of the exponential's time; a travelling arm
    /// needs thousands of them.
    fn new(stiffness: &DMatrix<f64>, damping: &DMatrix<f64>) -> Self {
        if one_norm(stiffness) + one_norm(damping) > MOST_FOR_SERIES {
            return Self::exponential(stiffness, damping);
        }
        match stiffness.nrows() {
            1 => Self::series::<1>(stiffness, damping),
            2 => Self::series::<2>(stiffness, damping),
            3 => Self::series::<3>(stiffness, damping),
            4 => Self::series::<4>(stiffness, damping),
            5 => Self::series::<5>(stiffness, damping),
            6 => Self::series::<6>(stiffness, damping),
            7 => Self::series::<7>(stiffness, damping),
            _ => Self::exponential(stiffness, damping),
        }
    }

    fn exponential(stiffness: &DMatrix<f64>, damping: &DMatrix<f64>) -> Self {
        let n = stiffness.nrows();
        let mut generator = DMatrix::zeros(3 * n, 3 * n);
        let unit = DMatrix::identity(n, n);
        generator.view_mut((0, n), (n, n)).copy_from(&unit);
        generator.view_mut((n, 0), (n, n)).copy_from(&-stiffness);
        generator.view_mut((n, n), (n, n)).copy_from(&-damping);
        generator.view_mut((n, 2 * n), (n, n)).copy_from(&unit);
        let flow = generator.exp();
        let block = |row: usize, column: usize| flow.view((row * n, column * n), (n, n)).into();
        Self {
            from_velocity: block(0, 1),
            from_force: block(0, 2),
            velocity_from_velocity: block(1, 1),
            velocity_from_force: block(1, 2),
        }
    }

    /// `x(s) = Σ cₖ sᵏ` over the step, from
    /// `cₖ₊₂ (k+2)(k+1) = -K cₖ - (k+1) D cₖ₊₁ (+ r for k = 0)`.
    fn series<const N: usize>(stiffness: &DMatrix<f64>, damping: &DMatrix<f64>) -> Self {
        let stiffness = SMatrix::<f64, N, N>::from_column_slice(stiffness.as_slice());
        let damping = SMatrix::<f64, N, N>::from_column_slice(damping.as_slice());
        let sums = |mut c: [SMatrix<f64, N, N>; 2], mut k: f64| {
            // `c` is of the powers k and k + 1.
            let mut position = c[0] + c[1];
            let mut velocity = c[0] * k + c[1] * (k + 1.0);
            for _ in 0..MOST_TERMS {
                let next = (stiffness * c[0] + damping * c[1] * (k + 1.0))
                    * (-1.0 / ((k + 2.0) * (k + 1.0)));
                k += 1.0;
                position += next;
                velocity += next * (k + 1.0);
                c = [c[1], next];
                // Both: without stiffness, or without damping, every other term is zero.
                if c[0].amax().max(c[1].amax()) * (k + 1.0) < f64::EPSILON * 1e-2 {
                    break;
                }
            }
            let dynamic = |m: SMatrix<f64, N, N>| DMatrix::from_column_slice(N, N, m.as_slice());
            (dynamic(position), dynamic(velocity))
        };
        let unit = SMatrix::<f64, N, N>::identity();
        let (from_velocity, velocity_from_velocity) = sums([SMatrix::zeros(), unit], 0.0);
        let second = unit * 0.5;
        let (from_force, velocity_from_force) = sums([SMatrix::zeros(), second], 1.0);
        Self {
            from_velocity,
            from_force,
            velocity_from_velocity,
            velocity_from_force,
        }
    }
}

/// Up to this size of `h² M⁻¹ K` and `h M⁻¹ D` together (largest column sums) terms of the series
/// fall from the start.
const MOST_FOR_SERIES: f64 = 2.0;
/// More than are needed at that size.
const MOST_TERMS: usize = 40;

fn one_norm(m: &DMatrix<f64>) -> f64 {
    let sums = m.column_iter().map(|column| column.lp_norm(1));
    sums.fold(0.0, f64::max)
}

fn solve(lu: &LU<f64, Dyn, Dyn>, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    lu.solve(right)
}

impl Recurrence {
    /// The recurrence of step `step_s` for symmetric positive definite `mass`; `None` if the mass
    /// matrix is singular or a step is a whole number of half periods of a mode.
    pub(super) fn new(
        mass: &DMatrix<f64>,
        damping: &DMatrix<f64>,
        stiffness: &DMatrix<f64>,
        step_s: f64,
    ) -> Option<Self> {
        let n = mass.nrows();
        let inverse = mass.clone().cholesky()?.inverse();
        let stiffness = &inverse * stiffness * (step_s * step_s);
        let damping = &inverse * damping * step_s;
        let ahead = Flow::new(&stiffness, &damping);
        let back = Flow::new(&stiffness, &-damping);
        let unit = DMatrix::identity(n, n);
        let velocity_from_mean = solve(&ahead.from_velocity.clone().lu(), &unit)?;
        let decay = &ahead.from_velocity * solve(&back.from_velocity.clone().lu(), &unit)?;
        // A constant r moves x by from_force h² M⁻¹ r: (flow - 1) x is the same with -K x for r.
        let gain = (&ahead.from_force + &decay * &back.from_force) * &inverse * step_s;
        Some(Self {
            mobility: &gain / step_s,
            velocity_from_force: -(&velocity_from_mean * &ahead.from_force) * &inverse * step_s,
            next_from_force: &ahead.velocity_from_force * &inverse * step_s,
            next_from_velocity: ahead.velocity_from_velocity,
            before_from_force: -(&back.from_force * &inverse) * step_s,
            before_from_velocity: back.from_velocity,
            velocity_from_mean,
            decay,
            gain,
            step_s,
        })
    }

    /// `out = Q u + G r`.
    pub(super) fn mean_velocity(&self, u: &DVector<f64>, r: &DVector<f64>, out: &mut DVector<f64>) {
        product(&self.decay, u, out);
        add_product(&self.gain, r, out);
    }

    /// Adds to `u` what the force `r` adds over a step.
    pub(super) fn add_force(&self, r: &DVector<f64>, u: &mut DVector<f64>) {
        add_product(&self.gain, r, u);
    }

    /// Change of `u` by a generalised impulse.
    pub(super) fn response(&self, impulse: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(impulse.len());
        add_product(&self.mobility, impulse, &mut out);
        out
    }

    /// Velocity at the instant from the mean velocity of the step ahead and the force at the
    /// instant.
    pub(super) fn velocity(&self, u: &DVector<f64>, r: &DVector<f64>, out: &mut DVector<f64>) {
        product(&self.velocity_from_mean, u, out);
        add_product(&self.velocity_from_force, r, out);
    }

    /// Velocity at the next instant, the force but for stiffness and damping being held.
    pub(super) fn next_velocity(&self, v: &DVector<f64>, r: &DVector<f64>, out: &mut DVector<f64>) {
        product(&self.next_from_velocity, v, out);
        add_product(&self.next_from_force, r, out);
    }

    /// Mean velocity over the step before the start, for a start at velocity `v` under `r`.
    pub(super) fn before_start(&self, v: &DVector<f64>, r: &DVector<f64>, out: &mut DVector<f64>) {
        product(&self.before_from_velocity, v, out);
        add_product(&self.before_from_force, r, out);
    }

    pub(super) fn step_s(&self) -> f64 {
        self.step_s
    }
}

fn product(m: &DMatrix<f64>, x: &DVector<f64>, out: &mut DVector<f64>) {
    out.fill(0.0);
    add_product(m, x, out);
}

/// `out += m x`, column by column: for matrices this small a general routine's overhead would
/// double the cost. Usual sizes are known to the compiler; all give the same sums in the same
/// order.
pub(super) fn add_product(m: &DMatrix<f64>, x: &DVector<f64>, out: &mut DVector<f64>) {
    let (m, x, out) = (m.as_slice(), x.as_slice(), out.as_mut_slice());
    match out.len() {
        1 => add_fixed::<1>(m, x, out),
        2 => add_fixed::<2>(m, x, out),
        3 => add_fixed::<3>(m, x, out),
        6 => add_fixed::<6>(m, x, out),
        7 => add_fixed::<7>(m, x, out),
        n => {
            for (column, factor) in m.chunks_exact(n).zip(x) {
                for (o, c) in out.iter_mut().zip(column) {
                    *o += c * factor;
                }
            }
        }
    }
}

fn add_fixed<const N: usize>(m: &[f64], x: &[f64], out: &mut [f64]) {
    let (columns, _) = m.as_chunks::<N>();
    let (Some(x), Some(out)) = (x.first_chunk::<N>(), out.first_chunk_mut::<N>()) else {
        return;
    };
    let mut sum = *out;
    for (column, factor) in columns.iter().zip(x) {
        for i in 0..N {
            sum[i] += column[i] * factor;
        }
    }
    *out = sum;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A damped oscillator, released: position and velocity at every instant, at steps up to
    /// several periods.
    #[test]
    fn verify_free_decay_is_exact_at_any_step() {
        let (m, omega, zeta, x0) = (100.0, 100.0f64, 0.02f64, 1e-3);
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        let one = |v: f64| DMatrix::from_element(1, 1, v);
        let k = m * omega * omega;
        for step_s in [1e-5, 2.5e-4, 1e-3, 7e-3, 0.0273, 0.1, 0.31] {
            let r = Recurrence::new(&one(m), &one(2.0 * zeta * omega * m), &one(k), step_s)
                .expect("a regular step");
            let mut x = DVector::from_element(1, x0);
            let mut u = DVector::zeros(1);
            let mut next = DVector::zeros(1);
            let mut velocity = DVector::zeros(1);
            let still = DVector::zeros(1);
            r.before_start(&still, &(-&x * k), &mut u);
            for i in 0..2000 {
                let t = i as f64 * step_s;
                let decay = x0 * (-zeta * omega * t).exp();
                let exact =
                    decay * ((damped * t).cos() + zeta * omega / damped * (damped * t).sin());
                let speed = -decay * omega * omega / damped * (damped * t).sin();
                let force = -&x * k;
                r.mean_velocity(&u, &force, &mut next);
                r.velocity(&next, &force, &mut velocity);
                assert!(
                    (x[0] - exact).abs() < 1e-9 * x0,
                    "{step_s} s, t = {t}: {} {exact}",
                    x[0]
                );
                assert!(
                    (velocity[0] - speed).abs() < 1e-9 * x0 * omega,
                    "{step_s} s, t = {t}: {} {speed}",
                    velocity[0]
                );
                x += &next * step_s;
                std::mem::swap(&mut u, &mut next);
            }
        }
    }

    /// Two masses with damping that is not proportional, against the exponential of the state
    /// matrix taken over the whole time at once.
    #[test]
    fn verify_coupled_damping_is_exact() {
        let mass = DMatrix::from_row_slice(2, 2, &[3.0, 0.4, 0.4, 1.5]);
        let damping = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, 20.0]);
        let stiffness = DMatrix::from_row_slice(2, 2, &[4e4, -1e4, -1e4, 3e4]);
        let inverse = mass.clone().try_inverse().expect("regular");
        let mut state = DMatrix::zeros(4, 4);
        state.view_mut((0, 2), (2, 2)).fill_with_identity();
        (state.view_mut((2, 0), (2, 2))).copy_from(&(-&inverse * &stiffness));
        (state.view_mut((2, 2), (2, 2))).copy_from(&(-&inverse * &damping));
        let start = DVector::from_column_slice(&[1e-3, -2e-3, 0.0, 0.0]);
        for step_s in [1e-3, 5e-3, 0.02] {
            let r = Recurrence::new(&mass, &damping, &stiffness, step_s).expect("regular");
            let mut x = start.rows(0, 2).into_owned();
            let (mut u, mut next) = (DVector::zeros(2), DVector::zeros(2));
            let still = DVector::zeros(2);
            r.before_start(&still, &(-&stiffness * &x), &mut u);
            let steps = 50;
            for _ in 0..steps {
                r.mean_velocity(&u, &(-&stiffness * &x), &mut next);
                x += &next * step_s;
                std::mem::swap(&mut u, &mut next);
            }
            let exact = (&state * (step_s * f64::from(steps))).exp() * &start;
            assert!((x - exact.rows(0, 2)).amax() < 1e-9 * 2e-3, "{step_s}");
        }
    }

    /// The series and the matrix exponential say the same, up to where the series ends.
    #[test]
    fn verify_series_and_exponential_agree() {
        let stiffness = DMatrix::from_row_slice(2, 2, &[0.7, -0.2, -0.5, 0.9]);
        let damping = DMatrix::from_row_slice(2, 2, &[0.3, 0.1, 0.05, 0.2]);
        for scale in [0.0_f64, 1e-6, 1e-2, 1.0] {
            for sign in [1.0, -1.0] {
                let (k, d) = (&stiffness * scale, &damping * (sign * scale.sqrt()));
                assert!(one_norm(&k) + one_norm(&d) < MOST_FOR_SERIES);
                let (a, b) = (Flow::series::<2>(&k, &d), Flow::exponential(&k, &d));
                for (a, b) in [
                    (&a.from_velocity, &b.from_velocity),
                    (&a.from_force, &b.from_force),
                    (&a.velocity_from_velocity, &b.velocity_from_velocity),
                    (&a.velocity_from_force, &b.velocity_from_force),
                ] {
                    assert!((a - b).amax() < 4e-15, "{scale} {sign}: {a} {b}");
                }
            }
        }
    }

    /// Without stiffness and damping a constant force gives the parabola, and the recurrence is the
    /// leapfrog's.
    #[test]
    fn verify_a_free_body_falls_on_a_parabola() {
        let zero = DMatrix::zeros(1, 1);
        let (m, h) = (7.0, 0.013);
        let r = Recurrence::new(&DMatrix::from_element(1, 1, m), &zero, &zero, h).expect("regular");
        let force = DVector::from_element(1, 3.0);
        let (mut x, mut u, mut next) = (0.0, DVector::zeros(1), DVector::zeros(1));
        let speed = DVector::from_element(1, -0.8);
        r.before_start(&speed, &force, &mut u);
        for i in 0..1000 {
            let t = f64::from(i) * h;
            assert!(
                (x + 0.8 * t - 0.5 * 3.0 / m * t * t).abs() < 1e-12 * (1.0 + x),
                "{t}"
            );
            r.mean_velocity(&u, &force, &mut next);
            assert!((next[0] - u[0] - h * 3.0 / m).abs() < 1e-12);
            x += h * next[0];
            std::mem::swap(&mut u, &mut next);
        }
    }
}
