//! From the end of the search to the answer.

mod changing;
mod excess;
mod held_out;
mod incidental;
mod test_part;
mod unnamed;

pub(crate) use changing::courses;
pub(crate) use test_part::breaks_away_from;

use rayon::prelude::*;

use self::excess::{Excess, excess};
use super::ambiguity::{Rival, experiments, rivals};
use super::answer::{Diagnosis, VERSION, Verdict, names};
use super::ceiling::{Bound, bound as bound_on};
use super::curve::Shown;
use super::doubts::{at_bound, doubts, unrelated};
use super::evidence::{alternative, causes, invisible, nominal, smallest_seen, visible};
use super::fit::{Fit, fit};
use super::floor::NoiseSource;
use super::noise::Noise;
use super::problem::{Point, Problem};
use super::search::Outcome;
use super::uncertainty::standard_errors;
use super::validate::{compare, rms};
use super::{Answer, DiagnoseError, Stage};
use crate::model::{Columns, PredictError};
use crate::stats::{deviation, ratio};

/// Least fraction of detectable candidates for the experiment to be informative.
const LEAST_VISIBLE: f64 = 0.05;
/// Other explanations that stand beside the causes at most; of more only the names are told.
const MOST_ALTERNATIVES: usize = 3;

/// The diagnosis where no output changes.
pub(super) fn not_excited(problem: &Problem, before: Columns, missing: Vec<String>) -> Answer {
    let mut diagnosis = empty(problem);
    diagnosis.verdict = Verdict::NotIdentifiable;
    diagnosis.reason = "No output moves beyond its noise: nothing can be told apart.".into();
    diagnosis.missing = missing;
    let residual = problem.data.residual(&before);
    let errors = rms(&residual, &problem.split.test);
    diagnosis.channels =
        test_part::channel_errors(problem, &problem.known, &errors, &errors, &errors, &errors);
    Answer {
        diagnosis,
        effects: Vec::new(),
        nominal: problem.start().nominal,
        after: before.clone(),
        before,
        test_rows: problem.split.test.per_channel.clone(),
    }
}

fn empty(problem: &Problem) -> Diagnosis {
    Diagnosis {
        version: VERSION,
        scenario: problem.data.scenario.clone(),
        data: problem.data.source.clone(),
        ..Diagnosis::default()
    }
}

/// Draws the conclusion. The choice is frozen when this is called; the test part is opened here.
///
/// # Errors
/// The simulation cannot be run around the model chosen.
pub(super) fn conclude(
    problem: &Problem,
    before: Columns,
    outcome: Outcome,
) -> Result<Answer, DiagnoseError> {
    let development = &problem.split.development;
    let to_all = |point: &Point| -> Result<Fit, PredictError> {
        let mut ended = fit(problem, point.clone(), development, &outcome.orders, true)?;
        // The test part was not simulated so far; figures and report include it.
        ended.predicted = problem.predict_whole(&ended.point)?;
        ended.residual = problem.data.residual(&ended.predicted);
        Ok(ended)
    };
    let (last, base) = rayon::join(
        || to_all(&outcome.chosen.point),
        || to_all(&outcome.base.point),
    );
    let (last, base) = (last?, base?);
    let (last, incidental) = incidental::without_incidental(problem, &base, last, to_all);
    let held_out::Kept { last, refuted } = held_out::kept(problem, &base, last, to_all);
    problem.report(Stage::Ceiling);
    // One needs hardly any simulations, the other many, some of them in sequence.
    let (mut bound, described) = rayon::join(
        || bound_on(problem, &base, &last, &outcome.signatures),
        || described(problem, &outcome, &last),
    );
    let mut diagnosis = described?;
    incidental::tell(incidental, &mut diagnosis);
    diagnosis.ceiling = bound.ceiling.clone();
    let changing = changing::keep_large(problem, &before, &last, &mut bound);
    diagnosis.unexplained_fraction = unexplained(problem, &base, &last, &bound).max(changing);
    let floors = changing::holding(&problem.known, &bound);
    let excess = excess(problem, &before, &last, &bound, &floors);
    let errors = test_part::errors(problem, &before, &base, &last, &bound, &floors);
    diagnosis.channels = errors;
    (diagnosis.doubts).extend(test_part::overstated(&diagnosis.channels));
    judge(problem, excess, &outcome, &mut diagnosis);
    tell_end(problem, &last, &mut diagnosis);
    held_out::tell(problem, &refuted, &mut diagnosis);
    test_part::open_test(problem, &base, &last, &bound.changes, &mut diagnosis);
    let fits = [&base, &last];
    let curve = unnamed::curve(problem, &outcome, fits, bound.is_hinted, &diagnosis)?
        .filter(|shown| !changing::is_better(problem, &bound, &last, &shown.fit));
    let (last, changes) = match curve {
        None => (last, bound.changes),
        Some(shown) => {
            let mut bound = bound_on(problem, &base, &shown.fit, &outcome.signatures);
            changing::keep_large(problem, &before, &shown.fit, &mut bound);
            with_curve(problem, [&base, &last], &shown, &bound, &mut diagnosis)?;
            diagnosis.channels =
                test_part::errors(problem, &before, &base, &shown.fit, &bound, &floors);
            (shown.fit, bound.changes)
        }
    };
    changing::tell(changes, &mut diagnosis);
    diagnosis.fits = outcome.fits;
    Ok(Answer {
        effects: problem.effects(&last.point),
        nominal: last.point.nominal.clone(),
        before,
        after: last.predicted,
        test_rows: problem.split.test.per_channel.clone(),
        diagnosis,
    })
}

