//! Checks a `robot.toml` against the schema of its tables: keys, types, lengths. All faults are
//! told, each at its place, in words that need no knowledge of the program.
//!
//! The schema is derived from the types that are read, so the two cannot disagree.

use serde_json::Value as Json;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::nearest::nearest;

/// A broken rule at a byte offset of the text.
pub(super) struct Broken {
    pub(super) at: usize,
    pub(super) message: String,
}

/// Every rule that the text breaks, in its order; what is no TOML breaks only those of TOML.
pub(super) fn check(text: &str) -> Vec<Broken> {
    let (table, errors) = DeTable::parse_recoverable(text);
    let mut faults: Vec<Broken> = errors.iter().map(syntax).collect();
    if faults.is_empty() {
        let root = Json::from(super::json_schema());
        let rules = Rules { root: &root };
        rules.table("", &table, &root, &mut faults);
    }
    faults.sort_by_key(|fault| fault.at);
    faults
}

fn syntax(error: &toml::de::Error) -> Broken {
    Broken {
        at: error.span().map_or(0, |span| span.start),
        message: error.message().replace('\n', "; "),
    }
}

/// The schema of the whole file.
struct Rules<'a> {
    root: &'a Json,
}

impl<'a> Rules<'a> {
    /// The rule itself, where it is one of several or stands elsewhere.
    fn resolved(&self, rule: &'a Json) -> &'a Json {
        if let Some(name) = rule.get("$ref").and_then(Json::as_str) {
            let name = name.rsplit('/').next().unwrap_or(name);
            let found = self.root.get("$defs").and_then(|all| all.get(name));
            return found.map_or(rule, |found| self.resolved(found));
        }
        let choices = rule.get("anyOf").and_then(Json::as_array);
        let is_null = |rule: &&Json| rule.get("type").and_then(Json::as_str) == Some("null");
        let chosen = choices.and_then(|all| all.iter().find(|rule| !is_null(rule)));
        chosen.map_or(rule, |chosen| self.resolved(chosen))
    }

    /// A table called `owner` in messages, empty for the file.
    fn table(
        &self,
        owner: &str,
        table: &Spanned<DeTable>,
        rule: &'a Json,
        faults: &mut Vec<Broken>,
    ) {
        let rule = self.resolved(rule);
        let properties = rule.get("properties").and_then(Json::as_object);
        let names = || properties.into_iter().flat_map(|all| all.keys());
        let mut meant = Vec::new();
        for (key, value) in table.get_ref() {
            let own = key.get_ref().as_ref();
            if let Some(rule) = properties.and_then(|all| all.get(own)) {
                self.value(&joined(owner, own), value, rule, faults);
                continue;
            }
            let near = nearest(own, names().map(String::as_str));
            meant.extend(near);
            let known: Vec<&str> = names().map(String::as_str).collect();
            let advice = near.map_or_else(
                || format!("known keys are {}", known.join(", ")),
                |near| format!("did you mean `{near}`?"),
            );
            faults.push(Broken {
                at: key.span().start,
                message: format!("unknown key `{own}` in {}; {advice}", place(owner)),
            });
        }
        let required = rule.get("required").and_then(Json::as_array);
        for key in required.into_iter().flatten().filter_map(Json::as_str) {
            // A misspelt key is one mistake, not two.
            if table.get_ref().contains_key(key) || meant.contains(&key) {
                continue;
            }
            let about = properties.and_then(|all| all.get(key)?.get("description")?.as_str());
            let about = about.map_or_else(String::new, |text| format!(": {text}"));
            faults.push(Broken {
                at: table.span().start,
                message: format!("missing key `{key}` in {}{about}", place(owner)),
            });
        }
    }

    fn value(
        &self,
        name: &str,
        value: &Spanned<DeValue>,
        rule: &'a Json,
        faults: &mut Vec<Broken>,
    ) {
        let rule = self.resolved(rule);
        let is = |kind: &str| match rule.get("type") {
            Some(Json::String(own)) => own == kind,
            Some(Json::Array(all)) => all.iter().any(|own| own == kind),
            _ => false,
        };
        match value.get_ref() {
            DeValue::Table(table) if is("object") => {
                let table = Spanned::new(value.span(), table.clone());
                self.table(name, &table, rule, faults);
            }
            DeValue::Array(entries) if is("array") => {
                let count = |key: &str| rule.get(key).and_then(Json::as_u64);
                if let Some(needed) = count("minItems").filter(|n| *n != entries.len() as u64) {
                    faults.push(Broken {
                        at: value.span().start,
                        message: format!(
                            "`{name}` has {} entries; it must have {needed}",
                            entries.len()
                        ),
                    });
                }
                let Some(items) = rule.get("items") else {
                    return;
                };
                for (index, entry) in entries.iter().enumerate() {
                    let name = entry_name(name, index, entry);
                    self.value(&name, entry, items, faults);
                }
            }
            DeValue::Integer(_) | DeValue::Float(_) if is("number") => {}
            DeValue::String(_) if is("string") => {}
            other => faults.push(Broken {
                at: value.span().start,
                message: format!(
                    "`{name}` is {}; it must be {}",
                    described(other),
                    wanted(rule)
                ),
            }),
        }
    }
}

/// An entry of a list: by its name where it has one.
fn entry_name(list: &str, index: usize, entry: &Spanned<DeValue>) -> String {
    match entry.get_ref() {
        DeValue::Table(table) => match table.get("name").and_then(|name| name.get_ref().as_str()) {
            Some(name) => format!("{list} \"{name}\""),
            None => format!("{list} {}", index + 1),
        },
        _ => list.to_owned(),
    }
}

fn joined(owner: &str, key: &str) -> String {
    match owner {
        "" => key.to_owned(),
        owner => format!("{owner}.{key}"),
    }
}

fn place(owner: &str) -> String {
    match owner {
        "" => "the file".to_owned(),
        owner => format!("[{owner}]"),
    }
}

fn described(value: &DeValue) -> String {
    match value {
        DeValue::String(text) => format!("the text \"{text}\""),
        DeValue::Integer(number) => format!("the number {number}"),
        DeValue::Float(number) => format!("the number {number}"),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

fn wanted(rule: &Json) -> &'static str {
    let kind = match rule.get("type") {
        Some(Json::Array(all)) => all.iter().find(|own| *own != "null"),
        own => own,
    };
    match kind.and_then(Json::as_str) {
        Some("number") => "a number",
        Some("string") => "a text in quotes",
        Some("array") => "a list",
        _ => "a table",
    }
}
