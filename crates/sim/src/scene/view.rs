//! An arm that is seen without a run: at the stops of a plan or a path.

use nalgebra::{Isometry3, Vector3};
use truecut_arm::{FrameId, Robot};
use truecut_plan::clearance::{Cell, Solid};
use truecut_plan::surface::Mesh;
use truecut_recording::{Body, Frame, Geometry, Pose, Scene, Shape};

use super::tooling::{Tooling, on_last_link};
use super::{arm_bodies, pose, shapes};

/// Colour of what stands about a part.
const FIXTURE_RGBA: [u8; 4] = [150, 140, 120, 255];
/// Colour of what the flange carries.
const CARRIED_RGBA: [u8; 4] = [95, 105, 120, 255];

/// What stands about an arm and what it carries, to be drawn.
#[derive(Debug, Clone, Default)]
pub struct Surroundings {
    pub standing: Vec<Body>,
    /// On the last link, in its frame.
    pub carried: Vec<Shape>,
}

impl Surroundings {
    /// Fixtures and what is carried of a cell, and its part, if that is not drawn by itself.
    pub fn of(cell: &Cell) -> Self {
        let shape = |solid: &Solid, at: &Isometry3<f64>, color_rgba| Shape {
            geometry: geometry(solid),
            color_rgba,
            body_from_shape: pose(at),
        };
        let standing = cell.standing().enumerate();
        let standing = standing.map(|(index, (name, solid, at))| Body {
            path: format!("cell/{index}_{name}"),
            shapes: vec![shape(solid, &Isometry3::identity(), FIXTURE_RGBA)],
            initial_pose: pose(at),
        });
        let carried = cell.carried();
        Self {
            standing: standing.collect(),
            carried: carried
                .map(|(_, solid, at)| shape(solid, at, CARRIED_RGBA))
                .collect(),
        }
    }
}

fn geometry(solid: &Solid) -> Geometry {
    match solid {
        Solid::Box { sides_m } => Geometry::Box {
            half_extents_m: (sides_m * 0.5).into(),
        },
        &Solid::Cylinder { radius_m, length_m } => Geometry::Cylinder { radius_m, length_m },
        &Solid::Ball { radius_m } => Geometry::Sphere { radius_m },
        Solid::Mesh {
            vertices_m,
            triangles,
        } => Geometry::Mesh {
            vertices_m: vertices_m.iter().map(|v| (*v).into()).collect(),
            triangles: triangles.clone(),
        },
    }
}

/// What clearances ask distances of; `None` for what is drawn and has no body.
pub(super) fn solid(geometry: &Geometry) -> Option<Solid> {
    Some(match geometry {
        Geometry::Box { half_extents_m } => Solid::Box {
            sides_m: Vector3::from(*half_extents_m) * 2.0,
        },
        &Geometry::Cylinder { radius_m, length_m } => Solid::Cylinder { radius_m, length_m },
        &Geometry::Sphere { radius_m } => Solid::Ball { radius_m },
        Geometry::Mesh {
            vertices_m,
            triangles,
        } => Solid::Mesh {
            vertices_m: vertices_m.iter().map(|v| Vector3::from(*v)).collect(),
            triangles: triangles.clone(),
        },
        _ => return None,
    })
}

/// The arm at the first stop with its tool, beside bodies that stand still, and a frame for each
/// stop: when, s, and in which posture. Nothing without a stop.
pub fn arm_view<'a>(
    robot: &Robot,
    tooling: &Tooling,
    stops: impl ExactSizeIterator<Item = (f64, &'a [f64])> + Clone,
    about: Surroundings,
) -> (Scene, Vec<Frame>) {
    let Some((_, first)) = stops.clone().next() else {
        return (Scene::default(), Vec::new());
    };
    let (mut bodies, _) = arm_bodies(robot, first, "true");
    let world_from_tool = robot.world_from_frame(first, FrameId::Tool);
    if let Some(last) = bodies.last_mut() {
        let held = on_last_link(robot, first, &world_from_tool, tooling);
        last.shapes.extend(held);
        last.shapes.extend(about.carried);
    }
    let standing = about.standing;
    let still: Vec<Pose> = standing.iter().map(|body| body.initial_pose).collect();
    bodies.extend(standing);
    let frames = stops.map(|(time_s, posture)| {
        let links = robot.world_from_links(posture);
        let moving = std::iter::once(Pose::IDENTITY).chain(links.iter().map(pose));
        Frame {
            time_s,
            poses: moving.chain(still.iter().copied()).collect(),
            arrows: Vec::new(),
            fields: Vec::new(),
        }
    });
    let frames = frames.collect();
    let scene = Scene {
        bodies,
        ..Scene::default()
    };
    (scene, frames)
}

/// A mesh that stands in the world.
pub fn mesh_body(path: &str, world_from_mesh: &Isometry3<f64>, mesh: &Mesh) -> Body {
    Body {
        path: path.to_owned(),
        shapes: shapes::body(&Isometry3::identity(), mesh),
        initial_pose: pose(world_from_mesh),
    }
}
