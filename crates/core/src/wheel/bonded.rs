//! A cylinder on rubber bonded to a hub: the line contact of a layer on a rigid base.
//!
//! A layer of thickness h, bonded below and free of friction above, in plane strain, answers a
//! pressure `p cos kx` by a deflection `2 M(kh)/(E* k)` (`meijers1968`),
//!
//! `M(s) = (2K sinh 2s - 4s) / (2K cosh 2s + 4s² + 1 + K²)`, `K = 3 - 4ν`.
//!
//! Over a patch of half width b, with x in units of b, `p = E* b/2R √(1-x²) Σ a_n U_2n(x)` makes
//! the condition of contact a linear system,
//!
//! `a_m - 2 Σ_n (-1)^(m+n) (2n+1) I_mn a_n = δ_m0`,
//! `I_mn = ∫ (1 - M(s)) J_2n+1(sB) J_2m+1(sB) ds/s`, `B = b/h`,
//!
//! whose integrand falls off as `exp(-2s)`. The force per width is `a_0 π E* b²/4R`, `a_0` times
//! that of a half-space; the approach is `D b²/2R`,
//!
//! `D = 2 Σ (-1)^n (2n+1) a_n ∫ M(s) J_2n+1(sB) ds/(s² B)`.
//!
//! Both depend on B and ν alone. `ln a_0` and `D/a_0 + ln B` are analytic in B² and are taken from
//! Chebyshev sums over `ln(1 + B²)` up to B = 8; beyond it powers of B go on, as they do for thin
//! layers.

use crate::legendre::legendre;
use crate::roots::newton;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{LN_2, PI};

/// Terms of the pressure: what is left out is below 1e-7 of D at the widest patch.
const TERMS: usize = 16;
/// Nodes over s, and how far they reach; the integrands are there below 1e-11.
const NODES: usize = 128;
const LARGEST_S: f64 = 16.0;
/// Widest patch of the sums, in thicknesses.
const WIDEST: f64 = 8.0;
/// Terms of the Chebyshev sums: an error of 1e-8.
const CHEBYSHEV: usize = 20;
/// Smallest square of B in the table: a half width of 1 nm under a centimetre of rubber.
const SMALLEST_SQUARE: f64 = 1e-14;
/// Steps of the table, cubic between them: an error of 1e-7.
const STEPS: usize = 512;

/// What a patch is at an approach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bonded {
    /// Square of the half width over that of the thickness, B².
    pub square: f64,
    /// Rate of that per rate of `2 R d/h²`.
    pub rate: f64,
    /// Force over that of a half-space at the same half width, a_0.
    pub force_factor: f64,
}

/// One of the table's steps: logarithms of B² and a_0, and their slopes over that of the approach.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Knot {
    value: [f64; 2],
    slope: [f64; 2],
}

/// Line contact of a bonded layer of one Poisson's ratio, as a table over the approach.
#[derive(Debug, Clone, PartialEq)]
pub struct BondedLayer {
    from: f64,
    step: f64,
    knots: Vec<Knot>,
}

impl BondedLayer {
    /// The table for a Poisson's ratio between 0 and 0.5.
    pub fn new(poisson: f64) -> Self {
        let sums = Sums::new(poisson);
        let end = |square: f64| sums.at(square.ln()).0;
        let (from, to) = (end(SMALLEST_SQUARE), end(WIDEST * WIDEST));
        let step = (to - from) / STEPS as f64;
        let mut log_square = SMALLEST_SQUARE.ln();
        let knots = (0..=STEPS).map(|k| {
            let sought = from + step * k as f64;
            // ln(B² D) over ln B² is all but straight
            let mut slopes = [1.0, 0.0];
            log_square += newton(step, 1e-12, |off| {
                let (found, slope, _) = sums.at(log_square + off);
                (sought - found) / slope
            });
            let (_, slope, factor) = sums.at(log_square);
            slopes[0] /= slope;
            slopes[1] = factor[1] / slope;
            Knot {
                value: [log_square, factor[0]],
                slope: slopes,
            }
        });
        Self {
            from,
            step,
            knots: knots.collect(),
        }
    }

    /// The patch at an approach of `2 R d/h²`, above zero.
    pub fn at(&self, approach: f64) -> Bonded {
        let place = (approach.ln() - self.from) / self.step;
        let index = place.clamp(0.0, STEPS as f64 - 1.0) as usize;
        let t = place - index as f64;
        let (a, b) = (&self.knots[index], &self.knots[index + 1]);
        let value = |i: usize| {
            let (from, to) = (a.value[i], b.value[i]);
            let (leaves, comes) = (self.step * a.slope[i], self.step * b.slope[i]);
            if t < 0.0 {
                return from + t * leaves;
            }
            if t > 1.0 {
                return to + (t - 1.0) * comes;
            }
            let rise = to - from;
            let (first, second) = (leaves - rise, rise - comes);
            from + t * (rise + (1.0 - t) * ((1.0 - t) * first + t * second))
        };
        let within = t.clamp(0.0, 1.0);
        let slope = a.slope[0] + within * (b.slope[0] - a.slope[0]);
        let square = value(0).exp();
        Bonded {
            square,
            rate: square / approach * slope,
            force_factor: value(1).exp(),
        }
    }
}

