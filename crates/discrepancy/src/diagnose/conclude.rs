//! From the end of the search to the answer.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::ambiguity::{Rival, experiments, rivals};
use super::answer::{Ceiling, ChannelErrors, Diagnosis, VERSION, Verdict, Work};
use super::ceiling::{Bound, bound};
use super::data::Rows;
use super::evidence::{alternative, causes, invisible, nominal, smallest_seen, visible};
use super::fit::{Fit, fit};
use super::noise::{Noise, dot};
use super::problem::{Point, Problem};
use super::search::Outcome;
use super::uncertainty::standard_errors;
use super::validate::{batch_sums, compare, error_of_sum, rms};
use super::{Answer, DiagnoseError, Stage};
use crate::model::{Columns, PredictError};

/// Where the noise is known: least ratio of the residual's variance to it that counts.
const EXCESS: f64 = 1.25;
/// With less than this part of the candidates within reach the experiment is too poor.
const LEAST_VISIBLE: f64 = 0.05;
/// Other explanations that are told of, at most.
const MOST_RIVALS: usize = 6;

/// The answer where nothing moves.
pub(super) fn not_excited(problem: &Problem, before: Columns, missing: Vec<String>) -> Answer {
    let mut diagnosis = empty(problem);
    diagnosis.verdict = Verdict::NotIdentifiable;
    diagnosis.reason = "No output moves beyond its noise: nothing can be told apart.".into();
    diagnosis.missing = missing;
    let residual = problem.data.residual(&before);
    let errors = rms(&residual, &problem.split.test);
    diagnosis.channels = channel_errors(problem, &errors, &errors, &errors, &errors);
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
        verdict: Verdict::NothingBeyondNoise,
        reason: String::new(),
        causes: Vec::new(),
        alternatives: Vec::new(),
        runner_up: None,
        unexplained_fraction: 0.0,
        channels: BTreeMap::new(),
        nominal: Vec::new(),
        smallest_seen: Vec::new(),
        missing: Vec::new(),
        ceiling: Ceiling {
            fraction: 0.0,
            t: 0.0,
            locks: Vec::new(),
        },
        experiments: Vec::new(),
        fits: Vec::new(),
        work: Work::default(),
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
        // The test part was not simulated so far; what is drawn and told shows it, too.
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
    // One asks for next to no simulations, the other for many, some of them one after the other.
    let (bound, told) = rayon::join(
        || bound(problem, &base, &last, &outcome.signatures),
        || told(problem, &outcome, &last),
    );
    let mut diagnosis = told?;
    diagnosis.ceiling = bound.ceiling.clone();
    diagnosis.unexplained_fraction = unexplained(problem, &base, &last, &bound);
    judge(problem, &before, &outcome, &last, &mut diagnosis);
    open_test(problem, &before, &base, &last, &bound, &mut diagnosis);
    diagnosis.fits = outcome.fits;
    Ok(Answer {
        effects: last
            .point
            .effects
            .iter()
            .map(|f| problem.effect(f))
            .collect(),
        nominal: last.point.nominal.clone(),
        before,
        after: last.predicted,
        test_rows: problem.split.test.per_channel.clone(),
        diagnosis,
    })
}

/// What simulations tell of the model chosen: causes with their uncertainty, other explanations, what would have been seen.
fn told(problem: &Problem, outcome: &Outcome, last: &Fit) -> Result<Diagnosis, DiagnoseError> {
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
    let told: Vec<&Rival> = (rivals.iter().take(MOST_RIVALS).enumerate())
        .filter(|(i, rival)| *i == 0 || rival.as_good)
        .map(|(_, rival)| rival)
        .collect();
    let answers = (told.par_iter())
        .map(|rival| alternative(problem, rival))
        .collect::<Result<Vec<_>, _>>()?;
    diagnosis.runner_up = answers.first().cloned();
    let as_good = answers.into_iter().zip(told).filter(|(_, r)| r.as_good);
    diagnosis.alternatives = as_good.map(|(answer, _)| answer).collect();
    if let Some(rival) = rivals.iter().find(|r| r.as_good) {
        diagnosis.experiments = experiments(problem, &outcome.chosen, &rival.fit);
    }
    Ok(diagnosis)
}

