//! The closed-form spoke of the published surface table, for tests.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::{Domain, Jet, Surface};

/// r(u, v) = (200 u, y, 25 sin πu − 0.006 (1 − u/2) y²) mm, y = 80 (v − ½).
pub(crate) struct Spoke;

impl Surface for Spoke {
    fn domain(&self) -> Domain {
        Domain::UNIT
    }

    fn jet(&self, u: f64, v: f64) -> Jet {
        let y = 80.0 * (v - 0.5);
        let (sin, cos) = (PI * u).sin_cos();
        let taper = 1.0 - 0.5 * u;
        let mm = |x, y, z| Vector3::new(x, y, z) * 1e-3;
        Jet {
            point_m: mm(200.0 * u, y, 25.0 * sin - 0.006 * taper * y * y),
            first_m: [
                mm(200.0, 0.0, 25.0 * PI * cos + 0.003 * y * y),
                mm(0.0, 80.0, -0.96 * taper * y),
            ],
            second_m: [
                mm(0.0, 0.0, -25.0 * PI * PI * sin),
                mm(0.0, 0.0, 0.48 * y),
                mm(0.0, 0.0, -76.8 * taper),
            ],
        }
    }
}
