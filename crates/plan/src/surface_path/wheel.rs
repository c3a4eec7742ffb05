//! The contact wheel of a belt grinder.

use truecut_core::wheel::belt::{line_half_width_m, relative_radius_m};

use super::error::SurfacePathError;

use crate::bounds::OutOfBounds;

/// A cylindrical contact wheel, pressed on with a force per width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactWheel {
    /// Radius with the belt on, m.
    pub radius_m: f64,
    pub width_m: f64,
    /// How far the wheel's centre is set below the radius, k h in the publication, m; 0 where the
    /// wheel just touches.
    pub indentation_m: f64,
    /// Normal force per width, N/m.
    pub line_load_n_per_m: f64,
    /// Effective modulus E* of wheel and workpiece, Pa.
    pub modulus_pa: f64,
}

impl ContactWheel {
    /// Checks the numbers.
    ///
    /// # Errors
    /// If a length, load or modulus is not above 0, or the indentation not below the radius.
    pub fn check(&self) -> Result<(), SurfacePathError> {
        let above_zero = [
            ("the wheel's radius (m)", self.radius_m),
            ("the wheel's width (m)", self.width_m),
            ("the wheel's line load (N/m)", self.line_load_n_per_m),
            ("the wheel's modulus (Pa)", self.modulus_pa),
        ];
        for (quantity, value) in above_zero {
            let good = value.is_finite() && value > 0.0;
            OutOfBounds::unless(good, quantity, value, "finite and above 0")?;
        }
        let (indentation_m, rule) = (self.indentation_m, "from 0 to below the wheel's radius");
        let good = (0.0..self.radius_m).contains(&indentation_m);
        OutOfBounds::unless(good, "the wheel's indentation (m)", indentation_m, rule)?;
        Ok(())
    }

    /// Half-width of the contact line by [`line_half_width_m`], m, the wheel's radius at most: in a
    /// hollow hardly wider than the wheel the law would give any width. `None` if the surface is
    /// hollow with a radius not above the wheel's.
    #[must_use]
    pub fn half_width_m(&self, curvature_across_per_m: f64) -> Option<f64> {
        let relative_m = relative_radius_m(self.radius_m, curvature_across_per_m)?;
        let half_m = line_half_width_m(self.line_load_n_per_m, self.modulus_pa, relative_m);
        Some(half_m.min(self.radius_m))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// `docs/physics/surfaces.md`, line contact: R 40 mm, W 25 mm, h 0.5 mm, 30 N over the width,
    /// E* 8 MPa.
    pub(crate) const PUBLISHED: ContactWheel = ContactWheel {
        radius_m: 0.04,
        width_m: 0.025,
        indentation_m: 0.5e-3,
        line_load_n_per_m: 1200.0,
        modulus_pa: 8e6,
    };

    #[test]
    fn verify_line_hertz_width_and_pressure() {
        let b = PUBLISHED.half_width_m(9.0).expect("convex");
        assert!((b * 1e3 / 2.37 - 1.0).abs() < 0.005, "{b}");
        let pressure = 2.0 * PUBLISHED.line_load_n_per_m / (PI * b);
        assert!((pressure / 0.32e6 - 1.0).abs() < 0.02, "{pressure}");
        assert_eq!(PUBLISHED.half_width_m(-25.0), None);
        let nearly_as_round = PUBLISHED.half_width_m(-25.0 + 1e-6);
        assert_eq!(nearly_as_round, Some(PUBLISHED.radius_m));
    }

    #[test]
    fn wheels_that_are_none_are_refused() {
        let bad = ContactWheel {
            indentation_m: 0.05,
            ..PUBLISHED
        };
        assert!(
            bad.check()
                .expect_err("too deep")
                .to_string()
                .contains("indentation")
        );
        let bad = ContactWheel {
            width_m: f64::NAN,
            ..PUBLISHED
        };
        assert!(bad.check().expect_err("NaN").to_string().contains("width"));
    }
}