/// Where the model chosen was reached through a larger one, no rival has as many effects. What came closest alone is told all the same; that it is no
/// alternative is settled: the larger model was chosen before it.
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
    let locked = diagnosis
        .ceiling
        .locks
        .first()
        .map(|l| format!("the residual of `{}` follows {}", l.channel, l.to));
    let locked = locked.or(excess.map(|(_, text)| text));
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
        (
            Verdict::FitFailed,
            "There is a discrepancy, and no fit of an effect to it converged.".into(),
        )
    } else if diagnosis.causes.is_empty() {
        match locked {
            Some(locked) => {
                diagnosis.unexplained_fraction = 1.0;
                (
                    Verdict::UnknownCause,
                    format!("No effect known explains the discrepancy; {locked}."),
                )
            }
            None if visible(problem, &diagnosis.smallest_seen) < LEAST_VISIBLE => {
                diagnosis.missing = invisible(problem, &diagnosis.smallest_seen);
                (
                    Verdict::NotIdentifiable,
                    "The experiment shows next to none of the effects at their typical size."
                        .into(),
                )
            }
            None => (
                Verdict::NothingBeyondNoise,
                "The model explains the data up to noise.".into(),
            ),
        }
    } else if diagnosis.unexplained_fraction > problem.options.unknown_above {
        let locked = locked.unwrap_or_else(|| "a pattern is left".into());
        let reason = format!(
            "The effects known leave {percent} % of the discrepancy unexplained; {locked}."
        );
        (Verdict::UnknownCause, reason)
    } else if diagnosis.alternatives.is_empty() {
        let rest = match locked {
            Some(locked) => format!(" {percent} % stay unexplained: {locked}."),
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
    if outcome.stopped && !diagnosis.causes.is_empty() {
        diagnosis.reason = format!("{} {stopped}", diagnosis.reason);
    }
    if !matches!(diagnosis.verdict, Verdict::Ambiguous) {
        diagnosis.alternatives.clear();
        diagnosis.experiments.clear();
    }
}

/// Where the noise is known and the residual is clearly above it: which part of the discrepancy that is, and a clause that says so.
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

/// Sum of the squared autocorrelations: by so much the variance of a mean square is larger than that of white noise.
fn memory(x: &[f64]) -> f64 {
    let whole = dot(x, x);
    let at = |lag: usize| dot(&x[lag..], &x[..x.len() - lag]) / whole;
    1.0 + 2.0
        * (1..(x.len() / 10).min(100))
            .map(|lag| at(lag).powi(2))
            .sum::<f64>()
}

/// Scores on the test part. It changes the verdict only where the test part contradicts it.
fn open_test(
    problem: &Problem,
    before: &Columns,
    base: &Fit,
    last: &Fit,
    bound: &Bound,
    diagnosis: &mut Diagnosis,
) {
    let test = &problem.split.test;
    let nominal = rms(&problem.data.residual(before), test);
    let (refitted, after) = (rms(&base.residual, test), rms(&last.residual, test));
    diagnosis.channels = channel_errors(problem, &nominal, &refitted, &after, &bound.floor);
    if diagnosis.verdict == Verdict::FitFailed {
        return;
    }
    let paired = compare(&base.residual, &last.residual, &last.noise, test);
    // Before the test part is called different, what the part before leaves uncertain is settled by both together.
    let all = problem.split.development.joined(test);
    let orders: Vec<usize> = last.noise.channels.iter().map(|c| c.ar.len()).collect();
    let refitted_to_all = fit(problem, last.point.clone(), &all, &orders, true);
    let settled = refitted_to_all.unwrap_or_else(|_| last.clone());
    let worse = !last.point.effects.is_empty() && paired.t() < -2.0;
    if worse || breaks_away(problem, &settled) {
        diagnosis.verdict = Verdict::UnknownCause;
        diagnosis.alternatives.clear();
        diagnosis.experiments.clear();
        diagnosis.reason = format!(
            "In the last part of the data, from {} s on, there is a discrepancy that the part before does not have.",
            truecut_recording::significant(problem.data.time_s[first_of(test)], 4)
        );
    }
}

fn first_of(rows: &Rows) -> usize {
    rows.per_channel
        .iter()
        .filter_map(|rows| rows.first().copied())
        .min()
        .unwrap_or(0)
}

/// Whether the error on the test part is clearly larger than before it: whitened, or as it is about its mean. Slow noise wanders, so
/// a mean alone must be far away.
fn breaks_away(problem: &Problem, last: &Fit) -> bool {
    let (before, test) = (&problem.split.development, &problem.split.test);
    (0..last.residual.len()).any(|c| {
        let single = Noise {
            channels: vec![last.noise.channels[c].clone()],
        };
        let column = vec![last.residual[c].clone()];
        let pick = |rows: &Rows| -> Rows {
            Rows {
                per_channel: vec![rows.per_channel[c].clone()],
            }
        };
        let whitened = |rows: &Rows| single.whiten(&column, &pick(rows));
        let plain = |rows: &Rows| -> Vec<f64> {
            rows.per_channel[c].iter().map(|&t| column[0][t]).collect()
        };
        let (a, b) = (plain(before), plain(test));
        is_larger(&whitened(before), &whitened(test), 6.0, 1.25)
            || is_larger(&centred(&a), &centred(&b), 8.0, 4.0)
            || is_larger(&a, &b, 8.0, 12.0)
    })
}

fn centred(x: &[f64]) -> Vec<f64> {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|x| x - mean).collect()
}

