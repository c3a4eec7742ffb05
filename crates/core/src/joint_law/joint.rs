//! All that a joint does beyond spring and damper, but for the friction of its bearings.

use std::sync::Arc;

use super::{BoucWen, Counterbalance, Curve, Ripple};

/// What a joint's transmission and link do beyond spring and damper.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointLaw {
    /// Viscous friction on the link, N m s/rad (N s/m).
    pub viscous: f64,
    /// Full width of the play, rad (m).
    pub gap: f64,
    /// Cubic stiffness, N m/rad³ (N/m³).
    pub cubic: f64,
    pub hysteresis: Option<BoucWen>,
    pub ripple: Option<Ripple>,
    pub counterbalance: Option<Counterbalance>,
    /// Constant torque on the link, N m (N).
    pub offset: f64,
    /// Torque on the link over its coordinate, N m (N).
    pub curve: Option<Arc<Curve>>,
}

impl JointLaw {
    /// Whether the joint rests where a linear one would.
    pub fn is_nominal(&self) -> bool {
        // Friction and hysteresis begin with nothing, and move no place of rest.
        let Self {
            gap,
            cubic,
            ripple,
            viscous: _,
            hysteresis: _,
            counterbalance: _,
            offset: _,
            curve: _,
        } = self;
        let elastic = *gap == 0.0 && *cubic == 0.0 && ripple.is_none();
        elastic && !self.loads_link()
    }

    /// What acts on the link beside the transmission and friction: a constant torque, a spring and
    /// a curve.
    fn on_link(&self) -> (f64, Option<Counterbalance>, Option<&Curve>) {
        // By name, so that a new part of the law is placed here or there, not forgotten.
        let Self {
            counterbalance,
            offset,
            curve,
            viscous: _,
            gap: _,
            cubic: _,
            hysteresis: _,
            ripple: _,
        } = self;
        (*offset, *counterbalance, curve.as_deref())
    }

    /// Where the link sees the motor, rad (m).
    pub fn seen(&self, motor: f64) -> f64 {
        self.ripple
            .map_or(motor, |ripple| motor + ripple.error(motor))
    }

    /// Change of [`JointLaw::seen`] per motor coordinate.
    pub fn gear(&self, motor: f64) -> f64 {
        self.ripple.map_or(1.0, |ripple| 1.0 + ripple.slope(motor))
    }

    /// Torque on the link that does not come through the transmission, N m (N).
    pub fn link_torque(&self, q: f64) -> f64 {
        let (offset, spring, curve) = self.on_link();
        let spring = spring.map_or(0.0, |spring| spring.torque(q));
        offset + spring + curve.map_or(0.0, |curve| curve.value(q))
    }

    /// Potential energy of [`JointLaw::link_torque`], J.
    pub fn link_energy_j(&self, q: f64) -> f64 {
        let (offset, spring, curve) = self.on_link();
        let spring = spring.map_or(0.0, |spring| spring.energy_j(q));
        spring - offset * q - curve.map_or(0.0, |curve| curve.integral(q))
    }

    /// Whether [`JointLaw::link_torque`] is ever there.
    pub fn loads_link(&self) -> bool {
        let (offset, spring, curve) = self.on_link();
        offset != 0.0 || spring.is_some() || curve.is_some()
    }
}
