//! What reading files of all formats has in common.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use crate::document::Document;
use crate::error::{Problem, ScenarioError};
use crate::fault::Fault;
use crate::format::Format;
use crate::structure;

/// The tables of a file without overrides, and its document.
pub(crate) fn read<T: DeserializeOwned>(
    format: Format,
    path: &Path,
    text: &str,
    schema: &Arc<Json>,
) -> Result<(T, Document), ScenarioError> {
    let document = Document::parse(path, text, &[], schema)?;
    let tables = document.tables(document.checked(format)?)?;
    Ok((tables, document))
}

/// Most faults that are told at once: each is shown within the text of its file.
const MOST_FAULTS: usize = 100;

impl Document {
    /// What is read, as JSON that fits the schema.
    pub fn checked(&self, format: Format) -> Result<Json, ScenarioError> {
        let faults = structure::check_file(self.schema(), format, self.effective());
        self.refuse(faults)?;
        Ok(structure::to_json(self.effective()))
    }

    /// The table types of JSON that fits the schema.
    pub fn tables<T: DeserializeOwned>(&self, json: Json) -> Result<T, ScenarioError> {
        // What the schema lets pass, the tables read; a difference is reported, not hidden.
        serde_json::from_value(json).map_err(|error| self.problem("", error.to_string()))
    }

    /// An error of the faults that were found; none if there are none.
    pub fn refuse(&self, mut faults: Vec<Fault>) -> Result<(), ScenarioError> {
        if faults.len() > MOST_FAULTS {
            let rest = faults.len() - MOST_FAULTS;
            faults.truncate(MOST_FAULTS);
            let last = &mut faults[MOST_FAULTS - 1];
            last.message += &format!("; {rest} more faults are not shown");
        }
        let located = faults.into_iter().map(|fault| self.locate(fault));
        let mut problems: Vec<Problem> = located.collect();
        // Overrides first, then in the order of the file.
        problems.sort_by_key(Problem::line);
        let mut problems = problems.into_iter();
        match problems.next() {
            None => Ok(()),
            Some(first) => Err(ScenarioError::Invalid(Box::new(first), problems.collect())),
        }
    }

    /// An error about the value of a dotted key.
    pub fn problem(&self, key: &str, message: impl Into<String>) -> ScenarioError {
        let fault = Fault::value(key, message.into(), "here");
        self.locate(fault).into()
    }

    /// The folder of the file, against which its paths are resolved.
    pub fn folder(&self) -> PathBuf {
        self.path()
            .parent()
            .map_or_else(PathBuf::new, Path::to_owned)
    }

    /// Name of the file without folder and extension, or what stands in for it, as a folder can
    /// have it.
    pub fn stem(&self, nameless: &str) -> String {
        truecut_files::folder_name(self.path(), nameless)
    }
}
