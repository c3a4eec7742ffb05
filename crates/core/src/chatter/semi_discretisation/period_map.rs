//! The map over one tooth period, step by step. Sizes are known to the compiler: that is what makes
//! it fast.

use super::super::krylov::dominant_eigenvalue;
use super::SemiDiscretisation;
use nalgebra::Complex;

/// Dominant eigenvalue of the period map.
pub(super) fn dominant_multiplier(
    of: &SemiDiscretisation,
    tooth_period_s: f64,
    depth_m: f64,
) -> Complex<f64> {
    macro_rules! by_modes {
        ($($n:literal)*) => {
            match of.modes.len() {
                1 => PeriodMap::<1, 1>::new(of, tooth_period_s, depth_m).dominant(),
                $($n => PeriodMap::<$n, 2>::new(of, tooth_period_s, depth_m).dominant(),)*
                n => unreachable!("{n} modes were refused"),
            }
        };
    }
    by_modes!(2 3 4 5 6 7 8 9 10 11 12)
}

/// Modal coordinates and their change per step.
#[derive(Debug, Clone, Copy)]
struct DelayState<const N: usize> {
    q: [f64; N],
    v: [f64; N],
}

impl<const N: usize> DelayState<N> {
    const ZERO: Self = Self {
        q: [0.0; N],
        v: [0.0; N],
    };

    fn add(&mut self, factor: f64, other: &Self) {
        for r in 0..N {
            self.q[r] += factor * other.q[r];
            self.v[r] += factor * other.v[r];
        }
    }

    fn largest(&self) -> f64 {
        let all = self.q.iter().chain(&self.v);
        all.fold(0.0, |largest, x| largest.max(x.abs()))
    }
}

/// Directional matrices that differ by no more than rounding, as in a slot with four teeth, share
/// one step.
const ALIKE: f64 = 1e-13;

/// One cutting step: what each coordinate, each rate and both remembered positions add to the next
/// state.
#[derive(Clone)]
struct CuttingStep<const N: usize, const D: usize> {
    from_q: [DelayState<N>; N],
    from_v: [DelayState<N>; N],
    from_before: [DelayState<N>; D],
    from_after: [DelayState<N>; D],
}

/// Modes in time steps, and what is remembered of them.
struct Oscillators<const N: usize, const D: usize> {
    /// (ωh)² and 2ζωh.
    rates: [(f64, f64); N],
    /// C, output by output.
    outputs: [[f64; N]; D],
    /// Displacement along the tool's axis per coordinate.
    heights: [f64; N],
}

/// Accelerations of the modes, in steps: per remembered position, and per displacement along the
/// tool's axis.
#[derive(Clone, Copy)]
struct Push<const N: usize, const D: usize> {
    remembered: [[f64; D]; N],
    floor: [f64; N],
}

/// All steps of one tooth period at a speed and depth. Time runs in steps.
pub(super) struct PeriodMap<const N: usize, const D: usize> {
    oscillators: Oscillators<N, D>,
    /// Free motion of each mode over a step, 2×2 row by row.
    free: [[f64; 4]; N],
    /// Empty where no tooth cuts.
    steps: Vec<Option<CuttingStep<N, D>>>,
}

impl<const N: usize, const D: usize> PeriodMap<N, D> {
    pub(super) fn new(of: &SemiDiscretisation, tooth_period_s: f64, depth_m: f64) -> Self {
        let h = tooth_period_s / of.steps() as f64;
        let rates = std::array::from_fn(|j| {
            let omega = of.modes[j].natural_frequency_rad_s * h;
            (omega * omega, 2.0 * of.modes[j].damping_ratio * omega)
        });
        let outputs = std::array::from_fn(|d| std::array::from_fn(|j| of.outputs[d * N + j]));
        let floor = of.floor.as_ref();
        let oscillators = Oscillators {
            rates,
            outputs,
            heights: floor.map_or([0.0; N], |f| std::array::from_fn(|j| f.heights[j])),
        };
        let mut steps: Vec<Option<CuttingStep<N, D>>> = Vec::with_capacity(of.steps());
        for (i, force) in of.forces.iter().enumerate() {
            let scale = depth_m * h * h;
            let push = || Push {
                remembered: std::array::from_fn(|j| {
                    // Where no tooth cuts nothing is listed.
                    std::array::from_fn(|d| force.get(j * D + d).map_or(0.0, |f| f * scale))
                }),
                floor: floor.map_or([0.0; N], |f| {
                    std::array::from_fn(|j| f.forces[i][j] * h * h)
                }),
            };
            let alike = |i: usize| {
                are_alike(&of.forces[i - 1], force)
                    && floor.is_none_or(|f| are_alike(&f.forces[i - 1], &f.forces[i]))
            };
            let is_free = force.is_empty()
                && floor.is_none_or(|f| f.forces[i].iter().all(|force| *force == 0.0));
            steps.push(if is_free {
                None
            } else if i > 0 && alike(i) {
                steps[i - 1].clone()
            } else {
                Some(oscillators.cutting_step(&push()))
            });
        }
        Self {
            free: rates.map(|(a, b)| free_step(a, b)),
            oscillators,
            steps,
        }
    }

    /// Length of the vector that the map acts on: the state, and one position for each step before
    /// it.
    pub(super) fn length(&self) -> usize {
        2 * N + self.steps.len() * D
    }

    fn dominant(&self) -> Complex<f64> {
        dominant_eigenvalue(self.length(), |from, to| self.apply(from, to))
    }

