//! A cubic B-spline surface through points at given parameters: least squares, with knots where it
//! lies off (The NURBS Book, section 9.4).

use nalgebra::Vector3;
use rayon::prelude::*;

use super::super::error::{SurfaceFault, place};
use super::super::knots::Knots;
use super::super::{Forms, NurbsPatch, Surface};
use super::chart::Chart;
use super::samples::Sample;

const DEGREE: usize = 3;
/// Spans along the longer side to begin with.
const FIRST_SPANS: f64 = 6.0;
/// Times that spans are halved where the patch lies off.
const ROUNDS: usize = 6;
/// Most control points along a side: more follow the roughness of a mesh, no face.
const MOST_POINTS: usize = 96;
/// Share of the allowed deviation that is aimed at in the vertices.
const AIM: f64 = 0.3;
/// What bending counts, beside the points near a control point: it decides only where there are
/// none, within holes and beyond the outline.
const BENDING: f64 = 1e-6;

/// A patch and how far the samples lie off it.
pub(super) struct Fitted {
    pub(super) patch: NurbsPatch,
    pub(super) at_vertices_m: f64,
    pub(super) deviation_m: f64,
    pub(super) control_points: [usize; 2],
}

/// A patch that comes as near to the samples as asked for.
///
/// # Errors
/// If it does not with as many control points as are taken.
pub(super) fn fit(samples: &[Sample], chart: &Chart, limit_m: f64) -> Result<Fitted, SurfaceFault> {
    let lengths_m = chart.lengths_m();
    let longer_m = lengths_m[0].max(lengths_m[1]);
    let mut breaks = lengths_m.map(|length_m| {
        let spans = (FIRST_SPANS * length_m / longer_m).round().max(2.0) as usize;
        (0..=spans)
            .map(|k| k as f64 / spans as f64)
            .collect::<Vec<f64>>()
    });
    let mut best: Option<(Fitted, Vector3<f64>)> = None;
    for _ in 0..=ROUNDS {
        let patch = through(samples, &breaks)?;
        let off_m: Vec<f64> = samples
            .par_iter()
            .map(|sample| off_m(&patch, sample))
            .collect();
        let worst = |counts: &dyn Fn(&Sample) -> bool| {
            let each = samples
                .iter()
                .zip(&off_m)
                .filter(|(sample, _)| counts(sample));
            each.fold(
                (0.0, Vector3::zeros()),
                |(most, at), (sample, off)| match *off > most {
                    true => (*off, sample.point_m),
                    false => (most, at),
                },
            )
        };
        let at_vertices_m = worst(&|sample| sample.is_vertex).0;
        let (deviation_m, at) = worst(&|_| true);
        let fitted = Fitted {
            patch,
            at_vertices_m,
            deviation_m,
            control_points: [0, 1].map(|k| breaks[k].len() + DEGREE - 1),
        };
        if best
            .as_ref()
            .is_none_or(|(best, _)| deviation_m < best.deviation_m)
        {
            best = Some((fitted, at));
        }
        let aim_m = AIM * limit_m;
        if at_vertices_m <= aim_m || !refined(&mut breaks, samples, &off_m, aim_m) {
            break;
        }
    }
    match best {
        Some((fitted, _)) if fitted.deviation_m <= limit_m => Ok(fitted),
        Some((fitted, at)) => Err(SurfaceFault::Deviates {
            deviation_mm: fitted.deviation_m * 1e3,
            at: place(&(at * 1e3)),
            at_vertices_mm: fitted.at_vertices_m * 1e3,
            limit_mm: limit_m * 1e3,
            points: fitted.control_points,
        }),
        None => Err(SurfaceFault::EmptyMesh),
    }
}

/// Distance of a sample from the patch along its normal.
fn off_m(patch: &NurbsPatch, sample: &Sample) -> f64 {
    let jet = patch.jet(sample.uv[0], sample.uv[1]);
    let way = sample.point_m - jet.point_m;
    Forms::of(&jet).map_or_else(|| way.norm(), |forms| way.dot(&forms.normal).abs())
}

/// Halves the spans that hold a vertex which lies farther off; whether there were any, and no more
/// control points than are taken.
fn refined(breaks: &mut [Vec<f64>; 2], samples: &[Sample], off_m: &[f64], aim_m: f64) -> bool {
    for (k, breaks) in breaks.iter_mut().enumerate() {
        let spans = breaks.len() - 1;
        let mut wanted = vec![false; spans];
        for (sample, off) in samples.iter().zip(off_m) {
            if sample.is_vertex && *off > aim_m {
                let span = breaks.partition_point(|b| *b <= sample.uv[k]);
                wanted[span.clamp(1, spans) - 1] = true;
            }
        }
        let middles: Vec<f64> = (0..spans)
            .filter(|span| wanted[*span])
            .map(|span| 0.5 * (breaks[span] + breaks[span + 1]))
            .collect();
        if middles.is_empty() || breaks.len() + middles.len() + DEGREE - 1 > MOST_POINTS {
            return false;
        }
        breaks.extend(middles);
        breaks.sort_by(f64::total_cmp);
    }
    true
}

