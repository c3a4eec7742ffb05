//! Depth limits of n modes under the averaged directional matrix: mode coupling, and regeneration
//! to zero order.
//!
//! With G(ω) the 3×3 receptance of the tool point and B the averaged matrix (Pa), the loop closes
//! where `det(I − a G(ω) (κ B + iω D)) = 0`, D what worn flanks add (Pa s), κ = 1 for teeth that
//! meet the nominal surface and κ = 1 − e^{−iωT} for teeth that meet the surface left one tooth
//! period earlier (`altintas1995`). Chips have no axial part, so the third columns of B and D are
//! zero and the determinant is that of a 2×2 block: `1 − a t + a² d`, t its trace and d its
//! determinant. Its imaginary part gives a = Im t/Im d, and what is left is one smooth real
//! function of ω, whose roots are the crossings. Nothing is assumed about proportional shapes,
//! orthogonal modes or light damping.

use super::{AveragedCut, TipMode};
use crate::roots::bisect;
use nalgebra::{Complex, DMatrix, Matrix2, Matrix3};
use std::f64::consts::TAU;

/// A depth at which a pair of eigenvalues reaches the imaginary axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Axial depth, m.
    pub depth_m: f64,
    /// Frequency there, Hz; 0 for static divergence.
    pub frequency_hz: f64,
}

/// Lowest depth at which mode coupling makes n damped modes unstable under the averaged matrix
/// `average` (axes of the shapes), teeth meeting the nominal surface. `None` if no depth does.
pub fn mode_coupling_limit(modes: &[TipMode], average: impl Into<AveragedCut>) -> Option<Crossing> {
    let fastest = fastest_rad_s(modes)?;
    let range = (slowest_rad_s(modes) * 0.02, fastest * 4.0);
    let scan = Scan::new(modes, &average.into(), range, 0.0);
    let hopf = scan.lowest_crossing();
    let divergence = scan.divergence_m().map(|depth_m| Crossing {
        depth_m,
        frequency_hz: 0.0,
    });
    lower(hopf, divergence)
}

/// Lowest depth at which regeneration makes n modes unstable at a tooth period, to zero order
/// (averaged matrix), m and Hz. Chatter frequencies are sought from a fiftieth of the lowest
/// natural frequency to four times the highest or one and a half times the tooth-passing frequency,
/// whichever is more; `None` if no depth is unstable there.
pub fn zero_order_limit(
    modes: &[TipMode],
    average: impl Into<AveragedCut>,
    tooth_period_s: f64,
) -> Option<Crossing> {
    let highest = (fastest_rad_s(modes)? * 4.0).max(1.5 * TAU / tooth_period_s);
    let range = (slowest_rad_s(modes) * 0.02, highest);
    zero_order_limit_within(modes, average, tooth_period_s, range)
}

/// As [`zero_order_limit`], with chatter frequencies from a range in rad/s.
pub fn zero_order_limit_within(
    modes: &[TipMode],
    average: impl Into<AveragedCut>,
    tooth_period_s: f64,
    range_rad_s: (f64, f64),
) -> Option<Crossing> {
    Scan::new(modes, &average.into(), range_rad_s, tooth_period_s).lowest_crossing()
}

/// Rightmost eigenvalue (1/s, imaginary part ≥ 0) of n damped modes under a cut of a depth, teeth
/// meeting the nominal surface: q̈ + 2ζω q̇ + ω² q = b Uᵀ(B U q + D U q̇). `None` without modes.
pub fn rightmost_per_s(
    modes: &[TipMode],
    average: impl Into<AveragedCut>,
    depth_m: f64,
) -> Option<Complex<f64>> {
    let average = average.into();
    let n = modes.len();
    let mut state = DMatrix::zeros(2 * n, 2 * n);
    for (i, row) in modes.iter().enumerate() {
        let omega = row.natural_frequency_rad_s;
        state[(i, n + i)] = 1.0;
        state[(n + i, i)] -= omega * omega;
        state[(n + i, n + i)] -= 2.0 * row.damping_ratio * omega;
        for (j, column) in modes.iter().enumerate() {
            let force = |matrix: &Matrix3<f64>| {
                depth_m
                    * row
                        .shape_per_sqrt_kg
                        .dot(&(matrix * column.shape_per_sqrt_kg))
            };
            state[(n + i, j)] += force(&average.on_position_pa);
            state[(n + i, n + j)] += force(&average.on_rate_pa_s);
        }
    }
    let eigenvalues = state.complex_eigenvalues();
    let rightmost = eigenvalues.iter().max_by(|a, b| a.re.total_cmp(&b.re));
    rightmost.map(|e| Complex::new(e.re, e.im.abs()))
}

