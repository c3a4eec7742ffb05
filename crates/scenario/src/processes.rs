//! The processes that a scenario may have: those of this crate, and those of a user's own.

use std::sync::{Arc, LazyLock};

use serde_json::Value as Json;
use thiserror::Error;

use crate::process::{Definition, ProcessSpec};
use crate::renamed;
use crate::scenario::tables::ScenarioTable;
use crate::schema::schema_of;

/// The processes that a scenario may have.
#[derive(Debug, Clone)]
pub struct Processes {
    own: Vec<Arc<Definition>>,
    schema: Arc<Json>,
}

/// Two processes of one name.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("there is a process `{0}` already")]
pub struct NameTaken(pub String);

impl Processes {
    /// Those of this crate.
    #[must_use]
    pub fn shipped() -> Processes {
        static SCHEMA: LazyLock<Arc<Json>> = LazyLock::new(|| {
            let mut schema = schema_of::<ScenarioTable>();
            renamed::deprecate(&mut schema);
            Arc::new(schema)
        });
        Processes {
            own: Vec::new(),
            schema: SCHEMA.clone(),
        }
    }

    /// One more.
    ///
    /// # Errors
    /// A name that another process has.
    pub fn with(mut self, definition: Definition) -> Result<Processes, NameTaken> {
        if self.names().any(|name| name == definition.name()) {
            return Err(NameTaken(definition.name().to_owned()));
        }
        let tables = Arc::make_mut(&mut self.schema).pointer_mut("/properties/process/properties");
        if let Some(tables) = tables.and_then(Json::as_object_mut) {
            tables.insert(definition.name().to_owned(), definition.schema.clone());
        }
        self.own.push(Arc::new(definition));
        Ok(self)
    }

    /// Their names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let own = self.own.iter().map(|one| one.name());
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
            .filter_map(|one| Some((one.clone(), tables.remove(one.name())?)))
            .collect()
    }
}

impl Default for Processes {
    fn default() -> Self {
        Processes::shipped()
    }
}
