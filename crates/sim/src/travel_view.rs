//! An arm led along postures, as it is seen.

use nalgebra::Isometry3;
use truecut_arm::Robot;
use truecut_recording::{Frame, Scene};

use crate::scene::{arm_bodies, pose};

/// The arm in the first posture, and a frame for each time and posture. Empty without postures.
#[must_use]
pub fn travel_view(robot: &Robot, postures: &[(f64, &[f64])]) -> (Scene, Vec<Frame>) {
    let frame = |(time_s, posture): &(f64, &[f64])| {
        let mut poses = vec![pose(&Isometry3::identity())];
        poses.extend(robot.world_from_links(posture).iter().map(pose));
        Frame {
            time_s: *time_s,
            poses,
            arrows: Vec::new(),
            fields: Vec::new(),
        }
    };
    let bodies = postures
        .first()
        .map(|(_, posture)| arm_bodies(robot, posture, "true", false));
    let scene = Scene {
        bodies: bodies.unwrap_or_default(),
        ..Scene::default()
    };
    (scene, postures.iter().map(frame).collect())
}
