//! Processes of a user's own crate: their tables are read, checked, overridden and swept like those of this crate.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use super::{Facts, ProcessSpec};
use crate::check::Check;
use crate::document::Fault;
use crate::schema;

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
    schema: Json,
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
    /// A process with the table `[process.<name>]` of type `T`. `check` holds what involves several keys; ranges of single keys
    /// stand in the schema of `T`, with their reason in `x-rule`.
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
            schema: schema::schema_of::<T>(),
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

/// The processes that a scenario may have.
#[derive(Debug, Clone)]
pub struct Processes {
    own: Vec<Arc<Definition>>,
    schema: Arc<Json>,
}

/// Two processes of one name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NameTaken(pub String);

impl fmt::Display for NameTaken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "there is a process `{}` already", self.0)
    }
}

impl std::error::Error for NameTaken {}

impl Processes {
    /// Those of this crate.
    #[must_use]
    pub fn shipped() -> Processes {
        Processes {
            own: Vec::new(),
            schema: schema::schema().clone(),
        }
    }

    /// One more.
    ///
    /// # Errors
    /// A name that another process has.
    pub fn with(mut self, definition: Definition) -> Result<Processes, NameTaken> {
        if self.names().any(|name| name == definition.name) {
            return Err(NameTaken(definition.name));
        }
        let tables = Arc::make_mut(&mut self.schema).pointer_mut("/properties/process/properties");
        if let Some(tables) = tables.and_then(Json::as_object_mut) {
            tables.insert(definition.name.clone(), definition.schema.clone());
        }
        self.own.push(Arc::new(definition));
        Ok(self)
    }

    /// Their names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let own = self.own.iter().map(|one| one.name.as_str());
        ProcessSpec::NAMES.iter().copied().chain(own)
    }

    /// JSON Schema of a scenario with these processes.
    #[must_use]
    pub fn json_schema(&self) -> &Json {
        &self.schema
    }

    pub(crate) fn schema(&self) -> &Arc<Json> {
        &self.schema
    }

    /// Takes the tables of own processes out of a scenario as JSON.
    pub(crate) fn take(&self, scenario: &mut Json) -> Vec<(Arc<Definition>, Json)> {
        let tables = scenario.get_mut("process").and_then(Json::as_object_mut);
        let Some(tables) = tables else {
            return Vec::new();
        };
        (self.own.iter())
            .filter_map(|one| Some((one.clone(), tables.remove(&one.name)?)))
            .collect()
    }
}

impl Default for Processes {
    fn default() -> Self {
        Processes::shipped()
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
