//! First-order semi-discretisation (Insperger and Stépán, *Semi-Discretization for Time-Delay Systems*, 2011): Floquet
//! multipliers of n modes under a periodic regenerative cut.
//!
//! A tooth period T is cut into k steps. Within a step the directional matrix is its average over the step, the
//! delayed displacement runs straight from one stored value to the next, and the modes follow their exact solution.
//!
//! # How it is computed
//!
//! The period map is never formed. Its state is the 2n modal coordinates and velocities and, since forces depend on
//! where the tool point was and on nothing else, the k last positions of that point: one number each for a single mode,
//! two otherwise. One application costs k small products, and Arnoldi's method finds the dominant multiplier in some
//! twenty of them. Directional matrices depend on the angle only and are shared by all speeds and depths; steps in
//! which no tooth cuts are free motion, known in closed form.

use super::krylov::dominant_eigenvalue;
use super::{DirectionalMatrix, TipMode};
use nalgebra::{Complex, DMatrix};
use std::f64::consts::TAU;

/// How a solution behaves from one tooth period to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bifurcation {
    /// A complex pair: vibration at a frequency of its own.
    Hopf,
    /// A negative real multiplier: every other tooth alike, period doubling.
    Flip,
    /// A positive real multiplier.
    Fold,
}

/// The dominant Floquet multiplier over a tooth period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Multiplier {
    pub value: Complex<f64>,
}

impl Multiplier {
    /// |μ|; stable below 1.
    pub fn magnitude(&self) -> f64 {
        self.value.norm()
    }

    pub fn is_stable(&self) -> bool {
        self.magnitude() < 1.0
    }

    /// Kind of instability that this multiplier brings when it leaves the unit circle.
    pub fn bifurcation(&self) -> Bifurcation {
        if self.value.im.abs() > 1e-6 * self.magnitude() {
            Bifurcation::Hopf
        } else if self.value.re < 0.0 {
            Bifurcation::Flip
        } else {
            Bifurcation::Fold
        }
    }

    /// Growth rate of the vibration, 1/s: ln|μ| / T.
    pub fn growth_per_s(&self, tooth_period_s: f64) -> f64 {
        self.magnitude().ln() / tooth_period_s
    }

    /// Frequencies (rad/s) at which such a vibration may appear are this one, its mirror image and whole tooth-passing
    /// frequencies more: arg μ / T in [0, π/T].
    pub fn base_frequency_rad_s(&self, tooth_period_s: f64) -> f64 {
        self.value.arg().abs() / tooth_period_s
    }
}

/// Enough steps a tooth period to follow the fastest of the modes: twenty-four to its cycle, and forty at least.
pub fn recommended_steps(modes: &[TipMode], tooth_period_s: f64) -> usize {
    let fastest = modes
        .iter()
        .map(|m| m.natural_frequency_rad_s)
        .fold(0.0, f64::max);
    ((24.0 * fastest * tooth_period_s / TAU).ceil() as usize).max(40)
}

/// Modes and a cut, prepared for any speed and depth.
#[derive(Debug, Clone, PartialEq)]
pub struct SemiDiscretisation {
    modes: Vec<TipMode>,
    /// C, outputs × modes, row by row: what is remembered of the modal coordinates.
    outputs: Vec<f64>,
    output_count: usize,
    /// For each step, n × outputs row by row: modal force per depth and remembered displacement, Pa/kg in the scaling
    /// of C; empty where no tooth cuts.
    forces: Vec<Vec<f64>>,
}

impl SemiDiscretisation {
    /// `steps` is k, the number of steps in a tooth period; shapes are in the milling frame.
    ///
    /// # Panics
    /// If there are no modes or no steps.
    pub fn new(modes: &[TipMode], process: &DirectionalMatrix, steps: usize) -> Self {
        assert!(!modes.is_empty() && steps > 0, "modes and steps are needed");
        let n = modes.len();
        let shapes = DMatrix::from_fn(3, n, |r, c| modes[c].shape_per_sqrt_kg[r]);
        let planar = shapes.rows(0, 2).into_owned();
        let scale = planar.norm().max(f64::MIN_POSITIVE);
        let (output_count, outputs) = if n == 1 {
            (1, vec![1.0])
        } else {
            let rows = (0..2).flat_map(|r| (0..n).map(move |c| (r, c)));
            (2, rows.map(|at| planar[at] / scale).collect())
        };
        let pitch = TAU / process.teeth as f64;
        let forces = (0..steps).map(|i| {
            let angle = |i: usize| pitch * i as f64 / steps as f64;
            let matrix = process.average_between_pa(angle(i), angle(i + 1));
            if matrix.amax() == 0.0 {
                return Vec::new();
            }
            let modal = shapes.transpose() * DMatrix::from_fn(3, 3, |r, c| matrix[(r, c)]);
            let force = if n == 1 {
                &modal * &shapes
            } else {
                modal.columns(0, 2).into_owned() * scale
            };
            force.transpose().as_slice().to_vec()
        });
        Self {
            modes: modes.to_vec(),
            outputs,
            output_count,
            forces: forces.collect(),
        }
    }

