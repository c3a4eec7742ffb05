//! Checks a document against the schema of the format: keys, types, ranges.
//!
//! The schema is derived from the table types of this crate, so the published schema, this check
//! and the types that are read cannot disagree. A range may carry its reason in `x-rule`.

use serde_json::Value as Json;
use toml_edit::{Item, Table, TableLike, Value};
use truecut_recording::nearest;

use crate::fault::Fault;
use crate::format::{Format, many_processes};
use crate::schema::{
    choices, is_table, kinds, of_tag, property, property_names, required, without_null,
};
use crate::suggest::same_quantity;

/// Every rule of a format's schema that the table breaks, in the order of the file where it has
/// one.
pub(crate) fn check_file(schema: &Json, format: Format, table: &Table) -> Vec<Fault> {
    let one = format
        .misread(table)
        .or_else(|| many_processes(schema, table));
    match one {
        Some(fault) => vec![fault],
        None => check_against(schema, table),
    }
}

/// Every rule of a schema that the table breaks.
pub(crate) fn check_against(schema: &Json, table: &Table) -> Vec<Fault> {
    let mut faults = Vec::new();
    check_table(schema, table, &mut Vec::new(), &mut faults);
    faults
}

/// The schema of the value at `path` of a file with this schema.
///
/// # Errors
/// An unknown key on the way, or a path that ends at a table.
pub(crate) fn leaf_schema<'a>(schema: &'a Json, path: &[String]) -> Result<&'a Json, Fault> {
    let mut here = schema;
    for (depth, part) in path.iter().enumerate() {
        let here_unwrapped = without_null(here);
        here = if let Some(items) = here_unwrapped.get("items") {
            items
        } else {
            let known = property(here_unwrapped, part);
            known.ok_or_else(|| unknown_key(here_unwrapped, &path[..depth], part))?
        };
    }
    if path.is_empty() || is_table(here) {
        let keys: Vec<&str> = property_names(without_null(here)).collect();
        let name = path.join(".");
        return Err(Fault::key(
            &name,
            format!("`{name}` is a table, not a value"),
            "a table",
        )
        .with_help(format!("set one of its keys: {}", keys.join(", "))));
    }
    Ok(here)
}

/// An unknown key of the table `parent`, with what was most likely meant.
fn unknown_key(schema: &Json, parent: &[String], key: &str) -> Fault {
    let table = table_name(parent);
    let unknown = format!("unknown key `{key}` in {table}");
    let meant = same_quantity(key, property_names(schema));
    let fault = if let [(candidate, unit), ..] = meant[..] {
        let message = format!("{unknown}: the unit key is missing, write `{candidate}`");
        let label = format!("without a known unit; `{candidate}` is in {unit}");
        let help = format!("`{candidate}` takes the value in {unit}");
        Fault::key(key, message, label).with_help(help)
    } else if let Some(candidate) = nearest(key, property_names(schema)) {
        let meant = format!("did you mean `{candidate}`?");
        Fault::key(key, format!("{unknown}; {meant}"), meant)
    } else {
        let known: Vec<&str> = property_names(schema).collect();
        let help = format!("known keys are {}", known.join(", "));
        Fault::key(key, unknown, "unknown key").with_help(help)
    };
    let path = [parent, &[key.to_owned()]].concat();
    Fault { path, ..fault }
}

fn table_name(path: &[String]) -> String {
    if path.is_empty() {
        "the file".into()
    } else {
        format!("[{}]", path.join("."))
    }
}

fn check_table(
    schema: &Json,
    table: &dyn TableLike,
    path: &mut Vec<String>,
    faults: &mut Vec<Fault>,
) {
    let schema = of_tag(schema, table);
    let mut meant: Vec<&str> = Vec::new();
    for (key, item) in table.iter() {
        match property(schema, key) {
            Some(known) => {
                path.push(key.to_owned());
                check_item(known, item, path, faults);
                path.pop();
            }
            None if let Some(instead) = instead(schema, key) => {
                meant.push(instead);
                faults.push(other_key(path, key, instead));
            }
            None => {
                meant.extend(
                    same_quantity(key, property_names(schema))
                        .iter()
                        .map(|one| one.0),
                );
                meant.extend(nearest(key, property_names(schema)));
                faults.push(unknown_key(schema, path, key));
            }
        }
    }
    // A misspelt key is one mistake, not two: what it was meant to be is not reported as missing as
    // well.
    for key in required(schema).filter(|key| !table.contains_key(key) && !meant.contains(key)) {
        path.push(key.to_owned());
        faults.push(missing_key(schema, path, key));
        path.pop();
    }
}

/// The key that the table has in place of one that belongs to its siblings.
fn instead<'a>(schema: &'a Json, key: &str) -> Option<&'a str> {
    schema.get("x-instead")?.get(key)?.as_str()
}

