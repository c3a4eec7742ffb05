//! `truecut check`: runs every scenario found, judges the claims, prints one table, writes JUnit
//! XML and a page.

mod report;

use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
use rayon::prelude::*;
use truecut::data;
use truecut::outputs::{Outputs, write_file, write_sweep};
use truecut_recording::{ClaimResult, Outcome};
use truecut_scenario::Scenario;
use truecut_sim::process::tells_unfinished;
use truecut_sim::run::{Run, RunError, Runs};
use truecut_sim::sweep::Sweep;
use truecut_sim::{Robots, estimates};

use crate::args::CheckArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::find::find_scenarios;
use crate::progress::{Progress, RunProgress};
use crate::signals::Signals;
use crate::text::{self, Align};

/// Of a scenario that had not begun when a signal came, and of one that had.
const NOT_RUN: &str = "not run: stopped by a signal";
const STOPPED: &str = "stopped by a signal";

/// A scenario that was checked.
struct Checked {
    file: PathBuf,
    name: String,
    notes: Vec<String>,
    result: Judgement,
    took: Duration,
}

enum Judgement {
    Judged(Judged),
    /// The report of why it cannot run.
    Refused(String),
    /// A signal came before there was a verdict: what there is instead.
    Stopped(String),
}

impl Judgement {
    fn judged(&self) -> Option<&Judged> {
        match self {
            Judgement::Judged(judged) => Some(judged),
            Judgement::Refused(_) | Judgement::Stopped(_) => None,
        }
    }
}

struct Judged {
    /// Of the run alone.
    run: ExitStatus,
    /// With its claims.
    status: ExitStatus,
    outcome: String,
    claims: Vec<ClaimResult>,
    /// That the run ended before its process did: the claims hold for a part of it.
    unfinished: Option<String>,
}

/// A sentence on the files that are no scenarios.
fn left_out(others: &[PathBuf]) -> Option<String> {
    let names: Vec<String> = others
        .iter()
        .map(|file| file.display().to_string())
        .collect();
    (!names.is_empty()).then(|| format!("not scenarios, left out: {}", names.join(", ")))
}

/// Checks every file found; a scenario with bad input does not keep the others from running. A
/// signal stops what runs at a step: the verdicts that there are by then are written all the same.
pub fn check(arguments: &CheckArguments) -> Result<ExitCode, Failure> {
    let signals = Signals::catch()?;
    arguments.common.use_jobs()?;
    let found = find_scenarios(&arguments.paths)?;
    let files = found.scenarios;
    (files.iter()).try_for_each(|file| Failure::if_same(&arguments.junit, file))?;
    Failure::if_folder(&arguments.junit)?;
    let shared = (&Runs::default(), &Robots::new());
    let progress = Progress::new(files.len(), "checking");
    let checked: Vec<Checked> = files
        .par_iter()
        .map(|file| check_one(file, arguments, shared, &progress.run(), &signals))
        .collect();
    drop(progress);
    // Verdicts are told also where the file that is to hold them is one that was read.
    crate::print(&table(&checked))?;
    Failure::if_read(&arguments.junit)?;
    write_junit(&checked, &arguments.junit)?;
    report::write(&checked, &arguments.junit)?;
    let notes = checked.iter().flat_map(|one| {
        let file = one.file.display();
        one.notes.iter().map(move |note| format!("{file}: {note}"))
    });
    crate::print(&text::notes(notes))?;
    crate::print(&text::notes(left_out(&found.others)))?;
    for one in &checked {
        if let Judgement::Refused(report) = &one.result {
            crate::complain(report);
        }
    }
    crate::print(&format!("  {}\n", summary(&checked, arguments)))?;
    let all = checked.iter().map(status_of);
    let all = all.fold(ExitStatus::Good, ExitStatus::and);
    Ok(signals.exit_code().map_or(all.into(), ExitCode::from))
}

