//! The JSON Schema of a format, and finding one's way in it.

use serde_json::Value as Json;
use toml_edit::{Item, TableLike};

/// JSON Schema of a file whose tables are of type `T`, without references.
pub(crate) fn schema_of<T: schemars::JsonSchema>() -> Json {
    let settings = schemars::generate::SchemaSettings::default()
        .with(|settings| settings.inline_subschemas = true);
    settings
        .into_generator()
        .into_root_schema_for::<T>()
        .to_value()
}

/// Whether the schema wants a number.
pub(crate) fn is_number(schema: &Json) -> bool {
    let kinds = kinds(without_null(schema));
    kinds.contains(&"number") || kinds.contains(&"integer")
}

/// Whether the schema wants a text.
pub(crate) fn is_text(schema: &Json) -> bool {
    let schema = without_null(schema);
    kinds(schema) == ["string"] || !choices(schema).is_empty()
}

/// Whether the schema wants a table.
pub(crate) fn is_table(schema: &Json) -> bool {
    kinds(without_null(schema)).contains(&"object")
}

/// The schema of an optional value without its `null` alternative.
pub(crate) fn without_null(schema: &Json) -> &Json {
    let is_null = |one: &Json| one.get("type").and_then(Json::as_str) == Some("null");
    schema
        .get("anyOf")
        .and_then(Json::as_array)
        .and_then(|alternatives| alternatives.iter().find(|one| !is_null(one)))
        .unwrap_or(schema)
}

/// The schema of a table whose keys depend on the value of one of them (named by `x-tag`): that of
/// the table's own value, or the general one if the value is not known.
pub(crate) fn of_tag<'a>(schema: &'a Json, table: &dyn TableLike) -> &'a Json {
    let variant = || {
        let tag = schema.get("x-tag")?.as_str()?;
        let value = table.get(tag).and_then(Item::as_str)?;
        let is_meant = |one: &&Json| {
            let constant = one.pointer(&format!("/properties/{tag}/const"));
            constant.and_then(Json::as_str) == Some(value)
        };
        schema.get("oneOf")?.as_array()?.iter().find(is_meant)
    };
    variant().unwrap_or(schema)
}

/// The JSON types that the value may have, apart from `null`.
pub(crate) fn kinds(schema: &Json) -> Vec<&str> {
    match schema.get("type") {
        Some(Json::String(kind)) => vec![kind],
        Some(Json::Array(list)) => list
            .iter()
            .filter_map(Json::as_str)
            .filter(|kind| *kind != "null")
            .collect(),
        _ => Vec::new(),
    }
}

/// The words a text may be; empty if any text is good.
pub(crate) fn choices(schema: &Json) -> Vec<&str> {
    let of_enum = schema
        .get("enum")
        .and_then(Json::as_array)
        .into_iter()
        .flatten();
    let of_one = schema
        .get("oneOf")
        .and_then(Json::as_array)
        .into_iter()
        .flatten();
    let named = of_one.flat_map(|one| {
        let constant = one.get("const").into_iter();
        constant.chain(
            one.get("enum")
                .and_then(Json::as_array)
                .into_iter()
                .flatten(),
        )
    });
    of_enum.chain(named).filter_map(Json::as_str).collect()
}

/// The schema of a key of a table.
pub(crate) fn property<'a>(schema: &'a Json, key: &str) -> Option<&'a Json> {
    let named = schema
        .get("properties")
        .and_then(|properties| properties.get(key))
        .filter(|key| !is_deprecated(key));
    named.or_else(|| {
        schema
            .get("additionalProperties")
            .filter(|other| other.is_object())
    })
}

/// The keys of a table.
pub(crate) fn property_names(schema: &Json) -> impl Iterator<Item = &str> {
    let properties = schema.get("properties").and_then(Json::as_object);
    let present = (properties.into_iter().flatten()).filter(|(_, key)| !is_deprecated(key));
    present.map(|(name, _)| name.as_str())
}

/// Whether a key is there for editors only: a file that has it is read with the present one.
fn is_deprecated(key: &Json) -> bool {
    key.get("deprecated").is_some()
}

/// The keys that a table must have.
pub(crate) fn required(schema: &Json) -> impl Iterator<Item = &str> {
    let list = schema.get("required").and_then(Json::as_array);
    list.into_iter().flatten().filter_map(Json::as_str)
}
