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

/// Whether what changes over time leaves less than a curve does where both are: no law of a place
/// or a speed is told for it.
pub(super) fn is_better(problem: &Problem, bound: &Bound, last: &Fit, with_curve: &Fit) -> bool {
    let rows = &problem.split.development;
    let left = rms(&bound.left, rows);
    let [without, with] = [last, with_curve].map(|fit| rms(&fit.residual, rows));
    let specs = problem.model.channels().iter().enumerate();
    let mut changed =
        specs.filter(|(_, spec)| bound.changes.iter().any(|one| one.channel == spec.name));
    changed.any(|(c, _)| left[c] < with[c] && with[c] != without[c])
}

/// Channels whose changes the reason tells at most; a load that is let go is in all of them.
const MOST_TOLD: usize = 3;

/// The finding, before whatever else the reason says: of each channel one, with its moment if it
/// has one.
pub(super) fn tell(changes: Vec<Change>, diagnosis: &mut Diagnosis) {
    diagnosis.changes = changes;
    if diagnosis.changes.is_empty() || diagnosis.verdict == Verdict::FitFailed {
        return;
    }
    let mut found: Vec<&Change> = diagnosis.changes.iter().collect();
    found.sort_by_key(|change| change.from_s.is_none());
    let mut told: Vec<&Change> = Vec::new();
    for change in &found {
        let is_new = told.iter().all(|one| one.channel != change.channel);
        if is_new && told.len() < MOST_TOLD {
            told.push(change);
        }
    }
    let others = match found.len() - told.len() {
        0 => String::new(),
        count => format!("; and {count} more"),
    };
    let told: Vec<String> = told.into_iter().map(course).collect();
    diagnosis.reason = format!(
        "Something changes over time: {}{others}. {}",
        told.join("; "),
        diagnosis.reason
    );
}

/// In which channel, when, and the law that does most like it.
fn course(change: &Change) -> String {
    let Change { channel, what, .. } = change;
    match (change.from_s, what.as_str()) {
        (Some(from_s), _) => {
            let when = significant(from_s, 3);
            format!(
                "`{channel}` is another from about {when} s on, most as if {what} had changed then"
            )
        }
        (None, TIME) => format!("`{channel}` drifts all along"),
        (None, _) => format!("`{channel}` changes all along, most as if {what} did"),
    }
}