fn check_one(
    file: &Path,
    arguments: &CheckArguments,
    shared: (&Runs, &Robots),
    progress: &RunProgress,
    signals: &Signals,
) -> Checked {
    let started = Instant::now();
    let mut name = file.display().to_string();
    let mut notes = Vec::new();
    let began = !signals.came();
    let result = Scenario::load(file, &arguments.common.set)
        .map_err(Failure::from)
        .and_then(|scenario| {
            name.clone_from(&scenario.name);
            notes = scenario.notes();
            if !began {
                return Ok(Judgement::Stopped(NOT_RUN.to_owned()));
            }
            // What is wrong with the robot's files the run tells.
            notes.extend(estimates(&scenario, shared.1).ok().flatten());
            let out = kept_in(file, arguments);
            judge_scenario(&scenario, out.as_deref(), shared.0, progress, signals)
        });
    let refused = |failure| {
        let report = miette::Report::from(failure);
        Judgement::Refused(format!("{report:?}"))
    };
    if let Ok(Judgement::Judged(judged)) = &result {
        notes.extend(judged.unfinished.clone());
    }
    Checked {
        file: file.to_owned(),
        name,
        notes,
        result: result.unwrap_or_else(refused),
        took: started.elapsed(),
    }
}

/// Where outputs of a scenario that fails are kept: below the folder asked for as its file lies, so
/// that files of one name in several folders do not meet.
fn kept_in(file: &Path, arguments: &CheckArguments) -> Option<PathBuf> {
    let is_name = |part: &Component| matches!(part, Component::Normal(_));
    let folder = file.parent().unwrap_or(Path::new(""));
    let below: PathBuf = folder.components().filter(is_name).collect();
    arguments.out.as_ref().map(|out| out.join(below))
}

fn judge_scenario(
    scenario: &Scenario,
    out: Option<&Path>,
    runs: &Runs,
    progress: &RunProgress,
    signals: &Signals,
) -> Result<Judgement, Failure> {
    if scenario.sweep.is_some() {
        let sweep = Sweep {
            progress: &|part| progress.set(part),
            stop: Some(signals.stop()),
            ..Sweep::of(scenario)
        };
        let Some(table) = unless_stopped(sweep.execute())? else {
            return Ok(Judgement::Stopped(STOPPED.to_owned()));
        };
        let claims = table.claims(scenario);
        let status = ExitStatus::of_sweep(&table, &claims);
        if let Some(out) = out.filter(|_| status != ExitStatus::Good) {
            write_sweep(out, scenario, &table)?;
        }
        return Ok(Judgement::Judged(Judged {
            run: ExitStatus::of_sweep(&table, &[]),
            status,
            outcome: text::count_rows(&table),
            claims,
            unfinished: None,
        }));
    }
    if data::is_left_open(scenario) {
        return Ok(Judgement::Judged(Judged {
            run: ExitStatus::Good,
            status: ExitStatus::Good,
            outcome: "not run: names no measured data".to_owned(),
            claims: Vec::new(),
            unfinished: None,
        }));
    }
    judge_run(scenario, out, runs, progress, signals)
}

fn judge_run(
    scenario: &Scenario,
    out: Option<&Path>,
    runs: &Runs,
    progress: &RunProgress,
    signals: &Signals,
) -> Result<Judgement, Failure> {
    let run = Run {
        read_data: Some(data::replayed),
        references: Some(runs),
        progress: &|part| progress.set(part),
        stop: Some(signals.stop()),
        ..Run::of(scenario)
    };
    // Kept because claims of other scenarios may refer to it.
    let recording = run.kept_in(runs)?;
    if recording.outcome == Outcome::Interrupted {
        let time_s = recording.time_s.last().copied().unwrap_or(0.0);
        let after = text::seconds(time_s);
        return Ok(Judgement::Stopped(format!("{STOPPED} after {after} of it")));
    }
    let Some(claims) = unless_stopped(run.judge(&recording))? else {
        return Ok(Judgement::Stopped(STOPPED.to_owned()));
    };
    let status = ExitStatus::of_run(&recording.outcome, &claims);
    if let Some(out) = out.filter(|_| status != ExitStatus::Good) {
        let outputs = Outputs::prepare(out, scenario, true)?;
        outputs.write(&recording, &claims)?;
    }
    Ok(Judgement::Judged(Judged {
        run: ExitStatus::of_run(&recording.outcome, &[]),
        status,
        outcome: recording.outcome.to_string(),
        claims,
        unfinished: (recording
            .header
            .notes
            .iter()
            .find(|note| tells_unfinished(note)))
        .cloned(),
    }))
}

/// What was made; `None` if a signal came before.
fn unless_stopped<T>(made: Result<T, RunError>) -> Result<Option<T>, Failure> {
    match made {
        Err(RunError::Stopped) => Ok(None),
        other => Ok(Some(other?)),
    }
}

