//! A spherical soft wheel on a curved face, by similarity with one on a flat face.
//!
//! A face of principal curvatures κ1 and κ2 (convex positive) leaves the gap
//! `½ (x²/R1 + y²/R2)`, `1/Ri = 1/R + κi`, below a sphere of radius R. While Ri are alike the patch
//! is round, and the gap that of a sphere of radius `Re = √(R1 R2)` over a plane (`johnson1985`,
//! sec. 4.2). Rubber, shell and the air's tension are linear: within a given circle all pressures
//! and deflections go with the curvature that is imposed, 1/Re in place of 1/R. So the wheel on
//! the curved face at an indentation d is one on a plane at `d/s`, all its springs and dampers
//! `s = R/Re` times as stiff.
//!
//! Of a solid wheel at a given indentation this gives the force of Hertz's elliptic contact to 1 %
//! and the area of its patch to 0.7 % where `R1/R2` is at most [`Curved::MOST_UNALIKE`]; the
//! ellipse is then up to 25 % longer and 21 % narrower than the circle that stands for it.

use super::pneumatic::PneumaticWheel;

/// What the curvature of a face makes of a wheel's contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curved {
    /// R/Re.
    factor: f64,
    /// Larger of R1 and R2 over the smaller one.
    unalike: f64,
}

impl Curved {
    /// The largest ratio of the relative radii for which the patch is taken to be round.
    pub const MOST_UNALIKE: f64 = 2.0;

    /// Of a sphere on a face with these principal curvatures; `None` where the face is as hollow as
    /// the sphere or more.
    pub fn new(radius_m: f64, curvatures_per_m: [f64; 2]) -> Option<Self> {
        let relative = curvatures_per_m.map(|curvature| 1.0 + radius_m * curvature);
        let [least, most] = [relative[0].min(relative[1]), relative[0].max(relative[1])];
        (least > 0.0).then(|| Self {
            factor: (least * most).sqrt(),
            unalike: most / least,
        })
    }

    /// Larger of the two relative radii over the smaller one.
    pub fn unalike(&self) -> f64 {
        self.unalike
    }

    /// The wheel whose contact with a plane is like the one of `wheel` here.
    pub fn wheel(&self, wheel: &PneumaticWheel) -> PneumaticWheel {
        PneumaticWheel {
            pressure_pa: wheel.pressure_pa * self.factor,
            youngs_modulus_pa: wheel.youngs_modulus_pa * self.factor,
            damping_pa_s_per_m: wheel.damping_pa_s_per_m * self.factor,
            ..*wheel
        }
    }

    /// The indentation of that wheel, m, or its rate.
    pub fn indentation_m(&self, indentation_m: f64) -> f64 {
        indentation_m / self.factor
    }

    /// Radius of the patch at an indentation for which it is `flat_m` on a plane: as the square
    /// root of the relative radius, to the second order that the law is of.
    pub fn contact_m(&self, flat_m: f64) -> f64 {
        flat_m / self.factor.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const SOLID: PneumaticWheel = PneumaticWheel {
        radius_m: 20e-3,
        pressure_pa: 0.0,
        shell_thickness_m: 20e-3,
        youngs_modulus_pa: 4e6,
        poisson: 0.49,
        damping_pa_s_per_m: 0.0,
    };

    fn force_n(wheel: &PneumaticWheel, curvatures_per_m: [f64; 2], indentation_m: f64) -> f64 {
        let curved = Curved::new(wheel.radius_m, curvatures_per_m).unwrap();
        let like = curved.wheel(wheel);
        like.normal_force_n(curved.indentation_m(indentation_m))
    }

    /// Complete elliptic integrals of the first and the second kind of a modulus, by the
    /// arithmetic-geometric mean.
    fn elliptic(modulus: f64) -> [f64; 2] {
        let (mut a, mut b) = (1.0, (1.0 - modulus * modulus).sqrt());
        let (mut c, mut power, mut sum) = (modulus, 0.5, 0.5 * modulus * modulus);
        while c > 1e-15 {
            (a, b, c) = (0.5 * (a + b), f64::sqrt(a * b), 0.5 * (a - b));
            power *= 2.0;
            sum += power * c * c;
        }
        let first = PI / (2.0 * a);
        [first, first * (1.0 - sum)]
    }

    /// Hertz's elliptic contact (`johnson1985`, eqs. 4.26 to 4.28): force at an approach, and the
    /// area of the patch, for the relative radii R1 > R2.
    fn hertz(radii_m: [f64; 2], modulus_pa: f64, approach_m: f64) -> (f64, f64) {
        let wanted = radii_m[0] / radii_m[1];
        let of = |e: f64| {
            let [k, second] = elliptic(e);
            (second / (1.0 - e * e) - k) / (k - second)
        };
        let (mut low, mut high) = (1e-3, 0.999);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            match of(middle) < wanted {
                true => low = middle,
                false => high = middle,
            }
        }
        let e = 0.5 * (low + high);
        let [k, second] = elliptic(e);
        // A = 3P (K - E) / (2π E* e² a³) and δ = 3P K / (2π a E*), A = 1/(2 R1).
        let a_square = approach_m * (k - second) / (k * e * e) * 2.0 * radii_m[0];
        let force_n = 2.0 * PI * a_square.sqrt() * modulus_pa * approach_m / (3.0 * k);
        (force_n, PI * a_square * (1.0 - e * e).sqrt())
    }

