//! From two recordings to what changed.

use std::time::Instant;

use super::answer::{
    Answer, Changed, ChangedParameter, Changes, Compared, Rival, VERSION, Verdict,
};
use super::change::Change;
use super::split::{both, twin};
use super::words::verdict;
use super::{Between, BetweenError, Motion, shared};
use crate::diagnose::{
    self, Alternative, Cause, ChannelErrors, DiagnoseError, Diagnosis, Options, Progress,
    check_units, clock_or_unit, explain,
};
use crate::model::{Columns, Model};
use crate::trial::Trial;
use truecut_scenario::effect::Effect;

/// Searches that are made anew, each with other effects that both recordings share.
const MOST_ANEW: usize = 3;

/// Looks for what changed from the first recording to the second.
///
/// # Errors
/// Data that do not fit the model or do not suffice; a nominal model that cannot be simulated.
pub fn changes(
    pair: &Between,
    options: &Options,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Answer, BetweenError> {
    let begun = Instant::now();
    let (first, second) = (&pair.first, &pair.second);
    let of_first = diagnose::diagnose(first, &first.observation, options, progress)
        .map_err(BetweenError::of(&first.observation.source))?;
    check_second(second).map_err(BetweenError::of(&second.observation.source))?;
    let mut answer = searched(pair, &of_first, options, progress)
        .map_err(BetweenError::of(&pair.observation.source))?;
    let found = &mut answer.changes;
    found.shared.clone_from(&of_first.diagnosis.causes);
    let unmoved = of_first.diagnosis.verdict == diagnose::Verdict::NotIdentifiable;
    if unmoved && found.verdict == Verdict::NothingChanged {
        found.verdict = Verdict::NotIdentifiable;
        found.reason = format!("{} {}", first.measured().source, of_first.diagnosis.reason);
        found.missing.clone_from(&of_first.diagnosis.missing);
    }
    if pair.repeats() && found.verdict == Verdict::UnknownChange {
        no_more_than_of_one(&of_first.diagnosis, found);
    }
    if let Some(told) = &of_first.diagnosis.set_up {
        doubted(&format!("{}: {told}", first.measured().source), &mut answer);
    }
    let found = &mut answer.changes;
    found.work.predictions += of_first.diagnosis.work.predictions;
    found.work.seconds = begun.elapsed().as_secs_f64();
    Ok(answer)
}

/// In a set-up that is not the machine's a change has no name; that nothing changed stays true.
fn doubted(told: &str, answer: &mut Answer) {
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

/// The search for changes, made anew as long as it finds other effects that both recordings share.
fn searched(
    pair: &Between,
    of_first: &diagnose::Answer,
    options: &Options,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Answer, DiagnoseError> {
    let own = &of_first.nominal;
    let mut shared = of_first.effects.clone();
    let mut undecided = Vec::new();
    let mut predictions = 0;
    let mut left = if pair.repeats() { 0 } else { MOST_ANEW };
    let (model, answer) = loop {
        let model = Change::new(pair, own, shared.clone());
        let answer = explain(&model, &pair.observation, options, progress, false)?;
        predictions += answer.diagnosis.work.predictions;
        if left == 0 || answer.effects.is_empty() {
            break (model, answer);
        }
        left -= 1;
        let Some(anew) = shared::anew(pair, own, &model, &answer, options)? else {
            break (model, answer);
        };
        shared = anew.shared;
        undecided.extend(anew.undecided);
    };
    let (nominal, shared) = model.settled(&answer.nominal);
    let mut effects = answer.effects.clone();
    let mut found = told(pair, &model, &shared, &answer.diagnosis, undecided);
    if !pair.repeats() && found.verdict == Verdict::UnknownChange {
        effects.retain(|effect| !effect.kind.is_curve());
        let grows = grows(pair, &model.predict(&answer.nominal, &effects)?);
        after_another_motion(grows, &mut found);
        if found.changes.is_empty() {
            effects.clear();
        }
    }
    let [before, after] = model.split(&shared, &effects);
    found.work.predictions = predictions;
    Ok(Answer {
        changes: found,
        before,
        after,
        nominal,
        unchanged: answer.before,
        changed: answer.after,
    })
}

/// Where nothing says that something changed but the size of what is left, beside a noise that is
/// known: it has to be more than both recordings leave of themselves, as large as the first does.
fn no_more_than_of_one(first: &Diagnosis, found: &mut Changes) {
    let signals = &found.ceiling.correlated_signals;
    if found.curve.is_some() || !signals.is_empty() {
        return;
    }
    let is_more = (found.channels.iter()).any(|(name, errors)| {
        let own = first.channels.get(name).map_or(0.0, |own| own.after);
        errors.after.powi(2) > EXCESS * 2.0 * own.powi(2)
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

/// Refuses units of the second recording that cannot be meant.
fn check_second(second: &Trial) -> Result<(), DiagnoseError> {
    second.observation.check(second.channels().len())?;
    let numbers: Vec<f64> = second.nominal().iter().map(|one| one.value).collect();
    let nominal = second.predict(&numbers, &[])?;
    check_units(second, &second.observation, &nominal)
        .map_err(|error| clock_or_unit(second, &second.observation, &nominal, error))
}

/// The answer of the search in words of changes.
fn told(
    pair: &Between,
    model: &Change,
    shared: &[Effect],
    found: &Diagnosis,
    undecided: Vec<String>,
) -> Changes {
    let compared = match pair.motion {
        Motion::Repeated { later_s, unlike } => Compared {
            repeated: true,
            later_s: Some(later_s),
            unlike: Some(unlike),
        },
        Motion::Different => Compared::default(),
    };
    let source = |trial: &Trial| trial.measured().source.clone();
    let (verdict, reason) = verdict(found, &undecided);
    let rival = |one: &Alternative| Rival {
        changes: one
            .causes
            .iter()
            .map(|cause| changed(pair, model, shared, cause))
            .collect(),
        angle_deg: one.angle_deg,
        criterion_difference: one.criterion_difference,
    };
    Changes {
        version: VERSION,
        scenario: found.scenario.clone(),
        first: source(&pair.first),
        second: source(&pair.second),
        compared,
        verdict,
        reason,
        changes: found
            .causes
            .iter()
            .map(|cause| changed(pair, model, shared, cause))
            .collect(),
        alternatives: found.alternatives.iter().map(rival).collect(),
        runner_up: found.runner_up.as_ref().map(rival),
        further: found.further.clone(),
        curve: found.curve.clone(),
        undecided,
        unexplained_fraction: found.unexplained_fraction,
        channels: found.channels.clone(),
        smallest_seen: found.smallest_seen.clone(),
        missing: found.missing.clone(),
        doubts: found.doubts.clone(),
        ceiling: found.ceiling.clone(),
        ..Changes::default()
    }
}

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
/// it. Changes that have one stay where they explain what they are about.
fn after_another_motion(grows: bool, found: &mut Changes) {
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

/// A cause of the search as what it is before and after.
fn changed(pair: &Between, model: &Change, shared: &[Effect], cause: &Cause) -> Changed {
    let candidates = model.candidates();
    let own = candidates
        .iter()
        .find(|one| one.kind.name() == cause.kind && diagnose::target_name(one) == cause.target);
    let sides = own.map(|own| {
        let value = |key: &str| cause.parameters.get(key).map_or(0.0, |one| one.value);
        let infos = own.kind.parameters().iter();
        let keys: Vec<&str> = infos
            .map(|info| {
                if own.rotary {
                    info.rotary_key
                } else {
                    info.key
                }
            })
            .collect();
        let effect = Effect {
            kind: own.kind,
            target: own.target.clone(),
            values: keys.iter().map(|key| value(key)).collect(),
        };
        let held = &pair.second.scenario().effects;
        let known = twin(shared, held, own.kind, &own.target);
        (keys, own.kind.parameters(), both(&effect, known))
    });
    let parameters = cause.parameters.iter().map(|(key, found)| {
        let place = sides.as_ref().and_then(|(keys, infos, sides)| {
            let at = keys.iter().position(|one| one == key)?;
            let neutral = if infos[at].is_size {
                infos[at].neutral
            } else {
                0.0
            };
            Some((sides[0].values[at], sides[1].values[at], neutral))
        });
        let (before, after, neutral) = place.unwrap_or((0.0, found.value, 0.0));
        let parameter = ChangedParameter {
            before,
            after,
            change: found.value - neutral,
            low: found.low.map(|low| low - neutral),
            high: found.high.map(|high| high - neutral),
            unit: found.unit.clone(),
        };
        (key.clone(), parameter)
    });
    Changed {
        kind: cause.kind.clone(),
        target: cause.target.clone(),
        parameters: parameters.collect(),
        evidence: cause.evidence.clone(),
    }
}