/// Of a scenario that a signal stopped nothing is said: the program's code tells of the signal.
fn status_of(checked: &Checked) -> ExitStatus {
    match &checked.result {
        Judgement::Judged(judged) => judged.status,
        Judgement::Refused(_) => ExitStatus::BadInput,
        Judgement::Stopped(_) => ExitStatus::Good,
    }
}

fn table(checked: &[Checked]) -> String {
    let mut rows = Vec::new();
    for one in checked {
        let (mark, outcome, claims) = match &one.result {
            Judgement::Judged(judged) => {
                let mark = if judged.status == ExitStatus::Good {
                    "✓"
                } else {
                    "✗"
                };
                let held = judged.claims.iter().filter(|claim| claim.holds).count();
                (
                    mark,
                    judged.outcome.clone(),
                    match judged.claims.len() {
                        0 => "no claims".to_owned(),
                        all => format!("{held}/{all} claims"),
                    },
                )
            }
            Judgement::Refused(_) => ("✗", "bad input".to_owned(), String::new()),
            Judgement::Stopped(how) => ("✗", how.clone(), String::new()),
        };
        let took = text::seconds(one.took.as_secs_f64());
        rows.push(vec![
            format!("{mark} {}", one.file.display()),
            claims,
            took,
            outcome,
        ]);
        let judged = one.result.judged();
        for claim in judged.into_iter().flat_map(|judged| &judged.claims) {
            if !claim.holds {
                let name = format!("    ✗ {}", claim.name);
                rows.push(vec![
                    name,
                    String::new(),
                    String::new(),
                    text::with_note(claim),
                ]);
            }
        }
    }
    text::table(
        &[Align::Left, Align::Right, Align::Right, Align::Left],
        &rows,
    )
}

fn summary(checked: &[Checked], arguments: &CheckArguments) -> String {
    let good = checked
        .iter()
        .filter(|one| {
            one.result
                .judged()
                .is_some_and(|it| it.status == ExitStatus::Good)
        })
        .count();
    let all = checked.len();
    let stopped = |one: &&Checked| matches!(one.result, Judgement::Stopped(_));
    let left = match checked.iter().filter(stopped).count() {
        0 => String::new(),
        left => format!(", {left} without a verdict: stopped by a signal"),
    };
    let kept = match &arguments.out {
        Some(out) if good < all => format!("; what failed is in {}", out.display()),
        _ => String::new(),
    };
    format!(
        "{good} of {all} scenarios hold{left}; JUnit XML in {}{kept}",
        arguments.junit.display()
    )
}

fn write_junit(checked: &[Checked], junit: &Path) -> Result<(), Failure> {
    let mut report = Report::new("truecut");
    for one in checked {
        let mut suite = TestSuite::new(one.file.display().to_string());
        suite.set_time(one.took);
        suite.add_test_case(run_case(one));
        let judged = one.result.judged();
        for claim in judged.into_iter().flat_map(|judged| &judged.claims) {
            suite.add_test_case(claim_case(claim));
        }
        report.add_test_suite(suite);
    }
    let xml = report
        .to_string()
        .map_err(|error| Failure::at(junit, error))?;
    Ok(write_file(junit, xml.as_bytes())?)
}

/// The run itself is a test case: failed if it diverges, ends in chatter or overloads a drive, an
/// error if it cannot start, skipped if a signal came before its end.
fn run_case(one: &Checked) -> TestCase {
    let status = match &one.result {
        Judgement::Judged(Judged {
            run: ExitStatus::Good,
            ..
        }) => TestCaseStatus::success(),
        Judgement::Judged(Judged { outcome, .. }) => non_success(NonSuccessKind::Failure, outcome),
        Judgement::Refused(report) => non_success(NonSuccessKind::Error, report),
        Judgement::Stopped(how) => {
            let mut skipped = TestCaseStatus::skipped();
            skipped.set_message(how);
            skipped
        }
    };
    let mut case = TestCase::new(format!("{} runs", one.name), status);
    case.set_time(one.took);
    if !one.notes.is_empty() {
        case.set_system_out(text::notes(&one.notes));
    }
    case
}

fn claim_case(claim: &ClaimResult) -> TestCase {
    let status = if claim.holds {
        TestCaseStatus::success()
    } else {
        let shown = text::with_note(claim);
        let text = format!("{}: {shown}; {}", claim.metric, claim.reason);
        non_success(NonSuccessKind::Failure, &text)
    };
    TestCase::new(&*claim.name, status)
}

fn non_success(kind: NonSuccessKind, message: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(kind);
    status.set_message(message);
    status
}
