//! Limits of joints and angles of frames in another unit.

use std::f64::consts::{PI, TAU};

use super::FEWEST_JOINTS;
use crate::model::{Chain, Joint, JointKind};

/// Most turns to either side of a joint that an industrial arm has: cables do not bear more, and a
/// wrist without end has no limits. A quarter of a turn in degrees would be 14 turns in radians.
const MOST_TURNS: f64 = 12.0;
/// Larger limits stand for none.
const NO_LIMIT_RAD: f64 = 1000.0;
/// Wrists that turn as often as their controller counts have a whole number of turns as their
/// limit (59 to 288 of them), within rounding; one in degrees is such by a chance of 1 in 500.
const WHOLE_TURN: f64 = 1e-3;
/// The quickest joints that there are, last ones of small SCARA arms, turn at 52 rad/s
/// (3000 deg/s); an arm's slowest at 60 deg/s, unless it carries a ton.
const MOST_RAD_PER_S: f64 = 60.0;
/// Larger speeds stand for none.
const NO_LIMIT_RAD_PER_S: f64 = 5000.0;
/// Joints that are named.
const NAMED: usize = 6;
/// Angles by which frames are turned, as parts of a half turn. Of two decimals only the first two
/// are looked for, of fewer none: any small angle is near one of them.
const ROUND: [f64; 9] = [
    1.0,
    1.0 / 2.0,
    3.0 / 2.0,
    2.0,
    1.0 / 4.0,
    3.0 / 4.0,
    1.0 / 3.0,
    2.0 / 3.0,
    1.0 / 6.0,
];
/// Of angles that are written with all digits of a number, rad.
const ROUNDING: f64 = 1e-9;

/// Limits in degrees. Each joint is looked at by itself: a file may have been mended in part.
pub(super) fn of_limits(chain: &Chain) -> Option<String> {
    let most = |joint: &Joint| {
        let limits = joint.limits.filter(|_| joint.kind == JointKind::Revolute)?;
        let furthest = [limits.lower, limits.upper].map(f64::abs);
        let furthest = furthest.into_iter().filter(|it| it.is_finite());
        furthest.reduce(f64::max)
    };
    let limited: Vec<(&Joint, f64)> = (chain.joints.iter())
        .filter_map(|joint| Some((joint, most(joint)?)))
        .collect();
    let counts_turns = |limit: f64| (limit / TAU - (limit / TAU).round()).abs() < WHOLE_TURN;
    let far = |(_, limit): &&(&Joint, f64)| {
        (MOST_TURNS * TAU..NO_LIMIT_RAD).contains(limit) && !counts_turns(*limit)
    };
    let doubtful: Vec<_> = limited.iter().filter(far).collect();
    (!doubtful.is_empty()).then(|| {
        format!(
            "{} of {} joints with limits may turn by more than {MOST_TURNS} times, {}: angles of a robot's file \
             are radians, and these look like degrees",
            doubtful.len(),
            limited.len(),
            named(&doubtful, "as far as", "rad")
        )
    })
}

/// Speeds in degrees a second. What turns without end may be a spindle.
pub(super) fn of_speeds(chain: &Chain) -> Option<String> {
    let speed = |joint: &Joint| {
        let limits = joint.limits.filter(|_| joint.kind == JointKind::Revolute)?;
        let has_ends = limits.lower.is_finite() && limits.upper.is_finite();
        (has_ends && limits.velocity.is_finite()).then_some(limits.velocity)
    };
    let limited: Vec<(&Joint, f64)> = (chain.joints.iter())
        .filter_map(|joint| Some((joint, speed(joint)?)))
        .collect();
    let quick = |(_, speed): &&(&Joint, f64)| (MOST_RAD_PER_S..NO_LIMIT_RAD_PER_S).contains(speed);
    let doubtful: Vec<_> = limited.iter().filter(quick).collect();
    (!doubtful.is_empty()).then(|| {
        format!(
            "{} of {} joints with a speed limit may turn faster than {MOST_RAD_PER_S} rad/s ({:.0} deg/s), {}: \
             speeds of a robot's file are rad/s, and these look like deg/s",
            doubtful.len(),
            limited.len(),
            MOST_RAD_PER_S.to_degrees(),
            named(&doubtful, "at up to", "rad/s")
        )
    })
}

/// `the joint "a1" as far as 178 rad, "a5" 120 rad`.
fn named(doubtful: &[&(&Joint, f64)], how_far: &str, unit: &str) -> String {
    let each = doubtful.iter().take(NAMED).enumerate();
    let each = each.map(|(index, (joint, value))| match index {
        0 => format!("the joint \"{}\" {how_far} {value} {unit}", joint.name),
        _ => format!("\"{}\" {value} {unit}", joint.name),
    });
    let more = doubtful.len().saturating_sub(NAMED);
    let more = (more > 0).then(|| format!("{more} more"));
    let all: Vec<String> = each.chain(more).collect();
    all.join(", ")
}

/// That some joints of an arm have no speed limit and others do: a slip, where a file without any
/// says nothing of speeds at all.
pub(super) fn of_missing_speeds(chain: &Chain) -> Option<String> {
    let has_some = chain.joints.iter().any(has_speed);
    (has_some && chain.joints.len() >= FEWEST_JOINTS)
        .then(|| unknown_speeds(chain))
        .flatten()
}

/// Which joints have no speed limit, so that none is too fast.
pub(crate) fn unknown_speeds(chain: &Chain) -> Option<String> {
    let unknown = chain.joints.iter().filter(|joint| !has_speed(joint));
    let names: Vec<&str> = unknown.map(|joint| joint.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "no speed limit is known of {}: speeds of these joints are not checked (0 in a URDF counts as not given)",
            names.join(", ")
        )
    })
}

fn has_speed(joint: &Joint) -> bool {
    joint
        .limits
        .is_some_and(|limits| limits.velocity.is_finite())
}

/// Angles in radians where degrees are asked for: one is a round part of π to the digits that are
/// given, and none is beyond a whole turn in radians, as measured angles of frames mostly are.
pub(crate) fn of_frame_angles(frame: &str, rpy_deg: [f64; 3]) -> Option<String> {
    let angle = rpy_deg.into_iter().find(|angle| is_round(*angle))?;
    let are_small = rpy_deg.iter().all(|angle| angle.abs() <= TAU + 1e-2);
    are_small.then(|| {
        format!(
            "frames.{frame} has rpy_deg = {rpy_deg:?}, in degrees, of which {angle} is {:.0} deg in radians to its \
             digits: was {:.0} meant?",
            angle.to_degrees(),
            angle.to_degrees()
        )
    })
}

/// Whether an angle is a round part of π to the decimals that it has, rounded or cut off.
fn is_round(angle: f64) -> bool {
    let text = angle.abs().to_string();
    let decimals = text.split_once('.').map_or(0, |(_, behind)| behind.len());
    let parts = match decimals {
        0 | 1 => &ROUND[..0],
        2 => &ROUND[..2],
        _ => &ROUND[..],
    };
    let digit = 10.0_f64.powi(-(decimals as i32)).max(ROUNDING);
    let mut candidates = parts.iter().map(|part| part * PI);
    candidates.any(|candidate| (candidate - angle.abs()).abs() < digit)
}
