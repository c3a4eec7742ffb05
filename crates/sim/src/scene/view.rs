//! An arm that is seen without a run: at the stops of a plan or a path.

use nalgebra::Isometry3;
use truecut_arm::{FrameId, Robot};
use truecut_plan::surface::Mesh;
use truecut_recording::{Body, Frame, Pose, Scene};

use super::tooling::{Tooling, on_last_link};
use super::{arm_bodies, pose, shapes};

/// The arm at the first stop with its tool, beside bodies that stand still, and a frame for each
/// stop: when, s, and in which posture. Nothing without a stop.
pub fn arm_view<'a>(
    robot: &Robot,
    tooling: &Tooling,
    stops: impl ExactSizeIterator<Item = (f64, &'a [f64])> + Clone,
    standing: Vec<Body>,
) -> (Scene, Vec<Frame>) {
    let Some((_, first)) = stops.clone().next() else {
        return (Scene::default(), Vec::new());
    };
    let (mut bodies, _) = arm_bodies(robot, first, "true");
    let world_from_tool = robot.world_from_frame(first, FrameId::Tool);
    if let Some(last) = bodies.last_mut() {
        let held = on_last_link(robot, first, &world_from_tool, tooling);
        last.shapes.extend(held);
    }
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
