//! Eccentricity of a running surface, for any of the wheels.

/// Eccentricity as `WheelContact` has it: `δ = δ0 + e sin φ + e0 cos φ`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Eccentricity {
    /// A quarter of a turn after the wheel starts, m.
    pub eccentricity_m: f64,
    /// At the contact when the wheel starts, m.
    pub eccentricity_at_start_m: f64,
}

impl Eccentricity {
    /// What eccentricity adds to the indentation, m, and to its rate, m/s.
    pub fn at(&self, angle_rad: f64, spin_rad_s: f64) -> (f64, f64) {
        let (s, c) = angle_rad.sin_cos();
        (
            self.eccentricity_m * s + self.eccentricity_at_start_m * c,
            spin_rad_s * (self.eccentricity_m * c - self.eccentricity_at_start_m * s),
        )
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
            eccentricity_m: e,
            eccentricity_at_start_m: e0,
        };
        for angle in [0.0, 0.7, 2.9, 40.0] {
            let (d, rate) = plate.indentation_m(0.0, 0.0, 0.0, angle, 125.0);
            let ours = eccentricity.at(angle, 125.0);
            assert!((ours.0 - d).abs() < 1e-18 && (ours.1 - rate).abs() < 1e-15);
        }
    }
}
