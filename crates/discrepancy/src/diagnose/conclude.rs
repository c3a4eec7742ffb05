//! From the end of the search to the answer.

use std::collections::BTreeMap;

use super::ambiguity::{Rival, experiments, rivals};
use super::answer::{
    Alternative, Cause, Ceiling, ChannelErrors, Diagnosis, Evidence, Nominal, Parameter,
    SmallestSeen, VERSION, Verdict, Work, key_and_unit, target_name,
};
use super::ceiling::{Bound, bound};
use super::data::Rows;
use super::fit::{Fit, fit};
use super::noise::{Noise, dot};
use super::problem::{Found, Problem};
use super::screen::{Ranked, critical, nuisance, projected};
use super::search::{LEAST_T, Outcome, without};
use super::uncertainty::standard_errors;
use super::validate::{batch_sums, compare, error_of_sum, rms};
use super::{Answer, DiagnoseError, Stage};
use crate::model::Columns;

/// Normal quantile of a two-sided 95 % interval.
const Z95: f64 = 1.959_964;
/// Normal quantile of a one-sided 95 % probability.
const Z95_ONE_SIDED: f64 = 1.644_854;
/// An effect is within reach up to so many times its typical size.
const REACH: f64 = 3.0;
/// Where the noise is known: least ratio of the residual's variance to it that counts.
const EXCESS: f64 = 1.25;
/// With less than this part of the candidates within reach the experiment is too poor.
const LEAST_VISIBLE: f64 = 0.1;

