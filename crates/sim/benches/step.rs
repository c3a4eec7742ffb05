//! Cost of a second of simulation: the arm under a given force, and under chamfering with its
//! contact.

use criterion::{Criterion, criterion_group, criterion_main};
use std::path::Path;
use std::time::Duration;
use truecut_scenario::Scenario;
use truecut_sim::run::{Claims, Run};

/// Wall time of the run's loop, without building.
fn run_once(scenario: &Scenario) -> Duration {
    let run = Run {
        claims: Claims::Ignore,
        ..Run::of(scenario)
    };
    Duration::from_secs_f64(run.execute().expect("shipped").run_s)
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
        // Claims come last; they look beyond the end of the shortened run and would be refused.
        let text = text.split("[[claim]]").next().expect("a first part");
        let scenario = Scenario::from_str(&root.join(path), text, &overrides).expect("overrides");
        c.bench_function(name, |b| {
            b.iter_custom(|times| (0..times).map(|_| run_once(&scenario)).sum());
        });
    }
}

criterion_group!(steps, seconds);
criterion_main!(steps);
