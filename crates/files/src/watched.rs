//! What was read: so that an answer can be told to be that of the same files.

use std::cell::RefCell;
use std::fs::Metadata;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

thread_local! {
    /// Digest of what this thread has read, while somebody wants to know.
    static READ: RefCell<Option<DefaultHasher>> = const { RefCell::new(None) };
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
    note(|digest| (path, bytes).hash(digest));
}

pub(crate) fn note_opened(path: &Path, found: &Metadata) {
    note(|digest| (path, found.len(), found.modified().ok()).hash(digest));
}
