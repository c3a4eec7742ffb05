//! Errors of the scenario file: what is wrong, where, and which rule it breaks.

use std::path::{Path, PathBuf};

use miette::{Diagnostic, NamedSource, SourceSpan};
use thiserror::Error;

use crate::excerpt::{excerpt, harmless_text};
use crate::fault::Fault;

/// Why a scenario could not be loaded.
#[derive(Debug, Error, Diagnostic)]
pub enum ScenarioError {
    /// The file could not be read.
    #[error("cannot read {what} {}: {reason}", path.display())]
    #[diagnostic(severity(Error))]
    Unreadable {
        /// What the file should be.
        what: &'static str,
        /// The file as it was named.
        path: PathBuf,
        /// What the operating system said.
        reason: String,
    },
    /// The text breaks rules of the format; all of them are listed, the first is the one shown
    /// first.
    #[error("{0}")]
    #[diagnostic(forward(0))]
    Invalid(Box<Problem>, #[related] Vec<Problem>),
}

/// One broken rule, with the place where it is broken.
#[derive(Debug, Clone, Error, Diagnostic)]
#[error("{message}")]
#[diagnostic(severity(Error))]
pub struct Problem {
    /// Dotted path of the key concerned, as `--set` takes it; empty for the file as a whole.
    pub key: String,
    /// What is wrong: the offending value, the limit and the rule.
    pub message: String,
    /// What to do about it.
    #[help]
    pub help: Option<String>,
    /// Short text shown under the offending characters.
    pub label: String,
    #[source_code]
    text: NamedSource<String>,
    #[label(primary, "{label}")]
    span: SourceSpan,
    line: Option<usize>,
}

impl Problem {
    pub(crate) fn new(fault: Fault, place: Place) -> Problem {
        let mut span = [place.span];
        let text = excerpt(&place.text, &mut span);
        let [span] = span;
        Problem {
            key: fault.path.join("."),
            message: harmless_text(&fault.message),
            help: fault.help.as_deref().map(harmless_text),
            label: harmless_text(&fault.label),
            text: NamedSource::new(place.source_name, text),
            span: span.into(),
            line: place.line,
        }
    }

    /// Line in the scenario file, counted from 1; `None` if the value came from `--set`.
    pub fn line(&self) -> Option<usize> {
        self.line
    }
}

/// A span in a named text: the scenario file, or what was given to `--set`.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub source_name: String,
    pub text: String,
    pub span: std::ops::Range<usize>,
    pub line: Option<usize>,
}

impl ScenarioError {
    /// The broken rules, in the order of the file; empty if the file could not be read at all.
    pub fn problems(&self) -> impl Iterator<Item = &Problem> {
        let (first, rest) = match self {
            ScenarioError::Unreadable { .. } => (None, &[][..]),
            ScenarioError::Invalid(first, rest) => (Some(&**first), &rest[..]),
        };
        first.into_iter().chain(rest)
    }
}

impl From<Problem> for ScenarioError {
    fn from(problem: Problem) -> Self {
        ScenarioError::Invalid(Box::new(problem), Vec::new())
    }
}

/// The text of a file that should be `what`.
pub(crate) fn read_text(what: &'static str, path: &Path) -> Result<String, ScenarioError> {
    truecut_files::read_text(path).map_err(|error| ScenarioError::Unreadable {
        what,
        path: path.to_owned(),
        reason: error.to_string(),
    })
}
