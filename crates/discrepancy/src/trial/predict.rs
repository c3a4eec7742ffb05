//! Predictions at the times of the data: by inverse dynamics, by means, or by runs of which the
//! last are kept.

use truecut_recording::{ChannelSpec, Outcome};
use truecut_scenario::Scenario;
use truecut_scenario::effect::{ClockEffect, Effect, EffectKind, SensorEffect, Typed};
use truecut_sim::SimError;
use truecut_sim::measurement::{ChannelModel, Sensors};
use truecut_sim::run::{self, Engine, Rows};

use super::cache::RunKey;
use super::candidates::delays_drive_forces;
use super::{EARLIEST_S, Kind, Trial, parallel, reduced, sampling};
use crate::model::{Candidate, Columns, PredictError};

/// Whether a sensor shows what is still to come further ahead than that.
fn comes_early(effect: &Effect) -> bool {
    matches!(
        effect.typed(),
        Some(
            Typed::Sensor(_, SensorEffect::Delay { delay_s })
            | Typed::Clock(ClockEffect::Delay { delay_s })
        ) if delay_s < -EARLIEST_S
    )
}

impl Trial {
    /// The scenario with the start that the data say.
    pub(crate) fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Effects that the scenario has itself, as candidates.
    pub(crate) fn held(&self) -> &[Candidate] {
        &self.held
    }

    /// Whether effects of this kind each add to the outputs in proportion to their sizes.
    pub(crate) fn adds_up(&self, kind: EffectKind) -> bool {
        use EffectKind::{JointCoulomb, JointOffset, JointViscous};
        let adds = [JointCoulomb, JointOffset, JointViscous].contains(&kind);
        adds && matches!(self.engine, Kind::Inverse { .. })
    }

    /// Whether effects of this kind are looked for at the end, beside causes found.
    pub(crate) fn comes_late(&self, kind: EffectKind) -> bool {
        delays_drive_forces(&self.scenario, kind)
    }

    pub(super) fn reduced(&self) -> Engine {
        Engine::Reduced {
            shortest_step_s: self.shortest_step_s,
            steps_per_period: self.steps_per_period,
        }
    }

    /// What the search is told; what is integrated in time ends at `until_s`.
    pub(super) fn predicted(
        &self,
        nominal: &[f64],
        effects: &[Effect],
        until_s: Option<f64>,
    ) -> Result<Columns, PredictError> {
        let failed = |error: SimError| PredictError(error.to_string());
        self.check_speeds(effects)?;
        self.check_modes(effects)?;
        match &self.engine {
            Kind::Forward => self.extrapolated(nominal, effects, until_s),
            Kind::Steady(model) => model.predict(effects).map_err(failed),
            Kind::Inverse { model, every } => {
                let columns = if self.changed(nominal).next().is_none() {
                    model.predict(effects)
                } else {
                    let varied = self.varied(nominal, effects)?;
                    let rigid = self.rigid.get(varied.robot.clone(), || {
                        (model.nominal_for(&varied.robot, &self.robots)).map_err(failed)
                    })?;
                    model.predict_from(&rigid, &varied.effects)
                };
                let columns = columns.map_err(failed)?;
                Ok((columns.iter())
                    .map(|column| parallel::picked(column, *every))
                    .collect())
            }
        }
    }

    /// Rapier's prediction, or the reduced plant's; with `until_s` no further than that.
    pub(super) fn forward(
        &self,
        nominal: &[f64],
        effects: &[Effect],
        engine: Engine,
        until_s: Option<f64>,
    ) -> Result<Columns, PredictError> {
        let until_s = until_s.filter(|_| !effects.iter().any(comes_early));
        let clock_rate = self.clock_rate(nominal);
        if engine == Engine::Rapier || !self.scenario.effects.is_empty() {
            let rows = self.run(&self.varied(nominal, effects)?, engine, until_s)?;
            return Ok(self.at_the_data(&rows, clock_rate));
        }
        let (sensors, machine): (Vec<Effect>, Vec<Effect>) =
            (effects.iter().cloned()).partition(|effect| effect.kind.family().is_instrumental());
        let key = RunKey {
            nominal: self.without_clock(nominal),
            machine: machine.clone(),
            until_s,
        };
        let run = self.runs.get(key, || {
            self.run(&self.varied(nominal, &machine)?, engine, until_s)
        })?;
        if sensors.is_empty() {
            return Ok(self.at_the_data(&run, clock_rate));
        }
        Ok(self.at_the_data(&self.sensed((*run).clone(), &sensors), clock_rate))
    }

    /// What sensors with these effects make of a run.
    fn sensed(&self, mut run: Rows, sensors: &[Effect]) -> Rows {
        let sensors = Sensors::new(sensors);
        for (spec, column) in run.channels.iter().zip(&mut run.columns) {
            let sensor = sensors.of(&spec.name);
            if sensor != ChannelModel::default() {
                sensor.apply(&run.time_s, column);
            }
        }
        run
    }

    /// The channels that were measured, of one run.
    pub(super) fn run(
        &self,
        scenario: &Scenario,
        engine: Engine,
        until_s: Option<f64>,
    ) -> Result<Rows, PredictError> {
        let names: Vec<&str> = self
            .channels
            .iter()
            .map(|spec| spec.name.as_str())
            .collect();
        let failed = |error: SimError| PredictError(error.to_string());
        let run = |scenario| run::Run {
            engine,
            ..reduced(scenario, &self.measured, &self.robots)
        };
        let stepped = (self.with_step(scenario, &run(scenario))).map_err(failed)?;
        let run = run(stepped.as_ref());
        let rows = (run.rows(&names, until_s)).map_err(failed)?;
        match rows.outcome {
            Outcome::Completed => Ok(rows),
            outcome => Err(PredictError(outcome.to_string())),
        }
    }

    /// A run's channels at the times of the samples, of a machine whose clock goes by `clock_rate`
    /// for what the scenario has.
    pub(super) fn at_the_data(&self, rows: &Rows, clock_rate: f64) -> Columns {
        let times: Vec<Vec<f64>> = (self.stretches_s.iter())
            .map(|times| times.iter().map(|time| clock_rate * time).collect())
            .collect();
        let column = |(spec, values): (&ChannelSpec, &Vec<f64>)| {
            let mut sampled: Vec<f64> = (times.iter())
                .flat_map(|times| sampling::at(&rows.time_s, values, times))
                .collect();
            if self.jumps.concern(&spec.name) {
                self.jumps.bridge(&mut sampled);
            }
            sampled
        };
        rows.channels
            .iter()
            .zip(&rows.columns)
            .map(column)
            .collect()
    }
}
