//! The text of a scenario with its overrides, and the way back from a key path to a place in the
//! text.
//!
//! Two parses are kept. The text as written knows where everything stands; the effective document
//! has the overrides applied and is what is read. An error names a key path, and the path is looked
//! up in the overrides first and in the text as written second, so line numbers are always those of
//! the file.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value as Json;
use toml_edit::{DocumentMut, InlineTable, Item, Key, Table, Value};

use crate::error::{Place, Problem, ScenarioError};
use crate::fault::{At, Fault, split_path};
use crate::format::taken_by;
use crate::overwrite::set_in_table;
use crate::renamed::{self, Renamed};
use crate::schema::is_text;
use crate::structure::leaf_schema;

/// A parsed scenario text with overrides.
#[derive(Debug, Clone)]
pub(crate) struct Document {
    path: PathBuf,
    written: Arc<toml_edit::Document<String>>,
    effective: DocumentMut,
    overrides: Vec<Override>,
    /// Names of before that the text and the overrides have.
    renamed: Vec<Renamed>,
    /// What the file may hold.
    schema: Arc<Json>,
}

/// One `--set key=value`.
#[derive(Debug, Clone)]
struct Override {
    path: Vec<String>,
    key: String,
    value: String,
}

/// What is wrong with a text that [`truecut_files::too_deep`] refuses.
pub(crate) fn nested() -> String {
    let most = truecut_files::MOST_NESTED;
    format!("not read as TOML: arrays and inline tables nest more than {most} deep")
}

impl Document {
    /// Parses `text` and applies `overrides` in order; `schema` says what the file may hold.
    pub fn parse(
        path: &Path,
        text: &str,
        overrides: &[(String, String)],
        schema: &Arc<Json>,
    ) -> Result<Document, ScenarioError> {
        let syntax = |error: toml_edit::TomlError| {
            let span = error.span().unwrap_or(0..0);
            let message = format!("not valid TOML: {}", error.message().trim());
            let fault = Fault::value("", message, "here");
            let fault = match taken_by(path) {
                Some(command) => fault.with_help(command),
                None => fault,
            };
            Problem::new(fault, place_in_file(path, text, span))
        };
        if let Some(at) = truecut_files::too_deep(text) {
            let fault = Fault::value("", nested(), "one more");
            return Err(Problem::new(fault, place_in_file(path, text, at..at + 1)).into());
        }
        let written = toml_edit::Document::parse(text.to_owned()).map_err(syntax)?;
        let mut effective = text.parse::<DocumentMut>().map_err(syntax)?;
        let renamed = renamed::rename(effective.as_table_mut());
        let mut document = Document {
            path: path.to_owned(),
            written: Arc::new(written),
            effective,
            overrides: Vec::new(),
            renamed,
            schema: schema.clone(),
        };
        document.override_with(overrides)?;
        Ok(document)
    }

    /// Applies further overrides, in order.
    pub fn override_with(&mut self, overrides: &[(String, String)]) -> Result<(), ScenarioError> {
        (overrides.iter()).try_for_each(|(key, value)| self.apply(key.trim(), value.trim()))
    }

    /// Applies further overrides whose values are numbers, each in its key's own unit.
    pub fn set_number(&mut self, key: &str, value: f64) -> Result<(), ScenarioError> {
        self.set(key, format!("{value:?}"), |_| Value::from(value))
    }

    /// JSON Schema of what the file may hold.
    pub fn schema(&self) -> &Arc<Json> {
        &self.schema
    }

    /// The file as it was named.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The text as written, without overrides.
    pub fn text(&self) -> &str {
        self.written.raw()
    }

    /// The text with the overrides applied; it is a scenario of its own.
    pub fn effective_text(&self) -> String {
        self.effective.to_string()
    }

    /// The document with the overrides applied, to be written on.
    pub fn effective_document(&self) -> &DocumentMut {
        &self.effective
    }

    /// What is read: the document with the overrides applied.
    pub fn effective(&self) -> &Table {
        self.effective.as_table()
    }

