//! One bristle: an elastica that is clamped in the hub and held at its tip.
//!
//! Pressed in by δ under the normal force n along itself and friction μn across, it bends by
//! `EI θ'' = -n (sin θ + μ cos θ)`, θ = 0 in the hub, θ' = 0 at the tip. With φ = θ + ψ, ψ = atan
//! μ, this is a pendulum, `EI φ'' = -P sin φ`, `n = P cos ψ`, which swings from ψ to its rest at α:
//! with `k = sin(α/2)`, `sin(φ/2) = k sin u`, `sin u₀ = sin(ψ/2)/k`
//!
//! `L √(P/EI) = ∫ du/√(1 - k² sin² u)`, `δ = ∫ (1 - cos θ) ds`, from u₀ to π/2 (Love, A Treatise on
//! the Mathematical Theory of Elasticity, 4th ed., art. 262).
//!
//! As δ → 0 this is the end-loaded cantilever and Euler's load beside each other,
//! `n = N/(1 + N μL²/(3EI Y))`, `N = π²EI/4L²`, `Y = √(5Lδ/3)`; the force is kept as a ratio to
//! that.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::{Arc, LazyLock};

use crate::legendre::legendre;
use crate::roots::illinois;

/// Intervals of the table, even in √δ; between them the ratio is linear, within 1.2e-4.
const INTERVALS: usize = 128;
/// Width to which the tip's inclination is found, relative.
const NARROWED: f64 = 1e-13;

/// Nodes on `[-1, 1]`; the integrands are smooth.
static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| legendre(16));

/// The law of a brush's bristles.
#[derive(Debug, Clone, PartialEq)]
pub struct Bristle {
    length_m: f64,
    /// EI/L², N.
    unit_n: f64,
    mu: f64,
    /// Shortening over length at which the tip lies along the face.
    lying: f64,
    /// Force over [`slight`] at even steps of √δ up to [`Self::lying`].
    ratio: Arc<[f64]>,
}

impl Bristle {
    /// Of a free length (m), a bending stiffness (N m²), with a coefficient of friction at its tip.
    #[must_use]
    pub fn new(length_m: f64, bending_n_m2: f64, mu: f64) -> Self {
        let [_, lying] = held(FRAC_PI_2 + mu.atan(), mu);
        Self {
            length_m,
            unit_n: bending_n_m2 / (length_m * length_m),
            mu,
            lying,
            ratio: ratios(mu, lying),
        }
    }

    /// Shortening from which its tip would lie along the face, m: the law ends there.
    #[must_use]
    pub fn lying_m(&self) -> f64 {
        self.lying * self.length_m
    }

    /// Force with which the bristle presses along itself when it is shortened, N. One that is
    /// shortened further than [`Self::lying_m`] keeps the ratio to slight bending that it has
    /// there.
    #[must_use]
    pub fn force_n(&self, shortening_m: f64) -> f64 {
        if shortening_m <= 0.0 {
            return 0.0;
        }
        let shortening = shortening_m / self.length_m;
        let place = INTERVALS as f64 * (shortening / self.lying).sqrt().min(1.0);
        let below = (place as usize).min(INTERVALS - 1);
        let part = place - below as f64;
        let ratio = self.ratio[below] * (1.0 - part) + self.ratio[below + 1] * part;
        self.unit_n * slight(shortening, self.mu) * ratio
    }
}

/// Force in EI/L² of a bristle that is bent slightly; the shortening is over its length.
fn slight(shortening: f64, mu: f64) -> f64 {
    let euler = PI * PI / 4.0;
    euler / (1.0 + euler * mu / (3.0 * (5.0 / 3.0 * shortening).sqrt()))
}

