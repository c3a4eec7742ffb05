//! What is asked of the drives beside what they can give.

use crate::build::Prepared;
use crate::plant::Plant;
use truecut_arm::{FrameId, Joint, directional_stiffness};
use truecut_recording::{Outcome, Scalar, Unit};
use truecut_scenario::{DriveKind, FaultRule};

/// How near to its limit, as a part of it, a torque is that was cut off.
const CUT_OFF: f64 = 1e-9;

/// The largest share of its limit that a drive was asked for, and how long servos gave all that
/// they can.
pub(crate) struct TorqueUse {
    limits: Vec<DriveLimit>,
    largest: f64,
    joint: usize,
    time_s: f64,
    dt_s: f64,
    /// Whether the drives are servos, which cut their torque off at the limit.
    cuts_off: bool,
}

/// What a drive can give.
struct DriveLimit {
    joint: usize,
    /// Steps in which its servo gave all that it can.
    saturated: u64,
    name: String,
    /// N m or N.
    value: f64,
    unit: &'static str,
}

impl TorqueUse {
    /// Limits of the joints; none for joints that are not driven.
    pub(crate) fn new(prepared: &Prepared) -> Self {
        let limits = driven(prepared)
            .filter(|(_, joint)| limit(joint).is_finite())
            .map(|(index, joint)| DriveLimit {
                joint: index,
                saturated: 0,
                name: joint.name.clone(),
                value: limit(joint),
                unit: joint.kind.effort_unit(),
            });
        Self {
            limits: limits.collect(),
            largest: 0.0,
            joint: 0,
            time_s: 0.0,
            dt_s: 0.0,
            cuts_off: prepared.kind == DriveKind::Servo,
        }
    }

    /// Takes the drives' torques at an instant.
    pub(crate) fn watch(&mut self, time_s: f64, plant: &dyn Plant) {
        self.dt_s = plant.time_step_s();
        for (at, drive) in self.limits.iter_mut().enumerate() {
            let share = plant.drive_torque(drive.joint).abs() / drive.value;
            drive.saturated += u64::from(self.cuts_off && (share - 1.0).abs() < CUT_OFF);
            if share > self.largest {
                (self.largest, self.joint, self.time_s) = (share, at, time_s);
            }
        }
    }

    /// The results; none if no joint has a limit.
    pub(crate) fn scalars(&self) -> impl Iterator<Item = Scalar> {
        self.largest().into_iter().chain(self.longest_saturated())
    }

    /// How long the servo that saturates most gave all that it can.
    fn longest_saturated(&self) -> Option<Scalar> {
        let drive = self.limits.iter().max_by_key(|drive| drive.saturated)?;
        if drive.saturated == 0 {
            return None;
        }
        let text = format!(
            "Time for which a servo was at its torque limit: joint `{}`, limit {} {}",
            drive.name, drive.value, drive.unit
        );
        Some(Scalar::new(
            "plant.torque_saturated",
            Unit::Second,
            drive.saturated as f64 * self.dt_s,
            text,
        ))
    }

    fn largest(&self) -> Option<Scalar> {
        let drive = self.limits.get(self.joint)?;
        let text = format!(
            "Largest torque asked of a drive, as a share of its limit: joint `{}`, limit {} {}, at \
             {:.4} s",
            drive.name, drive.value, drive.unit, self.time_s
        );
        Some(Scalar::new(
            "plant.torque_use_max",
            Unit::One,
            self.largest,
            text,
        ))
    }
}

impl TorqueUse {
    /// How a run that came to its end has ended: overloaded, if more was asked of a drive than it
    /// gives and the scenario's rule is that this fails.
    pub(crate) fn outcome(&self, rule: FaultRule) -> Outcome {
        match self.limits.get(self.joint) {
            Some(drive) if self.largest > 1.0 && rule == FaultRule::Fail => Outcome::Overloaded {
                time_s: self.time_s,
                joint: drive.name.clone(),
                share: self.largest,
                limit: format!("{} {}", drive.value, drive.unit),
            },
            _ => Outcome::Completed,
        }
    }
}

/// The joints that have a drive, with their index.
fn driven(prepared: &Prepared) -> impl Iterator<Item = (usize, &Joint)> {
    let joints = prepared.robot.chain.joints.iter().enumerate();
    joints.filter(|(index, _)| *index >= prepared.base_joints && prepared.kind != DriveKind::Force)
}

/// Which drives have no limit, so that nobody can tell whether they are overloaded; `None` if all
/// have one.
pub(crate) fn unchecked_note(prepared: &Prepared) -> Option<String> {
    let unknown = driven(prepared).filter(|(_, joint)| !limit(joint).is_finite());
    let names: Vec<&str> = unknown.map(|(_, joint)| joint.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "no effort limit is known of {}: overload of these drives is not checked (0 in a URDF \
             counts as not given)",
            names.join(", ")
        )
    })
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