fn fastest_rad_s(modes: &[TipMode]) -> Option<f64> {
    let frequencies = modes.iter().map(|m| m.natural_frequency_rad_s);
    frequencies.max_by(f64::total_cmp)
}

fn slowest_rad_s(modes: &[TipMode]) -> f64 {
    let frequencies = modes.iter().map(|m| m.natural_frequency_rad_s);
    frequencies.fold(f64::INFINITY, f64::min)
}

fn lower(a: Option<Crossing>, b: Option<Crossing>) -> Option<Crossing> {
    let found = a.into_iter().chain(b);
    found.min_by(|a, b| a.depth_m.total_cmp(&b.depth_m))
}

/// Trace and determinant of the loop's 2×2 block at one frequency, per depth and its square.
#[derive(Debug, Clone, Copy)]
struct Loop {
    trace: Complex<f64>,
    determinant: Complex<f64>,
}

/// The loop on a grid of frequencies, dense about each mode.
struct Scan<'a> {
    modes: &'a [TipMode],
    /// For mode j, (u uᵀ B) cut to 2×2, Pa/kg, and the same of what depends on velocities, Pa s/kg.
    residues: Vec<[Matrix2<f64>; 2]>,
    grid_rad_s: Vec<f64>,
    delay_s: f64,
    /// The determinant vanishes: one direction only.
    one_direction: bool,
}

impl<'a> Scan<'a> {
    fn new(
        modes: &'a [TipMode],
        average: &AveragedCut,
        (from_rad_s, to_rad_s): (f64, f64),
        delay_s: f64,
    ) -> Self {
        let residue = |mode: &TipMode, matrix: &Matrix3<f64>| -> Matrix2<f64> {
            let u = mode.shape_per_sqrt_kg;
            (u * (u.transpose() * matrix))
                .fixed_view::<2, 2>(0, 0)
                .into_owned()
        };
        let residues = modes.iter().map(|mode| {
            [
                residue(mode, &average.on_position_pa),
                residue(mode, &average.on_rate_pa_s),
            ]
        });
        let mut scan = Self {
            modes,
            residues: residues.collect(),
            grid_rad_s: grid(modes, from_rad_s, to_rad_s, delay_s),
            delay_s,
            one_direction: false,
        };
        let mut largest = (0.0_f64, 0.0_f64);
        for &omega in &scan.grid_rad_s {
            let at = scan.at(omega);
            largest.0 = largest.0.max(at.determinant.norm());
            largest.1 = largest.1.max(at.trace.norm_sqr());
        }
        scan.one_direction = largest.0 <= 1e-12 * largest.1;
        scan
    }

    /// Σ g_j (κ R_j + iω S_j), R_j of positions and S_j of velocities.
    fn at(&self, omega_rad_s: f64) -> Loop {
        let kappa = if self.delay_s > 0.0 {
            Complex::new(1.0, 0.0) - Complex::from_polar(1.0, -omega_rad_s * self.delay_s)
        } else {
            Complex::new(1.0, 0.0)
        };
        let mut sum = Matrix2::<Complex<f64>>::zeros();
        for (mode, [position, rate]) in self.modes.iter().zip(&self.residues) {
            let g = mode.receptance_s2(omega_rad_s);
            let rate = rate * omega_rad_s;
            sum += position.zip_map(&rate, |p, r| g * (kappa * p + Complex::new(0.0, r)));
        }
        Loop {
            trace: sum.m11 + sum.m22,
            determinant: sum.m11 * sum.m22 - sum.m12 * sum.m21,
        }
    }

    /// The real function whose roots are the crossings (scaled to the size
    /// of its terms), and the depth there (m) if it is a root.
    fn resultant(&self, omega_rad_s: f64) -> (f64, f64) {
        let Loop {
            trace: t,
            determinant: d,
        } = self.at(omega_rad_s);
        if self.one_direction {
            return (t.im, 1.0 / t.re);
        }
        let value = d.im * d.im - t.im * t.re * d.im + t.im * t.im * d.re;
        let size = d.norm_sqr() + t.norm_sqr() * d.norm();
        (value / size, t.im / d.im)
    }

