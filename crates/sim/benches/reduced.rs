//! The reduced plant beside rapier, in one run: cost of a step, of building, speed-up, distance.
//!
//! Every shipped scenario that is not a sweep, and rigs of one and three joints. A run is timed
//! from its first step to its last, guard and recorder included, the shortest of several; building
//! with the robot's files read before, and anew. The distance is the normalised root mean square
//! error against rapier at its default step: of the tool's displacement, and of the force on the
//! dynamometer or under the wheel. With `--test` every run is timed once.

use std::path::{Path, PathBuf};
use truecut_recording::{Window, compare};
use truecut_scenario::Scenario;
use truecut_sim::Robots;
use truecut_sim::run::{Claims, Engine, Finished, Run};

const REPEATS: usize = 7;

fn repeats() -> usize {
    let once = std::env::args().any(|argument| argument == "--test");
    if once { 1 } else { REPEATS }
}

/// A run, with the shortest times in s of building and of a step.
fn shortest(run: impl Fn() -> Finished) -> (Finished, f64, f64) {
    let runs: Vec<Finished> = (0..repeats()).map(|_| run()).collect();
    let least =
        |time: &dyn Fn(&Finished) -> f64| runs.iter().map(time).fold(f64::INFINITY, f64::min);
    let (build_s, run_s) = (least(&|run| run.build_s), least(&|run| run.run_s));
    let last = &runs[runs.len() - 1];
    let simulated_s = last.recording.time_s.last().expect("rows");
    let steps = simulated_s / last.time_step_s;
    (
        runs.into_iter().next_back().expect("runs"),
        build_s,
        run_s / steps,
    )
}

fn main() {
    println!(
        "| scenario | step | wall time a step | a simulated second | build | build, files read | \
         rapier / this: step | second | tool | force |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for (name, scenario) in scenarios() {
        let robots = Robots::new();
        let run = |engine, robots| {
            let run = Run {
                engine,
                robots,
                claims: Claims::Ignore,
                ..Run::of(&scenario)
            };
            run.execute().expect("shipped")
        };
        let (ours, build_s, cost_s) = shortest(|| run(Engine::REDUCED, Some(&robots)));
        let (_, read_s, _) = shortest(|| run(Engine::REDUCED, None));
        let (theirs, _, rapier_cost_s) = shortest(|| run(Engine::Rapier, None));
        let (step_s, rapier_step_s) = (ours.time_step_s, theirs.time_step_s);
        let distance = |channels: &[&str]| {
            compare(
                &theirs.recording,
                &ours.recording,
                channels,
                Window::default(),
            )
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
        // A path from CAM lies beside its scenario.
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
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
