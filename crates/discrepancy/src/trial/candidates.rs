//! The effects that could be at work in a scenario, each with a typical size.
//!
//! A typical size is one that changes an output by a tenth or so; the search starts from it and is
//! not bound to it. It comes from the nominal run: a friction from the drive force, a play from the
//! wind-up.
#![deny(clippy::wildcard_enum_match_arm)]

mod joints;
mod targets;

use std::collections::BTreeMap;

use truecut_recording::ChannelSpec;
use truecut_scenario::effect::{
    BaseEffect, ClockEffect, CuttingEffect, Effect, EffectKind, FootEffect, JointEffect,
    MillingEffect, RobotEffect, SensorEffect, Target, Typed, WheelEffect,
};
use truecut_scenario::{FootSpec, ProcessSpec, Scenario, WheelHold, WheelPart};
use truecut_sim::misfit;

use self::joints::joint_scale;
pub(super) use self::targets::delays_drive_forces;
use self::targets::{is_inverse, targets, why_untold};
use super::signals::Signals;
use crate::model::Candidate;

/// Part of a signal that a typical effect changes.
pub(super) const SHARE: f64 = 0.1;

/// Effects that may be looked for.
pub(super) struct Known {
    /// Every effect that applies to the scenario, would tell and is not in it already.
    pub absent: Vec<Candidate>,
    /// Those that are in it already.
    pub held: Vec<Candidate>,
    /// A sentence on those that apply and would not tell.
    pub untold: Vec<String>,
}

/// Every effect that applies to the scenario.
pub(super) fn candidates(
    scenario: &Scenario,
    signals: &Signals,
    channels: &[ChannelSpec],
) -> Known {
    let (mut absent, mut held) = (Vec::new(), Vec::new());
    let mut untold: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for kind in EffectKind::ALL
        .iter()
        .copied()
        .filter(|kind| !kind.is_curve())
    {
        for target in targets(kind, scenario, signals, channels) {
            let effect = Effect::neutral(kind, target);
            let known = |own: &Effect| own.kind == kind && own.target == effect.target;
            if misfit(scenario, &effect).is_some() {
                continue;
            }
            let is_held = scenario.effects.iter().any(known);
            match scale(scenario, signals, &effect) {
                None if is_held => {}
                None => {
                    let of_the_reason = untold.entry(why_untold(kind)).or_default();
                    of_the_reason.push(effect.to_string());
                }
                Some(scale) => {
                    let candidate = Candidate {
                        kind,
                        rotary: match effect.target {
                            Target::Joint(joint) => signals.joints[joint].rotary,
                            Target::Whole | Target::Axis(_) | Target::Channel(_) => false,
                        },
                        target: effect.target,
                        scale,
                    };
                    match is_held {
                        true => held.push(candidate),
                        false => absent.push(candidate),
                    }
                }
            }
        }
    }
    let told = |(why, effects): (&str, Vec<String>)| {
        format!("not looked for, since {why}: {}", effects.join(", "))
    };
    Known {
        absent,
        held,
        untold: untold.into_iter().map(told).collect(),
    }
}

/// A typical distance from neutral for each parameter; `None` if the effect cannot show. Each
/// family's are written as an effect of that size.
fn scale(scenario: &Scenario, signals: &Signals, effect: &Effect) -> Option<Vec<f64>> {
    let parts = scenario.process.facts().parts;
    let scale = match effect.typed()? {
        // No candidates of the search: see `curves`.
        Typed::Curve(..) => return None,
        // Commanded motion bends springs by little of what a link weighs more: by runs one was
        // named on one of twelve clean drawn arms (seed 9800012).
        Typed::Joint(
            _,
            JointEffect::LinkMass { .. }
            | JointEffect::LinkCenter { .. }
            | JointEffect::Rotor { .. },
        ) if !is_inverse(scenario) => return None,
        Typed::Joint(_, JointEffect::LinkLength { .. })
            if !is_inverse(scenario) && !signals.shows_places(scenario) =>
        {
            return None;
        }
        Typed::Joint(joint, effect) => joint_scale(&signals.joints[joint], effect)?.values(),
        Typed::Robot(effect) => robot_scale(signals, effect).values(),
        Typed::Base(_, effect) => base_scale(signals, effect).values(),
        Typed::Cutting(effect) => cutting_scale(&cut(scenario, signals)?, effect)?.values(),
        Typed::Milling(effect) => milling_scale(scenario, effect)?.values(),
        Typed::Foot(effect) => {
            foot_scale(parts.foot.as_ref()?, effect, signals.duration_s).values()
        }
        Typed::Wheel(effect) => wheel_scale(&parts.wheel?, effect)?.values(),
        Typed::Clock(effect) => clock_scale(signals, effect)?.values(),
        Typed::Sensor(channel, effect) => {
            let spread = signals.outputs.iter().find(|(name, _)| name == channel)?.1;
            sensor_scale(signals, effect, spread).values()
        }
    };
    (scale.iter().all(|s| s.is_finite() && *s > 0.0)).then_some(scale)
}

