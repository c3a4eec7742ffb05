//! What is measured changes over time: in the verdict, and in what is known of the noise.

use truecut_recording::significant;

use crate::diagnose::answer::{Change, Diagnosis, Verdict};
use crate::diagnose::ceiling::Bound;
use crate::diagnose::features::TIME;
use crate::diagnose::fit::Fit;
use crate::diagnose::floor::{Floor, NoiseSource};
use crate::diagnose::problem::Problem;
use crate::diagnose::validate::rms;
use crate::model::Columns;
use crate::stats::ratio;

/// The floors that hold: where a channel follows time itself, differences between periods are no
/// noise, and what they say of it is not known.
pub(super) fn holding(known: &[Option<Floor>], bound: &Bound) -> Vec<Option<Floor>> {
    let channels = known.iter().zip(&bound.in_time);
    let holds = |(floor, in_time): (&Option<Floor>, &bool)| {
        let floor = floor.as_ref();
        floor
            .filter(|floor| !in_time || floor.source != NoiseSource::Repetition)
            .cloned()
    };
    channels.map(holds).collect()
}

/// Takes changes of channels away in which they are no larger than what causes may leave: there a
/// law that is not quite a named one's, or a filter of the sensor, passes for a change as well. The
/// part of the discrepancy that changes, by its size, in the channel where it is most: an
/// autoregression follows what changes slowly, so that whitened it is next to nothing.
pub(super) fn keep_large(
    problem: &Problem,
    before: &Columns,
    last: &Fit,
    bound: &mut Bound,
) -> f64 {
    let rows = &problem.split.development;
    let nominal = rms(&problem.data.residual(before), rows);
    let [with, without] = [&last.residual, &bound.left].map(|residual| rms(residual, rows));
    let parts: Vec<f64> = (0..nominal.len())
        .map(|c| {
            let square = (with[c].powi(2) - without[c].powi(2)).max(0.0);
            ratio(square.sqrt(), nominal[c].max(with[c]))
        })
        .collect();
    let of = |change: &Change| {
        let mut specs = problem.model.channels().iter();
        specs.position(|spec| spec.name == change.channel)
    };
    let part = |change: &Change| of(change).map_or(0.0, |c| parts[c]);
    (bound.changes).retain(|change| part(change) > problem.options.unknown_above);
    bound.changes.iter().map(part).fold(0.0, f64::max)
}

/// Whether what changes over time leaves less than a curve does in the channels that either
/// reaches, its numbers paid for by Schwarz's criterion: no law of a place or a speed is told for
/// it. What more numbers take of the noise is no merit.
pub(super) fn is_better(problem: &Problem, bound: &Bound, last: &Fit, with_curve: &Fit) -> bool {
    let rows = &problem.split.development;
    let left = rms(&bound.left, rows);
    let [without, with] = [last, with_curve].map(|fit| rms(&fit.residual, rows));
    let specs = problem.model.channels().iter();
    let changed: Vec<bool> = specs
        .map(|spec| bound.changes.iter().any(|one| one.channel == spec.name))
        .collect();
    let merit = |c: usize| {
        let n = rows.per_channel[c].len() as f64;
        2.0 * n * (with[c] / left[c]).ln() - bound.numbers[c] as f64 * n.ln()
    };
    let reached = (0..changed.len()).filter(|&c| changed[c] || with[c] != without[c]);
    let by_curve = (0..changed.len()).any(|c| changed[c] && with[c] != without[c]);
    by_curve && reached.map(merit).sum::<f64>() > 0.0
}

/// Changes that the reason tells at most.
const MOST_TOLD: usize = 3;
/// Moments that are no further apart than this part of the later are one: a brake that sets in is
/// seen in several channels.
const SAME_MOMENT: f64 = 0.03;

/// The finding, before whatever else the reason says.
pub(super) fn tell(changes: Vec<Change>, diagnosis: &mut Diagnosis) {
    diagnosis.changes = changes;
    if diagnosis.changes.is_empty() || diagnosis.verdict == Verdict::FitFailed {
        return;
    }
    diagnosis.reason = format!(
        "Something changes over time: {}. {}",
        courses(&diagnosis.changes),
        diagnosis.reason
    );
}

