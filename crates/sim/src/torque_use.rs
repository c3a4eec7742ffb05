//! What is asked of the drives beside what they can give.

use crate::build::Prepared;
use crate::plant::Plant;
use truecut_arm::{FrameId, Joint, directional_stiffness};
use truecut_recording::{Scalar, Unit};
use truecut_scenario::DriveKind;

/// The largest share of its limit that a drive was asked for.
pub(crate) struct TorqueUse {
    /// Name and limit of every joint that has one, by its index.
    limits: Vec<(usize, String, f64)>,
    largest: f64,
    joint: usize,
    time_s: f64,
}

impl TorqueUse {
    /// Limits of the joints; none for joints that are not driven.
    pub(crate) fn new(prepared: &Prepared) -> Self {
        let joints = prepared.robot.chain.joints.iter().enumerate();
        let limits = joints
            .filter(|_| prepared.kind != DriveKind::Force)
            .map(|(index, joint)| (index, joint.name.clone(), limit(joint)))
            .filter(|(_, _, limit)| limit.is_finite() && *limit > 0.0);
        Self {
            limits: limits.collect(),
            largest: 0.0,
            joint: 0,
            time_s: 0.0,
        }
    }

    /// Takes the drives' torques at an instant.
    pub(crate) fn watch(&mut self, time_s: f64, plant: &dyn Plant) {
        for (at, (joint, _, limit)) in self.limits.iter().enumerate() {
            let share = plant.drive_torque(*joint).abs() / limit;
            if share > self.largest {
                (self.largest, self.joint, self.time_s) = (share, at, time_s);
            }
        }
    }

    /// The result; `None` if no joint has a limit.
    pub(crate) fn scalar(&self) -> Option<Scalar> {
        let (_, name, limit) = self.limits.get(self.joint)?;
        let text = format!(
            "Largest torque asked of a drive over its limit: joint `{name}`, limit {limit}, at {:.4} s",
            self.time_s
        );
        Some(Scalar::new(
            "plant.torque_use_max",
            Unit::One,
            self.largest,
            text,
        ))
    }
}

/// The limit that `robot.toml` gives, or the URDF where it gives none; infinite where nobody does.
fn limit(joint: &Joint) -> f64 {
    let of_urdf = || joint.limits.map_or(f64::INFINITY, |limits| limits.effort);
    joint
        .transmission
        .servo
        .map_or_else(of_urdf, |servo| servo.torque_limit)
}

/// What the servo's loops do to the stiffness of the arm; `None` for other drives.
pub(crate) fn servo_note(prepared: &Prepared) -> Option<String> {
    if prepared.kind != DriveKind::Servo {
        return None;
    }
    let along_tool = |robot: &truecut_arm::Robot| {
        let compliance = robot.process_compliance(&prepared.start, FrameId::Tool);
        compliance.map(|c| directional_stiffness(&c, &nalgebra::Vector3::x_axis()))
    };
    let mut held = truecut_arm::Robot::clone(&prepared.robot);
    let mut loops = Vec::new();
    for (index, joint) in held.chain.joints.iter_mut().enumerate() {
        let transmission = &mut joint.transmission;
        let (Some(stiffness), Some(servo)) = (transmission.stiffness, transmission.servo) else {
            continue;
        };
        let of_loop = servo.static_stiffness();
        transmission.stiffness = Some(1.0 / (1.0 / stiffness + 1.0 / of_loop));
        loops.push(format!(
            "joint{} {of_loop:.3e} beside {stiffness:.3e}",
            index + 1
        ));
    }
    let ratio = match (along_tool(&prepared.robot), along_tool(&held)) {
        (Ok(alone), Ok(held)) => format!(
            "; under a lasting force along the tool the arm is {:.2} times as soft as with drive = \"position\"",
            alone / held
        ),
        _ => String::new(),
    };
    Some(format!(
        "drive = \"servo\" has no integral action: its position loop gives way like a spring in series with \
         each transmission (static stiffness of the loop beside the transmission's, SI: {}){ratio}",
        loops.join(", ")
    ))
}
