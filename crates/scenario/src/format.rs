//! The formats of files that this crate reads. A file of another format gets one error, not one for
//! each of its keys.

use std::path::Path;

use serde_json::Value as Json;
use strum::VariantArray;
use toml_edit::Table;

use crate::fault::Fault;
use crate::process::not_one;
use crate::schema::{property, property_names, without_null};

/// A format, told by a table that no other has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, VariantArray)]
pub(crate) enum Format {
    Scenario,
    PathJob,
    Identification,
    Cell,
    Robot,
}

impl Format {
    fn tables(self) -> &'static [&'static str] {
        match self {
            Format::Scenario => &["process"],
            Format::PathJob => &["surface", "wheel", "path", "program"],
            Format::Identification => &["stiffness", "modes"],
            Format::Cell => &["fixture", "carried", "part"],
            Format::Robot => &["joint", "link", "frames", "masses"],
        }
    }

    fn name(self) -> &'static str {
        match self {
            Format::Scenario => "a scenario",
            Format::PathJob => "a path job",
            Format::Identification => "an identification",
            Format::Cell => "a cell",
            Format::Robot => "a robot's file",
        }
    }

    /// The command that takes such files.
    fn command(self) -> &'static str {
        match self {
            Format::Scenario => "truecut run",
            Format::PathJob => "truecut path",
            Format::Identification => "truecut identify",
            Format::Cell => "truecut program --cell",
            Format::Robot => "truecut robot --config",
        }
    }

    /// The fault of a file that has none of this format's tables, but one of another's.
    pub fn misread(self, table: &Table) -> Option<Fault> {
        let has = |key: &&&str| table.contains_key(key);
        if self.tables().iter().any(|key| has(&key)) {
            return None;
        }
        let others = Format::VARIANTS.iter().filter(|other| **other != self);
        let mut found = others.filter_map(|other| Some((other, other.tables().iter().find(has)?)));
        let (other, key) = found.next()?;
        let message = format!(
            "this is {}, since it has [{key}], but {} is asked for",
            other.name(),
            self.name()
        );
        let fault = Fault::key(key, message, format!("of {}", other.name()));
        Some(fault.with_help(format!("`{}` takes {}", other.command(), other.name())))
    }
}

/// What takes a file of this ending, where it is none of the formats above.
pub(crate) fn taken_by(path: &Path) -> Option<&'static str> {
    let ending = path.extension()?.to_str()?.to_lowercase();
    Some(match ending.as_str() {
        "urdf" | "xacro" => "`truecut robot` takes an arm; a scenario names it: [robot] urdf = …",
        "nc" | "ngc" | "gcode" | "mpf" | "apt" | "cls" => {
            "`truecut path --robot …` takes a path from CAM"
        }
        "jbi" | "mod" | "src" | "script" | "ls" => "`truecut program` takes a robot program",
        "csv" | "txt" | "parquet" | "arrow" | "mcap" => "`truecut data` takes measured data",
        "stl" | "obj" | "ply" => "`truecut part` takes a mesh",
        _ => return None,
    })
}

/// More than one process is one fault: what is missing in each of them is not what is wrong.
pub(crate) fn many_processes(schema: &Json, table: &Table) -> Option<Fault> {
    let processes = table.get("process")?.as_table_like()?;
    let names: Vec<&str> = property_names(without_null(property(schema, "process")?)).collect();
    let given = processes.iter().map(|(name, _)| name);
    let given: Vec<&str> = given.filter(|name| names.contains(name)).collect();
    (given.len() > 1).then(|| not_one(&given, &names))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_another_format_is_told_by_its_table_and_its_own_never() {
        let misread = |format: Format, text: &str| {
            let document: toml_edit::DocumentMut = text.parse().expect("a document");
            format
                .misread(document.as_table())
                .map(|fault| fault.message)
        };
        let scenario = "name = \"a\"\n[process.load]\n";
        assert_eq!(misread(Format::Scenario, scenario), None);
        let told = misread(Format::PathJob, scenario).expect("a fault");
        assert_eq!(
            told,
            "this is a scenario, since it has [process], but a path job is asked for"
        );
        let told = misread(Format::Scenario, "[wheel]\n[path]\n").expect("a fault");
        assert!(
            told.starts_with("this is a path job, since it has [wheel]"),
            "{told}"
        );
        let robot = "[[joint]]\nname = \"j1\"\n[masses]\n";
        let told = misread(Format::Scenario, robot).expect("a fault");
        assert!(
            told.starts_with("this is a robot's file, since it has [joint]"),
            "{told}"
        );
        // What is none of these has faults of its own.
        assert_eq!(misread(Format::Scenario, "name = \"a\"\n"), None);
        assert_eq!(
            misread(Format::Identification, "[modes]\n[process]\n"),
            None
        );
    }
}
