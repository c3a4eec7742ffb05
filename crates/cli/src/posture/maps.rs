//! Maps over joints 2 and 3 for three directions of the tool axis.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use truecut_plan::map::{JointMap, MapCell, MapRequest, axis_directions, joint_map};
use truecut_plan::{LEAST_ANISOTROPY, SingularityLimits};
use truecut_sim::stability::in_scenario;

use super::PostureAnswer;
use crate::failure::Failure;

use crate::figure::{Figure, Layer, Legend, Panel};
use crate::progress::Progress;
use truecut::outputs::write_file;

/// Grid step of the maps.
const STEP_DEG: f64 = 4.0;

/// Writes the figure.
pub fn write(answer: &PostureAnswer<'_>, out: &Path) -> Result<PathBuf, Failure> {
    let study = answer.study;
    let first = &answer.plan.points[0];
    let axes = axis_directions();
    let progress = Progress::new(axes.len(), "maps over joints 2 and 3");
    let mut panels = Vec::new();
    for (axis, name) in axes.into_iter().zip(["down", "along x", "along y"]) {
        let _told = progress.run();
        // The tool's x axis and the feed are along the first world axis perpendicular to the tool.
        let across = if axis.x.abs() > 0.5 {
            Vector3::y()
        } else {
            Vector3::x()
        };
        let request = MapRequest {
            joint_1_rad: first.posture[0],
            tool_axis: axis,
            zero_direction: across,
            redundancy_angle_rad: first.angle_rad,
            feed: across,
            singularity: SingularityLimits::default(),
        };
        let step = STEP_DEG.to_radians();
        let map = joint_map(&study.robot, &study.cut, &request, step)
            .map_err(|error| Failure::sim(answer.scenario, in_scenario(error)))?;
        let depth_m = study.cut.nominal.axial_depth_m;
        let against =
            |value: f64, needed: f64| ((value / needed).max(1e-6).ln() / 3.0).clamp(-1.0, 1.0);
        panels.push(panel(
            &map,
            &format!("r, tool {name}: blue from 0.1 on"),
            &|cell| against(cell.anisotropy, LEAST_ANISOTROPY),
        ));
        panels.push(panel(
            &map,
            &format!("6-DoF limit, tool {name}: blue if deep enough"),
            &|cell| against(cell.limit_depth_m, depth_m),
        ));
    }
    let figure = Figure {
        title: format!(
            "{}: anisotropy and mode-coupling limit over joints 2 and 3, redundancy angle {:.0} \
             deg",
            answer.scenario.name,
            first.angle_rad.to_degrees()
        ),
        panels,
        columns: 2,
        legend: Legend::Above,
    };
    let path = out
        .join(answer.scenario.stem())
        .join("posture_joint_maps.svg");
    write_file(&path, figure.to_svg().as_bytes())?;
    Ok(path)
}

fn panel(map: &JointMap, title: &str, shade: &dyn Fn(&MapCell) -> f64) -> Panel {
    let rows = map.joint_2_rad.iter().zip(&map.cells);
    let shaded = rows.flat_map(|(q2, row)| {
        let cells = map.joint_3_rad.iter().zip(row);
        cells.map(move |(q3, cell)| {
            let value = cell.as_ref().map_or(f64::NAN, shade);
            let shown = if value.abs() < 0.1 {
                0.1_f64.copysign(value)
            } else {
                value
            };
            ((q2.to_degrees(), q3.to_degrees()), shown)
        })
    });
    let step = |values: &[f64]| (values[1] - values[0]).to_degrees();
    let size = (step(&map.joint_2_rad), step(&map.joint_3_rad));
    Panel::new(
        title,
        "joint 2 [deg]",
        "joint 3 [deg]",
        vec![Layer::cells(size, shaded)],
    )
}
