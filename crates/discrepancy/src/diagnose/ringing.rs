//! Sizes of effects whose signature is ringing.
//!
//! On a base that gives, the arm rings through the record, at a frequency that is another for each
//! compliance. A fit finds the way only from where the frequency is right within a part of a period
//! over the record: from a usual start it ends at another optimum, or at nothing. So sizes are
//! tried from which to which no mode moves by more than that, over the first periods only, where
//! few are enough; the best of them again over a part twice as long, at sizes half as far apart,
//! until it is the whole.

use rayon::prelude::*;

use super::derivatives::difference;
use super::fit::Fit;
use super::noise::{Noise, add_columns, fit_linear};
use super::problem::{Found, Problem};
use super::screen::nuisance;
use super::signature::{Signature, with};
use crate::model::Columns;

/// The first part has so many periods of the slowest mode of the nominal machine.
const PERIODS: f64 = 10.0;
/// From a size to the next, a mode is out of step by no more than this part of a period over the
/// part of the record: a quarter to the size in between.
const OUT_OF_STEP: f64 = 0.5;
/// Optima that are followed to the whole record.
const FOLLOWED: usize = 3;
/// One size of so many is tried first: an axis about which nothing moves is not felt at any.
const PROBED: usize = 9;
/// In minus twice the log-likelihood.
const FELT: f64 = 1.0;
/// A channel moves once its prediction has left its first value by this part of its range.
const MOVES: f64 = 0.02;

/// For each candidate that rings the signatures at the sizes from which a fit finds the way.
pub(super) fn ringing(problem: &Problem, base: &Fit) -> Vec<Signature> {
    let Some(scan) = Scan::new(problem, base) else {
        return Vec::new();
    };
    let absent = (problem.searched()).filter(|&candidate| !base.point.holds(candidate));
    absent
        .flat_map(|candidate| scan.signatures(candidate))
        .collect()
}

struct Scan<'a, 'b> {
    problem: &'a Problem<'b>,
    base: &'a Fit,
    /// Where motion begins, and samples of the first part, from the start of the record.
    begins: usize,
    first: usize,
    /// Samples of the whole.
    whole: usize,
}

impl<'a, 'b> Scan<'a, 'b> {
    fn new(problem: &'a Problem<'b>, base: &'a Fit) -> Option<Self> {
        let time_s = &problem.data.time_s;
        let slowest_hz = problem.model.slowest_mode_hz()?;
        let own = problem.data.trajectories.first()?;
        let whole = problem.split.searched.min(own.end);
        let begins = (base.predicted.iter())
            .filter_map(|column| begins(&column[..whole]))
            .min()?;
        let interval_s = time_s[1] - time_s[0];
        let periods = (PERIODS / slowest_hz / interval_s).ceil() as usize;
        let rings = begins + 1 < whole && periods > 1;
        rings.then_some(Self {
            problem,
            base,
            begins,
            first: (begins + periods).min(whole),
            whole,
        })
    }

    fn signatures(&self, candidate: usize) -> Vec<Signature> {
        let problem = self.problem;
        let time_s = &problem.data.time_s;
        let part_s = time_s[self.first - 1] - time_s[self.begins];
        let of_candidate = &problem.candidates[candidate];
        let sizes = (problem.model).sizes_by_mode(of_candidate, OUT_OF_STEP / part_s);
        if problem.left() < 2 * sizes.len() || !self.is_felt(candidate, &sizes) {
            return Vec::new();
        }
        let profile: Vec<f64> = (sizes.par_iter())
            .map(|size| self.objective(candidate, *size, self.first))
            .collect();
        let at = |place: usize| profile.get(place).copied().unwrap_or(f64::INFINITY);
        let is_lowest = |&place: &usize| {
            let before = place.checked_sub(1).map_or(f64::INFINITY, at);
            at(place).is_finite() && at(place) <= before && at(place) < at(place + 1)
        };
        let mut optima: Vec<usize> = (0..sizes.len()).filter(is_lowest).collect();
        optima.sort_by(|a, b| at(*a).total_cmp(&at(*b)));
        optima.truncate(FOLLOWED);
        let followed = optima.into_par_iter();
        let found: Vec<f64> = followed
            .map(|place| self.followed(candidate, &sizes, place))
            .collect();
        (found.into_par_iter())
            .filter_map(|size| self.signature(candidate, size))
            .collect()
    }

