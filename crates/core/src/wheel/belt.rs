//! A grinding belt over a cylindrical contact wheel, pressed onto a surface curved across its axis.
//!
//! **Wheel.** Hertz's line contact: half width `b = √(4 F' R_e / (π E*))`, `1/R_e = 1/R + κ`,
//! pressure `p0 √(1 - x²/b²)`, `p0 = E* b / (2 R_e)`. With the indentation above that of the
//! patch's rim, `u = (b² - x²)/2R_e`, the pressure is `κ √u`, `κ = E* / √(2 R_e)`: a local bed, as
//! for the point. How far the wheel approaches depends on the depth h of the rubber on its hub
//! (`johnson1985`, eq. 5.57): `d = F'/(πE*) (2 ln(2h/b) - ν/(1-ν)) = b²/(4R_e) (…)`, for b well
//! below h. Beyond `b = h/2` we go on with the slope reached there in b²; the truth is stiffer.
//!
//! **Belt.** Tension T over width W is a layer with `N = T/W`. Wrapped round the wheel it presses
//! the wheel with `N/R`; pressed onto the workpiece it takes its shape, loses the curvature
//! `1/R_e`, and hands the face `N/R_e`. It pulls the patch's ends together (no kink, `bed`), and
//! bends round an edge across its run. Along its run it is not stretched sideways: no reaction
//! there.

use crate::roots::newton;
use std::f64::consts::PI;

use super::bed::Bed;
use super::patch::{Layer, Patch, Shape, indentation_for};

/// A step so small, as a part of the half width's square, is the last: the next would be less than
/// its square.
const LAST_STEP: f64 = 1e-7;
/// Where a contact begins, the bed's indentation grows without bound over the wheel's rate; that of
/// a half width of 1 nm will do.
const SMALLEST_SQUARE_M2: f64 = 1e-18;
/// `2 ln(2h/b)` from which the iteration begins, at a half width of 0.3 of the rubber's thickness.
const TYPICAL: f64 = 3.794_239_969_771_76;

/// Contact wheel and belt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeltWheel {
    /// Radius including the belt, m.
    pub radius_m: f64,
    pub width_m: f64,
    /// Contact modulus of the rubber, `E/(1-ν²)`, Pa.
    pub contact_modulus_pa: f64,
    pub poisson: f64,
    /// Thickness of the rubber on the hub, m.
    pub rubber_m: f64,
    /// Belt tension, N.
    pub tension_n: f64,
    /// Viscous pressure per rate of deflection of the surface, Pa s/m.
    pub damping_pa_s_per_m: f64,
}

/// Half-width of Hertz's line contact, `b = √(4 F' R_e/(π E*))` (`johnson1985`, eq. 4.43), m: force
/// per width in N/m, contact modulus in Pa, relative radius in m.
pub fn line_half_width_m(line_load_n_per_m: f64, modulus_pa: f64, relative_radius_m: f64) -> f64 {
    (4.0 * line_load_n_per_m * relative_radius_m / (PI * modulus_pa)).sqrt()
}

/// Radius of a wheel relative to a surface of this curvature across its axis (convex positive,
/// 1/m): `1/R_e = 1/R + κ`, m. On a concave surface tighter than the wheel there is none.
pub fn relative_radius_m(radius_m: f64, curvature_per_m: f64) -> Option<f64> {
    let sum = 1.0 / radius_m + curvature_per_m;
    (sum > 0.0).then(|| 1.0 / sum)
}

impl BeltWheel {
    /// [`relative_radius_m`] of this wheel.
    pub fn relative_radius_m(&self, curvature_per_m: f64) -> Option<f64> {
        relative_radius_m(self.radius_m, curvature_per_m)
    }

