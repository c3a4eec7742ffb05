//! The postures of one that differ by whole turns of joints.

use std::f64::consts::TAU;

use crate::model::{Joint, JointKind};

/// Turns of a joint to either side that are looked at, if that makes no more postures of one than
/// [`MOST_PLACES`].
const MOST_TURNS: i64 = 12;
const MOST_PLACES: f64 = 1024.0;

/// The posture with every joint turned to every place within its limits; to fewer about its least
/// turn, at least to one, where there would be too many: limits of hundreds of turns are degrees.
pub(crate) fn turned(joints: &[Joint], q: &[f64]) -> Vec<Vec<f64>> {
    let mut most = MOST_TURNS;
    let places = loop {
        let places: Vec<Vec<f64>> = (joints.iter().zip(q))
            .map(|(joint, &value)| places(joint, value, most))
            .collect();
        let count: f64 = places.iter().map(|places| places.len() as f64).product();
        if count <= MOST_PLACES || most == 0 {
            break places;
        }
        most -= 1;
    };
    let mut postures = vec![Vec::new()];
    for places in places {
        postures = postures
            .iter()
            .flat_map(|posture: &Vec<f64>| {
                places.iter().map(|place| {
                    let mut longer = posture.clone();
                    longer.push(*place);
                    longer
                })
            })
            .collect();
    }
    postures
}

/// Where a joint is within its limits, at most so many turns to either side of the one that is
/// nearest to `value`.
fn places(joint: &Joint, value: f64, most_turns: i64) -> Vec<f64> {
    let (low, high) = joint
        .limits
        .map_or((f64::NEG_INFINITY, f64::INFINITY), |l| (l.lower, l.upper));
    let turns = if joint.kind == JointKind::Prismatic || !(high - low).is_finite() {
        0..=0
    } else {
        let first = ((low - value) / TAU).ceil() as i64;
        let last = ((high - value) / TAU).floor() as i64;
        let least = 0_i64.max(first).min(last);
        first.max(least.saturating_sub(most_turns))..=last.min(least.saturating_add(most_turns))
    };
    turns
        .map(|turn| value + TAU * turn as f64)
        .filter(|value| (low..=high).contains(value))
        .collect()
}
