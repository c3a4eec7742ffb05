//! An arm before a path from CAM.

use std::f64::consts::PI;
use std::path::Path;

use nalgebra::Isometry3;
use truecut_arm::Robot;
use truecut_plan::cam::{self, CamPath, Rapid, WorkSetup};
use truecut_plan::program::{Program, ProgramError, Start, Tool, TravelOptions};

/// The program of an arm with its base at the origin; points of the path may lie far apart.
pub fn follow(
    start: Start<'_>,
    robot: &Robot,
    path: &CamPath,
    file: &Path,
    world_from_work: Isometry3<f64>,
) -> Result<Program, ProgramError> {
    let head = Program {
        name: "PLATE".to_owned(),
        comment: String::new(),
        tool: Tool::of(robot, "tool", 0),
        world_from_base: Isometry3::identity(),
        moves: Vec::new(),
        spindle: Vec::new(),
        notes: Vec::new(),
    };
    let setup = WorkSetup {
        world_from_work,
        spin_rad: None,
        rapid: Rapid::Line {
            speed_m_per_s: 0.25,
        },
        joint_share: 0.25,
        zone_m: None,
    };
    let options = TravelOptions {
        largest_step: PI,
        ..TravelOptions::default()
    };
    cam::follow(start, robot, head, path, file, &setup, &options)
}
