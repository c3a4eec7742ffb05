//! Running scenarios from these tests.

use std::path::{Path, PathBuf};
use truecut_recording::Recording;
use truecut_scenario::Scenario;
use truecut_sim::run::{Claims, Engine, Run};

/// Folder of the repository.
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A shipped scenario.
pub fn scenario(path: &str) -> Scenario {
    Scenario::load(&repository().join("scenarios").join(path), &[])
        .unwrap_or_else(|e| panic!("{path}: {e:?}"))
}

/// Runs a shipped scenario with overrides.
pub fn run(path: &str, overrides: &[(&str, &str)]) -> Recording {
    let overrides: Vec<_> = (overrides.iter())
        .map(|(k, v)| ((*k).to_string(), (*v).to_string()))
        .collect();
    recording(Engine::Rapier, &scenario(path), &overrides)
}

/// Runs a scenario given as text, as if it lay in `scenarios/arm`.
pub fn run_text(text: &str) -> Recording {
    let at = repository().join("scenarios/arm/of_a_test.toml");
    let scenario = Scenario::from_str(&at, text, &[]).unwrap_or_else(|e| panic!("{e:?}"));
    recording(Engine::Rapier, &scenario, &[])
}

/// The recording of a scenario with overrides, and with the data that it replays; its claims are
/// left alone.
pub fn recording(engine: Engine, scenario: &Scenario, overrides: &[(String, String)]) -> Recording {
    let run = Run {
        overrides: overrides.to_vec(),
        engine,
        read_data: Some(truecut::data::replayed),
        claims: Claims::Ignore,
        ..Run::of(scenario)
    };
    let finished = run.execute();
    finished
        .unwrap_or_else(|e| panic!("{overrides:?}: {e}"))
        .recording
}

/// Values of a channel.
pub fn channel<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    let index = (recording.header.index_of(name)).unwrap_or_else(|e| panic!("{e}"));
    &recording.columns[index]
}

/// Value of a scalar.
pub fn scalar(recording: &Recording, name: &str) -> f64 {
    let found = recording.scalars.iter().find(|s| s.name == name);
    found.unwrap_or_else(|| panic!("no scalar {name}")).value
}

/// Half of the range of a channel between two times.
pub fn amplitude(recording: &Recording, name: &str, from_s: f64, to_s: f64) -> f64 {
    let rows = recording.time_s.iter().zip(channel(recording, name));
    let (low, high) = rows
        .filter(|(t, _)| (from_s..=to_s).contains(*t))
        .fold((f64::MAX, f64::MIN), |(l, h), (_, x)| {
            (l.min(*x), h.max(*x))
        });
    (high - low) / 2.0
}

/// Largest lateral distance from the start between two times, m.
pub fn lateral_peak(recording: &Recording, from_s: f64, to_s: f64) -> f64 {
    let y = channel(recording, "tool.displacement_y");
    let z = channel(recording, "tool.displacement_z");
    (recording.time_s.iter().zip(y.iter().zip(z)))
        .filter(|(t, _)| (from_s..to_s).contains(*t))
        .map(|(_, (y, z))| y.hypot(*z))
        .fold(0.0, f64::max)
}