    /// Steps in a tooth period.
    pub fn steps(&self) -> usize {
        self.forces.len()
    }

    /// Dominant multiplier over a tooth period of `tooth_period_s` at an axial depth of `depth_m`.
    pub fn multiplier(&self, tooth_period_s: f64, depth_m: f64) -> Multiplier {
        let map = PeriodMap::new(self, tooth_period_s, depth_m);
        let length = 2 * self.modes.len() + self.steps() * self.output_count;
        let mut work = Work::default();
        Multiplier {
            value: dominant_eigenvalue(length, |from, to| map.apply(from, to, &mut work)),
        }
    }
}

/// All steps of one tooth period at a speed and depth. Time runs in steps; the state is (q, dq per step).
struct PeriodMap<'a> {
    of: &'a SemiDiscretisation,
    /// Free motion of each mode over a step, 2×2 row by row.
    free: Vec<[f64; 4]>,
    /// For each cutting step, the 2n × (2n + 2·outputs) matrix that acts on state and both remembered positions, row by
    /// row; empty where the motion is free.
    steps: Vec<Vec<f64>>,
}

#[derive(Default)]
struct Work {
    state: Vec<f64>,
    next: Vec<f64>,
}

impl<'a> PeriodMap<'a> {
    fn new(of: &'a SemiDiscretisation, tooth_period_s: f64, depth_m: f64) -> Self {
        let h = tooth_period_s / of.steps() as f64;
        let rates: Vec<(f64, f64)> = of
            .modes
            .iter()
            .map(|m| {
                let omega = m.natural_frequency_rad_s * h;
                (omega * omega, 2.0 * m.damping_ratio * omega)
            })
            .collect();
        let mut taylor = Taylor::new(of, &rates);
        let steps = of.forces.iter().map(|force| {
            if force.is_empty() {
                return Vec::new();
            }
            let scaled: Vec<f64> = force.iter().map(|f| f * depth_m * h * h).collect();
            taylor.step(&scaled)
        });
        let steps = steps.collect();
        Self {
            of,
            free: rates.iter().map(|&(a, b)| free_step(a, b)).collect(),
            steps,
        }
    }

    /// One tooth period: `from` is the state and the k positions before it, oldest first; `to` likewise a period later.
    fn apply(&self, from: &[f64], to: &mut [f64], work: &mut Work) {
        let (n, d) = (self.of.modes.len(), self.of.output_count);
        let s = 2 * n;
        let (state, past) = from.split_at(s);
        let (end, recorded) = to.split_at_mut(s);
        work.state.clear();
        work.state.extend_from_slice(state);
        work.next.resize(s, 0.0);
        for (i, step) in self.steps.iter().enumerate() {
            self.record(&work.state, &mut recorded[i * d..(i + 1) * d]);
            if step.is_empty() {
                for (j, e) in self.free.iter().enumerate() {
                    let (q, v) = (work.state[j], work.state[n + j]);
                    work.state[j] = e[0] * q + e[1] * v;
                    work.state[n + j] = e[2] * q + e[3] * v;
                }
                continue;
            }
            let last = self.steps.len() - 1;
            let before = &past[i * d..(i + 1) * d];
            let after = if i < last {
                &past[(i + 1) * d..(i + 2) * d]
            } else {
                // The newest remembered position is where the period began.
                &recorded[..d]
            };
            for (row, out) in step.chunks_exact(s + 2 * d).zip(&mut work.next) {
                let (on_state, on_past) = row.split_at(s);
                let (on_before, on_after) = on_past.split_at(d);
                *out = product(on_state, &work.state)
                    + product(on_before, before)
                    + product(on_after, after);
            }
            std::mem::swap(&mut work.state, &mut work.next);
        }
        end.copy_from_slice(&work.state);
    }

