//! Arguments of a robot's xacro file, as a file of ours gives them.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

/// Arguments by their names.
pub(crate) type ArgumentTable = BTreeMap<String, ArgumentValue>;

/// A value as TOML writes it.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(crate) enum ArgumentValue {
    Flag(bool),
    Integer(i64),
    Number(f64),
    Text(String),
}

impl JsonSchema for ArgumentValue {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "ArgumentValue".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        // Of texts an empty one is good, too: no prefix.
        schemars::json_schema!({ "type": ["number", "string", "boolean"], "minLength": 0 })
    }
}

impl ArgumentValue {
    /// As xacro takes it.
    fn into_text(self) -> String {
        match self {
            ArgumentValue::Flag(flag) => flag.to_string(),
            ArgumentValue::Integer(number) => number.to_string(),
            // With its point: xacro counts with whole numbers and with others.
            ArgumentValue::Number(number) => format!("{number:?}"),
            ArgumentValue::Text(text) => text,
        }
    }
}

/// The texts of a table; none without one.
pub(crate) fn texts(table: Option<ArgumentTable>) -> BTreeMap<String, String> {
    let named = table.unwrap_or_default().into_iter();
    named
        .map(|(name, value)| (name, value.into_text()))
        .collect()
}
