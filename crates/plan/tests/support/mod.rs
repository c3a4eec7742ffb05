//! The arm and the cut of the posture study.

use std::path::Path;

use truecut_arm::Robot;
use truecut_core::chatter::DirectionalMatrix;
use truecut_core::cutting::milling::cutter::Cutter;
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_core::cutting::milling::nominal::NominalCut;
use truecut_plan::Cut;

/// The asset with its spindle across the flange and the reference model's inertia, of which the asset has 0.82.
#[allow(dead_code, reason = "some files of tests have an arm of their own")]
pub fn robot() -> Robot {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/irb6600_175_255");
    let config = folder.join("milling.toml");
    Robot::load(&folder.join("robot.urdf"), Some(&config), None)
        .expect("the asset loads")
        .scaled(1.0 / 0.82, 1.0, 1.0)
}

/// A slot with a cutter of 20 mm, 0.1 mm per tooth.
pub fn slot(process: &DirectionalMatrix, axial_depth_m: f64, rpm: f64) -> Cut {
    Cut {
        nominal: NominalCut {
            cutter: Cutter::straight(10e-3, process.teeth),
            coefficients: process.coefficients,
            engagement: Engagement::SLOT,
            axial_depth_m,
            feed_per_tooth_m: 0.1e-3,
        },
        spindle_rad_s: rpm * std::f64::consts::TAU / 60.0,
    }
}
