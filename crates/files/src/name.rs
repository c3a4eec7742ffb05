//! Names of folders that are made of the names of files.

use std::path::Path;

/// Names that Windows keeps for devices, whatever the ending.
const DEVICES: [&str; 22] = [
    "CON", "PRN", "AUX", "NUL", "COM1", "COM2", "COM3", "COM4", "COM5", "COM6", "COM7", "COM8",
    "COM9", "LPT1", "LPT2", "LPT3", "LPT4", "LPT5", "LPT6", "LPT7", "LPT8", "LPT9",
];

/// The name of a file without folder and extension, as a name that a folder can have on every
/// system: `.` and `..`, which would lead elsewhere, and names of nothing become `nameless`; dots
/// and spaces at the end go; control characters become `_`; names of devices get one.
///
/// ```
/// use truecut_files::folder_name;
///
/// assert_eq!(folder_name("runs/swing.toml".as_ref(), "scenario"), "swing");
/// assert_eq!(folder_name("runs/...toml".as_ref(), "scenario"), "scenario");
/// assert_eq!(folder_name("con.toml".as_ref(), "scenario"), "con_");
/// ```
pub fn folder_name(file: &Path, nameless: &str) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let plain: String = stem
        .chars()
        .map(|c| if c.is_control() { '_' } else { c })
        .collect();
    let plain = plain.trim_end_matches(['.', ' ']);
    if plain.is_empty() {
        return nameless.to_owned();
    }
    let device = plain.split('.').next().unwrap_or_default().trim_end();
    match DEVICES.iter().any(|name| name.eq_ignore_ascii_case(device)) {
        true => format!("{plain}_"),
        false => plain.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_lead_elsewhere_or_are_kept_are_replaced() {
        let cases = [
            ("swing.toml", "swing"),
            ("a/b.c.toml", "b.c"),
            ("..toml", "it"),
            ("...toml", "it"),
            ("....toml", "it"),
            (" .toml", "it"),
            ("/", "it"),
            ("dot. .toml", "dot"),
            ("a\tb\u{1b}.toml", "a_b_"),
            ("CON.toml", "CON_"),
            ("nul.x.toml", "nul.x_"),
            ("lpt9.toml", "lpt9_"),
            ("console.toml", "console"),
            ("größe.toml", "größe"),
        ];
        for (file, name) in cases {
            assert_eq!(folder_name(Path::new(file), "it"), name, "{file:?}");
        }
    }
}
