//! Postures written as the columns of a path's table are read back as taught points.

use std::path::Path;

use proptest::prelude::*;
use truecut_arm::JointKind;
use truecut_plan::surface_path::{TaughtPoints, joint_cells};

use crate::assets;

/// Half of the last digit, in rad and m, with what the arithmetic rounds. At a limit it may be a
/// whole digit.
fn resolution(kind: JointKind) -> f64 {
    match kind {
        JointKind::Revolute => 1.000_001e-6_f64.to_radians(),
        JointKind::Prismatic => 1.000_001e-9,
    }
}

proptest! {
    #[test]
    fn postures_come_back_with_those_at_limits(
        at in 0..4_usize,
        drawn in prop::collection::vec(prop::collection::vec((0..6_u8, 0.0..1.0_f64), 6), 1..20),
    ) {
        let name = ["hp20", "irb6600_175_255", "rig_1dof", "rig_planar"][at];
        let robot = assets::robot(name);
        // One in three at a limit.
        let joint = |(joint, (choice, share)): (&truecut_arm::Joint, &(u8, f64))| {
            let range = joint.limits.map_or((-3.0, 3.0), |it| (it.lower, it.upper));
            match choice {
                0 => range.0,
                1 => range.1,
                _ => range.0 + (range.1 - range.0) * share,
            }
        };
        let posture = |shares: &Vec<(u8, f64)>| -> Vec<f64> {
            robot.chain.joints.iter().zip(shares).map(joint).collect()
        };
        let postures: Vec<Vec<f64>> = drawn.iter().map(posture).collect();
        let heading: Vec<String> = (1..=robot.dof()).map(|j| format!("j{j}")).collect();
        let rows = postures.iter().map(|posture| joint_cells(&robot, posture).join(","));
        let lines: Vec<String> = std::iter::once(heading.join(",")).chain(rows).collect();
        let read = TaughtPoints::from_text(&lines.join("\n"), Path::new("path.csv"), &robot);
        let read = read.map_err(|error| TestCaseError::fail(format!("{error}")))?;
        prop_assert_eq!(read.postures.len(), postures.len());
        for (read, written) in read.postures.iter().zip(&postures) {
            for ((joint, a), b) in robot.chain.joints.iter().zip(read).zip(written) {
                prop_assert!((a - b).abs() <= resolution(joint.kind), "{}: {a} of {b}", joint.name);
            }
        }
        // What is read is written as the same text.
        let again: Vec<String> = read.postures.iter().map(|it| joint_cells(&robot, it).join(",")).collect();
        prop_assert_eq!(&again[..], &lines[1..]);
    }
}