    /// The overrides, as given.
    pub fn overrides(&self) -> Vec<(String, String)> {
        self.overrides
            .iter()
            .map(|one| (one.key.clone(), one.value.clone()))
            .collect()
    }

    /// Names of before that the text and the overrides have, each with its present one.
    pub fn notes(&self) -> Vec<String> {
        let unique: BTreeSet<Renamed> = self.renamed.iter().copied().collect();
        unique.into_iter().map(renamed::note).collect()
    }

    /// Whether the effective document has something at the dotted `path`.
    pub fn has(&self, path: &str) -> bool {
        self.node(path).is_some()
    }

    /// The number at the dotted `path` of the effective document.
    pub fn number(&self, path: &str) -> Option<f64> {
        let value = match self.node(path)? {
            Node::Item(item) => item.as_value()?,
            Node::Value(value) => value,
            Node::Table(_) | Node::Inline(_) => return None,
        };
        (value.as_float()).or_else(|| value.as_integer().map(|number| number as f64))
    }

    fn node(&self, path: &str) -> Option<Node<'_>> {
        let table = Node::Table(self.effective.as_table());
        (split_path(path).iter())
            .try_fold(table, |node, part| node.child(part).map(|(_, child)| child))
    }

    /// Gives a fault its place in the file or in the override that caused it.
    pub fn locate(&self, fault: Fault) -> Problem {
        let place = self.place(&fault.path, fault.at);
        let message = match (place.line, self.partly_set(&fault.path)) {
            (None, _) => format!("{} (given by --set)", fault.message),
            (Some(_), Some(Override { key, value, .. })) => {
                format!("{} (partly given by --set {key}={value})", fault.message)
            }
            (Some(_), None) => fault.message,
        };
        let renamed = self.renamed_at(&fault.path);
        let help = fault.help.or_else(|| renamed.map(renamed::note));
        let told = Fault {
            message,
            help,
            ..fault
        };
        Problem::new(told, place)
    }

    /// The name of before of the key at `path`.
    fn renamed_at(&self, path: &[String]) -> Option<Renamed> {
        let path = path.join(".");
        self.renamed.iter().copied().find(|one| one.1 == path)
    }

    /// The last override of an entry of the list at `path`.
    fn partly_set(&self, path: &[String]) -> Option<&Override> {
        let entry = |one: &&Override| {
            one.path.len() == path.len() + 1
                && one.path.starts_with(path)
                && one.path[path.len()].parse::<usize>().is_ok()
        };
        self.overrides.iter().rev().find(entry)
    }

    fn place(&self, path: &[String], at: At) -> Place {
        // The last override that set this very value, or a value that holds it.
        if let Some(set) = self
            .overrides
            .iter()
            .rev()
            .find(|one| path.starts_with(&one.path))
        {
            return set.place(&self.path, at);
        }
        // A key that is missing from a table which exists only because an override made it.
        let created = |one: &&Override| !path.is_empty() && one.path.starts_with(path);
        let before = self.renamed_at(path).map(|(before, _)| split_path(before));
        let written = self.written_span(path, at);
        let written = written.or_else(|| self.written_span(&before?, at));
        match (written, self.overrides.iter().rev().find(created)) {
            (None, Some(set)) => set.place(&self.path, At::Key),
            (None, None) => self.in_file(self.enclosing_span(path)),
            (Some(span), _) => self.in_file(span),
        }
    }

    fn in_file(&self, span: std::ops::Range<usize>) -> Place {
        place_in_file(&self.path, self.text(), span)
    }

    fn written_span(&self, path: &[String], at: At) -> Option<std::ops::Range<usize>> {
        let mut node = Node::Table(self.written.as_table());
        let mut key_span = None;
        for part in path {
            let (key, child) = node.child(part)?;
            key_span = key.and_then(Key::span);
            node = child;
        }
        match at {
            At::Key => key_span.or_else(|| node.span()),
            At::Value => node.span().or(key_span),
        }
    }

    /// The header of the innermost table on the way to `path` that stands in the file.
    fn enclosing_span(&self, path: &[String]) -> std::ops::Range<usize> {
        (0..path.len())
            .rev()
            .filter(|depth| *depth > 0)
            .find_map(|depth| self.written_span(&path[..depth], At::Value))
            .unwrap_or_else(|| 0..self.text().lines().next().map_or(0, str::len))
    }

    fn apply(&mut self, key: &str, value: &str) -> Result<(), ScenarioError> {
        self.set(key, value.to_owned(), |leaf| match value.parse::<Value>() {
            Ok(Value::String(text)) => Value::String(text),
            // `--set name=5` means the text "5"; a number is wanted everywhere else.
            Ok(_) | Err(_) if is_text(leaf) => Value::from(value),
            Ok(parsed) => parsed,
            Err(_) => Value::from(value),
        })
    }

    /// Sets a key to the value that is made for its schema; `written` is how a report quotes it.
    fn set(
        &mut self,
        key: &str,
        written: String,
        value: impl FnOnce(&Json) -> Value,
    ) -> Result<(), ScenarioError> {
        let renamed = renamed::of(key);
        let one = Override {
            path: split_path(renamed.map_or(key, |(_, now)| now)),
            key: key.to_owned(),
            value: written,
        };
        let fail = |fault: Fault| {
            let place = one.place(&self.path, fault.at);
            let message = format!("{} (given by --set)", fault.message);
            let path = one.path.clone();
            Problem::new(
                Fault {
                    path,
                    message,
                    ..fault
                },
                place,
            )
        };
        let leaf = leaf_schema(&self.schema, &one.path).map_err(fail)?;
        let value = value(leaf);
        set_in_table(self.effective.as_table_mut(), &one.path, 0, value).map_err(fail)?;
        self.overrides.push(one);
        self.renamed.extend(renamed);
        Ok(())
    }
}

