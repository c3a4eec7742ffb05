//! Sets of files that replace those of an earlier answer together, or not at all.

use std::fs::{File, TryLockError};
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

use truecut_telemetry::{FileError, Reason};

/// Where files wait for their place.
const ASIDE: &str = ".part";

/// A folder into which one writer puts a set of files. They are written aside, into `.part` below
/// it; [`Staged::publish`] syncs them and gives them their places. Whatever goes wrong before, the
/// files of an earlier set stay, and what was written aside is removed. A program that is killed
/// leaves `.part`, which goes with the next set.
///
/// ```
/// use truecut::Staged;
///
/// # let folder = tempfile::tempdir()?;
/// # let folder = folder.path();
/// let set = Staged::begin(folder)?;
/// assert!(Staged::begin(folder).is_err(), "one writer a folder");
/// std::fs::write(set.path("answer.json"), "{}")?;
/// assert!(!folder.join("answer.json").exists());
/// // What an earlier set had of these names and this one has not is removed.
/// set.publish(&["figure.svg", "answer.json"])?;
/// assert!(folder.join("answer.json").exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Staged {
    folder: PathBuf,
    /// The folder, locked for as long as something may be written into it.
    _lock: Option<File>,
}

impl Staged {
    /// Makes the folder, locks it against other writers and empties what waits in it.
    ///
    /// # Errors
    /// A folder that cannot be made or written to, that is a link, or into which another program is
    /// writing.
    pub fn begin(folder: &Path) -> Result<Staged, FileError> {
        // A link may lead to files that nobody meant to be replaced.
        if folder.is_symlink() {
            let because = "it is a link, and links are not followed: remove it, or give --out the \
                           folder that it leads to";
            return Err(failed(folder, Error::other(because)));
        }
        std::fs::create_dir_all(folder).map_err(|error| failed(folder, error))?;
        let staged = Staged {
            _lock: lock(folder)?,
            folder: folder.to_owned(),
        };
        let aside = staged.aside();
        remove_all(&aside)
            .and_then(|()| std::fs::create_dir(&aside))
            .map_err(|error| failed(&aside, error))?;
        Ok(staged)
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where a file of the set is to be written.
    pub fn path(&self, name: &str) -> PathBuf {
        self.aside().join(name)
    }

    /// Gives the files their places. The last name is that of the file which says that the set is
    /// whole: its predecessor goes first, it comes last.
    ///
    /// # Errors
    /// A file that cannot be synced, replaced or removed.
    pub fn publish(&self, names: &[&str]) -> Result<(), FileError> {
        let waiting = |name: &&&str| self.path(name).is_file();
        for name in names.iter().filter(waiting) {
            let path = self.path(name);
            File::options()
                .write(true)
                .open(&path)
                .and_then(|file| file.sync_all())
                .map_err(|error| failed(&path, error))?;
        }
        if let Some(seal) = names.last() {
            remove(&self.folder.join(seal))?;
        }
        for name in names {
            let (from, to) = (self.path(name), self.folder.join(name));
            if from.is_file() {
                std::fs::rename(&from, &to).map_err(|error| failed(&to, error))?;
            } else {
                remove(&to)?;
            }
        }
        // Renames are on the disk once their folder is. Not every system can sync one.
        let _ = File::open(&self.folder).and_then(|folder| folder.sync_all());
        Ok(())
    }

    fn aside(&self) -> PathBuf {
        self.folder.join(ASIDE)
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        // There is nobody to tell that it stays; the next set removes it.
        let _ = remove_all(&self.aside());
    }
}

/// Removes a file; a link goes, what it leads to stays.
fn remove(path: &Path) -> Result<(), FileError> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(failed(path, error)),
        _ => Ok(()),
    }
}

fn remove_all(folder: &Path) -> std::io::Result<()> {
    let removed = match folder.is_symlink() {
        true => std::fs::remove_file(folder),
        false => std::fs::remove_dir_all(folder),
    };
    match removed {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

/// Locks a folder; `None` where the file system has no locks.
fn lock(folder: &Path) -> Result<Option<File>, FileError> {
    let Ok(file) = File::open(folder) else {
        return Ok(None);
    };
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => {
            let because =
                "another run is writing into this folder: give --out another one, or wait";
            Err(failed(folder, Error::other(because)))
        }
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

fn failed(path: &Path, error: Error) -> FileError {
    FileError {
        path: path.to_owned(),
        reason: Reason::Io(error),
    }
}