    /// Approach of the hub at the square of Hertz's half width, and its slope over that, both times
    /// 4 R_e: `b² (2 ln(2h/b) - ν/(1-ν))`, from Johnson's eq. 5.57; from a half width of h/2 it
    /// goes on straight.
    fn approach(&self, square_m2: f64) -> [f64; 2] {
        let h = self.rubber_m;
        let within = square_m2.min(0.25 * h * h);
        let factor = (4.0 * h * h / within).ln() - self.poisson / (1.0 - self.poisson);
        let slope = factor - 1.0;
        [within * factor + (square_m2 - within) * slope, slope]
    }

    /// Square of Hertz's half width at an indentation, m²: the approach over it grows ever more
    /// slowly, so that Newton's iteration comes to its root from below, whatever the first step
    /// does.
    fn half_width_square_m2(&self, indentation_m: f64, relative_radius_m: f64) -> f64 {
        if indentation_m <= 0.0 {
            return 0.0;
        }
        let sought = 4.0 * relative_radius_m * indentation_m;
        let start = sought / (TYPICAL - self.poisson / (1.0 - self.poisson));
        newton(start, LAST_STEP, |square| {
            let [found, slope] = self.approach(square);
            ((sought - found) / slope).max(-0.9 * square)
        })
    }

    /// The patch at an indentation on a surface of relative radius `R_e`.
    pub fn patch(&self, indentation_m: f64, relative_radius_m: f64) -> Patch {
        let d = indentation_m.max(0.0);
        let r = relative_radius_m;
        let square = self.half_width_square_m2(d, r);
        let bed = Bed {
            shell_m_per_pa: 0.0,
            tread_m_per_pa2: 2.0 * r / self.contact_modulus_pa.powi(2),
            damping_pa_s_per_m: self.damping_pa_s_per_m,
            tension_n_per_m: self.tension_n / self.width_m,
        };
        let shape = Shape::Line {
            radius_m: r,
            half_width_m: 0.5 * self.width_m,
        };
        let [_, slope] = self.approach(square.max(SMALLEST_SQUARE_M2));
        Patch::new(bed, Layer::AlongX, shape, square / (2.0 * r))
            .with_bed_indentation_rate(2.0 / slope)
    }

    /// Normal force at an indentation on a face without edges nearby, N.
    pub fn normal_force_n(&self, indentation_m: f64, relative_radius_m: f64) -> f64 {
        self.patch(indentation_m, relative_radius_m).free_force_n()
    }

