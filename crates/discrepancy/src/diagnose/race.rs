//! Many fits side by side: two that have come together go on as one, and what falls far behind is given up.

use rayon::prelude::*;

use super::fit::{Fit, Running};
use super::problem::{Point, Problem};
use crate::model::PredictError;

/// Iterations after which fits are compared; the first of them are under white noise.
const HEAT: usize = 5;
/// A fit is given up if, with all that its next step promises several times over, it has gained less than this part of what the
/// best of as many effects has.
const FAR_BEHIND: f64 = 0.5;
/// What is left may be so many times what the next step promises.
const PROMISE: f64 = 4.0;
/// That much must have been gained by the best before anything is given up; with less, chance decides who leads.
const CLEAR: f64 = 100.0;
/// Squared distance, in standard deviations of the noise, below which two predictions are the same.
const TOGETHER: f64 = 0.01;

/// One fit with its end.
pub(super) struct Trial {
    pub start: Point,
    pub iterations: usize,
    pub end: Result<Fit, PredictError>,
}

/// Fits to the training rows from all starts. With `base`, the model without what is added, those far behind are given up.
pub(super) fn run(
    problem: &Problem,
    starts: Vec<Point>,
    orders: &[usize],
    base: Option<&Fit>,
) -> Vec<Trial> {
    let train = &problem.split.train;
    let heats: Vec<(Point, Result<Running, PredictError>)> = starts
        .into_par_iter()
        .map(|start| {
            let heat = Running::begin(problem, start.clone(), train, orders, false);
            let heat = heat.and_then(|mut running| running.advance(HEAT).map(|()| running));
            (start, heat)
        })
        .collect();
    let given_up = given_up(&heats, base);
    let ends = heats.into_par_iter().zip(given_up);
    ends.map(|((start, heat), given_up)| {
        let iterations = heat.as_ref().map_or(0, Running::iterations);
        let end = heat.and_then(|mut running| match given_up {
            Some(reason) => Err(PredictError(reason.into())),
            None => {
                running.advance(usize::MAX)?;
                Ok(running.finish())
            }
        });
        Trial {
            start,
            iterations,
            end,
        }
    })
    .collect()
}

/// Which fits are not worth going on with, and why.
fn given_up(
    heats: &[(Point, Result<Running, PredictError>)],
    base: Option<&Fit>,
) -> Vec<Option<&'static str>> {
    let running: Vec<Option<&Running>> =
        (heats.iter()).map(|(_, heat)| heat.as_ref().ok()).collect();
    let count = |running: &Running| running.point().effects.len();
    let gains: Vec<Option<f64>> = (running.iter())
        .map(|running| Some(base?.objective - (*running)?.objective()))
        .collect();
    let best = |effects: usize| {
        let pairs = running.iter().zip(&gains);
        let gains = pairs.filter(|(other, _)| other.is_some_and(|other| count(other) == effects));
        gains.filter_map(|(_, gain)| *gain).fold(0.0, f64::max)
    };
    let verdict = |i: usize| {
        let own = running[i].filter(|own| !own.has_ended())?;
        let twin = running.iter().enumerate().any(|(j, other)| {
            let Some(other) = other.filter(|_| j != i) else {
                return false;
            };
            (j < i || other.has_ended()) && same(own, other)
        });
        if twin {
            return Some("given up: it came to where another fit of the same effects is");
        }
        let best = best(count(own));
        let within_reach = gains[i]? + PROMISE * own.decrement();
        (best > CLEAR && within_reach < FAR_BEHIND * best)
            .then_some("given up: far behind the best of as many effects")
    };
    (0..heats.len()).map(verdict).collect()
}

fn same(a: &Running, b: &Running) -> bool {
    let kinds = |running: &Running| -> Vec<usize> {
        let effects = running.point().effects.iter();
        effects.map(|found| found.candidate).collect()
    };
    kinds(a) == kinds(b) && a.distance(b) < TOGETHER
}
