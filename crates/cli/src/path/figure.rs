//! Figures of a path: lines on the face, wheel contact, joints.

use nalgebra::Vector3;
use truecut_plan::surface_path::Contact;

use super::{PlannedPath, durations_s};
use crate::figure::{BLACK, BLUE, Figure, GREEN, Layer, Legend, ORANGE, Panel, thinned};

/// Most points of a curve.
const POINTS: usize = 1500;
/// Points of the face's outline per border.
const OUTLINE: usize = 60;

/// Four panels: lines on the face, widths and depths along them, joint angles, joint speeds.
pub fn figure(answer: &PlannedPath<'_>) -> Figure {
    Figure {
        title: format!("{}: path", answer.job.name),
        panels: vec![
            on_face(answer),
            along(answer),
            joints(answer),
            speeds(answer),
        ],
        columns: 2,
        legend: Legend::Above,
    }
}

/// Viewed against the mean normal of the patch.
fn on_face(answer: &PlannedPath<'_>) -> Panel {
    let contacts: Vec<&Contact> = answer.path.lines.iter().flatten().collect();
    let normal: Vector3<f64> = contacts.iter().map(|c| c.normal.into_inner()).sum();
    let normal = normal.normalize();
    let x = [Vector3::x(), Vector3::y()]
        .map(|axis| axis - normal * normal.dot(&axis))
        .into_iter()
        .find(|axis| axis.norm() > 0.5)
        .unwrap_or_else(Vector3::x)
        .normalize();
    let y = normal.cross(&x);
    let seen = |p: &Vector3<f64>| (p.dot(&x) * 1e3, p.dot(&y) * 1e3);
    let outline = outline(answer);
    let mut lines = Vec::new();
    let mut edges = [Vec::new(), Vec::new()];
    for line in &answer.path.lines {
        for contact in line {
            lines.push(seen(&contact.point_m));
            let across = contact.normal.cross(&contact.feed) * (0.5 * contact.swath_m);
            edges[0].push(seen(&(contact.point_m + across)));
            edges[1].push(seen(&(contact.point_m - across)));
        }
        let gap = (f64::NAN, f64::NAN);
        lines.push(gap);
        edges.iter_mut().for_each(|edge| edge.push(gap));
    }
    let [one, other] = edges;
    Panel::new(
        "Lines on the face",
        "patch, across the view [mm]",
        "patch, up the view [mm]",
        vec![
            Layer::line("face", outline.iter().map(seen), BLACK),
            Layer::dashed("swath", one, ORANGE),
            Layer::dashed("", other, ORANGE),
            Layer::line("line", lines, BLUE),
        ],
    )
}

/// The face's boundary, or the borders of its patch.
fn outline(answer: &PlannedPath<'_>) -> Vec<Vector3<f64>> {
    let surface = answer.inputs.patch.surface.as_ref();
    match &answer.inputs.patch.boundary {
        Some(boundary) => {
            let corners = boundary.corners_m();
            corners.iter().chain(corners.first()).copied().collect()
        }
        None => {
            let domain = surface.domain();
            let at = |range: [f64; 2], k: usize| {
                range[0] + (range[1] - range[0]) * k as f64 / OUTLINE as f64
            };
            let (u, v) = (domain.u, domain.v);
            let sides = (0..=OUTLINE)
                .map(|k| [at(u, k), v[0]])
                .chain((0..=OUTLINE).map(|k| [u[1], at(v, k)]))
                .chain((0..=OUTLINE).rev().map(|k| [at(u, k), v[1]]))
                .chain((0..=OUTLINE).rev().map(|k| [u[0], at(v, k)]));
            sides.map(|[u, v]| surface.point_m(u, v)).collect()
        }
    }
}

/// Swath, edge gap and depth over arc length along the lines.
fn along(answer: &PlannedPath<'_>) -> Panel {
    let mut at_mm = 0.0;
    let (mut swath, mut gap, mut depth) = (Vec::new(), Vec::new(), Vec::new());
    for (line, depths) in answer.path.lines.iter().zip(&answer.depth_m) {
        for (k, contact) in line.iter().enumerate() {
            if let Some(before) = k.checked_sub(1).map(|b| &line[b]) {
                at_mm += (contact.point_m - before.point_m).norm() * 1e3;
            }
            swath.push((at_mm, contact.swath_m * 1e2));
            gap.push((at_mm, contact.edge_gap_m * 1e3));
            // The tool is lifted at the first pose of a line.
            depth.push((at_mm, depths[k + 1] * 1e3));
        }
    }
    let layer = |label: &str, points: Vec<(f64, f64)>, colour| {
        Layer::line(label, thinned(points, POINTS), colour)
    };
    Panel::new(
        "What the wheel does",
        "along the lines [mm]",
        "swath [cm]; gap, depth [mm]",
        vec![
            layer("swath", swath, BLUE),
            layer("edge gap", gap, ORANGE),
            layer("depth", depth, GREEN),
        ],
    )
}

/// The curve of a joint, named by its number.
fn of_joint(joint: usize, curve: impl Iterator<Item = (f64, f64)>) -> Layer {
    let number = (joint + 1).to_string();
    Layer::line(number, thinned(curve, POINTS), joint)
}

/// Joint angles over time.
fn joints(answer: &PlannedPath<'_>) -> Panel {
    let mut time_s = 0.0;
    let times: Vec<f64> = durations_s(answer)
        .into_iter()
        .map(|d| {
            time_s += d;
            time_s
        })
        .collect();
    let layers = (0..answer.inputs.robot.dof()).map(|joint| {
        let moves = answer.program.moves.iter().zip(&times);
        let curve = moves.map(|(step, t)| (*t, step.posture[joint].to_degrees()));
        of_joint(joint, curve)
    });
    Panel::new("Joints", "time [s]", "angle [deg]", layers.collect())
}

/// Joint speeds on lines, relative to their limits.
fn speeds(answer: &PlannedPath<'_>) -> Panel {
    let durations = durations_s(answer);
    let chain = &answer.inputs.robot.chain.joints;
    let layers = chain.iter().enumerate().map(|(joint, one)| {
        let limit = one.limits.map_or(f64::NAN, |l| l.velocity);
        let mut time_s = 0.0;
        let steps = answer.program.moves.windows(2).zip(&durations[1..]);
        let curve = steps.map(|(pair, duration)| {
            time_s += duration;
            let turned = (pair[1].posture[joint] - pair[0].posture[joint]).abs();
            (time_s, turned / duration.max(1e-9) / limit)
        });
        of_joint(joint, curve)
    });
    Panel::new(
        "Joint speeds",
        "time [s]",
        "speed over its limit",
        layers.collect(),
    )
}
