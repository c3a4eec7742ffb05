//! The answer of a diagnosis in the full model: the search uses the reduced plant.

use crate::diagnose::Answer;
use crate::model::{Columns, Model};
use crate::trial::Trial;

/// A diagnosis with the predictions of the full model.
#[derive(Debug)]
pub struct Confirmed {
    /// The answer, its errors on the test part those of the full model.
    pub answer: Answer,
    /// The nominal model's outputs, at the samples of the data.
    pub nominal: Columns,
    /// The extended model's.
    pub extended: Columns,
    /// Why the full model could not be run, if so; then outputs and errors are those of the search.
    pub failure: Option<String>,
}

impl Confirmed {
    /// Runs nominal and extended model in full, and scores them on the test part.
    pub fn of(trial: &Trial, mut answer: Answer) -> Confirmed {
        let before: Vec<f64> = trial.nominal().iter().map(|one| one.value).collect();
        let (nominal, extended) = rayon::join(
            || trial.confirm(&before, &[]),
            || trial.confirm(&answer.nominal, &answer.effects),
        );
        let failures = [nominal.as_ref().err(), extended.as_ref().err()];
        let failure = failures
            .into_iter()
            .flatten()
            .next()
            .map(ToString::to_string);
        let nominal = nominal.unwrap_or_else(|_| answer.before.clone());
        let extended = extended.unwrap_or_else(|_| answer.after.clone());
        if failure.is_none() {
            score(trial, &mut answer, &nominal, &extended);
        }
        Confirmed {
            answer,
            nominal,
            extended,
            failure,
        }
    }
}

/// Errors on the test part, of the full model.
fn score(trial: &Trial, answer: &mut Answer, nominal: &Columns, extended: &Columns) {
    for (index, spec) in trial.channels().iter().enumerate() {
        let measured = &trial.observation.outputs[index].values;
        let rows = &answer.test_rows[index];
        let rms = |column: &[f64]| {
            let squares = rows
                .iter()
                .map(|&row| (measured[row] - column[row]).powi(2));
            (squares.sum::<f64>() / rows.len().max(1) as f64).sqrt()
        };
        if let Some(errors) = answer.diagnosis.channels.get_mut(&spec.name) {
            errors.before = rms(&nominal[index]);
            errors.after = rms(&extended[index]);
        }
    }
}
