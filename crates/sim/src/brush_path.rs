//! The way of a brush along taught postures, and the edges that it deburrs.
//!
//! As a robot plays moves by joints: from posture to posture all joints move together, as long as the tool's way takes at the feed, or
//! the slowest joint at its share of the top speed. Corners are rounded as a motion filter rounds them ([`crate::course`]).

use crate::course::Course;
use crate::error::SimError;
use crate::led_path::{KNOT_INTERVAL_S, LedPath, check_speeds};
use crate::path_job;
use crate::process::Station;
use crate::tool_path::Along;
use nalgebra::{DVector, Isometry3, Vector3};
use std::sync::Arc;
use truecut_arm::{FrameId, Robot};
use truecut_core::wheel::edge_wear::EdgeWear;
use truecut_plan::surface::{Mesh, MeshUse, SharpEdge};
use truecut_plan::surface_path::TaughtPoints;
use truecut_scenario::{BrushSpec, EdgeSpec};

const TAUGHT: &str = "process.brush.taught";

/// Parts in which the tool's way from posture to posture is measured.
const PARTS: usize = 16;
/// A point of an edge may be so far from the mesh's edge: what is printed in a file is rounded.
const ON_THE_EDGE_M: f64 = 0.05e-3;
/// Most places on all edges.
const MOST_STATIONS: f64 = 100_000.0;

/// What a brush works on.
#[derive(Debug)]
pub(crate) struct BrushWork {
    pub mesh: Arc<Mesh>,
    pub world_from_mesh: Isometry3<f64>,
    /// Places on the edges, in the mesh's frame, edge after edge.
    pub stations: Vec<Station>,
}

/// The way along the taught postures.
pub(crate) fn solve(spec: &BrushSpec, robot: &Robot) -> Result<LedPath, SimError> {
    let taught = taught(spec, robot)?;
    let moves = moves(spec, robot, &taught.postures);
    if moves.len() < 2 {
        let message = format!(
            "{} holds one posture, played again and again: a brush is led from one posture to another",
            spec.taught.display()
        );
        return Err(SimError::scenario(TAUGHT, message));
    }
    let sampled = Course::new(moves).sampled(KNOT_INTERVAL_S);
    let postures: Vec<Vec<f64>> = sampled.iter().map(|q| q.as_slice().to_vec()).collect();
    let at_mm = ways_mm(robot, &postures);
    let along = Along {
        key: TAUGHT,
        at_mm: &|k| at_mm[k],
    };
    let advice = "lower process.brush.joint_speed";
    check_speeds(robot, &postures, &along, "the way", advice)?;
    let duration_s = (postures.len() - 1) as f64 * KNOT_INTERVAL_S;
    let work = work(spec)?;
    let length_m: f64 = work.stations.iter().map(|station| station.length_m).sum();
    let note = format!(
        "brush: {} taught postures, {duration_s:.2} s, {:.0} mm of edge",
        taught.postures.len(),
        length_m * 1e3
    );
    Ok(LedPath {
        postures,
        duration_s,
        note: Some(note),
        belt: None,
        brush: Some(work),
    })
}

fn taught(spec: &BrushSpec, robot: &Robot) -> Result<TaughtPoints, SimError> {
    let text = std::fs::read_to_string(&spec.taught).map_err(|error| {
        let file = spec.taught.display();
        SimError::scenario(
            TAUGHT,
            format!("cannot read the taught postures of {file}: {error}"),
        )
    })?;
    TaughtPoints::from_text(&text, &spec.taught, robot)
        .map_err(|error| SimError::scenario(TAUGHT, error.to_string()))
}

/// Postures with the times at which the course's own clock meets them; those that repeat the one before are left out.
fn moves(spec: &BrushSpec, robot: &Robot, postures: &[Vec<f64>]) -> Vec<(f64, DVector<f64>)> {
    let mut kept: Vec<(f64, DVector<f64>)> = Vec::new();
    for posture in postures {
        let posture = DVector::from_vec(posture.clone());
        let at_s = match kept.last() {
            None => 0.0,
            Some((_, before)) if *before == posture => continue,
            Some((at_s, before)) => at_s + move_s(spec, robot, before, &posture),
        };
        kept.push((at_s, posture));
    }
    kept
}

