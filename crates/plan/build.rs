//! Lists the dialects of robot programs: the folders of `src/program` that hold a `dialect.rs`.
//!
//! The list is made here so that no dialect can be left out of it: a folder without its `pub mod`
//! in `src/program/mod.rs` does not compile.

use std::path::PathBuf;
use std::{env, fs, io};

const PROGRAM: &str = "src/program";

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed={PROGRAM}");
    let mut rooms = Vec::new();
    for folder in fs::read_dir(PROGRAM)? {
        let folder = folder?;
        if folder.path().join("dialect.rs").is_file() {
            rooms.push(folder.file_name().to_string_lossy().into_owned());
        }
    }
    rooms.sort();
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let list = format!("dialects! {{ {} }}\n", rooms.join(", "));
    fs::write(out.join("dialects.rs"), list)
}
