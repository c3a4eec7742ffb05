//! A pneumatic wheel: a spherical rubber shell, inflated, pressed onto a face that is flat beside
//! it.
//!
//! Three springs, from thin-shell and contact mechanics:
//!
//! - **Air.** Gauge pressure p stretches the shell to the tension `N = p R / 2` (Laplace). Pressed
//!   flat, the layer loses its curvature 2/R and hands the face `2 N / R = p`: the membrane part of
//!   the force is `p` times the area of the patch.
//! - **Shell.** Shallow-shell theory gives a sphere the Winkler stiffness `E h / R²` (arch action);
//!   with the tension it reads `E h w / R² - N ∇²w = q` (`vella2012`, whose bending term is left
//!   out).
//! - **Tread.** Within the patch the rubber itself yields as a half-space. Hertz's patch of radius
//!   a has the pressure `(2E*/πR) √(a² - ρ²)`; with the indentation above that of the patch's rim,
//!   `u = (a² - ρ²)/2R`, that is `κ √u`, `κ = (2E*/πR) √(2R)`: the same for every patch, so a local
//!   bed gives Hertz's pressure. The half-space drags the rim of the patch along by as much again:
//!   approach `a²/R = 2 u0`.
//!
//! Tread and shell carry the same pressure, in series; the air is beside them, in parallel. From
//! the pressure q at the middle: `d = c1 q + 2 c2 q²`, `u0 = c1 q + c2 q²`, `c1 = R²/(E h)`,
//! `c2 = 1/κ²`. The patch ends where the layer leaves without a kink, `N |w'| = N c / R`
//! ([`Bed::leaving_n_per_m`]).
//!
//! Limits: `p → 0`, shell rigid (h → ∞): Hertz's point contact, `a = (3FR/4E*)^{1/3}`,
//! `p0 = 3F/(2πa²)`. Modulus → 0: `F = p A`, A the patch. A membrane without any shell has no patch
//! at all: nothing but the rim, which is not modelled, keeps it from giving way, its approach
//! growing with the logarithm of the rim's distance. The model holds while the falling-off length
//! is small beside R. Bending of the shell (length `√(hR) / (12(1-ν²))^{1/4}`) is left out; it
//! would add to the reaction at an edge.

use super::bed::Bed;
use super::patch::{Layer, Patch, Shape};
use std::f64::consts::PI;

/// Geometry, material and filling of the wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PneumaticWheel {
    pub radius_m: f64,
    /// Gauge pressure, Pa.
    pub pressure_pa: f64,
    /// Thickness of the rubber shell, m; infinite for a solid wheel.
    pub shell_thickness_m: f64,
    /// Young's modulus of the rubber, Pa.
    pub youngs_modulus_pa: f64,
    pub poisson: f64,
    /// Viscous pressure per rate of deflection of the surface, Pa s/m.
    pub damping_pa_s_per_m: f64,
}

impl PneumaticWheel {
    /// Contact modulus against a rigid face, `E* = E/(1-ν²)`, Pa.
    pub fn contact_modulus_pa(&self) -> f64 {
        self.youngs_modulus_pa / (1.0 - self.poisson * self.poisson)
    }

    /// The bed of its surface.
    pub fn bed(&self) -> Bed {
        let r = self.radius_m;
        let hertz = 2.0 * self.contact_modulus_pa() / (PI * r) * (2.0 * r).sqrt();
        Bed {
            shell_m_per_pa: r * r / (self.youngs_modulus_pa * self.shell_thickness_m),
            tread_m_per_pa2: 1.0 / (hertz * hertz),
            damping_pa_s_per_m: self.damping_pa_s_per_m,
            tension_n_per_m: 0.5 * self.pressure_pa * r,
        }
    }

    /// The patch at an indentation: how far the undeformed wheel would reach beyond the face, m.
    pub fn patch(&self, indentation_m: f64) -> Patch {
        let bed = self.bed();
        let d = indentation_m.max(0.0);
        let (c1, c2) = (bed.shell_m_per_pa, bed.tread_m_per_pa2);
        let q = if d > 0.0 {
            2.0 * d / (c1 + (c1 * c1 + 8.0 * c2 * d).sqrt())
        } else {
            0.0
        };
        let bed_indentation_rate = (c1 + 2.0 * c2 * q) / (c1 + 4.0 * c2 * q);
        let shape = Shape::Point {
            radius_m: self.radius_m,
        };
        Patch::new(bed, Layer::Isotropic, shape, bed.deflection_m(q))
            .with_bed_indentation_rate(bed_indentation_rate)
    }