    fn lowest_crossing(&self) -> Option<Crossing> {
        let value = |omega: f64| self.resultant(omega).0;
        let values: Vec<f64> = self.grid_rad_s.iter().map(|w| value(*w)).collect();
        let mut lowest = None;
        let mut bracket = |from: f64, to: f64, from_positive: bool| {
            let root = self.refine(from, to, from_positive);
            lowest = lower(lowest, self.crossing(root));
        };
        for (w, v) in self.grid_rad_s.windows(2).zip(values.windows(2)) {
            if (v[0] > 0.0) != (v[1] > 0.0) {
                bracket(w[0], w[1], v[0] > 0.0);
            }
        }
        // Two roots between grid points show as a dip of the size, unless it is no more than the
        // grid's coarseness.
        for (w, v) in self.grid_rad_s.windows(3).zip(values.windows(3)) {
            let sign = v[1].signum();
            let alike = v.iter().all(|v| v.signum() == sign);
            if !alike || v[1].abs() > v[0].abs() || v[1].abs() > v[2].abs() {
                continue;
            }
            let dip = lowest_point(|omega| sign * value(omega), w[0], w[2]);
            if sign * value(dip) < 0.0 {
                bracket(w[0], dip, sign > 0.0);
                bracket(dip, w[2], sign < 0.0);
            }
        }
        lowest
    }

    fn crossing(&self, omega_rad_s: f64) -> Option<Crossing> {
        let depth_m = self.resultant(omega_rad_s).1;
        let real = depth_m > 0.0 && depth_m.is_finite();
        (real && self.closes(omega_rad_s, depth_m)).then_some(Crossing {
            depth_m,
            frequency_hz: omega_rad_s / TAU,
        })
    }

    fn refine(&self, low: f64, high: f64, low_positive: bool) -> f64 {
        let [low, high] = bisect([low, high], 48, |omega| {
            (self.resultant(omega).0 > 0.0) != low_positive
        });
        0.5 * (low + high)
    }

    /// Whether the determinant is zero there, and not only its resultant (which also vanishes with
    /// κ or with both imaginary parts).
    fn closes(&self, omega_rad_s: f64, depth_m: f64) -> bool {
        let at = self.at(omega_rad_s);
        let first = at.trace * depth_m;
        let second = at.determinant * depth_m * depth_m;
        let rest = Complex::new(1.0, 0.0) - first + second;
        rest.norm() <= 1e-6 * (1.0 + first.norm() + second.norm())
    }

    /// Smallest positive root of 1 − a t(0) + a² d(0), m.
    fn divergence_m(&self) -> Option<f64> {
        let at = self.at(0.0);
        let (t, d) = (at.trace.re, at.determinant.re);
        if self.one_direction || d == 0.0 {
            return Some(1.0 / t).filter(|a| *a > 0.0);
        }
        let discriminant = t * t - 4.0 * d;
        if discriminant < 0.0 {
            return None;
        }
        let q = 0.5 * (t + t.signum() * discriminant.sqrt());
        let roots = [q / d, 1.0 / q];
        let positive = roots.into_iter().filter(|a| a.is_finite() && *a > 0.0);
        positive.min_by(f64::total_cmp)
    }
}

/// Where a function with one minimum between two points is lowest (golden section).
fn lowest_point(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const SHARE: f64 = 0.381_966_011_250_105_1;
    let (mut low, mut high) = (from, to);
    for _ in 0..32 {
        let width = high - low;
        if f(low + SHARE * width) < f(high - SHARE * width) {
            high -= SHARE * width;
        } else {
            low += SHARE * width;
        }
    }
    0.5 * (low + high)
}

/// Frequencies, rising, rad/s: even in the logarithm, clusters about each mode in units of its
/// half-width, and fine enough for the turns of e^{−iωT}.
fn grid(modes: &[TipMode], from_rad_s: f64, to_rad_s: f64, delay_s: f64) -> Vec<f64> {
    const EVEN: usize = 160;
    const PER_TURN: f64 = 48.0;
    let mut grid = Vec::new();
    let ratio = (to_rad_s / from_rad_s).powf(1.0 / EVEN as f64);
    let mut omega = from_rad_s;
    while omega < to_rad_s {
        grid.push(omega);
        let step = omega * (ratio - 1.0);
        let finest = if delay_s > 0.0 {
            TAU / delay_s / PER_TURN
        } else {
            f64::INFINITY
        };
        omega += step.min(finest);
    }
    for mode in modes {
        let width = mode.damping_ratio.max(1e-4) * mode.natural_frequency_rad_s;
        for i in -24..=24_i32 {
            // Dense within a few half-widths, thinning outwards to thirty of them.
            let x = f64::from(i) / 24.0;
            let offset = width * (3.0 * x + 27.0 * x.powi(3));
            let omega = mode.natural_frequency_rad_s + offset;
            if omega > from_rad_s && omega < to_rad_s {
                grid.push(omega);
            }
        }
    }
    grid.sort_by(f64::total_cmp);
    grid
}

#[cfg(test)]
mod tests;