fn robot_scale(signals: &Signals, effect: RobotEffect) -> RobotEffect {
    match effect {
        RobotEffect::Payload { .. } => RobotEffect::Payload {
            mass_kg: 0.05 * signals.moving_mass_kg,
            center_x_m: 0.1,
            center_y_m: 0.1,
            center_z_m: 0.1,
        },
    }
}

fn base_scale(signals: &Signals, effect: BaseEffect) -> BaseEffect {
    let stiffnesses = signals.joints.iter().filter_map(|joint| joint.stiffness);
    let stiffest = stiffnesses.fold(f64::NAN, f64::max);
    match effect {
        BaseEffect::Compliance { .. } => BaseEffect::Compliance {
            compliance_rad_per_n_m: SHARE / stiffest,
        },
        BaseEffect::Tilt { .. } => BaseEffect::Tilt {
            angle_rad: SHARE * SHARE,
        },
    }
}

/// What effects on a cut are measured by.
struct Cut {
    depth_m: f64,
    /// Of a chamfer; none of a steady machine.
    chamfer: Option<ChamferCut>,
}

struct ChamferCut {
    edges: usize,
    tooth_feed_m: f64,
    /// A tenth of the cutting force per edge length at full chip, N/m.
    line_n_per_m: f64,
    turns: f64,
    path_m: f64,
}

fn cut(scenario: &Scenario, signals: &Signals) -> Option<Cut> {
    if let ProcessSpec::Replay(replay) = &scenario.process {
        return Some(Cut {
            depth_m: replay.turning?.depth_m,
            chamfer: None,
        });
    }
    let ProcessSpec::Chamfer(chamfer) = &scenario.process else {
        return None;
    };
    let tooth_feed_m = chamfer.schedule.feed_per_tooth_m();
    let turns = chamfer.schedule.spindle_rad_s * signals.duration_s;
    Some(Cut {
        depth_m: chamfer.schedule.depth_m,
        chamfer: Some(ChamferCut {
            edges: chamfer.schedule.edges,
            tooth_feed_m,
            line_n_per_m: SHARE * chamfer.coefficients.in_plane_pa() * tooth_feed_m,
            turns,
            path_m: turns * chamfer.hole_radius_m,
        }),
    })
}

fn cutting_scale(cut: &Cut, effect: CuttingEffect) -> Option<CuttingEffect> {
    use CuttingEffect as E;
    let chamfer = cut.chamfer.as_ref();
    Some(match effect {
        E::Coefficient { .. } => E::Coefficient { factor: SHARE },
        E::EdgeForce { .. } => {
            let line = chamfer?.line_n_per_m;
            E::EdgeForce {
                axial_n_per_m: line,
                radial_n_per_m: line,
                tangential_n_per_m: line,
            }
        }
        E::Runout { .. } => {
            let offset = match chamfer {
                Some(chamfer) => between_edges(chamfer)?,
                None => 0.01 * cut.depth_m,
            };
            E::Runout {
                cosine_m: offset,
                sine_m: offset,
            }
        }
        // The hole's offset varies the depth around the rim.
        E::HoleOffset { .. } => E::HoleOffset {
            y_m: 0.5 * SHARE * cut.depth_m,
            z_m: 0.5 * SHARE * cut.depth_m,
        },
        E::WornTooth { .. } => E::WornTooth {
            recess_m: between_edges(chamfer?)?,
        },
        E::Wear { .. } => E::Wear {
            growth_per_m: 2.0 * SHARE / chamfer?.path_m,
        },
        E::DepthOffset { .. } => E::DepthOffset {
            depth_m: 2.0 * SHARE * cut.depth_m,
        },
        E::SpindleSpeed { .. } => E::SpindleSpeed {
            factor: (0.3 / chamfer?.turns).min(SHARE),
        },
    })
}

