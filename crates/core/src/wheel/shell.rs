//! How a rubber shell, thick or thin, is pressed onto a plane: elasticity of a hollow sphere.
//!
//! **Answer to a pressure.** A pressure `p_n P_n(cos θ)` on a hollow sphere, free inside, moves its
//! surface by `2R/(E* (n + ½)) M_n p_n P_n`; the exact solution has two terms that grow outwards
//! (powers n+1 and n-1 of the radius) and two that fall off (-n and -n-2), `lurie1964`. Against
//! opposite planes even n act. What a hollow sphere yields more than a solid one, `ΔM_n`, holds
//! bending, shear and stretching of the shell at any thickness; it falls off as exp(-2nh/R). The
//! solid sphere itself is taken as Hertz takes it, a half-space whose approach counts from afar
//! (counted from the equator it is 4 % stiffer at δ = R/100).
//!
//! **Air.** Gauge pressure p stretches the shell to the tension `N = p r²/2(R - h/2)`, r the inner
//! radius, Laplace's `pR/2` of a thin one. It stiffens what the shell adds:
//! `1/ΔM_n → 1/ΔM_n + 2N/(E*R) (n-1)(n+2)/(n+½)`; the tread on it yields as before.
//!
//! **Contact.** With the Hankel transform of the pressure `∫_0^a φ(t) cos kt dt`, `k = (n+½)/R`,
//! a patch of radius a on a plane at the approach δ has
//!
//! `φ(t) + ∫_0^a φ(τ) K(t,τ) dτ = E*/π (δ - t²/R)`, `K = 2/π Σ 2 ΔM_n cos kt cos kτ / R`,
//!
//! `φ(a) = 0` (no kink), and the force `2π ∫ φ dt`: the integral equation of a layered half-space
//! (`sneddon1966`), solved at Gauss's nodes. Without ΔM it is Hertz.
//!
//! **Bed.** A patch over edges needs a local bed (`bed`): Hertz's, times a factor that gives the
//! whole patch the force found here, beside the layer's tension.

use super::bed::Bed;
use super::patch::{Layer, Patch, Shape};
use crate::legendre::legendre;
use crate::roots::bisect;
use nalgebra::{DMatrix, Matrix2, Matrix4, Vector2, Vector4};
use std::f64::consts::{FRAC_1_PI, PI, SQRT_2};

/// Nodes over a patch.
const NODES: usize = 20;
/// Patches of the table, and the widest over the wheel's radius.
const PATCHES: usize = 40;
const WIDEST: f64 = 0.6;
/// Terms reach to so many times R/h: what follows is below 1e-6.
const TERMS: f64 = 9.0;
/// Largest degree of a term: shells down to R/150.
const LARGEST_DEGREE: usize = 1350;

/// `κ R/E*` of Hertz's bed (`bed`) of a ball.
pub(super) const HERTZ: f64 = 2.0 * SQRT_2 / PI;

/// A shell's dimensionless numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Proportions {
    /// Thickness over radius; 1 is solid.
    pub thickness: f64,
    pub poisson: f64,
    /// Tension over E* R.
    pub tension: f64,
}

/// A patch of the table: over the root of the approach, `x = √(δ/R)`, the radius over `R x` and the
/// factor of the bed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Row {
    x: f64,
    value: [f64; 2],
    slope: [f64; 2],
}

/// Contacts of a shell with a plane, as a table over the approach.
#[derive(Debug, Clone, PartialEq)]
pub struct Shell {
    rows: Vec<Row>,
}

/// A shell at an approach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pressed {
    /// Indentation of the bed over R, a²/2R².
    pub bed_indentation: f64,
    /// Its rate per rate of the approach.
    pub rate: f64,
    /// Stiffness of the bed over Hertz's.
    pub factor: f64,
}

impl Shell {
    pub(super) fn new(shell: &Proportions) -> Self {
        let terms = Terms::new(shell);
        let mut rows = vec![Row {
            value: [1.0, 1.0],
            ..Row::default()
        }];
        rows.extend((1..=PATCHES).map(|k| {
            let radius = WIDEST * (k as f64 / PATCHES as f64).powi(2);
            let [force, approach] = terms.contact(radius);
            let x = approach.sqrt();
            Row {
                x,
                value: [
                    radius / x,
                    factor(0.5 * radius * radius, force, shell.tension),
                ],
                slope: [0.0; 2],
            }
        }));
        rows[0].value[1] = rows[1].value[1];
        set_slopes(&mut rows);
        Self { rows }
    }

