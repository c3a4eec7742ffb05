//! The motion of a brush along taught postures, a path from a file or edges themselves, and the
//! edges that it deburrs.

use super::edges::{laid, work_setup};
use super::path_file::{self, LedAlong, StartNear};
use super::{BrushWork, KNOT_INTERVAL_S, PlannedMotion, Target};
use crate::error::SimError;
use crate::process::Station;
use nalgebra::Vector3;
use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;
use truecut_arm::{FrameId, Robot};
use truecut_core::wheel::edge_wear::EdgeWear;
use truecut_plan::motion::follow::{AtMm, FollowError, check_duration, check_speeds};
use truecut_plan::motion::taught::{TaughtSpeeds, through_taught, tool_path_mm};
use truecut_plan::path_file::LaidPath;
use truecut_plan::surface::{EdgeChain, LEAST_TURN_RAD, Mesh, MeshUse, SharpEdge};
use truecut_plan::surface_path::TaughtPoints;
use truecut_scenario::{BrushSpec, BrushWay, EdgePlace, EdgeSpec, LONGEST_S};

const TAUGHT: &str = "process.brush.taught";
const PATH: &str = "process.brush.path.file";
const ALONG: &str = "process.brush.along";

/// What helps where an arm cannot go along an edge.
const OTHERWISE: &str = "place the part elsewhere, tilt the brush otherwise, begin a closed edge at \
                         another point of it, or go along the edge the other way round (`reversed`)";

/// A point of an edge may be so far from the mesh's edge: what is printed in a file is rounded.
const ON_THE_EDGE_M: f64 = 0.05e-3;
/// Most places on all edges.
const MOST_STATIONS: f64 = 100_000.0;
/// Places nearer to each other are the same, m.
const SAME_PLACE_M: f64 = 1e-6;
/// Of the knots of the way one in so many is looked at for the depth of brush and hub.
const LOOKED_AT: usize = 4;

/// The motion of a brush; `start` is for paths from a file.
pub(crate) fn solve(
    spec: &BrushSpec,
    robot: &Robot,
    start: &StartNear,
) -> Result<PlannedMotion, SimError> {
    let (work, chains) = work(spec)?;
    let (key, led) = match &spec.way {
        BrushWay::Taught {
            file,
            feed_m_per_s,
            joint_share,
        } => {
            let speeds = TaughtSpeeds {
                feed_m_per_s: *feed_m_per_s,
                joint_share: *joint_share,
            };
            (TAUGHT, through(file, speeds, robot)?)
        }
        BrushWay::Path(path) => (PATH, path_file::lead(path, PATH, robot, start)?),
        BrushWay::Along(along) => {
            let path = laid(along, &chains)?;
            let laid = LaidPath {
                path: &path,
                file: &spec.workpiece.file,
                setup: work_setup(spec, along),
                joint_share: along.joint_share,
            };
            let key = |edge: usize| key_of(edge, "point_mm");
            (
                ALONG,
                path_file::lead_along(&laid, "edge", (&key, OTHERWISE), robot, start)?,
            )
        }
    };
    let path_mm = tool_path_mm(robot, &led.knots);
    let depth_m = deepest_m(spec, key, robot, &work, &led.knots, &|k| path_mm[k])?;
    let note = told(spec, &work, &led, depth_m);
    Ok(PlannedMotion {
        knots: led.knots,
        duration_s: led.duration_s,
        note: Some(note),
        target: Target::Edges(work),
    })
}

pub(super) fn key_of(edge: usize, key: &str) -> String {
    format!("process.brush.edge.{edge}.{key}")
}

