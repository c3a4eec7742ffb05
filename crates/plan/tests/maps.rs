//! Stiffness at the tool, its sections, and the maps over joints 2 and 3.

use crate::milling_arm::robot;
use crate::support::slot;
use nalgebra::{Matrix3, Vector3};
use truecut_arm::FrameId;
use truecut_core::chatter::DirectionalMatrix;
use truecut_core::chatter::averaged::mode_coupling_limit;
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_core::stiffness::PlanarDefinition;
use truecut_plan::map::{MapCells, MapRequest, axis_directions, joint_map};
use truecut_plan::section::tool_stiffness;
use truecut_plan::{Cut, SingularityLimits};

/// P1, θr = 20°, degrees (`docs/physics/stability.md`, An arm).
const P1_DEG: [f64; 6] = [-43.1717, 33.4476, 5.1977, -72.4716, 110.6398, 131.8613];

/// Aluminium with two teeth.
fn cut() -> Cut {
    let aluminium = DirectionalMatrix::planar(2, 767e6, 0.22, Engagement::SLOT);
    slot(&aluminium, 0.3e-3, 2400.0)
}

fn request(tool_axis: nalgebra::Unit<Vector3<f64>>) -> MapRequest {
    let across = if tool_axis.x.abs() > 0.5 {
        Vector3::y()
    } else {
        Vector3::x()
    };
    MapRequest {
        joint_1_rad: P1_DEG[0].to_radians(),
        tool_axis,
        zero_direction: across,
        redundancy_angle_rad: 20_f64.to_radians(),
        feed: across,
        singularity: SingularityLimits::default(),
    }
}

/// The cell at P1's joints 2 and 3 holds P1's posture (one of its two wrists) and r = 0.60. Its
/// limit is that of the arm's own damping; with the printed one, 0.02 in every mode, its modes have
/// the printed limit, 2.27 mm.
#[test]
fn verify_the_map_holds_the_printed_posture() {
    let (robot, cut) = (robot(), cut());
    let cells = MapCells::new(&robot, &cut, &request(-Vector3::z_axis())).expect("a map");
    let [q2, q3] = [P1_DEG[1], P1_DEG[2]].map(f64::to_radians);
    let cell = cells.cell(q2, q3).expect("modes").expect("in reach");
    let tip = robot
        .world_from_frame(&cell.posture, FrameId::Tool)
        .translation
        .vector;
    assert!(
        (tip - Vector3::new(1.050, -1.450, 0.870)).norm() < 1e-5,
        "{tip}"
    );
    assert!(
        (cell.anisotropy - (1.0 - 0.615 / 1.535)).abs() < 1e-3,
        "{}",
        cell.anisotropy
    );
    let average = cut.directional().average_pa();
    let mut modes = robot
        .tip_modes(&cell.posture, FrameId::Tool, None)
        .expect("stiffness");
    let own = mode_coupling_limit(&modes, &average)
        .expect("a limit")
        .depth_m;
    assert!(
        (cell.limit_depth_m / own - 1.0).abs() < 1e-6,
        "{} {own}",
        cell.limit_depth_m
    );
    modes.iter_mut().for_each(|m| m.damping_ratio = 0.02);
    let printed = mode_coupling_limit(&modes, &average)
        .expect("a limit")
        .depth_m;
    assert!((printed / 2.27e-3 - 1.0).abs() < 0.02, "{printed}");
}

/// In every cell of the three maps joints 1 to 3 and the tool axis are what was asked, and values
/// are those of the posture.
#[test]
fn maps_hold_the_tool_axis() {
    let (robot, cut) = (robot(), cut());
    for axis in axis_directions() {
        let asked = request(axis);
        let map = joint_map(&robot, &cut, &asked, 15_f64.to_radians()).expect("a map");
        let mut held = 0;
        for (row, q2) in map.cells.iter().zip(&map.joint_2_rad) {
            for (cell, q3) in row.iter().zip(&map.joint_3_rad) {
                let Some(cell) = cell else { continue };
                held += 1;
                let tool = robot.world_from_frame(&cell.posture, FrameId::Tool);
                assert!((tool * Vector3::z() - axis.into_inner()).norm() < 1e-9);
                let joints = [asked.joint_1_rad, *q2, *q3];
                assert!(
                    joints
                        .iter()
                        .zip(&cell.posture)
                        .all(|(a, b)| (a - b).abs() < 1e-6)
                );
                assert!((0.0..1.0).contains(&cell.anisotropy) && cell.limit_depth_m > 0.0);
            }
        }
        assert!(held > 50, "{held} cells for {axis:?}");
    }
}

/// Sections at P1, θr = 20° against the printed free ones, and what each definition must satisfy:
/// held ≥ free, the ellipsoid's section between them in neither sense a load, the roots of the free
/// ones.
#[test]
fn verify_sections_of_the_ellipsoid() {
    let robot = robot();
    let q = P1_DEG.map(f64::to_radians);
    let axes = Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::z()]);
    let found = tool_stiffness(&robot, &q, &axes).expect("compliant");
    let of = |wanted| {
        let section = found.sections.iter().find(|(one, _)| *one == wanted);
        section.expect("all four").1
    };
    let free = of(PlanarDefinition::Free);
    assert!((free.min / 0.615e6 - 1.0).abs() < 2e-3 && (free.max / 1.535e6 - 1.0).abs() < 2e-3);
    let held = of(PlanarDefinition::Held);
    assert!(held.min > free.min && held.max > free.max);
    let root = of(PlanarDefinition::RootSection);
    assert!((root.max.powi(2) / free.max - 1.0).abs() < 1e-9);
    let axes = found.ellipsoid.semi_axes_n_per_m;
    for (definition, section) in found.sections {
        if definition != PlanarDefinition::RootSection {
            assert!(section.min >= axes.x * (1.0 - 1e-9) && section.max <= axes.z * (1.0 + 1e-9));
        }
    }
}
