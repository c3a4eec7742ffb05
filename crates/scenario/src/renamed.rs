//! Keys, channels and scalars that had another name before. A file that uses it is read as if it
//! used the present one, and a note says so.

use serde_json::{Map, Value as Json};
use toml_edit::visit_mut::{VisitMut, visit_item_mut};
use toml_edit::{Formatted, Item, KeyMut, Table, TableLike};

/// A name of before, and the name that it has now. A key is its whole path.
pub(crate) type Renamed = (&'static str, &'static str);

const RENAMED: [Renamed; 7] = [
    (
        "process.polish.control.penetration_mm",
        "process.polish.control.indentation_mm",
    ),
    (
        "process.belt.control.penetration_mm",
        "process.belt.control.indentation_mm",
    ),
    ("process.wheel.runout_um", "process.wheel.eccentricity_um"),
    ("wheel.penetration", "wheel.indentation"),
    ("polish.penetration", "polish.indentation"),
    ("belt.penetration", "belt.indentation"),
    ("belt.largest_penetration", "belt.largest_indentation"),
];

/// Keys whose text names a key, a channel or a scalar.
const NAMING: [&str; 4] = ["key", "channel", "channels", "scalar"];

/// What the name `before` became.
pub(crate) fn of(before: &str) -> Option<Renamed> {
    RENAMED.into_iter().find(|one| one.0 == before)
}

/// What a user is told.
pub(crate) fn note((before, now): Renamed) -> String {
    format!("`{before}` is called `{now}` now")
}

/// Writes the present names into a file, and says which names of before it had. A key stays where
/// its table has the present one as well.
pub(crate) fn rename(file: &mut Table) -> Vec<Renamed> {
    let mut texts = Texts::default();
    texts.visit_table_mut(file);
    let keys = RENAMED
        .into_iter()
        .filter(|one| rename_key(file, *one).is_some());
    texts.met.into_iter().chain(keys).collect()
}

fn rename_key(file: &mut Table, renamed: Renamed) -> Option<()> {
    let (parents, before, now) = parts(renamed)?;
    let table = parents
        .split('.')
        .try_fold(file as &mut dyn TableLike, |table, part| {
            table.get_mut(part)?.as_table_like_mut()
        })?;
    if table.contains_key(now) {
        return None;
    }
    let decor = table.key(before)?.leaf_decor().clone();
    let value = table.remove(before)?;
    table.insert(now, value);
    *table.key_mut(now)?.leaf_decor_mut() = decor;
    Some(())
}

/// Renames in texts.
#[derive(Default)]
struct Texts {
    /// Whether the text that is visited names something.
    is_name: bool,
    met: Vec<Renamed>,
}

impl VisitMut for Texts {
    fn visit_table_like_kv_mut(&mut self, key: KeyMut<'_>, item: &mut Item) {
        let is_name = std::mem::replace(&mut self.is_name, NAMING.contains(&key.get()));
        visit_item_mut(self, item);
        self.is_name = is_name;
    }

    fn visit_string_mut(&mut self, text: &mut Formatted<String>) {
        let renamed = of(text.value()).filter(|_| self.is_name);
        if let Some((_, now)) = renamed {
            let decor = text.decor().clone();
            *text = Formatted::new(now.to_owned());
            *text.decor_mut() = decor;
        }
        self.met.extend(renamed);
    }
}

/// Lets the schema of a scenario take keys of before, for editors.
pub(crate) fn deprecate(schema: &mut Json) {
    for one in RENAMED {
        deprecate_key(schema, one);
    }
}

fn deprecate_key(schema: &mut Json, renamed: Renamed) -> Option<()> {
    let (parents, before, now) = parts(renamed)?;
    let table = parents
        .split('.')
        .try_fold(schema, |table, part| keys(table)?.get_mut(part))?;
    let keys = keys(table)?;
    let mut key = keys.get(now)?.clone();
    let facts = key.as_object_mut()?;
    facts.insert(
        "description".into(),
        format!("Earlier name of `{now}`.").into(),
    );
    facts.insert("deprecated".into(), true.into());
    keys.insert(before.to_owned(), key);
    Some(())
}

/// The keys of a table that may be optional.
fn keys(table: &mut Json) -> Option<&mut Map<String, Json>> {
    let table = if table.get("anyOf").is_some() {
        table.pointer_mut("/anyOf/0")?
    } else {
        table
    };
    table.get_mut("properties")?.as_object_mut()
}

/// The table of a key, its last part before and its last part now; `None` of a channel.
fn parts((before, now): Renamed) -> Option<(&'static str, &'static str, &'static str)> {
    before.starts_with("process.").then_some(())?;
    let (parents, before) = before.rsplit_once('.')?;
    Some((parents, before, now.rsplit_once('.')?.1))
}
