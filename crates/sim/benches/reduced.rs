//! The reduced plant beside rapier, in one run: cost of a step, of building, speed-up, distance.
//!
//! Every shipped scenario that is not a sweep, and rigs of one and three joints. A run is timed from the
//! built cell to its last row, guard and rows included, without a recorder; building with the robot's files
//! read before, and anew. The distance is the normalised root mean square error against rapier at its
//! default step: of the tool's displacement, and of the force on the dynamometer or under the wheel.

use std::path::{Path, PathBuf};
use std::time::Instant;
use truecut_recording::{Recorder, Recording, Window, compare};
use truecut_scenario::Scenario;
use truecut_sim::{Cell, Robots};

const REPEATS: usize = 7;
const WINDOW: usize = 100;

fn record(cell: Cell) -> Recording {
    let mut recorder = Recorder::new(cell.header(), Vec::new()).expect("no sinks");
    let end = cell.run(&mut recorder, &|_| {}).expect("no sinks");
    let finished = recorder.finish(end.scalars, end.profiles, end.outcome);
    finished.expect("no sinks").0
}

/// Shortest times in s of building and of a step. Of a run, every [`WINDOW`] rows are timed by themselves
/// and the shortest of all repeats counts, so that what else the machine does drops out.
fn shortest(build: impl Fn() -> Cell) -> (f64, f64) {
    let mut build_s = f64::INFINITY;
    let mut windows_s: Vec<f64> = Vec::new();
    for _ in 0..REPEATS {
        let start = Instant::now();
        let cell = build();
        build_s = build_s.min(start.elapsed().as_secs_f64());
        let (mut sum, mut rows) = (0.0, 0);
        let mut start = Instant::now();
        cell.run_rows(|_, row| {
            sum += row[0];
            rows += 1;
            if rows % WINDOW == 0 {
                let window = rows / WINDOW - 1;
                let now = Instant::now();
                let taken_s = (now - start).as_secs_f64();
                match windows_s.get_mut(window) {
                    Some(best) => *best = best.min(taken_s),
                    None => windows_s.push(taken_s),
                }
                start = now;
            }
        });
        std::hint::black_box(sum);
    }
    let timed_rows = (windows_s.len() * WINDOW) as f64;
    (build_s, windows_s.iter().sum::<f64>() / timed_rows)
}

fn main() {
    println!(
        "| scenario | step | wall time a step | a simulated second | build | build, files read | \
         rapier / this: step | second | tool | force |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for (name, scenario) in scenarios() {
        let robots = Robots::new();
        let reduced = || Cell::build_reduced_from(&robots, &scenario).expect("shipped");
        let rapier = || Cell::build(&scenario).expect("shipped");
        let (step_s, rapier_step_s) = (reduced().time_step_s(), rapier().time_step_s());
        let (build_s, cost_s) = shortest(reduced);
        let (_, rapier_cost_s) = shortest(rapier);
        let read_s = (0..REPEATS)
            .map(|_| {
                let start = Instant::now();
                std::hint::black_box(Cell::build_reduced(&scenario).expect("shipped"));
                start.elapsed().as_secs_f64()
            })
            .fold(f64::INFINITY, f64::min);
        let (ours, theirs) = (record(reduced()), record(rapier()));
        let distance = |channels: &[&str]| {
            compare(&theirs, &ours, channels, Window::default())
                .map_or_else(|_| String::new(), |d| format!("{:.3} %", d.nrmse * 1e2))
        };
        let on = |stem: &str| {
            let axes = ["x", "y", "z"].map(|a| format!("{stem}_{a}"));
            distance(&axes.each_ref().map(String::as_str))
        };
        println!(
            "| {name} | {:.3} ms | {:.2} us | {:.2} ms | {:.2} ms | {:.1} ms | {:.1} | {:.0} | {} | {} |",
            step_s * 1e3,
            cost_s * 1e6,
            cost_s / step_s * 1e3,
            build_s * 1e3,
            read_s * 1e3,
            rapier_cost_s / cost_s,
            rapier_cost_s / rapier_step_s * step_s / cost_s,
            on("tool.displacement"),
            [on("dynamometer.force"), distance(&["wheel.normal_force"])].concat(),
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
