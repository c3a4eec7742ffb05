//! Signatures: the change of the prediction for a size of an effect that is not small, since
//! backlash or dry friction have no derivative at zero.

use rayon::prelude::*;
use truecut_scenario::effect::EffectKind;

use super::derivatives::difference;
use super::fit::Fit;
use super::noise::add_columns;
use super::problem::{Found, Point, Problem};
use super::validate::rms;
use crate::model::Columns;

/// Change of the prediction for one candidate at given shape parameters, one for each size
/// parameter.
#[derive(Debug, Clone)]
pub(super) struct Signature {
    pub candidate: usize,
    /// The values at which it was taken, all sizes at once.
    pub values: Vec<f64>,
    /// Indices of its size parameters.
    pub sizes: Vec<usize>,
    /// Change of the prediction for each of them alone.
    pub columns: Vec<Columns>,
    /// What else changes the prediction in proportion to the size.
    pub moments: Vec<Moment>,
    /// A fit starts from these very values: a part of this change is that of no size.
    pub as_taken: bool,
}

/// A parameter whose product with the size adds to the change, as a payload's mass times its centre
/// does: with mass, first and second moments the change is linear, wherever the centre is.
#[derive(Debug, Clone)]
pub(super) struct Moment {
    /// Index of the parameter.
    pub parameter: usize,
    /// How far it was moved to either side, at the size of the signature.
    pub reach: f64,
    /// What that changed, as far as it goes with the parameter.
    pub column: Columns,
    /// And as far as it goes with its square.
    pub square: Columns,
    /// And with its product with each of those before it.
    pub products: Vec<Columns>,
}

/// Signatures of all candidates that the point does not hold, over their grids of starts.
pub(super) fn signatures(problem: &Problem, base: &Fit) -> Vec<Signature> {
    let wanted: Vec<(usize, Vec<Vec<f64>>)> = absent(problem, &base.point)
        .flat_map(|candidate| {
            let grid = grid(problem, candidate);
            grid.into_iter().map(move |levels| (candidate, levels))
        })
        .collect();
    let screening = Screening {
        problem,
        base,
        level: rms(&base.residual, &problem.split.train),
    };
    let found: Vec<Vec<Signature>> = (wanted.into_par_iter())
        .map(|(candidate, levels)| screening.ladder(candidate, levels))
        .collect();
    found.into_iter().flatten().collect()
}

/// Number of tests that a screening at the point makes: one for each value on the grids, whether or
/// not two of them came to the same.
pub(super) fn tests(problem: &Problem, point: &Point) -> usize {
    let grids = absent(problem, point).flat_map(|candidate| grid(problem, candidate));
    grids.map(|levels| levels.len()).sum()
}

/// Candidates that the point does not hold, but those that are looked for at the end.
fn absent(problem: &Problem, point: &Point) -> impl Iterator<Item = usize> {
    let at_the_end = |candidate: &usize| {
        problem.late.contains(candidate) || problem.lengths().any(|one| one == *candidate)
    };
    (problem.searched()).filter(move |candidate| !point.holds(*candidate) && !at_the_end(candidate))
}

/// A signature so many times the residual is taken anew at a smaller size: the effect, if it is
/// there, is no larger than that.
const FAR_TOO_LARGE: f64 = 4.0;
/// And then it is to be so many times the residual.
const LARGE: f64 = 2.0;
/// A size taken anew is no smaller than this part of what it was.
const LEAST_PART: f64 = 1e-4;

/// What all signatures of one screening share.
struct Screening<'a, 'b> {
    problem: &'a Problem<'b>,
    base: &'a Fit,
    /// Of the residual, in each channel.
    level: Vec<f64>,
}

