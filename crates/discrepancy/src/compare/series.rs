//! The series that a comparison works on.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use truecut_recording::ChannelSpec;

use crate::stats::distributions::{t_quantile, t_tail};

/// A measured and the simulated channel, at the same uniform times.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    /// Name, unit and meaning.
    pub spec: &'a ChannelSpec,
    /// SI; finite also where not valid.
    pub measured: &'a [f64],
    /// Whether a measured sample is valid.
    pub valid: &'a [bool],
    /// SI, at every time.
    pub simulated: &'a [f64],
    /// Known standard deviation of the measurement's noise, SI.
    pub noise: Option<f64>,
}

impl Pair<'_> {
    /// Measured minus simulated; zero where the measurement is not valid.
    pub fn residual(&self) -> Vec<f64> {
        let rows = self.measured.iter().zip(self.simulated).zip(self.valid);
        rows.map(|((measured, simulated), valid)| if *valid { measured - simulated } else { 0.0 })
            .collect()
    }
}

/// Kind of a signal that the residual may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A joint's coordinate.
    Position,
    /// A joint's velocity; only its sign is used.
    Velocity,
    /// The angle of the spindle, rad, modulo one turn.
    SpindlePhase,
    /// A force or torque.
    Load,
    /// Time since the first sample.
    Time,
}

/// A signal that may explain the residual.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanatory {
    /// Name, unit and meaning.
    pub spec: ChannelSpec,
    /// Its kind.
    pub kind: Kind,
    /// SI, at every time.
    pub values: Vec<f64>,
}

impl Explanatory {
    pub(super) fn new(spec: ChannelSpec, kind: Kind, values: Vec<f64>) -> Explanatory {
        Explanatory { spec, kind, values }
    }
}

/// An estimate with its standard error, and a test against its neutral value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error under coloured noise, as one reads it: the 95 % interval reaches 1.96 of
    /// it to either side. It includes that the noise's spectrum is known with few degrees of
    /// freedom.
    pub standard_error: f64,
    /// Degrees of freedom of the noise's spectrum; the interval follows Student's law with so many.
    pub degrees_of_freedom: f64,
    /// Two-sided p-value of the neutral value.
    pub p_value: f64,
}

/// Half the 95 % interval, in the standard error of a normal variable.
const NORMAL: f64 = 1.959_964;

impl Estimate {
    /// The error of `value` over `scale` follows Student's law with so many degrees of freedom.
    pub(super) fn new(value: f64, neutral: f64, scale: f64, degrees: f64) -> Estimate {
        let distance = (value - neutral).abs();
        let p_value = if distance == 0.0 {
            1.0
        } else {
            (2.0 * t_tail(distance / scale, degrees)).min(1.0)
        };
        Estimate {
            value,
            standard_error: scale * t_quantile(0.05, degrees) / NORMAL,
            degrees_of_freedom: degrees.min(1e6),
            p_value,
        }
    }
}

/// Mean over the valid samples.
pub(super) fn mean(values: &[f64], valid: &[bool]) -> f64 {
    let counted = values.iter().zip(valid).filter(|(_, valid)| **valid);
    let (sum, count) = counted.fold((0.0, 0.0), |(sum, count), (x, _)| (sum + x, count + 1.0));
    if count > 0.0 { sum / count } else { f64::NAN }
}

/// RMS over the valid samples.
pub(super) fn rms(values: &[f64], valid: &[bool]) -> f64 {
    let squares: Vec<f64> = values.iter().map(|x| x * x).collect();
    mean(&squares, valid).sqrt()
}

/// Values less their mean, zero where not valid.
pub(super) fn centred(values: &[f64], valid: &[bool]) -> Vec<f64> {
    let mean = mean(values, valid);
    let rows = values.iter().zip(valid);
    rows.map(|(x, valid)| if *valid { x - mean } else { 0.0 })
        .collect()
}

/// Least squares on a few columns that are zero where samples are not valid: coefficients and the
/// inverse of the normal matrix. `None` if the columns are linearly dependent.
pub(super) fn least_squares(
    columns: &[Vec<f64>],
    target: &[f64],
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let count = columns.len();
    let normal = DMatrix::from_fn(count, count, |i, j| dot(&columns[i], &columns[j]));
    let right = DVector::from_fn(count, |i, _| dot(&columns[i], target));
    // Columns of different units: judged after scaling.
    let scale = DVector::from_fn(count, |i, _| normal[(i, i)].sqrt());
    if scale.iter().any(|one| one.is_nan() || *one <= 0.0) {
        return None;
    }
    let scaled = DMatrix::from_fn(count, count, |i, j| normal[(i, j)] / scale[i] / scale[j]);
    if scaled.clone().symmetric_eigen().eigenvalues.min() < 1e-10 {
        return None;
    }
    let inverse = scaled.cholesky()?.inverse();
    let inverse = DMatrix::from_fn(count, count, |i, j| inverse[(i, j)] / scale[i] / scale[j]);
    Some((&inverse * right, inverse))
}
