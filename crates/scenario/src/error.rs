//! Errors of the scenario file: what is wrong, where, and which rule it breaks.

use std::fmt;
use std::path::{Path, PathBuf};

use miette::{Diagnostic, LabeledSpan, NamedSource, Severity, SourceCode, SourceSpan};

/// Why a scenario could not be loaded.
#[derive(Debug)]
pub enum ScenarioError {
    /// The file could not be read.
    Unreadable {
        /// What the file should be.
        what: &'static str,
        /// The file as it was named.
        path: PathBuf,
        /// What the operating system said.
        reason: String,
    },
    /// The text breaks rules of the format; all of them are listed, the first is the one shown first.
    Invalid(Box<Problem>, Vec<Problem>),
}

/// One broken rule, with the place where it is broken.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Dotted path of the key concerned, as `--set` takes it; empty for the file as a whole.
    pub key: String,
    /// What is wrong: the offending value, the limit and the rule.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
    /// Short text shown under the offending characters.
    pub label: String,
    source: NamedSource<String>,
    span: SourceSpan,
    line: Option<usize>,
}

impl Problem {
    pub(crate) fn new(
        key: String,
        message: String,
        label: String,
        help: Option<String>,
        place: Place,
    ) -> Problem {
        Problem {
            key,
            message,
            help,
            label,
            source: NamedSource::new(place.source_name, place.text),
            span: place.span.into(),
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

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Problem {}

impl Diagnostic for Problem {
    fn severity(&self) -> Option<Severity> {
        Some(Severity::Error)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help
            .as_ref()
            .map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = LabeledSpan::new_primary_with_span(Some(self.label.clone()), self.span);
        Some(Box::new(std::iter::once(label)))
    }
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

    /// One error from what was collected; `None` if nothing was.
    pub(crate) fn from_problems(mut problems: Vec<Problem>) -> Option<ScenarioError> {
        if problems.is_empty() {
            return None;
        }
        let first = problems.remove(0);
        Some(ScenarioError::Invalid(Box::new(first), problems))
    }
}

/// The text of a file that should be `what`.
pub(crate) fn read_text(what: &'static str, path: &Path) -> Result<String, ScenarioError> {
    std::fs::read_to_string(path).map_err(|error| ScenarioError::Unreadable {
        what,
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ScenarioError::Unreadable { what, path, reason } => {
                write!(f, "cannot read {what} {}: {reason}", path.display())
            }
            ScenarioError::Invalid(first, _) => write!(f, "{first}"),
        }
    }
}

impl std::error::Error for ScenarioError {}

impl Diagnostic for ScenarioError {
    fn severity(&self) -> Option<Severity> {
        Some(Severity::Error)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        match self {
            ScenarioError::Unreadable { .. } => None,
            ScenarioError::Invalid(first, _) => first.help(),
        }
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        match self {
            ScenarioError::Unreadable { .. } => None,
            ScenarioError::Invalid(first, _) => first.source_code(),
        }
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        match self {
            ScenarioError::Unreadable { .. } => None,
            ScenarioError::Invalid(first, _) => first.labels(),
        }
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        match self {
            ScenarioError::Unreadable { .. } => None,
            ScenarioError::Invalid(_, rest) if rest.is_empty() => None,
            ScenarioError::Invalid(_, rest) => Some(Box::new(
                rest.iter().map(|problem| problem as &dyn Diagnostic),
            )),
        }
    }
}
