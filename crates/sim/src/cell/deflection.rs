//! How far the tool is off its path: of processes whose path is not straight, where the
//! displacement since touch-down shows the path and hides what the process does to the arm.

use std::sync::Arc;

use nalgebra::Vector3;
use truecut_arm::{FrameId, Robot};
use truecut_recording::{ChannelSpec, Unit};

use crate::plant::JointState;

/// How the names of the channels begin.
const NAME: &str = "tool.deflection_";
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
            ChannelSpec::new(format!("{NAME}{axis}"), Unit::Metre, text)
        })
    }

    /// Whether a channel of that name is one of these.
    pub(super) fn is_channel(name: &str) -> bool {
        name.starts_with(NAME)
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Uniform};

    /// Length from the shoulder to the flange with the elbow straight, m.
    const RADIUS_M: f64 = 1.3;

    fn arm() -> Arc<Robot> {
        let urdf = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../assets/robots/arm_2r/robot.urdf");
        let mut robot = Robot::load(&urdf, None, None).expect("the asset");
        robot.frames.flange_from_tool = nalgebra::Isometry3::identity();
        Arc::new(robot)
    }

    fn at(command: f64, off: f64) -> JointState {
        JointState::at_rest(&[command + off, 0.0], &[command, 0.0])
    }

    fn is(found: [f64; 3], expected: Vector3<f64>) {
        let off = (Vector3::from(found) - expected).norm();
        assert!(off < 1e-12, "{found:?} for {expected}");
    }

    /// The stretched arm turns about its shoulder by a step, and is off by an angle δ: the tool is
    /// off by a chord of length 2 R sin(δ/2), turned against the step before by δ/2 and half the
    /// step. What the arm sags at touch-down is no deflection.
    #[test]
    fn verify_the_chord_of_a_turned_arm() {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mut draw = |low: f64, high: f64| {
            let range = Uniform::new(low, high).expect("a range");
            range.sample(&mut rng)
        };
        for case in 0..200 {
            let sense = if case % 2 == 0 { 1.0 } else { -1.0 };
            let (from, sag, delta) = (draw(-1.0, 1.0), draw(-0.1, 0.1), draw(-0.05, 0.05));
            let step = sense * draw(0.01, 0.3);
            let chord_m = 2.0 * RADIUS_M * (delta / 2.0).sin();
            let path = |normal| {
                let (start, command) = (vec![from + sag, 0.0], vec![from, 0.0]);
                let mut path = PathDeflection::new(arm(), start, command, normal);
                is(path.now(&at(from, sag)), Vector3::zeros());
                path
            };
            let moved = at(from + step, sag + delta);
            // Seen from beside the plane of motion.
            let turned = (delta + step) / 2.0;
            let expected = Vector3::new(turned.cos(), turned.sin(), 0.0) * chord_m * sense;
            let mut beside = path(Some(Vector3::y()));
            is(beside.now(&moved), expected);
            // Standing, the path keeps its direction.
            is(beside.now(&moved), expected);
            // With the workpiece before the tool, whose z axis points out along the arm.
            let expected = Vector3::new(sense * (delta / 2.0).cos(), 0.0, (delta / 2.0).sin());
            is(path(None).now(&moved), expected * chord_m);
        }
    }
}
