//! How far the searches of a comparison may go, all together.

use super::Between;
use super::change::Change;
use crate::diagnose::{
    self, DiagnoseError, Observation, Options, Part, Progress, Refit, explain, refitted,
};
use crate::model::Model;
use crate::trial::Trial;
use truecut_scenario::effect::Effect;

/// What was done of it, and what may be.
pub(super) struct Work<'a> {
    pub options: &'a Options,
    pub progress: &'a (dyn Fn(Progress) + Sync),
    /// Simulations made.
    pub made: usize,
}

/// Searches between which all simulations are divided: the first recording by itself, changes, and
/// twice these anew, with others that both share.
pub const SEARCHES: usize = 4;

impl Work<'_> {
    /// The next search: it may take its part of what all may.
    fn part(&self, has_units: bool) -> Part {
        Part {
            has_units,
            made: self.made,
            most: self.options.max_predictions.div_ceil(SEARCHES),
        }
    }

    /// The first recording by itself.
    pub fn diagnose(&mut self, trial: &Trial) -> Result<diagnose::Answer, DiagnoseError> {
        self.explained(trial, &trial.observation, true)
    }

    /// The search for changes.
    pub fn search(
        &mut self,
        model: &Change,
        pair: &Between,
    ) -> Result<diagnose::Answer, DiagnoseError> {
        self.explained(model, &pair.observation, false)
    }

    fn explained(
        &mut self,
        model: &dyn Model,
        data: &Observation,
        has_units: bool,
    ) -> Result<diagnose::Answer, DiagnoseError> {
        let part = self.part(has_units);
        let found = explain(model, data, self.options, self.progress, part)?;
        self.made += found.diagnosis.work.predictions;
        Ok(found)
    }

    /// These changes, fitted to the data.
    pub fn refitted(
        &mut self,
        model: &Change,
        data: &Observation,
        nominal: &[f64],
        effects: &[Effect],
    ) -> Result<Refit, DiagnoseError> {
        let found = refitted(model, data, self.options, nominal, effects)?;
        self.made += found.predictions;
        Ok(found)
    }
}