    /// Whether any size does something that the data would show.
    fn is_felt(&self, candidate: usize, sizes: &[f64]) -> bool {
        let some: Vec<f64> = sizes.iter().copied().step_by(PROBED).collect();
        let without = self.left(&self.base.residual, self.first);
        let beside: Vec<f64> = (some.into_par_iter())
            .map(|size| self.objective(candidate, size, self.first))
            .collect();
        (beside.iter()).any(|objective| (objective - without).abs() > FELT)
    }

    /// The best size near one on the list, over longer and longer parts of the record.
    fn followed(&self, candidate: usize, sizes: &[f64], place: usize) -> f64 {
        let last = sizes.len() as f64 - 1.0;
        let size = |place: f64| {
            let below = (place.floor() as usize).min(sizes.len().saturating_sub(2));
            let [low, high] = [below, (below + 1).min(sizes.len() - 1)].map(|i| sizes[i]);
            low * (high / low).powf(place - below as f64)
        };
        let mut place = place as f64;
        let (mut part, mut apart) = (self.first, 1.0);
        loop {
            part = (self.begins + 2 * (part - self.begins)).min(self.whole);
            apart *= 0.5;
            let tried = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|step| place + apart * step);
            let tried = tried.map(|place| place.clamp(0.0, last));
            let objectives = tried.map(|place| self.objective(candidate, size(place), part));
            let best = (0..tried.len()).min_by(|a, b| objectives[*a].total_cmp(&objectives[*b]));
            place = tried[best.unwrap_or(2)];
            if part == self.whole {
                return size(place);
            }
        }
    }

    /// Minus twice the log-likelihood of what is left of the first samples beside all that the
    /// model can move by itself, were it white noise.
    fn left(&self, residual: &Columns, samples: usize) -> f64 {
        let (problem, base) = (self.problem, self.base);
        let mut rows = problem.split.train.clone();
        for rows in &mut rows.per_channel {
            rows.retain(|row| *row < samples);
        }
        let (columns, priors) = nuisance(problem, base);
        let floor = &problem.floor;
        let white = Noise::white(residual, &rows, floor);
        let orders = vec![0; residual.len()];
        fit_linear(residual, &columns, &priors, &rows, &white, &orders, floor).objective
    }

    /// The same beside an effect of the size.
    fn objective(&self, candidate: usize, size: f64, samples: usize) -> f64 {
        let (problem, base) = (self.problem, self.base);
        let point = with(&base.point, found(candidate, size));
        let Ok(predicted) = problem.predict_until(samples, &point) else {
            return f64::INFINITY;
        };
        let mut residual: Columns = base.residual.clone();
        add_columns(&mut residual, &predicted, -1.0);
        add_columns(&mut residual, &base.predicted, 1.0);
        self.left(&residual, samples)
    }

    fn signature(&self, candidate: usize, size: f64) -> Option<Signature> {
        let base = self.base;
        let point = with(&base.point, found(candidate, size));
        let predicted = self.problem.predict(&point).ok()?;
        Some(Signature {
            candidate,
            values: vec![size],
            sizes: vec![0],
            columns: vec![difference(&predicted, &base.predicted, 1.0)],
            moments: Vec::new(),
            as_taken: true,
        })
    }
}

fn found(candidate: usize, size: f64) -> Found {
    Found {
        candidate,
        values: vec![size],
        smoothing: 0.0,
    }
}

/// The first sample at which a channel moves; none of one that does not.
fn begins(column: &[f64]) -> Option<usize> {
    let (low, high) = (column.iter()).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(*x), high.max(*x))
    });
    let first = *column.first()?;
    column
        .iter()
        .position(|x| (x - first).abs() > MOVES * (high - low))
}
