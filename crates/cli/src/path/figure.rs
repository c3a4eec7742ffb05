//! Figures of a path: lines on the face, wheel contact, joints.

use nalgebra::Vector3;
use truecut_plan::motion::joints::joint_speeds;
use truecut_plan::surface::outline;
use truecut_plan::surface_path::Contact;

use super::{PlannedPath, durations_s};
use crate::clearance::Checked;
use crate::figure::{BLACK, BLUE, Figure, GREEN, Layer, Legend, ORANGE, Panel, thinned};

/// Most points of a curve.
const POINTS: usize = 1500;

/// Six panels: lines on the face, edge gap and depth along them, joint angles, joint speeds,
/// clearance, swath.
pub fn figure(answer: &PlannedPath<'_>) -> Figure {
    let [contact, swath] = along(answer);
    Figure {
        title: format!("{}: path", answer.job.name),
        panels: [
            Some(on_face(answer)),
            Some(contact),
            Some(joints(answer)),
            Some(speeds(answer)),
            answer.clearance.as_ref().map(|own| clearance(answer, own)),
            Some(swath),
        ]
        .into_iter()
        .flatten()
        .collect(),
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
    let border = border(answer);
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
        "across the face [mm]",
        "up the face [mm]",
        vec![
            Layer::line("face", border.iter().map(seen), BLACK),
            Layer::dashed("swath", one, ORANGE),
            Layer::dashed("", other, ORANGE),
            Layer::line("line", lines, BLUE),
        ],
    )
    .evenly()
}

/// The face's boundary, or the borders of its patch.
fn border(answer: &PlannedPath<'_>) -> Vec<Vector3<f64>> {
    match &answer.inputs.patch.boundary {
        Some(boundary) => {
            let corners = boundary.corners_m();
            corners.iter().chain(corners.first()).copied().collect()
        }
        None => outline(answer.inputs.patch.surface.as_ref()),
    }
}

/// Edge gap and depth, and the swath, which is far larger, over arc length along the lines.
fn along(answer: &PlannedPath<'_>) -> [Panel; 2] {
    let mut at_mm = 0.0;
    let (mut swath, mut gap, mut depth) = (Vec::new(), Vec::new(), Vec::new());
    for (line, depths) in answer.path.lines.iter().zip(&answer.depths.at_m) {
        for (k, contact) in line.iter().enumerate() {
            if let Some(before) = k.checked_sub(1).map(|b| &line[b]) {
                at_mm += (contact.point_m - before.point_m).norm() * 1e3;
            }
            swath.push((at_mm, contact.swath_m * 1e3));
            gap.push((at_mm, contact.edge_gap_m * 1e3));
            // The tool is lifted at the first pose of a line.
            depth.push((at_mm, depths[k + 1] * 1e3));
        }
    }
    let layer = |label: &str, points: Vec<(f64, f64)>, colour| {
        Layer::line(label, thinned(points, POINTS), colour)
    };
    let panel = |title: &str, y_label: &str, layers| {
        Panel::new(title, "along the lines [mm]", y_label, layers)
    };
    [
        panel(
            "What the wheel does",
            "gap and depth [mm]",
            vec![layer("edge gap", gap, ORANGE), layer("depth", depth, GREEN)],
        ),
        panel("Swath", "swath [mm]", vec![layer("", swath, BLUE)]),
    ]
}

/// The curve of a joint, named by its number.
fn of_joint(joint: usize, curve: impl Iterator<Item = (f64, f64)>) -> Layer {
    let number = format!("joint {}", joint + 1);
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
    let robot = &answer.inputs.robot;
    let mut curves = vec![Vec::new(); robot.dof()];
    let mut time_s = 0.0;
    let steps = answer
        .program
        .moves
        .windows(2)
        .zip(durations_s(answer).into_iter().skip(1));
    for (pair, duration_s) in steps {
        time_s += duration_s;
        let [from, to] = [0, 1].map(|end| pair[end].posture.as_slice());
        for one in joint_speeds(robot, from, to, duration_s.max(1e-9)) {
            curves[one.joint].push((time_s, one.share()));
        }
    }
    let layers = curves.into_iter().enumerate();
    let layers = layers.map(|(joint, curve)| of_joint(joint, curve.into_iter()));
    Panel::new(
        "Joint speeds",
        "time [s]",
        "speed over its limit",
        layers.collect(),
    )
}

/// Places at which the clearance is drawn.
const CLEARANCES: usize = 400;

/// Clearance of the nearest bodies over time.
fn clearance(answer: &PlannedPath<'_>, checked: &Checked) -> Panel {
    let rows = &answer.replay.rows;
    let every = rows.len().div_ceil(CLEARANCES).max(1);
    let clearance = checked.over_stations(&answer.inputs.robot, every);
    let times = rows.iter().step_by(every).map(|row| row.time_s);
    let curve = times.zip(clearance).filter(|(_, m)| m.is_finite());
    let curve: Vec<(f64, f64)> = curve.map(|(time_s, m)| (time_s, m * 1e3)).collect();
    let layers = vec![Layer::line("", curve, BLUE)];
    Panel::new("Clearance", "time [s]", "nearest bodies [mm]", layers)
}
