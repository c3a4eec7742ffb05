//! What kinds act on, and why some would not tell.

use truecut_recording::ChannelSpec;
use truecut_scenario::effect::{EffectKind, Target, TargetKind};
use truecut_scenario::{ProcessSpec, ReplayMode, Scenario};

use crate::trial::signals::Signals;

/// Whether it is a delay of drive forces that are measured. It is looked for beside other causes
/// alone: by itself a search took it for all that is of friction's shape.
pub(in crate::trial) fn delays_drive_forces(scenario: &Scenario, kind: EffectKind) -> bool {
    let late = matches!(kind, EffectKind::ClockDelay | EffectKind::SensorDelay);
    late && is_inverse(scenario)
}

/// Whether drive forces are predicted from measured motion.
pub(in crate::trial) fn is_inverse(scenario: &Scenario) -> bool {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        return false;
    };
    matches!(replay.mode, ReplayMode::Inverse { .. })
}

pub(super) fn why_untold(kind: EffectKind) -> &'static str {
    match kind.name() {
        "joint_load_friction" => "under so even a load it is dry friction",
        "joint_counterbalance" => {
            "where the joint turns so little a balancing spring is an offset and a stiffness"
        }
        "joint_ripple" => "the joint turns too little for a ripple",
        "cutting_runout" | "cutting_worn_tooth" => "with a single edge it is a depth offset",
        "wheel_eccentricity" => "the wheel does not turn",
        "clock_delay" => "with one channel it is a delay of its sensor",
        "link_mass" | "link_center" | "joint_rotor" => {
            "only measured motion of all joints shows one link beside the others"
        }
        "link_length" => "neither places of the tool nor measured motion of all joints show it",
        "clock_rate" => "with one channel it is hardly anything but a gain",
        "wheel_removal" => "what is removed is not measured",
        _ => "nothing in the nominal run gives it a size",
    }
}

pub(super) fn targets(
    kind: EffectKind,
    scenario: &Scenario,
    signals: &Signals,
    channels: &[ChannelSpec],
) -> Vec<Target> {
    match kind.target() {
        TargetKind::Whole => vec![Target::Whole],
        // What the last link carries has no drive that would feel it.
        TargetKind::Joint if kind == EffectKind::LinkLength && !signals.shows_places(scenario) => {
            let others = signals.joints.len().saturating_sub(1);
            (0..others).map(Target::Joint).collect()
        }
        TargetKind::Joint => (0..signals.joints.len()).map(Target::Joint).collect(),
        TargetKind::Axis => (0..3).map(Target::Axis).collect(),
        TargetKind::Channel => (channels.iter())
            .map(|spec| Target::Channel(spec.name.clone()))
            .collect(),
    }
}
