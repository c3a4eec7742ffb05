//! The reduced plant beside rapier, in one run: cost of a step, of building, speed-up, distance.
//!
//! Every shipped scenario that is not a sweep, and two rigs of one and two joints. Times are the shortest of
//! some repeats; a run is timed from the built cell to its last row, guard and rows included, without a
//! recorder. The distance is the normalised root mean square error against rapier at its default step.

use std::path::{Path, PathBuf};
use std::time::Instant;
use truecut_recording::{Recorder, Recording, Window, compare};
use truecut_scenario::Scenario;
use truecut_sim::{Cell, Robots};

const REPEATS: usize = 7;

fn record(cell: Cell) -> Recording {
    let mut recorder = Recorder::new(cell.header(), Vec::new()).expect("no sinks");
    let end = cell.run(&mut recorder, &|_| {}).expect("no sinks");
    let finished = recorder.finish(end.scalars, end.profiles, end.outcome);
    finished.expect("no sinks").0
}

/// Shortest time in s of a run's parts: building, running.
fn shortest(build: impl Fn() -> Cell) -> (f64, f64) {
    let mut best = (f64::INFINITY, f64::INFINITY);
    for _ in 0..REPEATS {
        let start = Instant::now();
        let cell = build();
        let built = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let mut sum = 0.0;
        cell.run_rows(|_, row| sum += row[0]);
        std::hint::black_box(sum);
        best = (best.0.min(built), best.1.min(start.elapsed().as_secs_f64()));
    }
    best
}

fn main() {
    println!(
        "| scenario | step | a step | a simulated second | build | of rapier's: a step, a second | tool | force |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for (name, scenario) in scenarios() {
        let robots = Robots::new();
        let reduced = || Cell::build_reduced_from(&robots, &scenario).expect("shipped");
        let rapier = || Cell::build(&scenario).expect("shipped");
        let (step_s, rapier_step_s) = (reduced().time_step_s(), rapier().time_step_s());
        let (build_s, run_s) = shortest(reduced);
        let (_, rapier_s) = shortest(rapier);
        let duration_s = scenario.run.duration_s;
        let per_step = |run_s: f64, step_s: f64| run_s / (duration_s / step_s);
        let (cost_s, rapier_cost_s) = (per_step(run_s, step_s), per_step(rapier_s, rapier_step_s));
        let (ours, theirs) = (record(reduced()), record(rapier()));
        let distance = |channels: &[&str]| {
            compare(&theirs, &ours, channels, Window::default())
                .map_or("".into(), |d| format!("{:.3} %", d.nrmse * 1e2))
        };
        let axes = |stem: &str| ["x", "y", "z"].map(|a| format!("{stem}_{a}"));
        let on = |stem: &str| distance(&axes(stem).each_ref().map(String::as_str));
        let force = [on("dynamometer.force"), distance(&["wheel.normal_force"])].concat();
        println!(
            "| {name} | {:.3} ms | {:.2} us | {:.2} ms | {:.2} ms | {:.1}, {:.1} | {} | {force} |",
            step_s * 1e3,
            cost_s * 1e6,
            run_s / duration_s * 1e3,
            build_s * 1e3,
            rapier_cost_s / cost_s,
            rapier_s / run_s,
            on("tool.displacement"),
        );
    }
}

const RIG: &str = r#"
[process.load]
constant_n = [100.0, 0.0, 0.0]
[process.load.sweep]
amplitude_n = [200.0, 0.0, 0.0]
from_hz = 1
to_hz = 20
"#;

fn scenarios() -> Vec<(String, Scenario)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut all = Vec::new();
    for (name, robot) in [
        ("rig of one joint", "rig_1dof"),
        ("rig of three joints", "rig_planar"),
    ] {
        let text = format!(
            "name = \"rig\"\n[robot]\nurdf = \"../../assets/robots/{robot}/robot.urdf\"\n\
             gravity = false\n[run]\nduration_s = 5.0\n{RIG}"
        );
        let scenario = Scenario::from_str(&root.join("arm/rig.toml"), &text, &[]);
        all.push((
            name.to_string(),
            scenario.unwrap_or_else(|e| panic!("{e:?}")),
        ));
    }
    let mut files: Vec<PathBuf> = ["arm", "chamfer", "wheel"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(root.join(folder)).expect("shipped"))
        .map(|entry| entry.expect("shipped").path())
        .collect();
    files.sort();
    for file in files {
        let scenario = Scenario::load(&file, &[]).unwrap_or_else(|e| panic!("{e:?}"));
        if scenario.sweep.is_none() {
            let name = file
                .strip_prefix(&root)
                .expect("below")
                .display()
                .to_string();
            all.push((name, scenario));
        }
    }
    all
}
