//! The pressure foot as part of a process: normal spring by the core, friction by request.

pub(crate) mod setup;

use super::quantity::Quantity;
use super::{ContactStiffness, FrameMotion, ToolState};
use crate::effect::FootEffects;
use crate::loads::{Attachment, ContactOutcome, ContactRequest, Loads, Wrench};
use nalgebra::{Vector2, Vector3};
use truecut_core::friction::{EquivalentViscous, FootFriction, FrictionLaw};
use truecut_core::pressure_foot::{FootForce, FootMemory, PressureFoot};
use truecut_recording::Unit;

/// The same friction times a factor, or falling with the speed. A law without friction stays
/// without; the equivalent viscous law has no speed to fall with (both are refused where effects
/// are read).
pub(crate) fn with_effects(friction: FootFriction, effects: &FootEffects) -> FootFriction {
    let by = |mu: f64| mu * effects.friction_factor;
    let law = match friction {
        FootFriction::Equivalent(e) => {
            return FootFriction::Equivalent(EquivalentViscous { mu: by(e.mu), ..e });
        }
        FootFriction::Law(law) => law,
    };
    let (mu, mu_static, speed) = match law {
        FrictionLaw::Coulomb { mu } => (by(mu), by(mu), 1.0),
        FrictionLaw::Stribeck {
            mu,
            mu_static,
            stribeck_speed_m_per_s,
        } => (by(mu), by(mu_static), stribeck_speed_m_per_s),
        FrictionLaw::None | FrictionLaw::Viscous { .. } | FrictionLaw::Falling { .. } => {
            return friction;
        }
    };
    FootFriction::Law(match (effects.falling, law) {
        (Some((drop, falling_speed_m_per_s)), _) => FrictionLaw::Falling {
            mu,
            mu_static,
            stribeck_speed_m_per_s: speed,
            drop,
            falling_speed_m_per_s,
        },
        (None, FrictionLaw::Coulomb { .. }) => FrictionLaw::Coulomb { mu },
        (None, _) => FrictionLaw::Stribeck {
            mu,
            mu_static,
            stribeck_speed_m_per_s: speed,
        },
    })
}

/// All that a foot is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FootParameters {
    pub spring: PressureFoot,
    pub friction: FootFriction,
    /// Part of the gauge pressure lost per second, 1/s: `p = p0 exp(-rate t)`.
    pub pressure_loss_per_s: f64,
    /// Part of the gas's absolute pressure that is gauge pressure; 0 for a spring that is not gas.
    pub gauge_share: f64,
}

/// A foot and what it remembers.
#[derive(Debug, Clone)]
pub struct Foot {
    parameters: FootParameters,
    memory: FootMemory,
    amplitude: AmplitudeOfRevolution,
    last: FootStep,
}

/// Values of the last committed step.
#[derive(Debug, Clone, Copy, Default)]
struct FootStep {
    normal_n: f64,
    lifted: bool,
    friction_on_workpiece_n: Vector2<f64>,
    sliding: bool,
    slip_speed_m_per_s: f64,
}

/// Peak lateral excursion of the revolution just finished, about its mean.
#[derive(Debug, Clone, Copy, Default)]
struct AmplitudeOfRevolution {
    finished_m: f64,
    running_low_m: Vector2<f64>,
    running_high_m: Vector2<f64>,
    revolution: i64,
}

impl AmplitudeOfRevolution {
    fn observe(&mut self, revolution: i64, lateral_m: Vector2<f64>) {
        if revolution != self.revolution {
            self.finished_m = (self.running_high_m - self.running_low_m).amax() / 2.0;
            self.running_low_m = lateral_m;
            self.running_high_m = lateral_m;
            self.revolution = revolution;
        }
        self.running_low_m = self.running_low_m.inf(&lateral_m);
        self.running_high_m = self.running_high_m.sup(&lateral_m);
    }
}

impl Foot {
    pub fn new(parameters: FootParameters) -> Self {
        Self {
            parameters,
            memory: FootMemory::default(),
            amplitude: AmplitudeOfRevolution::default(),
            last: FootStep {
                normal_n: parameters.spring.preload_n,
                ..FootStep::default()
            },
        }
    }

    pub fn parameters(&self) -> &FootParameters {
        &self.parameters
    }

