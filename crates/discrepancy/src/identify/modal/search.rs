//! The search for poles: one more where it takes most off the residual, then all together.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::Pole;
use super::projection::Problem;

/// Damping ratios that a new mode starts from.
const ZETAS: [f64; 4] = [0.005, 0.02, 0.06, 0.15];
/// Frequencies that a new mode may start from.
const STARTS: usize = 60;
/// More modes are not looked for.
const MOST: usize = 16;
/// Modes that are added although none of them is worth it yet.
const PATIENCE: usize = 3;
/// A mode must make up this share of some FRF at its own frequency.
const VISIBLE: f64 = 0.05;
/// Beyond this a pole is no mode but a slope.
const OVERDAMPED: f64 = 0.5;
/// A residual this small (share of the squares) is rounding.
const EXACT: f64 = 1e-14;
const MAX_STEPS: usize = 60;

/// The poles that the data show, or `count` of them.
pub(super) fn poles(problem: &Problem, band_hz: [f64; 2], count: Option<usize>) -> Vec<Pole> {
    let none = problem.solve(&[]).cost();
    let (mut poles, mut cost) = (Vec::new(), none);
    // What a mode leaves while others are still missing looks like coloured noise, in which it is worth little; a few
    // more are tried before the last that was worth it stands.
    let (mut worthy, mut worthy_cost) = (Vec::new(), none);
    let total = problem.total();
    while poles.len() < count.unwrap_or(MOST) && cost > EXACT * total {
        if problem.size() <= problem.unknowns(poles.len() + 1) + 1.0 {
            break;
        }
        let Some(more) = one_more(problem, band_hz, &poles, cost) else {
            break;
        };
        (poles, cost) = more;
        if count.is_some() || worth_it(problem, (&worthy, worthy_cost), (&poles, cost)) {
            (worthy, worthy_cost) = (poles.clone(), cost);
        } else if poles.len() >= worthy.len() + PATIENCE {
            break;
        }
    }
    worthy
}

/// The poles with the one added that takes most off the cost; `None` if none takes anything off.
fn one_more(
    problem: &Problem,
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

/// Bayes's information criterion; residuals that go together count once.
fn worth_it(problem: &Problem, before: (&[Pole], f64), after: (&[Pole], f64)) -> bool {
    let together = problem.correlation(&problem.solve(after.0));
    let samples = problem.size() / together;
    let price = problem.unknowns(after.0.len()) - problem.unknowns(before.0.len());
    samples * (before.1 / after.1).ln() > price * samples.ln()
}

/// The starts that take most off the residual: the best of each damping.
fn starts(problem: &Problem, band_hz: [f64; 2], poles: &[Pole]) -> Vec<Pole> {
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

/// Whether all poles are modes of the band that matter somewhere.
fn sensible(problem: &Problem, poles: &[Pole], band_hz: [f64; 2]) -> bool {
    let fitted = problem.solve(poles);
    let inside = |pole: &Pole| {
        let hz = pole.omega / TAU;
        hz >= band_hz[0] && hz <= band_hz[1] && pole.zeta < OVERDAMPED
    };
    (poles.iter().enumerate())
        .all(|(k, pole)| inside(pole) && problem.share(pole, k, &fitted) > VISIBLE)
}

/// Moves all poles to the nearest least cost.
pub(super) fn refine(problem: &Problem, start: &[Pole]) -> Vec<Pole> {
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

/// Poles moved against a step of the logarithms of ω and ζ, by a factor of two at most.
fn stepped(poles: &[Pole], step: &DVector<f64>) -> Vec<Pole> {
    let factor = |delta: f64| (-delta).clamp(-0.7, 0.7).exp();
    (poles.iter().enumerate())
        .map(|(k, pole)| Pole {
            omega: pole.omega * factor(step[2 * k]),
            zeta: (pole.zeta * factor(step[2 * k + 1])).clamp(1e-7, 0.99),
        })
        .collect()
}