/// Chebyshev sums of `ln a_0` and `D/a_0 + ln B` over `ln(1 + B²)`.
struct Sums {
    half: f64,
    coefficients: [[f64; 2]; CHEBYSHEV],
}

impl Sums {
    fn new(poisson: f64) -> Self {
        let kernel = Kernel::new(poisson);
        let half = 0.5 * (WIDEST * WIDEST).ln_1p();
        let angle = |k: usize| PI * (k as f64 + 0.5) / CHEBYSHEV as f64;
        let mut coefficients = [[0.0; 2]; CHEBYSHEV];
        for k in 0..CHEBYSHEV {
            let ratio = (half * (1.0 + angle(k).cos())).exp_m1().sqrt();
            let [a0, d] = kernel.patch(ratio);
            let values = [a0.ln(), d / a0 + ratio.ln()];
            for (n, sums) in coefficients.iter_mut().enumerate() {
                let share = if n == 0 { 1.0 } else { 2.0 } / CHEBYSHEV as f64;
                let weight = share * (n as f64 * angle(k)).cos();
                for (sum, value) in sums.iter_mut().zip(values) {
                    *sum += weight * value;
                }
            }
        }
        Self { half, coefficients }
    }

    /// At `ln B²`: `ln(B² D)`, its slope, and `ln a_0` with its slope.
    fn at(&self, log_square: f64) -> (f64, f64, [f64; 2]) {
        let square = log_square.exp();
        let x = square.ln_1p() / self.half - 1.0;
        let stretch = square / (1.0 + square) / self.half;
        // Clenshaw's recurrence, for the sums and their slopes
        let (mut sum, mut slope) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
        for c in self.coefficients.iter().skip(1).rev() {
            for i in 0..2 {
                let next = 2.0 * x * slope[i][0] - slope[i][1] + 2.0 * sum[i][0];
                slope[i] = [next, slope[i][0]];
                let next = 2.0 * x * sum[i][0] - sum[i][1] + c[i];
                sum[i] = [next, sum[i][0]];
            }
        }
        let first = self.coefficients[0];
        let value = |i: usize| x * sum[i][0] - sum[i][1] + first[i];
        let change = |i: usize| stretch * (sum[i][0] + x * slope[i][0] - slope[i][1]);
        let factor = [value(0), change(0)];
        let per_force = value(1) - 0.5 * log_square;
        (
            log_square + factor[0] + per_force.ln(),
            1.0 + factor[1] + (change(1) - 0.5) / per_force,
            factor,
        )
    }
}

/// `1 - M` at the nodes over s.
struct Kernel {
    /// s, its weight, and 1 - M(s).
    nodes: Vec<[f64; 3]>,
}

impl Kernel {
    fn new(poisson: f64) -> Self {
        let k = 3.0 - 4.0 * poisson;
        let node = |(x, weight): (f64, f64)| {
            let s = 0.5 * LARGEST_S * (1.0 + x);
            let below = 2.0 * k * (2.0 * s).cosh() + 4.0 * s * s + 1.0 + k * k;
            let rest = 2.0 * k * (-2.0 * s).exp() + 4.0 * s * (s + 1.0) + 1.0 + k * k;
            [s, 0.5 * LARGEST_S * weight, rest / below]
        };
        Self {
            nodes: legendre(NODES).into_iter().map(node).collect(),
        }
    }

    /// a_0 and D at a half width over the thickness.
    fn patch(&self, ratio: f64) -> [f64; 2] {
        let mut system = DMatrix::<f64>::identity(TERMS, TERMS);
        let mut approach = [0.0; TERMS];
        approach[0] = 0.5 * LN_2 + 0.25 - 0.5 * ratio.ln();
        for (n, value) in approach.iter_mut().enumerate().skip(1) {
            *value = 1.0 / (4 * n * (n + 1)) as f64;
        }
        let signed = |n: usize| if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        let order = |n: usize| (2 * n + 1) as f64;
        for [s, weight, rest] in &self.nodes {
            let j = odd_bessel(s * ratio);
            for (value, j) in approach.iter_mut().zip(j) {
                *value -= weight * rest * j / (s * s * ratio);
            }
            approach[0] += weight * 0.5 * (-s).exp() / s;
            for m in 0..TERMS {
                let row = 2.0 * signed(m) * weight * rest / s * j[m];
                for n in 0..TERMS {
                    system[(m, n)] -= row * signed(n) * order(n) * j[n];
                }
            }
        }
        let mut first = DVector::zeros(TERMS);
        first[0] = 1.0;
        let terms = (system.lu().solve(&first))
            .expect("a layer that answers every pressure by a deflection");
        let d: f64 = (0..TERMS)
            .map(|n| 2.0 * signed(n) * order(n) * terms[n] * approach[n])
            .sum();
        [terms[0], d]
    }
}

