//! The time step: default and limit.

mod own_modes;

use crate::engine::Engine;
use crate::error::SimError;
use crate::process::Process;
use nalgebra::DMatrix;
use std::f64::consts::TAU;
use truecut_arm::{FrameId, LinearArm, Load, Robot};
use truecut_recording::significant;
use truecut_scenario::RunSpec;

/// Default steps between two cutting edges.
const STEPS_PER_TOOTH: f64 = 40.0;
/// Default steps in one period of the fastest given force; the exact scheme meets a force of
/// frequency w to (w dt)²/12: 0.2 %.
const STEPS_PER_FORCE_PERIOD: f64 = 40.0;

/// Default steps in the shortest time in which a carrier follows its contact.
const STEPS_PER_QUICKEST: f64 = 5.0;

/// Relative error of an interval that is rounding.
const ROUNDING: f64 = 1e-9;

/// How the plant is stepped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Scheme {
    /// rapier's: second order in all that moves.
    Leapfrog,
    /// Exact for the linear arm; second order in what acts on it.
    Exact {
        /// Default steps in one period of the fastest mode.
        steps_per_period: f64,
    },
}

impl Scheme {
    /// The scheme of an engine, for an arm of which a joint has play or none has.
    pub fn of(engine: Engine, has_play: bool) -> Self {
        match engine {
            Engine::Rapier => Self::Leapfrog,
            Engine::Reduced {
                steps_per_period, ..
            } => Self::Exact {
                steps_per_period: match has_play {
                    true => steps_per_period.with_play,
                    false => steps_per_period.without_play,
                },
            },
        }
    }

    fn is_exact(self) -> bool {
        self != Self::Leapfrog
    }

    /// No default step is longer than this, s. Sticking and slipping is met to a step only: with 1
    /// ms clear data show it, and a diagnosis takes an effect that shortens the step (a base that
    /// gives, play) for a cause.
    fn longest_s(self) -> f64 {
        match self {
            Self::Leapfrog => 0.25e-3,
            Self::Exact { .. } => 0.8e-3,
        }
    }

    /// Default steps in one period of the fastest mode.
    fn steps_per_period(self) -> f64 {
        match self {
            Self::Leapfrog => 60.0,
            Self::Exact { steps_per_period } => steps_per_period,
        }
    }

    /// Default steps in one period of a mode that only a base which gives has: nothing acts within
    /// the base, and nothing is read there.
    fn steps_per_base_period(self) -> f64 {
        match self {
            Self::Leapfrog => self.steps_per_period(),
            Self::Exact { .. } => 5.0,
        }
    }

    /// Longest default step for the modes, s.
    fn step_of_modes_s(self, fastest: Fastest) -> f64 {
        let of_base = 1.0 / (fastest.frequency_hz * self.steps_per_base_period());
        of_base.min(1.0 / (fastest.base_held_hz * self.steps_per_period()))
    }

    /// Fewest steps in one period of the fastest mode that are accepted. The leapfrog scheme would
    /// be stable down to π; at eight the fastest mode is out of tune by (2π/8)²/24 = 2.6 %, slower
    /// ones by far less. The exact scheme reads velocities off two positions, for which two steps
    /// in a period are too few.
    fn fewest_steps_per_period(self) -> f64 {
        match self {
            Self::Leapfrog => 8.0,
            Self::Exact { .. } => 4.0,
        }
    }
}

/// Most steps of a run: some twenty minutes of a six-joint arm.
const MOST_STEPS: f64 = 2e7;

/// The fastest mode of the plant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fastest {
    pub frequency_hz: f64,
    /// Fastest mode with the base held.
    pub base_held_hz: f64,
    /// What makes it so fast.
    pub cause: Cause,
}

/// What a fast mode is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cause {
    /// Joints and links.
    Joints,
    /// The spring of a contact.
    Contact,
    /// A rotor between drive and transmission.
    Rotor,
}

impl Cause {
    /// The key it is written under, and what it is.
    fn place(self) -> (&'static str, &'static str) {
        match self {
            Cause::Joints => (
                "robot.urdf",
                "the stiffness of a joint on the mass it moves",
            ),
            Cause::Contact => ("process", "the stiffness of the process's contact"),
            Cause::Rotor => ("robot.urdf", "a rotor on its transmission"),
        }
    }
}

/// Refuses a run of more steps than anyone waits for; `from` is the key that the step comes from,
/// and why it is so short.
fn check_count(step_s: f64, duration_s: f64, (key, why): (&str, &str)) -> Result<(), SimError> {
    let count = duration_s / step_s;
    if count <= MOST_STEPS {
        return Ok(());
    }
    Err(SimError::scenario(
        key,
        format!(
            "{duration_s} s in steps of {step_s:.4e} s are {count:.2e} steps, but a run has at most \
             {MOST_STEPS:.0e}; {why}"
        ),
    ))
}