impl Screening<'_, '_> {
    /// Signatures at several levels of the sizes, smallest first; a level that would be taken anew
    /// where one before it is, is left out.
    fn ladder(&self, candidate: usize, levels: Vec<Vec<f64>>) -> Vec<Signature> {
        let infos = self.problem.infos(candidate);
        let sizes: Vec<usize> = (0..infos.len()).filter(|&i| infos[i].is_size).collect();
        let mut ladder: Vec<Signature> = Vec::new();
        for mut values in levels {
            let taken = ladder.iter().any(|smaller| {
                (sizes.iter().zip(&smaller.columns)).all(|(&i, column)| {
                    let neutral = infos[i].neutral;
                    let grown = (values[i] - neutral) / (smaller.values[i] - neutral);
                    self.ratio(column) * grown > FAR_TOO_LARGE
                })
            });
            if taken {
                continue;
            }
            let columns: Option<Vec<Columns>> = (sizes.iter())
                .map(|&chosen| self.taken(candidate, &mut values, chosen))
                .collect();
            let Some(columns) = columns else { continue };
            ladder.push(Signature {
                moments: self.moments(candidate, &values, &sizes, &columns),
                candidate,
                values,
                sizes: sizes.clone(),
                columns,
                as_taken: false,
            });
        }
        ladder
    }

    /// The moments of a candidate that has some, each at the size in `values`.
    fn moments(
        &self,
        candidate: usize,
        values: &[f64],
        sizes: &[usize],
        columns: &[Columns],
    ) -> Vec<Moment> {
        let (&[size], [column]) = (sizes, columns) else {
            return Vec::new();
        };
        let of_candidate = &self.problem.candidates[candidate];
        if of_candidate.kind != EffectKind::Payload {
            return Vec::new();
        }
        let scale = &of_candidate.scale;
        let moved = |parameters: &[(usize, f64)]| -> Option<Columns> {
            let mut moved = values.to_vec();
            for (parameter, side) in parameters {
                moved[*parameter] += side * scale[*parameter];
            }
            let change = self.change(candidate, &moved, size, values[size])?;
            Some(difference(&change, column, 1.0))
        };
        let shapes = (0..values.len()).filter(|parameter| *parameter != size);
        let mut found: Vec<Moment> = Vec::new();
        for parameter in shapes {
            let sides = [1.0, -1.0].map(|side| moved(&[(parameter, side)]));
            let [Some(up), Some(down)] = sides else {
                return Vec::new();
            };
            let with = |other: &Moment| -> Option<Columns> {
                let mut both = moved(&[(parameter, 1.0), (other.parameter, 1.0)])?;
                for alone in [&up, &other.column, &other.square] {
                    add_columns(&mut both, alone, -1.0);
                }
                Some(both)
            };
            let Some(products) = found.iter().map(with).collect() else {
                return Vec::new();
            };
            let column = difference(&up, &down, 0.5);
            found.push(Moment {
                parameter,
                reach: scale[parameter],
                square: difference(&up, &column, 1.0),
                column,
                products,
            });
        }
        found
    }

    /// How large a change is beside the residual, in the channel where it is largest.
    fn ratio(&self, change: &Columns) -> f64 {
        let size = rms(change, &self.problem.split.train);
        let ratios = (size.iter().zip(&self.level)).map(|(s, r)| s / r.max(f64::MIN_POSITIVE));
        ratios.fold(0.0, f64::max)
    }

    /// Change of the prediction for one size parameter alone; `values` gets the size at which it
    /// was taken.
    fn taken(&self, candidate: usize, values: &mut [f64], chosen: usize) -> Option<Columns> {
        let infos = self.problem.infos(candidate);
        let neutral = infos[chosen].neutral;
        let first = self.change(candidate, values, chosen, values[chosen]);
        let ratio = match &first {
            Some(first) => self.ratio(first),
            // It cannot be simulated at this size.
            None => 10.0 * FAR_TOO_LARGE,
        };
        if ratio <= FAR_TOO_LARGE {
            return first;
        }
        let smaller = neutral + (values[chosen] - neutral) * (LARGE / ratio).max(LEAST_PART);
        let second = self.change(candidate, values, chosen, smaller);
        if second.is_some() {
            values[chosen] = smaller;
        }
        second.or(first)
    }

    /// Change of the prediction if one size parameter has the value, and the others do nothing.
    fn change(
        &self,
        candidate: usize,
        values: &[f64],
        chosen: usize,
        value: f64,
    ) -> Option<Columns> {
        let infos = self.problem.infos(candidate);
        let mut alone: Vec<f64> = values.to_vec();
        for (x, info) in alone.iter_mut().zip(infos).filter(|(_, info)| info.is_size) {
            *x = info.neutral;
        }
        alone[chosen] = value;
        let found = Found {
            values: alone,
            ..self.problem.neutral(candidate)
        };
        let columns = self.problem.predict(&with(&self.base.point, found)).ok()?;
        Some(difference(&columns, &self.base.predicted, 1.0))
    }
}