/// Bessel functions of odd order, J_1, J_3, …, at x > 0, by Miller's recurrence from far above.
fn odd_bessel(x: f64) -> [f64; TERMS] {
    let top = 2 * ((x.max(2.0 * TERMS as f64) as usize + 30) / 2 + 1);
    let (mut above, mut here, mut sum) = (0.0, 1e-250, 0.0);
    let mut odd = [0.0; TERMS];
    for order in (1..=top).rev() {
        // `here` is of this order
        if order.is_multiple_of(2) {
            sum += 2.0 * here;
        } else if order / 2 < TERMS {
            odd[order / 2] = here;
        }
        (above, here) = (here, 2.0 * order as f64 / x * here - above);
        if here.abs() > 1e200 {
            let scale = 1e-200;
            (above, here, sum) = (above * scale, here * scale, sum * scale);
            odd = odd.map(|j| j * scale);
        }
    }
    odd.map(|j| j / (sum + here))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Force per width, N/mm, and half width, mm.
    fn press(layer: &BondedLayer, [d, r, modulus, h]: [f64; 4]) -> [f64; 2] {
        let found = layer.at(2.0 * r * d / (h * h));
        let square = found.square * h * h;
        let hertz = PI * modulus * square / (4.0 * r);
        [found.force_factor * hertz, square.sqrt()]
    }

    /// Force in N/mm and half width in mm at an indentation (mm), relative radius (mm), contact
    /// modulus (MPa) and thickness (mm), by other solutions
    /// (`tests/crosscheck/truecut_reference/bonded.py`).
    #[test]
    fn verify_force_and_half_width_of_a_bonded_layer() {
        for (poisson, case, force, half_width) in [
            (0.48, [0.36, 30.0, 8.0, 15.0], 2.5246, 3.3893),
            (0.48, [0.5, 30.0, 8.0, 15.0], 3.9629, 4.1949),
            (0.3, [0.5, 30.0, 8.0, 15.0], 3.0349, 3.7267),
            (0.48, [0.1, 30.0, 8.0, 15.0], 0.48582, 1.5155),
            (0.48, [0.5, 30.0, 8.0, 8.0], 7.4243, 5.0888),
        ] {
            let [found, wide] = press(&BondedLayer::new(poisson), case);
            assert!((found / force - 1.0).abs() < 1e-4, "{case:?}: {found}");
            assert!((wide / half_width - 1.0).abs() < 1e-4, "{case:?}: {wide}");
        }
    }

    /// The table against the sums it is made from, between its knots.
    #[test]
    fn verify_the_table_is_the_layer() {
        for poisson in [0.0, 0.3, 0.48, 0.499] {
            let (layer, kernel) = (BondedLayer::new(poisson), Kernel::new(poisson));
            for ratio in [1e-5, 1e-3, 0.03, 0.2, 0.45, 0.9, 1.7, 3.3, 5.9, 7.7] {
                let [a0, d] = kernel.patch(ratio);
                let approach = ratio * ratio * d;
                let found = layer.at(approach);
                let off = [found.square / (ratio * ratio), found.force_factor / a0];
                assert!(
                    off.iter().all(|x| (x - 1.0).abs() < 1e-6),
                    "{ratio} {off:?}"
                );
                let h = 1e-4 * approach;
                let slope = layer.at(approach + h).square - layer.at(approach - h).square;
                let error = slope / (2.0 * h) / found.rate - 1.0;
                assert!(error.abs() < 1e-3, "{ratio}: {error}");
            }
        }
    }

    /// Thin layers: one that can be compressed is a bed of springs, `p = M u/h` with the confined
    /// modulus M, here E* (1-ν)²/(1-2ν); its patch is the chord, D = 1.
    #[test]
    fn verify_a_thin_compressible_layer_is_a_bed_of_springs() {
        let nu: f64 = 0.2;
        let confined = (1.0 - nu).powi(2) / (1.0 - 2.0 * nu);
        let mut last = [f64::INFINITY; 2];
        for ratio in [2.0, 4.0, 8.0] {
            let [a0, d] = Kernel::new(nu).patch(ratio);
            // force 2/3 M b³/(R h)
            let springs = 8.0 / (3.0 * PI) * confined * ratio;
            let off = [a0 / springs - 1.0, d - 1.0];
            assert!(
                off[0].abs() < 0.6 * last[0] && off[1] < 0.6 * last[1],
                "{off:?}"
            );
            last = off.map(f64::abs);
        }
        assert!(last[0] < 0.1 && last[1] < 0.05, "{last:?}");
    }

    /// Bessel functions of Abramowitz and Stegun's tables 9.1 and 9.4.
    #[test]
    fn verify_bessel_functions() {
        for (x, order, value) in [
            (1.0, 1, 0.440_050_585_744_93),
            (10.0, 1, 0.043_472_746_168_86),
            (10.0, 3, 0.058_379_379_305_19),
            (50.0, 1, -0.097_511_828_125_18),
            (1e-6, 1, 5e-7),
        ] {
            let found = odd_bessel(x)[order / 2];
            assert!((found - value).abs() < 1e-12, "{x} {order}: {found}");
        }
    }
}