impl Override {
    fn place(&self, scenario: &Path, at: At) -> Place {
        let text = format!("{}={}", self.key, self.value);
        let span = match at {
            At::Key => 0..self.key.len(),
            At::Value => self.key.len() + 1..text.len(),
        };
        Place {
            source_name: format!("--set for {}", scenario.display()),
            text,
            span,
            line: None,
        }
    }
}

/// The span in `text`, cut at the end of its first line so that reports stay short.
fn place_in_file(path: &Path, text: &str, span: std::ops::Range<usize>) -> Place {
    let start = span.start.min(text.len());
    let end = span.end.clamp(start, text.len());
    let first_line = text[start..end]
        .find('\n')
        .map_or(end, |offset| start + offset);
    Place {
        source_name: path.display().to_string(),
        text: text.to_owned(),
        span: start..first_line,
        line: Some(1 + text[..start].matches('\n').count()),
    }
}

/// Anything that can be walked into.
#[derive(Clone, Copy)]
enum Node<'a> {
    Table(&'a Table),
    Inline(&'a InlineTable),
    Item(&'a Item),
    Value(&'a Value),
}

impl<'a> Node<'a> {
    fn child(self, part: &str) -> Option<(Option<&'a Key>, Node<'a>)> {
        match self {
            Node::Table(table) => table
                .get_key_value(part)
                .map(|(key, item)| (Some(key), Node::Item(item))),
            Node::Inline(table) => table
                .get_key_value(part)
                .map(|(key, item)| (Some(key), Node::Item(item))),
            Node::Item(Item::Table(table)) => Node::Table(table).child(part),
            Node::Item(Item::ArrayOfTables(tables)) => tables
                .get(part.parse().ok()?)
                .map(|table| (None, Node::Table(table))),
            Node::Item(Item::Value(value)) => Node::Value(value).child(part),
            Node::Item(Item::None) => None,
            Node::Value(Value::Array(array)) => array
                .get(part.parse().ok()?)
                .map(|value| (None, Node::Value(value))),
            Node::Value(Value::InlineTable(table)) => Node::Inline(table).child(part),
            Node::Value(_) => None,
        }
    }

    fn span(self) -> Option<std::ops::Range<usize>> {
        match self {
            Node::Table(table) => table.span(),
            Node::Inline(table) => table.span(),
            Node::Item(item) => item.span(),
            Node::Value(value) => value.span(),
        }
    }
}
