//! The `[joint.servo]` table.

use super::{ConfigReader, Key, RawJoint, RawServo, Rule};
use crate::error::{ArmError, ArmErrorKind};
use crate::model::{JointKind, Servo};

impl ConfigReader<'_> {
    /// The servo and the source of its values, `None` if any of them is wrong.
    pub(super) fn servo(
        &self,
        raw: &RawJoint,
        servo: &RawServo,
        kind: JointKind,
        faults: &mut Vec<ArmError>,
    ) -> Option<(Servo, String)> {
        let name = raw.name.get_ref();
        let source = raw.source.servo.as_deref();
        let mut needed = |key: Key| {
            let before = faults.len();
            let found = self.value(name, kind, &key, source, faults);
            if found.is_none() && faults.len() == before {
                let missing = match kind {
                    JointKind::Revolute => key.revolute.0,
                    JointKind::Prismatic => key.prismatic.0,
                };
                let message = format!("joint \"{name}\": [joint.servo] lacks `{missing}`");
                let at = servo.position_gain_per_s.span().start;
                faults.push(self.error(at, ArmErrorKind::Toml(message)));
            }
            found
        };
        let position_gain = Some(servo.position_gain_per_s.clone());
        let position = ("position_gain_per_s", &position_gain);
        let position = needed(Key {
            revolute: position,
            prismatic: position,
            source: "servo",
            rule: Rule::Positive,
        });
        let velocity = needed(key!(
            servo.velocity_gain_nm_s_per_rad,
            velocity_gain_n_s_per_m,
            "servo",
            Positive
        ));
        let limit = key!(servo.torque_limit_nm, force_limit_n, "servo", Positive);
        let limit = needed(limit);
        let forward = key!(
            servo.velocity_feed_forward,
            velocity_feed_forward,
            "servo",
            NotNegative
        );
        let forward = self.value(name, kind, &forward, source, faults);
        let (torque_limit, text) = limit?;
        let servo = Servo {
            position_gain_per_s: position?.0,
            velocity_gain: velocity?.0,
            torque_limit,
            velocity_feed_forward: forward.map_or(1.0, |(share, _)| share),
        };
        Some((servo, text))
    }
}
