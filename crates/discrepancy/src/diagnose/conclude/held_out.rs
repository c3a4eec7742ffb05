//! Causes that the held-out part does not bear out.

use super::test_part::part_of;
use crate::diagnose::answer::{Cause, Diagnosis, Verdict, names};
use crate::diagnose::choice::LEAST_T;
use crate::diagnose::data::Rows;
use crate::diagnose::fit::Fit;
use crate::diagnose::problem::{Point, Problem};
use crate::diagnose::starts::without;
use crate::diagnose::validate::{batch_sums, error_of_sum, rms};
use crate::model::PredictError;

/// The model with what is left of its causes, and the names of those taken away, with the channel
/// in which each makes most worse and its errors without and with it.
pub(super) struct Kept {
    pub last: Fit,
    pub refuted: Vec<Refuted>,
}

/// A cause that makes held-out data worse.
pub(super) struct Refuted {
    name: String,
    channel: usize,
    without: f64,
    with: f64,
}

/// Of what a cause does, a held-out part that contradicts it shows no more than this. Half is where
/// an error neither rises nor falls; a pattern out of step by 60 degrees shows half of itself, too,
/// and is there.
const MOST_SHOWN: f64 = 0.25;

/// Takes away, one after the other, causes without which the held-out part is predicted better: an
/// error that is whitened may say otherwise, where the noise's memory has taken a part of the
/// pattern for noise.
pub(super) fn kept(
    problem: &Problem,
    base: &Fit,
    mut last: Fit,
    to_all: impl Fn(&Point) -> Result<Fit, PredictError>,
) -> Kept {
    let mut refuted = Vec::new();
    'again: loop {
        let count = last.point.effects.len();
        for index in 0..count {
            let small = match count {
                1 => base.clone(),
                _ => match to_all(&without(&last.point, index)) {
                    Ok(small) => small,
                    Err(_) => continue,
                },
            };
            if let Some((channel, errors)) = worse(problem, &small, &last) {
                let mut alone = last.point.clone();
                alone.effects = vec![last.point.effects[index].clone()];
                refuted.push(Refuted {
                    name: names(problem, &alone).join(" + "),
                    channel,
                    without: errors[0],
                    with: errors[1],
                });
                last = small;
                continue 'again;
            }
        }
        return Kept { last, refuted };
    }
}

/// The channel in which the larger model raises the held-out error most, with both errors, if it
/// raises one and lowers none by what is worth naming, that is no chance, and little of what the
/// cause does shows there: a pattern that is there, and only out of step or of another
/// size, contradicts no cause.
fn worse(problem: &Problem, small: &Fit, large: &Fit) -> Option<(usize, [f64; 2])> {
    let test = &problem.split.test;
    let [before, after] = [small, large].map(|fit| rms(&fit.residual, test));
    let least = problem.options.min_gain;
    let channels = 0..before.len();
    if (channels.clone()).any(|c| after[c] < (1.0 - least) * before[c]) {
        return None;
    }
    let rise = |c: &usize| after[*c] / before[*c].max(f64::MIN_POSITIVE);
    let most = (channels.clone()).max_by(|a, b| rise(a).total_cmp(&rise(b)))?;
    let clear = rise(&most) > 1.0 + least && risen(test, most, small, large) > LEAST_T;
    let contradicts = clear && shown(problem, small, large) < MOST_SHOWN;
    contradicts.then(|| (most, [before[most], after[most]]))
}

/// What the held-out part shows of what the cause does, at most: the part of it that fits best what
/// the smaller model leaves there, and its standard error. All channels, each in units of what is
/// left of it.
fn shown(problem: &Problem, small: &Fit, large: &Fit) -> f64 {
    let test = &problem.split.test;
    let (mut along, mut squares) = (Vec::new(), Vec::new());
    for (channel, size) in rms(&small.residual, test).into_iter().enumerate() {
        let [small, large] = [small, large].map(|fit| &fit.residual[channel]);
        for &t in test.per_channel[channel].iter().filter(|_| size > 0.0) {
            let done = small[t] - large[t];
            along.push(small[t] * done / size.powi(2));
            squares.push(done.powi(2) / size.powi(2));
        }
    }
    let whole = squares.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let part = along.iter().sum::<f64>() / whole;
    let left = along.iter().zip(&squares).map(|(a, s)| a - part * s);
    part + error_of_sum(&batch_sums(&left.collect::<Vec<_>>())) / whole
}

/// By how many standard errors the squares of a channel rise.
fn risen(test: &Rows, channel: usize, small: &Fit, large: &Fit) -> f64 {
    let squares = |fit: &Fit, t: usize| fit.residual[channel][t].powi(2);
    let rises: Vec<f64> = (test.per_channel[channel].iter())
        .map(|&t| squares(large, t) - squares(small, t))
        .collect();
    let sums = batch_sums(&rises);
    sums.iter().sum::<f64>() / error_of_sum(&sums).max(f64::MIN_POSITIVE)
}

/// The causes and the others that explain as much, by name: they do not stand beside the verdict.
fn either(diagnosis: &Diagnosis) -> String {
    let name = |cause: &Cause| match &cause.target {
        Some(target) => format!("{} on {target}", cause.kind),
        None => cause.kind.clone(),
    };
    let others = diagnosis.alternatives.iter().map(|one| &one.causes);
    let all = std::iter::once(&diagnosis.causes).chain(others);
    let names = all.map(|causes| causes.iter().map(name).collect::<Vec<_>>().join(" and "));
    names.collect::<Vec<_>>().join(" or ")
}

/// The finding in the verdict: what the search came to, and why it is not named.
pub(super) fn tell(problem: &Problem, refuted: &[Refuted], diagnosis: &mut Diagnosis) {
    if refuted.is_empty() || diagnosis.verdict == Verdict::FitFailed {
        return;
    }
    let told: Vec<String> = (refuted.iter())
        .map(|one| {
            let spec = &problem.model.channels()[one.channel];
            let number = |x: f64| truecut_recording::significant(x, 3);
            format!(
                "{} (`{}` {} without it, {} {} with it)",
                one.name,
                spec.name,
                number(one.without),
                number(one.with),
                spec.unit
            )
        })
        .collect();
    let from = part_of(problem);
    let contradicted = format!(
        "The last part of the data, from {from} s on, contradicts {}, which the part before asks for: not named.",
        told.join(" and ")
    );
    let others = match diagnosis.verdict {
        Verdict::Ambiguous => format!(" Of the rest it is not known which: {}.", either(diagnosis)),
        Verdict::UnknownCause => format!(" {}", diagnosis.reason),
        _ if diagnosis.causes.is_empty() => String::new(),
        _ => format!(" {}", diagnosis.reason),
    };
    diagnosis.reason = format!("{contradicted}{others}");
    diagnosis.verdict = Verdict::UnknownCause;
    diagnosis.missing.clear();
    diagnosis.unexplained_fraction = match diagnosis.causes.is_empty() {
        true => 1.0,
        false => diagnosis.unexplained_fraction,
    };
    diagnosis.alternatives.clear();
    diagnosis.further.clear();
    diagnosis.experiments.clear();
    diagnosis.runner_up = None;
}