    /// What is recorded of the step last committed.
    pub(super) fn quantities(&self) -> [Quantity; 6] {
        let (last, friction) = (&self.last, self.last.friction_on_workpiece_n);
        let flag = |on: bool| f64::from(u8::from(on));
        [
            Quantity::new("foot.normal_force", Unit::Newton, last.normal_n)
                .text("Force with which the foot presses on the workpiece"),
            Quantity::new("foot.friction_y", Unit::Newton, friction.x)
                .text("Friction of the foot on the workpiece, process Y"),
            Quantity::new("foot.friction_z", Unit::Newton, friction.y)
                .text("Friction of the foot on the workpiece, process Z"),
            Quantity::new("foot.sliding", Unit::One, flag(last.sliding))
                .text("1 while the foot slides or is lifted, 0 while it sticks"),
            Quantity::new(
                "foot.slip_speed",
                Unit::MetrePerSecond,
                last.slip_speed_m_per_s,
            )
            .text("Speed of the foot over the workpiece"),
            Quantity::new("foot.lifted", Unit::One, flag(last.lifted))
                .text("1 while the foot is off the workpiece"),
        ]
    }

    fn spring(&self, time_s: f64) -> PressureFoot {
        let p = &self.parameters;
        if p.pressure_loss_per_s == 0.0 {
            return p.spring;
        }
        let left = (-p.pressure_loss_per_s * time_s).exp();
        p.spring.at_pressure(left, p.gauge_share)
    }

    fn force(&self, time_s: f64, motion: &FrameMotion) -> FootForce {
        self.spring(time_s)
            .force(motion.displacement_m.x, &self.memory)
    }

    /// Adds the normal force on the robot and the friction request.
    pub fn press(&self, state: &ToolState, loads: &mut Loads) {
        let normal_force_n = self.force(state.time_s, &state.foot).normal_n;
        let law = match self.parameters.friction {
            FootFriction::Law(law) => law,
            FootFriction::Equivalent(e) => FrictionLaw::Viscous {
                coefficient_n_s_per_m: e
                    .coefficient_n_s_per_m(normal_force_n, self.amplitude.finished_m),
            },
        };
        let force_n = Vector3::new(-normal_force_n, 0.0, 0.0);
        let wrench = Wrench::force(Attachment::Foot, force_n);
        loads.wrenches.push(wrench);
        loads.contacts.push(ContactRequest {
            frame: Attachment::Foot,
            normal_force_n,
            law,
        });
    }

    /// Advances seals and amplitude; keeps what will be recorded.
    pub fn commit(&mut self, time_s: f64, motion: &FrameMotion, outcome: &ContactOutcome) {
        let force = self.force(time_s, motion);
        self.memory = self
            .spring(time_s)
            .commit(motion.displacement_m.x, &self.memory);
        if let FootFriction::Equivalent(e) = self.parameters.friction {
            let revolution = (time_s * e.frequency_rad_s / std::f64::consts::TAU).floor() as i64;
            self.amplitude
                .observe(revolution, motion.displacement_m.yz());
        }
        self.last = FootStep {
            normal_n: force.normal_n,
            lifted: force.lifted,
            friction_on_workpiece_n: -outcome.friction_n,
            sliding: outcome.sliding || force.lifted,
            slip_speed_m_per_s: outcome.velocity_m_per_s.norm(),
        };
    }

    /// Whether the foot slid (or hung free) in the step last committed.
    pub fn sliding(&self) -> bool {
        self.last.sliding
    }

    /// Force on the workpiece in the step last committed: normal along X, friction in Y and Z, N.
    pub fn force_on_workpiece_n(&self) -> Vector3<f64> {
        let f = self.last.friction_on_workpiece_n;
        Vector3::new(self.last.normal_n, f.x, f.y)
    }

    /// Preload at touch-down: the foot presses, its friction is still unloaded.
    pub fn touch_down_wrench(&self) -> Wrench {
        let preload = self.parameters.spring.preload_n;
        Wrench::force(Attachment::Foot, Vector3::new(-preload, 0.0, 0.0))
    }

    /// The stiffest state of the foot along X.
    pub fn contact_stiffness(&self) -> ContactStiffness {
        let spring = &self.parameters.spring;
        let rod = if spring.seal_stiction_n > 0.0 {
            spring.rod_stiffness_n_per_m
        } else {
            0.0
        };
        ContactStiffness {
            frame: Attachment::Foot,
            direction: Vector3::x(),
            stiffness_n_per_m: spring.gas_stiffness_n_per_m + rod,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_amplitude_is_half_the_range_of_the_finished_revolution() {
        let mut amplitude = AmplitudeOfRevolution::default();
        for i in 0..400 {
            let t = i as f64 / 100.0;
            let a = 1e-5 * (1.0 + t.floor());
            let phase = std::f64::consts::TAU * t;
            amplitude.observe(
                t.floor() as i64,
                Vector2::new(a * phase.cos() + 3e-4, 0.5 * a * phase.sin()),
            );
        }
        // the fourth revolution runs; the third had an amplitude of 30 µm about 300 µm
        assert!((amplitude.finished_m - 3e-5).abs() < 1e-7);
    }
}
