//! The effects that could be at work in a scenario, each with a typical size.
//!
//! A typical size is one that changes an output by a tenth or so; the search starts from it and is not bound
//! to it. It comes from the nominal run: a friction from the drive force, a play from the wind-up.

use std::f64::consts::TAU;

use truecut_recording::ChannelSpec;
use truecut_recording::measured::Measured;
use truecut_scenario::effect::{Effect, EffectKind, Family, Target, TargetKind};
use truecut_scenario::{ChamferSpec, ControlSpec, PolishSpec, ProcessSpec, ReplayMode, Scenario};
use truecut_sim::facts::RobotFacts;
use truecut_sim::{InverseModel, Rows, SteadyModel};

use crate::model::Candidate;

/// Part of a signal that a typical effect changes.
const SHARE: f64 = 0.1;

/// How far a polishing wheel is pressed in, as a part of its radius.
const TYPICAL_PENETRATION: f64 = 0.03;

/// What moves in the nominal run, joint by joint and channel by channel.
pub(super) struct Signals {
    joints: Vec<JointSignals>,
    moving_mass_kg: f64,
    /// Standard deviation of every measured output, with its name.
    outputs: Vec<(String, f64)>,
    interval_s: f64,
    duration_s: f64,
}

struct JointSignals {
    rotary: bool,
    stiffness: Option<f64>,
    /// Root mean square of the velocity.
    speed: f64,
    /// Greatest speed.
    fastest: f64,
    /// Standard deviation of the coordinate.
    travel: f64,
    /// Root mean square of the drive force or torque.
    effort: f64,
    /// Standard deviation of its magnitude, as a part of that.
    effort_varies: f64,
}

