//! Eccentricity of a running surface, for any of the wheels.

/// Eccentricity of a wheel that has turned by φ since its start: it adds `e0 cos φ + e sin φ` to
/// the radius at the contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Eccentricity {
    /// e0, at the contact when the wheel starts, m.
    pub at_start_m: f64,
    /// e, a quarter of a turn after the wheel starts, m.
    pub quarter_later_m: f64,
}

impl Eccentricity {
    /// Whether the surface runs true.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// What eccentricity adds to the radius, m, and to its rate, m/s.
    pub fn at(&self, angle_rad: f64, spin_rad_s: f64) -> [f64; 2] {
        let (e0, e) = (self.at_start_m, self.quarter_later_m);
        let (sin, cos) = angle_rad.sin_cos();
        [e0 * cos + e * sin, spin_rad_s * (e * cos - e0 * sin)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wheel::WheelContact;

    #[test]
    fn verify_eccentricity_is_that_of_the_wheel_on_a_plate() {
        let (e, e0) = (20e-6, -7e-6);
        let plate = WheelContact {
            radius_m: 0.075,
            width_m: 0.025,
            stiffness_n_per_m: 4e4,
            damping_n_s_per_m: 50.0,
            mu: 0.4,
            eccentricity_m: e,
            eccentricity_at_start_m: e0,
        };
        let eccentricity = Eccentricity {
            at_start_m: e0,
            quarter_later_m: e,
        };
        for angle in [0.0, 0.7, 2.9, 40.0] {
            let (d, rate) = plate.indentation_m(0.0, 0.0, 0.0, angle, 125.0);
            let ours = eccentricity.at(angle, 125.0);
            assert!((ours[0] - d).abs() < 1e-18 && (ours[1] - rate).abs() < 1e-15);
        }
    }
}
