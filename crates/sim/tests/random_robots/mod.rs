//! Robots that nobody would build, of 1 to 12 joints: each run ends right, or stops with the
//! quantity and the place. What is called completed agrees with the same run at half its step.
//!
//! A part of them with each test run; as many as are asked for, with the table of
//! `docs/numerics.md`, by `TRUECUT_RANDOM_ROBOTS=10000 cargo test --release --workspace --test
//! integration random_robots -- --nocapture`.

mod drawn;
mod falling;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::ops::Range;

use drawn::{Drawn, draw};
use rayon::prelude::*;
use truecut_recording::{Outcome, Recording, SinkError};
use truecut_scenario::Scenario;
use truecut_sim::run::{Claims, Run, RunError};

/// With each test run.
const ROBOTS: u64 = 150;
/// Longer runs are left out: masses that differ by far make modes so fast that a run takes minutes.
const MOST_STEPS: usize = 40_000;
/// Largest disagreement with half the step, as a part of the tool's range.
const ALLOWED: f64 = 0.01;
/// One robot of so many is run twice at the same step: the same to the bit.
const AGAIN: u64 = 5;
/// Stick and slip is compared by its envelope, over so many parts of the run.
const PARTS: usize = 8;

/// How the runs of a robot ended.
enum End {
    /// Half the step disagrees by that part of the range.
    Reached(f64),
    /// What went out of bounds.
    Diverged(String),
    Refused(String),
    TooLong,
}

/// A run; none where it would take too many steps.
fn run(
    text: &str,
    folder: &std::path::Path,
    step_s: Option<f64>,
) -> Result<Option<(Recording, f64)>, String> {
    let overrides: Vec<(String, String)> = step_s
        .iter()
        .map(|step_s| ("run.time_step_ms".to_owned(), format!("{:?}", step_s * 1e3)))
        .collect();
    let told = |error: &dyn std::fmt::Display| error.to_string();
    let scenario = Scenario::from_str(&folder.join("random.toml"), text, &overrides)
        .map_err(|error| told(&error))?;
    let most = if step_s.is_some() {
        2 * MOST_STEPS + 2
    } else {
        MOST_STEPS
    };
    let is_long = std::cell::Cell::new(false);
    let finished = Run {
        claims: Claims::Ignore,
        before: &|extent| match extent.steps <= most {
            true => Ok(()),
            false => {
                is_long.set(true);
                Err(SinkError::new(
                    "a run".to_owned(),
                    "begin",
                    std::io::Error::other("too long"),
                ))
            }
        },
        ..Run::of(&scenario)
    }
    .execute();
    match finished {
        Ok(finished) => Ok(Some((finished.recording, finished.time_step_s))),
        Err(RunError::Sink(_)) if is_long.get() => Ok(None),
        Err(error) => Err(error.to_string()),
    }
}

/// The tool's path: rows of x, y, z, at every so many-th row.
fn path(recording: &Recording, every: usize) -> Vec<[f64; 3]> {
    let column = |axis: &str| {
        recording
            .channel(&format!("tool.displacement_{axis}"))
            .unwrap()
    };
    let columns = ["x", "y", "z"].map(column);
    (0..recording.time_s.len())
        .step_by(every)
        .map(|row| columns.map(|column| column[row]))
        .collect()
}

