//! Laws of one joint beyond a linear spring and damper: transmission, friction on the link,
//! balance.
//!
//! Coordinates, forces and stiffnesses are those of the joint: rad, N m, N m/rad for a rotary one,
//! m, N, N/m for a prismatic one. The wind-up of a transmission is motor coordinate minus link
//! coordinate.

mod curve;
mod friction;
mod joint;
mod transmission;

pub use curve::Curve;
pub use friction::{LinkFriction, solve_link_friction};
pub use joint::JointLaw;
pub use transmission::{BoucWen, Elastic, Ripple, beyond_gap};

/// A spring that balances the link, or any load that repeats with its coordinate:
/// `C cos q + S sin q`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Counterbalance {
    /// C, N m (N).
    pub cosine: f64,
    /// S, N m (N).
    pub sine: f64,
}

impl Counterbalance {
    /// Torque (force) on the link at coordinate `q`, N m (N).
    pub fn torque(&self, q: f64) -> f64 {
        let (sin, cos) = q.sin_cos();
        self.cosine * cos + self.sine * sin
    }

    /// Potential energy, J, of which the torque is the negative slope: `S cos q - C sin q`.
    pub fn energy_j(&self, q: f64) -> f64 {
        let (sin, cos) = q.sin_cos();
        self.sine * cos - self.cosine * sin
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_balance_torque_is_the_slope_of_its_energy() {
        let balance = Counterbalance {
            cosine: 300.0,
            sine: -120.0,
        };
        let h = 1e-6;
        for q in [-2.0, -0.3, 0.0, 1.1, 3.0] {
            let slope = (balance.energy_j(q + h) - balance.energy_j(q - h)) / (2.0 * h);
            assert!((balance.torque(q) + slope).abs() < 1e-6, "{q}");
        }
    }

    /// A bar of mass m with its centre at r, held level at q = 0, weighs `m g r cos q` about its
    /// axis.
    #[test]
    fn verify_a_cosine_balances_a_bar_at_every_angle() {
        let (m, g, r) = (12.0, 9.81, 0.4);
        let balance = Counterbalance {
            cosine: m * g * r,
            sine: 0.0,
        };
        for q in [-1.2, 0.0, 0.7, 2.5f64] {
            assert!((balance.torque(q) - m * g * r * q.cos()).abs() < 1e-12);
        }
    }
}
