//! A sweep over the workers of a HyperQueue server: each makes parts, which are put together here.

use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::json;
use truecut::SweepParts;
use truecut::outputs::write_sweep;
use truecut_scenario::Scenario;

use super::present;
use crate::args::SweepArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::signals::Signals;

/// Speaks with the server.
const SCRIPT: &str = include_str!("hyperqueue.py");

/// Its exit codes.
const NO_PACKAGE: i32 = 3;
const NO_SERVER: i32 = 4;

/// How long a part is meant to take: long beside what a scheduler and a start of the program need,
/// short beside what a lost worker may cost.
const PART_S: f64 = 10.0;

/// More parts than that are work for a scheduler and for the file system.
const MOST_PARTS: usize = 20_000;

/// How often a part that did not come is tried again, if nothing else is asked for.
const RETRIES: usize = 3;

/// From one look at what has come to the next.
const BETWEEN_LOOKS: Duration = Duration::from_millis(200);

/// Some rows that a worker makes.
struct Share {
    rows: Range<usize>,
    part: PathBuf,
}

impl Share {
    /// What the worker said.
    fn words(&self) -> PathBuf {
        self.part.with_extension("err")
    }
}

/// Runs a sweep on the workers and writes what a sweep on one machine leaves. Parts that are there
/// already are kept, so that a sweep that was stopped goes on.
pub fn run_and_write(
    arguments: &SweepArguments,
    scenario: &Scenario,
    signals: &Signals,
) -> Result<ExitStatus, Failure> {
    let parts = SweepParts::of(scenario, arguments.engine())?;
    let folder = std::path::absolute(arguments.out.join(scenario.stem()).join("parts"))
        .map_err(|error| Failure::at(&arguments.out, error))?;
    std::fs::create_dir_all(&folder).map_err(|error| Failure::at(&folder, error))?;
    let size = match arguments.part_rows {
        Some(rows) => rows.get(),
        None => fitting_size(&parts, &folder)?,
    };
    let shares: Vec<Share> = (0..parts.count())
        .step_by(size)
        .map(|start| start..(start + size).min(parts.count()))
        .map(|rows| Share {
            part: folder.join(format!("rows_{:07}_{:07}.jsonl", rows.start, rows.end)),
            rows,
        })
        .collect();
    let lacking = |share: &&Share| !parts.has(&share.rows, &share.part);
    for _ in 0..=arguments.retries.unwrap_or(RETRIES) {
        let left: Vec<&Share> = shares.iter().filter(lacking).collect();
        if left.is_empty() || signals.came() {
            break;
        }
        Progress::of_one("sweeping on workers", |progress| {
            hand_out(arguments, scenario, &left, progress, signals)
        })?;
    }
    let left: Vec<&Share> = shares.iter().filter(lacking).collect();
    if signals.came() {
        let came = shares.len() - left.len();
        return crate::print(&format!(
            "{}\n  stopped by a signal: {came} of {} parts are kept, and the same call goes on from there\n\n",
            scenario.name,
            shares.len()
        ));
    }
    if let Some(share) = left.first() {
        return Err(not_made(share, left.len(), shares.len()));
    }
    let names: Vec<PathBuf> = shares.iter().map(|share| share.part.clone()).collect();
    let table = parts.merge(&names)?;
    let written = write_sweep(&arguments.out, scenario, &table)?;
    // They have served.
    let _ = std::fs::remove_dir_all(&folder);
    present(scenario, &table, &written)
}

/// How many rows take about [`PART_S`]: as many as in a part that an earlier call has left, or by
/// the time of the first row.
fn fitting_size(parts: &SweepParts<'_>, folder: &Path) -> Result<usize, Failure> {
    let left = std::fs::read_dir(folder).map_err(|error| Failure::at(folder, error))?;
    let left = left.flatten().filter_map(|entry| {
        let rows = rows_of(&entry.path())?;
        parts.has(&rows, &entry.path()).then(|| rows.len())
    });
    if let Some(longest) = left.max() {
        return Ok(longest);
    }
    let began = Instant::now();
    let trial = folder.join("trial.jsonl");
    let made = parts.make(&(0..1), &trial, &|_| {}, None);
    let _ = std::fs::remove_file(&trial);
    made?;
    let row_s = began.elapsed().as_secs_f64().max(1e-6);
    let least = parts.count().div_ceil(MOST_PARTS).max(1);
    Ok(((PART_S / row_s) as usize).clamp(least, parts.count().max(least)))
}