    /// Normal force at an indentation on a face without edges nearby, N.
    pub fn normal_force_n(&self, indentation_m: f64) -> f64 {
        self.patch(indentation_m).free_force_n()
    }

    /// Indentation that gives a normal force on a face without edges nearby, m.
    pub fn indentation_m(&self, normal_force_n: f64) -> f64 {
        super::patch::indentation_for(normal_force_n, self.radius_m, |d| self.normal_force_n(d))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A soft ball of 20 mm.
    pub(in crate::wheel) fn wheel() -> PneumaticWheel {
        PneumaticWheel {
            radius_m: 20e-3,
            pressure_pa: 0.1e6,
            shell_thickness_m: 5e-3,
            youngs_modulus_pa: 4e6,
            poisson: 0.49,
            damping_pa_s_per_m: 0.0,
        }
    }

    #[test]
    fn verify_without_air_a_solid_wheel_is_hertz() {
        let w = PneumaticWheel {
            pressure_pa: 0.0,
            shell_thickness_m: f64::INFINITY,
            ..wheel()
        };
        let (r, e) = (w.radius_m, w.contact_modulus_pa());
        for force in [1.0, 10.0, 40.0] {
            let patch = w.patch(w.indentation_m(force));
            let a = (3.0 * force * r / (4.0 * e)).cbrt();
            assert!((patch.contact_m() / a - 1.0).abs() < 1e-9);
            let peak = 3.0 * force / (2.0 * PI * a * a);
            for s in [0.0_f64, 0.5, 0.9] {
                let expected = peak * (1.0 - s * s).sqrt();
                assert!((patch.pressure_pa(s * a, 0.0) / expected - 1.0).abs() < 1e-8);
            }
            assert!((w.indentation_m(force) / (a * a / r) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn verify_soft_shell_carries_pressure_times_patch() {
        let mut last = f64::INFINITY;
        for modulus in [4e6, 4e5, 4e4, 4e3] {
            let w = PneumaticWheel {
                youngs_modulus_pa: modulus,
                ..wheel()
            };
            let patch = w.patch(0.6e-3);
            let ratio = patch.free_force_n() / (w.pressure_pa * PI * patch.contact_m().powi(2));
            assert!(ratio > 1.0 && ratio < last, "{modulus}: {ratio}");
            last = ratio;
        }
        assert!(last < 1.005, "{last}");
    }

    #[test]
    fn verify_force_is_the_integral_of_the_pressure_and_grows_with_each_spring() {
        let w = wheel();
        let patch = w.patch(0.8e-3);
        let n = 4000;
        let c = patch.contact_m();
        let sum: f64 = (0..n)
            .map(|i| {
                let rho = c * (i as f64 + 0.5) / n as f64;
                patch.pressure_pa(rho, 0.0) * 2.0 * PI * rho * c / n as f64
            })
            .sum();
        assert!((sum / patch.free_force_n() - 1.0).abs() < 1e-6);
        let force = w.normal_force_n(0.8e-3);
        let more = [
            PneumaticWheel {
                pressure_pa: 0.2e6,
                ..w
            },
            PneumaticWheel {
                shell_thickness_m: 8e-3,
                ..w
            },
            PneumaticWheel {
                youngs_modulus_pa: 6e6,
                ..w
            },
        ];
        for stiffer in more {
            assert!(stiffer.normal_force_n(0.8e-3) > 1.05 * force);
        }
        assert!((w.normal_force_n(w.indentation_m(12.0)) / 12.0 - 1.0).abs() < 1e-9);
        assert_eq!(w.normal_force_n(-1e-3), 0.0);
    }

    /// The bed itself, integrated inside and outside the patch, carries the same force: the layer
    /// only redistributes it.
    #[test]
    fn verify_what_the_bed_carries_is_what_the_face_presses() {
        let w = wheel();
        let (patch, bed) = (w.patch(0.8e-3), w.bed());
        let (c, r, n) = (patch.contact_m(), w.radius_m, w.bed().tension_n_per_m);
        let inside = patch.free_force_n() - w.pressure_pa * PI * c * c;
        // the layer outside, from the slope with which it leaves the patch
        let (mut deflection, mut slope, mut rho, h) =
            (patch.bed_indentation_at_m(c, 0.0), -c / r, c, 1e-7);
        let mut outside = 0.0;
        while deflection > 0.0 && slope < 0.0 {
            let q = bed.pressure_pa(deflection);
            outside += q * 2.0 * PI * rho * h;
            slope += h * (q / n - slope / rho);
            deflection += h * slope;
            rho += h;
        }
        let carried = inside + outside;
        assert!(
            (carried / patch.free_force_n() - 1.0).abs() < 0.02,
            "{carried}"
        );
    }
}
