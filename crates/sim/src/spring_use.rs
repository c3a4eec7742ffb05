//! How far the springs of the transmissions are wound up, beside the range in which they are
//! straight lines.

use crate::build::Prepared;
use crate::plant::JointState;
use truecut_arm::JointKind;
use truecut_recording::{Outcome, Scalar, Unit};
use truecut_scenario::DriveKind;

/// The largest part of its linear range to which a spring was wound up.
pub(crate) struct SpringUse {
    springs: Vec<Spring>,
    largest: f64,
    /// Which spring it was, and when.
    spring: usize,
    time_s: f64,
}

/// The spring of a joint.
struct Spring {
    joint: usize,
    name: String,
    kind: JointKind,
    /// rad or m.
    linear_to: f64,
}

impl Spring {
    /// The range as `robot.toml` would give it.
    fn key(&self) -> String {
        let unit = match self.kind {
            JointKind::Revolute => "rad",
            JointKind::Prismatic => "m",
        };
        format!("linear_to_{unit} = {}", self.linear_to)
    }
}

impl SpringUse {
    /// The springs between motors and links: none where drives give forces, or act on the link.
    pub(crate) fn new(prepared: &Prepared) -> Self {
        let joints = prepared.robot.chain.joints.iter().enumerate();
        let springs = joints
            .skip(prepared.base_joints)
            .filter(|(_, joint)| {
                let transmission = &joint.transmission;
                transmission.stiffness.is_some() && !transmission.rigid_servo
            })
            .filter(|_| prepared.kind != DriveKind::Force)
            .map(|(index, joint)| Spring {
                joint: index,
                name: joint.name.clone(),
                kind: joint.kind,
                linear_to: joint.linear_to(),
            });
        Self {
            springs: springs.collect(),
            largest: 0.0,
            spring: 0,
            time_s: 0.0,
        }
    }

    /// Takes the joints' state at an instant.
    pub(crate) fn watch(&mut self, time_s: f64, state: &JointState) {
        for (at, spring) in self.springs.iter().enumerate() {
            let windup = state.motor[spring.joint] - state.position[spring.joint];
            let share = windup.abs() / spring.linear_to;
            if share > self.largest {
                (self.largest, self.spring, self.time_s) = (share, at, time_s);
            }
        }
    }

    /// The result; none if no joint has a spring.
    pub(crate) fn scalar(&self) -> Option<Scalar> {
        let spring = self.springs.get(self.spring)?;
        let text = format!(
            "Largest wind-up of a transmission, as a share of the range in which its spring is a \
             straight line: joint `{}`, {}, at {:.4} s",
            spring.name,
            spring.key(),
            self.time_s
        );
        let name = "plant.windup_use_max";
        Some(Scalar::new(name, Unit::One, self.largest, text))
    }

    /// How a run that came to its end has ended: beyond the model, if a spring was wound up further
    /// than it is a straight line.
    pub(crate) fn outcome(&self) -> Outcome {
        match self.springs.get(self.spring) {
            Some(spring) if self.largest > 1.0 => Outcome::BeyondModel {
                quantity: format!(
                    "the wind-up of joint `{}` (at {:.4} s)",
                    spring.name, self.time_s
                ),
                value: self.largest * spring.linear_to,
                limit: spring.linear_to,
                rule: format!(
                    "its spring is a straight line no further ({} in robot.toml, with its source)",
                    spring.key()
                ),
            },
            _ => Outcome::Completed,
        }
    }
}
