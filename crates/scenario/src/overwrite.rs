//! Writes one value into a document at a key path.

use toml_edit::{Array, Item, Table, TableLike, Value};

use crate::fault::Fault;

/// Sets the value at `path[depth..]` below `table`, making tables on the way.
pub(crate) fn set_in_table(
    table: &mut dyn TableLike,
    path: &[String],
    depth: usize,
    value: Value,
) -> Result<(), Fault> {
    let Some(part) = path.get(depth) else {
        return Ok(());
    };
    if depth + 1 == path.len() {
        let decor = table
            .get(part)
            .and_then(Item::as_value)
            .map(|old| old.decor().clone());
        let mut value = value;
        if let Some(decor) = decor {
            *value.decor_mut() = decor;
        }
        table.insert(part, Item::Value(value));
        return Ok(());
    }
    let item = table.entry(part).or_insert_with(|| {
        let mut made = Table::new();
        made.set_implicit(true);
        Item::Table(made)
    });
    match item {
        Item::ArrayOfTables(tables) => {
            let count = tables.len();
            let table = path[depth + 1]
                .parse()
                .ok()
                .and_then(|index: usize| tables.get_mut(index));
            match table {
                Some(table) if depth + 2 < path.len() => {
                    set_in_table(table, path, depth + 2, value)
                }
                _ => Err(no_such_entry(path, depth + 1, count)),
            }
        }
        Item::Value(Value::Array(array)) => set_in_array(array, path, depth + 1, value),
        other => match other.as_table_like_mut() {
            Some(table) => set_in_table(table, path, depth + 1, value),
            None => Err(not_a_table(path, depth)),
        },
    }
}

fn set_in_array(
    array: &mut Array,
    path: &[String],
    depth: usize,
    value: Value,
) -> Result<(), Fault> {
    let count = array.len();
    let entry = path[depth]
        .parse()
        .ok()
        .and_then(|index: usize| array.get_mut(index));
    let Some(entry) = entry else {
        return Err(no_such_entry(path, depth, count));
    };
    if depth + 1 == path.len() {
        let decor = entry.decor().clone();
        *entry = value;
        *entry.decor_mut() = decor;
        return Ok(());
    }
    match entry {
        Value::InlineTable(table) => set_in_table(table, path, depth + 1, value),
        Value::Array(inner) => set_in_array(inner, path, depth + 1, value),
        _ => Err(not_a_table(path, depth)),
    }
}

fn no_such_entry(path: &[String], depth: usize, count: usize) -> Fault {
    let list = path[..depth].join(".");
    let entry = path.get(depth).map_or("", String::as_str);
    let message = format!("`{list}` has no entry {entry}: it has {count}, counted from 0");
    Fault::key(&path.join("."), message, "no such entry")
}

fn not_a_table(path: &[String], depth: usize) -> Fault {
    let table = path[..=depth].join(".");
    let message = format!("`{table}` is not a table in this scenario");
    Fault::key(&path.join("."), message, "cannot go further")
}