    /// Indentation that gives a normal force, m.
    pub fn indentation_m(&self, normal_force_n: f64, relative_radius_m: f64) -> f64 {
        indentation_for(normal_force_n, self.rubber_m, |d| {
            self.normal_force_n(d, relative_radius_m)
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Wheel and belt of the reference, slack.
    pub(in crate::wheel) fn wheel() -> BeltWheel {
        BeltWheel {
            radius_m: 40e-3,
            width_m: 25e-3,
            contact_modulus_pa: 8e6,
            poisson: 0.48,
            rubber_m: 15e-3,
            tension_n: 0.0,
            damping_pa_s_per_m: 0.0,
        }
    }

    /// Indentation at a half width, m.
    fn approach_m(w: &BeltWheel, half_width_m: f64, relative_radius_m: f64) -> f64 {
        w.approach(half_width_m * half_width_m)[0] / (4.0 * relative_radius_m)
    }

    /// `docs/physics/surfaces.md`, line contact: 30 N on 25 mm, E* = 8 MPa, R = 40 mm on κ = 9 per
    /// metre: b = 2.37 mm, p0 = 0.32 MPa.
    #[test]
    fn verify_slack_belt_is_hertz_line_contact() {
        let w = wheel();
        let r = w.relative_radius_m(9.0).unwrap();
        let d = w.indentation_m(30.0, r);
        let patch = w.patch(d, r);
        let b = (4.0 * 1200.0 * r / (std::f64::consts::PI * 8e6)).sqrt();
        assert!(
            (patch.contact_m() / b - 1.0).abs() < 1e-9,
            "{}",
            patch.contact_m()
        );
        assert!((patch.contact_m() - 2.37e-3).abs() < 0.005e-3);
        assert!((patch.pressure_pa(0.0, 0.0) - 0.32e6).abs() < 0.005e6);
        let quarter = patch.pressure_pa(0.5 * b, 0.0) / patch.pressure_pa(0.0, 0.0);
        assert!((quarter - 0.75_f64.sqrt()).abs() < 1e-9);
        assert!(w.relative_radius_m(-30.0).is_none());
    }

    /// Johnson's approach against the strain integrated along the axis under Hertz's pressure (his
    /// eq. 4.46): `σx = -p0 ((b²+2z²)/(b√(b²+z²)) - 2z/b)`, `σz = -p0 b/√(b²+z²)`, plane strain.
    #[test]
    fn verify_approach_is_the_strain_below_the_patch() {
        let w = wheel();
        let (r, nu) = (40e-3, w.poisson);
        for b in [0.3e-3_f64, 1e-3, 3e-3] {
            let p0 = w.contact_modulus_pa * b / (2.0 * r);
            let n = 400_000;
            let h = w.rubber_m / n as f64;
            let mut approach = 0.0;
            for i in 0..n {
                let z = (i as f64 + 0.5) * h;
                let root = b.hypot(z);
                let x = p0 * ((b * b + 2.0 * z * z) / (b * root) - 2.0 * z / b);
                approach += (p0 * b / root - nu / (1.0 - nu) * x) / w.contact_modulus_pa * h;
            }
            let ours = approach_m(&w, b, r);
            // the closed form leaves out terms of (b/h)²
            assert!(
                (ours / approach - 1.0).abs() < (b / w.rubber_m).powi(2),
                "{b}: {ours} {approach}"
            );
        }
    }

    #[test]
    fn verify_tension_adds_force_and_shortens_the_patch() {
        let (slack, r) = (wheel(), 40e-3);
        let d = slack.indentation_m(30.0, r);
        let mut last = (slack.normal_force_n(d, r), slack.patch(d, r).contact_m());
        for tension in [10.0, 50.0, 150.0] {
            let tight = BeltWheel {
                tension_n: tension,
                ..slack
            };
            let now = (tight.normal_force_n(d, r), tight.patch(d, r).contact_m());
            assert!(now.0 > last.0 && now.1 < last.1, "{tension}: {now:?}");
            last = now;
        }
    }

    /// Indentations from nothing to twice as deep as the closed form reaches, small and large
    /// relative radii.
    #[test]
    fn verify_half_width_is_the_root_of_the_approach() {
        let w = wheel();
        assert_eq!(w.half_width_square_m2(0.0, 40e-3), 0.0);
        for r in [8e-3, 40e-3, 4.0] {
            let deepest = 2.0 * approach_m(&w, 0.5 * w.rubber_m, r);
            for part in [1e-9, 1e-6, 1e-3, 0.03, 0.3, 0.499, 0.501, 1.0] {
                let d = part * deepest;
                let back = approach_m(&w, w.half_width_square_m2(d, r).sqrt(), r);
                assert!((back / d - 1.0).abs() < 1e-12, "{r} {part}: {back} {d}");
            }
        }
    }

    #[test]
    fn approach_goes_on_smoothly_beyond_its_range() {
        let (w, r) = (wheel(), 40e-3);
        let b = 0.5 * w.rubber_m;
        let slope = |b: f64| (approach_m(&w, b + 1e-7, r) - approach_m(&w, b - 1e-7, r)) / 2e-7;
        assert!((slope(b - 1e-6) / slope(b + 1e-6) - 1.0).abs() < 1e-3);
        let deep = w.patch(approach_m(&w, 1.2 * b, r), r);
        assert!((deep.undeformed_half_length_m() / (1.2 * b) - 1.0).abs() < 1e-6);
    }
}
