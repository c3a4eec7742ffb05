//! Whether another set-up explains more than any causes do: an arm that hangs, a clock that is not
//! the data's, columns that are swapped.

mod swapped;

use truecut_recording::significant;

use super::{DiagnoseError, Observation};
use crate::model::{Columns, Model};
use crate::stats::deviation;

/// A set-up is told if it leaves less than this part of what the causes leave: it has no value to
/// fit but the friction of each joint, where the causes were chosen and fitted.
const FAR_LESS: f64 = 0.5;
/// What leaves less than this part of the drive forces has no need of another set-up.
const ENOUGH: f64 = 0.01;

/// What leaves more than this part of the outputs fits none of them, however much more is left as
/// it is: of many set-ups one always leaves less than a model that is wrong altogether.
const FITTING: f64 = 0.5;

/// What leaves so many times as much as the best is not told beside it.
const HOPELESS: f64 = 10.0;

/// The set-up that explains far more than `after`, in one sentence.
pub(crate) fn doubt(model: &dyn Model, data: &Observation, after: &Columns) -> Option<String> {
    best(model, data, after).map(|(_, told)| told)
}

/// What that set-up leaves, and the sentence.
fn best(model: &dyn Model, data: &Observation, after: &Columns) -> Option<(f64, String)> {
    let now = left(data, after);
    if now < ENOUGH || now.is_nan() {
        return None;
    }
    let set_ups = model.set_ups().into_iter();
    let set_ups = set_ups.chain(swapped::set_ups(model, data));
    let sized = set_ups.map(|one| (left(data, &one.predicted), one.told));
    let (best, told) = sized.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let percent = |part: f64| significant(100.0 * part, 2);
    (best < (FAR_LESS * now).min(FITTING)).then(|| {
        let told = format!(
            "Look at the set-up first: if {told}, {} % of the outputs is left with nothing but friction fitted, and {} % \
             as it is.",
            percent(best),
            percent(now)
        );
        (best, told)
    })
}

/// A factor on drive forces may be what a clock does to them: units and the best set-up, that which
/// leaves less first. `in_units` is what the model predicts in the units that were meant.
pub(super) fn or_units(
    model: &dyn Model,
    data: &Observation,
    [before, in_units]: [&Columns; 2],
    units: DiagnoseError,
) -> DiagnoseError {
    let Some((by_set_up, told)) = best(model, data, before) else {
        return units;
    };
    let by_units = left(data, in_units);
    if HOPELESS * by_units < by_set_up {
        return units;
    }
    if by_units < by_set_up {
        return DiagnoseError::SetUp {
            told: format!("{units}."),
            otherwise: Some(told),
        };
    }
    DiagnoseError::SetUp {
        told,
        otherwise: (by_units <= HOPELESS * by_set_up).then(|| units.to_string()),
    }
}

/// Root mean square over the channels of what is left over what the channel does.
fn left(data: &Observation, predicted: &Columns) -> f64 {
    let shares = data.outputs.iter().zip(predicted).map(|(output, column)| {
        let rows = output.values.iter().zip(column).zip(&output.valid);
        let rows: Vec<(f64, f64)> = rows
            .filter(|(_, valid)| **valid)
            .map(|((measured, predicted), _)| (*measured, measured - predicted))
            .collect();
        let measured: Vec<f64> = rows.iter().map(|(measured, _)| *measured).collect();
        let square: f64 = rows.iter().map(|(_, left)| left * left).sum();
        square / rows.len().max(1) as f64 / deviation(&measured).powi(2)
    });
    let shares: Vec<f64> = shares.filter(|share| share.is_finite()).collect();
    (shares.iter().sum::<f64>() / shares.len().max(1) as f64).sqrt()
}
