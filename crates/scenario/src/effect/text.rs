//! Effects written into the text of a scenario.

use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, TableLike, Value};

use super::{Effect, ParameterInfo, Target};

/// Writes `effects` into the document: an entry of the same kind and target takes the new values
/// where they differ, others are appended. `rotary` says of each joint whether it is rotary.
pub(crate) fn write(document: &mut DocumentMut, effects: &[Effect], rotary: &[bool]) {
    let entry = document
        .as_table_mut()
        .entry("effect")
        .or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()));
    for effect in effects {
        let rotary = match effect.target {
            Target::Joint(joint) => rotary.get(joint).copied().unwrap_or(false),
            _ => false,
        };
        match entry {
            Item::ArrayOfTables(tables) => write_table(tables, effect, rotary),
            Item::Value(Value::Array(array)) => write_inline(array, effect, rotary),
            _ => {}
        }
    }
    if entry
        .as_array_of_tables()
        .is_some_and(ArrayOfTables::is_empty)
    {
        document.as_table_mut().remove("effect");
    }
}

fn write_table(tables: &mut ArrayOfTables, effect: &Effect, rotary: bool) {
    if let Some(known) = tables.iter_mut().find(|table| is_of(*table, effect)) {
        set_values(known, effect, rotary);
        return;
    }
    let mut table = Table::new();
    fill(&mut table, effect, rotary);
    tables.push(table);
}

fn write_inline(array: &mut Array, effect: &Effect, rotary: bool) {
    for entry in array.iter_mut() {
        if let Value::InlineTable(known) = entry
            && is_of(known, effect)
        {
            set_values(known, effect, rotary);
            return;
        }
    }
    let mut table = InlineTable::new();
    fill(&mut table, effect, rotary);
    array.push(table);
}

/// Whether the entry has the kind and the target of the effect.
fn is_of(table: &dyn TableLike, effect: &Effect) -> bool {
    let text = |key: &str| table.get(key).and_then(Item::as_str);
    text("kind") == Some(effect.kind.name())
        && match &effect.target {
            Target::Whole => true,
            Target::Joint(joint) => {
                table.get("joint").and_then(Item::as_integer) == i64::try_from(joint + 1).ok()
            }
            Target::Axis(axis) => text("axis") == Some(axis_name(*axis)),
            Target::Channel(channel) => text("channel") == Some(channel),
        }
}

fn axis_name(axis: usize) -> &'static str {
    ["x", "y", "z"].get(axis).copied().unwrap_or("z")
}

fn fill(table: &mut dyn TableLike, effect: &Effect, rotary: bool) {
    table.insert("kind", toml_edit::value(effect.kind.name()));
    match &effect.target {
        Target::Whole => {}
        Target::Joint(joint) => {
            let number = i64::try_from(joint + 1).unwrap_or(i64::MAX);
            table.insert("joint", toml_edit::value(number));
        }
        Target::Axis(axis) => {
            table.insert("axis", toml_edit::value(axis_name(*axis)));
        }
        Target::Channel(channel) => {
            table.insert("channel", toml_edit::value(channel.as_str()));
        }
    }
    set_values(table, effect, rotary);
}

fn set_values(table: &mut dyn TableLike, effect: &Effect, rotary: bool) {
    let known = effect.kind.parameters();
    let uses = |key: fn(&ParameterInfo) -> &'static str| {
        (known.iter().filter(|info| info.depends_on_joint()))
            .any(|info| table.contains_key(key(info)))
    };
    let rotary = uses(|info| info.rotary_key) || (rotary && !uses(|info| info.key));
    let scalars = known.len() - usize::from(effect.kind.is_curve());
    for (info, value) in known.iter().take(scalars).zip(&effect.values) {
        let key = if rotary { info.rotary_key } else { info.key };
        let old = table.get(key).and_then(Item::as_value);
        let same = |old: &Value| {
            old.as_float() == Some(*value) || old.as_integer().map(|n| n as f64) == Some(*value)
        };
        if old.is_some_and(same) {
            continue;
        }
        let mut new = number(*value);
        if let Some(old) = old {
            *new.decor_mut() = old.decor().clone();
        }
        table.insert(key, Item::Value(new));
    }
    if let Some(info) = known.get(scalars) {
        let key = if rotary { info.rotary_key } else { info.key };
        let list: Array = effect.values[scalars..]
            .iter()
            .map(|v| number(*v))
            .collect();
        table.insert(key, Item::Value(Value::Array(list)));
    }
}

/// The shortest text that reads back as exactly this number.
fn number(value: f64) -> Value {
    format!("{value:?}")
        .parse()
        .unwrap_or_else(|_| Value::from(value))
}
