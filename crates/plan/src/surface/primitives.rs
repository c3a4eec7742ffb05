//! Planes as patches.

use nalgebra::Vector3;

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

pub(super) fn finite(what: &'static str, vector: &Vector3<f64>) -> Result<(), SurfaceFault> {
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
    }
}
