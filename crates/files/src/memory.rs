//! How much memory may be used.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// What is read takes at most so many times its size on the disk: meshes whose corners are joined,
/// tables whose cells are numbers.
const READING_TAKES: u64 = 8;

/// As [`limit_memory`] has it; zero before it is asked for.
static LIMIT: AtomicU64 = AtomicU64::new(0);

/// Lets the process use no more than that, bytes: larger files are refused before they are read,
/// larger runs before they begin. Without it the limit is that of the control group, if there is
/// one.
pub fn limit_memory(bytes: u64) {
    LIMIT.store(bytes.max(1), Ordering::Relaxed);
}

/// Bytes that may be used.
pub fn memory_limit() -> u64 {
    match LIMIT.load(Ordering::Relaxed) {
        0 => {
            let limit = of_group(Path::new("/sys/fs/cgroup"));
            limit_memory(limit);
            limit
        }
        limit => limit,
    }
}

/// Largest file that is read within the limit, bytes.
pub(crate) fn largest_file() -> u64 {
    memory_limit() / READING_TAKES
}

/// The limit of the control group that the process is in (version 2, else 1); all where there is
/// none.
fn of_group(folder: &Path) -> u64 {
    let files = ["memory.max", "memory/memory.limit_in_bytes"];
    let limits = files.iter().filter_map(|file| {
        let text = std::fs::read_to_string(folder.join(file)).ok()?;
        text.trim().parse().ok()
    });
    limits.min().unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_of_a_group_is_read_in_both_versions() {
        let folder = tempfile::tempdir().unwrap();
        let write =
            |file: &str, text: &str| std::fs::write(folder.path().join(file), text).unwrap();
        assert_eq!(of_group(folder.path()), u64::MAX);
        write("memory.max", "max\n");
        assert_eq!(of_group(folder.path()), u64::MAX);
        write("memory.max", "2147483648\n");
        assert_eq!(of_group(folder.path()), 2 << 30);
        std::fs::create_dir(folder.path().join("memory")).unwrap();
        write("memory/memory.limit_in_bytes", "1073741824\n");
        assert_eq!(of_group(folder.path()), 1 << 30);
    }
}
