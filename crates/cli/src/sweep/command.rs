//! `truecut sweep`: a sweep whole, some of its rows as a part, parts put together, or over workers.

use std::ops::Range;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use truecut::outputs::write_sweep;
use truecut::{Made, SweepParts};
use truecut_scenario::Scenario;
use truecut_sim::run::RunError;

use super::{cluster, present, run_and_write};
use crate::args::{SweepArguments, Workers};
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::signals::Signals;

/// Does what the arguments ask of a sweep.
pub fn sweep(arguments: &SweepArguments) -> Result<ExitCode, Failure> {
    let signals = Signals::catch()?;
    let scenario = arguments.load()?;
    let status = match (&arguments.rows, &arguments.part) {
        (Some(rows), Some(part)) => make_part(arguments, &scenario, rows, part, &signals),
        _ if !arguments.merge.is_empty() => merge(arguments, &scenario),
        _ if arguments.workers_on == Workers::Hyperqueue => {
            cluster::run_and_write(arguments, &scenario, &signals)
        }
        _ => run_and_write(
            &scenario,
            arguments.engine(),
            &arguments.out,
            signals.stop(),
        ),
    }?;
    Ok(signals.exit_code().map_or(status.into(), ExitCode::from))
}

/// Makes some rows. That they are made is what a scheduler waits for: how their runs ended is told
/// with the table.
fn make_part(
    arguments: &SweepArguments,
    scenario: &Scenario,
    rows: &Range<usize>,
    part: &Path,
    signals: &Signals,
) -> Result<ExitStatus, Failure> {
    Failure::if_read(part)?;
    let parts = SweepParts::of(scenario, arguments.engine())?;
    let is_late = AtomicBool::new(false);
    let made = within(arguments.limit_s, signals.stop(), &is_late, || {
        Progress::of_one("sweeping", |progress| {
            parts.make(rows, part, progress, Some(signals.stop()))
        })
    });
    let (named, shown) = (format!("rows {}..{}", rows.start, rows.end), part.display());
    match made {
        Ok(Made::Now) => crate::print(&format!("{shown}: {named} of {}\n", parts.count())),
        Ok(Made::Before) => crate::print(&format!("{shown}: has {named} already\n")),
        Err(RunError::Stopped) if is_late.load(Ordering::Relaxed) => {
            let limit_s = arguments.limit_s.unwrap_or_default();
            Err(Failure::message(format!(
                "{named} took longer than --limit-s {limit_s}: no part was written"
            )))
        }
        Err(RunError::Stopped) => crate::print(&format!(
            "{named}: stopped by a signal, no part was written\n"
        )),
        Err(error) => Err(error.into()),
    }
}

/// Does work; sets `stop`, and `is_late`, when it takes longer than a limit.
fn within<T>(
    limit_s: Option<f64>,
    stop: &AtomicBool,
    is_late: &AtomicBool,
    work: impl FnOnce() -> T,
) -> T {
    let limit = limit_s.and_then(|limit_s| Duration::try_from_secs_f64(limit_s).ok());
    let Some(limit) = limit else {
        return work();
    };
    std::thread::scope(|scope| {
        let (done, waiting) = mpsc::channel::<()>();
        scope.spawn(move || {
            if waiting.recv_timeout(limit) == Err(mpsc::RecvTimeoutError::Timeout) {
                is_late.store(true, Ordering::Relaxed);
                stop.store(true, Ordering::Relaxed);
            }
        });
        let answer = work();
        drop(done);
        answer
    })
}

/// Puts parts together to the files that a sweep on one machine leaves.
fn merge(arguments: &SweepArguments, scenario: &Scenario) -> Result<ExitStatus, Failure> {
    let parts = SweepParts::of(scenario, arguments.engine())?;
    let table = parts.merge(&arguments.merge)?;
    let written = write_sweep(&arguments.out, scenario, &table)?;
    present(scenario, &table, &written)
}
