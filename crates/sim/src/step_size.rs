//! The time step: default and limit.

use crate::error::SimError;
use crate::process::Process;
use nalgebra::DMatrix;
use std::f64::consts::TAU;
use truecut_arm::{FrameId, Load, Robot};

/// No default step is longer than this, s.
const LONGEST_S: f64 = 0.25e-3;
/// Default steps in one period of the fastest mode.
const STEPS_PER_PERIOD: f64 = 60.0;
/// Fewest steps in one period of the fastest mode that are accepted. The scheme would be stable down to π;
/// at eight the fastest mode is out of tune by (2π/8)²/24 = 2.6 %, slower ones by far less.
const FEWEST_STEPS_PER_PERIOD: f64 = 8.0;
/// Default steps between two cutting edges.
const STEPS_PER_TOOTH: f64 = 40.0;

/// The step of a run, s: the smallest of 0.25 ms, 1/60 of the fastest mode's period (contact springs and
/// rotors included) and 1/40 of the tooth period, shortened so that the run is a whole number of steps;
/// or the one asked for, if it is short enough.
pub(crate) fn choose(
    asked_s: Option<f64>,
    fastest_mode_hz: Option<f64>,
    process: &dyn Process,
    duration_s: f64,
) -> Result<f64, SimError> {
    if let Some(asked) = asked_s {
        if let Some(f) = fastest_mode_hz
            && asked * f * FEWEST_STEPS_PER_PERIOD > 1.0
        {
            let limit_ms = 1e3 / (f * FEWEST_STEPS_PER_PERIOD);
            return Err(SimError::scenario(
                "run.time_step_ms",
                format!(
                    "a step of {} ms is too long: the fastest mode, at {f:.1} Hz, needs at least \
                     {FEWEST_STEPS_PER_PERIOD} steps in a period, that is {limit_ms:.3} ms at most",
                    asked * 1e3
                ),
            ));
        }
        return Ok(asked);
    }
    let mode = fastest_mode_hz.map_or(LONGEST_S, |f| 1.0 / (f * STEPS_PER_PERIOD));
    let tooth = process
        .tooth_period_s()
        .map_or(LONGEST_S, |t| t / STEPS_PER_TOOTH);
    let step = LONGEST_S.min(mode).min(tooth);
    Ok(duration_s / (duration_s / step).ceil())
}

/// Frequency of the fastest mode of the arm with the process's springs attached, Hz. `None` for an arm
/// whose joints are free.
pub(crate) fn fastest_mode_hz(
    robot: &Robot,
    q: &[f64],
    process: &dyn Process,
    with_rotors: bool,
) -> Result<f64, SimError> {
    let mut arm = robot.linearised(q, FrameId::Tool, &Load::none())?;
    let world_from_process = robot.world_from_process(q);
    for spring in process.contact_stiffness() {
        let direction = world_from_process.rotation * spring.direction;
        let row = robot
            .jacobian(q, spring.frame.into())
            .fixed_rows::<3>(0)
            .tr_mul(&direction);
        arm.stiffness += &row * row.transpose() * spring.stiffness_n_per_m;
    }
    let modes = arm.modes()?;
    let mut fastest = modes.frequency_hz.iter().copied().fold(0.0, f64::max);
    if with_rotors {
        fastest = fastest.max(rotor_mode_hz(robot, &arm.mass));
    }
    Ok(fastest)
}

/// Fastest of the modes in which a rotor swings against its link.
fn rotor_mode_hz(robot: &Robot, mass: &DMatrix<f64>) -> f64 {
    let joints = robot.chain.joints.iter().enumerate();
    joints
        .filter_map(|(i, joint)| {
            let t = &joint.transmission;
            let stiffness = t.stiffness?;
            (t.rotor_inertia > 0.0)
                .then(|| (stiffness * (1.0 / t.rotor_inertia + 1.0 / mass[(i, i)])).sqrt() / TAU)
        })
        .fold(0.0, f64::max)
}
