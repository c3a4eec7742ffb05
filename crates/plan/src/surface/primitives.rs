//! Planes and circular cylinders as patches.

use nalgebra::{Unit, Vector3};

use super::error::{SurfaceFault, place};
use super::{Domain, Jet, Surface};

/// A flat parallelogram.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanePatch {
    corner_m: Vector3<f64>,
    sides_m: [Vector3<f64>; 2],
}

impl PlanePatch {
    /// A patch from a corner along two sides; the outward normal is their cross product.
    ///
    /// # Errors
    /// If a number is not finite or the sides do not span a plane.
    pub fn new(
        corner_m: Vector3<f64>,
        side_u_m: Vector3<f64>,
        side_v_m: Vector3<f64>,
    ) -> Result<Self, SurfaceFault> {
        for (what, vector) in [
            ("corner", corner_m),
            ("side u", side_u_m),
            ("side v", side_v_m),
        ] {
            finite(what, &vector)?;
        }
        let spanned = side_u_m.cross(&side_v_m).norm();
        if spanned <= 1e-9 * side_u_m.norm() * side_v_m.norm() {
            return Err(SurfaceFault::NoNormal { u: 0.0, v: 0.0 });
        }
        Ok(Self {
            corner_m,
            sides_m: [side_u_m, side_v_m],
        })
    }
}

impl Surface for PlanePatch {
    fn domain(&self) -> Domain {
        Domain::UNIT
    }

    fn jet(&self, u: f64, v: f64) -> Jet {
        let [u, v] = [u, v].map(|t| t.clamp(0.0, 1.0));
        Jet {
            point_m: self.corner_m + self.sides_m[0] * u + self.sides_m[1] * v,
            first_m: self.sides_m,
            second_m: [Vector3::zeros(); 3],
        }
    }
}

/// Part of a circular cylinder: u turns about the axis, v runs along it.
#[derive(Debug, Clone, PartialEq)]
pub struct CylinderPatch {
    origin_m: Vector3<f64>,
    axis: Vector3<f64>,
    /// Direction at angle 0, and at a right angle.
    radial: [Vector3<f64>; 2],
    radius_m: f64,
    angles_rad: [f64; 2],
    length_m: f64,
}

impl CylinderPatch {
    /// A cylinder about `axis` through `origin_m`, from angle to angle (rad, 0 along
    /// `zero_direction`, right-handed about the axis). A positive radius gives the outside
    /// (convex), a negative one a bore seen from within (concave).
    ///
    /// # Errors
    /// If a number is not finite, the radius or length vanishes, angles do not rise or turn more
    /// than once, or the zero direction lies along the axis.
    pub fn new(
        origin_m: Vector3<f64>,
        axis: Unit<Vector3<f64>>,
        zero_direction: Unit<Vector3<f64>>,
        radius_m: f64,
        angles_rad: [f64; 2],
        length_m: f64,
    ) -> Result<Self, SurfaceFault> {
        finite("origin", &origin_m)?;
        let bad = |quantity: &str, value: f64, rule| SurfaceFault::OutOfBounds {
            quantity: quantity.to_owned(),
            value: value.to_string(),
            rule,
        };
        if !radius_m.is_finite() || radius_m == 0.0 {
            return Err(bad(
                "the radius of the cylinder (m)",
                radius_m,
                "finite and not 0",
            ));
        }
        if !length_m.is_finite() || length_m <= 0.0 {
            return Err(bad("the length of the cylinder (m)", length_m, "above 0"));
        }
        let turn = angles_rad[1] - angles_rad[0];
        if !(turn > 0.0 && turn <= std::f64::consts::TAU) {
            return Err(bad(
                "the angle that the cylinder patch spans (rad)",
                turn,
                "above 0 and at most a turn",
            ));
        }
        let flat = zero_direction.into_inner() - axis.into_inner() * axis.dot(&zero_direction);
        let Some(zero) = Unit::try_new(flat, 1e-9) else {
            return Err(bad(
                "the sine between axis and zero direction of the cylinder",
                flat.norm(),
                "at least 1e-9",
            ));
        };
        Ok(Self {
            origin_m,
            axis: axis.into_inner(),
            radial: [zero.into_inner(), axis.cross(&zero)],
            radius_m,
            angles_rad,
            length_m,
        })
    }
}

impl Surface for CylinderPatch {
    fn domain(&self) -> Domain {
        Domain::UNIT
    }

    fn jet(&self, u: f64, v: f64) -> Jet {
        let [u, v] = [u, v].map(|t| t.clamp(0.0, 1.0));
        let span = self.angles_rad[1] - self.angles_rad[0];
        let radius = self.radius_m.abs();
        // A bore is turned through backwards, so that r_u × r_v points to its axis.
        let (angle, rate) = if self.radius_m > 0.0 {
            (self.angles_rad[0] + u * span, span)
        } else {
            (self.angles_rad[1] - u * span, -span)
        };
        let (sin, cos) = angle.sin_cos();
        let out = self.radial[0] * cos + self.radial[1] * sin;
        let around = self.radial[1] * cos - self.radial[0] * sin;
        Jet {
            point_m: self.origin_m + out * radius + self.axis * (self.length_m * v),
            first_m: [around * (radius * rate), self.axis * self.length_m],
            second_m: [
                out * (-radius * rate * rate),
                Vector3::zeros(),
                Vector3::zeros(),
            ],
        }
    }
}

fn finite(what: &'static str, vector: &Vector3<f64>) -> Result<(), SurfaceFault> {
    if vector.iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err(SurfaceFault::NotFinite {
        what,
        index: 1,
        value: place(vector),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Forms;

    #[test]
    fn verify_a_bore_is_concave_and_its_normal_points_inward() {
        let bore = CylinderPatch::new(
            Vector3::zeros(),
            Vector3::y_axis(),
            Vector3::z_axis(),
            -0.04,
            [-0.5, 0.5],
            0.1,
        )
        .expect("a bore");
        let jet = bore.jet(0.2, 0.5);
        let forms = Forms::of(&jet).expect("regular");
        let from_axis = Vector3::new(jet.point_m.x, 0.0, jet.point_m.z);
        assert!((from_axis.normalize() + forms.normal.into_inner()).norm() < 1e-12);
        assert!((forms.curvatures().min_per_m + 25.0).abs() < 1e-12);
    }

    #[test]
    fn patches_that_are_none_are_refused() {
        let flat = PlanePatch::new(Vector3::zeros(), Vector3::x(), Vector3::x() * 3.0);
        assert!(
            flat.expect_err("parallel")
                .to_string()
                .contains("no normal")
        );
        let nan = PlanePatch::new(Vector3::zeros(), Vector3::x() * f64::NAN, Vector3::y());
        assert!(nan.expect_err("NaN").to_string().contains("side u"));
        let (y, z) = (Vector3::y_axis(), Vector3::z_axis());
        let cylinder = |radius, angles, length, zero| {
            let made = CylinderPatch::new(Vector3::zeros(), y, zero, radius, angles, length);
            made.expect_err("no cylinder").to_string()
        };
        assert!(cylinder(0.0, [0.0, 1.0], 1.0, z).contains("radius"));
        assert!(cylinder(0.1, [1.0, 0.0], 1.0, z).contains("spans"));
        assert!(cylinder(0.1, [0.0, 1.0], f64::NAN, z).contains("length"));
        assert!(cylinder(0.1, [0.0, 1.0], 1.0, y).contains("zero direction"));
    }
}