/// The answer where nothing moves.
pub(super) fn not_excited(problem: &Problem, before: Columns, missing: Vec<String>) -> Answer {
    let mut diagnosis = empty(problem);
    diagnosis.verdict = Verdict::NotIdentifiable;
    diagnosis.reason = "No output moves beyond its noise: nothing can be told apart.".into();
    diagnosis.missing = missing;
    let residual = problem.data.residual(&before);
    let errors = rms(&residual, &problem.split.test);
    diagnosis.channels = channel_errors(problem, &errors, &errors, &errors, &residual);
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
    let last = fit(
        problem,
        outcome.chosen.point.clone(),
        development,
        &outcome.orders,
        true,
    )?;
    let base = fit(
        problem,
        outcome.base.point.clone(),
        development,
        &outcome.orders,
        true,
    )?;
    problem.report(Stage::Ceiling);
    let bound = bound(problem, &last.predicted, &last.residual, &last.noise);
    let mut diagnosis = empty(problem);
    diagnosis.ceiling = bound.ceiling.clone();
    diagnosis.smallest_seen = smallest_seen(problem, &outcome);
    diagnosis.unexplained_fraction = unexplained(problem, &base, &last, &bound);
    let errors = standard_errors(problem, &last, development)?;
    diagnosis.causes = causes(problem, &last, &errors)?;
    diagnosis.nominal = nominal(problem, &last, &errors);
    let rivals = match last.point.effects.is_empty() {
        true => Vec::new(),
        false => rivals(problem, &outcome),
    };
    let rival_answers = rivals
        .iter()
        .take(6)
        .map(|r| alternative(problem, r))
        .collect::<Result<Vec<_>, _>>()?;
    diagnosis.runner_up = rival_answers.first().cloned();
    let as_good = rival_answers
        .into_iter()
        .zip(&rivals)
        .filter(|(_, r)| r.as_good);
    diagnosis.alternatives = as_good.map(|(a, _)| a).collect();
    if let Some(rival) = rivals.iter().find(|r| r.as_good) {
        diagnosis.experiments = experiments(problem, &outcome.chosen, &rival.fit);
    }
    judge(problem, &outcome, &last, &mut diagnosis);
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

/// The verdict, before the test part is opened.
fn judge(problem: &Problem, outcome: &Outcome, last: &Fit, diagnosis: &mut Diagnosis) {
    let excess = excess(problem, last);
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
    (diagnosis.verdict, diagnosis.reason) = if outcome.failed {
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
    if !matches!(diagnosis.verdict, Verdict::Ambiguous) {
        diagnosis.alternatives.clear();
        diagnosis.experiments.clear();
    }
}

/// Where the noise is known and the residual is clearly above it: which part of the discrepancy that is, and a clause that says so.
fn excess(problem: &Problem, last: &Fit) -> Option<(f64, String)> {
    let rows = &problem.split.development;
    let nominal = problem
        .data
        .residual(&problem.predict(&problem.start()).ok()?);
    let mut most: Option<(f64, String)> = None;
    for (c, output) in problem.data.outputs.iter().enumerate() {
        let Some(noise) = output.noise else { continue };
        let rows = &rows.per_channel[c];
        let squares: Vec<f64> = rows.iter().map(|&t| last.residual[c][t].powi(2)).collect();
        let n = rows.len() as f64;
        let (mean, error) = (
            squares.iter().sum::<f64>() / n,
            error_of_sum(&batch_sums(&squares)) / n,
        );
        let variance = noise * noise;
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
    diagnosis.channels = channel_errors(problem, &nominal, &refitted, &after, &bound.left);
    if diagnosis.verdict == Verdict::FitFailed {
        return;
    }
    let paired = compare(&base.residual, &last.residual, &last.noise, test);
    let worse = !last.point.effects.is_empty() && paired.t() < -2.0;
    if worse || breaks_away(problem, last) {
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

/// Whether the error on the test part is clearly larger than before it, whitened or as it is.
fn breaks_away(problem: &Problem, last: &Fit) -> bool {
    let (before, test) = (&problem.split.development, &problem.split.test);
    let white = Noise::white(&last.residual, before, &problem.floor);
    (0..last.residual.len()).any(|c| {
        let excess = |noise: &Noise, least: f64, ratio: f64| {
            let squares = |rows: &Rows| -> Vec<f64> {
                let single = Noise {
                    channels: vec![noise.channels[c].clone()],
                };
                let rows = Rows {
                    per_channel: vec![rows.per_channel[c].clone()],
                };
                let e = single.whiten(&vec![last.residual[c].clone()], &rows);
                e.iter().map(|x| x * x).collect()
            };
            let (a, b) = (squares(before), squares(test));
            let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
            let error = |x: &[f64]| error_of_sum(&batch_sums(x)) / x.len() as f64;
            // In noise alone both errors are alike up to their lengths; where the test part is unlike, its own error is larger.
            let expected = error(&a) * (a.len() as f64 / b.len() as f64).sqrt();
            mean(&b) > ratio * mean(&a) && mean(&b) - mean(&a) > least * expected
        };
        excess(&last.noise, 6.0, 1.25) || excess(&white, 8.0, 2.0)
    })
}

fn channel_errors(
    problem: &Problem,
    nominal: &[f64],
    refitted: &[f64],
    after: &[f64],
    left: &Columns,
) -> BTreeMap<String, ChannelErrors> {
    let floor = rms(left, &problem.split.development);
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

fn causes(
    problem: &Problem,
    fit: &Fit,
    errors: &[Option<f64>],
) -> Result<Vec<Cause>, DiagnoseError> {
    let mut position = problem.nominal.len();
    let mut causes = Vec::new();
    for (i, found) in fit.point.effects.iter().enumerate() {
        let own = &errors[position..position + found.values.len()];
        position += found.values.len();
        let evidence = evidence(problem, fit, i)?;
        causes.push(cause(problem, found, own, evidence));
    }
    Ok(causes)
}

fn cause(problem: &Problem, found: &Found, errors: &[Option<f64>], evidence: Evidence) -> Cause {
    let candidate = &problem.candidates[found.candidate];
    let infos = problem.infos(found.candidate);
    let parameters = found
        .values
        .iter()
        .zip(errors)
        .enumerate()
        .map(|(i, (value, error))| {
            let (key, unit) = key_and_unit(problem, found.candidate, i);
            let parameter = Parameter {
                value: *value,
                low: error.map(|e| (value - Z95 * e).max(infos[i].min)),
                high: error.map(|e| (value + Z95 * e).min(infos[i].max)),
                unit,
            };
            (key, parameter)
        });
    Cause {
        kind: candidate.kind.name().into(),
        target: target_name(candidate),
        parameters: parameters.collect(),
        evidence,
    }
}

/// What is lost without one of the effects, the others fitted anew.
fn evidence(problem: &Problem, full: &Fit, index: usize) -> Result<Evidence, DiagnoseError> {
    let orders: Vec<usize> = full.noise.channels.iter().map(|c| c.ar.len()).collect();
    let rows = &problem.split.development;
    let small = fit(problem, without(&full.point, index), rows, &orders, true)?;
    let paired = compare(
        &small.residual,
        &full.residual,
        &full.noise,
        &problem.split.validation,
    );
    Ok(Evidence {
        likelihood_gain: small.objective - full.objective,
        validation_t: paired.t(),
        practical_gain: paired.practical,
    })
}

fn nominal(problem: &Problem, fit: &Fit, errors: &[Option<f64>]) -> Vec<Nominal> {
    let rows = problem.nominal.iter().zip(&fit.point.nominal).zip(errors);
    rows.map(|((parameter, value), error)| Nominal {
        key: parameter.key.clone(),
        before: parameter.value,
        after: Parameter {
            value: *value,
            low: error.map(|e| value - Z95 * e),
            high: error.map(|e| value + Z95 * e),
            unit: parameter.unit_text.clone(),
        },
    })
    .collect()
}

fn alternative(problem: &Problem, rival: &Rival) -> Result<Alternative, DiagnoseError> {
    let errors = standard_errors(problem, &rival.fit, &problem.split.train)?;
    Ok(Alternative {
        causes: causes(problem, &rival.fit, &errors)?,
        angle_deg: rival.angle_deg,
        behind_t: rival.behind_t,
        criterion_difference: rival.criterion_difference,
    })
}

/// For each size of each candidate: what would have been detected, and would have been worth naming, with 95 % probability.
fn smallest_seen(problem: &Problem, outcome: &Outcome) -> Vec<SmallestSeen> {
    let (fit, split) = (&outcome.chosen, &problem.split);
    let (columns, priors) = nuisance(problem, fit);
    let norm = |change: &Columns, rows: &Rows| {
        let columns: Vec<_> = columns.iter().map(|x| fit.noise.whiten(x, rows)).collect();
        let left = projected(&fit.noise.whiten(change, rows), &columns, &priors);
        dot(&left, &left).sqrt()
    };
    let level = rms(&fit.residual, &split.train);
    // A gain of `norm^2` on the validation blocks has the standard error `2 norm`.
    let validation = 2.0 * (LEAST_T + Z95_ONE_SIDED);
    let practical = ((1.0 + problem.options.min_gain).powi(2) - 1.0).sqrt();
    let mut all = Vec::new();
    for Ranked { signature, .. } in &outcome.ranking {
        let infos = problem.infos(signature.candidate);
        let alpha = problem.options.family_wise_error;
        let detection = critical(alpha, outcome.tests, infos.len()).sqrt() + Z95_ONE_SIDED;
        for (&size, change) in signature.sizes.iter().zip(&signature.columns) {
            let info = &infos[size];
            let secant = (signature.values[size] - info.neutral).abs();
            let seen = rms(change, &split.train)
                .iter()
                .zip(&level)
                .map(|(a, b)| a / b)
                .fold(0.0, f64::max);
            let factors = [
                detection / norm(change, &split.train),
                validation / norm(change, &split.validation),
                practical / seen,
            ];
            let needed = secant * factors.into_iter().fold(0.0, f64::max);
            let room = (info.max - info.neutral).max(info.neutral - info.min);
            let (parameter, unit) = key_and_unit(problem, signature.candidate, size);
            all.push(SmallestSeen {
                kind: problem.candidates[signature.candidate].kind.name().into(),
                target: target_name(&problem.candidates[signature.candidate]),
                parameter,
                size: (needed <= room).then_some(needed),
                unit,
            });
        }
    }
    all.sort_by(|a, b| (&a.kind, &a.target, &a.parameter).cmp(&(&b.kind, &b.target, &b.parameter)));
    all
}

/// Part of the sizes that are within reach of the experiment.
fn visible(problem: &Problem, seen: &[SmallestSeen]) -> f64 {
    if seen.is_empty() {
        return 0.0;
    }
    let hidden = invisible(problem, seen).len();
    1.0 - hidden as f64 / seen.len() as f64
}

fn invisible(problem: &Problem, seen: &[SmallestSeen]) -> Vec<String> {
    let reach = |entry: &SmallestSeen| {
        let candidate = problem
            .candidates
            .iter()
            .position(|c| c.kind.name() == entry.kind && target_name(c) == entry.target)?;
        let infos = problem.infos(candidate);
        let index =
            (0..infos.len()).find(|&i| key_and_unit(problem, candidate, i).0 == entry.parameter)?;
        Some(REACH * problem.candidates[candidate].scale[index])
    };
    let hidden = seen.iter().filter(|e| match (e.size, reach(e)) {
        (Some(size), Some(reach)) => size > reach,
        _ => true,
    });
    hidden
        .map(|e| {
            let target = e
                .target
                .as_deref()
                .map(|t| format!(" {t}"))
                .unwrap_or_default();
            format!(
                "{}{target} (`{}`) would be seen at no typical size",
                e.kind, e.parameter
            )
        })
        .collect()
}
