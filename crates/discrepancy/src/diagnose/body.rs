//! A body of unknown mass at an unknown place: what it changes is linear in its mass, its first and
//! its second moments, so that its place is found among all places without another simulation.

use super::moments::Moments;
use super::noise::{Noise, add_columns};
use super::problem::Problem;
use super::screen::{Extension, Ranked, projected};
use super::signature::Signature;
use crate::model::Columns;

/// Distances from where the signature was taken, in parts of its reach, from which the place is
/// looked for.
const DISTANCES: [f64; 4] = [0.0, 0.3, 1.0, 3.0];
/// The best of these are followed.
const FOLLOWED: usize = 4;
/// A step is halved so often.
const HALVED: usize = 12;
/// Most steps to a place.
const STEPS: usize = 400;
/// Part of what is explained below which a number of the place says nothing.
const UNTOLD: f64 = 1e-6;
/// The noise is that of what is left after so many rounds.
const ROUNDS: usize = 3;

/// Where the body gains most, in parts of the reach of each moment; `None` where none is possible.
pub(super) fn placed(extension: &Extension, signature: &Signature) -> Option<Ranked> {
    let problem = extension.problem;
    let (&[size], [column]) = (&*signature.sizes, &*signature.columns) else {
        return None;
    };
    if signature.moments.is_empty() {
        return None;
    }
    let rows = &problem.split.train;
    let body = Body::new(problem, signature, size, column);
    let residual = &extension.base.residual;
    let mut best: Option<Ranked> = None;
    let white = Noise::white(residual, rows, &problem.floor);
    for first in [white, extension.base.noise.clone()] {
        let mut noise = first;
        for _ in 0..ROUNDS {
            let Some(place) = body.best(&body.sums(extension, &noise)) else {
                break;
            };
            let change = body.change(&place);
            let fit = extension.fit(&[&change]);
            let found = body.ranked(&place, fit.coefficients[0], extension.zero - fit.objective);
            let Some(found) = found else { break };
            let gains = best.as_ref().is_none_or(|best| best.gain < found.gain);
            if gains {
                best = Some(found);
            }
            let mut left = residual.clone();
            let all = std::iter::once(&change).chain(extension.nuisance.iter().copied());
            for (column, coefficient) in all.zip(&fit.coefficients) {
                add_columns(&mut left, column, -coefficient);
            }
            noise = Noise::fit(&left, rows, extension.orders, &problem.floor);
        }
    }
    best
}

/// A body with the bounds of its numbers.
struct Body<'a> {
    problem: &'a Problem<'a>,
    signature: &'a Signature,
    /// Index of its mass.
    size: usize,
    /// What mass, first and second moments change, in the order of [`Body::powers`].
    columns: Vec<&'a Columns>,
}

