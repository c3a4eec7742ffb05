//! What moves in the nominal run: what sizes of effects are measured by.

use truecut_recording::measured::Measured;
use truecut_scenario::Scenario;
use truecut_scenario::effect::EffectKind;
use truecut_sim::facts::RobotFacts;
use truecut_sim::run::Rows;

use crate::stats;

/// What moves in the nominal run, joint by joint and channel by channel.
pub(super) struct Signals {
    pub joints: Vec<JointSignals>,
    pub moving_mass_kg: f64,
    /// Standard deviation of every measured output, with its name.
    pub outputs: Vec<(String, f64)>,
    pub interval_s: f64,
    pub duration_s: f64,
}

pub(super) struct JointSignals {
    pub rotary: bool,
    pub stiffness: Option<f64>,
    /// Root mean square of the velocity.
    pub speed: f64,
    /// Greatest speed.
    pub fastest: f64,
    /// Standard deviation of the coordinate.
    pub travel: f64,
    /// The coordinate from end to end.
    range: [f64; 2],
    /// Speed that it exceeds in one sample of a hundred, over several samples.
    sustained: f64,
    /// Root mean square of the drive force or torque.
    pub effort: f64,
    /// Standard deviation of its magnitude, as a part of that.
    pub effort_varies: f64,
}

/// A channel of a run.
pub(super) fn column<'a>(rows: &'a Rows, name: &str) -> Option<&'a Vec<f64>> {
    let mut pairs = rows.channels.iter().zip(&rows.columns);
    pairs.find_map(|(spec, column)| (spec.name == name).then_some(column))
}

/// Whether a channel says where the tool is, or how far it has moved.
pub(crate) fn is_place(channel: &str) -> bool {
    ["tool.position_", "tool.displacement_"]
        .iter()
        .any(|start| channel.starts_with(start))
}

impl Signals {
    pub(super) fn new(
        scenario: &Scenario,
        measured: &Measured,
        facts: &RobotFacts,
        nominal: Option<&Rows>,
    ) -> Signals {
        let column = |name: &str| -> Option<Vec<f64>> {
            let simulated = nominal.and_then(|rows| column(rows, name)).cloned();
            simulated.or_else(|| measured.channel(name).ok().map(|one| one.values.clone()))
        };
        let first = |joint: usize, names: &[&str]| {
            let mut found = names
                .iter()
                .map(|name| column(&format!("joint{joint}.{name}")));
            found.find_map(|values| values)
        };
        let interval_s = match nominal {
            Some(recording) => step(&recording.time_s),
            None => measured.interval_s(),
        };
        let joints = (facts.joints.iter().enumerate())
            .map(|(index, joint)| {
                let number = index + 1;
                let coordinate = first(number, &["angle", "position"]).unwrap_or_default();
                let efforts = [
                    "drive_torque",
                    "drive_force",
                    "transmission_torque",
                    "transmission_force",
                ];
                let velocity = differences(&coordinate);
                let efforts = first(number, &efforts).unwrap_or_default();
                let magnitudes: Vec<f64> = efforts.iter().map(|effort| effort.abs()).collect();
                JointSignals {
                    rotary: joint.rotary,
                    stiffness: joint.stiffness.map(|k| k * scenario.robot.stiffness_scale),
                    speed: rms(&velocity) / interval_s,
                    fastest: velocity.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
                        / interval_s,
                    travel: deviation(&coordinate),
                    range: ends(&coordinate),
                    sustained: sustained(&coordinate) / interval_s,
                    effort: rms(&efforts),
                    effort_varies: deviation(&magnitudes) / rms(&efforts),
                }
            })
            .collect();
        Signals {
            joints,
            moving_mass_kg: facts.moving_mass_kg,
            outputs: (measured.outputs())
                .map(|one| (one.spec.name.clone(), deviation(&one.values)))
                .collect(),
            interval_s: measured.interval_s(),
            duration_s: (measured.process_time_s().into_iter()).fold(0.0, f64::max),
        }
    }

    /// Whether places of the tool were measured while the arm goes from posture to posture: of one
    /// that is pushed about one, a link's length is hardly more than the weight that it moves.
    pub(super) fn shows_places(&self, scenario: &Scenario) -> bool {
        let mut outputs = self.outputs.iter();
        scenario.process.facts().replays && outputs.any(|(name, _)| is_place(name))
    }

    /// Of each joint, the greatest speed over which a friction may fall.
    pub(super) fn fall_speeds(&self) -> Vec<f64> {
        (self.joints.iter())
            .map(|joint| FALL_PART * joint.fastest)
            .collect()
    }
}

impl JointSignals {
    /// From end to end of what a curve of this kind is given over; `None` where nothing moves.
    pub(super) fn ends(&self, kind: EffectKind) -> Option<[f64; 2]> {
        let ends = match kind {
            EffectKind::JointFrictionBySpeed => [0.0, self.sustained],
            _ => self.range,
        };
        let moves = self.travel > LEAST_TRAVEL && ends[1] - ends[0] > LEAST_TRAVEL;
        moves.then_some(ends)
    }
}

/// A joint that moves by less, rad (m) or as much a second, shows no curve.
const LEAST_TRAVEL: f64 = 1e-6;
/// Samples over which a speed is taken: between two of them it is noise.
const SPEED_OVER: usize = 6;

fn ends(values: &[f64]) -> [f64; 2] {
    let finite = finite(values);
    [
        finite.iter().copied().fold(f64::INFINITY, f64::min),
        finite.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    ]
}

fn sustained(values: &[f64]) -> f64 {
    let pairs = values.windows(SPEED_OVER + 1);
    let mut speeds: Vec<f64> = finite(
        &pairs
            .map(|window| (window[SPEED_OVER] - window[0]).abs() / SPEED_OVER as f64)
            .collect::<Vec<_>>(),
    );
    speeds.sort_by(f64::total_cmp);
    let last = speeds.len().saturating_sub(1);
    speeds.get(last - last / 100).copied().unwrap_or(0.0)
}

/// At its fastest the joint must be beyond the fall: at twice its speed 2 % of the excess are left.
const FALL_PART: f64 = 0.5;

fn step(times_s: &[f64]) -> f64 {
    match times_s {
        [first, .., last] => (last - first) / (times_s.len() - 1) as f64,
        _ => f64::NAN,
    }
}

fn differences(values: &[f64]) -> Vec<f64> {
    values.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// Root mean square of the values that are finite.
fn rms(values: &[f64]) -> f64 {
    stats::rms(&finite(values))
}

/// Standard deviation of the values that are finite.
fn deviation(values: &[f64]) -> f64 {
    stats::deviation(&finite(values))
}

fn finite(values: &[f64]) -> Vec<f64> {
    values.iter().copied().filter(|v| v.is_finite()).collect()
}
