//! Measured data of a scenario, and the run beside it.

use std::path::Path;

use truecut_recording::measured::measured;
use truecut_recording::{Measured, Recorder, Recording};
use truecut_scenario::{ProcessSpec, Scenario};
use truecut_sim::Cell;
use truecut_sim::replay::predict::{Prediction, predict};

use crate::failure::Failure;
use crate::progress::RunProgress;

/// Reads the measured data of a scenario; `file` overrides the one that it names.
pub fn read(scenario: &Scenario, file: Option<&Path>) -> Result<Measured, Failure> {
    let Some(data) = &scenario.data else {
        let text = format!("{}: missing table `[data]`", scenario.path().display());
        let help =
            "it says which column of the measured data is which channel; see `truecut schema`";
        return Err(Failure::with_help(text, help));
    };
    let Some(file) = file.or(data.file.as_deref()) else {
        let text = "`data.file` is missing, and no --data FILE is given";
        return Err(scenario.problem("data", text).into());
    };
    let table = truecut_telemetry::read_table(file, data.header);
    let table = table.map_err(|error| Failure::message(error.to_string()))?;
    measured(&table, &data.mapping).map_err(|error| Failure::message(error.to_string()))
}

/// Simulates what was measured: the recording, and the measured channels in the form that it is to be
/// compared with.
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
            measured,
        } = prediction;
        let time_s = measured.time_s.clone();
        return Ok((
            Recording {
                header,
                time_s,
                columns,
                ..Recording::default()
            },
            measured,
        ));
    }
    let replayed = matches!(scenario.process, ProcessSpec::Replay(_)).then_some(&measured);
    let cell = Cell::build_with_data(scenario, replayed).map_err(failed)?;
    let sink_failed = |error| failed(truecut_sim::SimError::Sink(error));
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
        ProcessSpec::Load(_) | ProcessSpec::Replay(_) => return None,
    };
    (speed_rad_s > 0.0).then_some(speed_rad_s / std::f64::consts::TAU)
}
