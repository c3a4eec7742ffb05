//! Robots among the assets.

use std::path::Path;

use truecut_arm::Robot;

/// The robot of that name.
pub fn robot(name: &str) -> Robot {
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    let urdf = robots.join(name).join("robot.urdf");
    Robot::load(&urdf, None, None).expect("the asset loads")
}
