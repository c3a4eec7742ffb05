//! A pneumatic wheel: a spherical rubber shell, inflated, pressed onto a face that is flat beside
//! it.
//!
//! What a whole patch needs of force and approach is that of an elastic hollow sphere, whose shell
//! is under the air's tension (`shell`): from the shell's bending and stretching where it is thin
//! to Hertz's contact where it is thick. Over edges the face presses a layer under that tension on
//! Hertz's local bed: within Hertz's patch of radius a the pressure is `(2E*/πR) √(a² - ρ²)`; with
//! the indentation above that of the patch's rim, `u = (a² - ρ²)/2R`, that is `κ √u`,
//! `κ = (2E*/πR) √(2R)`. The bed is as much softer than κ as makes the force of a whole patch
//! right.
//!
//! Pressed flat, the layer loses its curvature 2/R and hands the face 2N/R, the gauge pressure of a
//! thin shell. The patch ends where the layer leaves without a kink, `N |w'| = N c / R`
//! ([`Bed::leaving_n_per_m`]).
//!
//! Limits: solid, or so thick that the hollow is far: Hertz's point contact,
//! `a = (3FR/4E*)^{1/3}`, `p0 = 3F/(2πa²)`, approach a²/R. The air's tension is that before
//! contact; linear theory asks for indentations below the shell's thickness.

use super::bed::Bed;
use super::patch::{Layer, Patch, Shape};
use super::shell::{HERTZ, Proportions, Shell};

