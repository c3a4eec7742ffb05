//! Errors of the library as exceptions.

use std::any::Any;
use std::path::Path;

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyRuntimeError};
use pyo3::prelude::*;
use truecut::RunError;
use truecut::arm::ArmError;
use truecut::scenario::ScenarioError;

create_exception!(
    truecut,
    TruecutError,
    PyException,
    "What is wrong with a scenario, a robot or data.\n\n\
     Attributes: `file` (str or None), `line` (int, counted from 1, or None), `key` (dotted key of \
     the scenario, or None), `rule` (the value, the limit and the rule that it breaks), `help` \
     (what to do about it, or None)."
);

/// Where an error lies.
#[derive(Default)]
struct Place {
    file: Option<String>,
    line: Option<usize>,
    key: Option<String>,
    help: Option<String>,
}

fn raised(py: Python<'_>, rule: &str, place: Place) -> PyErr {
    let Place {
        file,
        line,
        key,
        help,
    } = place;
    let mut text = String::new();
    if let Some(file) = &file {
        text.push_str(file);
        if let Some(line) = line {
            text.push_str(&format!(":{line}"));
        }
        text.push_str(": ");
    }
    text.push_str(rule);
    if let Some(help) = &help {
        text.push_str(&format!(" ({help})"));
    }
    let error = TruecutError::new_err(text);
    let value = error.value(py);
    let set = value
        .setattr("file", file)
        .and_then(|()| value.setattr("line", line))
        .and_then(|()| value.setattr("key", key))
        .and_then(|()| value.setattr("rule", rule))
        .and_then(|()| value.setattr("help", help));
    match set {
        Ok(()) => error,
        Err(other) => other,
    }
}

/// An error without a place in a file.
pub fn plain(py: Python<'_>, rule: &str) -> PyErr {
    raised(py, rule, Place::default())
}

/// An error of a scenario's file.
pub fn of_scenario(py: Python<'_>, path: &Path, error: &ScenarioError) -> PyErr {
    let problems: Vec<_> = error.problems().collect();
    let Some(first) = problems.first() else {
        return plain(py, &error.to_string());
    };
    let others = problems[1..].iter().map(|one| one.message.as_str());
    let rules: Vec<&str> = std::iter::once(first.message.as_str())
        .chain(others)
        .collect();
    let place = Place {
        file: Some(path.display().to_string()),
        line: first.line(),
        key: (!first.key.is_empty()).then(|| first.key.clone()),
        help: first.help.clone(),
    };
    raised(py, &rules.join("; "), place)
}

/// An error of a robot's files.
pub fn of_arm(py: Python<'_>, error: &ArmError) -> PyErr {
    let place = Place {
        file: error.path().map(|path| path.display().to_string()),
        line: error.line(),
        ..Place::default()
    };
    let rule = match place.file {
        Some(_) => error.message(),
        None => error.to_string(),
    };
    raised(py, &rule, place)
}

/// An error of a run.
pub fn of_run(py: Python<'_>, path: &Path, error: &RunError) -> PyErr {
    match error {
        RunError::Scenario(error) => of_scenario(py, path, error),
        RunError::Robot { error, .. } => of_arm(py, error),
        RunError::Unjudged { error, .. } => of_run(py, path, error),
        RunError::Data { message, help } => {
            let place = Place {
                help: help.clone(),
                ..Place::default()
            };
            raised(py, message, place)
        }
        other => plain(py, &other.to_string()),
    }
}

/// A panic of the library, which is a fault of it.
pub fn bug(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    let text = text.unwrap_or("no text");
    PyRuntimeError::new_err(format!("truecut has a fault, please report it: {text}"))
}
