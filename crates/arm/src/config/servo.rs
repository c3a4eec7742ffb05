//! The `[joint.servo]` table.

use super::{ConfigReader, Key, RawJoint, RawServo, Rule};
use crate::error::{ArmError, ArmErrorKind};
use crate::model::{JointKind, Servo};

impl ConfigReader<'_> {
    /// The servo and the source of its values.
    pub(super) fn servo(
        &self,
        raw: &RawJoint,
        servo: &RawServo,
        kind: JointKind,
    ) -> Result<(Servo, String), ArmError> {
        let name = raw.name.get_ref();
        let source = raw.source.servo.as_deref();
        let position_gain = Some(servo.position_gain_per_s.clone());
        let keys = [
            (
                ("position_gain_per_s", &position_gain),
                ("position_gain_per_s", &position_gain),
            ),
            (
                (
                    "velocity_gain_nm_s_per_rad",
                    &servo.velocity_gain_nm_s_per_rad,
                ),
                ("velocity_gain_n_s_per_m", &servo.velocity_gain_n_s_per_m),
            ),
            (
                ("torque_limit_nm", &servo.torque_limit_nm),
                ("force_limit_n", &servo.force_limit_n),
            ),
        ];
        let mut values = [0.0; 3];
        let mut text = String::new();
        for (slot, (revolute, prismatic)) in values.iter_mut().zip(keys) {
            let key = Key {
                revolute,
                prismatic,
                source: "servo",
                rule: Rule::Positive,
            };
            let Some((value, found)) = self.value(name, kind, &key, source)? else {
                let missing = match kind {
                    JointKind::Revolute => key.revolute.0,
                    JointKind::Prismatic => key.prismatic.0,
                };
                let message = format!("joint \"{name}\": [joint.servo] lacks `{missing}`");
                let at = servo.position_gain_per_s.span().start;
                return Err(self.error(at, ArmErrorKind::Toml(message)));
            };
            (*slot, text) = (value, found);
        }
        let feed_forward = Key {
            revolute: ("velocity_feed_forward", &servo.velocity_feed_forward),
            prismatic: ("velocity_feed_forward", &servo.velocity_feed_forward),
            source: "servo",
            rule: Rule::NotNegative,
        };
        let feed_forward = self.value(name, kind, &feed_forward, source)?;
        let [position_gain_per_s, velocity_gain, torque_limit] = values;
        let servo = Servo {
            position_gain_per_s,
            velocity_gain,
            torque_limit,
            velocity_feed_forward: feed_forward.map_or(1.0, |(share, _)| share),
        };
        Ok((servo, text))
    }
}