/// What a default step is so short for: a key, and the reason.
fn cause(
    step_s: f64,
    scheme: Scheme,
    fastest: Option<Fastest>,
    (quickest_s, own): (Option<f64>, Option<(f64, f64)>),
) -> (&'static str, String) {
    let is_set_by = |limit_s: f64| step_s >= 0.99 * limit_s;
    if quickest_s.is_some_and(|t| is_set_by(t / STEPS_PER_QUICKEST)) {
        let why = "it is a fifth of the time in which the carrier of the force control follows its contact";
        return ("process", why.into());
    }
    if let Some((own_s, hz)) = own.filter(|(own_s, _)| is_set_by(*own_s)) {
        let parts = 1.0 / (own_s * hz);
        let why =
            format!("it is 1/{parts:.0} of the period of the fastest mode of tool and workpiece");
        return ("process", why);
    }
    let Some(fastest) = fastest.filter(|f| is_set_by(scheme.step_of_modes_s(*f))) else {
        let why = "it follows from the time between two cutting edges, or is the longest";
        return ("process", why.into());
    };
    let frequency_hz = fastest.frequency_hz;
    let per_period = (1.0 / (step_s * frequency_hz)).round();
    let (key, what) = fastest.cause.place();
    let why = format!(
        "it is 1/{per_period} of the period of the fastest mode, at {frequency_hz:.4e} Hz, which {what} makes"
    );
    (key, why)
}

/// Refuses a step in which a wheel's carrier would leave its contact before it is asked again.
fn check_carrier(asked_s: f64, process: &dyn Process) -> Result<(), SimError> {
    let Some(quickest_s) = process.quickest_s().filter(|t| asked_s > *t) else {
        return Ok(());
    };
    Err(SimError::scenario(
        "run.time_step_ms",
        format!(
            "`run.time_step_ms` is {}, but must be at most {}: so soon the carrier of the force control follows its contact; leave the key \
             out, or give the control more damping (law \"constant_force\") or more mass and a softer spring (law \"compliant\")",
            significant(asked_s * 1e3, 4),
            significant(quickest_s * 1e3, 4)
        ),
    ))
}

/// The step of a run, s: the smallest of
/// - the scheme's longest (0.25 ms; exact: 0.8 ms),
/// - its part (1/60; exact: 1/20, with play 1/40; 1/5 of a mode that only a base that gives has) of
///   the fastest mode's period, contact springs and rotors included,
/// - a fifth of the time in which a wheel's carrier follows its contact,
/// - 1/40 of the period of the fastest mode of tool and workpiece, less where a tool mode moves
///   more than a fiftieth of the arm's mass,
/// - 1/40 of the tooth period and, for the exact scheme, 1/40 of the period of the fastest given
///   force,
///
/// shortened so that the run is a whole number of steps (exact scheme with a recording interval:
/// the interval is; milling: the tooth period); or the one asked for, if it is short enough.
pub(crate) fn choose(
    scheme: Scheme,
    run: &RunSpec,
    fastest: Option<Fastest>,
    process: &dyn Process,
) -> Result<f64, SimError> {
    let fastest_mode_hz = fastest.map(|fastest| fastest.frequency_hz);
    if let Some(asked) = run.time_step_s {
        let from = ("run.time_step_ms", "it is the step asked for");
        check_count(asked, run.duration_s, from)?;
        check_carrier(asked, process)?;
        own_modes::check(asked, process)?;
        return check(scheme, asked, fastest_mode_hz);
    }
    let longest = scheme.longest_s();
    let quickest_s = process.quickest_s();
    let carried = quickest_s.map_or(longest, |t| t / STEPS_PER_QUICKEST);
    let mode = fastest.map_or(longest, |fastest| scheme.step_of_modes_s(fastest));
    let tooth = process
        .tooth_period_s()
        .map_or(longest, |t| t / STEPS_PER_TOOTH);
    let own_s = own_modes::step_s(process);
    let own = own_s.unwrap_or(longest);
    let mut step = longest.min(mode).min(tooth).min(carried).min(own);
    if scheme.is_exact()
        && let Some(f) = process.highest_frequency_hz()
    {
        step = step.min(1.0 / (f * STEPS_PER_FORCE_PERIOD));
    }
    let (key, why) = cause(
        step,
        scheme,
        fastest,
        (quickest_s, own_s.zip(process.fastest_mode_hz())),
    );
    check_count(step, run.duration_s, (key, &why))?;
    if let Some(period) = process
        .tooth_period_s()
        .filter(|_| process.steps_with_teeth())
    {
        let count = (period / step).ceil();
        return Ok(period
            / if scheme.is_exact() {
                graded(count)
            } else {
                count
            });
    }
    let whole = match run.record_interval_s {
        Some(interval) if scheme.is_exact() => interval,
        _ => run.duration_s,
    };
    Ok(whole_part(whole, step))
}