/// The answer with a curve beside the causes, or in their place.
fn with_curve(
    problem: &Problem,
    [base, last]: [&Fit; 2],
    shown: &Shown,
    bound: &Bound,
    diagnosis: &mut Diagnosis,
) -> Result<(), DiagnoseError> {
    let errors = standard_errors(problem, &shown.fit, &problem.split.development)?;
    diagnosis.ceiling = bound.ceiling.clone();
    diagnosis.unexplained_fraction = unexplained(problem, base, &shown.fit, bound);
    diagnosis.causes = causes(problem, &shown.fit, &errors)?;
    diagnosis.nominal = nominal(problem, &shown.fit, &errors);
    unnamed::tell(problem, last, shown, diagnosis);
    Ok(())
}

/// Takes the verdict back where a size lies at an end of its range.
fn tell_end(problem: &Problem, last: &Fit, diagnosis: &mut Diagnosis) {
    let is_named = diagnosis.verdict == Verdict::Named;
    if !is_named && diagnosis.verdict != Verdict::UnknownCause {
        return;
    }
    if let Some(end) = at_bound(problem, last) {
        if is_named {
            diagnosis.verdict = Verdict::UnknownCause;
            diagnosis.reason = format!(
                "No size of the effects known fits: {end}. {}",
                diagnosis.reason
            );
        }
        diagnosis.at_end = Some(end);
    }
}

/// Simulations around the model chosen: causes with their uncertainty, other explanations,
/// detectable sizes.
fn described(problem: &Problem, outcome: &Outcome, last: &Fit) -> Result<Diagnosis, DiagnoseError> {
    let mut diagnosis = empty(problem);
    diagnosis.smallest_seen = smallest_seen(problem, outcome);
    let errors = standard_errors(problem, last, &problem.split.development)?;
    diagnosis.causes = causes(problem, last, &errors)?;
    diagnosis.nominal = nominal(problem, last, &errors);
    diagnosis.doubts = problem.model.doubt().into_iter().collect();
    diagnosis.doubts.extend(doubts(problem, last));
    let simulated = &outcome.base.predicted;
    let unrelated = (diagnosis.causes.iter()).filter_map(|one| unrelated(problem, simulated, one));
    diagnosis.doubts.extend(unrelated);
    let rivals = match last.point.effects.is_empty() {
        true => Vec::new(),
        false => rivals(problem, outcome, &outcome.rivals),
    };
    let rivals = match rivals.is_empty() {
        true => next_best(problem, outcome),
        false => rivals,
    };
    let as_good: Vec<usize> = (0..rivals.len()).filter(|&i| rivals[i].as_good).collect();
    let (told, further) = as_good.split_at(as_good.len().min(MOST_ALTERNATIVES));
    diagnosis.further = (further.iter())
        .map(|&i| names(problem, &rivals[i].fit.point).join(" + "))
        .collect();
    // The next best is reported even where it is no alternative; the same law with more numbers is
    // no other explanation.
    let next = (rivals.iter()).position(|one| one.as_good || one.criterion_difference >= 0.0);
    let described: Vec<&Rival> = (rivals.iter().enumerate())
        .filter(|(i, _)| Some(*i) == next || told.contains(i))
        .map(|(_, rival)| rival)
        .collect();
    let answers = (described.par_iter())
        .map(|rival| alternative(problem, rival, &outcome.orders))
        .collect::<Result<Vec<_>, _>>()?;
    diagnosis.runner_up = answers.first().cloned();
    let as_good = answers
        .into_iter()
        .zip(described)
        .filter(|(_, r)| r.as_good);
    diagnosis.alternatives = as_good.map(|(answer, _)| answer).collect();
    if let Some(rival) = rivals.iter().find(|r| r.as_good) {
        diagnosis.experiments = experiments(problem, &outcome.chosen, &rival.fit);
    }
    Ok(diagnosis)
}

