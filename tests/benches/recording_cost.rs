//! What the files of a run cost: one pass of `backward_sufficient` without any, and with all three.
//!
//! Both kinds of run alternate, so that the ratio does not depend on the machine's mood; the
//! fastest of each counts. With `--test` each run is made once.

use std::path::Path;
use std::time::Instant;

use truecut_recording::Sink;
use truecut_scenario::Scenario;
use truecut_sim::run::{Claims, Run};
use truecut_telemetry::{Background, IpcSink, ParquetSink, RrdSink};

const REPEATS: usize = 15;

/// Wall time from the built cell to the closed files, s.
fn run(scenario: &Scenario, sinks: Vec<Box<dyn Sink + Send>>) -> f64 {
    let start = Instant::now();
    let run = Run {
        sinks,
        claims: Claims::Ignore,
        ..Run::of(scenario)
    };
    let finished = run.execute().unwrap_or_else(|e| panic!("{e}"));
    start.elapsed().as_secs_f64() - finished.build_s
}

fn files(folder: &Path) -> Vec<Box<dyn Sink + Send>> {
    let all: Vec<Box<dyn Sink + Send>> = vec![
        Box::new(IpcSink::new(folder.join("recording.arrows"))),
        Box::new(ParquetSink::new(folder.join("recording.parquet"))),
        Box::new(RrdSink::new(folder.join("recording.rrd"))),
    ];
    vec![Box::new(Background::new(all))]
}

fn main() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/chamfer/backward_sufficient.toml");
    let scenario = Scenario::load(&path, &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let folder = tempfile::tempdir().expect("a folder");
    let (mut without, mut with) = (f64::INFINITY, f64::INFINITY);
    let once = std::env::args().any(|argument| argument == "--test");
    for _ in 0..if once { 1 } else { REPEATS } {
        without = without.min(run(&scenario, Vec::new()));
        with = with.min(run(&scenario, files(folder.path())));
    }
    println!("no files    {:7.1} ms", without * 1e3);
    println!("three files {:7.1} ms", with * 1e3);
    println!("cost        {:+7.1} %", (with / without - 1.0) * 100.0);
}
