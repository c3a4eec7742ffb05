//! Files that bear their name only when they are whole.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// A file under construction. It is written beside the file whose name it is to have; what that
/// one held stays until the new content is on the disk.
enum Aside {
    New(NamedTempFile, PathBuf),
    /// A device or a pipe, which has no content to keep.
    Straight(File),
}

impl Aside {
    fn begin(path: &Path) -> io::Result<Aside> {
        if path.metadata().is_ok_and(|there| is_special(&there)) {
            return Ok(Aside::Straight(File::options().write(true).open(path)?));
        }
        let folder = path.parent().filter(|it| !it.as_os_str().is_empty());
        let mut builder = tempfile::Builder::new();
        builder.prefix(".").suffix(".part");
        // As any new file's; those of the library are for their owner's eyes only.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder.unwrap_or(Path::new(".")))?;
        Ok(Aside::New(file, path.to_owned()))
    }

    /// What is written to.
    fn file(&self) -> io::Result<File> {
        match self {
            Aside::New(file, _) => file.as_file().try_clone(),
            Aside::Straight(file) => file.try_clone(),
        }
    }

    /// Gives the file its name, in place of what had it. A link of that name is replaced, what it
    /// leads to stays.
    fn keep(self) -> io::Result<()> {
        let Aside::New(file, path) = self else {
            return Ok(());
        };
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    }
}

fn is_special(there: &std::fs::Metadata) -> bool {
    !there.is_file() && !there.is_dir()
}

/// Writes a file aside, syncs it and gives it its name: whatever goes wrong, what the file held
/// before stays.
///
/// # Errors
/// What the writer finds, and a folder or disk that does not take the file.
pub fn write_whole<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), E>,
) -> Result<(), E> {
    let aside = Aside::begin(path)?;
    write(&mut aside.file()?)?;
    Ok(aside.keep()?)
}

/// A file to read and to write further at its end; empty if there is none of that name yet, or what
/// has the name is no file. A link of that name is replaced, what it leads to stays.
///
/// # Errors
/// A name that cannot be given, a file that cannot be opened.
pub fn continued(path: &Path) -> io::Result<File> {
    let mut options = File::options();
    options.read(true).append(true);
    match path.symlink_metadata() {
        Ok(there) if there.is_file() => return options.open(path),
        Ok(_) => std::fs::remove_file(path)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    options.create_new(true).open(path)
}

/// A file to write at once under its name, in place of what has that name, and to read what was
/// written. A link of that name is replaced, what it leads to stays.
///
/// # Errors
/// A name that cannot be given.
pub fn fresh(path: &Path) -> io::Result<File> {
    if path.metadata().is_ok_and(|there| is_special(&there)) {
        return File::options().write(true).open(path);
    }
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => (File::options().read(true).write(true))
            .create_new(true)
            .open(path),
    }
}
