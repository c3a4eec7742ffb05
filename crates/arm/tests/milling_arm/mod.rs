//! The arm of the posture study.

use std::path::Path;

use truecut_arm::Robot;

/// The reference arm with its spindle across the flange: tool z = flange x, tool y = flange y, tip
/// at (0.25, 0, 0.18) m in the flange. Inertia is the reference model's, not the asset's 0.82 of
/// it.
pub fn robot() -> Robot {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/irb6600_175_255");
    let config = folder.join("milling.toml");
    Robot::load(&folder.join("robot.urdf"), Some(&config), None)
        .expect("the asset loads")
        .scaled(1.0 / 0.82, 1.0, 1.0)
}
