//! Part of a circular cylinder as a patch, for tests: its curvatures are known.

use nalgebra::{Unit, Vector3};

use super::{Domain, Forms, Jet, Surface};

/// Part of a circular cylinder: u turns about the axis, v runs along it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CylinderPatch {
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
    pub fn new(
        origin_m: Vector3<f64>,
        axis: Unit<Vector3<f64>>,
        zero_direction: Unit<Vector3<f64>>,
        radius_m: f64,
        angles_rad: [f64; 2],
        length_m: f64,
    ) -> Self {
        let flat = zero_direction.into_inner() - axis.into_inner() * axis.dot(&zero_direction);
        let zero = Unit::new_normalize(flat);
        Self {
            origin_m,
            axis: axis.into_inner(),
            radial: [zero.into_inner(), axis.cross(&zero)],
            radius_m,
            angles_rad,
            length_m,
        }
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

#[test]
fn verify_a_bore_is_concave_and_its_normal_points_inward() {
    let bore = CylinderPatch::new(
        Vector3::zeros(),
        Vector3::y_axis(),
        Vector3::z_axis(),
        -0.04,
        [-0.5, 0.5],
        0.1,
    );
    let jet = bore.jet(0.2, 0.5);
    let forms = Forms::of(&jet).expect("regular");
    let from_axis = Vector3::new(jet.point_m.x, 0.0, jet.point_m.z);
    assert!((from_axis.normalize() + forms.normal.into_inner()).norm() < 1e-12);
    assert!((forms.curvatures().min_per_m + 25.0).abs() < 1e-12);
}
