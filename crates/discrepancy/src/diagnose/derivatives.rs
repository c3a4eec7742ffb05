//! Derivatives of the prediction by finite differences.

use rayon::prelude::*;

use super::data::Rows;
use super::problem::{Point, Problem};
use crate::model::{Columns, PredictError};

/// Change of the prediction at the rows per unit of each variable, by finite differences; of the
/// first variables it may be known.
///
/// # Errors
/// The simulation can be run on neither side of the point.
pub(super) fn jacobian(
    problem: &Problem,
    rows: &Rows,
    point: &Point,
    predicted: &Columns,
    known: Vec<Columns>,
) -> Result<Vec<Columns>, PredictError> {
    let variables = problem.variables(point);
    let values: Vec<f64> = variables.iter().map(|v| v.value).collect();
    let wanted = variables.par_iter().enumerate().skip(known.len());
    let columns = wanted.map(|(i, v)| {
        let sides = if v.value + v.step <= v.max {
            [v.step, -v.step]
        } else {
            [-v.step, v.step]
        };
        let mut failure = None;
        for step in sides {
            let mut moved = values.clone();
            moved[i] += step;
            match problem.predict_for(rows, &problem.with_values(point, &moved)) {
                Ok(columns) => return Ok(difference(&columns, predicted, 1.0 / step)),
                Err(error) => failure = Some(error),
            }
        }
        Err(failure.expect("both sides failed"))
    });
    let columns: Result<Vec<Columns>, PredictError> = columns.collect();
    Ok([known, columns?].concat())
}

/// `(a - b) * factor`.
pub(super) fn difference(a: &Columns, b: &Columns, factor: f64) -> Columns {
    let pairs = a.iter().zip(b);
    pairs
        .map(|(a, b)| a.iter().zip(b).map(|(x, y)| (x - y) * factor).collect())
        .collect()
}
