//! A wheel brush of nylon wires.
//!
//! Each is an elastica ([`bristle`](super::bristle)). Without friction it buckles: its force hardly
//! changes with the depth, a brush is soft. Friction bends it before it buckles, and then n ∝ √δ at
//! first. Bristles do not touch each other, and their inertia is left out.
//!
//! **The brush.** Bristles stand evenly over the running surface `2πR W`; over a flat face they
//! indent it by `δ(x) = d - x²/2R`. Its contact is as long as the chord, many times a rubber
//! wheel's.

use super::bristle::Bristle;
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
    /// The law of its bristles.
    #[must_use]
    pub fn bristle(&self) -> Bristle {
        let bending_n_m2 = self.youngs_modulus_pa * PI / 64.0 * self.bristle_diameter_m.powi(4);
        Bristle::new(self.free_length_m, bending_n_m2, self.mu)
    }

    /// Half the length of the contact, `√(2Rd)`, m.
    pub fn half_length_m(&self, indentation_m: f64) -> f64 {
        (2.0 * self.radius_m * indentation_m.max(0.0)).sqrt()
    }

    /// Mean pressure at a distance from the middle along the run, Pa.
    fn pressure_pa(&self, bristle: &Bristle, indentation_m: f64, x: f64) -> f64 {
        let per_area = self.bristles / (2.0 * PI * self.radius_m * self.width_m);
        per_area * bristle.force_n(indentation_m - x * x / (2.0 * self.radius_m))
    }

    /// Normal force on a flat face, N, of the part of the contact between `from` and `to` (m from
    /// its middle, along the run): a face that ends there bears the bristles on it only, since no
    /// layer joins them.
    pub fn normal_force_n(
        &self,
        indentation_m: f64,
        from_m: f64,
        to_m: f64,
        (bristle, quadrature): (&Bristle, &Quadrature),
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
                self.pressure_pa(bristle, indentation_m, half * phi.sin()) * half * phi.cos()
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
    fn verify_brush_carries_the_sum_of_its_bristles() {
        let (b, q) = (brush(), Quadrature::new(24));
        let bristle = b.bristle();
        let d = 2e-3;
        let half = b.half_length_m(d);
        let whole = b.normal_force_n(d, -1.0, 1.0, (&bristle, &q));
        // one bristle after another around the circumference
        let spacing = 2.0 * PI * b.radius_m / b.bristles;
        let n = (half / spacing) as i32 + 1;
        let sum: f64 = (-n..=n)
            .map(|i| bristle.force_n(d - (f64::from(i) * spacing).powi(2) / (2.0 * b.radius_m)))
            .sum();
        assert!((whole / sum - 1.0).abs() < 1e-3, "{whole} {sum}");
        let left = b.normal_force_n(d, -1.0, 0.3 * half, (&bristle, &q));
        let right = b.normal_force_n(d, 0.3 * half, 1.0, (&bristle, &q));
        assert!(((left + right) / whole - 1.0).abs() < 1e-4);
        // softer than a spring: twice the depth gives less than twice the force per contact length
        let deep = b.normal_force_n(2.0 * d, -1.0, 1.0, (&bristle, &q));
        assert!(deep / whole < 2.0 && deep / whole > 2f64.sqrt());
    }
}