fn other_key(parent: &[String], key: &str, instead: &str) -> Fault {
    let table = parent.join(".");
    let message =
        format!("`{key}` does not belong in [{table}]: what it acts on is given by `{instead}`");
    Fault::key(
        &format!("{table}.{key}"),
        message,
        format!("write `{instead}`"),
    )
}

fn missing_key(schema: &Json, path: &[String], key: &str) -> Fault {
    let table = table_name(&path[..path.len() - 1]);
    let description = property(schema, key)
        .and_then(|known| known.get("description"))
        .and_then(Json::as_str)
        .map(|text| format!("`{key}`: {}", text.replace('\n', " ")));
    let message = format!("missing key `{key}` in {table}");
    let label = format!("`{key}` is missing here");
    Fault {
        help: description,
        ..Fault::key(&path.join("."), message, label)
    }
}

fn check_item(schema: &Json, item: &Item, path: &mut Vec<String>, faults: &mut Vec<Fault>) {
    let schema = without_null(schema);
    match item {
        Item::None => {}
        Item::Table(table) if is_table(schema) => check_table(schema, table, path, faults),
        Item::Table(_) => faults.push(wrong_type(schema, path, "a table")),
        Item::ArrayOfTables(tables) => match schema.get("items") {
            Some(items) if is_table(items) => {
                for (index, table) in tables.iter().enumerate() {
                    path.push(index.to_string());
                    check_table(without_null(items), table, path, faults);
                    path.pop();
                }
            }
            _ => faults.push(wrong_type(schema, path, "a list of tables")),
        },
        Item::Value(value) => check_value(schema, value, path, faults),
    }
}

fn check_value(schema: &Json, value: &Value, path: &mut Vec<String>, faults: &mut Vec<Fault>) {
    let schema = without_null(schema);
    let kinds = kinds(schema);
    match value {
        Value::InlineTable(table) if kinds.contains(&"object") => {
            check_table(schema, table, path, faults);
        }
        Value::Array(array) if kinds.contains(&"array") => {
            if let Some(fault) = wrong_length(schema, array.len(), path) {
                faults.push(fault);
            }
            for (index, entry) in array.iter().enumerate() {
                path.push(index.to_string());
                check_value(
                    schema.get("items").unwrap_or(&Json::Null),
                    entry,
                    path,
                    faults,
                );
                path.pop();
            }
        }
        Value::Float(number) if kinds.contains(&"number") => {
            faults.extend(out_of_range(schema, *number.value(), path));
        }
        Value::Integer(number) if kinds.contains(&"number") || kinds.contains(&"integer") => {
            faults.extend(out_of_range(schema, *number.value() as f64, path));
        }
        Value::Boolean(_) if kinds.contains(&"boolean") => {}
        Value::String(text) if kinds.contains(&"string") || !choices(schema).is_empty() => {
            faults.extend(wrong_word(schema, text.value(), path));
        }
        other => faults.push(wrong_type(schema, path, describe(other).as_str())),
    }
}

fn describe(value: &Value) -> String {
    let text = value.to_string();
    let text = text.trim();
    match value {
        Value::String(_) => format!("the text {text}"),
        Value::Integer(_) => format!("the integer {text}"),
        Value::Float(_) => format!("the number {text}"),
        Value::Boolean(_) => text.to_owned(),
        Value::Datetime(_) => format!("the date {text}"),
        Value::Array(_) => "a list".into(),
        Value::InlineTable(_) => "a table".into(),
    }
}

fn wanted(schema: &Json) -> String {
    let words = choices(schema);
    if !words.is_empty() {
        return format!("one of {}", quoted(&words));
    }
    let kinds: Vec<&str> = kinds(schema)
        .iter()
        .map(|kind| match *kind {
            "number" => "a number",
            "integer" => "a whole number",
            "string" => "a text in quotes",
            "boolean" => "true or false",
            "array" => "a list",
            _ => "a table",
        })
        .collect();
    kinds.join(" or ")
}

fn quoted(words: &[&str]) -> String {
    words
        .iter()
        .map(|word| format!("\"{word}\""))
        .collect::<Vec<_>>()
        .join(", ")
}

fn wrong_type(schema: &Json, path: &[String], found: &str) -> Fault {
    let wanted = wanted(schema);
    let key = path.join(".");
    Fault::value(
        &key,
        format!("`{key}` must be {wanted}, but is {found}"),
        format!("not {wanted}"),
    )
}