    /// One tooth period: `from` is the state and the k positions before it, oldest first; `to`
    /// likewise a period later.
    pub(super) fn apply(&self, from: &[f64], to: &mut [f64]) {
        let (start, past) = from.split_at(2 * N);
        let (end, recorded) = to.split_at_mut(2 * N);
        let mut state = DelayState {
            q: std::array::from_fn(|j| start[j]),
            v: std::array::from_fn(|j| start[N + j]),
        };
        let newest = self.oscillators.seen(&state.q);
        let position = |i: usize| -> [f64; D] {
            if i < self.steps.len() {
                std::array::from_fn(|d| past[i * D + d])
            } else {
                newest
            }
        };
        for (i, step) in self.steps.iter().enumerate() {
            let seen = self.oscillators.seen(&state.q);
            recorded[i * D..(i + 1) * D].copy_from_slice(&seen);
            state = match step {
                None => self.free_motion(&state),
                Some(step) => step.apply(&state, &position(i), &position(i + 1)),
            };
        }
        end[..N].copy_from_slice(&state.q);
        end[N..].copy_from_slice(&state.v);
    }

    fn free_motion(&self, state: &DelayState<N>) -> DelayState<N> {
        let mut next = DelayState::ZERO;
        for (j, e) in self.free.iter().enumerate() {
            next.q[j] = e[0] * state.q[j] + e[1] * state.v[j];
            next.v[j] = e[2] * state.q[j] + e[3] * state.v[j];
        }
        next
    }
}

impl<const N: usize, const D: usize> CuttingStep<N, D> {
    fn apply(&self, state: &DelayState<N>, before: &[f64; D], after: &[f64; D]) -> DelayState<N> {
        let mut next = DelayState::ZERO;
        for j in 0..N {
            next.add(state.q[j], &self.from_q[j]);
            next.add(state.v[j], &self.from_v[j]);
        }
        for d in 0..D {
            next.add(before[d], &self.from_before[d]);
            next.add(after[d], &self.from_after[d]);
        }
        next
    }
}

impl<const N: usize, const D: usize> Oscillators<N, D> {
    /// C q.
    fn seen(&self, q: &[f64; N]) -> [f64; D] {
        std::array::from_fn(|d| (0..N).map(|j| self.outputs[d][j] * q[j]).sum())
    }

    /// A (q, v) · factor = (v, −a q − b v + F C q + f z) · factor.
    fn derivative(&self, force: &Push<N, D>, column: &DelayState<N>, factor: f64) -> DelayState<N> {
        let seen = self.seen(&column.q);
        let height: f64 = (0..N).map(|j| self.heights[j] * column.q[j]).sum();
        let mut next = DelayState::ZERO;
        for (j, ((a, b), row)) in self.rates.iter().zip(&force.remembered).enumerate() {
            let push: f64 = row.iter().zip(&seen).map(|(f, s)| f * s).sum();
            let push = push + force.floor[j] * height;
            next.q[j] = column.v[j] * factor;
            next.v[j] = (push - a * column.q[j] - b * column.v[j]) * factor;
        }
        next
    }

    /// Exact solution of y' = A y − B (z₀ (1 − τ) + z₁ τ), B = (0, F), over τ = 0 … 1 by the Taylor
    /// series of e^A, ∫e^{A(1−τ)} dτ and ∫e^{A(1−τ)} τ dτ, which short steps let converge fast.
    /// Terms of the columns that start with a rate follow from those that start with a coordinate:
    /// A eᵥ = e_q − b eᵥ.
    fn cutting_step(&self, force: &Push<N, D>) -> CuttingStep<N, D> {
        let mut term_q = [DelayState::<N>::ZERO; N];
        let mut term_v = [DelayState::<N>::ZERO; N];
        for j in 0..N {
            term_q[j].q[j] = 1.0;
            term_v[j].v[j] = 1.0;
        }
        let (mut sum_q, mut sum_v) = (term_q, term_v);
        let mut whole = term_v;
        let mut rising = term_v.map(|column| {
            let mut half = DelayState::ZERO;
            half.add(0.5, &column);
            half
        });
        for m in 1..40_u32 {
            let factor = 1.0 / f64::from(m);
            let (next, after) = (1.0 / f64::from(m + 1), 1.0 / f64::from((m + 1) * (m + 2)));
            let mut largest = 0.0_f64;
            for j in 0..N {
                let mut column = DelayState::ZERO;
                column.add(factor, &term_q[j]);
                column.add(-factor * self.rates[j].1, &term_v[j]);
                term_v[j] = column;
                term_q[j] = self.derivative(force, &term_q[j], factor);
                sum_q[j].add(1.0, &term_q[j]);
                sum_v[j].add(1.0, &term_v[j]);
                whole[j].add(next, &term_v[j]);
                rising[j].add(after, &term_v[j]);
                largest = largest.max(term_q[j].largest()).max(term_v[j].largest());
            }
            if largest < 1e-17 {
                break;
            }
        }
        let mut step = CuttingStep {
            from_q: sum_q,
            from_v: sum_v,
            from_before: [DelayState::ZERO; D],
            from_after: [DelayState::ZERO; D],
        };
        for (j, pushes) in force.remembered.iter().enumerate() {
            for (d, push) in pushes.iter().enumerate() {
                step.from_before[d].add(*push, &rising[j]);
                step.from_before[d].add(-push, &whole[j]);
                step.from_after[d].add(-push, &rising[j]);
            }
        }
        step
    }
}

fn are_alike(a: &[f64], b: &[f64]) -> bool {
    let size = b.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= ALIKE * size)
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
