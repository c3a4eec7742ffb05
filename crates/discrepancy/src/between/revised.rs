//! Verdicts of the search that are taken back: in another set-up, where no more is left than one
//! recording leaves, after another motion.

use truecut_scenario::effect::Effect;

use super::Between;
use super::answer::{Answer, Changed, Changes, Verdict};
use super::change::Change;
use super::told::changed_of;
use super::work::Work;
use crate::diagnose::{self, Ceiling, ChannelErrors, DiagnoseError, Diagnosis, Nominal};
use crate::model::Columns;

/// What was found, as it is told in the end.
pub(super) struct Now {
    /// Numbers that were refitted, with their intervals.
    pub numbers: Vec<Nominal>,
    /// As the model has them.
    pub nominal: Vec<f64>,
    /// Changes.
    pub effects: Vec<Effect>,
    /// What is predicted with them.
    pub changed: Columns,
}

/// In a set-up that is not the machine's a change has no name; that nothing changed stays true.
pub(super) fn doubted(told: &str, answer: &mut Answer) {
    let found = &mut answer.changes;
    let names = [Verdict::Changed, Verdict::Ambiguous, Verdict::UnknownChange];
    if !names.contains(&found.verdict) {
        found.doubts.push(told.to_owned());
        return;
    }
    found.verdict = Verdict::UnknownChange;
    found.reason = format!("{told} {}", found.reason);
    found.changes.clear();
    found.alternatives.clear();
    found.further.clear();
    found.runner_up = None;
    found.curve = None;
    answer.after.clone_from(&answer.before);
    answer.changed.clone_from(&answer.unchanged);
}

/// Where nothing says that something changed but the size of what is left, beside a noise that is
/// known: it has to be more than both recordings leave of themselves, as large as the first does.
pub(super) fn no_more_than_of_one(first: &Diagnosis, found: &mut Changes) {
    let signals = &found.ceiling.correlated_signals;
    if found.curve.is_some() || !signals.is_empty() {
        return;
    }
    // Noise alone is no more than of one, however little of it the first had by chance.
    let is_more = (found.channels.iter()).any(|(name, errors)| {
        let own = first.channels.get(name).map_or(0.0, |own| own.after);
        let both = 2.0 * own.powi(2);
        errors.after.powi(2) > EXCESS * both.max(errors.noise_floor.powi(2))
    });
    if is_more {
        return;
    }
    let (verdict, what) = match found.changes.is_empty() {
        true => (Verdict::NothingChanged, "Nothing changed that can be seen"),
        false => (Verdict::Changed, "The changes named explain what differs"),
    };
    found.verdict = verdict;
    found.reason = format!(
        "{what}: more is left than the noise as it is known, but no more than the model leaves of two recordings like the \
         first."
    );
}

/// Ratio of variances that noise of a hundred independent samples does not reach.
const EXCESS: f64 = 1.5;

/// Whether the second recording has clearly more that is left than the first has.
fn grows(pair: &Between, predicted: &Columns) -> bool {
    let rows = pair.first.observation.time_s.len();
    let outputs = pair.observation.outputs.iter().zip(predicted);
    outputs
        .map(|(output, predicted)| -> Vec<Option<f64>> {
            let rows = output.values.iter().zip(&output.valid).zip(predicted);
            rows.map(|((y, valid), p)| valid.then(|| y - p)).collect()
        })
        .any(|left| {
            let own =
                |rows: &[Option<f64>]| -> Vec<f64> { rows.iter().copied().flatten().collect() };
            diagnose::breaks_away_from(&own(&left[..rows]), &own(&left[rows..]))
        })
}

