//! Measured data as the search sees them, with the signals that a residual may follow.

use std::f64::consts::TAU;

use truecut_recording::measured::Measured;
use truecut_recording::{ChannelSpec, UnknownName};
use truecut_scenario::{DriveKind, ProcessSpec, ReplayMode, Scenario};
use truecut_sim::run::Rows;
use truecut_sim::{InverseModel, SimError};

use super::noise::of_inputs;
use super::signals::column;
use super::{parallel, sampling};
use crate::diagnose::{Fine, Observation, Output, Regressor};
use crate::stats::ratio;

/// A run that ends so many intervals before a sample says nothing of it.
const BEYOND: f64 = 1.5;

/// Outputs in the order of `channels`; commands, velocities, spindle angle and load as known
/// signals.
pub(super) fn observation(
    scenario: &Scenario,
    measured: &Measured,
    channels: &[ChannelSpec],
    nominal: Option<&Rows>,
) -> Observation {
    let process_s = measured.process_time_s();
    let end_s = nominal.and_then(|rows| rows.time_s.last());
    let end_s = end_s.map_or(f64::INFINITY, |end| end + BEYOND * measured.interval_s());
    let runs = |row: usize| (0.0..=end_s).contains(&process_s[row]);
    let outputs = (channels.iter())
        .filter_map(|spec| measured.channel(&spec.name).ok())
        .map(|channel| Output {
            values: channel.values.clone(),
            valid: (channel.valid.iter().enumerate())
                .map(|(row, valid)| *valid && runs(row))
                .collect(),
            noise: channel.noise,
            sample: None,
            noise_without_memory: 0.0,
            held_step: 0.0,
            noise_of_inputs: 0.0,
            noise_error: 0.0,
        })
        .collect();
    let mut regressors: Vec<Regressor> = (measured.inputs())
        .map(|channel| Regressor::new(&channel.spec.name, channel.values.clone()))
        .collect();
    let rates: Vec<Regressor> = (regressors.iter())
        .map(|input| {
            let values = rate(&input.values, measured.interval_s());
            Regressor::new(format!("rate of {}", input.name), values)
        })
        .collect();
    regressors.extend(rates);
    if let Some(speed) = spin_rad_s(scenario) {
        regressors.push(Regressor {
            name: "spindle angle".to_owned(),
            values: (process_s.iter())
                .map(|t| (speed * t).rem_euclid(TAU))
                .collect(),
            is_angle: true,
        });
    }
    if let Some(recording) = nominal {
        let stretches = measured.stretches_s();
        let known = scenario.process.facts().signals.iter().filter_map(|name| {
            let column = column(recording, name)?;
            let at = |times: &Vec<f64>| sampling::at(&recording.time_s, column, times);
            let values = stretches.iter().flat_map(at).collect();
            Some(Regressor::new(*name, values))
        });
        regressors.extend(known);
    }
    Observation {
        source: measured.source.clone(),
        scenario: scenario.name.clone(),
        time_s: measured.time_s.clone(),
        trajectories: (measured.passes().into_iter())
            .map(|pass| pass.samples)
            .collect(),
        outputs,
        regressors,
        fine: None,
        again: Vec::new(),
    }
}

/// In mode "inverse" the places and velocities of the joints are known signals: places as they are
/// before thinning, too, since what waves over them is filtered like the outputs. Their noise is in
/// what is predicted.
pub(super) fn add_motion(
    observation: &mut Observation,
    scenario: &Scenario,
    measured: &Measured,
    model: &InverseModel,
    every: usize,
) {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        return;
    };
    let ReplayMode::Inverse {
        compare_cutoff_hz, ..
    } = replay.mode
    else {
        return;
    };
    let mut fine = Vec::new();
    for joint in 0..model.robot().dof() {
        let names = ["angle", "position"].map(|kind| format!("joint{}.{kind}", joint + 1));
        let mut found = measured
            .inputs()
            .filter(|one| names.contains(&one.spec.name));
        let Some(channel) = found.next() else {
            continue;
        };
        let name = &channel.spec.name;
        let rate = model.velocity(joint).iter().step_by(every).copied();
        let known = &mut observation.regressors;
        known.push(Regressor::new(
            name,
            parallel::picked(&channel.values, every),
        ));
        known.push(Regressor::new(format!("rate of {name}"), rate.collect()));
        fine.push(Regressor::new(name, channel.values.clone()));
    }
    // With noise a joint may go too far beyond its limits: then nothing is known of it.
    let sizes = of_inputs(model, scenario, measured).unwrap_or_default();
    for (output, size) in observation.outputs.iter_mut().zip(sizes) {
        output.noise_of_inputs = size;
    }
    observation.fine = Some(Fine {
        signals: fine,
        every,
        filter: InverseModel::filter_of(compare_cutoff_hz, measured.rate_hz()),
    });
}

/// Spindle or wheel speed, if anything spins.
pub(super) fn spin_rad_s(scenario: &Scenario) -> Option<f64> {
    scenario.process.facts().rate_rad_s
}

/// Central differences; one-sided at the ends.
fn rate(values: &[f64], interval_s: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|i| {
            let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
            let span = (after - before) as f64 * interval_s;
            ratio(values[after] - values[before], span)
        })
        .collect()
}

/// The channels of the run that were measured, in the order of the data.
pub(super) fn outputs(
    scenario: &Scenario,
    measured: &Measured,
    rows: &Rows,
) -> Result<Vec<ChannelSpec>, SimError> {
    let mapped = |name: &str| {
        let data = scenario.data.as_ref();
        data.and_then(|data| (data.mapping.channels.iter()).position(|one| one.channel == name))
    };
    let key = |name: &str| {
        mapped(name).map_or_else(
            || "data".to_owned(),
            |i| format!("data.channel.{i}.channel"),
        )
    };
    (measured.outputs())
        .map(|output| {
            let name = &output.spec.name;
            let known = || rows.channels.iter().map(|spec| spec.name.as_str());
            let simulated =
                (rows.channels.iter().find(|spec| spec.name == *name)).ok_or_else(|| {
                    let error = UnknownName::new("channel", name, known());
                    SimError::scenario(key(name), error.to_string())
                })?;
            if simulated.unit != output.spec.unit {
                let accepted: Vec<&str> = simulated.unit.accepted_symbols().collect();
                let message = format!(
                    "channel {name} is given in {}, but its unit must be one of {}",
                    output.spec.unit,
                    accepted.join(", ")
                );
                return Err(SimError::scenario(key(name), message));
            }
            Ok(simulated.clone())
        })
        .collect()
}

/// A sentence on the joints of a replay that no column commands, where others are.
pub(super) fn uncommanded(
    scenario: &Scenario,
    measured: &Measured,
    joints: usize,
) -> Option<String> {
    if super::mode(scenario) != Some(ReplayMode::Forward)
        || scenario.robot.drive == DriveKind::Force
    {
        return None;
    }
    let commanded = |joint: &usize| {
        let name = format!("joint{joint}.command");
        measured.inputs().any(|input| input.spec.name == name)
    };
    let (with, without): (Vec<usize>, Vec<usize>) = (1..=joints).partition(commanded);
    let named: Vec<String> = without
        .iter()
        .map(|joint| format!("joint{joint}"))
        .collect();
    (!with.is_empty() && !without.is_empty()).then(|| {
        format!(
            "no column commands {}: held at the posture that the data begin with, or the scenario gives",
            named.join(", ")
        )
    })
}