impl<'a> Body<'a> {
    fn new(
        problem: &'a Problem<'a>,
        signature: &'a Signature,
        size: usize,
        column: &'a Columns,
    ) -> Body<'a> {
        let mut columns = vec![column];
        for moment in &signature.moments {
            columns.extend([&moment.column, &moment.square]);
            columns.extend(&moment.products);
        }
        Body {
            problem,
            signature,
            size,
            columns,
        }
    }

    /// What multiplies each column for a body of the signature's mass at the place.
    fn powers(place: &[f64]) -> Vec<f64> {
        let mut found = vec![1.0];
        for (i, x) in place.iter().enumerate() {
            found.extend([*x, x * x]);
            found.extend(place[..i].iter().map(|other| x * other));
        }
        found
    }

    fn change(&self, place: &[f64]) -> Columns {
        let mut sum: Columns = (self.columns[0].iter())
            .map(|column| vec![0.0; column.len()])
            .collect();
        for (column, power) in self.columns.iter().zip(Self::powers(place)) {
            add_columns(&mut sum, column, power);
        }
        sum
    }

    /// Inner products of the columns, whitened and without what the model can do by itself.
    fn sums(&self, extension: &Extension, noise: &Noise) -> Moments {
        let rows = &self.problem.split.train;
        let white = |x: &Columns| noise.whiten(x, rows);
        let own: Vec<Vec<f64>> = extension.nuisance.iter().map(|x| white(x)).collect();
        let free = |x: &Columns| projected(&white(x), &own, &extension.priors);
        let columns: Vec<Vec<f64>> = self.columns.iter().map(|x| free(x)).collect();
        Moments::new(&free(&extension.base.residual), &columns)
    }

    /// Index of each number of the place, and by how much a part of its reach moves it.
    fn axes(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let moments = self.signature.moments.iter();
        moments.map(|moment| (moment.parameter, moment.reach))
    }

    fn is_within(&self, place: &[f64]) -> bool {
        let infos = self.problem.infos(self.signature.candidate);
        self.axes().zip(place).all(|((parameter, reach), x)| {
            let value = self.signature.values[parameter] + reach * x;
            (infos[parameter].min..=infos[parameter].max).contains(&value)
        })
    }

    /// The place at which a body of the best mass explains most, by a search along the axes from
    /// the best of a grid of places.
    fn best(&self, sums: &Moments) -> Option<Vec<f64>> {
        let explained = |place: &[f64]| -> f64 {
            match self.is_within(place) {
                true => sums.explained_along(&Self::powers(place)),
                false => 0.0,
            }
        };
        let mut starts: Vec<(f64, Vec<f64>)> = (grid(self.signature.moments.len()).into_iter())
            .map(|place| (explained(&place), place))
            .collect();
        starts.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = starts.into_iter().take(FOLLOWED);
        let ends = best.map(|(_, place)| climbed(&explained, place));
        let (gain, place) = ends.max_by(|a, b| a.0.total_cmp(&b.0))?;
        (gain > 0.0).then_some(place)
    }

    fn ranked(&self, place: &[f64], factor: f64, gain: f64) -> Option<Ranked> {
        let infos = self.problem.infos(self.signature.candidate);
        let mut start = self.signature.values.clone();
        let info = &infos[self.size];
        start[self.size] = info.neutral + factor * (start[self.size] - info.neutral);
        for ((parameter, reach), x) in self.axes().zip(place) {
            start[parameter] += reach * x;
        }
        let possible = start[self.size] > info.min && start[self.size] <= info.max;
        possible.then(|| Ranked {
            signature: self.signature.clone(),
            start,
            others: Vec::new(),
            gain: gain.max(0.0),
        })
    }
}

/// The top that steps along the axes lead to from a place, and the place.
fn climbed(height: &impl Fn(&[f64]) -> f64, mut place: Vec<f64>) -> (f64, Vec<f64>) {
    let mut here = height(&place);
    let (mut step, mut halved) = (0.3, 0);
    for _ in 0..STEPS {
        let sides = (0..place.len()).flat_map(|i| [(i, step), (i, -step)]);
        let moved = sides.map(|(i, by)| {
            let mut moved = place.clone();
            moved[i] += by;
            (height(&moved), moved)
        });
        match moved.max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((better, moved)) if better > here => {
                (here, place) = (better, moved);
                step *= 1.5;
            }
            _ if halved == HALVED => break,
            _ => {
                step *= 0.5;
                halved += 1;
            }
        }
    }
    // What the data do not tell stays where it was.
    for i in 0..place.len() {
        let kept = std::mem::replace(&mut place[i], 0.0);
        if height(&place) < here * (1.0 - UNTOLD) {
            place[i] = kept;
        }
    }
    (here, place)
}

/// Places in so many dimensions: all corners, edges and faces of cubes about the origin.
fn grid(dimensions: usize) -> Vec<Vec<f64>> {
    let mut signs: Vec<Vec<f64>> = vec![Vec::new()];
    for _ in 0..dimensions {
        let longer = |place: &Vec<f64>, x: f64| [place.as_slice(), &[x]].concat();
        signs = (signs.iter())
            .flat_map(|place| [-1.0, 0.0, 1.0].map(|x| longer(place, x)))
            .collect();
    }
    let cubes = DISTANCES.iter().flat_map(|far| {
        let places = signs.iter();
        places.map(move |place| place.iter().map(|x| far * x).collect::<Vec<f64>>())
    });
    cubes.collect()
}
