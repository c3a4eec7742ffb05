//! The milling arm in rapier at five redundancy angles, against mode coupling and semi-discretisation.

use crate::support::{milling, run, scalar, scenario};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;
use truecut_arm::{BranchOptions, FrameId, Robot, tool_pose};
use truecut_core::chatter::averaged::mode_coupling_limit;
use truecut_core::chatter::limit::{LimitSearch, first_limit};
use truecut_core::chatter::semi_discretisation::{SemiDiscretisation, recommended_steps};
use truecut_core::chatter::{DirectionalMatrix, TipMode, in_axes};
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_scenario::Scenario;

/// A slot in 45 steel with four teeth at P1.
const SLOT: &str = r#"
name = "slot"
[robot]
urdf = "../../assets/robots/irb6600_175_255/robot.urdf"
config = "../../assets/robots/irb6600_175_255/milling.toml"
inertia_scale = 1.2195121951219512
[process.milling]
spindle_rpm = 2400
feed_mm_per_tooth = 0.01
axial_depth_mm = 0.3
engagement = "slot"
start_angle_deg = 0.5
[process.milling.cutter]
diameter_mm = 20
teeth = 4
[process.milling.material]
file = "../../assets/materials/steel_45.toml"
set = "steel45_linear"
[process.milling.path]
start_mm = [1050, -1450, 870]
direction = [1, 0, 0]
length_mm = 30
redundancy_deg = 120
shoulder = "front"
elbow = "upper"
"#;

const PERIOD_S: f64 = 60.0 / (2400.0 * 4.0);

fn slot(angle_deg: f64, depth_m: f64, regeneration: bool, duration_s: f64) -> Scenario {
    scenario(
        SLOT,
        &[
            ("process.milling.path.redundancy_deg", format!("{angle_deg:?}")),
            ("process.milling.axial_depth_mm", format!("{:?}", depth_m * 1e3)),
            ("process.milling.regeneration", regeneration.to_string()),
            ("run.duration_s", format!("{duration_s:?}")),
        ],
    )
}

#[test]
fn explore() {
    for angle in [20.0, 60.0, 120.0, 160.0, 220.0] {
        let end = run(&slot(angle, 0.3e-3, true, 0.2));
        let coupling = scalar(&end, "theory.mode_coupling_depth");
        let zero = scalar(&end, "theory.regenerative_depth");
        println!(
            "{angle} coupling {:.4} mm at {:.2} Hz, regen {:.4} mm at {:.2} Hz, dt {:.3e}",
            coupling * 1e3,
            scalar(&end, "theory.mode_coupling_frequency"),
            zero * 1e3,
            scalar(&end, "theory.regenerative_frequency"),
            scalar(&end, "run.time_step")
        );
        for (share, regeneration, duration) in [(0.9, false, 4.0), (1.1, false, 4.0), (0.9, true, 8.0), (1.1, true, 8.0)] {
            let depth = share * if regeneration { zero } else { coupling };
            let start = std::time::Instant::now();
            let end = run(&slot(angle, depth, regeneration, duration));
            println!(
                "   {share} {regeneration}: growth {:.3} level {:.2e} f {:.2} a {:.2e} defl {:.2e} in {:.2} s",
                scalar(&end, "milling.growth_rate"),
                scalar(&end, "milling.vibration_level"),
                scalar(&end, "milling.chatter_frequency"),
                scalar(&end, "milling.chatter_amplitude"),
                scalar(&end, "milling.floor_error"),
                start.elapsed().as_secs_f64()
            );
        }
    }
}
