//! `truecut check`: runs every scenario found, judges the claims, prints one table, writes JUnit
//! XML.

use std::path::{Component, Path, PathBuf};
use std::time::{Duration, Instant};

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
use rayon::prelude::*;
use truecut::data;
use truecut::outputs::{Outputs, write_file, write_sweep};
use truecut_recording::ClaimResult;
use truecut_scenario::Scenario;
use truecut_sim::run::{Run, Runs};
use truecut_sim::sweep::sweep;
use truecut_sim::{Robots, estimates};

use crate::args::CheckArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::find::find_scenarios;
use crate::progress::{Progress, RunProgress};
use crate::text::{self, Align};

/// A scenario that was checked.
struct Checked {
    file: PathBuf,
    name: String,
    notes: Vec<String>,
    /// ExitStatus, or the report of why it cannot run.
    result: Result<Judged, String>,
    took: Duration,
}

struct Judged {
    /// Of the run alone.
    run: ExitStatus,
    /// With its claims.
    status: ExitStatus,
    outcome: String,
    claims: Vec<ClaimResult>,
}

/// A sentence on the files that are no scenarios.
fn left_out(others: &[PathBuf]) -> Option<String> {
    let names: Vec<String> = others
        .iter()
        .map(|file| file.display().to_string())
        .collect();
    (!names.is_empty()).then(|| format!("not scenarios, left out: {}", names.join(", ")))
}

/// Checks every file found; a scenario with bad input does not keep the others from running.
pub fn check(arguments: &CheckArguments) -> Result<ExitStatus, Failure> {
    arguments.common.use_jobs()?;
    let found = find_scenarios(&arguments.paths)?;
    let files = found.scenarios;
    (files.iter()).try_for_each(|file| Failure::if_same(&arguments.junit, file))?;
    let shared = (&Runs::default(), &Robots::new());
    let progress = Progress::new(files.len(), "checking");
    let checked: Vec<Checked> = files
        .par_iter()
        .map(|file| check_one(file, arguments, shared, &progress.run()))
        .collect();
    drop(progress);
    write_junit(&checked, &arguments.junit)?;
    crate::print(&table(&checked))?;
    let notes = checked.iter().flat_map(|one| {
        let file = one.file.display();
        one.notes.iter().map(move |note| format!("{file}: {note}"))
    });
    crate::print(&text::notes(notes))?;
    crate::print(&text::notes(left_out(&found.others)))?;
    for one in &checked {
        if let Err(report) = &one.result {
            crate::complain(report);
        }
    }
    crate::print(&format!("  {}\n", summary(&checked, arguments)))?;
    Ok(checked
        .iter()
        .map(status_of)
        .fold(ExitStatus::Good, ExitStatus::and))
}

fn check_one(
    file: &Path,
    arguments: &CheckArguments,
    shared: (&Runs, &Robots),
    progress: &RunProgress,
) -> Checked {
    let started = Instant::now();
    let mut name = file.display().to_string();
    let mut notes = Vec::new();
    let result = Scenario::load(file, &arguments.common.set)
        .map_err(Failure::from)
        .and_then(|scenario| {
            name.clone_from(&scenario.name);
            notes = scenario.notes();
            // What is wrong with the robot's files the run tells.
            notes.extend(estimates(&scenario, shared.1).ok().flatten());
            let out = kept_in(file, arguments);
            judge_scenario(&scenario, out.as_deref(), shared.0, progress)
        });
    Checked {
        file: file.to_owned(),
        name,
        notes,
        result: result.map_err(|failure| format!("{:?}", miette::Report::from(failure))),
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
) -> Result<Judged, Failure> {
    if scenario.sweep.is_some() {
        let table = sweep(scenario, &|part| progress.set(part))?;
        let claims = table.claims(scenario);
        let status = ExitStatus::of_sweep(&table, &claims);
        if let Some(out) = out.filter(|_| status != ExitStatus::Good) {
            write_sweep(out, scenario, &table)?;
        }
        return Ok(Judged {
            run: ExitStatus::of_sweep(&table, &[]),
            status: ExitStatus::of_sweep(&table, &claims),
            outcome: text::count_rows(&table),
            claims,
        });
    }
    if data::is_left_open(scenario) {
        return Ok(Judged {
            run: ExitStatus::Good,
            status: ExitStatus::Good,
            outcome: "not run: names no measured data".to_owned(),
            claims: Vec::new(),
        });
    }
    let run = Run {
        read_data: Some(data::replayed),
        references: Some(runs),
        progress: &|part| progress.set(part),
        ..Run::of(scenario)
    };
    // Kept because claims of other scenarios may refer to it.
    let recording = run.kept_in(runs)?;
    let claims = run.judge(&recording)?;
    let status = ExitStatus::of_run(&recording.outcome, &claims);
    if let Some(out) = out.filter(|_| status != ExitStatus::Good) {
        let outputs = Outputs::prepare(out, scenario, true)?;
        outputs.write(&recording, &claims)?;
    }
    Ok(Judged {
        run: ExitStatus::of_run(&recording.outcome, &[]),
        status,
        outcome: recording.outcome.to_string(),
        claims,
    })
}

fn status_of(checked: &Checked) -> ExitStatus {
    checked
        .result
        .as_ref()
        .map_or(ExitStatus::BadInput, |judged| judged.status)
}

fn table(checked: &[Checked]) -> String {
    let mut rows = Vec::new();
    for one in checked {
        let (mark, outcome, claims) = match &one.result {
            Ok(judged) => {
                let mark = if judged.status == ExitStatus::Good {
                    "✓"
                } else {
                    "✗"
                };
                let held = judged.claims.iter().filter(|claim| claim.holds).count();
                (
                    mark,
                    judged.outcome.clone(),
                    format!("{held}/{} claims", judged.claims.len()),
                )
            }
            Err(_) => ("✗", "bad input".to_owned(), String::new()),
        };
        let took = text::seconds(one.took.as_secs_f64());
        rows.push(vec![
            format!("{mark} {}", one.file.display()),
            claims,
            took,
            outcome,
        ]);
        let judged = one.result.as_ref().ok();
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
        .filter(|one| status_of(one) == ExitStatus::Good)
        .count();
    let all = checked.len();
    let kept = match &arguments.out {
        Some(out) if good < all => format!("; what failed is in {}", out.display()),
        _ => String::new(),
    };
    format!(
        "{good} of {all} scenarios hold; JUnit XML in {}{kept}",
        arguments.junit.display()
    )
}

fn write_junit(checked: &[Checked], junit: &Path) -> Result<(), Failure> {
    let mut report = Report::new("truecut");
    for one in checked {
        let mut suite = TestSuite::new(one.file.display().to_string());
        suite.set_time(one.took);
        suite.add_test_case(run_case(one));
        let judged = one.result.as_ref().ok();
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
/// error if it cannot start.
fn run_case(one: &Checked) -> TestCase {
    let status = match &one.result {
        Ok(Judged {
            run: ExitStatus::Good,
            ..
        }) => TestCaseStatus::success(),
        Ok(Judged { outcome, .. }) => non_success(NonSuccessKind::Failure, outcome),
        Err(report) => non_success(NonSuccessKind::Error, report),
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
