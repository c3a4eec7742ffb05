//! How much memory may be used.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// What is read takes at most so many times its size on the disk: meshes whose corners are joined,
/// tables whose cells are numbers.
const READING_TAKES: u64 = 8;

/// As [`limit_memory`] has it; zero before it is asked for.
static LIMIT: AtomicU64 = AtomicU64::new(0);

/// Lets the process use no more than that, bytes: larger files are refused before they are read,
/// larger runs before they begin. Without it the limit is the least of those of the control group
/// and of the process (`ulimit -v`, `ulimit -d`), if there are any.
pub fn limit_memory(bytes: u64) {
    LIMIT.store(bytes.max(1), Ordering::Relaxed);
}

/// Bytes that may be used.
pub fn memory_limit() -> u64 {
    match LIMIT.load(Ordering::Relaxed) {
        0 => {
            let of_self = std::fs::read_to_string("/proc/self/limits").unwrap_or_default();
            let limit = of_group(Path::new("/sys/fs/cgroup")).min(of_process(&of_self));
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

/// The least of the limits of the process, as Linux tells them; all where there are none.
fn of_process(limits: &str) -> u64 {
    let limit = |line: &str| {
        let names = ["Max data size", "Max address space"];
        let rest = names.iter().find_map(|name| line.strip_prefix(name))?;
        rest.split_whitespace().next()?.parse().ok()
    };
    limits.lines().filter_map(limit).min().unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limits_of_a_process_are_read() {
        let limits = |data: &str, space: &str| {
            format!(
                "Limit                     Soft Limit           Hard Limit           Units     \n\
                 Max file size             4096                 unlimited            bytes     \n\
                 Max data size             {data:20} unlimited            bytes     \n\
                 Max address space         {space:20} unlimited            bytes     \n"
            )
        };
        assert_eq!(of_process(""), u64::MAX);
        assert_eq!(of_process(&limits("unlimited", "unlimited")), u64::MAX);
        assert_eq!(of_process(&limits("unlimited", "4294967296")), 4 << 30);
        assert_eq!(of_process(&limits("1048576", "4294967296")), 1 << 20);
    }

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