/// The patch of least squares over spans.
fn through(samples: &[Sample], breaks: &[Vec<f64>; 2]) -> Result<NurbsPatch, SurfaceFault> {
    let knots = breaks.each_ref().map(|breaks| {
        let [first, last] = [breaks[0], breaks[breaks.len() - 1]];
        let ends = |at: f64| std::iter::repeat_n(at, DEGREE);
        let all = ends(first).chain(breaks.iter().copied()).chain(ends(last));
        all.collect::<Vec<f64>>()
    });
    let counts = knots.each_ref().map(|knots| knots.len() - DEGREE - 1);
    let along = [
        Knots::new("u", DEGREE, knots[0].clone(), counts[0])?,
        Knots::new("v", DEGREE, knots[1].clone(), counts[1])?,
    ];
    let mut equations = Banded::new(counts);
    let mut total = 0.0;
    for sample in samples.iter().filter(|sample| sample.weight > 0.0) {
        let [in_u, in_v] = [0, 1].map(|k| along[k].basis(sample.uv[k]));
        let mut terms = [(0, 0.0); (DEGREE + 1) * (DEGREE + 1)];
        for (k, term) in terms.iter_mut().enumerate() {
            let (i, j) = (k / (DEGREE + 1), k % (DEGREE + 1));
            *term = (
                (in_u.first + i) * counts[1] + in_v.first + j,
                in_u.derivatives[0][i] * in_v.derivatives[0][j],
            );
        }
        equations.add(&terms, sample.weight, &sample.point_m);
        total += sample.weight;
    }
    bend(
        &mut equations,
        &knots,
        counts,
        BENDING * total / (counts[0] * counts[1]) as f64,
    );
    let points = equations.solved();
    let rows: Vec<Vec<Vector3<f64>>> = points.chunks(counts[1]).map(<[_]>::to_vec).collect();
    let ones = vec![vec![1.0; counts[1]]; counts[0]];
    NurbsPatch::new([DEGREE; 2], knots, &rows, &ones)
}

/// Each control point near the straight line between its neighbours, by their places (Greville's
/// abscissae).
fn bend(equations: &mut Banded, knots: &[Vec<f64>; 2], counts: [usize; 2], weight: f64) {
    let places = knots.each_ref().map(|knots| {
        let inner = knots.windows(DEGREE).skip(1);
        inner
            .map(|w| w.iter().sum::<f64>() / DEGREE as f64)
            .collect::<Vec<f64>>()
    });
    let strides = [counts[1], 1];
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            let index = i * counts[1] + j;
            for (k, at) in [i, j].into_iter().enumerate() {
                if at == 0 || at + 1 == counts[k] {
                    continue;
                }
                let before = places[k][at] - places[k][at - 1];
                let after = places[k][at + 1] - places[k][at];
                let terms = [
                    (index - strides[k], after / (before + after)),
                    (index, -1.0),
                    (index + strides[k], before / (before + after)),
                ];
                equations.add(&terms, weight, &Vector3::zeros());
            }
        }
    }
}

/// Normal equations of control points, of which only near ones meet in a term.
struct Banded {
    width: usize,
    /// Row by row: the diagonal last, before it what stands to its left.
    lower: Vec<f64>,
    right: Vec<Vector3<f64>>,
}

impl Banded {
    fn new([rows, columns]: [usize; 2]) -> Self {
        let width = DEGREE * columns + DEGREE + 1;
        Self {
            width,
            lower: vec![0.0; rows * columns * width],
            right: vec![Vector3::zeros(); rows * columns],
        }
    }

    /// Σ c x = value, weighted.
    fn add(&mut self, terms: &[(usize, f64)], weight: f64, value: &Vector3<f64>) {
        for (row, one) in terms {
            self.right[*row] += value * (weight * one);
            for (column, other) in terms.iter().filter(|(column, _)| column <= row) {
                let at = (row + 1) * self.width - 1 - (row - column);
                self.lower[at] += weight * one * other;
            }
        }
    }

    /// Cholesky's method within the band.
    fn solved(mut self) -> Vec<Vector3<f64>> {
        let (count, width) = (self.right.len(), self.width);
        for row in 0..count {
            let (above, own) = self.lower.split_at_mut(row * width);
            let own = &mut own[..width];
            let first = (row + 1).saturating_sub(width);
            for column in first..=row {
                // Columns that both rows have within the band.
                let from = first.max((column + 1).saturating_sub(width));
                let here = &own[width - 1 - (row - from)..width - 1 - (row - column)];
                let sum = if column < row {
                    let there = &above[column * width..(column + 1) * width];
                    let there = &there[width - 1 - (column - from)..width - 1];
                    here.iter().zip(there).map(|(a, b)| a * b).sum::<f64>()
                } else {
                    here.iter().map(|a| a * a).sum::<f64>()
                };
                let at = width - 1 - (row - column);
                own[at] = if column < row {
                    (own[at] - sum) / above[(column + 1) * width - 1]
                } else {
                    (own[at] - sum).max(f64::MIN_POSITIVE).sqrt()
                };
            }
        }
        let entry = |row: usize, column: usize| self.lower[(row + 1) * width - 1 - (row - column)];
        for row in 0..count {
            let first = (row + 1).saturating_sub(width);
            let mut value = self.right[row];
            for column in first..row {
                value -= self.right[column] * entry(row, column);
            }
            self.right[row] = value / entry(row, row);
        }
        for row in (0..count).rev() {
            let mut value = self.right[row];
            for below in row + 1..count.min(row + width) {
                value -= self.right[below] * entry(below, row);
            }
            self.right[row] = value / entry(row, row);
        }
        self.right
    }
}