/// Where the model chosen was reached through a larger one, no rival has as many effects. The
/// closest single explanation is reported all the same, but is no alternative, since the larger
/// model was preferred to it, unless it is the likelier one: then blocks that neither was fitted to
/// speak for one and the likelihood of all for the other.
fn next_best(problem: &Problem, outcome: &Outcome) -> Vec<Rival> {
    let mut found = rivals(problem, outcome, &outcome.singles);
    found.truncate(1);
    (found.iter_mut()).for_each(|rival| rival.as_good &= rival.criterion_difference < 0.0);
    found
}

/// The verdict, before the causes' gain on the test part is known; what is left beyond a known
/// noise floor (`excess`) is counted there, too.
fn judge(problem: &Problem, excess: Option<Excess>, outcome: &Outcome, diagnosis: &mut Diagnosis) {
    if let Some(excess) = &excess {
        diagnosis.unexplained_fraction = diagnosis.unexplained_fraction.max(excess.fraction);
    }
    let prevails = excess.as_ref().is_some_and(|excess| excess.prevails);
    let known = (diagnosis.channels.values()).all(|one| one.noise_source != NoiseSource::Bound);
    let followed = diagnosis
        .ceiling
        .correlated_signals
        .first()
        .map(|l| format!("the residual of `{}` follows {}", l.channel, l.signal));
    let followed = match (followed, excess) {
        (Some(followed), Some(excess)) => Some(format!("{}, and {followed}", excess.text)),
        (followed, excess) => followed.or(excess.map(|excess| excess.text)),
    };
    let is_more = followed.is_some();
    let percent = match 100.0 * diagnosis.unexplained_fraction {
        ..1.0 => "less than 1".to_owned(),
        percent => format!("{percent:.0}"),
    };
    let stopped = format!(
        "The search stopped at the limit of {} simulations before it had looked at everything.",
        problem.allowed()
    );
    (diagnosis.verdict, diagnosis.reason) = if outcome.stopped && diagnosis.causes.is_empty() {
        diagnosis.unexplained_fraction = 1.0;
        (Verdict::FitFailed, stopped.clone())
    } else if outcome.failed {
        diagnosis.unexplained_fraction = 1.0;
        let reason = "There is a discrepancy, and no fit of an effect to it converged.";
        (Verdict::FitFailed, reason.into())
    } else if diagnosis.causes.is_empty() {
        without_cause(problem, followed, diagnosis)
    } else if prevails || diagnosis.unexplained_fraction > problem.options.unknown_above {
        let followed = followed.unwrap_or_else(|| "a pattern is left".into());
        let of_what = match diagnosis.most_fallen() {
            Some((name, errors)) => format!(
                "of what stands out of the noise unexplained, though the error of `{name}` falls from {} to {} {}",
                truecut_recording::significant(errors.refitted, 3),
                truecut_recording::significant(errors.after, 3),
                errors.unit
            ),
            None => "of the discrepancy unexplained".to_owned(),
        };
        let reason = format!("The effects known leave {percent} % {of_what}; {followed}.");
        (Verdict::UnknownCause, reason)
    } else if diagnosis.alternatives.is_empty() {
        let explained = match followed {
            Some(followed) => {
                format!("explain the discrepancy but for {percent} %: {followed}.")
            }
            None => format!(
                "explain the discrepancy {}.",
                up_to_noise(problem, diagnosis)
            ),
        };
        (Verdict::Named, format!("The causes named {explained}"))
    } else {
        (
            Verdict::Ambiguous,
            match diagnosis.further.as_slice() {
                [] => "Several causes explain the discrepancy alike.".into(),
                further => format!(
                    "Several causes explain the discrepancy alike; less likely, and not excluded: {}.",
                    further.join(", ")
                ),
            },
        )
    };
    // A budget that ended the search is told first.
    let ended = match (
        outcome.stopped && !diagnosis.causes.is_empty(),
        outcome.limited,
    ) {
        (true, _) => Some(stopped),
        // Up to noise that is known there is nothing more.
        (_, true) if is_more || !known => Some(format!(
            "The search ended at the limit of {} causes, and more is there.",
            outcome.chosen.point.effects.len()
        )),
        _ => None,
    };
    if let Some(ended) = ended {
        diagnosis.reason = format!("{ended} {}", diagnosis.reason);
    }
    if diagnosis.verdict == Verdict::UnknownCause {
        // Of a part, too, nothing is named beside what is likelier without a word of that.
        (diagnosis.alternatives).retain(|other| other.criterion_difference < 0.0);
        diagnosis.further.clear();
        diagnosis.experiments.clear();
    } else if diagnosis.verdict != Verdict::Ambiguous {
        diagnosis.alternatives.clear();
        diagnosis.further.clear();
        diagnosis.experiments.clear();
    }
}

