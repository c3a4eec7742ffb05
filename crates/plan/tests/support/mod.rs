//! The cut of the posture study.

use truecut_core::chatter::{AttachedModes, DirectionalMatrix};
use truecut_core::cutting::milling::cutter::Cutter;
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_core::cutting::milling::nominal::NominalCut;
use truecut_plan::Cut;

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
        attached: AttachedModes::default(),
    }
}