fn range(rows: &[[f64; 3]]) -> f64 {
    let of = |axis: usize| {
        let values = rows.iter().map(|row| row[axis]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        high - low
    };
    (0..3).map(of).fold(0.0, f64::max)
}

/// Lowest and highest of each axis in each part of the run.
fn envelope(rows: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let parts = rows.chunks(rows.len().div_ceil(PARTS).max(1));
    parts
        .flat_map(|part| {
            let extreme = |of: fn(f64, f64) -> f64| {
                part.iter().skip(1).fold(part[0], |so_far, row| {
                    [0, 1, 2].map(|axis| of(so_far[axis], row[axis]))
                })
            };
            [extreme(f64::min), extreme(f64::max)]
        })
        .collect()
}

/// By how much two runs disagree, as a part of the range of the motion.
fn disagreement(whole: &Recording, half: &Recording, sticks: bool) -> f64 {
    let (whole, half) = (path(whole, 1), path(half, 2));
    let range = range(&half);
    let rows = whole.len().min(half.len());
    let (a, b) = match sticks {
        true => (envelope(&whole[..rows]), envelope(&half[..rows])),
        false => (whole, half),
    };
    let off = |(a, b): (&[f64; 3], &[f64; 3])| {
        (0..3)
            .map(|axis| (a[axis] - b[axis]).abs())
            .fold(0.0, f64::max)
    };
    let largest = a.iter().zip(&b).map(off).fold(0.0, f64::max);
    // Less than a nanometre is nothing that is told of an arm.
    largest / range.max(1e-9)
}

fn end(robot: &Drawn, folder: &std::path::Path) -> End {
    let (whole, step_s) = match run(&robot.scenario, folder, None) {
        Ok(Some(made)) => made,
        Ok(None) => return End::TooLong,
        Err(error) => return End::Refused(error),
    };
    match &whole.outcome {
        Outcome::Diverged { quantity, rule, .. } => {
            return End::Diverged(format!("{quantity}: {rule}"));
        }
        outcome if !outcome.reached_end() => return End::Diverged(outcome.to_string()),
        _ => {}
    }
    if robot.seed.is_multiple_of(AGAIN) {
        let (again, _) = run(&robot.scenario, folder, None).unwrap().unwrap();
        let bits = |it: &Recording| -> Vec<Vec<u64>> {
            let one = |column: &Vec<f64>| column.iter().map(|value| value.to_bits()).collect();
            it.columns.iter().map(one).collect()
        };
        assert!(
            bits(&again) == bits(&whole),
            "seed {}: {}",
            robot.seed,
            robot.told
        );
    }
    match run(&robot.scenario, folder, Some(step_s / 2.0)) {
        Ok(Some((half, _))) if half.outcome.reached_end() => {
            End::Reached(disagreement(&whole, &half, robot.sticks))
        }
        Ok(Some((half, _))) => panic!("seed {}: at half the step {}", robot.seed, half.outcome),
        Ok(None) => End::TooLong,
        Err(error) => panic!("seed {}: at half the step: {error}", robot.seed),
    }
}

/// Without numbers and names, so that alike ends are counted together.
fn kind(text: &str) -> String {
    let words = text
        .split_whitespace()
        .filter(|word| !word.contains(|c: char| c.is_ascii_digit()));
    words.take(14).collect::<Vec<_>>().join(" ")
}

/// The seeds that are asked for in the environment, as a number or `FROM..TO`, or those of each
/// test run.
fn seeds(each_run: u64) -> Range<u64> {
    let Ok(asked) = std::env::var("TRUECUT_RANDOM_ROBOTS") else {
        return 0..each_run;
    };
    let number = |text: &str| text.parse().expect("TRUECUT_RANDOM_ROBOTS: N or FROM..TO");
    match asked.split_once("..") {
        Some((from, to)) => number(from)..number(to),
        None => 0..number(&asked),
    }
}

const DRIVES: [&str; 3] = ["position", "servo", "force"];

#[test]
fn random_robots_end_right_or_say_where_they_stop() {
    let seeds = seeds(ROBOTS);
    let made = |seed: u64| {
        let folder = tempfile::tempdir().unwrap();
        let robot = draw(seed, folder.path());
        let end = end(&robot, folder.path());
        (robot, end)
    };
    let ends: Vec<(Drawn, End)> = seeds.into_par_iter().map(made).collect();
    let mut table = BTreeMap::<String, [usize; 3]>::new();
    let (mut worst, mut wrong) = ((0.0, 0), String::new());
    for (robot, end) in &ends {
        let name = match end {
            End::Reached(off) => {
                if *off > worst.0 {
                    worst = (*off, robot.seed);
                }
                if off.is_nan() || *off > ALLOWED {
                    let _ = writeln!(wrong, "seed {} ({}): {off:.4}", robot.seed, robot.told);
                }
                "completed".to_owned()
            }
            End::Diverged(what) => format!("diverged: {}", kind(what)),
            End::Refused(why) => format!("refused: {}", kind(why)),
            End::TooLong => format!("left out: more than {MOST_STEPS} steps"),
        };
        let drive = DRIVES.iter().position(|drive| *drive == robot.drive);
        table.entry(name).or_default()[drive.unwrap()] += 1;
    }
    println!("{DRIVES:?}");
    for (name, of) in &table {
        println!("{:6} {of:?}  {name}", of.iter().sum::<usize>());
    }
    println!(
        "worst disagreement {:.2e} of the range (seed {})",
        worst.0, worst.1
    );
    assert!(
        wrong.is_empty(),
        "completed, and half the step disagrees:\n{wrong}"
    );
    let completed: usize = table.get("completed").into_iter().flatten().sum();
    let completed = completed as f64 / ends.len() as f64;
    assert!(completed >= 0.7, "completed: {completed}");
}
