//! Where an arm with effects rests.

use super::Altered;
use crate::error::SimError;
use truecut_arm::Load;
use truecut_core::joint_law::{Elastic, JointLaw};

/// Most rounds of the search.
const MAX_ROUNDS: usize = 200;
/// The search ends when no coordinate moves by more than this, rad (m): rounding of the
/// coordinates.
const TOLERANCE: f64 = 1e-15;

/// The posture in which the arm rests at `command` under `load`: link friction and hysteresis
/// unloaded, a joint with play on the side that the load chooses, in the middle without load.
///
/// The nominal equilibrium is solved for a command that stands where a linear transmission would
/// have to stand; play, ripple, cubic stiffness and torques on the link move that command until it
/// no longer changes.
pub(crate) fn at_rest(
    altered: &Altered,
    command: &[f64],
    load: &Load,
) -> Result<Vec<f64>, SimError> {
    let (robot, laws) = (&altered.robot, &altered.laws);
    let mut q = robot.static_posture(command, load)?;
    if laws.iter().all(JointLaw::is_nominal) {
        return Ok(q);
    }
    let stiffness = robot.transmission_stiffness("a driven arm")?;
    let mut stand_in = command.to_vec();
    for _ in 0..MAX_ROUNDS {
        let mut moved: f64 = 0.0;
        for (i, law) in laws.iter().enumerate() {
            let k = stiffness[(i, i)];
            let elastic = Elastic {
                stiffness: k,
                cubic: law.cubic,
                gap: law.gap,
            };
            let linear_windup = stand_in[i] - q[i];
            // What cancels to rounding is no load that could choose a side of the play.
            let carried = k * linear_windup - law.link_torque(q[i]);
            let floor = 1e-12 * k * (1.0 + q[i].abs());
            let carried = if carried.abs() < floor { 0.0 } else { carried };
            let Some(windup) = elastic.windup(carried) else {
                return Err(no_rest(i, carried));
            };
            let next = law.seen(command[i]) - windup + linear_windup;
            moved = moved.max((next - stand_in[i]).abs());
            stand_in[i] = next;
        }
        if moved <= TOLERANCE * (1.0 + command.iter().fold(0.0, |a: f64, c| a.max(c.abs()))) {
            return Ok(q);
        }
        q = robot.static_posture(&stand_in, load)?;
    }
    // A joint that a load of changing sign drives to and fro across its play has no one posture at
    // rest.
    Err(SimError::scenario(
        "effect",
        format!("the arm finds no posture at rest with these effects in {MAX_ROUNDS} rounds"),
    ))
}

fn no_rest(joint: usize, torque: f64) -> SimError {
    SimError::scenario(
        "effect",
        format!(
            "the transmission of joint {} cannot carry {torque:.4} N m (N) at the start: it softens too much",
            joint + 1
        ),
    )
}

/// Tilt of the base under the arm when the arm itself is not held (`drive = "force"`): joints of
/// the base at rest, those of the arm where they are asked to start.
pub(crate) fn base_at_rest(altered: &Altered, start: &[f64], load: &Load) -> Vec<f64> {
    let robot = &altered.robot;
    let mut q = start.to_vec();
    if altered.base_joints == 0 {
        return q;
    }
    for _ in 0..MAX_ROUNDS {
        let torque = robot.load_torques(&q, load);
        let mut moved: f64 = 0.0;
        for i in 0..altered.base_joints {
            let next = -torque[i]
                / robot.chain.joints[i]
                    .transmission
                    .stiffness
                    .unwrap_or(f64::INFINITY);
            moved = moved.max((next - q[i]).abs());
            q[i] = next;
        }
        if moved <= TOLERANCE {
            break;
        }
    }
    q
}
