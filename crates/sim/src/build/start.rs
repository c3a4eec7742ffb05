//! Where a run starts.

use super::first_of;
use crate::command::JointCommand;
use crate::effect::{self, Altered};
use crate::error::SimError;
use crate::loads::{Attachment, Wrench, stacked};
use crate::process::ProcessSetup;
use nalgebra::{Isometry3, Vector6};
use truecut_arm::{Load, Robot};
use truecut_scenario::DriveKind;

/// Rounds until held joints stand where they are held; the sag hardly changes by them.
const HOLDING_ROUNDS: usize = 20;
/// Of a coordinate, rad or m.
const HELD: f64 = 1e-12;

/// Joints at the start, those of the base first: at rest under gravity and the process's static
/// loads, friction unloaded; an arm without drives in its posture, on a base at rest. Motors that
/// nothing commands are moved to where they hold their joints in the posture.
pub(super) fn at_start(
    kind: DriveKind,
    made: &ProcessSetup,
    altered: &Altered,
    command: &mut JointCommand,
    world_from_process: &Isometry3<f64>,
    gravity: &Load,
) -> Result<Vec<f64>, SimError> {
    let robot = &altered.robot;
    if kind == DriveKind::Force {
        let base = vec![0.0; altered.base_joints];
        let whole = [&base[..], &made.posture].concat();
        return Ok(effect::base_at_rest(altered, &whole, gravity));
    }
    let at_rest = |command: &JointCommand| {
        let position = first_of(command, robot.dof());
        let wrenches = made.process.static_loads().wrenches;
        let (attachment, wrench) = combine(robot, &position, &wrenches, world_from_process);
        let load = gravity.with_wrench(attachment.into(), wrench);
        effect::at_rest(altered, &position, &load)
    };
    let mut start = at_rest(command)?;
    let held = made.held();
    for _ in 0..HOLDING_ROUNDS {
        let missing = |joint: usize| made.posture[joint] - start[altered.base_joints + joint];
        let missing: Vec<(usize, f64)> = held.iter().map(|&j| (j, missing(j))).collect();
        if missing.iter().all(|(_, by)| by.abs() < HELD) {
            break;
        }
        for (joint, by) in missing {
            command.shift(altered.base_joints + joint, by);
        }
        start = at_rest(command)?;
    }
    Ok(start)
}

/// All wrenches as one, in world axes: at the frame they share, or at the tool.
fn combine(
    robot: &Robot,
    q: &[f64],
    wrenches: &[Wrench],
    world_from_process: &Isometry3<f64>,
) -> (Attachment, Vector6<f64>) {
    let at = |a: Attachment| robot.world_from_frame(q, a.into()).translation.vector;
    let shared = wrenches.first().map_or(Attachment::Tool, |w| w.frame);
    let target = if wrenches.iter().all(|w| w.frame == shared) {
        shared
    } else {
        Attachment::Tool
    };
    let mut total = Vector6::zeros();
    for wrench in wrenches {
        let force = world_from_process.rotation * wrench.force_n;
        let lever = at(wrench.frame) - at(target);
        let moment = world_from_process.rotation * wrench.moment_n_m + lever.cross(&force);
        total += stacked(&force, &moment);
    }
    (target, total)
}