/// Force in EI/L² and shortening over length of a bristle whose tip inclines to α - atan μ.
fn held(alpha: f64, mu: f64) -> [f64; 2] {
    let psi = mu.atan();
    let k = (0.5 * alpha).sin();
    let first = ((0.5 * psi).sin() / k).min(1.0).asin();
    let half = 0.5 * (FRAC_PI_2 - first);
    let (mut length, mut shorter) = (0.0, 0.0);
    for (node, weight) in RULE.iter() {
        let sine = k * (first + half * (1.0 + node)).sin();
        let cosine = (1.0 - sine * sine).sqrt();
        let ds = half * weight / cosine;
        // of θ/2: 1 - cos θ does not cancel
        let turned = sine * (0.5 * psi).cos() - cosine * (0.5 * psi).sin();
        length += ds;
        shorter += 2.0 * turned * turned * ds;
    }
    [length * length * psi.cos(), shorter / length]
}

fn ratios(mu: f64, lying: f64) -> Arc<[f64]> {
    let (from, to) = (mu.atan(), FRAC_PI_2 + mu.atan());
    let at = |i: usize| lying * (i as f64 / INTERVALS as f64).powi(2);
    let mut alpha = from;
    let ratio = |i: usize| {
        if i == 0 {
            return 1.0;
        }
        let shortening = at(i);
        let mut force = held(to, mu)[0];
        let ends = [shortening - at(i - 1), shortening - lying];
        illinois([alpha, to], ends, NARROWED, |trial| {
            let [n, shortened] = held(trial, mu);
            (alpha, force) = (trial, n);
            shortening - shortened
        });
        force / slight(shortening, mu)
    };
    (0..=INTERVALS).map(ratio).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Shooting from the tip by Runge and Kutta's rule: force and shortening of a bristle whose tip
    /// turns by an angle.
    fn shot(tip_rad: f64, mu: f64) -> [f64; 2] {
        const STEPS: usize = 2000;
        let h = 1.0 / STEPS as f64;
        let along = |n: f64| {
            let rates = |[angle, bend, _]: [f64; 3]| {
                [
                    bend,
                    -n * (angle.sin() + mu * angle.cos()),
                    1.0 - angle.cos(),
                ]
            };
            let mut y = [tip_rad, 0.0, 0.0];
            for _ in 0..STEPS {
                let moved = |k: [f64; 3], part: f64| [0, 1, 2].map(|i| y[i] + part * h * k[i]);
                let a = rates(y);
                let b = rates(moved(a, 0.5));
                let c = rates(moved(b, 0.5));
                let d = rates(moved(c, 1.0));
                y = [0, 1, 2].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
            }
            y
        };
        let [mut low, mut high] = [0.0, 6.0];
        for _ in 0..60 {
            let n = 0.5 * (low + high);
            *(if along(n)[0] > 0.0 {
                &mut low
            } else {
                &mut high
            }) = n;
        }
        [low, along(low)[2]]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        /// The equation integrated by another rule, at random friction and inclination.
        #[test]
        fn verify_the_elastica_by_shooting(tip_rad in 0.02..1.5f64, mu in 0.0..1.0f64) {
            let [force, shortening] = shot(tip_rad, mu);
            let found = Bristle::new(1.0, 1.0, mu).force_n(shortening);
            prop_assert!((found / force - 1.0).abs() < 3e-4, "{shortening} {found} {force}");
        }
    }

    #[test]
    fn verify_frictionless_bristle_buckles_at_eulers_load() {
        let (length_m, bending) = (25e-3, 2e-5);
        let bristle = Bristle::new(length_m, bending, 0.0);
        let euler = PI * PI / 4.0 * bending / length_m.powi(2);
        assert!((bristle.force_n(1e-9) / euler - 1.0).abs() < 1e-4);
        assert_eq!(bristle.force_n(-1e-3), 0.0);
    }

    /// μn = 3EI Y/L³.
    #[test]
    fn verify_a_hardly_bent_bristle_is_a_cantilever() {
        let mu = 0.5;
        let shortening = 1e-9_f64;
        let tip = (5.0 / 3.0 * shortening).sqrt();
        let found = Bristle::new(1.0, 1.0, mu).force_n(shortening);
        assert!((mu * found / (3.0 * tip) - 1.0).abs() < 1e-3);
    }
}