/// Parts of the typical size at which signatures are taken where the kind names no sizes to start
/// from; smallest first.
const LEVELS: [f64; 2] = [0.2, 1.0];

/// Parts of the typical size for a kind. What adds a torque, or moves a motor, in proportion to its
/// size changes the prediction in that proportion, too: one level says all.
fn levels(kind: EffectKind) -> &'static [f64] {
    use EffectKind as K;
    match kind {
        K::JointViscous | K::JointAsymmetricViscous | K::JointRipple | K::JointOffset => {
            &LEVELS[1..]
        }
        _ => &LEVELS,
    }
}

/// Signatures of a candidate at one combination of its shape parameters.
pub(super) fn shaped(
    problem: &Problem,
    base: &Fit,
    candidate: usize,
    shape: Vec<f64>,
) -> Vec<Signature> {
    let screening = Screening {
        problem,
        base,
        level: rms(&base.residual, &problem.split.train),
    };
    let ladders = ladders(problem, candidate, &[shape]).into_iter();
    ladders
        .flat_map(|levels| screening.ladder(candidate, levels))
        .collect()
}

/// Starting values of a candidate for each combination of the shape parameters' starts.
fn grid(problem: &Problem, candidate: usize) -> Vec<Vec<Vec<f64>>> {
    let infos = problem.infos(candidate).iter();
    let scale = &problem.candidates[candidate].scale;
    let mut shapes = vec![Vec::new()];
    for (info, scale) in infos.zip(scale).filter(|(info, _)| !info.is_size) {
        let starts = if info.starts.is_empty() {
            vec![info.neutral.clamp(info.min, info.max)]
        } else {
            moved_to(info.starts, *scale)
        };
        shapes = combine(&shapes, &starts);
    }
    ladders(problem, candidate, &shapes)
}

const A_FEW: usize = 4;

/// Starts of a shape parameter, moved to where the machine's own scale is if that lies beyond them:
/// friction falls by another speed in a joint that turns ten times as fast. More starts than a few
/// are all that there may be.
fn moved_to(starts: &[f64], scale: f64) -> Vec<f64> {
    let (low, high) = (starts[0], starts[starts.len() - 1]);
    if starts.len() > A_FEW {
        return starts.to_vec();
    }
    let factor = scale / scale.clamp(low, high);
    starts.iter().map(|start| start * factor).collect()
}

/// Starting values: for each combination of the shape parameters those of the sizes. Those that are
/// levels of one typical size belong together; those that the kind names stand for themselves.
fn ladders(problem: &Problem, candidate: usize, shapes: &[Vec<f64>]) -> Vec<Vec<Vec<f64>>> {
    let infos = problem.infos(candidate);
    let scale = &problem.candidates[candidate].scale;
    let parts = levels(problem.candidates[candidate].kind);
    let sizes = || infos.iter().filter(|p| p.is_size);
    let own_starts = sizes().map(|p| p.starts.len()).max().unwrap_or(0);
    let is_ladder = own_starts == 0;
    let levels = match sizes().any(|p| p.starts.is_empty()) {
        true => own_starts.max(parts.len()),
        false => own_starts,
    };
    // Several sizes start together, at the same place in their lists.
    let at_level = |shape: &[f64], level: usize| -> Vec<f64> {
        let mut shape = shape.iter();
        let values = infos.iter().zip(scale).map(|(info, scale)| {
            if !info.is_size {
                *shape.next().expect("one for each shape parameter")
            } else if info.starts.is_empty() {
                let part = parts[level.min(parts.len() - 1)];
                typical(info.neutral, scale * part, info.min, info.max)
            } else {
                info.starts[level.min(info.starts.len() - 1)]
            }
        });
        values.collect()
    };
    let ladders = shapes.iter().flat_map(|shape| {
        let values = (0..levels).map(|level| at_level(shape, level));
        match is_ladder {
            true => vec![values.collect::<Vec<_>>()],
            false => values.map(|values| vec![values]).collect(),
        }
    });
    ladders.collect()
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