/// After another motion what has no name is not called a change: the first recording may not show
/// it. What is told is then the model without it, fitted anew.
pub(super) fn after_another_motion(
    pair: &Between,
    model: &Change,
    work: &mut Work,
    found: &mut Changes,
    now: &mut Now,
) -> Result<(), DiagnoseError> {
    let had = now.effects.len();
    now.effects.retain(|effect| !effect.kind.is_curve());
    let mut fitted = None;
    if now.effects.len() < had {
        let of_names = work.refitted(model, &pair.observation, &now.nominal, &now.effects)?;
        now.changed.clone_from(&of_names.predicted);
        fitted = Some(of_names);
    }
    judge_after_another_motion(grows(pair, &now.changed), found);
    if found.changes.is_empty() && !now.effects.is_empty() {
        now.effects.clear();
        fitted = Some(work.refitted(model, &pair.observation, &now.nominal, &[])?);
    }
    let Some(fitted) = fitted else {
        return Ok(());
    };
    let (_, shared) = model.settled(&fitted.nominal);
    found.changes = changed_of(pair, model, &shared, &fitted.causes);
    for (name, errors) in &mut found.channels {
        errors.after = fitted.after.get(name).copied().unwrap_or(errors.after);
    }
    // What the residual of another model follows is not what is left of this one.
    found.ceiling = Ceiling::default();
    if fitted.effects.is_empty() {
        found.unexplained_fraction = 1.0;
        found.alternatives.clear();
        found.further.clear();
        found.runner_up = None;
        found.doubts.clear();
    }
    *now = Now {
        numbers: fitted.numbers,
        nominal: fitted.nominal,
        effects: fitted.effects,
        changed: fitted.predicted,
    };
    Ok(())
}

/// Changes that have a name stay where they explain what they are about.
fn judge_after_another_motion(grows: bool, found: &mut Changes) {
    found.curve = None;
    if !found.changes.is_empty() && are_explained(found) {
        found.verdict = Verdict::Changed;
        found.reason = "The changes named explain what the second recording has beyond the first; something that no \
                        effect known explains is left, which after another motion need not be a change."
            .to_owned();
        return;
    }
    if found.changes.is_empty() && !grows {
        found.verdict = Verdict::NothingChanged;
        found.reason = "Nothing changed that can be seen; both recordings have something in common that no effect \
                        known explains, and a change that is smaller than that would not be seen."
            .to_owned();
        return;
    }
    let name = |one: &Changed| match &one.target {
        Some(target) => format!("{} {target}", one.kind),
        None => one.kind.clone(),
    };
    found.undecided.extend(found.changes.iter().map(name));
    found.changes.clear();
    found.verdict = Verdict::Ambiguous;
    found.reason = "The second recording has something that no effect known explains; after another motion that need \
                    not be a change. Repeating the motion of the first would tell."
        .to_owned();
}

/// From this ratio of the variance left to that of the noise on, most of what is left is no noise.
const PREVAILS: f64 = 2.0;

/// Whether the changes explain, up to noise, the channel in which they explain most.
fn are_explained(found: &Changes) -> bool {
    let explained = |one: &ChannelErrors| {
        let noise = one.noise_floor.powi(2).max(f64::MIN_POSITIVE);
        (one.refitted.powi(2) - one.after.powi(2)) / noise
    };
    let most = (found.channels.values()).max_by(|a, b| explained(a).total_cmp(&explained(b)));
    most.is_some_and(|one| one.after.powi(2) < PREVAILS * one.noise_floor.powi(2))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::diagnose::NoiseSource;

    fn channels(after: [f64; 2]) -> BTreeMap<String, ChannelErrors> {
        let named = ["joint1.drive_torque", "joint2.drive_torque"].into_iter();
        let of = |(name, after): (&str, f64)| {
            let errors = ChannelErrors {
                before: 1.0,
                refitted: 1.0,
                after,
                noise_floor: 0.03,
                noise_source: NoiseSource::Stated,
                noise_without_memory: 0.0,
                unit: "N m".into(),
            };
            (name.to_owned(), errors)
        };
        named.zip(after).map(of).collect()
    }

    /// Where one channel is left as both recordings leave it, another one is not in the way of that
    /// in which the first had less noise than usual; one with more than noise is.
    #[test]
    fn noise_in_another_channel_is_no_more_than_of_one() {
        let first = Diagnosis {
            channels: channels([0.065, 0.014]),
            ..Diagnosis::default()
        };
        let changes = |left: f64| {
            let mut found = Changes {
                verdict: Verdict::UnknownChange,
                channels: channels([0.1, left]),
                ..Changes::default()
            };
            no_more_than_of_one(&first, &mut found);
            found.verdict
        };
        assert_eq!(changes(0.029), Verdict::NothingChanged);
        assert_eq!(changes(0.06), Verdict::UnknownChange);
    }
}