/// The verdict where no cause was found; `followed` names what the residual correlates with.
fn without_cause(
    problem: &Problem,
    followed: Option<String>,
    diagnosis: &mut Diagnosis,
) -> (Verdict, String) {
    if let Some(followed) = followed {
        diagnosis.unexplained_fraction = 1.0;
        let reason = format!("No effect known explains the discrepancy; {followed}.");
        return (Verdict::UnknownCause, reason);
    }
    if visible(problem, &diagnosis.smallest_seen) < LEAST_VISIBLE {
        diagnosis.missing = invisible(problem, &diagnosis.smallest_seen);
        let reason = "The experiment shows next to none of the effects at their typical size.";
        return (Verdict::NotIdentifiable, reason.into());
    }
    let reason = format!(
        "The model explains the data {}.",
        up_to_noise(problem, diagnosis)
    );
    (Verdict::NothingBeyondNoise, reason)
}

/// What an explanation is held against: noise that is known is a fact, noise read off what is left
/// is at most all of it.
fn up_to_noise(problem: &Problem, diagnosis: &Diagnosis) -> String {
    let rows = &problem.split.development.per_channel;
    let channels = problem.model.channels().iter().enumerate();
    let bounded = channels.filter_map(|(c, spec)| {
        let errors = diagnosis.channels.get(&spec.name)?;
        let measured = rows[c].iter().map(|&t| problem.data.outputs[c].values[t]);
        let share = ratio(errors.after, deviation(&measured.collect::<Vec<_>>()));
        (errors.noise_source == NoiseSource::Bound).then_some((share, spec, errors))
    });
    let Some((share, spec, errors)) = bounded.max_by(|a, b| a.0.total_cmp(&b.0)) else {
        let mut sources: Vec<&str> = (diagnosis.channels.values())
            .map(|errors| errors.noise_source.description())
            .collect();
        sources.sort_unstable();
        sources.dedup();
        return format!("up to the noise ({})", sources.join(", "));
    };
    let memory = match errors.noise_without_memory > 0.0 {
        true => format!(
            "; without memory, noise would be {} times smaller",
            truecut_recording::significant(errors.after / errors.noise_without_memory, 2)
        ),
        false => String::new(),
    };
    format!(
        "up to noise, if what is left is noise: {} % of `{}`{memory}. How much of it is, these data \
         do not say; `noise` of a channel would, or a stretch at standstill, or the same motion twice",
        truecut_recording::significant(100.0 * share, 2),
        spec.name
    )
}

/// What a flexible predictor still explains, as a fraction of that plus what the effects explain.
fn unexplained(problem: &Problem, base: &Fit, last: &Fit, bound: &Bound) -> f64 {
    let rows = &problem.split.development;
    let noise = Noise::fit(&bound.left, rows, &last.noise.own_orders(), &problem.floor);
    let named = compare(&base.residual, &last.residual, &noise, rows)
        .gain
        .max(0.0);
    ratio(bound.gain, named + bound.gain)
}
