//! What was read: so that an answer can be told to be that of the same files.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fs::Metadata;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

thread_local! {
    /// Digest of what this thread has read, while somebody wants to know.
    static READ: RefCell<Option<DefaultHasher>> = const { RefCell::new(None) };
}

/// Where all files are that the process has read.
static EVER_READ: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Whether the process has read the file at `path`, by whatever name: what is written there would
/// take its place.
pub fn was_read(path: &Path) -> bool {
    let read = EVER_READ.lock().unwrap_or_else(PoisonError::into_inner);
    path.canonicalize().is_ok_and(|path| read.contains(&path))
}

fn note_read(path: &Path) {
    if let Ok(path) = path.canonicalize() {
        let mut read = EVER_READ.lock().unwrap_or_else(PoisonError::into_inner);
        read.insert(path);
    }
}

/// Does something, and gives a number that depends on the name and the content of every file that
/// [`read`](crate::read) and [`read_text`](crate::read_text) gave this thread meanwhile, and on the
/// name, the size and the time of change of every file that [`open`](crate::open) did. Work inside
/// work is watched with it.
pub fn watched<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let outer = READ.replace(Some(DefaultHasher::new()));
    let answer = work();
    let inner = READ.replace(outer).unwrap_or_default().finish();
    note(|digest| inner.hash(digest));
    (answer, inner)
}

fn note(what: impl FnOnce(&mut DefaultHasher)) {
    READ.with_borrow_mut(|digest| digest.as_mut().map(what));
}

pub(crate) fn note_bytes(path: &Path, bytes: &[u8]) {
    note_read(path);
    note(|digest| (path, bytes).hash(digest));
}

pub(crate) fn note_opened(path: &Path, found: &Metadata) {
    note_read(path);
    note(|digest| (path, found.len(), found.modified().ok()).hash(digest));
}