/// The motion through taught postures.
fn through(file: &Path, speeds: TaughtSpeeds, robot: &Robot) -> Result<LedAlong, SimError> {
    let taught = taught(file, robot)?;
    let trajectory = through_taught(robot, &taught.postures, speeds).ok_or_else(|| {
        let message = format!(
            "{} holds one posture, played again and again: a brush is led from one posture to another",
            file.display()
        );
        SimError::scenario(TAUGHT, message)
    })?;
    let refused = |error: FollowError| SimError::scenario(TAUGHT, error.to_string());
    let advice = "raise process.brush.feed_mm_per_s or process.brush.joint_speed";
    check_duration(trajectory.duration_s(), LONGEST_S, advice).map_err(refused)?;
    let sampled = trajectory.sampled(KNOT_INTERVAL_S);
    let knots: Vec<Vec<f64>> = sampled.iter().map(|q| q.as_slice().to_vec()).collect();
    let path_mm = tool_path_mm(robot, &knots);
    let at_mm = |k: usize| path_mm[k];
    let advice = "lower process.brush.joint_speed";
    check_speeds(robot, &knots, KNOT_INTERVAL_S, &at_mm, "the way", advice).map_err(refused)?;
    Ok(LedAlong {
        duration_s: (knots.len() - 1) as f64 * KNOT_INTERVAL_S,
        told: format!("{} taught postures", taught.postures.len()),
        way: None,
        knots,
    })
}

fn taught(file: &Path, robot: &Robot) -> Result<TaughtPoints, SimError> {
    let text = truecut_files::read_text(file).map_err(|error| {
        let file = file.display();
        SimError::scenario(
            TAUGHT,
            format!("cannot read the taught postures of {file}: {error}"),
        )
    })?;
    TaughtPoints::from_text(&text, file, robot)
        .map_err(|error| SimError::scenario(TAUGHT, error.to_string()))
}

/// How far the unbent brush reaches into the workpiece along the commanded way, m; an error where
/// its hub would strike.
fn deepest_m(
    spec: &BrushSpec,
    key: &str,
    robot: &Robot,
    work: &BrushWork,
    postures: &[Vec<f64>],
    at_mm: &AtMm<'_>,
) -> Result<f64, SimError> {
    let hub_m = spec.brush.radius_m - spec.brush.free_length_m;
    let mesh_from_world = work.world_from_mesh.inverse();
    let mut deepest_m = 0.0_f64;
    for k in (0..postures.len()).step_by(LOOKED_AT) {
        let mesh_from_tool = mesh_from_world * robot.world_from_frame(&postures[k], FrameId::Tool);
        let depth =
            |radius_m| (work.mesh).wheel_depth_m(&mesh_from_tool, radius_m, spec.brush.width_m);
        let depth_m = depth(spec.brush.radius_m);
        deepest_m = deepest_m.max(depth_m);
        if depth_m > 0.0 && depth(hub_m) > 0.0 {
            let message = format!(
                "the brush's hub, radius {:.3} mm, would strike the workpiece {:.1} mm from the way's start: bristles of {:.3} mm leave no more; lead it further away",
                hub_m * 1e3,
                at_mm(k),
                spec.brush.free_length_m * 1e3
            );
            return Err(SimError::scenario(key, message));
        }
    }
    Ok(deepest_m)
}

/// What there is to tell of the way.
fn told(spec: &BrushSpec, work: &BrushWork, led: &LedAlong, depth_m: f64) -> String {
    let length_m: f64 = work.stations.iter().map(|station| station.length_m).sum();
    let lying_m = spec.brush.bristle().lying_m();
    let pressed = if depth_m == 0.0 {
        "the way never brings the brush to the workpiece".to_owned()
    } else if depth_m > lying_m {
        format!(
            "pressed in by up to {:.2} mm, but from {:.2} mm on the tip of a bristle lies along the face, and its law ends",
            depth_m * 1e3,
            lying_m * 1e3
        )
    } else {
        format!("pressed in by up to {:.2} mm", depth_m * 1e3)
    };
    format!(
        "brush: {}, {:.2} s, {:.0} mm of edge, {pressed}",
        led.told,
        led.duration_s,
        length_m * 1e3
    )
}

/// The workpiece and its edges, with those that are picked.
pub(super) fn work(spec: &BrushSpec) -> Result<(BrushWork, Vec<EdgeChain>), SimError> {
    let mesh = Mesh::load(&spec.workpiece.file, spec.workpiece.unit_m, MeshUse::Body)
        .map_err(|error| SimError::scenario("process.brush.workpiece.mesh", error.to_string()))?;
    let mut chains = Vec::new();
    let mut lines = Vec::new();
    for (index, edge) in spec.edges.iter().enumerate() {
        lines.push(match &edge.place {
            EdgePlace::Points(points_m) => points_m.iter().map(|p| Vector3::from(*p)).collect(),
            EdgePlace::Picked { point_m, reversed } => {
                let found = mesh.edge_at(&Vector3::from(*point_m), spec.crease_rad);
                let found = found.map_err(|fault| {
                    let file = spec.workpiece.file.display();
                    let extent = extent_mm(&mesh);
                    let message = format!("{file}: {fault}; the mesh reaches from {extent}");
                    SimError::scenario(key_of(index, "point_mm"), message)
                })?;
                let chain = if *reversed { found.reversed() } else { found };
                let points_m = chain.points_m.clone();
                chains.push(chain);
                points_m
            }
        });
    }
    let stations = stations(spec, &mesh, &lines)?;
    let work = BrushWork {
        mesh: Arc::new(mesh),
        world_from_mesh: spec.world_from_mesh,
        stations,
    };
    Ok((work, chains))
}

