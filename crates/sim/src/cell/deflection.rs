//! How far the tool is off its path: of processes whose path is not straight, where the
//! displacement since touch-down shows the path and hides what the process does to the arm.

use std::sync::Arc;

use nalgebra::Vector3;
use truecut_arm::{FrameId, Robot};
use truecut_recording::{ChannelSpec, Unit};

use crate::plant::JointState;

/// Shorter moves between two rows give no direction, m.
const STANDS_M: f64 = 1e-9;

/// Tool point less where the arm would have it without deflection: at the command, shifted to the
/// posture of touch-down.
pub(crate) struct PathDeflection {
    robot: Arc<Robot>,
    start: Vec<f64>,
    first_command: Vec<f64>,
    /// Outward normal of the workpiece, world; without it against the tool's z axis.
    normal: Option<Vector3<f64>>,
    commanded_m: Option<Vector3<f64>>,
    /// Where the path last led, world, of length 1.
    along: Vector3<f64>,
}

impl PathDeflection {
    pub(super) fn new(
        robot: Arc<Robot>,
        start: Vec<f64>,
        first_command: Vec<f64>,
        normal: Option<Vector3<f64>>,
    ) -> Self {
        Self {
            robot,
            start,
            first_command,
            normal,
            commanded_m: None,
            along: Vector3::x(),
        }
    }

    pub(super) fn specs() -> [ChannelSpec; 3] {
        let text = "Tool point less its place on the path without deflection";
        [
            ("along", "along the path"),
            ("across", "across it, in the surface"),
            ("normal", "away from the workpiece"),
        ]
        .map(|(axis, called)| {
            let text = format!("{text}, {called}");
            ChannelSpec::new(format!("tool.deflection_{axis}"), Unit::Metre, text)
        })
    }

    /// Along the path, across it, and away from the workpiece, m; while the arm stands still with
    /// the directions that the path had last.
    pub(super) fn now(&mut self, joints: &JointState) -> [f64; 3] {
        let shift = joints.command.iter().zip(&self.first_command);
        let still = self.start.iter().zip(shift);
        let still: Vec<f64> = still.map(|(q, (now, first))| q + (now - first)).collect();
        let tool = |q: &[f64]| self.robot.world_from_frame(q, FrameId::Tool);
        let commanded = tool(&still);
        let commanded_m = commanded.translation.vector;
        let off_m = tool(&joints.position).translation.vector - commanded_m;
        if let Some(before_m) = self.commanded_m.replace(commanded_m) {
            let moved = (commanded_m - before_m).try_normalize(STANDS_M);
            self.along = moved.unwrap_or(self.along);
        }
        let normal = self.normal.unwrap_or(-(commanded.rotation * Vector3::z()));
        let along = self.along - normal * normal.dot(&self.along);
        // A path straight in or out has no direction in the surface.
        let along = along.try_normalize(1e-6);
        let along = along.unwrap_or_else(|| commanded.rotation * Vector3::x());
        let across = normal.cross(&along);
        [along, across, normal].map(|axis| axis.dot(&off_m))
    }
}