    /// At an approach over the radius, not below zero.
    pub(super) fn at(&self, approach: f64) -> Pressed {
        let x = approach.sqrt();
        let last = self.rows.len() - 2;
        let index = (self.rows.partition_point(|row| row.x <= x).max(1) - 1).min(last);
        let (a, b) = (&self.rows[index], &self.rows[index + 1]);
        let step = b.x - a.x;
        let t = (x - a.x) / step;
        let cubic = |i: usize| {
            if t > 1.0 {
                return [b.value[i] + b.slope[i] * (x - b.x), b.slope[i]];
            }
            let rise = b.value[i] - a.value[i];
            let (first, second) = (step * a.slope[i] - rise, rise - step * b.slope[i]);
            let value = a.value[i] + t * (rise + (1.0 - t) * ((1.0 - t) * first + t * second));
            let slope = rise + (1.0 - t) * (1.0 - 3.0 * t) * first + t * (2.0 - 3.0 * t) * second;
            [value, slope / step]
        };
        let [ratio, change] = cubic(0);
        Pressed {
            bed_indentation: 0.5 * approach * ratio * ratio,
            rate: 0.5 * ratio * (ratio + x * change),
            factor: cubic(1)[0].max(0.0),
        }
    }
}

/// The factor on Hertz's bed with which a patch of this bed indentation presses by `force`, radius
/// and E* being 1.
fn factor(bed_indentation: f64, force: f64, tension: f64) -> f64 {
    let hertz = 4.0 / 3.0 * (2.0 * bed_indentation).powf(1.5);
    let alone = force / hertz;
    if tension <= 0.0 {
        return alone;
    }
    let presses = |factor: f64| {
        let bed = Bed {
            shell_m_per_pa: 0.0,
            tread_m_per_pa2: 1.0 / (factor * HERTZ).powi(2),
            damping_pa_s_per_m: 0.0,
            tension_n_per_m: tension,
        };
        let shape = Shape::Point { radius_m: 1.0 };
        Patch::new(bed, Layer::Isotropic, shape, bed_indentation).free_force_n()
    };
    let [low, high] = bisect([1e-6 * alone, alone], 40, |factor| presses(factor) >= force);
    0.5 * (low + high)
}

/// Slopes of the parabolas through three rows each.
fn set_slopes(rows: &mut [Row]) {
    let last = rows.len() - 1;
    for k in 0..=last {
        let from = k.clamp(1, last - 1) - 1;
        let [a, b, c] = [rows[from], rows[from + 1], rows[from + 2]];
        for i in 0..2 {
            let first = (b.value[i] - a.value[i]) / (b.x - a.x);
            let second = (c.value[i] - b.value[i]) / (c.x - b.x);
            let bend = (second - first) / (c.x - a.x);
            rows[k].slope[i] = first + bend * (2.0 * rows[k].x - a.x - b.x);
        }
    }
}

/// `ΔM_n` of even degrees with the shell's tension: k R, and what it has in the sum.
struct Terms {
    rule: Vec<(f64, f64)>,
    terms: Vec<[f64; 2]>,
}

impl Terms {
    fn new(shell: &Proportions) -> Self {
        let rule = legendre(NODES);
        if shell.thickness >= 1.0 {
            let terms = Vec::new();
            return Self { rule, terms };
        }
        let reach = (TERMS / shell.thickness).ceil() as usize;
        let largest = reach.clamp(20, LARGEST_DEGREE);
        let term = |n: usize| {
            let n = n as f64;
            let yields =
                softness(n, shell.thickness, shell.poisson) - softness(n, 1.0, shell.poisson);
            let stiffened = 2.0 * shell.tension * ((n - 1.0) * (n + 2.0)).max(0.0) / (n + 0.5);
            [n + 0.5, 2.0 * yields / (1.0 + stiffened * yields)]
        };
        Self {
            rule,
            terms: (0..=largest).step_by(2).map(term).collect(),
        }
    }

