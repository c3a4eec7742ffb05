//! Ways of a wheel that are solved as a whole before the run.

use crate::belt_path::{self, BeltLines};
use crate::brush_path::{self, BrushWork};
use crate::command::Samples;
use crate::error::SimError;
use crate::polish_path;
use crate::robots::Robots;
use crate::tool_path::Along;
use std::sync::Arc;
use truecut_arm::{Load, Robot};
use truecut_scenario::{LONGEST_S, ProcessSpec, Scenario};

/// Time between knots of the command, s.
pub(crate) const KNOT_INTERVAL_S: f64 = 5e-3;

/// A way that leads the arm.
#[derive(Debug)]
pub(crate) struct LedPath {
    /// Postures every [`KNOT_INTERVAL_S`], from the start on.
    pub postures: Vec<Vec<f64>>,
    pub duration_s: f64,
    /// What there is to tell of it, for people.
    pub note: Option<String>,
    pub over: Over,
}

/// What a way was solved over, for the process that goes along it.
#[derive(Debug)]
pub(crate) enum Over {
    /// A face that the scenario gives whole.
    Face,
    /// The lines of a path job.
    Lines(BeltLines),
    /// A workpiece and its edges.
    Edges(BrushWork),
}

impl LedPath {
    /// The way of a scenario whose process has one; `posture` is where the arm comes from, or what the first posture is to be near.
    pub(crate) fn of(
        scenario: &Scenario,
        robot: &Robot,
        robots: &Robots,
        posture: &[f64],
    ) -> Result<Option<Arc<Self>>, SimError> {
        let solve = || match &scenario.process {
            ProcessSpec::Polish(spec) => polish_path::solve(spec, robot, posture).map(Some),
            ProcessSpec::Belt(spec) => belt_path::solve(spec, robot, posture).map(Some),
            ProcessSpec::Brush(spec) => brush_path::solve(spec, robot).map(Some),
            _ => Ok(None),
        };
        let found = robots.led_path(&scenario.robot, posture, &scenario.process, solve)?;
        let Some(path) = found else { return Ok(None) };
        let (asked_s, taken_s) = (scenario.run.duration_s, path.duration_s);
        if asked_s.is_finite() && asked_s > taken_s {
            return Err(SimError::scenario(
                "run.duration_s",
                format!(
                    "{asked_s} s are longer than the path takes, {taken_s:.4} s: the tool has nowhere to go; leave the key out"
                ),
            ));
        }
        Ok(Some(path))
    }

    /// Where the arm stands before the first step, without load.
    pub(crate) fn start(&self) -> &[f64] {
        &self.postures[0]
    }

    /// The command that leads a nominal arm along, with the sag that it makes up for.
    pub(crate) fn command(&self, robot: &Robot, sag: Option<&Load>) -> Result<Samples, SimError> {
        let postures = match sag {
            Some(load) => robot.holding_commands(&self.postures, load)?,
            None => self.postures.clone(),
        };
        Ok(Samples {
            interval_s: KNOT_INTERVAL_S,
            postures,
            forces: vec![None; robot.dof()],
        })
    }
}

/// Refuses a way that takes longer than a run may: it would not fit into memory. `advice` says what helps.
pub(crate) fn check_duration(key: &str, duration_s: f64, advice: &str) -> Result<(), SimError> {
    if duration_s <= LONGEST_S {
        return Ok(());
    }
    Err(SimError::scenario(
        key,
        format!(
            "the way takes {duration_s:.4e} s, but must take at most {LONGEST_S} s: a run fits into memory; {advice}"
        ),
    ))
}

/// Refuses a way on which a joint is faster than it can be. `from` names what distances are counted from, `advice` what helps.
pub(crate) fn check_speeds(
    robot: &Robot,
    postures: &[Vec<f64>],
    along: &Along<'_>,
    from: &str,
    advice: &str,
) -> Result<(), SimError> {
    for (k, pair) in postures.windows(2).enumerate() {
        for (index, joint) in robot.chain.joints.iter().enumerate() {
            let Some(limits) = joint.limits else { continue };
            let speed = (pair[1][index] - pair[0][index]).abs() / KNOT_INTERVAL_S;
            if speed > limits.velocity {
                return Err(SimError::scenario(
                    along.key,
                    format!(
                        "joint `{}` would have to move at {:.2} deg/s {:.1} mm from {from}'s start, but can do {:.2} deg/s: {advice}",
                        joint.name,
                        speed.to_degrees(),
                        (along.at_mm)(k),
                        limits.velocity.to_degrees()
                    ),
                ));
            }
        }
    }
    Ok(())
}
