//! The step of milling runs in a search.
//!
//! A force that follows chips is met to the second order of the step, and its default step is that
//! of a run that is looked at, not of one that is held against a thousand samples with noise of a
//! hundredth of it. Then an effect whose only merit is a shorter step (a base that hardly gives)
//! fits better. So the step is halved until that moves no output by more than a small part of what
//! it varies.

use std::borrow::Cow;

use truecut_scenario::{ProcessSpec, Scenario};
use truecut_sim::SimError;
use truecut_sim::run::{self, Engine};

use super::{Trial, reduced};
use crate::model::Columns;

/// With the step halved no output may move by more than this part of its deviation from a line; of
/// that a third is left.
const MOST_MOVED: f64 = 1e-3;
/// The step is halved no more often: a run takes longer each time.
const MOST_HALVINGS: usize = 3;
/// Steps that differ by no more than this part of them are equal.
const ROUNDING: f64 = 1e-9;

impl Trial {
    /// Finds the longest step that the search may take.
    ///
    /// # Errors
    /// Whatever makes the scenario unfit to run.
    pub(super) fn find_step(&mut self) -> Result<(), SimError> {
        let is_milling = matches!(self.scenario.process, ProcessSpec::Milling(_));
        if !is_milling || self.scenario.run.time_step_s.is_some() {
            return Ok(());
        }
        let mut step_s = reduced(&self.scenario, &self.measured, &self.robots).time_step_s()?;
        let Some(mut before) = self.nominal_run() else {
            return Ok(());
        };
        for _ in 0..MOST_HALVINGS {
            step_s *= 0.5;
            self.longest_step_s = step_s;
            self.shortest_step_s = self.shortest_step_s.min(step_s * (1.0 - ROUNDING));
            let Some(now) = self.nominal_run() else { break };
            let moved = now.iter().zip(&before).map(|(now, before)| {
                let apart: Vec<f64> = now.iter().zip(before).map(|(a, b)| a - b).collect();
                root_mean_square(&apart) / from_a_line(now).max(f64::MIN_POSITIVE)
            });
            let most = moved.fold(0.0, f64::max);
            before = now;
            if most < MOST_MOVED {
                break;
            }
        }
        Ok(())
    }

    /// `None` where it fails: the search tells.
    fn nominal_run(&self) -> Option<Columns> {
        let rows = self.run(&self.scenario, Engine::REDUCED, None).ok()?;
        Some(self.at_the_data(&rows))
    }

    /// The scenario with a step that a run may take: a whole part of the default one.
    pub(super) fn with_step<'a>(
        &self,
        scenario: &'a Scenario,
        run: &run::Run<'_>,
    ) -> Result<Cow<'a, Scenario>, SimError> {
        if self.longest_step_s == f64::INFINITY {
            return Ok(Cow::Borrowed(scenario));
        }
        let own_s = run.time_step_s()?;
        let parts = (own_s / self.longest_step_s * (1.0 - ROUNDING)).ceil();
        if parts <= 1.0 {
            return Ok(Cow::Borrowed(scenario));
        }
        let mut stepped = scenario.clone();
        stepped.run.time_step_s = Some(own_s / parts);
        Ok(Cow::Owned(stepped))
    }
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Deviation from the line that fits best.
fn from_a_line(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = values.iter().sum::<f64>() / count;
    let pairs = || {
        values
            .iter()
            .enumerate()
            .map(|(k, x)| (k as f64 - middle, x - mean))
    };
    let spread: f64 = pairs().map(|(k, _)| k * k).sum();
    let slope = pairs().map(|(k, x)| k * x).sum::<f64>() / spread.max(f64::MIN_POSITIVE);
    let left: Vec<f64> = pairs().map(|(k, x)| x - slope * k).collect();
    root_mean_square(&left)
}
