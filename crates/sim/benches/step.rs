//! Cost of a second of simulation: the arm under a given force, and under chamfering with its contact.

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use std::path::Path;
use truecut_recording::Recorder;
use truecut_scenario::Scenario;
use truecut_sim::Cell;

fn run_once(cell: Cell) -> usize {
    let mut recorder = Recorder::new(cell.header(), Vec::new()).expect("no sink");
    cell.run(&mut recorder, &|_| {}).expect("no sink");
    recorder.header().channels.len()
}

fn seconds(c: &mut Criterion) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    for (name, path) in [
        ("forced arm, 1000 steps", "arm/static_load.toml"),
        ("chamfering arm, 1000 steps", "chamfer/backward_low.toml"),
    ] {
        let overrides = [("run.duration_s", "0.25"), ("run.time_step_ms", "0.25")]
            .map(|(k, v)| (k.to_string(), v.to_string()));
        let scenario = Scenario::load(&root.join(path), &[]).expect("shipped");
        let text = scenario
            .effective_text()
            .replace("dwell_revolutions = 2\n", "");
        let scenario = Scenario::from_str(&root.join(path), &text, &overrides).expect("overrides");
        c.bench_function(name, |b| {
            b.iter_batched(
                || Cell::build(&scenario).expect("shipped"),
                run_once,
                BatchSize::SmallInput,
            );
        });
    }
}

criterion_group!(steps, seconds);
criterion_main!(steps);
