//! The milling arm in rapier at five redundancy angles, with the damping of its joints: teeth that
//! meet the nominal surface against mode coupling, teeth that meet their own against
//! semi-discretisation, stable at 0.9 of either limit and unstable at 1.1 of it. The two limits
//! differ by a factor of six to thirty.
//!
//! The feed is a tenth of a usual one: the floor's feedback, which grows with the feed and which
//! the theories leave out, is then a tenth of mode coupling's at the limit, and the posture changes
//! little while the tool travels.

use super::support::{grows, scenario};
use nalgebra::Vector3;
use truecut_arm::{BranchOptions, Elbow, FrameId, Robot, Shoulder, tool_pose};
use truecut_core::chatter::averaged::mode_coupling_limit;
use truecut_core::chatter::limit::{LimitSearch, first_limit};
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_core::chatter::{DirectionalMatrix, TipMode};
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
const ANGLES_DEG: [f64; 5] = [20.0, 60.0, 120.0, 160.0, 220.0];

/// Teeth that meet their own surface begin on a wedge: at depths that are large beside the feed a
/// cut that is at full depth from the start swings too far to be linear.
pub fn slot(angle_deg: f64, depth_m: f64, regeneration: bool, duration_s: f64) -> Scenario {
    let ramp_mm = if regeneration { 2.0 } else { 0.0 };
    scenario(
        SLOT,
        &[
            (
                "process.milling.path.redundancy_deg",
                format!("{angle_deg:?}"),
            ),
            (
                "process.milling.axial_depth_mm",
                format!("{:?}", depth_m * 1e3),
            ),
            ("process.milling.regeneration", regeneration.to_string()),
            ("process.milling.ramp_mm", format!("{ramp_mm:?}")),
            ("run.duration_s", format!("{duration_s:?}")),
        ],
    )
}

fn process() -> DirectionalMatrix {
    DirectionalMatrix::planar(4, 2e9, 0.3, Engagement::SLOT)
}

/// Modes at the start of the path, in the milling frame: the feed is along world x, the tool points
/// down. Solved anew from the robot's files.
fn modes(angle_deg: f64) -> Vec<TipMode> {
    let scenario = slot(angle_deg, 0.3e-3, true, 1.0);
    let spec = &scenario.robot;
    let robot = Robot::load(&spec.urdf, spec.config.as_deref(), None).expect("the asset loads");
    let robot = robot.scaled(spec.inertia_scale, 1.0, 1.0);
    let point = Vector3::new(1.050, -1.450, 0.870);
    let down = -Vector3::z_axis();
    let pose = tool_pose(&point, &down, &Vector3::x(), angle_deg.to_radians()).expect("square");
    let solver = robot.ik_solver(&BranchOptions::default());
    let geometry = solver.geometry().expect("ortho-parallel");
    let postures = solver.branches(&pose, FrameId::Tool);
    let upper_front = postures.into_iter().find(|q| {
        let branch = geometry.branch(q);
        (branch.shoulder, branch.elbow) == (Shoulder::Front, Elbow::Upper)
    });
    let q = upper_front.expect("in reach");
    robot.tip_modes(&q, FrameId::Tool, None).expect("stiffness")
}

/// Whether vibration grows at 0.9 and at 1.1 of a limit.
fn about(angle_deg: f64, limit_m: f64, regeneration: bool, duration_s: f64) -> [bool; 2] {
    [0.9, 1.1].map(|share| {
        println!("{angle_deg} deg, {regeneration}, {share} of {limit_m:.4e} m");
        grows(&slot(angle_deg, share * limit_m, regeneration, duration_s))
    })
}

#[test]
fn verify_arm_on_the_nominal_surface_has_the_limit_of_mode_coupling() {
    for angle_deg in ANGLES_DEG {
        let theory = mode_coupling_limit(&modes(angle_deg), &process().average_pa());
        let limit_m = theory.expect("a limit").depth_m;
        let found = about(angle_deg, limit_m, false, 3.0);
        assert_eq!(found, [false, true], "{angle_deg} deg");
    }
}

#[test]
fn verify_arm_on_its_own_surface_has_the_limit_of_spectral_elements() {
    for angle_deg in ANGLES_DEG {
        let modes = modes(angle_deg);
        let elements = SpectralElements::new(&modes, &process());
        let search = LimitSearch::to_depth(6e-3);
        let theory = first_limit(&elements, PERIOD_S, &search).expect("a limit");
        let coupling = mode_coupling_limit(&modes, &process().average_pa()).expect("a limit");
        assert!(theory.depth_m > 5.0 * coupling.depth_m, "{angle_deg} deg");
        let found = about(angle_deg, theory.depth_m, true, 3.5);
        assert_eq!(found, [false, true], "{angle_deg} deg");
    }
}