fn milling_scale(scenario: &Scenario, effect: MillingEffect) -> Option<MillingEffect> {
    let ProcessSpec::Milling(milling) = &scenario.process else {
        return None;
    };
    let cut = &milling.cut;
    Some(match effect {
        // As much as a tenth of the chip's stiffness at the tooth-passing frequency.
        MillingEffect::ProcessDamping { .. } => MillingEffect::ProcessDamping {
            per_slope_n_per_m: SHARE * cut.coefficients.tangential_pa * cut.cutter.radius_m
                / cut.cutter.teeth as f64,
        },
        MillingEffect::ToolMode { .. } => MillingEffect::ToolMode {
            compliance_m_per_n: SHARE * cut.feed_per_tooth_m / cut.average_force_n().norm(),
            frequency_hz: 50.0,
            damping_ratio: 0.02,
        },
    })
}

/// A single edge cannot differ from the others: its recess or runout is a depth offset.
fn between_edges(chamfer: &ChamferCut) -> Option<f64> {
    (chamfer.edges > 1).then_some(2.0 * SHARE * chamfer.tooth_feed_m)
}

fn foot_scale(foot: &FootSpec, effect: FootEffect, duration_s: f64) -> FootEffect {
    use FootEffect as E;
    match effect {
        E::Friction { .. } => E::Friction { factor: SHARE },
        E::FrictionFalling { .. } => E::FrictionFalling {
            drop: 2.0 * SHARE,
            speed_m_per_s: 1e-3,
        },
        E::PressureLoss { .. } => E::PressureLoss {
            rate_per_s: SHARE / duration_s,
        },
        E::SealStiction { .. } => E::SealStiction {
            force_n: SHARE * foot.cylinders.preload_n(),
        },
    }
}

/// `n P F²/2k_t` of a tenth of the grains of a soft wheel (16 per mm², 40 mN, 200 N/m), 6 N/m,
/// beside some 300 N/m along an edge.
const TYPICAL_JAMMING: f64 = 0.02;

fn wheel_scale(wheel: &WheelPart, effect: WheelEffect) -> Option<WheelEffect> {
    use WheelEffect as E;
    let held_n = match wheel.hold {
        WheelHold::Force(force_n) => Some(force_n),
        WheelHold::Path | WheelHold::Position => None,
    };
    Some(match effect {
        E::Stiffness { .. } => E::Stiffness { factor: SHARE },
        E::Friction { .. } => E::Friction { factor: SHARE },
        E::Removal { .. } => (wheel.shows_removal).then_some(E::Removal { factor: SHARE })?,
        // One that does not turn is a deeper path.
        E::Eccentricity { .. } => wheel.turns.then_some(E::Eccentricity {
            cosine_m: SHARE * wheel.indentation_m,
            sine_m: SHARE * wheel.indentation_m,
        })?,
        E::EdgeGrains { .. } => wheel.over_edges.then_some(E::EdgeGrains {
            share: TYPICAL_JAMMING,
        })?,
        E::ForceOffset { .. } => E::ForceOffset {
            force_n: SHARE * held_n?,
        },
        E::ForceStiction { .. } => E::ForceStiction {
            force_n: SHARE * held_n?,
        },
    })
}

fn clock_scale(signals: &Signals, effect: ClockEffect) -> Option<ClockEffect> {
    let several = signals.outputs.len() > 1;
    several.then_some(match effect {
        ClockEffect::Delay { .. } => ClockEffect::Delay {
            delay_s: signals.interval_s,
        },
        ClockEffect::Rate { .. } => ClockEffect::Rate {
            factor: SHARE * SHARE,
        },
    })
}

fn sensor_scale(signals: &Signals, effect: SensorEffect, spread: f64) -> SensorEffect {
    use SensorEffect as E;
    match effect {
        E::Delay { .. } => E::Delay {
            delay_s: signals.interval_s,
        },
        E::LowPass { .. } => E::LowPass {
            time_constant_s: signals.interval_s,
        },
        E::Gain { .. } => E::Gain { factor: SHARE },
        E::Offset { .. } => E::Offset {
            offset: SHARE * spread,
        },
        E::Drift { .. } => E::Drift {
            amplitude: SHARE * spread,
            time_constant_s: 0.3 * signals.duration_s,
        },
    }
}

/// Numbers of the candidates of such kinds.
pub(crate) fn of_kinds(
    candidates: &[Candidate],
    is_such: impl Fn(EffectKind) -> bool,
) -> Vec<usize> {
    let all = 0..candidates.len();
    all.filter(|&i| is_such(candidates[i].kind)).collect()
}