/// How long a move takes by itself.
fn move_s(spec: &BrushSpec, robot: &Robot, from: &DVector<f64>, to: &DVector<f64>) -> f64 {
    let between = |k: usize| from + (to - from) * (k as f64 / PARTS as f64);
    let parts: Vec<Vec<f64>> = (0..=PARTS)
        .map(|k| between(k).as_slice().to_vec())
        .collect();
    let way_m = ways_mm(robot, &parts)[PARTS] * 1e-3;
    let slowest_s = (robot.chain.joints.iter().enumerate()).filter_map(|(i, joint)| {
        let speed = spec.joint_share * joint.limits?.velocity;
        Some((to[i] - from[i]).abs() / speed)
    });
    slowest_s.fold(way_m / spec.feed_m_per_s, f64::max)
}

/// How far the tool point has come at each of these postures, mm.
fn ways_mm(robot: &Robot, postures: &[Vec<f64>]) -> Vec<f64> {
    let (mut way_mm, mut before) = (0.0, None::<Vector3<f64>>);
    let ways = postures.iter().map(|posture| {
        let at = robot
            .world_from_frame(posture, FrameId::Tool)
            .translation
            .vector;
        way_mm += before.map_or(0.0, |before| (at - before).norm() * 1e3);
        before = Some(at);
        way_mm
    });
    ways.collect()
}

/// The workpiece and its edges.
fn work(spec: &BrushSpec) -> Result<BrushWork, SimError> {
    let mesh = Mesh::load(&spec.workpiece.file, spec.workpiece.unit_m, MeshUse::Body)
        .map_err(|error| SimError::scenario("process.brush.workpiece.mesh", error.to_string()))?;
    check_count(spec)?;
    let sharp = mesh.sharp_edges();
    let mut stations = Vec::new();
    for (index, edge) in spec.edges.iter().enumerate() {
        for pair in edge.points_m.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(Vector3::from);
            let count = ((to - from).norm() / spec.station_m - 1e-9).ceil().max(1.0);
            for k in 0..count as usize {
                let point_m = from + (to - from) * ((k as f64 + 0.5) / count);
                let found = edge_at(spec, index, &sharp, &point_m)?;
                stations.push(Station {
                    edge: index,
                    point_m,
                    length_m: (to - from).norm() / count,
                    normals: found.normals,
                    wear: wear(spec, edge, found.wedge_rad()),
                });
            }
        }
    }
    Ok(BrushWork {
        mesh: Arc::new(mesh),
        world_from_mesh: path_job::pose(&spec.place),
        stations,
    })
}

fn wear(spec: &BrushSpec, edge: &EdgeSpec, wedge_rad: f64) -> EdgeWear {
    EdgeWear {
        burr_height_m: edge.burr_height_m,
        burr_thickness_m: edge.burr_thickness_m,
        wedge_rad,
        tip_m: spec.bristle_diameter_m,
        preston_per_pa: spec.preston_per_pa,
    }
}

fn check_count(spec: &BrushSpec) -> Result<(), SimError> {
    let pairs = spec.edges.iter().flat_map(|edge| edge.points_m.windows(2));
    let length_m: f64 = pairs
        .map(|pair| (Vector3::from(pair[1]) - Vector3::from(pair[0])).norm())
        .sum();
    let count = length_m / spec.station_m;
    if count <= MOST_STATIONS {
        return Ok(());
    }
    Err(SimError::scenario(
        "process.brush.station_mm",
        format!(
            "`process.brush.station_mm` is {}, which makes {count:.0} places on {:.0} mm of edge, but there are at most {MOST_STATIONS}",
            spec.station_m * 1e3,
            length_m * 1e3
        ),
    ))
}

/// The mesh's edge at a point of an edge that the scenario gives.
fn edge_at<'a>(
    spec: &BrushSpec,
    index: usize,
    sharp: &'a [SharpEdge],
    point_m: &Vector3<f64>,
) -> Result<&'a SharpEdge, SimError> {
    let distances = sharp.iter().map(|edge| (edge.distance_m(point_m), edge));
    let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((distance_m, edge)) = nearest
        && distance_m <= ON_THE_EDGE_M
    {
        return Ok(edge);
    }
    let nearest = nearest.map_or_else(
        || "it has none".to_owned(),
        |(distance_m, _)| format!("the nearest is {:.3} mm away", distance_m * 1e3),
    );
    let [x, y, z] = (point_m * 1e3).into();
    Err(SimError::scenario(
        format!("process.brush.edge.{index}.points_mm"),
        format!(
            "no edge of {} that stands out runs within {} mm of ({x:.3}, {y:.3}, {z:.3}) mm, but must where a brush deburrs: {nearest}",
            spec.workpiece.file.display(),
            ON_THE_EDGE_M * 1e3
        ),
    ))
}
