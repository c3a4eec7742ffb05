//! A few channels of a run, as fast as they can be had.

use truecut_recording::{ChannelSpec, Measured, Outcome};

use super::request::Run;
use crate::cell::{Cell, RunEnd};
use crate::engine::Engine;
use crate::error::SimError;

/// Columns of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// The channels asked for, in the order of `columns`.
    pub channels: Vec<ChannelSpec>,
    /// Times, s.
    pub time_s: Vec<f64>,
    /// One column for each channel, SI.
    pub columns: Vec<Vec<f64>>,
    /// How the run ended.
    pub outcome: Outcome,
}

/// Rows that come at the data's interval but for this part of it are at their times.
const MET: f64 = 1e-6;

impl Run<'_> {
    /// Runs with nothing kept but the rows of the channels named (all if none is named): no energy
    /// balance, no findings, no claims, no sinks. With measured data, whatever the process, rows
    /// come at the data's times, or at every step where steps do not meet these. With `until_s` the
    /// run ends there, but for a few rows more, so that whoever reads between rows finds
    /// neighbours.
    ///
    /// # Errors
    /// Whatever makes the scenario unfit to run; a step shorter than the engine may take; a channel
    /// that it does not have. The fault of a key is not yet at its place in the file: see
    /// [`super::RunError::of`].
    pub fn rows(&self, channels: &[&str], until_s: Option<f64>) -> Result<Rows, SimError> {
        let mut cell = self.cell_at_the_times()?;
        self.check_step(&cell)?;
        if let Some(until_s) = until_s {
            cell.end_after(until_s);
        }
        let all = cell.channels().to_vec();
        let kept: Vec<usize> = if channels.is_empty() {
            (0..all.len()).collect()
        } else {
            (channels.iter())
                .map(|name| cell.channel_index(name))
                .collect::<Result<_, _>>()?
        };
        let mut rows = Rows {
            channels: kept.iter().map(|i| all[*i].clone()).collect(),
            time_s: Vec::with_capacity(cell.rows()),
            columns: kept
                .iter()
                .map(|_| Vec::with_capacity(cell.rows()))
                .collect(),
            outcome: Outcome::Completed,
        };
        cell.keep_only(&kept);
        let end = cell.run_rows(|time_s, row| {
            rows.time_s.push(time_s);
            for (column, index) in rows.columns.iter_mut().zip(&kept) {
                column.push(row[*index]);
            }
        });
        rows.outcome = end.outcome;
        Ok(rows)
    }

    /// What the run ends with: no row is kept.
    pub(crate) fn end(&self) -> Result<RunEnd, SimError> {
        let cell = self.cell(&*self.resolved()?, self.measured)?;
        Ok(cell.run_rows(|_, _| {}))
    }

    /// The time step of [`Run::rows`], s.
    ///
    /// # Errors
    /// Whatever makes the scenario unfit to run.
    pub fn time_step_s(&self) -> Result<f64, SimError> {
        Ok(self.cell_at_the_times()?.time_step_s())
    }

    /// Natural frequencies of the arm as it starts, effects included, slowest first, Hz.
    ///
    /// # Errors
    /// Whatever makes the scenario unfit to run; an arm without springs.
    pub fn modes_hz(&self) -> Result<Vec<f64>, SimError> {
        self.cell_at_the_times()?.modes_hz()
    }

    fn cell_at_the_times(&self) -> Result<Cell, SimError> {
        let mut scenario = self.resolved()?.into_owned();
        let Some(interval_s) = self.measured.map(Measured::interval_s) else {
            return self.cell(&scenario, self.measured);
        };
        scenario.run.record_interval_s = Some(interval_s);
        let mut cell = self.cell(&scenario, self.measured)?;
        let is_met = (cell.row_interval_s() / interval_s - 1.0).abs() < MET;
        if !is_met {
            // Whoever reads between rows finds near ones: steps of rapier, and of milling, whose
            // force jumps and whose tool rings between two samples.
            cell.keep_every_step();
        }
        Ok(cell)
    }

    fn check_step(&self, cell: &Cell) -> Result<(), SimError> {
        match self.engine {
            Engine::Reduced {
                shortest_step_s, ..
            } if cell.time_step_s() < shortest_step_s => Err(SimError::scenario(
                "run.time_step_ms",
                format!(
                    "the run needs steps of {:.3e} s, but {shortest_step_s:.3e} s is the shortest allowed",
                    cell.time_step_s()
                ),
            )),
            _ => Ok(()),
        }
    }
}
