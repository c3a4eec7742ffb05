//! Signatures: the change of the prediction for a size of an effect that is not small, since backlash or dry friction have no
//! derivative at zero.

use rayon::prelude::*;

use super::fit::{Fit, difference};
use super::problem::{Found, Point, Problem};
use super::validate::rms;
use crate::model::Columns;

/// Change of the prediction for one candidate at given shape parameters, one for each size parameter.
#[derive(Debug, Clone)]
pub(super) struct Signature {
    pub candidate: usize,
    /// The values at which it was taken, all sizes at once.
    pub values: Vec<f64>,
    /// Indices of its size parameters.
    pub sizes: Vec<usize>,
    /// Change of the prediction for each of them alone.
    pub columns: Vec<Columns>,
}

/// Signatures of all candidates that the point does not hold, over their grids of starts.
pub(super) fn signatures(problem: &Problem, base: &Fit) -> Vec<Signature> {
    let mut wanted = Vec::new();
    for candidate in 0..problem.candidates.len() {
        if base.point.effects.iter().all(|f| f.candidate != candidate) {
            wanted.extend(
                grid(problem, candidate)
                    .into_iter()
                    .map(|values| (candidate, values)),
            );
        }
    }
    let level = rms(&base.residual, &problem.split.train);
    let signatures = wanted.into_par_iter().map(|(candidate, mut values)| {
        let infos = problem.infos(candidate);
        let sizes: Vec<usize> = (0..infos.len()).filter(|&i| infos[i].is_size).collect();
        let mut columns = Vec::new();
        for &chosen in &sizes {
            columns.push(signature_of(
                problem,
                base,
                candidate,
                &mut values,
                chosen,
                &level,
            )?);
        }
        Some(Signature {
            columns,
            candidate,
            values,
            sizes,
        })
    });
    let found: Vec<Option<Signature>> = signatures.collect();
    found.into_iter().flatten().collect()
}

/// A signature so many times the residual is taken anew at a smaller size: the effect, if it is there, is no larger than that.
const FAR_TOO_LARGE: f64 = 4.0;

/// Change of the prediction for one size parameter alone; `values` gets the size at which it was taken.
fn signature_of(
    problem: &Problem,
    base: &Fit,
    candidate: usize,
    values: &mut [f64],
    chosen: usize,
    level: &[f64],
) -> Option<Columns> {
    let infos = problem.infos(candidate);
    let change = |value: f64| {
        let mut alone: Vec<f64> = values.to_vec();
        for (x, info) in alone.iter_mut().zip(infos).filter(|(_, info)| info.is_size) {
            *x = info.neutral;
        }
        alone[chosen] = value;
        let found = Found {
            candidate,
            values: alone,
        };
        let columns = problem.predict(&with(&base.point, found)).ok()?;
        Some(difference(&columns, &base.predicted, 1.0))
    };
    let first = change(values[chosen]);
    let ratio = match &first {
        Some(first) => {
            let size = rms(first, &problem.split.train);
            size.iter()
                .zip(level)
                .map(|(s, r)| s / r.max(f64::MIN_POSITIVE))
                .fold(0.0, f64::max)
        }
        // It cannot be simulated at this size.
        None => 10.0 * FAR_TOO_LARGE,
    };
    if ratio <= FAR_TOO_LARGE {
        return first;
    }
    let neutral = infos[chosen].neutral;
    let smaller = neutral + (values[chosen] - neutral) * (2.0 / ratio).max(1e-4);
    let second = change(smaller);
    if second.is_some() {
        values[chosen] = smaller;
    }
    second.or(first)
}

/// Parts of the typical size at which signatures are taken where the kind names no sizes to start from.
const LEVELS: [f64; 2] = [1.0, 0.2];

/// Starting values: all combinations of the shape parameters' starts, each with all starts of the sizes.
fn grid(problem: &Problem, candidate: usize) -> Vec<Vec<f64>> {
    let infos = problem.infos(candidate);
    let scale = &problem.candidates[candidate].scale;
    let mut grid = vec![Vec::new()];
    // Several sizes start together, at the same place in their lists.
    let levels = infos
        .iter()
        .filter(|p| p.is_size)
        .map(|p| {
            if p.starts.is_empty() {
                LEVELS.len()
            } else {
                p.starts.len()
            }
        })
        .max();
    for info in infos.iter().filter(|info| !info.is_size) {
        let starts = if info.starts.is_empty() {
            vec![info.neutral.clamp(info.min, info.max)]
        } else {
            info.starts.to_vec()
        };
        grid = combine(&grid, &starts);
    }
    let mut all = Vec::new();
    for shape in grid {
        for level in 0..levels.unwrap_or(0) {
            let mut shape = shape.iter();
            let values = infos.iter().zip(scale).map(|(info, scale)| {
                if !info.is_size {
                    *shape.next().expect("one for each shape parameter")
                } else if info.starts.is_empty() {
                    typical(
                        info.neutral,
                        scale * LEVELS[level.min(LEVELS.len() - 1)],
                        info.min,
                        info.max,
                    )
                } else {
                    info.starts[level.min(info.starts.len() - 1)]
                }
            });
            all.push(values.collect());
        }
    }
    all
}

fn typical(neutral: f64, scale: f64, min: f64, max: f64) -> f64 {
    let above = neutral + scale;
    if above <= max {
        above
    } else {
        (neutral - scale).max(min)
    }
}

fn combine(grid: &[Vec<f64>], starts: &[f64]) -> Vec<Vec<f64>> {
    let rows = grid
        .iter()
        .flat_map(|row| starts.iter().map(move |s| [row.as_slice(), &[*s]].concat()));
    rows.collect()
}

/// The point with one effect more.
pub(super) fn with(point: &Point, found: Found) -> Point {
    let mut point = point.clone();
    point.effects.push(found);
    point
}
