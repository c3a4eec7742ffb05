//! Many fits in parallel: fits that converge to the same point are merged, and those far behind are
//! dropped.

use rayon::prelude::*;

use super::fit::{Fit, Running};
use super::problem::{Point, Problem};
use crate::model::PredictError;

/// Iterations after which fits are compared, the first of them under white noise, and a part: a fit
/// is given up if, with all that its next step promises several times over, it has gained less than
/// this part of what the best of as many effects has.
const HEATS: [(usize, f64); 2] = [(3, 0.2), (5, 0.5)];
/// What is left may be so many times what the next step promises.
const PROMISE: f64 = 4.0;
/// That much must have been gained by the best before anything is given up; with less, chance
/// decides who leads.
const CLEAR: f64 = 100.0;
/// Squared distance, in standard deviations of the noise, below which two predictions are the same.
const TOGETHER: f64 = 0.01;

/// Gain that fits must exceed to be continued.
#[derive(Debug, Clone, Copy)]
pub(super) enum Race<'a> {
    /// Nothing: all go to their ends. A model that all extend may be known.
    None(Option<&'a Fit>),
    /// What the best of as many effects gains on the model that all extend.
    Extending(&'a Fit),
    /// An objective.
    ToBeat(f64),
}

/// One fit with its end.
pub(super) struct FitTrial {
    pub start: Point,
    pub iterations: usize,
    pub end: Result<Fit, PredictError>,
}

/// A fit in progress.
struct Runner<'a, 'b> {
    start: Point,
    running: Result<Running<'a, 'b>, PredictError>,
    /// Why it was stopped.
    given_up: Option<&'static str>,
}

impl<'a, 'b> Runner<'a, 'b> {
    fn begin(
        problem: &'a Problem<'b>,
        start: Point,
        orders: &'a [usize],
        race: Race,
    ) -> Runner<'a, 'b> {
        let running = Running::begin(problem, start.clone(), &problem.split.train, orders, false);
        Runner {
            start,
            running: match race {
                Race::Extending(base) | Race::None(Some(base)) => {
                    running.map(|running| running.knowing(base))
                }
                _ => running,
            },
            given_up: None,
        }
    }

    fn advance(&mut self, iterations: usize) {
        if self.given_up.is_none()
            && let Ok(running) = &mut self.running
            && let Err(error) = running.advance(iterations)
        {
            self.running = Err(error);
        }
    }

    fn end(mut self, problem: &Problem) -> FitTrial {
        let iterations = self.running.as_ref().map_or(0, Running::iterations);
        self.advance(usize::MAX);
        FitTrial {
            start: self.start,
            iterations: (self.running.as_ref()).map_or(iterations, Running::iterations),
            end: match self.given_up {
                Some(reason) => Err(PredictError(reason.into())),
                None => self.running.and_then(|running| possible(problem, running)),
            },
        }
    }
}

/// The fit, unless it ended where no machine is.
fn possible(problem: &Problem, running: Running) -> Result<Fit, PredictError> {
    let fit = running.finish();
    if problem.model.may_be(&problem.effects(&fit.point)) {
        return Ok(fit);
    }
    Err(PredictError(
        "it ended at a mode that moves most of the arm's mass".into(),
    ))
}

/// Fits to the training rows from all starts.
pub(super) fn run(
    problem: &Problem,
    starts: Vec<Point>,
    orders: &[usize],
    race: Race,
) -> Vec<FitTrial> {
    let mut runners: Vec<Runner> = (starts.into_par_iter())
        .map(|start| Runner::begin(problem, start, orders, race))
        .collect();
    for (iterations, part) in HEATS {
        (runners.par_iter_mut()).for_each(|runner| runner.advance(iterations));
        let reasons = given_up(&runners, race, part);
        for (runner, reason) in runners.iter_mut().zip(reasons) {
            runner.given_up = runner.given_up.or(reason);
        }
    }
    runners
        .into_par_iter()
        .map(|runner| runner.end(problem))
        .collect()
}

/// Fits to stop, and why.
fn given_up(runners: &[Runner], race: Race, part: f64) -> Vec<Option<&'static str>> {
    let running: Vec<Option<&Running>> = (runners.iter())
        .map(|runner| runner.running.as_ref().ok())
        .collect();
    let count = |running: &Running| running.point().effects.len();
    let next_best = match race {
        Race::Extending(_) => next_best(runners),
        _ => None,
    };
    let is_behind = |own: &Running| {
        let reachable = own.objective() - PROMISE * own.decrement();
        match race {
            Race::None(_) => false,
            Race::ToBeat(objective) => reachable > objective,
            Race::Extending(base) => {
                let gains = running
                    .iter()
                    .flatten()
                    .filter(|one| count(one) == count(own));
                let gains = gains.map(|one| base.objective - one.objective());
                let best = gains.fold(0.0, f64::max);
                best > CLEAR && base.objective - reachable < part * best
            }
        }
    };
    let verdict = |i: usize| {
        let own = running[i].filter(|own| !own.has_ended())?;
        let twin = running.iter().enumerate().any(|(j, other)| {
            let Some(other) = other.filter(|_| j != i && runners[j].given_up.is_none()) else {
                return false;
            };
            (j < i || other.has_ended()) && same(own, other)
        });
        if twin {
            return Some("given up: it came to where another fit of the same effects is");
        }
        (is_behind(own) && next_best != Some(own.point().candidates())).then_some(match race {
            Race::ToBeat(_) => "given up: it does not come to more than the fit that it began from",
            _ => "given up: far behind the best of as many effects",
        })
    };
    (0..runners.len()).map(verdict).collect()
}

/// The effects of the best fit that has others than the leader, among fits of the fewest effects:
/// it is reported as the next best explanation, however far behind.
fn next_best(runners: &[Runner]) -> Option<Vec<usize>> {
    let on_the_way: Vec<&Running> = (runners.iter())
        .filter(|runner| runner.given_up.is_none())
        .filter_map(|runner| runner.running.as_ref().ok())
        .collect();
    let count = |running: &Running| running.point().effects.len();
    let fewest = on_the_way.iter().map(|running| count(running)).min()?;
    let best_but = |not: &[usize]| {
        let others = on_the_way
            .iter()
            .filter(|running| count(running) == fewest && running.point().candidates() != not);
        let best = others.min_by(|a, b| a.objective().total_cmp(&b.objective()))?;
        Some(best.point().candidates())
    };
    best_but(&best_but(&[])?)
}

fn same(a: &Running, b: &Running) -> bool {
    a.point().candidates() == b.point().candidates() && a.distance(b) < TOGETHER
}
