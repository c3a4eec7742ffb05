//! Finds scenarios in folders.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// What was found at some paths.
#[derive(Default)]
pub struct Found {
    pub scenarios: Vec<PathBuf>,
    /// `.toml` files below folders that are something else.
    pub others: Vec<PathBuf>,
}

/// The scenarios at `paths`: files as they are named, and below folders every `.toml` file that is
/// one or is meant to be, in alphabetical order, each once. Hidden folders are left out.
pub fn find_scenarios(paths: &[PathBuf]) -> Result<Found, Failure> {
    let mut found = Found::default();
    for path in paths {
        if path.is_dir() {
            collect(path, &mut found)?;
        } else if path.exists() {
            found.scenarios.push(path.clone());
        } else {
            return Err(Failure::at(path, "no such file or folder"));
        }
    }
    // A file that is named by itself and by its folder is one.
    let mut known = BTreeSet::new();
    let place = |path: &PathBuf| path.canonicalize().unwrap_or_else(|_| path.clone());
    found.scenarios.retain(|path| known.insert(place(path)));
    if found.scenarios.is_empty() {
        let paths: Vec<String> = paths
            .iter()
            .map(|path| path.display().to_string())
            .collect();
        let help = "a scenario is a .toml file with a [process] table";
        return Err(Failure::with_help(
            format!("no scenario in {}", paths.join(", ")),
            help,
        ));
    }
    Ok(found)
}

fn collect(folder: &Path, found: &mut Found) -> Result<(), Failure> {
    let unreadable = |error: std::io::Error| Failure::at(folder, error);
    let entries = std::fs::read_dir(folder).map_err(unreadable)?;
    let mut entries: Vec<PathBuf> = entries
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<_, _>>()
        .map_err(unreadable)?;
    entries.sort();
    for path in entries {
        let hidden = path
            .file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with('.'));
        // A symbolic link could form a cycle.
        if hidden || (path.is_dir() && path.is_symlink()) {
            continue;
        } else if path.is_dir() {
            collect(&path, found)?;
        } else if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            let list = match is_scenario(&path) {
                true => &mut found.scenarios,
                false => &mut found.others,
            };
            list.push(path);
        }
    }
    Ok(())
}

/// Tables that stand in scenarios, and those by which files of other kinds are told that have some
/// of them, too.
const OF_SCENARIOS: [&str; 9] = [
    "process",
    "robot",
    "run",
    "claim",
    "sweep",
    "effect",
    "data",
    "uncertain",
    "fit",
];
const OF_OTHERS: [&str; 6] = ["surface", "wheel", "path", "program", "stiffness", "modes"];

/// A file that cannot be read counts, so that its fault is reported, and so does one whose process
/// is missing or misspelt.
fn is_scenario(path: &Path) -> bool {
    let table = truecut_files::read_text(path)
        .ok()
        .and_then(|text| text.parse::<toml::Table>().ok());
    let Some(table) = table else {
        return true;
    };
    let has = |keys: &[&str]| keys.iter().any(|key| table.contains_key(*key));
    table.contains_key("process") || (has(&OF_SCENARIOS) && !has(&OF_OTHERS))
}
