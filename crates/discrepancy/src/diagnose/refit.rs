//! A model with given effects, fitted to the data: what it is told by, without a search.

use std::collections::BTreeMap;

use truecut_scenario::effect::Effect;

use super::answer::{Cause, Nominal};
use super::evidence::{causes, nominal as nominal_numbers};
use super::fit::{Fit, fit};
use super::noise::Noise;
use super::problem::Problem;
use super::uncertainty::standard_errors;
use super::validate::rms;
use super::{DiagnoseError, Observation, Options, Progress};
use crate::model::{Columns, Model};

/// Such a model.
pub(crate) struct Refit {
    pub causes: Vec<Cause>,
    pub numbers: Vec<Nominal>,
    /// As they were fitted.
    pub nominal: Vec<f64>,
    pub effects: Vec<Effect>,
    /// For all samples.
    pub predicted: Columns,
    /// Root mean square of what is left in the last part, by channel.
    pub after: BTreeMap<String, f64>,
    pub predictions: usize,
}

/// The numbers of these effects and the nominal ones, fitted to all but the last part.
///
/// # Errors
/// The simulation cannot be run.
pub(crate) fn refitted(
    model: &dyn Model,
    data: &Observation,
    options: &Options,
    nominal: &[f64],
    effects: &[Effect],
) -> Result<Refit, DiagnoseError> {
    let quiet = |_: Progress| {};
    let problem = Problem::new(model, data, options, &quiet);
    let mut found = fitted(&problem, nominal, effects)?;
    found.predicted = problem.predict_whole(&found.point)?;
    found.residual = data.residual(&found.predicted);
    let errors = standard_errors(&problem, &found, &problem.split.development)?;
    let left = rms(&found.residual, &problem.split.test);
    let names = model.channels().iter().map(|spec| spec.name.clone());
    Ok(Refit {
        causes: causes(&problem, &found, &errors)?,
        numbers: nominal_numbers(&problem, &found, &errors),
        effects: problem.effects(&found.point),
        after: names.zip(left).collect(),
        nominal: found.point.nominal,
        predicted: found.predicted,
        predictions: problem.predictions(),
    })
}

/// Minus twice the log-likelihood of the data, with the numbers of these effects and the nominal
/// ones fitted to all but the last part; and how many simulations that took.
///
/// # Errors
/// The simulation cannot be run.
pub(crate) fn likelihood(
    model: &dyn Model,
    data: &Observation,
    options: &Options,
    nominal: &[f64],
    effects: &[Effect],
) -> Result<(f64, usize), DiagnoseError> {
    let quiet = |_: Progress| {};
    let problem = Problem::new(model, data, options, &quiet);
    let found = fitted(&problem, nominal, effects)?;
    Ok((found.objective, problem.predictions()))
}

fn fitted(problem: &Problem, nominal: &[f64], effects: &[Effect]) -> Result<Fit, DiagnoseError> {
    let start = problem.at(nominal, effects);
    let rows = &problem.split.development;
    let residual = problem.data.residual(&problem.predict(&start)?);
    let orders = Noise::orders(&residual, rows, &problem.floor);
    Ok(fit(problem, start, rows, &orders, true)?)
}
