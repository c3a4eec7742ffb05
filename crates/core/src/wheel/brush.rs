//! A wheel brush of nylon wires.
//!
//! **One bristle.** A cantilever of free length L and bending stiffness EI whose tip is held on the
//! workpiece: pressed in by δ it must shorten, so it bends. With the deflection of an end-loaded
//! cantilever, `y = Y (3s² - s³)/2`, the shortening is `∫½y'² = (3/5) Y²/L`, so `Y = √(5Lδ/3)`.
//! Virtual work of the tip, normal force n and friction μn along its drag:
//! `3EI Y/L³ = n (6/5) Y/L + μ n`, hence
//!
//! `n(δ) = (5EI / 2L²) / (1 + 5μL/(6Y))`.
//!
//! Without friction that is the buckling load of a cantilever (2.5 EI/L²; Euler's is π²/4 = 2.467),
//! constant in δ: a brush is soft. Friction bends the bristle before it buckles, and then `n ∝ √δ`
//! at first. Holds for δ up to about a fifth of L. Bristles do not touch each other, and their
//! inertia is left out.
//!
//! **The brush.** Bristles stand evenly over the running surface `2πR W`; over a flat face they
//! indent it by `δ(x) = d - x²/2R`. Its contact is as long as the chord, many times a rubber
//! wheel's.

use super::quadrature::Quadrature;
use std::f64::consts::{FRAC_PI_2, PI};

/// Brush and its bristles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Brush {
    /// Radius to the tips, m.
    pub radius_m: f64,
    pub width_m: f64,
    /// Number of bristles.
    pub bristles: f64,
    pub bristle_diameter_m: f64,
    /// Free length of a bristle, m.
    pub free_length_m: f64,
    /// Young's modulus of the wire, Pa.
    pub youngs_modulus_pa: f64,
    /// Friction coefficient of tips.
    pub mu: f64,
}

impl Brush {
    /// Normal force of one bristle shortened by `shortening_m`, N.
    pub fn bristle_n(&self, shortening_m: f64) -> f64 {
        if shortening_m <= 0.0 {
            return 0.0;
        }
        let length = self.free_length_m;
        let tip = (5.0 / 3.0 * length * shortening_m).sqrt();
        self.buckling_n() / (1.0 + 5.0 * self.mu * length / (6.0 * tip))
    }

    /// Force of a bristle without friction, `5EI/2L²`, N.
    pub fn buckling_n(&self) -> f64 {
        let bending = self.youngs_modulus_pa * PI / 64.0 * self.bristle_diameter_m.powi(4);
        2.5 * bending / (self.free_length_m * self.free_length_m)
    }

    /// Half the length of the contact, `√(2Rd)`, m.
    pub fn half_length_m(&self, indentation_m: f64) -> f64 {
        (2.0 * self.radius_m * indentation_m.max(0.0)).sqrt()
    }

    /// Mean pressure at a distance from the middle along the run, Pa.
    pub fn pressure_pa(&self, indentation_m: f64, x: f64) -> f64 {
        let per_area = self.bristles / (2.0 * PI * self.radius_m * self.width_m);
        per_area * self.bristle_n(indentation_m - x * x / (2.0 * self.radius_m))
    }

    /// Normal force on a flat face, N, of the part of the contact between `from` and `to` (m from
    /// its middle, along the run): a face that ends there bears the bristles on it only, since no
    /// layer joins them.
    pub fn normal_force_n(
        &self,
        indentation_m: f64,
        from_m: f64,
        to_m: f64,
        quadrature: &Quadrature,
    ) -> f64 {
        let half = self.half_length_m(indentation_m);
        if half <= 0.0 {
            return 0.0;
        }
        let angle = |x: f64| (x / half).clamp(-1.0, 1.0).asin();
        let (from, to) = (angle(from_m), angle(to_m));
        debug_assert!((-FRAC_PI_2..=FRAC_PI_2).contains(&from));
        self.width_m
            * quadrature.integrate(from, to, |phi| {
                self.pressure_pa(indentation_m, half * phi.sin()) * half * phi.cos()
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn brush() -> Brush {
        Brush {
            radius_m: 60e-3,
            width_m: 20e-3,
            bristles: 8000.0,
            bristle_diameter_m: 0.5e-3,
            free_length_m: 25e-3,
            youngs_modulus_pa: 3e9,
            mu: 0.3,
        }
    }

    #[test]
    fn verify_frictionless_bristle_buckles_within_two_percent_of_euler() {
        let b = Brush { mu: 0.0, ..brush() };
        let bending = b.youngs_modulus_pa * PI / 64.0 * b.bristle_diameter_m.powi(4);
        let euler = PI * PI / 4.0 * bending / b.free_length_m.powi(2);
        for d in [1e-5, 1e-3] {
            assert!((b.bristle_n(d) / euler - 1.0).abs() < 0.02);
        }
        assert_eq!(b.bristle_n(-1e-3), 0.0);
    }

    /// The force is the slope of the bristle's energy plus what friction takes,
    /// `n dδ = dU - μ n dY`.
    #[test]
    fn verify_work_of_the_tip_is_bending_energy_less_friction() {
        let b = brush();
        let bending = b.youngs_modulus_pa * PI / 64.0 * b.bristle_diameter_m.powi(4);
        let tip = |d: f64| (5.0 / 3.0 * b.free_length_m * d).sqrt();
        let energy = |d: f64| 1.5 * bending * tip(d).powi(2) / b.free_length_m.powi(3);
        for d in [1e-4, 1e-3, 4e-3] {
            let h = 1e-4 * d;
            let du = (energy(d + h) - energy(d - h)) / (2.0 * h);
            let dy = (tip(d + h) - tip(d - h)) / (2.0 * h);
            let n = b.bristle_n(d);
            assert!(((n + b.mu * n * dy) / du - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn verify_brush_carries_the_sum_of_its_bristles() {
        let (b, q) = (brush(), Quadrature::new(24));
        let d = 2e-3;
        let half = b.half_length_m(d);
        let whole = b.normal_force_n(d, -1.0, 1.0, &q);
        // one bristle after another around the circumference
        let spacing = 2.0 * PI * b.radius_m / b.bristles;
        let n = (half / spacing) as i32 + 1;
        let sum: f64 = (-n..=n)
            .map(|i| b.bristle_n(d - (f64::from(i) * spacing).powi(2) / (2.0 * b.radius_m)))
            .sum();
        assert!((whole / sum - 1.0).abs() < 1e-3, "{whole} {sum}");
        let left = b.normal_force_n(d, -1.0, 0.3 * half, &q);
        let right = b.normal_force_n(d, 0.3 * half, 1.0, &q);
        assert!(((left + right) / whole - 1.0).abs() < 1e-4);
        // softer than a spring: twice the depth gives less than twice the force per contact length
        let deep = b.normal_force_n(2.0 * d, -1.0, 1.0, &q);
        assert!(deep / whole < 2.0 && deep / whole > 2f64.sqrt());
    }
}