    #[test]
    fn verify_a_solid_wheel_on_curved_faces_is_hertzs_elliptic_contact() {
        let (radius_m, modulus_pa) = (SOLID.radius_m, SOLID.contact_modulus_pa());
        for (radii, approach_m) in [
            ([1.25, 1.0], 0.1e-3),
            ([2.0, 1.0], 0.3e-3),
            ([0.9, 0.6], 0.2e-3),
            ([1.6, 0.8], 0.05e-3),
            ([3.0, 2.2], 0.2e-3),
        ] {
            let radii_m = radii.map(|part| part * radius_m);
            let curvatures_per_m = radii_m.map(|relative_m| 1.0 / relative_m - 1.0 / radius_m);
            let curved = Curved::new(radius_m, curvatures_per_m).unwrap();
            assert!((curved.unalike() - radii[0] / radii[1]).abs() < 1e-9);
            let (force, area_m2) = hertz(radii_m, modulus_pa, approach_m);
            let found = force_n(&SOLID, curvatures_per_m, approach_m);
            assert!(
                (found / force - 1.0).abs() < 0.0101,
                "{radii:?}: {found} {force}"
            );
            let shell = SOLID.shell();
            let patch = (curved.wheel(&SOLID)).patch(&shell, curved.indentation_m(approach_m));
            let found_m2 = PI * patch.contact_m().powi(2);
            let flat_m = SOLID.patch(&shell, approach_m).contact_m();
            assert!((curved.contact_m(flat_m) / patch.contact_m() - 1.0).abs() < 1e-8);
            assert!(
                (found_m2 / area_m2 - 1.0).abs() < 0.0075,
                "{radii:?}: {found_m2} {area_m2}"
            );
        }
    }

    /// On a sphere the similarity is that of Hertz to rounding, and a membrane hands a face that
    /// takes its curvature from 1/R to −κ the pressure `2N (1/R + κ)`.
    #[test]
    fn verify_spheres_and_membranes() {
        let curvature_per_m = 30.0;
        let relative_m = 1.0 / (1.0 / SOLID.radius_m + curvature_per_m);
        let d = 0.2e-3_f64;
        let hertz = 4.0 / 3.0 * SOLID.contact_modulus_pa() * (relative_m * d.powi(3)).sqrt();
        let found = force_n(&SOLID, [curvature_per_m; 2], d);
        assert!((found / hertz - 1.0).abs() < 1e-8, "{found} {hertz}");
        let soft = PneumaticWheel {
            pressure_pa: 0.1e6,
            shell_thickness_m: 0.4e-3,
            youngs_modulus_pa: 4e3,
            ..SOLID
        };
        let curved = Curved::new(soft.radius_m, [curvature_per_m; 2]).unwrap();
        let patch = curved
            .wheel(&soft)
            .patch(&soft.shell(), curved.indentation_m(0.6e-3));
        let pressure_pa = patch.free_force_n() / (PI * patch.contact_m().powi(2));
        let membrane_pa = 2.0 * soft.tension_n_per_m() / relative_m;
        assert!(
            (pressure_pa / membrane_pa - 1.0).abs() < 0.02,
            "{pressure_pa} {membrane_pa}"
        );
        assert_eq!(Curved::new(20e-3, [0.0, -50.0]), None);
    }
}