    fn record(&self, state: &[f64], out: &mut [f64]) {
        let n = self.of.modes.len();
        for (row, out) in self.of.outputs.chunks_exact(n).zip(out) {
            *out = product(row, &state[..n]);
        }
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// exp of [[0, 1], [−a, −b]].
fn free_step(a: f64, b: f64) -> [f64; 4] {
    let inside = a - 0.25 * b * b;
    let decay = (-0.5 * b).exp();
    let root = inside.abs().sqrt();
    let (c, s) = if root < 1e-9 {
        (1.0, 1.0)
    } else if inside > 0.0 {
        (root.cos(), root.sin() / root)
    } else {
        (root.cosh(), root.sinh() / root)
    };
    [
        decay * (c + 0.5 * b * s),
        decay * s,
        -decay * a * s,
        decay * (c - 0.5 * b * s),
    ]
}

/// Exact solution of one cutting step by its Taylor series, which the short steps let converge fast.
struct Taylor<'a> {
    of: &'a SemiDiscretisation,
    rates: &'a [(f64, f64)],
    /// Columns of the current term: 2n of the identity's, `outputs` of the force's.
    term: Vec<f64>,
    /// Sums of A^m/m!, and of A^m B/(m+1)! and A^m B/(m+2)!, by columns.
    sum: Vec<f64>,
    force_sums: [Vec<f64>; 2],
    seen: Vec<f64>,
}

impl<'a> Taylor<'a> {
    fn new(of: &'a SemiDiscretisation, rates: &'a [(f64, f64)]) -> Self {
        let s = 2 * of.modes.len();
        let d = of.output_count;
        Self {
            of,
            rates,
            term: vec![0.0; s * (s + d)],
            sum: vec![0.0; s * s],
            force_sums: [vec![0.0; s * d], vec![0.0; s * d]],
            seen: vec![0.0; d],
        }
    }

    /// Rows of the step's matrix for forces `force` (n × outputs per step², row by row):
    /// y' = A y − B (z₀ (1 − τ) + z₁ τ) over τ = 0 … 1.
    fn step(&mut self, force: &[f64]) -> Vec<f64> {
        let n = self.of.modes.len();
        let (s, d) = (2 * n, self.of.output_count);
        self.start(force);
        for m in 1..40 {
            let factor = 1.0 / m as f64;
            let mut largest = 0.0_f64;
            for column in self.term.chunks_exact_mut(s) {
                advance(self.of, self.rates, force, &mut self.seen, column, factor);
                largest = column.iter().fold(largest, |l, x| l.max(x.abs()));
            }
            self.accumulate(m);
            if largest < 1e-17 {
                break;
            }
        }
        let width = s + 2 * d;
        let mut rows = vec![0.0; s * width];
        for r in 0..s {
            let row = &mut rows[r * width..(r + 1) * width];
            let (on_state, on_past) = row.split_at_mut(s);
            for (out, column) in on_state.iter_mut().zip(self.sum.chunks_exact(s)) {
                *out = column[r];
            }
            for c in 0..d {
                let at = c * s + r;
                let (whole, rising) = (self.force_sums[0][at], self.force_sums[1][at]);
                on_past[c] = rising - whole;
                on_past[d + c] = -rising;
            }
        }
        rows
    }

    fn start(&mut self, force: &[f64]) {
        let n = self.of.modes.len();
        let (s, d) = (2 * n, self.of.output_count);
        self.term.fill(0.0);
        for i in 0..s {
            self.term[i * s + i] = 1.0;
        }
        for c in 0..d {
            for r in 0..n {
                self.term[(s + c) * s + n + r] = force[r * d + c];
            }
        }
        self.sum.fill(0.0);
        self.force_sums.iter_mut().for_each(|sum| sum.fill(0.0));
        self.accumulate(0);
    }

    /// Adds the current term, A^m/m! and A^m B/m!, to the sums.
    fn accumulate(&mut self, m: usize) {
        let s = 2 * self.of.modes.len();
        let (identity, forced) = self.term.split_at(s * s);
        for (sum, term) in self.sum.iter_mut().zip(identity) {
            *sum += term;
        }
        let weights = [1.0 / (m + 1) as f64, 1.0 / ((m + 1) * (m + 2)) as f64];
        for (sums, weight) in self.force_sums.iter_mut().zip(weights) {
            for (sum, term) in sums.iter_mut().zip(forced) {
                *sum += weight * term;
            }
        }
    }
}

/// Replaces a column (q, v) by A (q, v) · factor: (v, −a q − b v + F C q).
fn advance(
    of: &SemiDiscretisation,
    rates: &[(f64, f64)],
    force: &[f64],
    seen: &mut [f64],
    column: &mut [f64],
    factor: f64,
) {
    let (n, d) = (of.modes.len(), of.output_count);
    let (q, v) = column.split_at_mut(n);
    for (row, out) in of.outputs.chunks_exact(n).zip(seen.iter_mut()) {
        *out = product(row, q);
    }
    for (j, &(a, b)) in rates.iter().enumerate() {
        let push = product(&force[j * d..(j + 1) * d], seen);
        let acceleration = push - a * q[j] - b * v[j];
        q[j] = v[j] * factor;
        v[j] = acceleration * factor;
    }
}

#[cfg(test)]
mod tests;
