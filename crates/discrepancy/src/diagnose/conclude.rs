//! From the end of the search to the answer.

mod test_part;

use rayon::prelude::*;

use super::ambiguity::{Rival, experiments, rivals};
use super::answer::{Diagnosis, VERSION, Verdict};
use super::ceiling::{Bound, bound};
use super::evidence::{alternative, causes, invisible, nominal, smallest_seen, visible};
use super::fit::{Fit, fit};
use super::noise::{Noise, dot};
use super::problem::{Point, Problem};
use super::search::Outcome;
use super::uncertainty::standard_errors;
use super::validate::{compare, rms};
use super::{Answer, DiagnoseError, Stage};
use crate::model::{Columns, PredictError};
use crate::stats::{deviation, ratio};

/// Where the noise is known: least significant ratio of the residual's variance to it.
const EXCESS: f64 = 1.25;
/// Least fraction of detectable candidates for the experiment to be informative.
const LEAST_VISIBLE: f64 = 0.05;
/// Other explanations that are reported at most.
const MOST_RIVALS: usize = 6;

/// The diagnosis where no output changes.
pub(super) fn not_excited(problem: &Problem, before: Columns, missing: Vec<String>) -> Answer {
    let mut diagnosis = empty(problem);
    diagnosis.verdict = Verdict::NotIdentifiable;
    diagnosis.reason = "No output moves beyond its noise: nothing can be told apart.".into();
    diagnosis.missing = missing;
    let residual = problem.data.residual(&before);
    let errors = rms(&residual, &problem.split.test);
    diagnosis.channels = test_part::channel_errors(problem, &errors, &errors, &errors, &errors);
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
    problem.report(Stage::Ceiling);
    // One needs hardly any simulations, the other many, some of them in sequence.
    let (bound, described) = rayon::join(
        || bound(problem, &base, &last, &outcome.signatures),
        || described(problem, &outcome, &last),
    );
    let mut diagnosis = described?;
    diagnosis.ceiling = bound.ceiling.clone();
    diagnosis.unexplained_fraction = unexplained(problem, &base, &last, &bound);
    judge(problem, &before, &outcome, &last, &mut diagnosis);
    test_part::open_test(problem, &before, &base, &last, &bound, &mut diagnosis);
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

/// Simulations around the model chosen: causes with their uncertainty, other explanations,
/// detectable sizes.
fn described(problem: &Problem, outcome: &Outcome, last: &Fit) -> Result<Diagnosis, DiagnoseError> {
    let mut diagnosis = empty(problem);
    diagnosis.smallest_seen = smallest_seen(problem, outcome);
    let errors = standard_errors(problem, last, &problem.split.development)?;
    diagnosis.causes = causes(problem, last, &errors)?;
    diagnosis.nominal = nominal(problem, last, &errors);
    let rivals = match last.point.effects.is_empty() {
        true => Vec::new(),
        false => rivals(problem, outcome, &outcome.rivals),
    };
    let rivals = match rivals.is_empty() {
        true => next_best(problem, outcome),
        false => rivals,
    };
    let described: Vec<&Rival> = (rivals.iter().take(MOST_RIVALS).enumerate())
        .filter(|(i, rival)| *i == 0 || rival.as_good)
        .map(|(_, rival)| rival)
        .collect();
    let answers = (described.par_iter())
        .map(|rival| alternative(problem, rival))
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
/// closest single explanation is reported all the same, but is no alternative: the larger model was
/// preferred to it.
fn next_best(problem: &Problem, outcome: &Outcome) -> Vec<Rival> {
    let mut found = rivals(problem, outcome, &outcome.singles);
    found.truncate(1);
    found.iter_mut().for_each(|rival| rival.as_good = false);
    found
}

/// The verdict, before the test part is opened.
fn judge(
    problem: &Problem,
    before: &Columns,
    outcome: &Outcome,
    last: &Fit,
    diagnosis: &mut Diagnosis,
) {
    let excess = excess(problem, before, last);
    if let Some((fraction, _)) = &excess {
        diagnosis.unexplained_fraction = diagnosis.unexplained_fraction.max(*fraction);
    }
    let followed = diagnosis
        .ceiling
        .correlated_signals
        .first()
        .map(|l| format!("the residual of `{}` follows {}", l.channel, l.signal));
    let followed = followed.or(excess.map(|(_, text)| text));
    let percent = (100.0 * diagnosis.unexplained_fraction).round();
    let stopped = format!(
        "The search stopped at the limit of {} simulations before it had looked at everything.",
        problem.options.max_predictions
    );
    (diagnosis.verdict, diagnosis.reason) = if outcome.stopped && diagnosis.causes.is_empty() {
        diagnosis.unexplained_fraction = 1.0;
        (Verdict::FitFailed, stopped.clone())
    } else if outcome.failed {
        diagnosis.unexplained_fraction = 1.0;
        let reason = "There is a discrepancy, and no fit of an effect to it converged.";
        (Verdict::FitFailed, reason.into())
    } else if diagnosis.causes.is_empty() {
        without_cause(problem, last, followed, diagnosis)
    } else if diagnosis.unexplained_fraction > problem.options.unknown_above {
        let followed = followed.unwrap_or_else(|| "a pattern is left".into());
        let reason = format!(
            "The effects known leave {percent} % of the discrepancy unexplained; {followed}."
        );
        (Verdict::UnknownCause, reason)
    } else if diagnosis.alternatives.is_empty() {
        let rest = match followed {
            Some(followed) => format!(" {percent} % stay unexplained: {followed}."),
            None => String::new(),
        };
        (
            Verdict::Named,
            format!("The causes named explain the discrepancy.{rest}"),
        )
    } else {
        (
            Verdict::Ambiguous,
            "Several causes explain the discrepancy alike.".into(),
        )
    };
    // A budget that ended the search is told first.
    let ended = match (
        outcome.stopped && !diagnosis.causes.is_empty(),
        outcome.limited,
    ) {
        (true, _) => Some(stopped),
        (_, true) => Some(format!(
            "The search ended at the limit of {} causes, and more is there.",
            diagnosis.causes.len()
        )),
        _ => None,
    };
    if let Some(ended) = ended {
        diagnosis.reason = format!("{ended} {}", diagnosis.reason);
    }
    if !matches!(diagnosis.verdict, Verdict::Ambiguous) {
        diagnosis.alternatives.clear();
        diagnosis.experiments.clear();
    }
}

/// The verdict where no cause was found; `followed` names what the residual correlates with.
fn without_cause(
    problem: &Problem,
    last: &Fit,
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
    (Verdict::NothingBeyondNoise, up_to_noise(problem, last))
}

/// What nothing beyond noise means: noise that is stated is a fact, noise read off what is left is
/// at most all of it.
fn up_to_noise(problem: &Problem, last: &Fit) -> String {
    let rows = &problem.split.development;
    let left = rms(&last.residual, rows);
    let channels = (problem.data.outputs.iter().enumerate())
        .filter(|(_, output)| output.noise.is_none())
        .map(|(c, output)| {
            let measured = rows.per_channel[c].iter().map(|&t| output.values[t]);
            (ratio(left[c], deviation(&measured.collect::<Vec<_>>())), c)
        });
    let Some((share, c)) = channels.max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return "The model explains the data up to the noise stated.".into();
    };
    format!(
        "The model explains the data up to noise, if what is left is noise: {} % of `{}`. How much of it is, these data do not \
         say; `noise` of a channel would.",
        truecut_recording::significant(100.0 * share, 2),
        problem.model.channels()[c].name
    )
}

/// Where the noise is known and the residual is clearly above it: that fraction of the discrepancy,
/// and a clause for the text.
fn excess(problem: &Problem, before: &Columns, last: &Fit) -> Option<(f64, String)> {
    let rows = &problem.split.development;
    let nominal = problem.data.residual(before);
    let mut most: Option<(f64, String)> = None;
    for (c, output) in problem.data.outputs.iter().enumerate() {
        let Some(noise) = output.noise else { continue };
        let rows = &rows.per_channel[c];
        let residual: Vec<f64> = rows.iter().map(|&t| last.residual[c][t]).collect();
        let n = rows.len() as f64;
        let (mean, variance) = (dot(&residual, &residual) / n, noise * noise);
        // Of noise of that variance, with the colour of the residual.
        let error = variance * (2.0 * memory(&residual) / n).sqrt();
        if mean < EXCESS * variance || mean - variance < 4.0 * error {
            continue;
        }
        let before = rows.iter().map(|&t| nominal[c][t].powi(2)).sum::<f64>() / n;
        let fraction = ((mean - variance) / (before - variance).max(mean - variance)).min(1.0);
        if most.as_ref().is_none_or(|m| m.0 < fraction) {
            let ratio = truecut_recording::significant((mean / variance).sqrt(), 3);
            let name = &problem.model.channels()[c].name;
            most = Some((
                fraction,
                format!("the residual of `{name}` is {ratio} times the noise stated"),
            ));
        }
    }
    most
}

/// Sum of the squared autocorrelations: the factor by which the variance of a mean square exceeds
/// that of white noise.
fn memory(x: &[f64]) -> f64 {
    let whole = dot(x, x);
    let at = |lag: usize| dot(&x[lag..], &x[..x.len() - lag]) / whole;
    1.0 + 2.0
        * (1..(x.len() / 10).min(100))
            .map(|lag| at(lag).powi(2))
            .sum::<f64>()
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
