//! Accuracy and cost of the forced arm over the time step, as JSON, for `benches/versus_mujoco.py`.
//!
//! The arm takes a step of 1 kN at its tool for two seconds. The error of a step is the root mean square
//! of the tool's distance from the reference at 0.02 ms, over the range of the reference.

use std::path::Path;
use std::time::Instant;
use truecut_recording::Recording;
use truecut_scenario::Scenario;

const STEPS_MS: [f64; 6] = [0.1, 0.25, 0.5, 0.625, 1.0, 1.25];
const REPEATS: usize = 7;
const SIMULATED_S: f64 = 2.0;

fn run(scenario: &Scenario, step_ms: f64) -> Recording {
    let overrides = [
        ("run.duration_s", SIMULATED_S.to_string()),
        ("run.time_step_ms", step_ms.to_string()),
        ("run.record_interval_ms", "10".to_string()),
    ]
    .map(|(k, v)| (k.to_string(), v));
    truecut_sim::sweep::record(scenario, &overrides).unwrap_or_else(|e| panic!("{e}"))
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
    let scenario = Scenario::load(&path, &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let reference = tool(&run(&scenario, 0.02));
    let rows: Vec<String> = STEPS_MS
        .iter()
        .map(|step| {
            let error = error(&reference, &tool(&run(&scenario, *step)));
            let fastest = (0..REPEATS)
                .map(|_| {
                    let start = Instant::now();
                    run(&scenario, *step);
                    start.elapsed().as_secs_f64()
                })
                .fold(f64::INFINITY, f64::min);
            let wall = fastest / SIMULATED_S;
            format!("{{\"step_ms\": {step}, \"error\": {error:e}, \"wall_s_per_s\": {wall:e}}}")
        })
        .collect();
    println!("[{}]", rows.join(", "));
}
