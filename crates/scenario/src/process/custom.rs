//! Processes of a user's own crate: their tables are read, checked, overridden and swept like those
//! of this crate.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use super::facts::Facts;
use crate::check::Check;
use crate::fault::Fault;
use crate::schema::schema_of;

type Table = Arc<dyn Any + Send + Sync>;
type Read = dyn Fn(Json) -> Result<Table, String> + Send + Sync;
type CheckTable = dyn Fn(&dyn Any) -> Result<(), BrokenRule> + Send + Sync;
type FactsOf = dyn Fn(&dyn Any) -> Facts + Send + Sync;

/// A process that a scenario may have besides those of this crate: its name, its table, its facts.
///
/// What runs it is opaque here; `truecut_sim` makes definitions that can be run.
#[derive(Clone)]
pub struct Definition {
    name: String,
    pub(crate) schema: Json,
    read: Arc<Read>,
    check: Arc<CheckTable>,
    facts: Arc<FactsOf>,
    runner: Arc<dyn Any + Send + Sync>,
}

/// A rule between the keys of a table that a scenario breaks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BrokenRule {
    /// Dotted key below the table.
    pub key: String,
    /// Value, limit and reason.
    pub message: String,
}

impl Definition {
    /// A process with the table `[process.<name>]` of type `T`. `check` holds what involves several
    /// keys; ranges of single keys stand in the schema of `T`, with their reason in `x-rule`.
    pub fn new<T>(
        name: &str,
        check: fn(&T) -> Result<(), BrokenRule>,
        facts: fn(&T) -> Facts,
        runner: Arc<dyn Any + Send + Sync>,
    ) -> Definition
    where
        T: DeserializeOwned + JsonSchema + Send + Sync + 'static,
    {
        Definition {
            name: name.to_owned(),
            schema: schema_of::<T>(),
            read: Arc::new(|json| {
                let table: T = serde_json::from_value(json).map_err(|error| error.to_string())?;
                Ok(Arc::new(table))
            }),
            check: Arc::new(move |table| check(known(table))),
            facts: Arc::new(move |table| facts(known(table))),
            runner,
        }
    }

    /// The process's name, which is also the name of its table.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// A definition meets tables only that it has read itself.
fn known<T: 'static>(table: &dyn Any) -> &T {
    table.downcast_ref().expect("a table of this definition")
}

impl fmt::Debug for Definition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Definition").field(&self.name).finish()
    }
}

/// A process of a user's own crate with its table.
#[derive(Clone)]
pub struct CustomSpec {
    definition: Arc<Definition>,
    json: Json,
    table: Table,
}

impl CustomSpec {
    /// Reads a table that fits its schema; `None` after recording a fault.
    pub(crate) fn read(
        definition: Arc<Definition>,
        json: Json,
        check: &mut Check,
    ) -> Option<CustomSpec> {
        let path = format!("process.{}", definition.name);
        let table = match (definition.read)(json.clone()) {
            Ok(table) => table,
            Err(error) => {
                check.refuse(Fault::key(&path, error, "here"));
                return None;
            }
        };
        if let Err(rule) = (definition.check)(table.as_ref()) {
            let path = format!("{path}.{}", rule.key);
            check.refuse(Fault::value(&path, rule.message, "here"));
        }
        Some(CustomSpec {
            definition,
            json,
            table,
        })
    }

    /// The process's name, which is also the name of its table.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.definition.name
    }

    /// Its table, if it is of this type.
    #[must_use]
    pub fn table<T: 'static>(&self) -> Option<&T> {
        self.table.downcast_ref()
    }

    /// Its table, for what runs it.
    #[must_use]
    pub fn any(&self) -> &dyn Any {
        self.table.as_ref()
    }

    /// What runs it.
    #[must_use]
    pub fn runner(&self) -> &dyn Any {
        self.definition.runner.as_ref()
    }

    /// What is known of it.
    #[must_use]
    pub fn facts(&self) -> Facts {
        (self.definition.facts)(self.table.as_ref())
    }
}

impl fmt::Debug for CustomSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple(self.name()).field(&self.json).finish()
    }
}

impl PartialEq for CustomSpec {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name() && self.json == other.json
    }
}
