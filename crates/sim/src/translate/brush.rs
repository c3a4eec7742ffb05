//! From the brush table and its solved way to the process that runs.

use crate::brush_path::BrushWork;
use crate::effect::WheelEffects;
use crate::process::{BrushProcess, BrushSetup};
use crate::scene::Workpiece;
use nalgebra::{Isometry3, Vector3};
use truecut_arm::{FrameId, Robot};
use truecut_core::wheel::brush::Brush;
use truecut_scenario::BrushSpec;

/// The process along a solved way, and its workpiece.
pub(super) fn brush(
    spec: &BrushSpec,
    effects: &WheelEffects,
    work: &BrushWork,
    robot: &Robot,
    posture: &[f64],
    world_from_process: &Isometry3<f64>,
    duration_s: f64,
) -> (BrushProcess, Workpiece) {
    let mut stations = work.stations.clone();
    for station in &mut stations {
        station.wear.preston_per_pa *= effects.removal_factor;
    }
    let world_from_tool = robot.world_from_frame(posture, FrameId::Tool);
    let workpiece = Workpiece::Mesh {
        process_from_mesh: world_from_process.inverse() * work.world_from_mesh,
        mesh: work.mesh.clone(),
    };
    let setup = BrushSetup {
        brush: Brush {
            radius_m: spec.radius_m,
            width_m: spec.width_m,
            bristles: spec.bristles,
            bristle_diameter_m: spec.bristle_diameter_m,
            free_length_m: spec.free_length_m,
            youngs_modulus_pa: spec.youngs_modulus_pa * effects.stiffness_factor,
            mu: spec.mu * effects.friction_factor,
        },
        runout_m: effects.eccentricity_m,
        spin_rad_s: spec.spin_rad_s,
        mesh: work.mesh.clone(),
        world_from_mesh: work.world_from_mesh,
        stations,
        process_from_world: world_from_process.rotation.inverse(),
        approach: world_from_tool.rotation * Vector3::z(),
        duration_s,
    };
    (BrushProcess::new(setup), workpiece)
}