/// Changes in words: what happens at one moment once, with all channels that show it, and of each
/// channel one, with its moment if it has one.
pub(crate) fn courses(changes: &[Change]) -> String {
    let events = events(changes);
    let others = match events.len().saturating_sub(MOST_TOLD) {
        0 => String::new(),
        count => format!("; and {count} more"),
    };
    let told = events.iter().take(MOST_TOLD).map(|event| course(event));
    told.collect::<Vec<_>>().join("; ") + &others
}

/// Changes by their moment, those that have one first; a channel once.
fn events(changes: &[Change]) -> Vec<Vec<&Change>> {
    let mut found: Vec<&Change> = changes.iter().collect();
    found.sort_by_key(|change| change.from_s.is_none());
    let mut events: Vec<Vec<&Change>> = Vec::new();
    for change in found {
        if events
            .iter()
            .flatten()
            .any(|one| one.channel == change.channel)
        {
            continue;
        }
        let is_same = |event: &&mut Vec<&Change>| match (event[0].from_s, change.from_s) {
            (Some(a), Some(b)) => (a - b).abs() <= SAME_MOMENT * a.max(b),
            (None, None) => event[0].what == change.what,
            _ => false,
        };
        match events.iter_mut().find(is_same) {
            Some(event) => event.push(change),
            None => events.push(vec![change]),
        }
    }
    events
}

/// In which channels, when, and the law that does most like it in the first of them.
fn course(event: &[&Change]) -> String {
    let Change { what, .. } = event[0];
    let channels: Vec<String> = event
        .iter()
        .map(|one| format!("`{}`", one.channel))
        .collect();
    let channels = match channels.split_last() {
        Some((last, others)) if !others.is_empty() => {
            format!("{} and {last}", others.join(", "))
        }
        _ => channels.concat(),
    };
    let is_one = event.len() == 1;
    match (event[0].from_s, what.as_str()) {
        (Some(from_s), _) => {
            let when = significant(from_s, 3);
            let are = if is_one { "is another" } else { "are others" };
            match event[0].until_s.map(|until_s| significant(until_s, 3)) {
                None => format!(
                    "{channels} {are} from about {when} s on, most as if {what} had changed then"
                ),
                Some(until) => format!(
                    "{channels} {are} from about {when} s until about {until} s, most as if {what} was another there"
                ),
            }
        }
        (None, TIME) => format!(
            "{channels} drift{} all along",
            if is_one { "s" } else { "" }
        ),
        (None, _) => format!(
            "{channels} change{} all along, most as if {what} did",
            if is_one { "s" } else { "" }
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(channel: &str, from_s: Option<f64>, what: &str) -> Change {
        Change {
            channel: channel.into(),
            from_s,
            until_s: None,
            what: what.into(),
        }
    }

    /// A brake is seen in the channels of several joints at about the same time: it is told once.
    #[test]
    fn what_happens_at_one_moment_is_told_once() {
        let mut diagnosis = Diagnosis {
            verdict: Verdict::UnknownCause,
            reason: "The rest.".into(),
            ..Diagnosis::default()
        };
        let changes = vec![
            change("joint3.drive_torque", Some(18.9), "joint_coulomb of joint3"),
            change("joint2.drive_torque", Some(19.1), "payload"),
            change("joint3.drive_torque", None, "time"),
            change("joint4.drive_torque", Some(18.8), "joint_offset of joint4"),
            change(
                "joint1.drive_torque",
                Some(31.0),
                "sensor_gain of joint1.drive_torque",
            ),
            change("joint5.drive_torque", None, "time"),
        ];
        tell(changes, &mut diagnosis);
        assert_eq!(
            diagnosis.reason,
            "Something changes over time: `joint3.drive_torque`, `joint2.drive_torque` and `joint4.drive_torque` are others \
             from about 18.9 s on, most as if joint_coulomb of joint3 had changed then; `joint1.drive_torque` is another from \
             about 31.0 s on, most as if sensor_gain of joint1.drive_torque had changed then; `joint5.drive_torque` drifts all \
             along. The rest."
        );
    }
}
