//! Files of the repository that a reader knows.

use std::fs;
use std::path::{Path, PathBuf};

/// Larger files say nothing that a smaller one does not.
const LARGEST: u64 = 200_000;

/// A file and what it holds.
pub struct Seed {
    pub path: PathBuf,
    pub bytes: Vec<u8>,
}

/// The repository's root.
#[must_use]
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().expect("a folder above").to_owned()
}

/// Files below folders of the repository whose endings are these, in the order of their names;
/// `knows` is asked for each.
///
/// # Panics
/// If there is none.
#[must_use]
pub fn seeds(
    folders: &[&str],
    endings: &[&str],
    knows: impl Fn(&Path, &[u8]) -> bool,
) -> Vec<Seed> {
    let mut found = Vec::new();
    let mut open: Vec<PathBuf> = folders.iter().map(|folder| root().join(folder)).collect();
    while let Some(folder) = open.pop() {
        let entries = fs::read_dir(&folder).expect("a folder of the repository");
        for path in entries.map(|entry| entry.expect("an entry").path()) {
            if path.is_dir() {
                open.push(path);
                continue;
            }
            let ending = path.extension().unwrap_or_default().to_string_lossy();
            let small = path.metadata().is_ok_and(|file| file.len() <= LARGEST);
            if small
                && endings
                    .iter()
                    .any(|known| known.eq_ignore_ascii_case(&ending))
            {
                let bytes = fs::read(&path).expect("a file of the repository");
                if knows(&path, &bytes) {
                    found.push(Seed { path, bytes });
                }
            }
        }
    }
    assert!(!found.is_empty(), "no {endings:?} in {folders:?}");
    found.sort_by(|one, other| one.path.cmp(&other.path));
    found
}
