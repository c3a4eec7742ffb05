//! A value of any kind as a file writes it, for what takes texts: overrides, arguments of xacro.

use schemars::JsonSchema;
use serde::Deserialize;

/// A value as TOML writes it.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(crate) enum Written {
    Flag(bool),
    Integer(i64),
    Number(f64),
    Text(String),
}

impl JsonSchema for Written {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Written".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        // Of texts an empty one is good, too: no prefix.
        schemars::json_schema!({ "type": ["number", "string", "boolean"], "minLength": 0 })
    }
}

impl Written {
    /// Its text.
    pub(crate) fn text(&self) -> String {
        match self {
            Written::Flag(flag) => flag.to_string(),
            Written::Integer(number) => number.to_string(),
            // With its point: whole numbers and others are two things.
            Written::Number(number) => format!("{number:?}"),
            Written::Text(text) => text.clone(),
        }
    }
}
