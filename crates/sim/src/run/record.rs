//! The recording of a run, from a plant or from what is predicted without one.

use std::time::Instant;

use truecut_recording::{
    ChannelSpec, Measured, OpenSinks, Outcome, PartMesh, Recorder, Recording, Sink,
};
use truecut_scenario::Scenario;

use super::clearance;
use super::request::{Claims, Keep, Run};
use super::scalars;
use crate::error::SimError;
use crate::process::cut_short;
use crate::replay::predict::{Prediction, predict};

/// A run that has ended, with its sinks still open for the claims.
pub(super) struct Recorded {
    pub recording: Recording,
    pub sinks: OpenSinks,
    pub time_step_s: f64,
    pub build_s: f64,
    pub run_s: f64,
    pub compared: Option<Measured>,
    pub part: Option<PartMesh>,
}

type Sinks = Vec<Box<dyn Sink + Send>>;

/// A note on a run that ends before its process does by itself: widths, claims and scalars are then
/// of what is there by that time.
fn unfinished(scenario: &Scenario) -> Option<String> {
    // Of a path that was laid for the run, only the plant's builder knows how long it takes.
    let natural_s = scenario.process.facts().natural_duration_s;
    let natural_s = natural_s.filter(|natural_s| natural_s.is_finite())?;
    cut_short(scenario.run.duration_s, natural_s)
}

/// The channels that claims and sweep ask for, and what a cell about the arm does.
fn judged(scenario: &Scenario, about: Option<&clearance::About>) -> Vec<String> {
    let sweep = scenario.sweep.iter().flat_map(|sweep| sweep.metrics());
    let metrics = (scenario.claims.iter().map(|claim| &claim.metric)).chain(sweep);
    let names = metrics.flat_map(|metric| metric.channels()).cloned();
    let joints = about.into_iter().flat_map(|about| about.channels());
    names.chain(joints).collect()
}

impl Run<'_> {
    pub(super) fn record(
        &self,
        scenario: &Scenario,
        measured: Option<&Measured>,
        sinks: Sinks,
    ) -> Result<Recorded, SimError> {
        let started = Instant::now();
        if let Some(measured) = measured
            && let Some(prediction) = predict(scenario, measured)?
        {
            let build_s = started.elapsed().as_secs_f64();
            return self.record_prediction(scenario, measured, prediction, build_s, sinks);
        }
        let cell = self.cell(scenario, measured)?;
        let about = clearance::About::of(scenario, self.robots, &cell)?;
        // Without sinks nobody sees the scene.
        let mut header = match sinks.is_empty() {
            true => cell.header(),
            false => cell.header_with_scene(),
        };
        header
            .notes
            .extend(measured.into_iter().flat_map(|data| data.notes.clone()));
        let left_out = about.iter().flat_map(|about| about.notes());
        header.notes.extend(left_out.cloned());
        header.notes.extend(unfinished(scenario));
        if self.claims != Claims::Ignore {
            scenario.check_claims(&header)?;
            scenario.check_bands(cell.row_interval_s())?;
            if scalars::are_claimed(scenario) {
                let made = scalars::made(scenario, self.cell(scenario, measured)?);
                scalars::check(scenario, made)?;
            }
        }
        let keep = match self.keep {
            Keep::All => None,
            Keep::Judged => Some(judged(scenario, about.as_ref())),
        };
        let mut extent = cell.extent();
        if let Some(names) = &keep {
            let is_kept = |channel: &&ChannelSpec| names.contains(&channel.name);
            extent.kept = header.channels.iter().filter(is_kept).count();
        }
        extent.check_memory()?;
        (self.before)(&extent)?;
        let time_step_s = cell.time_step_s();
        let build_s = started.elapsed().as_secs_f64();
        let started = Instant::now();
        let mut recorder = Recorder::new(header, sinks)?;
        if let Some(names) = &keep {
            recorder.keep_only(names);
        }
        let end = cell.run(&mut recorder, self.progress, self.stop)?;
        let (mut recording, sinks) = recorder.finish(end.scalars, end.profiles, end.outcome)?;
        if let Some(about) = &about {
            let clearance = about.clearance(&recording);
            recording.scalars.push(clearance);
        }
        Ok(Recorded {
            recording,
            sinks,
            time_step_s,
            build_s,
            run_s: started.elapsed().as_secs_f64(),
            compared: None,
            part: end.part,
        })
    }

    fn record_prediction(
        &self,
        scenario: &Scenario,
        measured: &Measured,
        prediction: Prediction,
        build_s: f64,
        sinks: Sinks,
    ) -> Result<Recorded, SimError> {
        let Prediction {
            header,
            columns,
            measured: mut compared,
        } = prediction;
        if self.claims != Claims::Ignore {
            scenario.check_claims(&header)?;
            scenario.check_bands(compared.interval_s())?;
            scalars::check(scenario, Vec::new())?;
        }
        let started = Instant::now();
        let mut recorder = Recorder::new(header, sinks)?;
        if self.keep == Keep::Judged {
            recorder.keep_only(&judged(scenario, None));
        }
        let mut row = Vec::with_capacity(columns.len());
        for (k, time_s) in compared.time_s.iter().enumerate() {
            row.clear();
            row.extend(columns.iter().map(|column| column[k]));
            recorder.push_row(*time_s, &row)?;
        }
        let (recording, sinks) = recorder.finish(Vec::new(), Vec::new(), Outcome::Completed)?;
        let time_step_s = compared.interval_s();
        keep_inputs(&mut compared, measured);
        Ok(Recorded {
            recording,
            sinks,
            time_step_s,
            build_s,
            run_s: started.elapsed().as_secs_f64(),
            compared: Some(compared),
            part: None,
        })
    }
}

/// Adds the inputs that the prediction made no output of: they may explain what is left.
fn keep_inputs(compared: &mut Measured, measured: &Measured) {
    if compared.time_s != measured.time_s {
        return;
    }
    let known = |name: &str| compared.channel(name).is_ok();
    let inputs = measured.inputs().filter(|input| !known(&input.spec.name));
    let inputs: Vec<_> = inputs.cloned().collect();
    compared.channels.extend(inputs);
}
