//! Least squares by moments of blocks.

use nalgebra::{DMatrix, DVector};
use truecut_scenario::FitSpec;
use truecut_sim::{InverseModel, SimError};

use super::base::Base;
use super::columns::Column;
use crate::trial::parallel::picked;

/// The rows in which a joint moves, as moments of each block and channel, and those in which it
/// stands.
pub(super) struct Rows {
    /// `[block][channel]`.
    moments: Vec<Vec<Moments>>,
    /// By channel.
    standing: Vec<Vec<StandingRow>>,
    /// Of each parameter: whether it is dry friction.
    is_dry: Vec<bool>,
}

struct StandingRow {
    left: f64,
    columns: DVector<f64>,
}

/// Sums over rows.
#[derive(Debug, Clone)]
struct Moments {
    columns: DMatrix<f64>,
    target: DVector<f64>,
    /// Of what the scenario leaves, squared.
    left: f64,
    /// Of the measured drive force, squared.
    measured: f64,
    rows: usize,
}

impl Rows {
    /// # Errors
    /// Fewer rows than unknowns.
    pub fn new(
        model: &InverseModel,
        spec: &FitSpec,
        columns: &[Column],
        base: &Base,
        every: usize,
    ) -> Result<Rows, SimError> {
        let kept: Vec<&Column> = (base.groups.iter())
            .map(|g| &columns[g.members[0].0])
            .collect();
        let predicted = model.predict(&[])?;
        let samples = model.measured().time_s.len().div_ceil(every);
        let unknowns = kept.len();
        let mut rows = Rows {
            moments: vec![vec![Moments::none(unknowns); predicted.len()]; spec.blocks],
            standing: Vec::new(),
            is_dry: kept.iter().map(|column| column.is_dry).collect(),
        };
        for (c, (channel, predicted)) in
            model.measured().channels.iter().zip(&predicted).enumerate()
        {
            let joint = model.joints()[c];
            let rotary = model.channels()[c].unit == truecut_recording::Unit::NewtonMetre;
            let least = if rotary {
                spec.standstill_rad_per_s
            } else {
                spec.standstill_m_per_s
            };
            let [measured, predicted, velocity] =
                [&channel.values, predicted, model.velocity(joint)].map(|x| picked(x, every));
            let valid = picked(&channel.valid, every);
            let mut standing = Vec::new();
            for k in (0..samples).filter(|k| valid[*k]) {
                let row = DVector::from_iterator(unknowns, kept.iter().map(|x| x.values[c][k]));
                let left = measured[k] - predicted[k];
                if velocity[k].abs() > least {
                    rows.moments[k * spec.blocks / samples][c].add(&row, left, measured[k]);
                } else {
                    standing.push(StandingRow { left, columns: row });
                }
            }
            rows.standing.push(standing);
        }
        let all: usize = rows
            .moments
            .iter()
            .flatten()
            .map(|moments| moments.rows)
            .sum();
        if all <= 2 * unknowns {
            let message = format!(
                "the data have {all} rows in which a joint moves, but {unknowns} unknowns need more than twice as many"
            );
            return Err(SimError::scenario("fit", message));
        }
        Ok(rows)
    }

    /// Sums over the blocks but one.
    fn without(&self, block: Option<usize>, weights: &[f64]) -> Moments {
        let mut sum = Moments::none(self.is_dry.len());
        for (b, channels) in self.moments.iter().enumerate() {
            if Some(b) != block {
                for (moments, weight) in channels.iter().zip(weights) {
                    sum.join(moments, *weight);
                }
            }
        }
        sum
    }

    fn of_channel(&self, channel: usize) -> Moments {
        let mut sum = Moments::none(self.is_dry.len());
        for channels in &self.moments {
            sum.join(&channels[channel], 1.0);
        }
        sum
    }

    /// Rows of a channel in which its joint moves.
    pub fn count(&self, channel: usize) -> usize {
        self.of_channel(channel).rows
    }

    /// Root mean square of the measured drive force.
    pub fn measured_rms(&self, channel: usize) -> f64 {
        let sum = self.of_channel(channel);
        (sum.measured / sum.rows.max(1) as f64).sqrt()
    }

    /// Root mean square of what parameters leave of a channel.
    pub fn rms(&self, channel: usize, found: &DVector<f64>) -> f64 {
        let sum = self.of_channel(channel);
        (sum.squares(found) / sum.rows.max(1) as f64).sqrt()
    }

    /// The same, where each block has the parameters that were found without it; and block by
    /// block.
    pub fn held_out(&self, channel: usize, without: &[DVector<f64>]) -> (f64, Vec<f64>) {
        let blocks = self.moments.iter().zip(without);
        let squares: Vec<(f64, f64)> = blocks
            .map(|(of, found)| (of[channel].squares(found), of[channel].rows as f64))
            .collect();
        let all: f64 = squares.iter().map(|(square, _)| square).sum();
        let by_block = squares.iter().map(|(square, rows)| (square / rows).sqrt());
        (
            (all / self.count(channel).max(1) as f64).sqrt(),
            by_block.collect(),
        )
    }

    /// Rows in which the joint stands, and how many of them are within its dry friction and
    /// `noise`.
    pub fn standing(&self, channel: usize, found: &DVector<f64>, noise: f64) -> (usize, usize) {
        let dry = self.of_channel(channel).columns.diagonal();
        let held: f64 = (0..found.len())
            .filter(|&i| self.is_dry[i] && dry[i] > 0.0)
            .map(|i| found[i].abs())
            .sum();
        let rows = &self.standing[channel];
        let within = rows.iter().filter(|row| {
            let smooth: f64 = (0..found.len())
                .filter(|&i| !self.is_dry[i])
                .map(|i| row.columns[i] * found[i])
                .sum();
            (row.left - smooth).abs() <= held + noise
        });
        (rows.len(), within.count())
    }
}

