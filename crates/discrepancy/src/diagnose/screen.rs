//! Screening: what each candidate would add to the present model, from its signature.

use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::data::Rows;
use super::derivatives::difference;
use super::fit::Fit;
use super::noise::{LinearFit, Prior, dot, fit_linear, solve};
use super::problem::{Found, Problem};
use super::signature::{Signature, with};
use crate::model::Columns;

/// A candidate with what it would gain.
#[derive(Debug, Clone)]
pub(super) struct Ranked {
    pub signature: Signature,
    /// Values to start a fit from.
    pub start: Vec<f64>,
    /// The same with other shape parameters, where these promise half as much; at most two.
    pub others: Vec<Vec<f64>>,
    /// Fall of minus twice the log-likelihood.
    pub gain: f64,
}

impl Ranked {
    pub fn candidate(&self) -> usize {
        self.signature.candidate
    }

    /// The gain less what as many parameters gain from pure noise in the long run (BIC).
    pub fn net(&self, n: f64) -> f64 {
        self.gain - self.start.len() as f64 * n.ln()
    }
}

/// Columns that the present model can move by itself, with what is known of them.
pub(super) fn nuisance<'a>(problem: &Problem, base: &'a Fit) -> (Vec<&'a Columns>, Vec<Prior>) {
    let variables = problem.variables(&base.point);
    (
        base.jacobian.iter().collect(),
        variables.iter().map(|v| v.prior).collect(),
    )
}

/// Those columns with what is known of them, and the fit of them alone.
fn without_candidates<'a>(
    problem: &Problem,
    base: &'a Fit,
    rows: &Rows,
    orders: &[usize],
) -> (Vec<&'a Columns>, Vec<Prior>, LinearFit) {
    let (columns, priors) = nuisance(problem, base);
    let zero = fit_linear(
        &base.residual,
        &columns,
        &priors,
        rows,
        &base.noise,
        orders,
        &problem.floor,
    );
    (columns, priors, zero)
}

/// What each signature would gain on the rows, the best of each candidate that the point does not
/// hold, best first.
pub(super) fn rank(
    problem: &Problem,
    base: &Fit,
    signatures: &[Signature],
    rows: &Rows,
    orders: &[usize],
) -> Vec<Ranked> {
    let (columns, priors, zero) = without_candidates(problem, base, rows, orders);
    let ranked: Vec<Ranked> = signatures
        .par_iter()
        .filter(|signature| !base.point.holds(signature.candidate))
        .map(|signature| {
            let (gain, start) = gain(
                problem,
                base,
                signature,
                &columns,
                &priors,
                rows,
                orders,
                zero.objective,
            );
            Ranked {
                signature: signature.clone(),
                start,
                others: Vec::new(),
                gain,
            }
        })
        .collect();
    let n = rows.len() as f64;
    let mut best: Vec<Ranked> = Vec::new();
    for candidate in 0..problem.candidates.len() {
        let mut own: Vec<&Ranked> = ranked
            .iter()
            .filter(|r| r.candidate() == candidate)
            .collect();
        own.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let Some(first) = own.first() else { continue };
        // Where a fit starts matters for shapes, and for sizes whose kind says where to start.
        let shape = |r: &Ranked| -> Vec<f64> {
            let all = r.signature.values.iter().zip(problem.infos(candidate));
            all.filter(|(_, info)| !info.is_size || !info.starts.is_empty())
                .map(|(x, _)| *x)
                .collect()
        };
        let others = own
            .iter()
            .filter(|r| r.gain > 0.5 * first.gain && shape(r) != shape(first));
        best.push(Ranked {
            others: others.take(2).map(|r| r.start.clone()).collect(),
            ..(*first).clone()
        });
    }
    best.sort_by(|a, b| b.net(n).total_cmp(&a.net(n)));
    best
}

