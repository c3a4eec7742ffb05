//! Accuracy and cost of the forced arm over the time step, as JSON, for `benches/versus_mujoco.py`.
//!
//! The arm takes a step of 1 kN at its tool for two seconds. The error of a step is the root mean
//! square of the tool's distance from the reference at 0.02 ms, over the range of the reference.
//! With `--test` each run is made once.

use std::path::Path;
use truecut_recording::Recording;
use truecut_scenario::Scenario;
use truecut_sim::run::{Claims, Run};

const STEPS_MS: [f64; 6] = [0.1, 0.25, 0.5, 0.625, 1.0, 1.25];
const REPEATS: usize = 7;
const SIMULATED_S: f64 = 2.0;

/// The run, and the wall time of its loop: from the built cell to the last row, guard and recording
/// included, as MuJoCo's loop is timed on a loaded model.
fn run(scenario: &Scenario, step_ms: f64) -> (Recording, f64) {
    let overrides = [
        ("run.duration_s", SIMULATED_S.to_string()),
        ("run.time_step_ms", step_ms.to_string()),
        ("run.record_interval_ms", "10".to_string()),
    ]
    .map(|(k, v)| (k.to_string(), v));
    let run = Run {
        overrides: overrides.to_vec(),
        claims: Claims::Ignore,
        ..Run::of(scenario)
    };
    let finished = run.execute().unwrap_or_else(|e| panic!("{e}"));
    (finished.recording, finished.run_s)
}

fn tool(recording: &Recording) -> Vec<[f64; 3]> {
    let axis = |a: &str| {
        let name = format!("tool.displacement_{a}");
        &recording.columns[recording.header.index_of(&name).expect("channel")]
    };
    let (x, y, z) = (axis("x"), axis("y"), axis("z"));
    (0..x.len()).map(|i| [x[i], y[i], z[i]]).collect()
}

fn error(reference: &[[f64; 3]], other: &[[f64; 3]]) -> f64 {
    let n = reference.len().min(other.len());
    let square =
        |a: &[f64; 3], b: &[f64; 3]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum() };
    let sum: f64 = (0..n).map(|i| square(&reference[i], &other[i])).sum();
    let range = reference
        .iter()
        .map(|p| square(p, &[0.0; 3]))
        .fold(0.0, f64::max);
    (sum / n as f64 / range).sqrt()
}

fn main() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/arm/static_load.toml");
    // Without the claims: the last one looks at times that this shorter run does not reach.
    let text = std::fs::read_to_string(&path).expect("shipped");
    let robot_and_load = text.split("[[claim]]").next().expect("the first part");
    let scenario = Scenario::from_str(&path, robot_and_load, &[]);
    let scenario = scenario.unwrap_or_else(|e| panic!("{e:?}"));
    let once = std::env::args().any(|argument| argument == "--test");
    let repeats = if once { 1 } else { REPEATS };
    let reference = tool(&run(&scenario, 0.02).0);
    let rows: Vec<String> = STEPS_MS
        .iter()
        .map(|step| {
            let error = error(&reference, &tool(&run(&scenario, *step).0));
            let fastest = (0..repeats)
                .map(|_| run(&scenario, *step).1)
                .fold(f64::INFINITY, f64::min);
            let wall = fastest / SIMULATED_S;
            format!("{{\"step_ms\": {step}, \"error\": {error:e}, \"wall_s_per_s\": {wall:e}}}")
        })
        .collect();
    println!("[{}]", rows.join(", "));
}