impl Moments {
    fn none(unknowns: usize) -> Moments {
        Moments {
            columns: DMatrix::zeros(unknowns, unknowns),
            target: DVector::zeros(unknowns),
            left: 0.0,
            measured: 0.0,
            rows: 0,
        }
    }

    fn add(&mut self, row: &DVector<f64>, left: f64, measured: f64) {
        self.columns.ger(1.0, row, row, 1.0);
        self.target.axpy(left, row, 1.0);
        self.left += left * left;
        self.measured += measured * measured;
        self.rows += 1;
    }

    fn join(&mut self, other: &Moments, weight: f64) {
        self.columns += &other.columns * weight;
        self.target.axpy(weight, &other.target, 1.0);
        self.left += weight * other.left;
        self.measured += weight * other.measured;
        self.rows += other.rows;
    }

    /// Squares that parameters leave.
    fn squares(&self, found: &DVector<f64>) -> f64 {
        let explained = 2.0 * found.dot(&self.target) - found.dot(&(&self.columns * found));
        (self.left - explained).max(0.0)
    }

    /// Inverse of the matrix of the columns, without directions that do not show; their number, and
    /// the part of each parameter that lies in them.
    fn inverse(&self) -> (DMatrix<f64>, usize, DVector<f64>) {
        let scale = self.columns.diagonal().map(|square| match square > 0.0 {
            true => 1.0 / square.sqrt(),
            false => 0.0,
        });
        let scaled = |matrix: &DMatrix<f64>| {
            let (rows, columns) = matrix.shape();
            DMatrix::from_fn(rows, columns, |i, j| matrix[(i, j)] * scale[i] * scale[j])
        };
        let eigen = scaled(&self.columns).symmetric_eigen();
        let least = DARK * eigen.eigenvalues.max();
        let shown = eigen
            .eigenvalues
            .map(|value| if value > least { 1.0 / value } else { 0.0 });
        let dark = shown.iter().filter(|value| **value == 0.0).count();
        let in_dark = |i: usize| -> f64 {
            let directions = eigen.eigenvectors.row(i).into_owned();
            let parts = directions.iter().zip(&shown);
            let dark = parts.filter(|(_, shown)| **shown == 0.0);
            dark.map(|(part, _)| part * part).sum::<f64>().sqrt()
        };
        let dark_part = DVector::from_fn(shown.len(), |i, _| in_dark(i));
        let inverse =
            &eigen.eigenvectors * DMatrix::from_diagonal(&shown) * eigen.eigenvectors.transpose();
        (scaled(&inverse), dark, dark_part)
    }
}

/// Directions of columns of unit length whose squared singular value is below this part of the
/// largest do not show: noise of a part in ten thousand would decide them.
const DARK: f64 = 1e-8;
/// A parameter of which more than this part lies in them is not seen: its estimate would hold so
/// much of what the scenario says.
const UNSEEN: f64 = 1e-2;
/// Weights stand still after so many turns: they change by the residuals' sizes alone.
const TURNS: usize = 5;

/// Changes of the parameters.
pub(super) struct Solution {
    pub found: DVector<f64>,
    /// With each of the blocks left out.
    pub without: Vec<DVector<f64>>,
    pub undetermined: usize,
    /// Of each parameter, whether the data show it.
    pub seen: Vec<bool>,
    /// Up to a factor.
    covariance: DMatrix<f64>,
}

impl Solution {
    /// Weighted least squares; weights are those of what the fit leaves of each channel.
    pub fn new(rows: &Rows) -> Solution {
        let channels = rows.standing.len();
        let mut found = DVector::zeros(rows.is_dry.len());
        let mut weights = vec![1.0; channels];
        let (mut inverse, mut undetermined) = (DMatrix::zeros(0, 0), 0);
        let mut dark_part = DVector::zeros(0);
        for _ in 0..TURNS {
            for (c, weight) in weights.iter_mut().enumerate() {
                let left = rows.rms(c, &found);
                let floor = 1e-9 * rows.measured_rms(c);
                *weight = 1.0 / left.max(floor).max(f64::MIN_POSITIVE.sqrt()).powi(2);
            }
            let whole = rows.without(None, &weights);
            (inverse, undetermined, dark_part) = whole.inverse();
            found = &inverse * &whole.target;
        }
        let without = (0..rows.moments.len())
            .map(|block| {
                let others = rows.without(Some(block), &weights);
                others.inverse().0 * &others.target
            })
            .collect();
        Solution {
            found,
            without,
            undetermined,
            seen: dark_part.iter().map(|part| *part < UNSEEN).collect(),
            covariance: inverse,
        }
    }

    /// Standard deviation of a sum of the parameters, by the jackknife of blocks.
    pub fn deviation(&self, sum: impl Fn(&DVector<f64>) -> f64) -> f64 {
        let values: Vec<f64> = self.without.iter().map(sum).collect();
        let count = values.len() as f64;
        let squares: f64 = crate::stats::centred(&values).iter().map(|x| x * x).sum();
        ((count - 1.0) / count * squares).sqrt()
    }

    /// Correlation of two parameters in noise alone.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        let c = &self.covariance;
        let size = (c[(i, i)] * c[(j, j)]).sqrt();
        if size > 0.0 { c[(i, j)] / size } else { 0.0 }
    }

    /// What to add of the second parameter to the first so that the sum does not vary with it.
    pub fn regression(&self, i: usize, j: usize) -> f64 {
        -self.covariance[(i, j)] / self.covariance[(j, j)]
    }
}