    /// Force over E* R² and approach over R of a patch of this radius over R.
    fn contact(&self, radius: f64) -> [f64; 2] {
        let node = |(x, weight): &(f64, f64)| (0.5 * radius * (1.0 + x), 0.5 * radius * weight);
        let (t, weight): (Vec<f64>, Vec<f64>) = self.rule.iter().map(node).unzip();
        let mut system = DMatrix::<f64>::identity(NODES, NODES);
        // the last row: what the equation says at the rim
        let mut rim = [0.0; NODES];
        let mut cosines = [0.0; NODES];
        for [k, yields] in &self.terms {
            for (cosine, t) in cosines.iter_mut().zip(&t) {
                *cosine = (k * t).cos();
            }
            let share = 2.0 * FRAC_1_PI * yields;
            let at_rim = share * (k * radius).cos();
            for j in 0..NODES {
                let column = weight[j] * cosines[j];
                rim[j] += at_rim * column;
                for i in 0..NODES {
                    system[(i, j)] += share * cosines[i] * column;
                }
            }
        }
        let sides = DMatrix::from_fn(NODES, 2, |i, j| {
            FRAC_1_PI * if j == 0 { 1.0 } else { t[i] * t[i] }
        });
        let found = (system.lu().solve(&sides)).expect("a shell that yields to every pressure");
        let at_rim = |j: usize, side: f64| {
            side * FRAC_1_PI - (0..NODES).map(|i| rim[i] * found[(i, j)]).sum::<f64>()
        };
        let approach = at_rim(1, radius * radius) / at_rim(0, 1.0);
        let force = (0..NODES)
            .map(|i| weight[i] * (approach * found[(i, 0)] - found[(i, 1)]))
            .sum::<f64>();
        [2.0 * PI * force, approach]
    }
}

/// `M_n` of a hollow sphere (thickness over radius), or of a solid one, `lurie1964`. Radius and
/// shear modulus are 1.
fn softness(n: f64, thickness: f64, poisson: f64) -> f64 {
    let lame = 2.0 * poisson / (1.0 - 2.0 * poisson);
    let scale = (n + 0.5) / (1.0 - poisson);
    let inner = 1.0 - thickness;
    if n == 0.0 {
        // U = c r + d/r², no stress inside
        let (grows, falls) = (3.0 * lame + 2.0, 4.0);
        let hole = inner.powi(3);
        let (c, d) = (1.0 / grows, hole / falls);
        return scale * (c + d) / (1.0 - hole);
    }
    let degree = n * (n + 1.0);
    // radial and tangential displacement, radial and shear stress of the solution r^power
    let solution = |power: f64, [u, v]: [f64; 2]| {
        let stretched = 2.0 * u - degree * v;
        let radial = (lame + 2.0) * power * u + lame * stretched;
        Vector4::new(u, v, radial, (power - 1.0) * v + u)
    };
    let general = |power: f64| {
        let u = lame * degree - 2.0 * (1.0 - degree) - (power + 2.0) * (power - 1.0);
        let v = (lame + 1.0) * (power + 2.0) + 2.0;
        let size = u.hypot(v);
        solution(power, [u / size, v / size])
    };
    let growing = [
        (n + 1.0, general(n + 1.0)),
        (n - 1.0, solution(n - 1.0, [1.0, 1.0 / n])),
    ];
    if thickness >= 1.0 {
        let [a, b] = growing.map(|(_, s)| s);
        let stresses = Matrix2::new(a[2], b[2], a[3], b[3]);
        let parts = (stresses.lu().solve(&Vector2::new(1.0, 0.0))).unwrap_or_default();
        return scale * (a[0] * parts[0] + b[0] * parts[1]);
    }
    let falling = [
        (-n, general(-n)),
        (-n - 2.0, solution(-n - 2.0, [1.0, -1.0 / (n + 1.0)])),
    ];
    // growing ones are 1 at the outer radius, falling ones at the inner; stresses of a solution
    // go with one power less than its displacements
    let mut system = Matrix4::zeros();
    let mut moves = Vector4::zeros();
    for (column, (power, s)) in growing.iter().chain(&falling).enumerate() {
        let grows = *power > 0.0;
        let at_inner = if grows { inner.powf(power - 1.0) } else { 1.0 };
        let at_outer = if grows { 1.0 } else { inner.powf(1.0 - power) };
        for i in 0..2 {
            system[(i, column)] = s[2 + i] * at_inner;
            system[(2 + i, column)] = s[2 + i] * at_outer;
        }
        // displacement at the outer radius, of a falling one over the inner radius
        moves[column] = s[0] * at_outer;
    }
    let load = Vector4::new(0.0, 0.0, 1.0, 0.0);
    let parts = system.lu().solve(&load).unwrap_or_default();
    scale * moves.dot(&parts)
}
