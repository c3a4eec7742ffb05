//! How much can still be written.

use std::io;
use std::path::Path;

/// Bytes that the disk of a folder has free for this user; `None` where the system is not asked.
///
/// # Errors
/// A folder that cannot be asked.
#[cfg(unix)]
pub fn room_bytes(folder: &Path) -> io::Result<Option<u64>> {
    let disk = rustix::fs::statvfs(folder)?;
    Ok(Some(disk.f_bavail.saturating_mul(disk.f_frsize)))
}

/// Bytes that the disk of a folder has free for this user; `None` where the system is not asked.
///
/// # Errors
/// None here.
#[cfg(not(unix))]
pub fn room_bytes(_folder: &Path) -> io::Result<Option<u64>> {
    Ok(None)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_folder_has_room_and_one_that_is_not_there_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        assert!(room_bytes(folder.path()).unwrap() > Some(0));
        assert!(room_bytes(&folder.path().join("none")).is_err());
    }
}
