//! Search for poles: one is added where it reduces the residual most, then all are refined
//! together.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::Pole;
use super::projection::PoleProblem;

/// Starting damping ratios of a new mode.
const ZETAS: [f64; 4] = [0.005, 0.02, 0.06, 0.15];
/// Number of starting frequencies of a new mode.
const STARTS: usize = 60;
/// Maximum number of modes.
const MOST: usize = 16;
/// Modes that are added in a row without improving BIC.
const PATIENCE: usize = 3;
/// Least fraction of some FRF that a mode contributes at its own frequency.
const VISIBLE: f64 = 0.05;
/// Damping ratio above which a pole is not a mode but a trend.
const OVERDAMPED: f64 = 0.5;
/// A residual this small (fraction of the sum of squares) is rounding.
const EXACT: f64 = 1e-14;
const MAX_STEPS: usize = 60;

/// The significant poles, or `count` of them.
pub(super) fn poles(problem: &PoleProblem, band_hz: [f64; 2], count: Option<usize>) -> Vec<Pole> {
    let none = problem.solve(&[]).cost();
    let (mut poles, mut cost) = (Vec::new(), none);
    // While other modes are missing, the residual looks like coloured noise, in which a mode gains
    // little; a few more are tried before the last accepted set is final.
    let (mut accepted, mut best_cost) = (Vec::new(), none);
    let total = problem.total();
    while poles.len() < count.unwrap_or(MOST) && cost > EXACT * total {
        if problem.size() <= problem.unknowns(poles.len() + 1) + 1.0 {
            break;
        }
        let Some(more) = one_more(problem, band_hz, &poles, cost) else {
            break;
        };
        (poles, cost) = more;
        if count.is_some() || improves_bic(problem, (&accepted, best_cost), (&poles, cost)) {
            (accepted, best_cost) = (poles.clone(), cost);
        } else if poles.len() >= accepted.len() + PATIENCE {
            break;
        }
    }
    accepted
}

/// The poles with the one added that reduces the cost most; `None` if none does.
fn one_more(
    problem: &PoleProblem,
    band_hz: [f64; 2],
    poles: &[Pole],
    cost: f64,
) -> Option<(Vec<Pole>, f64)> {
    let mut found: Option<(Vec<Pole>, f64)> = None;
    for start in starts(problem, band_hz, poles) {
        let mut trial = poles.to_vec();
        trial.push(start);
        let trial = refine(problem, &trial);
        let least = found.as_ref().map_or(cost, |(_, best)| *best);
        let trial_cost = problem.solve(&trial).cost();
        if trial_cost < least && sensible(problem, &trial, band_hz) {
            found = Some((trial, trial_cost));
        }
    }
    found
}

/// Bayesian information criterion, with the number of independent residuals.
fn improves_bic(problem: &PoleProblem, before: (&[Pole], f64), after: (&[Pole], f64)) -> bool {
    let together = problem.correlation(&problem.solve(after.0));
    let samples = problem.size() / together;
    let price = problem.unknowns(after.0.len()) - problem.unknowns(before.0.len());
    samples * (before.1 / after.1).ln() > price * samples.ln()
}

/// The starts that reduce the residual most: the best of each damping.
fn starts(problem: &PoleProblem, band_hz: [f64; 2], poles: &[Pole]) -> Vec<Pole> {
    let low = band_hz[0].max(1e-3 * band_hz[1]);
    let at = |i: usize| TAU * low * (band_hz[1] / low).powf((i as f64 + 0.5) / STARTS as f64);
    let mut trial = poles.to_vec();
    trial.push(Pole {
        omega: 1.0,
        zeta: 0.1,
    });
    let mut best: Vec<(Pole, f64)> = Vec::new();
    for zeta in ZETAS {
        let costs = (0..STARTS).map(|i| {
            let pole = Pole { omega: at(i), zeta };
            trial[poles.len()] = pole;
            (pole, problem.solve(&trial).cost())
        });
        best.extend(costs.min_by(|a, b| a.1.total_cmp(&b.1)));
    }
    best.sort_by(|a, b| a.1.total_cmp(&b.1));
    best.truncate(2);
    best.into_iter().map(|(pole, _)| pole).collect()
}

/// Whether all poles are modes in the band that contribute to some FRF.
fn sensible(problem: &PoleProblem, poles: &[Pole], band_hz: [f64; 2]) -> bool {
    let fitted = problem.solve(poles);
    let inside = |pole: &Pole| {
        let hz = pole.omega / TAU;
        hz >= band_hz[0] && hz <= band_hz[1] && pole.zeta < OVERDAMPED
    };
    (poles.iter().enumerate())
        .all(|(k, pole)| inside(pole) && problem.share(pole, k, &fitted) > VISIBLE)
}

/// Moves all poles to the nearest minimum of the cost.
pub(super) fn refine(problem: &PoleProblem, start: &[Pole]) -> Vec<Pole> {
    let mut poles = start.to_vec();
    let mut at = problem.solve(&poles);
    let mut cost = at.cost();
    let mut damping = 1e-3;
    for _ in 0..MAX_STEPS {
        let jacobian = problem.jacobian(&poles, &at);
        let normal = jacobian.tr_mul(&jacobian);
        let gradient = jacobian.tr_mul(&DVector::from_column_slice(&at.residual));
        let mut moved = None;
        while moved.is_none() && damping < 1e8 {
            let diagonal = DMatrix::from_diagonal(&(normal.diagonal() * damping));
            let Some(step) = (&normal + diagonal).lu().solve(&gradient) else {
                damping *= 10.0;
                continue;
            };
            let trial = stepped(&poles, &step);
            let fitted = problem.solve(&trial);
            if fitted.cost() <= cost {
                moved = Some((trial, fitted, step.amax()));
                damping = (damping * 0.2).max(1e-12);
            } else {
                damping *= 10.0;
            }
        }
        let Some((trial, fitted, step)) = moved else {
            break;
        };
        let gain = cost - fitted.cost();
        poles = trial;
        at = fitted;
        cost = at.cost();
        if step < 1e-10 || gain <= 1e-12 * cost {
            break;
        }
    }
    poles
}

/// Poles moved by the negative step of the logarithms of ω and ζ, by a factor of two at most.
fn stepped(poles: &[Pole], step: &DVector<f64>) -> Vec<Pole> {
    let factor = |delta: f64| (-delta).clamp(-0.7, 0.7).exp();
    (poles.iter().enumerate())
        .map(|(k, pole)| Pole {
            omega: pole.omega * factor(step[2 * k]),
            zeta: (pole.zeta * factor(step[2 * k + 1])).clamp(1e-7, 0.99),
        })
        .collect()
}
