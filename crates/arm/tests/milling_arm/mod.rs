//! The arm of the posture study.

use std::path::Path;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::Robot;

/// The reference arm with its spindle across the flange: tool z = flange x, tool y = flange y, tip at (0.25, 0, 0.18) m in the
/// flange. Inertia is the reference model's, not the asset's 0.82 of it.
pub fn robot() -> Robot {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets/robots/irb6600_175_255/robot.urdf");
    let mut robot = Robot::load(&urdf, None, None)
        .expect("the asset loads")
        .scaled(1.0 / 0.82, 1.0, 1.0);
    let axes = Matrix3::from_columns(&[-Vector3::z(), Vector3::y(), Vector3::x()]);
    robot.frames.flange_from_tool = Isometry3::from_parts(
        Translation3::new(0.25, 0.0, 0.18),
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes)),
    );
    robot
}