/// A sample's square counts for at most so many times the mean square.
const SINGLE: f64 = 16.0;

/// Whether the mean square is larger by the ratio, and by so many standard errors. In noise alone both errors are alike up to their
/// lengths; where the later part is unlike, its own error is larger.
fn is_larger(before: &[f64], after: &[f64], least: f64, ratio: f64) -> bool {
    let (n, m) = (before.len() as f64, after.len() as f64);
    // One sample about which an event comes a step early is no discrepancy of the whole part.
    let most = SINGLE * dot(before, before) / n;
    let squares = |x: &[f64]| -> Vec<f64> { x.iter().map(|x| (x * x).min(most)).collect() };
    let expected = error_of_sum(&batch_sums(&squares(before))) / n * (n / m).sqrt();
    let mean = |x: &[f64]| squares(x).iter().sum::<f64>() / x.len() as f64;
    let (a, b) = (mean(before), mean(after));
    b > ratio * a && b - a > least * expected
}

fn channel_errors(
    problem: &Problem,
    nominal: &[f64],
    refitted: &[f64],
    after: &[f64],
    floor: &[f64],
) -> BTreeMap<String, ChannelErrors> {
    let specs = problem.model.channels().iter().enumerate();
    specs
        .map(|(c, spec)| {
            let errors = ChannelErrors {
                before: nominal[c],
                refitted: refitted[c],
                after: after[c],
                noise_floor: problem.data.outputs[c].noise.unwrap_or(floor[c]),
                unit: spec.unit.to_string(),
            };
            (spec.name.clone(), errors)
        })
        .collect()
}

/// What a flexible predictor still explains, as a part of that and what the effects explain.
fn unexplained(problem: &Problem, base: &Fit, last: &Fit, bound: &Bound) -> f64 {
    let rows = &problem.split.development;
    let orders: Vec<usize> = last.noise.channels.iter().map(|c| c.ar.len()).collect();
    let noise = Noise::fit(&bound.left, rows, &orders, &problem.floor);
    let named = compare(&base.residual, &last.residual, &noise, rows)
        .gain
        .max(0.0);
    if bound.gain <= 0.0 {
        0.0
    } else {
        bound.gain / (named + bound.gain)
    }
}