/// The next of numbers a fifth apart. In a search that varies a mode of the tool the step then
/// stays as it is, and with it its error; one that follows the mode makes predictions jump.
fn graded(count: f64) -> f64 {
    ((4.0 * count.log2() * (1.0 - ROUNDING)).ceil() / 4.0)
        .exp2()
        .ceil()
}

/// The longest whole part of `whole` that is no longer than `step`. An interval read off times in
/// decimals misses its round value by rounding; that asks for no part more.
fn whole_part(whole: f64, step: f64) -> f64 {
    whole / (whole / step * (1.0 - ROUNDING)).ceil()
}

fn check(scheme: Scheme, asked_s: f64, fastest_mode_hz: Option<f64>) -> Result<f64, SimError> {
    let fewest = scheme.fewest_steps_per_period();
    if let Some(f) = fastest_mode_hz
        && asked_s * f * fewest > 1.0
    {
        let limit_ms = 1e3 / (f * fewest);
        return Err(SimError::scenario(
            "run.time_step_ms",
            format!(
                "a step of {} ms is too long: the fastest mode, at {f:.1} Hz, needs at least \
                 {fewest} steps in a period, that is {limit_ms:.3} ms at most",
                asked_s * 1e3
            ),
        ));
    }
    Ok(asked_s)
}

/// Frequency of the fastest mode of the arm with the process's springs attached, Hz. `None` for an
/// arm whose joints are free.
pub(crate) fn fastest_mode(
    robot: &Robot,
    q: &[f64],
    process: &dyn Process,
    base_joints: usize,
    with_rotors: bool,
) -> Result<Fastest, SimError> {
    let mut arm = robot.linearised(q, FrameId::Tool, &Load::none())?;
    let highest = |arm: &LinearArm| -> Result<f64, SimError> {
        Ok(arm
            .modes()?
            .frequency_hz
            .iter()
            .copied()
            .fold(0.0, f64::max))
    };
    let alone_hz = highest(&arm)?;
    let world_from_process = robot.world_from_process(q);
    for spring in process.contact_stiffness() {
        let direction = world_from_process.rotation * spring.direction;
        let row = robot
            .jacobian(q, spring.frame.into())
            .fixed_rows::<3>(0)
            .tr_mul(&direction);
        arm.stiffness += &row * row.transpose() * spring.stiffness_n_per_m;
    }
    let frequency_hz = highest(&arm)?;
    let mut fastest = Fastest {
        frequency_hz,
        base_held_hz: match base_joints {
            0 => frequency_hz,
            base => highest(&base_held(&arm, base))?,
        },
        cause: Cause::Joints,
    };
    // A contact that makes the fastest mode half as fast again is what it is made of.
    if fastest.frequency_hz > 1.5 * alone_hz {
        fastest.cause = Cause::Contact;
    }
    let rotor_hz = if with_rotors {
        rotor_mode_hz(robot, &arm.mass)
    } else {
        0.0
    };
    fastest.base_held_hz = fastest.base_held_hz.max(rotor_hz);
    if rotor_hz > fastest.frequency_hz {
        fastest.frequency_hz = rotor_hz;
        fastest.cause = Cause::Rotor;
    }
    Ok(fastest)
}

/// The arm without its first joints, the springs of its base.
fn base_held(arm: &LinearArm, base: usize) -> LinearArm {
    let n = arm.mass.nrows() - base;
    let part = |whole: &DMatrix<f64>| whole.view((base, base), (n, n)).into_owned();
    LinearArm {
        mass: part(&arm.mass),
        damping: part(&arm.damping),
        stiffness: part(&arm.stiffness),
        tip_jacobian: arm.tip_jacobian.columns(base, n).into_owned(),
    }
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

#[cfg(test)]
mod tests {
    use super::whole_part;

    #[test]
    fn rounding_asks_for_no_part_more() {
        let parts = |whole: f64, step: f64| (whole / whole_part(whole, step)).round();
        // Four milliseconds as the difference of two times in decimals.
        let read_s = 1.004 - 1.0;
        assert!(read_s > 0.004);
        assert_eq!(parts(read_s, 0.8e-3), 5.0);
        assert_eq!(parts(0.004, 0.8e-3), 5.0);
        assert_eq!(parts(0.004, 0.799e-3), 6.0);
        assert_eq!(parts(0.002, 0.8e-3), 3.0);
        assert_eq!(parts(0.5e-3, 0.8e-3), 1.0);
    }
}