/// Geometry, material and filling of the wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PneumaticWheel {
    pub radius_m: f64,
    /// Gauge pressure, Pa.
    pub pressure_pa: f64,
    /// Thickness of the rubber shell, m; the radius for a solid wheel.
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

    /// Tension of the shell under the air, N/m: over the cut through the middle the hollow's area
    /// times p is the tension times the shell's mean circumference.
    pub fn tension_n_per_m(&self) -> f64 {
        let inner_m = (self.radius_m - self.shell_thickness_m).max(0.0);
        let mean_m = self.radius_m - 0.5 * self.shell_thickness_m;
        self.pressure_pa * inner_m * inner_m / (2.0 * mean_m)
    }

    /// Its contacts with a face; a table that is worth keeping.
    pub fn shell(&self) -> Shell {
        Shell::new(&Proportions {
            thickness: (self.shell_thickness_m / self.radius_m).min(1.0),
            poisson: self.poisson,
            tension: self.tension_n_per_m() / (self.contact_modulus_pa() * self.radius_m),
        })
    }

    /// The patch at an indentation, with the wheel's [`Self::shell`]: how far the undeformed wheel
    /// would reach beyond the face, m.
    pub fn patch(&self, shell: &Shell, indentation_m: f64) -> Patch {
        let r = self.radius_m;
        let pressed = shell.at(indentation_m.max(0.0) / r);
        let stiffness = HERTZ * pressed.factor * self.contact_modulus_pa() / r.sqrt();
        let bed = Bed {
            shell_m_per_pa: 0.0,
            tread_m_per_pa2: 1.0 / (stiffness * stiffness),
            damping_pa_s_per_m: self.damping_pa_s_per_m,
            tension_n_per_m: self.tension_n_per_m(),
        };
        let shape = Shape::Point { radius_m: r };
        Patch::new(bed, Layer::Isotropic, shape, r * pressed.bed_indentation)
            .with_bed_indentation_rate(pressed.rate)
    }

    /// Normal force at an indentation on a face without edges nearby, N.
    pub fn normal_force_n(&self, indentation_m: f64) -> f64 {
        self.patch(&self.shell(), indentation_m).free_force_n()
    }

    /// Indentation that gives a normal force on a face without edges nearby, m.
    pub fn indentation_m(&self, normal_force_n: f64) -> f64 {
        let shell = self.shell();
        super::patch::indentation_for(normal_force_n, self.radius_m, |d| {
            self.patch(&shell, d).free_force_n()
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::f64::consts::PI;

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

    /// The patch at an indentation.
    pub(in crate::wheel) fn pressed(wheel: &PneumaticWheel, indentation_m: f64) -> Patch {
        wheel.patch(&wheel.shell(), indentation_m)
    }

    #[test]
    fn verify_a_solid_wheel_is_hertz() {
        let w = PneumaticWheel {
            shell_thickness_m: 20e-3,
            ..wheel()
        };
        let (r, e) = (w.radius_m, w.contact_modulus_pa());
        for force in [1.0, 10.0, 40.0] {
            let d = w.indentation_m(force);
            let patch = pressed(&w, d);
            let a = (3.0 * force * r / (4.0 * e)).cbrt();
            assert!((patch.contact_m() / a - 1.0).abs() < 1e-9);
            let peak = 3.0 * force / (2.0 * PI * a * a);
            for s in [0.0_f64, 0.5, 0.9] {
                let expected = peak * (1.0 - s * s).sqrt();
                assert!((patch.pressure_pa(s * a, 0.0) / expected - 1.0).abs() < 1e-8);
            }
            assert!((d / (a * a / r) - 1.0).abs() < 1e-9);
        }
    }

    /// A hollow that is small and far does not matter, and no more does the air in it.
    #[test]
    fn verify_a_thick_wheel_is_hertz() {
        for (poisson, pressure_pa) in [(0.3, 0.0), (0.49, 0.0), (0.49, 0.2e6)] {
            let w = PneumaticWheel {
                radius_m: 25e-3,
                shell_thickness_m: 24e-3,
                poisson,
                pressure_pa,
                ..wheel()
            };
            for part in [1e-4, 1e-3, 1e-2] {
                let d = part * w.radius_m;
                let hertz = 4.0 / 3.0 * w.contact_modulus_pa() * (w.radius_m * d.powi(3)).sqrt();
                let off = w.normal_force_n(d) / hertz - 1.0;
                assert!(off.abs() < 2e-3, "{poisson} {pressure_pa} {part}: {off}");
            }
        }
    }

    /// Force over E* R² of hollow spheres without air between rigid planes, by axisymmetric finite
    /// elements (`tests/reference/shell.py`): Poisson's ratio, thickness and indentation over the
    /// radius. Those count the approach from the equator, which stiffens a solid sphere by 4 % at
    /// R/100.
    #[test]
    fn verify_shells_against_finite_elements() {
        let found = [
            (0.49, 0.5, [2.0617e-4, 1.1983e-3], 0.034),
            (0.49, 0.25, [1.3650e-4, 6.5203e-4], 0.02),
            (0.49, 0.1, [4.2471e-5, 1.6471e-4], 0.01),
            (0.3, 0.25, [1.4225e-4, 6.9117e-4], 0.026),
            (0.3, 0.05, [1.4178e-5, 5.2224e-5], 0.01),
        ];
        for (poisson, thickness, forces, tolerance) in found {
            let w = PneumaticWheel {
                pressure_pa: 0.0,
                shell_thickness_m: thickness * 20e-3,
                poisson,
                ..wheel()
            };
            let unit = w.contact_modulus_pa() * w.radius_m.powi(2);
            for (part, force) in [0.003, 0.01].into_iter().zip(forces) {
                let off = w.normal_force_n(part * w.radius_m) / (unit * force) - 1.0;
                assert!(
                    (-tolerance..0.002).contains(&off),
                    "{poisson} {thickness} {part}: {off}"
                );
            }
        }
    }

    /// A thin shell of little stiffness holds what the air presses on the patch.
    #[test]
    fn verify_soft_shell_carries_pressure_times_patch() {
        let mut last = f64::INFINITY;
        for modulus in [4e6, 4e5, 4e4, 4e3] {
            let w = PneumaticWheel {
                youngs_modulus_pa: modulus,
                shell_thickness_m: 0.4e-3,
                ..wheel()
            };
            let patch = pressed(&w, 0.6e-3);
            let ratio = patch.free_force_n() / (w.pressure_pa * PI * patch.contact_m().powi(2));
            assert!(ratio < last, "{modulus}: {ratio}");
            last = ratio;
        }
        assert!((last - 1.0).abs() < 0.03, "{last}");
    }

    #[test]
    fn verify_force_is_the_integral_of_the_pressure_and_grows_with_each_spring() {
        let w = wheel();
        let patch = pressed(&w, 0.8e-3);
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
        let patch = pressed(&w, 0.8e-3);
        let bed = patch.bed();
        let (c, r, n) = (patch.contact_m(), w.radius_m, w.tension_n_per_m());
        let inside = patch.free_force_n() - 2.0 * n / r * PI * c * c;
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
