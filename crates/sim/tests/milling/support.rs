//! Scenarios and runs of the milling tests.

use std::path::{Path, PathBuf};

use truecut_recording::{Outcome, Recording};
use truecut_scenario::{MillingSpec, ProcessSpec, Scenario};
use truecut_sim::run::{Claims, Engine, Run};

/// The benchmark's oscillator: two teeth, half immersion in down-milling.
pub const RIG: &str = r#"
name = "benchmark"
[robot]
urdf = "../../assets/robots/rig_milling/robot.urdf"
gravity = false
[process.milling]
spindle_rpm = 10000
feed_mm_per_tooth = 0.02
axial_depth_mm = 0.2
engagement = "down"
radial_depth_mm = 10
start_angle_deg = 1
[process.milling.cutter]
diameter_mm = 20
teeth = 2
[process.milling.cutting]
tangential_mpa = 600
radial_mpa = 200
[process.milling.path]
direction = [1, 0, 0]
length_mm = 10
"#;

/// A place from which the robots are reached.
pub fn place() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/arm/milling.toml")
}

pub fn scenario(text: &str, overrides: &[(&str, String)]) -> Scenario {
    let owned: Vec<(String, String)> = (overrides.iter())
        .map(|(key, value)| ((*key).to_owned(), value.clone()))
        .collect();
    Scenario::from_str(&place(), text, &owned).unwrap_or_else(|e| panic!("{e}"))
}

pub fn milling(scenario: &Scenario) -> &MillingSpec {
    match &scenario.process {
        ProcessSpec::Milling(milling) => milling,
        other => panic!("not milling but {}", other.name()),
    }
}

/// A finished run in rapier.
pub fn run(scenario: &Scenario) -> Recording {
    run_in(Engine::Rapier, scenario)
}

/// The same with the arm linearised.
pub fn run_reduced(scenario: &Scenario) -> Recording {
    run_in(Engine::REDUCED, scenario)
}

fn run_in(engine: Engine, scenario: &Scenario) -> Recording {
    let run = Run {
        engine,
        claims: Claims::Ignore,
        ..Run::of(scenario)
    };
    let recording = run.execute().unwrap_or_else(|e| panic!("{e}")).recording;
    assert_eq!(recording.outcome, Outcome::Completed);
    recording
}

pub fn scalar(recording: &Recording, name: &str) -> f64 {
    let found = recording.scalar(name);
    found.unwrap_or_else(|e| panic!("{e}")).value
}

/// Whether vibration grows: its rate is positive, or at the end it is beyond what counts as small,
/// a twentieth of the feed per tooth.
pub fn grows(scenario: &Scenario) -> bool {
    let end = run(scenario);
    let rate = scalar(&end, "milling.growth_rate");
    let level = scalar(&end, "milling.vibration_level");
    println!("{rate:.3} /s, {level:.2e} m");
    rate > 0.0 || level > 0.05 * milling(scenario).cut.feed_per_tooth_m
}