fn wrong_word(schema: &Json, text: &str, path: &[String]) -> Option<Fault> {
    let key = path.join(".");
    let words = choices(schema);
    if words.is_empty() {
        let blank = text.trim().is_empty() && schema.get("minLength").is_none();
        return blank.then(|| Fault::value(&key, format!("`{key}` is empty"), "empty text"));
    }
    if words.contains(&text) {
        return None;
    }
    let label = nearest(text, words.iter().copied()).map_or_else(
        || "unknown word".into(),
        |word| format!("did you mean \"{word}\"?"),
    );
    let message = format!(
        "`{key}` is \"{text}\", but must be one of {}",
        quoted(&words)
    );
    Some(Fault::value(&key, message, label))
}

fn wrong_length(schema: &Json, length: usize, path: &[String]) -> Option<Fault> {
    let bound = |name: &str| {
        schema
            .get(name)
            .and_then(Json::as_u64)
            .map(|bound| bound as usize)
    };
    let (min, max) = (
        bound("minItems").unwrap_or(0),
        bound("maxItems").unwrap_or(usize::MAX),
    );
    if (min..=max).contains(&length) {
        return None;
    }
    let key = path.join(".");
    let wanted = match (min, max) {
        (min, max) if min == max => format!("{min} entries"),
        (min, usize::MAX) => format!("at least {min} entries"),
        (min, max) => format!("{min} to {max} entries"),
    };
    let message = format!("`{key}` has {length} entries, but must have {wanted}");
    Some(Fault::value(&key, message, format!("{length} entries")))
}

/// Largest size of a number: products of a few of them are finite.
const LARGEST: f64 = 1e18;

/// Whether a number may stand at `path`, as far as that does not depend on others.
pub(crate) fn may_be(schema: &Json, path: &[String], value: f64) -> bool {
    leaf_schema(schema, path)
        .is_ok_and(|leaf| out_of_range(without_null(leaf), value, path).is_none())
}

/// Least and largest number that may stand at `path`, as far as that does not depend on others.
pub(crate) fn range(schema: &Json, path: &[String]) -> [f64; 2] {
    let leaf = leaf_schema(schema, path).map(without_null);
    let bound = |[open, closed]: [&str; 2]| {
        let leaf = leaf.as_ref().ok()?;
        (leaf.get(open).or_else(|| leaf.get(closed))).and_then(Json::as_f64)
    };
    [
        bound(["exclusiveMinimum", "minimum"]).unwrap_or(-LARGEST),
        bound(["exclusiveMaximum", "maximum"]).unwrap_or(LARGEST),
    ]
}

fn out_of_range(schema: &Json, value: f64, path: &[String]) -> Option<Fault> {
    let key = path.join(".");
    if !value.is_finite() {
        let message = format!("`{key}` is {value}, but must be a finite number");
        return Some(Fault::value(&key, message, "not finite"));
    }
    if value.abs() > LARGEST {
        let message = format!(
            "`{key}` is {value:e}, but must be at most {LARGEST:e} in size: SI stays finite"
        );
        return Some(Fault::value(&key, message, "too large"));
    }
    let bound = |name: &str| schema.get(name).and_then(Json::as_f64);
    let limit = if let Some(limit) = bound("exclusiveMinimum").filter(|limit| value <= *limit) {
        format!("must be greater than {limit}")
    } else if let Some(limit) = bound("minimum").filter(|limit| value < *limit) {
        format!("must be at least {limit}")
    } else if let Some(limit) = bound("exclusiveMaximum").filter(|limit| value >= *limit) {
        format!("must be less than {limit}")
    } else {
        let limit = bound("maximum").filter(|limit| value > *limit)?;
        format!("must be at most {limit}")
    };
    let rule = schema.get("x-rule").and_then(Json::as_str);
    let rule = rule.map(|rule| format!(": {rule}")).unwrap_or_default();
    let message = format!("`{key}` is {value}, but {limit}{rule}");
    Some(Fault::value(&key, message, limit))
}

/// The table as JSON, for reading it into the table types. Numbers are finite after [`check`].
pub(crate) fn to_json(table: &dyn TableLike) -> Json {
    table
        .iter()
        .map(|(key, item)| (key.to_owned(), item_to_json(item)))
        .collect()
}

fn item_to_json(item: &Item) -> Json {
    match item {
        Item::None => Json::Null,
        Item::Value(value) => value_to_json(value),
        Item::Table(table) => to_json(table),
        Item::ArrayOfTables(tables) => tables.iter().map(|table| to_json(table)).collect(),
    }
}

fn value_to_json(value: &Value) -> Json {
    match value {
        Value::String(text) => Json::from(text.value().as_str()),
        Value::Integer(number) => Json::from(*number.value()),
        Value::Float(number) => Json::from(*number.value()),
        Value::Boolean(flag) => Json::from(*flag.value()),
        Value::Datetime(date) => Json::from(date.value().to_string()),
        Value::Array(array) => array.iter().map(value_to_json).collect(),
        Value::InlineTable(table) => to_json(table),
    }
}