impl Signals {
    pub(super) fn new(
        scenario: &Scenario,
        measured: &Measured,
        facts: &RobotFacts,
        nominal: Option<&Rows>,
    ) -> Signals {
        let column = |name: &str| -> Option<Vec<f64>> {
            let simulated = nominal.and_then(|recording| {
                let index = recording
                    .channels
                    .iter()
                    .position(|spec| spec.name == name)?;
                Some(recording.columns[index].clone())
            });
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

    /// Of each joint, the greatest speed over which a friction may fall.
    pub(super) fn fall_speeds(&self) -> Vec<f64> {
        (self.joints.iter())
            .map(|joint| FALL_PART * joint.fastest)
            .collect()
    }
}

/// At its fastest the joint must be beyond the fall: at twice its speed 2 % of the excess are left.
const FALL_PART: f64 = 0.5;

/// Every effect that applies to the scenario and is not in it already.
pub(super) fn candidates(
    scenario: &Scenario,
    signals: &Signals,
    channels: &[ChannelSpec],
) -> Vec<Candidate> {
    let mut all = Vec::new();
    for kind in EffectKind::ALL.iter().copied() {
        if !applies(scenario, kind) {
            continue;
        }
        for target in targets(kind, signals, channels) {
            let known = |effect: &Effect| effect.kind == kind && effect.target == target;
            if scenario.effects.iter().any(known) {
                continue;
            }
            if let Some(scale) = scale(scenario, signals, kind, &target) {
                all.push(Candidate {
                    kind,
                    rotary: match target {
                        Target::Joint(joint) => signals.joints[joint].rotary,
                        _ => false,
                    },
                    target,
                    scale,
                });
            }
        }
    }
    all
}

fn applies(scenario: &Scenario, kind: EffectKind) -> bool {
    let process = &scenario.process;
    if let ProcessSpec::Replay(replay) = process {
        match replay.mode {
            ReplayMode::Inverse { .. } => return InverseModel::supports(kind),
            ReplayMode::Observe => return SteadyModel::supports(scenario, kind),
            ReplayMode::Forward => {}
        }
    }
    match kind.family() {
        Family::Joint | Family::Robot | Family::Sensor => true,
        Family::Cutting => match process {
            ProcessSpec::Chamfer(chamfer) => edge_tells(chamfer, kind),
            _ => false,
        },
        Family::Foot => match process {
            ProcessSpec::Chamfer(chamfer) => chamfer.foot.is_some(),
            ProcessSpec::Load(load) => load.foot.is_some(),
            _ => false,
        },
        Family::Wheel => match process {
            ProcessSpec::Wheel(_) => wheel_tells(kind),
            ProcessSpec::Polish(polish) => polish_tells(polish, kind),
            ProcessSpec::Belt(belt) => control_tells(Some(&belt.control), kind),
            ProcessSpec::Brush(_) => control_tells(None, kind),
            _ => false,
        },
    }
}

/// A single edge cannot differ from the others: its recess or runout is a depth offset.
fn edge_tells(chamfer: &ChamferSpec, kind: EffectKind) -> bool {
    let between_edges = matches!(
        kind,
        EffectKind::CuttingRunout | EffectKind::CuttingWornTooth
    );
    !between_edges || chamfer.edges > 1
}

/// What the wheel takes off is no channel of its process, and it has no force control.
fn wheel_tells(kind: EffectKind) -> bool {
    use EffectKind as K;
    matches!(
        kind,
        K::WheelStiffness | K::WheelEccentricity | K::WheelFriction
    )
}

/// An offset that does not turn is a deeper path.
fn polish_tells(polish: &PolishSpec, kind: EffectKind) -> bool {
    match kind {
        EffectKind::WheelEccentricity => polish.spin_rad_s != 0.0,
        _ => control_tells(Some(&polish.control), kind),
    }
}

/// A force control is there or not.
fn control_tells(control: Option<&ControlSpec>, kind: EffectKind) -> bool {
    match kind {
        EffectKind::WheelForceOffset | EffectKind::WheelForceStiction => {
            control.is_some_and(|control| control.force_n().is_some())
        }
        _ => true,
    }
}

fn targets(kind: EffectKind, signals: &Signals, channels: &[ChannelSpec]) -> Vec<Target> {
    match kind.target() {
        TargetKind::Whole => vec![Target::Whole],
        TargetKind::Joint => (0..signals.joints.len()).map(Target::Joint).collect(),
        TargetKind::Axis => (0..3).map(Target::Axis).collect(),
        TargetKind::Channel => (channels.iter())
            .map(|spec| Target::Channel(spec.name.clone()))
            .collect(),
    }
}

/// A typical distance from neutral for each parameter; `None` if the effect cannot show.
fn scale(
    scenario: &Scenario,
    signals: &Signals,
    kind: EffectKind,
    target: &Target,
) -> Option<Vec<f64>> {
    let scale = match (kind.family(), target) {
        (Family::Joint, Target::Joint(joint)) => joint_scale(&signals.joints[*joint], kind)?,
        (Family::Robot, _) => robot_scale(signals, kind),
        (Family::Cutting, _) => match &scenario.process {
            ProcessSpec::Chamfer(chamfer) => cutting_scale(chamfer, kind, signals.duration_s),
            ProcessSpec::Replay(replay) => vec![0.01 * replay.turning?.depth_m; 2],
            _ => return None,
        },
        (Family::Foot, _) => foot_scale(scenario, kind, signals.duration_s)?,
        (Family::Wheel, _) => match &scenario.process {
            ProcessSpec::Wheel(wheel) => {
                let flat = SHARE * wheel.normal_force_n / wheel.stiffness_n_per_m;
                match kind {
                    EffectKind::WheelEccentricity => vec![flat, flat],
                    _ => vec![SHARE],
                }
            }
            ProcessSpec::Polish(polish) => polish_scale(polish, kind),
            ProcessSpec::Belt(belt) => match kind {
                EffectKind::WheelEccentricity => vec![SHARE * belt.job.wheel.indentation_m; 2],
                _ => vec![SHARE],
            },
            ProcessSpec::Brush(brush) => match kind {
                EffectKind::WheelEccentricity => vec![SHARE * BRUSHED * brush.free_length_m; 2],
                _ => vec![SHARE],
            },
            _ => return None,
        },
        (Family::Sensor, Target::Channel(channel)) => {
            let spread = signals.outputs.iter().find(|(name, _)| name == channel)?.1;
            sensor_scale(kind, spread, signals)
        }
        _ => return None,
    };
    (scale.len() == kind.parameters().len() && scale.iter().all(|s| s.is_finite() && *s > 0.0))
        .then_some(scale)
}

/// By such a part of their length bristles are typically pressed in.
const BRUSHED: f64 = 0.05;

/// Most cycles per 2 pi of the coordinate that are looked for.
const MOST_CYCLES: f64 = 160.0;
/// A joint that turns the phase of a ripple by less than this shows a constant, which a ripple cannot be told from, rad.
const LEAST_PHASE: f64 = 0.1;

/// Under a load that varies by less than this part of itself, friction that grows with the load is dry friction.
const LEAST_VARIATION: f64 = 0.2;

fn joint_scale(joint: &JointSignals, kind: EffectKind) -> Option<Vec<f64>> {
    use EffectKind as K;
    let effort = SHARE * joint.effort;
    let windup = joint.stiffness.map(|k| joint.effort / k);
    Some(match kind {
        K::JointStiffness | K::JointDamping => {
            joint.stiffness?;
            vec![if kind == K::JointDamping { 1.0 } else { SHARE }]
        }
        K::JointViscous => vec![effort / joint.speed],
        K::JointAsymmetricViscous => vec![effort / joint.speed; 2],
        K::JointCoulomb | K::JointOffset => vec![effort],
        K::JointLoadFriction => {
            if joint.effort_varies.is_nan() || joint.effort_varies < LEAST_VARIATION {
                return None;
            }
            vec![0.5 * SHARE]
        }
        K::JointAsymmetricCoulomb | K::JointCounterbalance => vec![effort; 2],
        K::JointStribeck => vec![effort, 0.2 * joint.speed],
        K::JointBacklash => vec![2.0 * SHARE * windup?],
        K::JointHysteresis => vec![effort, windup?],
        K::JointCubicStiffness => vec![SHARE * joint.stiffness? / windup?.powi(2)],
        K::JointRipple => {
            let turn = if joint.rotary { 1.0 } else { TAU };
            if MOST_CYCLES * turn * joint.travel < LEAST_PHASE {
                return None;
            }
            let amplitude = SHARE * windup?;
            vec![amplitude, amplitude, 0.1 / joint.travel]
        }
        _ => return None,
    })
}

fn robot_scale(signals: &Signals, kind: EffectKind) -> Vec<f64> {
    match kind {
        EffectKind::Payload => vec![0.05 * signals.moving_mass_kg, 0.1, 0.1, 0.1],
        _ => {
            let stiffest = (signals.joints.iter().filter_map(|joint| joint.stiffness))
                .fold(f64::NAN, f64::max);
            vec![SHARE / stiffest]
        }
    }
}

fn cutting_scale(chamfer: &ChamferSpec, kind: EffectKind, duration_s: f64) -> Vec<f64> {
    use EffectKind as K;
    let tooth_feed = chamfer.feed_per_tooth_m();
    // Cutting force per edge length at full chip.
    let line = SHARE * chamfer.cutting.in_plane_pa * tooth_feed;
    let turns = chamfer.spindle_rad_s * duration_s;
    let path = turns * 0.5 * chamfer.hole_diameter_m;
    match kind {
        K::CuttingEdgeForce => vec![line; 3],
        K::CuttingRunout => vec![2.0 * SHARE * tooth_feed; 2],
        // The hole's offset varies the depth around the rim.
        K::CuttingHoleOffset => vec![0.5 * SHARE * chamfer.depth_m; 2],
        K::CuttingWornTooth => vec![2.0 * SHARE * tooth_feed],
        K::CuttingWear => vec![2.0 * SHARE / path],
        K::CuttingDepthOffset => vec![2.0 * SHARE * chamfer.depth_m],
        K::SpindleSpeed => vec![(0.3 / turns).min(SHARE)],
        _ => vec![SHARE],
    }
}

fn foot_scale(scenario: &Scenario, kind: EffectKind, duration_s: f64) -> Option<Vec<f64>> {
    let foot = match &scenario.process {
        ProcessSpec::Chamfer(chamfer) => chamfer.foot.as_ref()?,
        ProcessSpec::Load(load) => load.foot.as_ref()?,
        _ => return None,
    };
    Some(match kind {
        EffectKind::FootFrictionFalling => vec![2.0 * SHARE, 1e-3],
        EffectKind::FootPressureLoss => vec![SHARE / duration_s],
        EffectKind::FootSealStiction => vec![SHARE * foot.preload_n()],
        _ => vec![SHARE],
    })
}

fn polish_scale(polish: &PolishSpec, kind: EffectKind) -> Vec<f64> {
    use EffectKind as K;
    match kind {
        // A patch that is small beside the wheel: the wheel is pressed in by a few percent of its radius.
        K::WheelEccentricity => vec![SHARE * TYPICAL_PENETRATION * polish.wheel.radius_m; 2],
        _ => control_scale(&polish.control, kind),
    }
}

fn control_scale(control: &ControlSpec, kind: EffectKind) -> Vec<f64> {
    match (kind, control.force_n()) {
        (EffectKind::WheelForceOffset | EffectKind::WheelForceStiction, Some(force_n)) => {
            vec![SHARE * force_n]
        }
        _ => vec![SHARE],
    }
}

fn sensor_scale(kind: EffectKind, spread: f64, signals: &Signals) -> Vec<f64> {
    match kind {
        EffectKind::SensorDelay | EffectKind::SensorLowPass => vec![signals.interval_s],
        EffectKind::SensorOffset => vec![SHARE * spread],
        EffectKind::SensorDrift => vec![SHARE * spread, 0.3 * signals.duration_s],
        _ => vec![SHARE],
    }
}

fn step(times_s: &[f64]) -> f64 {
    match times_s {
        [first, .., last] => (last - first) / (times_s.len() - 1) as f64,
        _ => f64::NAN,
    }
}

fn differences(values: &[f64]) -> Vec<f64> {
    values.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

fn rms(values: &[f64]) -> f64 {
    let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    (finite.iter().map(|v| v * v).sum::<f64>() / finite.len() as f64).sqrt()
}

fn deviation(values: &[f64]) -> f64 {
    let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let mean = finite.iter().sum::<f64>() / finite.len() as f64;
    rms(&finite.iter().map(|v| v - mean).collect::<Vec<_>>())
}