/// The rows that the name of a part tells of.
fn rows_of(part: &Path) -> Option<Range<usize>> {
    let name = part.file_name()?.to_str()?;
    let (from, to) = name
        .strip_prefix("rows_")?
        .strip_suffix(".jsonl")?
        .split_once('_')?;
    Some(from.parse().ok()?..to.parse().ok()?)
}

/// Gives shares to the workers, once, and waits for all.
fn hand_out(
    arguments: &SweepArguments,
    scenario: &Scenario,
    shares: &[&Share],
    progress: &(dyn Fn(f64) + Sync),
    signals: &Signals,
) -> Result<(), Failure> {
    let program = std::env::current_exe().map_err(|error| Failure::message(error.to_string()))?;
    let tasks = shares.iter().map(|share| {
        let mut words = vec![program.display().to_string()];
        words.extend(arguments.for_part(scenario, &share.rows, share.part.display().to_string()));
        json!({"args": words, "stderr": share.words()})
    });
    let plan = json!({
        "server": arguments.server,
        "name": scenario.name,
        "tasks": tasks.collect::<Vec<_>>(),
    });
    let python = std::env::var_os("TRUECUT_PYTHON").unwrap_or_else(|| "python3".into());
    let python = PathBuf::from(python);
    let failed = |error: std::io::Error| Failure::at(&python, error);
    let mut script = Command::new(&python)
        .args(["-c", SCRIPT])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(failed)?;
    if let Some(mut input) = script.stdin.take() {
        // One that ends at once says why by its code.
        let _ = input.write_all(plan.to_string().as_bytes());
    }
    let ended = wait(script, shares, progress, signals).map_err(failed)?;
    let Some(ended) = ended else {
        return Ok(());
    };
    let words = String::from_utf8_lossy(&ended.stderr).trim().to_owned();
    match ended.status.code() {
        Some(0) => Ok(()),
        Some(NO_PACKAGE) => Err(Failure::with_help(
            format!("{} has no package hyperqueue", python.display()),
            "pip install hyperqueue, or name another interpreter in TRUECUT_PYTHON",
        )),
        Some(NO_SERVER) => Err(Failure::with_help(
            format!("there is no HyperQueue server: {words}"),
            "start one (`hq server start`) and workers, or name its folder with --server",
        )),
        _ => Err(Failure::with_help(
            format!("HyperQueue's server is gone, or refused the work: {words}"),
            "parts that have come are kept, and the same call goes on from there",
        )),
    }
}

/// Waits until the script ends, and tells what has come. `None` after a signal: the script is
/// ended then, what the workers hold goes on.
fn wait(
    mut script: Child,
    shares: &[&Share],
    progress: &(dyn Fn(f64) + Sync),
    signals: &Signals,
) -> std::io::Result<Option<Output>> {
    let mut errors = script.stderr.take();
    // A pipe that nobody reads would stop the script.
    let reader = std::thread::spawn(move || {
        let mut words = Vec::new();
        if let Some(errors) = &mut errors {
            let _ = std::io::Read::read_to_end(errors, &mut words);
        }
        words
    });
    let status = loop {
        if let Some(status) = script.try_wait()? {
            break status;
        }
        if signals.came() {
            script.kill()?;
            script.wait()?;
            return Ok(None);
        }
        let came = shares.iter().filter(|share| share.part.exists()).count();
        progress(came as f64 / shares.len() as f64);
        std::thread::sleep(BETWEEN_LOOKS);
    };
    Ok(Some(Output {
        status,
        stdout: Vec::new(),
        stderr: reader.join().unwrap_or_default(),
    }))
}

/// Parts that did not come, with what the worker said of the first.
fn not_made(share: &Share, left: usize, of: usize) -> Failure {
    let Range { start, end } = share.rows;
    let words = truecut_files::read_text(&share.words()).unwrap_or_default();
    let words = match words.trim() {
        "" => "its worker said nothing: it may have died, or have no disk left".to_owned(),
        words => words.to_owned(),
    };
    Failure::with_help(
        format!("{left} of {of} parts did not come; the first is rows {start}..{end}: {words}"),
        "parts that have come are kept, and the same call goes on from there",
    )
}
