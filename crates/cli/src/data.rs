//! Measured data of a scenario, and the run beside it.

use std::path::Path;

use truecut_recording::measured::measured as map;
use truecut_recording::{Measured, Recorder, Recording};
use truecut_scenario::{DataSpec, ProcessSpec, Scenario};
use truecut_sim::replay::predict::{Prediction, predict};
use truecut_sim::{Cell, SimError};
use truecut_telemetry::read_table;

use crate::failure::Failure;
use crate::progress::RunProgress;

/// The data that a replay is driven by: from `file`, else from the file that the scenario names. `None` for
/// scenarios that replay nothing.
pub fn measured(scenario: &Scenario, file: Option<&Path>) -> Result<Option<Measured>, Failure> {
    let replays = matches!(scenario.process, ProcessSpec::Replay(_));
    let Some(data) = scenario.data.as_ref().filter(|_| replays) else {
        return match file {
            Some(_) => Err(Failure::with_help(
                format!("{} replays nothing", scenario.path().display()),
                "leave out --data, or use a scenario with [process.replay]",
            )),
            None => Ok(None),
        };
    };
    load(scenario, data, file).map(Some)
}

/// The data that a scenario is held against.
pub fn needed(scenario: &Scenario, file: Option<&Path>) -> Result<Measured, Failure> {
    let Some(data) = &scenario.data else {
        let text = format!("{}: there is no [data] table", scenario.path().display());
        let help = "add [data] with one [[data.channel]] for each column: it says which is which, and in which unit";
        return Err(Failure::with_help(text, help));
    };
    load(scenario, data, file)
}

fn load(scenario: &Scenario, data: &DataSpec, file: Option<&Path>) -> Result<Measured, Failure> {
    let Some(path) = file.or(data.file.as_deref()) else {
        let message = "the scenario names no file of measured data: write data.file, or run it with --data FILE";
        return Err(scenario.problem("data", message).into());
    };
    // A fault of a file that the scenario names is one of the scenario, at that key.
    let failed = |message: String| match file {
        Some(_) => Failure::message(message),
        None => scenario.problem("data.file", message).into(),
    };
    let table = read_table(path, data.header).map_err(|error| failed(error.to_string()))?;
    let measured = map(&table, &data.mapping).map_err(|error| failed(error.to_string()))?;
    Ok(measured)
}

/// Simulates what was measured: the recording, and the measured channels in the form that it is to be
/// compared with. Inputs stay among them: they may explain what is left.
pub fn simulate(
    scenario: &Scenario,
    measured: Measured,
    progress: &RunProgress,
) -> Result<(Recording, Measured), Failure> {
    let failed = |error| Failure::sim(scenario, error);
    if let Some(prediction) = predict(scenario, &measured).map_err(failed)? {
        let Prediction {
            header,
            columns,
            measured: mut compared,
        } = prediction;
        let time_s = compared.time_s.clone();
        if time_s == measured.time_s {
            let known = |name: &str| compared.channel(name).is_ok();
            let inputs = measured.inputs().filter(|input| !known(&input.spec.name));
            let inputs: Vec<_> = inputs.cloned().collect();
            compared.channels.extend(inputs);
        }
        return Ok((
            Recording {
                header,
                time_s,
                columns,
                ..Recording::default()
            },
            compared,
        ));
    }
    let replayed = matches!(scenario.process, ProcessSpec::Replay(_)).then_some(&measured);
    let cell = Cell::build_with_data(scenario, replayed).map_err(failed)?;
    let sink_failed = |error| failed(SimError::Sink(error));
    let mut recorder = Recorder::new(cell.header(), Vec::new()).map_err(sink_failed)?;
    let end = cell
        .run(&mut recorder, &|part| progress.set(part))
        .map_err(failed)?;
    let finished = recorder.finish(end.scalars, end.profiles, end.outcome);
    let (recording, sinks) = finished.map_err(sink_failed)?;
    sinks.close(&recording, &[]).map_err(sink_failed)?;
    Ok((recording, measured))
}

/// Revolutions of the scenario's spindle or wheel per second.
pub fn spindle_hz(scenario: &Scenario) -> Option<f64> {
    let speed_rad_s = match &scenario.process {
        ProcessSpec::Chamfer(chamfer) => chamfer.spindle_rad_s,
        ProcessSpec::Wheel(wheel) => wheel.spin_rad_s.abs(),
        ProcessSpec::Milling(milling) => milling.spindle_rad_s,
        ProcessSpec::Polish(polish) => polish.spin_rad_s.abs(),
        ProcessSpec::Replay(replay) => replay.turning?.spindle_rad_s,
        ProcessSpec::Belt(belt) => belt.wheel_rad_s(),
        ProcessSpec::Brush(brush) => brush.spin_rad_s.abs(),
        ProcessSpec::Load(_) => return None,
    };
    (speed_rad_s > 0.0).then_some(speed_rad_s / std::f64::consts::TAU)
}

/// Whether a scenario replays data that only the command line can name.
pub fn is_left_open(scenario: &Scenario) -> bool {
    let data = scenario.data.as_ref();
    matches!(scenario.process, ProcessSpec::Replay(_))
        && data.is_some_and(|data| data.file.is_none())
}