#[expect(clippy::too_many_arguments, reason = "the inner loop of `rank`")]
fn gain(
    problem: &Problem,
    base: &Fit,
    signature: &Signature,
    nuisance: &[&Columns],
    priors: &[Prior],
    rows: &Rows,
    orders: &[usize],
    zero: f64,
) -> (f64, Vec<f64>) {
    let infos = problem.infos(signature.candidate);
    let mut used: Vec<usize> = (0..signature.sizes.len()).collect();
    let mut start = signature.values.clone();
    for &i in &signature.sizes {
        start[i] = infos[i].neutral;
    }
    // A size that comes out on the wrong side of its bound is not there; what is left is fitted
    // again.
    while !used.is_empty() {
        let mut design: Vec<&Columns> = used.iter().map(|&j| &signature.columns[j]).collect();
        design.extend(nuisance);
        let mut all = vec![Prior::default(); used.len()];
        all.extend(priors);
        let LinearFit {
            coefficients,
            objective,
            ..
        } = fit_linear(
            &base.residual,
            &design,
            &all,
            rows,
            &base.noise,
            orders,
            &problem.floor,
        );
        let size = |position: usize| {
            let i = signature.sizes[used[position]];
            let secant = signature.values[i] - infos[i].neutral;
            (i, infos[i].neutral + coefficients[position] * secant)
        };
        let outside = (0..used.len()).find(|&p| {
            let (i, value) = size(p);
            value <= infos[i].min && infos[i].neutral - infos[i].min <= 0.0
        });
        if let Some(position) = outside {
            used.remove(position);
            continue;
        }
        for position in 0..used.len() {
            let (i, value) = size(position);
            start[i] = value.clamp(infos[i].min, infos[i].max);
        }
        return ((zero - objective).max(0.0), start);
    }
    (0.0, start)
}

/// Takes the signatures of the best anew at the sizes that were found: what is not linear looks
/// different there.
pub(super) fn refine(
    problem: &Problem,
    base: &Fit,
    mut ranked: Vec<Ranked>,
    rows: &Rows,
    orders: &[usize],
    count: usize,
) -> Vec<Ranked> {
    let (columns, priors, zero) = without_candidates(problem, base, rows, orders);
    let count = count.min(ranked.len());
    ranked[..count].par_iter_mut().for_each(|entry| {
        let infos = problem.infos(entry.candidate());
        for _ in 0..2 {
            let (candidate, values) = (entry.candidate(), entry.start.clone());
            let found = Found { candidate, values };
            let Ok(predicted) = problem.predict(&with(&base.point, found)) else {
                return;
            };
            let column = difference(&predicted, &base.predicted, 1.0);
            let mut design = vec![&column];
            design.extend(&columns);
            let mut all = vec![Prior::default()];
            all.extend(&priors);
            let fit = fit_linear(
                &base.residual,
                &design,
                &all,
                rows,
                &base.noise,
                orders,
                &problem.floor,
            );
            let factor = fit.coefficients[0].clamp(0.2, 5.0);
            let gain = (zero.objective - fit.objective).max(0.0);
            // At the size itself the change is no extrapolation, so it counts even where it is
            // less.
            let near = (fit.coefficients[0] - 1.0).abs() < 0.3;
            if near || gain > entry.gain {
                entry.gain = gain;
            }
            for &i in &entry.signature.sizes {
                let value = infos[i].neutral + factor * (entry.start[i] - infos[i].neutral);
                entry.start[i] = value.clamp(infos[i].min, infos[i].max);
            }
            if near {
                break;
            }
        }
    });
    let n = rows.len() as f64;
    ranked.sort_by(|a, b| b.net(n).total_cmp(&a.net(n)));
    ranked
}

/// The gain that pure noise exceeds with probability `alpha` in any of `tests` tests.
pub(super) fn critical(alpha: f64, tests: usize, dof: usize) -> f64 {
    let tail = alpha / tests.max(1) as f64;
    ChiSquared::new(dof.max(1) as f64)
        .map(|d| d.inverse_cdf(1.0 - tail))
        .unwrap_or(f64::INFINITY)
}

/// A whitened column less what the nuisance columns can do.
pub(super) fn projected(column: &[f64], nuisance: &[Vec<f64>], priors: &[Prior]) -> Vec<f64> {
    // Of the prior only its width matters here.
    let centred: Vec<Prior> = priors.iter().map(|p| Prior { offset: 0.0, ..*p }).collect();
    let coefficients = solve(column, nuisance, &centred);
    let mut left = column.to_vec();
    for (x, b) in nuisance.iter().zip(&coefficients) {
        for (l, x) in left.iter_mut().zip(x) {
            *l -= b * x;
        }
    }
    left
}

/// Angle in degrees between the spaces of two sets of whitened, projected columns (the smallest
/// principal one for single columns).
pub(super) fn angle_deg(a: &[f64], b: &[f64]) -> f64 {
    let norms = (dot(a, a) * dot(b, b)).sqrt();
    if norms <= 0.0 {
        return 90.0;
    }
    (dot(a, b).abs() / norms).min(1.0).acos().to_degrees()
}
