//! Finds scenarios in folders.

use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// The scenarios at `paths`: files as they are named, and below folders every `.toml` file with a
/// `[process]` table, in alphabetical order. Hidden folders are left out.
pub fn find_scenarios(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    for path in paths {
        if path.is_dir() {
            collect(path, &mut found)?;
        } else if path.exists() {
            found.push(path.clone());
        } else {
            return Err(Failure::at(path, "no such file or folder"));
        }
    }
    if found.is_empty() {
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

fn collect(folder: &Path, found: &mut Vec<PathBuf>) -> Result<(), Failure> {
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
            && is_scenario(&path)
        {
            found.push(path);
        }
    }
    Ok(())
}

/// A file with a syntax error counts if it has a process table, so that the error is reported.
fn is_scenario(path: &Path) -> bool {
    let Ok(text) = std::fs::read_to_string(path) else {
        return false;
    };
    match text.parse::<toml::Table>() {
        Ok(table) => table.get("process").is_some_and(toml::Value::is_table),
        Err(_) => text
            .lines()
            .any(|line| line.trim_start().starts_with("[process")),
    }
}