/// Places on the edges, which run straight from point to point.
fn stations(
    spec: &BrushSpec,
    mesh: &Mesh,
    lines: &[Vec<Vector3<f64>>],
) -> Result<Vec<Station>, SimError> {
    check_count(spec, lines)?;
    let sharp = mesh.sharp_edges();
    let mut stations = Vec::new();
    let mut known = HashSet::new();
    for (index, (edge, points_m)) in spec.edges.iter().zip(lines).enumerate() {
        for point_m in points_m {
            edge_at(spec, index, mesh, &sharp, point_m)?;
        }
        for pair in points_m.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let count = count(&from, &to, spec.station_m);
            for k in 0..count as usize {
                let point_m = from + (to - from) * ((k as f64 + 0.5) / count);
                let found = edge_at(spec, index, mesh, &sharp, &point_m)?;
                if !known.insert(point_m.map(|x| (x / SAME_PLACE_M).round() as i64)) {
                    return Err(twice(&key_of(index, edge.place.key()), &point_m));
                }
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
    Ok(stations)
}

fn wear(spec: &BrushSpec, edge: &EdgeSpec, wedge_rad: f64) -> EdgeWear {
    EdgeWear {
        burr_height_m: edge.burr_height_m,
        burr_thickness_m: edge.burr_thickness_m,
        wedge_rad,
        tip_m: spec.brush.bristle_diameter_m,
        preston_per_pa: spec.preston_per_pa,
    }
}

/// In how many parts a straight piece of edge is cut.
fn count(from: &Vector3<f64>, to: &Vector3<f64>, station_m: f64) -> f64 {
    ((to - from).norm() / station_m - 1e-9).ceil().max(1.0)
}

fn twice(key: &str, point_m: &Vector3<f64>) -> SimError {
    let [x, y, z] = (point_m * 1e3).into();
    SimError::scenario(
        key,
        format!(
            "the edge at ({x:.3}, {y:.3}, {z:.3}) mm is given twice: what is removed there would count twice"
        ),
    )
}

fn check_count(spec: &BrushSpec, lines: &[Vec<Vector3<f64>>]) -> Result<(), SimError> {
    let pairs = || {
        let all = lines.iter().flat_map(|points_m| points_m.windows(2));
        all.map(|pair| [pair[0], pair[1]])
    };
    let length_m: f64 = pairs().map(|[from, to]| (to - from).norm()).sum();
    let count: f64 = pairs()
        .map(|[from, to]| count(&from, &to, spec.station_m))
        .sum();
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
    mesh: &Mesh,
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
        key_of(index, spec.edges[index].place.key()),
        format!(
            "no edge of {} that stands out by {:.0} degrees or more runs within {} mm of ({x:.3}, {y:.3}, {z:.3}) mm, but must where a brush deburrs: {nearest}; the mesh reaches from {}",
            spec.workpiece.file.display(),
            LEAST_TURN_RAD.to_degrees(),
            ON_THE_EDGE_M * 1e3,
            extent_mm(mesh)
        ),
    ))
}

/// Where a mesh lies: a wrong unit shows.
fn extent_mm(mesh: &Mesh) -> String {
    let corner = |pick: fn(f64, f64) -> f64| {
        let all = mesh.vertices_m().iter().copied();
        let [x, y, z] = all
            .reduce(|a, b| a.zip_map(&b, pick))
            .map_or([0.0; 3], |corner| (corner * 1e3).into());
        format!("({x:.3}, {y:.3}, {z:.3})")
    };
    format!("{} to {} mm", corner(f64::min), corner(f64::max))
}
