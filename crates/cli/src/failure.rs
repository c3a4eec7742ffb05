//! Errors of the program, as one report on standard error.

use std::ops::Range;
use std::path::Path;

use miette::{LabeledSpan, MietteDiagnostic, NamedSource, Report};
use truecut_arm::{ArmError, ArmErrorKind};
use truecut_scenario::{Identification, Scenario, ScenarioError, excerpt, harmless_text};
use truecut_sim::SimError;
use truecut_sim::run::RunError;
use truecut_telemetry::FileError;

/// Why a command failed.
#[derive(Debug)]
pub struct Failure(Report);

impl From<Failure> for Report {
    fn from(failure: Failure) -> Report {
        failure.0
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

impl From<ScenarioError> for Failure {
    fn from(error: ScenarioError) -> Failure {
        Failure(error.into())
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Failure {
        match error {
            RunError::Scenario(error) => (*error).into(),
            RunError::Robot { error, scenario } => {
                let help = format!("it is the robot of {}", scenario.display());
                Failure::arm_with(&error, Some(help))
            }
            RunError::Data { message, help } => Failure::advised(message, help),
            RunError::Unjudged { error, .. } => (*error).into(),
            RunError::Metric { .. } | RunError::Sink(_) | RunError::Stopped => {
                Failure::message(error.to_string())
            }
        }
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Failure {
        Failure::message(error.to_string())
    }
}

impl Failure {
    /// A failure that is not at a place in a file.
    pub fn message(text: impl Into<String>) -> Failure {
        Failure::advised(text, None)
    }

    /// A failure about a file or a folder.
    pub fn at(path: &Path, what: impl std::fmt::Display) -> Failure {
        Failure::message(format!("{}: {what}", path.display()))
    }

    /// Refuses to write over a file that is read.
    pub fn if_same(out: &Path, read: &Path) -> Result<(), Failure> {
        let place = |path: &Path| path.canonicalize().ok();
        let is_same = place(out).is_some_and(|out| Some(out) == place(read));
        Failure::if_written_over(out, is_same)
    }

    /// A failure if a file is to be written where a folder stands.
    pub fn if_folder(out: &Path) -> Result<(), Failure> {
        match out.is_dir() {
            true => Err(Failure::at(
                out,
                "is a folder; a file is to be written there",
            )),
            false => Ok(()),
        }
    }

    /// A failure if `out` is a file that was read: a robot's, its settings, measured data.
    pub fn if_read(out: &Path) -> Result<(), Failure> {
        Failure::if_written_over(out, truecut_files::was_read(out))
    }

    fn if_written_over(out: &Path, is_read: bool) -> Result<(), Failure> {
        if is_read {
            let text = "is what is read and cannot be what is written, too";
            return Err(Failure::at(out, text));
        }
        Ok(())
    }

    /// A failure that is not at a place in a file, with advice.
    pub fn with_help(text: impl Into<String>, help: impl Into<String>) -> Failure {
        Failure::advised(text, Some(help.into()))
    }

    fn advised(text: impl Into<String>, help: Option<String>) -> Failure {
        Failure(described(text, help).into())
    }

    /// An error in a file that another file names; at its line if known.
    pub fn in_file(
        path: Option<&Path>,
        line: Option<usize>,
        text: String,
        help: Option<String>,
    ) -> Failure {
        let place = path.zip(line);
        let shown = place.and_then(|(path, line)| in_line(path, line, text.clone(), help.clone()));
        shown.unwrap_or_else(|| {
            // A file that is too long to be shown, or whose line is not known.
            let line = line.map_or_else(String::new, |line| format!(":{line}"));
            let file = path.map_or_else(String::new, |path| format!("{}{line}: ", path.display()));
            Failure::advised(format!("{file}{text}"), help)
        })
    }

    /// A robot that cannot be used, at the line of the error if known.
    pub fn arm(error: &ArmError) -> Failure {
        Failure::arm_with(error, None)
    }

    fn arm_with(error: &ArmError, help: Option<String>) -> Failure {
        if let (ArmErrorKind::Several(faults), Some(path)) = (error.kind(), error.path()) {
            let labels = faults.iter().filter_map(|fault| {
                let line = fault.line()?;
                Some((line, fault.message()))
            });
            let labels: Vec<(usize, String)> = labels.collect();
            let text = format!("{} faults", faults.len());
            if let Some(shown) = in_lines(path, text, &labels, help.clone()) {
                return shown;
            }
        }
        if let ArmErrorKind::AmbiguousTip { .. } = error.kind() {
            let tip = "--tip, or `tip` of [robot] in a scenario, names the link that is the flange";
            return Failure::with_help(error.to_string(), tip);
        }
        let place = error.path().zip(error.line());
        let shown = place.and_then(|(path, line)| in_line(path, line, error.message(), help));
        shown.unwrap_or_else(|| Failure::message(error.to_string()))
    }

    /// An error of the simulator, at the key of the scenario that caused it.
    pub fn sim(scenario: &Scenario, error: SimError) -> Failure {
        RunError::of(scenario, error).into()
    }

    /// An error of the arm of an identification, at the key that caused it.
    pub fn identified_arm(file: &Identification, error: SimError) -> Failure {
        match error {
            SimError::Scenario { key, message } => {
                (file.problem(&key, format!("`{key}` {message}"))).into()
            }
            SimError::Arm(error) if error.line().is_some() => {
                let help = format!("it is the robot of {}", file.path().display());
                Failure::arm_with(&error, Some(help))
            }
            SimError::Arm(error) => {
                let key = file.robot.key_of(&error);
                file.problem(&key, error.to_string()).into()
            }
            other => file.problem("robot.urdf", other.to_string()).into(),
        }
    }
}

fn described(text: impl Into<String>, help: Option<String>) -> MietteDiagnostic {
    MietteDiagnostic {
        help: help.as_deref().map(harmless_text),
        ..MietteDiagnostic::new(harmless_text(&text.into()))
    }
}

fn in_line(path: &Path, line: usize, text: String, help: Option<String>) -> Option<Failure> {
    in_lines(path, text, &[(line, "here".to_owned())], help)
}

/// The same with a label at each of several lines.
fn in_lines(
    path: &Path,
    text: String,
    labels: &[(usize, String)],
    help: Option<String>,
) -> Option<Failure> {
    // As it can be shown: lines are where they are in any encoding that is read.
    let source = truecut_files::read_raw_text(path).ok()?;
    let source = String::from_utf8_lossy(&source).into_owned();
    let span = |(line, _): &(usize, String)| {
        let lines = source.split_inclusive('\n').take(line.checked_sub(1)?);
        let start: usize = lines.map(str::len).sum();
        let rest = source.get(start..)?.lines().next().unwrap_or_default();
        let first = start + rest.len() - rest.trim_start().len();
        Some(first..first + rest.trim().len())
    };
    let mut spans: Vec<Range<usize>> = labels.iter().map(span).collect::<Option<_>>()?;
    let source = excerpt(&source, &mut spans);
    let label = |(index, ((_, label), span)): (usize, (&(usize, String), Range<usize>))| {
        let of = if index == 0 {
            LabeledSpan::new_primary_with_span
        } else {
            LabeledSpan::new_with_span
        };
        of(Some(harmless_text(label)), span)
    };
    let labels: Vec<LabeledSpan> = labels.iter().zip(spans).enumerate().map(label).collect();
    let report = Report::new(described(text, help).with_labels(labels));
    let source = NamedSource::new(path.display().to_string(), source);
    Some(Failure(report.with_source_code(source)))
}
