//! Screening: what each candidate would add to the present model, from its signature.

use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::body::placed;
use super::derivatives::difference;
use super::fit::Fit;
use super::moments::solve;
use super::noise::{LinearFit, Noise, Prior, add_column, dot, fit_linear};
use super::problem::{Found, Problem};
use super::signature::{Signature, with};
use crate::model::Columns;

/// A candidate with what it would gain.
#[derive(Debug, Clone)]
pub(super) struct Ranked {
    pub signature: Signature,
    /// Values to start a fit from.
    pub start: Vec<f64>,
    /// The same with other shape parameters, where these promise half as much, at most two; and a
    /// size as its signature was taken.
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

/// So often a size at which nothing can be predicted is brought nearer to one at which it could.
const NEARER: usize = 4;

/// A model that one more effect may extend, and what it explains by itself of the training rows.
pub(super) struct Extension<'a> {
    pub(super) problem: &'a Problem<'a>,
    pub(super) base: &'a Fit,
    pub(super) orders: &'a [usize],
    pub(super) nuisance: Vec<&'a Columns>,
    pub(super) priors: Vec<Prior>,
    /// Minus twice its log-likelihood.
    pub(super) zero: f64,
}

/// What each signature would gain on the training rows, the best of each candidate that the point
/// does not hold, best first; the signatures of the best taken anew at the sizes that were found:
/// what is not linear looks different there.
pub(super) fn rank(
    problem: &Problem,
    base: &Fit,
    signatures: &[Signature],
    orders: &[usize],
    refined: usize,
) -> Vec<Ranked> {
    let extension = Extension::new(problem, base, orders);
    let ranked: Vec<Ranked> = signatures
        .par_iter()
        .filter(|signature| !base.point.holds(signature.candidate))
        .map(|signature| extension.ranked(signature))
        .collect();
    let mut best: Vec<Ranked> = (problem.searched())
        .filter_map(|candidate| extension.best_of(candidate, &ranked))
        .collect();
    let n = problem.split.train.len() as f64;
    best.sort_by(|a, b| b.net(n).total_cmp(&a.net(n)));
    let count = refined.min(best.len());
    (best[..count].par_iter_mut()).for_each(|entry| extension.refine(entry));
    best.sort_by(|a, b| b.net(n).total_cmp(&a.net(n)));
    best
}

