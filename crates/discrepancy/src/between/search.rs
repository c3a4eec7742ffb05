//! From two recordings to what changed.

use std::time::Instant;

use truecut_scenario::effect::Effect;

use super::answer::{Answer, Verdict};
use super::change::{Change, Of};
use super::revised::{Now, after_another_motion, doubted, no_more_than_of_one};
use super::told::{shared_causes, told};
use super::work::Work;
use super::{Between, BetweenError, events, join, shared};
use crate::diagnose::{
    self, DiagnoseError, Options, Progress, check_units, clock_or_unit, set_up_doubt,
};
use crate::model::Model;
use crate::trial::Trial;

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
    let mut work = Work {
        options,
        progress,
        made: 0,
    };
    let of_first = (work.diagnose(first)).map_err(BetweenError::of(&first.observation.source))?;
    check_second(second).map_err(BetweenError::of(&second.observation.source))?;
    let (mut answer, set_up_of_second) =
        searched(pair, &of_first, &mut work).map_err(BetweenError::of(&pair.observation.source))?;
    let found = &mut answer.changes;
    let unmoved = of_first.diagnosis.verdict == diagnose::Verdict::NotIdentifiable;
    if unmoved && found.verdict == Verdict::NothingChanged {
        found.verdict = Verdict::NotIdentifiable;
        found.reason = format!("{} {}", first.measured().source, of_first.diagnosis.reason);
        found.missing.clone_from(&of_first.diagnosis.missing);
    }
    if pair.repeats() && found.verdict == Verdict::UnknownChange {
        no_more_than_of_one(&of_first.diagnosis, found);
    }
    let doubts = [
        (first, of_first.diagnosis.set_up),
        (second, set_up_of_second),
    ];
    let doubts: Vec<String> = (doubts.into_iter())
        .filter_map(|(trial, told)| Some(format!("{}: {}", trial.measured().source, told?)))
        .collect();
    if !doubts.is_empty() {
        doubted(&doubts.join(" "), &mut answer);
        // What happens in a set-up that is not the machine's need not happen in it.
        answer.changes.events.clear();
    }
    events::tell(&mut answer.changes);
    let found = &mut answer.changes;
    found.work.predictions = work.made;
    found.work.seconds = begun.elapsed().as_secs_f64();
    Ok(answer)
}

/// The search for changes, made anew as long as it finds other effects that both recordings share;
/// and another set-up, if any explains far more of the second recording than what was found.
fn searched(
    pair: &Between,
    of_first: &diagnose::Answer,
    work: &mut Work,
) -> Result<(Answer, Option<String>), DiagnoseError> {
    let own = &of_first.nominal;
    let mut shared = of_first.effects.clone();
    let mut known = of_first.diagnosis.causes.clone();
    let mut undecided = Vec::new();
    let (of, mut left) = match pair.repeats() {
        true => (Of::Difference, 0),
        false => (Of::Both, MOST_ANEW),
    };
    let (model, found) = loop {
        let model = Change::new(pair, of, own, shared.clone());
        let found = work.search(&model, pair)?;
        if left == 0 || found.effects.is_empty() {
            break (model, found);
        }
        left -= 1;
        let Some(anew) = shared::anew(pair, own, &model, &found, work)? else {
            break (model, found);
        };
        known.extend(found.diagnosis.causes);
        shared = anew.shared;
        undecided.extend(anew.undecided);
    };
    let mut now = Now {
        numbers: found.diagnosis.nominal.clone(),
        effects: found.effects.clone(),
        nominal: found.nominal,
        changed: found.after,
    };
    let (mut both, mut shared) = model.settled(&now.nominal);
    if of == Of::Difference && !shared.is_empty() {
        // What both have is told as it fits both, not as the first has it.
        let joint = Change::new(pair, Of::Both, own, shared.clone());
        let data = join::one_after_the_other(&pair.first.observation, &pair.second.observation);
        let start: Vec<f64> = joint.nominal().iter().map(|one| one.value).collect();
        if let Ok(fitted) = work.refitted(&joint, &data, &start, &now.effects) {
            let (fitted_both, fitted_shared) = joint.settled(&fitted.nominal);
            let sides = model.split(&fitted_shared, &now.effects);
            if can_be_simulated(pair, &fitted_both, &sides) {
                (both, shared) = (fitted_both, fitted_shared);
                now.numbers = fitted.numbers;
            }
        }
    }
    let mut changes = told(pair, &model, &shared, &found.diagnosis, undecided);
    if !pair.repeats() && changes.verdict == Verdict::UnknownChange {
        after_another_motion(pair, &model, work, &mut changes, &mut now)?;
        (both, shared) = model.settled(&now.nominal);
    }
    let [before, after] = model.split(&shared, &now.effects);
    let predicted = pair.second.predict(&both[1], &after)?;
    let set_up_of_second = set_up_doubt(&pair.second, &pair.second.observation, &predicted);
    changes.shared = shared_causes(pair, &known, [&before, &after], &shared, &now.numbers);
    let of_both = [&found.diagnosis, &of_first.diagnosis];
    changes.events = events::events(pair, of_both, &both, &before);
    let [nominal, _] = both;
    let answer = Answer {
        changes,
        before,
        after,
        nominal,
        unchanged: found.before,
        changed: now.changed,
    };
    Ok((answer, set_up_of_second))
}

/// Whether both machines run. Not so if what both share, fitted to both, takes from a link what a
/// change (a payload taken off) takes from it as well.
fn can_be_simulated(pair: &Between, both: &[Vec<f64>; 2], sides: &[Vec<Effect>; 2]) -> bool {
    let trials = [&pair.first, &pair.second];
    (trials.into_iter().zip(both).zip(sides))
        .all(|((trial, numbers), effects)| trial.predict(numbers, effects).is_ok())
}

/// Refuses units of the second recording that cannot be meant.
fn check_second(second: &Trial) -> Result<(), DiagnoseError> {
    second.observation.check(second.channels().len())?;
    let numbers: Vec<f64> = second.nominal().iter().map(|one| one.value).collect();
    let nominal = second.predict(&numbers, &[])?;
    check_units(second, &second.observation, &nominal)
        .map_err(|error| clock_or_unit(second, &second.observation, &nominal, error))
}
