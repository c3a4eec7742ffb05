//! A grinding belt over a cylindrical contact wheel, pressed onto a surface curved across its axis.
//!
//! **Wheel.** Rubber of depth h bonded to a hub, in plane strain (`bonded`): at a half width b its
//! force is `a_0` times that of Hertz's half-space, `a_0 π E* b²/4R_e`, `1/R_e = 1/R + κ`, its
//! approach `D b²/2R_e`, both functions of b/h and ν. Hertz's pressure `p0 √(1 - x²/b²)`,
//! `p0 = E* b/2R_e`, is a root of the indentation above that of the patch's rim,
//! `u = (b² - x²)/2R_e`: `κ √u`, `κ = E* / √(2 R_e)`, a local bed, as for the point. Rubber gets
//! the bed of `a_0 κ`: its force and its width are those of the layer, the pressure in the middle
//! is higher by a part that grows with b/h (0.8 % at b = h/2, 5 % at b = h, ν = 0.48).
//!
//! **Belt.** Tension T over width W is a layer with `N = T/W`. Wrapped round the wheel it presses
//! the wheel with `N/R`; pressed onto the workpiece it takes its shape, loses the curvature
//! `1/R_e`, and hands the face `N/R_e`. It pulls the patch's ends together (no kink, `bed`), and
//! bends round an edge across its run. Along its run it is not stretched sideways: no reaction
//! there.

use std::f64::consts::PI;

use super::bed::Bed;
use super::bonded::BondedLayer;
use super::patch::{Layer, Patch, Shape, indentation_for};

/// Where a contact begins, the bed's indentation grows without bound over the wheel's rate; that at
/// an indentation of 1 am will do.
const SMALLEST_INDENTATION_M: f64 = 1e-18;

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

    /// Its rubber; a table that is worth keeping.
    pub fn layer(&self) -> BondedLayer {
        BondedLayer::new(self.poisson)
    }

    /// The patch at an indentation on a surface of relative radius `R_e`, with the wheel's
    /// [`Self::layer`].
    pub fn patch(&self, layer: &BondedLayer, indentation_m: f64, relative_radius_m: f64) -> Patch {
        let (r, square_m2) = (relative_radius_m, self.rubber_m * self.rubber_m);
        let pressed = layer.at(2.0 * r * indentation_m.max(SMALLEST_INDENTATION_M) / square_m2);
        let bed = Bed {
            shell_m_per_pa: 0.0,
            tread_m_per_pa2: 2.0 * r / (self.contact_modulus_pa * pressed.force_factor).powi(2),
            damping_pa_s_per_m: self.damping_pa_s_per_m,
            tension_n_per_m: self.tension_n / self.width_m,
        };
        let shape = Shape::Line {
            radius_m: r,
            half_width_m: 0.5 * self.width_m,
        };
        let bed_indentation_m = if indentation_m > 0.0 {
            pressed.square * square_m2 / (2.0 * r)
        } else {
            0.0
        };
        Patch::new(bed, Layer::AlongX, shape, bed_indentation_m)
            .with_bed_indentation_rate(pressed.rate)
    }

    /// Normal force at an indentation on a face without edges nearby, N.
    pub fn normal_force_n(&self, indentation_m: f64, relative_radius_m: f64) -> f64 {
        self.patch(&self.layer(), indentation_m, relative_radius_m)
            .free_force_n()
    }

    /// Indentation that gives a normal force, m.
    pub fn indentation_m(&self, normal_force_n: f64, relative_radius_m: f64) -> f64 {
        let layer = self.layer();
        indentation_for(normal_force_n, self.rubber_m, |d| {
            self.patch(&layer, d, relative_radius_m).free_force_n()
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

    /// `docs/physics/surfaces.md`, line contact: 30 N on 25 mm, E* = 8 MPa, R = 40 mm on κ = 9 per
    /// metre: b = 2.37 mm, p0 = 0.32 MPa, on rubber that is deep beside them.
    #[test]
    fn verify_slack_belt_on_deep_rubber_is_hertz_line_contact() {
        let w = BeltWheel {
            rubber_m: 3.0,
            ..wheel()
        };
        let r = w.relative_radius_m(9.0).unwrap();
        let patch = w.patch(&w.layer(), w.indentation_m(30.0, r), r);
        let b = line_half_width_m(1200.0, 8e6, r);
        assert!((patch.contact_m() / b - 1.0).abs() < 1e-6);
        assert!((patch.contact_m() - 2.37e-3).abs() < 0.005e-3);
        assert!((patch.pressure_pa(0.0, 0.0) - 0.32e6).abs() < 0.005e6);
        let quarter = patch.pressure_pa(0.5 * b, 0.0) / patch.pressure_pa(0.0, 0.0);
        assert!((quarter - 0.75_f64.sqrt()).abs() < 1e-6);
        assert!(w.relative_radius_m(-30.0).is_none());
    }

    /// Under a narrow patch the approach grows with the logarithm of h/b, as that of a half-space's
    /// strain down to the depth h does (`johnson1985`, eq. 5.57), `b²/2R (ln(2h/b) - ν/2(1-ν))`;
    /// that this is not the layer's strain is a constant beside the logarithm, .061 at ν = .48.
    #[test]
    fn verify_a_narrow_patch_approaches_by_the_logarithm() {
        let (w, r) = (wheel(), 40e-3);
        let layer = w.layer();
        let off = [1e-4, 1e-5, 1e-6].map(|d: f64| {
            let b = w.patch(&layer, d, r).undeformed_half_length_m();
            let estimate = (2.0 * w.rubber_m / b).ln() - 0.5 * w.poisson / (1.0 - w.poisson);
            d * 2.0 * r / (b * b) - estimate
        });
        // what is left falls with (b/h)² ln(h/b)
        assert!(off[0] - off[2] < 0.05 && off[1] - off[2] < 5e-3, "{off:?}");
        assert!((off[2] - 0.061).abs() < 1e-3, "{off:?}");
    }

    /// The bed's indentation goes with the wheel's at the rate it tells, which damping asks for.
    #[test]
    fn verify_the_bed_is_indented_at_the_rate_told() {
        let (w, r) = (wheel(), 40e-3);
        let layer = w.layer();
        let at = |d: f64| w.patch(&layer, d, r).bed_indentation_at_m(0.0, 0.0);
        for d in [1e-6, 0.1e-3, 1e-3, 3e-3] {
            let h = 1e-3 * d;
            let slope = (at(d + h) - at(d - h)) / (2.0 * h);
            let told = layer.at(2.0 * r * d / w.rubber_m.powi(2)).rate;
            assert!((slope / told - 1.0).abs() < 1e-3, "{d}: {slope} {told}");
        }
        assert_eq!(w.normal_force_n(0.0, r), 0.0);
        assert_eq!(w.normal_force_n(-1e-3, r), 0.0);
    }

    #[test]
    fn verify_tension_adds_force_and_shortens_the_patch() {
        let (slack, r) = (wheel(), 40e-3);
        let (d, layer) = (slack.indentation_m(30.0, r), slack.layer());
        let mut last = (
            slack.normal_force_n(d, r),
            slack.patch(&layer, d, r).contact_m(),
        );
        for tension in [10.0, 50.0, 150.0] {
            let tight = BeltWheel {
                tension_n: tension,
                ..slack
            };
            let now = (
                tight.normal_force_n(d, r),
                tight.patch(&layer, d, r).contact_m(),
            );
            assert!(now.0 > last.0 && now.1 < last.1, "{tension}: {now:?}");
            last = now;
        }
    }
}