impl<'a> Extension<'a> {
    fn new(problem: &'a Problem, base: &'a Fit, orders: &'a [usize]) -> Extension<'a> {
        let (nuisance, priors) = nuisance(problem, base);
        let mut extension = Extension {
            problem,
            base,
            orders,
            nuisance,
            priors,
            zero: 0.0,
        };
        extension.zero = extension.fit(&[]).objective;
        extension
    }

    /// The residual by columns of which nothing is known beforehand and those of the model itself.
    pub(super) fn fit(&self, own: &[&Columns]) -> LinearFit {
        let mut priors = vec![Prior::default(); own.len()];
        priors.extend(&self.priors);
        fit_linear(
            &self.base.residual,
            &[own, &self.nuisance].concat(),
            &priors,
            &self.problem.split.train,
            &self.base.noise,
            self.orders,
            &self.problem.floor,
        )
    }

    /// The best of a candidate, with starts of other shapes.
    fn best_of(&self, candidate: usize, ranked: &[Ranked]) -> Option<Ranked> {
        let own = ranked.iter().filter(|r| r.candidate() == candidate);
        let mut own: Vec<&Ranked> = own.collect();
        own.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let first = *own.first()?;
        // Where a fit starts matters for shapes, and for sizes whose kind says where to start.
        let shape = |r: &Ranked| -> Vec<f64> {
            let all = r.signature.values.iter().zip(self.problem.infos(candidate));
            all.filter(|(_, info)| !info.is_size || !info.starts.is_empty())
                .map(|(x, _)| *x)
                .collect()
        };
        let others = own
            .iter()
            .filter(|r| r.gain > 0.5 * first.gain && shape(r) != shape(first));
        let as_taken = self.as_taken(&own, first);
        let others = others.take(2).map(|r| r.start.clone());
        Some(Ranked {
            others: as_taken.into_iter().chain(others).collect(),
            ..first.clone()
        })
    }

    /// The size of a signature as it was taken, where that itself explains more than the first is
    /// to gain: a change that is not linear, as by play, may be larger or smaller than needed at
    /// every part of it, and a fit from there ends at another optimum. Of kinds that say where to
    /// start.
    fn as_taken(&self, own: &[&Ranked], first: &Ranked) -> Option<Vec<f64>> {
        let (problem, train) = (self.problem, &self.problem.split.train);
        let white =
            |residual: &Columns| Noise::white(residual, train, &problem.floor).objective(train);
        let infos = problem.infos(first.candidate());
        let left = |ranked: &&&Ranked| -> Option<f64> {
            let signature = &ranked.signature;
            let (&[size], [column]) = (&*signature.sizes, &*signature.columns) else {
                return None;
            };
            let says = !infos[size].starts.is_empty();
            says.then(|| white(&difference(&self.base.residual, column, 1.0)))
        };
        let taken = own.iter().filter_map(|one| Some((left(&one)?, *one)));
        let (left, best) = taken.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let gain = white(&self.base.residual) - left;
        let is_more = gain > first.gain && best.signature.values != first.start;
        is_more.then(|| best.signature.values.clone())
    }

    /// A signature's gain, and the sizes at which it gains that.
    fn ranked(&self, signature: &Signature) -> Ranked {
        let infos = self.problem.infos(signature.candidate);
        let mut used: Vec<usize> = (0..signature.sizes.len()).collect();
        let mut found = Ranked {
            signature: signature.clone(),
            start: signature.values.clone(),
            others: Vec::new(),
            gain: 0.0,
        };
        for &i in &signature.sizes {
            found.start[i] = infos[i].neutral;
        }
        // A size that comes out on the wrong side of its bound is not there; what is left is fitted
        // again.
        while !used.is_empty() {
            let columns: Vec<&Columns> = used.iter().map(|&j| &signature.columns[j]).collect();
            let fit = self.fit(&columns);
            let size = |position: usize| {
                let i = signature.sizes[used[position]];
                let secant = signature.values[i] - infos[i].neutral;
                (i, infos[i].neutral + fit.coefficients[position] * secant)
            };
            let outside = (0..used.len()).find(|&p| {
                let (i, value) = size(p);
                value <= infos[i].min && infos[i].neutral - infos[i].min <= 0.0
            });
            if let Some(position) = outside {
                used.remove(position);
                continue;
            }
            for (i, value) in (0..used.len()).map(size) {
                found.start[i] = value.clamp(infos[i].min, infos[i].max);
            }
            found.gain = (self.zero - fit.objective).max(0.0);
            break;
        }
        if signature.as_taken {
            found.start.clone_from(&signature.values);
        }
        match placed(self, signature) {
            Some(better) if better.gain > found.gain => better,
            _ => found,
        }
    }

    /// The prediction at the sizes that were found. Where it cannot be made, in a cut that chatters
    /// there, say, the sizes come nearer to those of the signature, at which it can.
    fn nearer(&self, entry: &mut Ranked) -> Option<Columns> {
        for _ in 0..NEARER {
            let (candidate, values) = (entry.candidate(), entry.start.clone());
            let found = Found {
                values,
                ..self.problem.neutral(candidate)
            };
            if let Ok(predicted) = (self.problem).predict(&with(&self.base.point, found)) {
                return Some(predicted);
            }
            for &i in &entry.signature.sizes {
                entry.start[i] = 0.5 * (entry.start[i] + entry.signature.values[i]);
            }
        }
        None
    }

    /// Takes the signature anew at the sizes that were found.
    fn refine(&self, entry: &mut Ranked) {
        let (problem, base) = (self.problem, self.base);
        if entry.signature.as_taken {
            return;
        }
        let infos = problem.infos(entry.candidate());
        for _ in 0..2 {
            let Some(predicted) = self.nearer(entry) else {
                return;
            };
            let fit = self.fit(&[&difference(&predicted, &base.predicted, 1.0)]);
            let factor = fit.coefficients[0].clamp(0.2, 5.0);
            let gain = (self.zero - fit.objective).max(0.0);
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
                return;
            }
        }
        self.nearer(entry);
    }
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
        add_column(&mut left, x, -b);
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
