//! Rules of the house: who may know whom, held against the manifests; how long files are and how
//! wide comments.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// What each crate may depend on, of ours. The program may depend on everything; the whole-system
/// tests too.
const MAY_DEPEND_ON: &[(&str, &[&str])] = &[
    ("core", &[]),
    ("files", &[]),
    ("arm", &["core", "files"]),
    ("plan", &["arm", "core", "files"]),
    ("recording", &[]),
    ("scenario", &["plan", "recording", "arm", "core", "files"]),
    (
        "sim",
        &["plan", "scenario", "recording", "arm", "core", "files"],
    ),
    ("telemetry", &["recording", "files"]),
    ("discrepancy", &["sim", "plan", "scenario", "recording"]),
    (
        "truecut",
        &[
            "core",
            "files",
            "arm",
            "plan",
            "recording",
            "scenario",
            "sim",
            "telemetry",
            "discrepancy",
        ],
    ),
    ("python", &["truecut"]),
    (
        "cli",
        &[
            "truecut",
            "core",
            "files",
            "arm",
            "plan",
            "recording",
            "scenario",
            "sim",
            "telemetry",
            "discrepancy",
        ],
    ),
];

/// Libraries that stay in one place each.
const ONLY_IN: &[(&str, &[&str])] = &[
    ("rapier3d", &["sim"]),
    ("parry3d", &["plan", "sim"]),
    ("re_chunk", &["telemetry"]),
    ("re_log_encoding", &["telemetry"]),
    ("re_log_types", &["telemetry"]),
    ("re_sdk_types", &["telemetry"]),
    ("mcap", &["telemetry"]),
    ("pyo3", &["python"]),
    ("re_ros_msg", &["telemetry"]),
    ("re_cdr", &["telemetry"]),
    ("clap", &["cli"]),
    ("urdf-rs", &["arm"]),
    ("rs-opw-kinematics", &["arm"]),
];

/// What the analytic core may use besides the standard library: mathematics, and a macro for
/// errors.
const CORE_MAY_USE: &[&str] = &["nalgebra", "statrs", "thiserror"];

/// Crates whose lints are their own: PyO3's macros write `unsafe` blocks, which `forbid` refuses.
const OWN_LINTS: &[&str] = &["python"];

/// Calls by which files are read and written past the room that refuses pipes, devices and what is
/// too large, and that writes whole files only.
const PAST_FILES: &[&str] = &[
    "fs::read(",
    "fs::read_to_string(",
    "fs::write(",
    "File::open(",
    "File::create(",
];
/// Where they stand: that room, locks on folders, and what makes bad files.
const MAY_OPEN: &[&str] = &[
    "crates/files/src/",
    "crates/truecut/src/staged.rs",
    "fuzz/src/",
];

/// Names of the packages in a manifest's dependency tables of these names, also below `target`.
fn dependencies(manifest: &toml::Table, tables: &[&str]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (key, value) in manifest {
        let Some(table) = value.as_table() else {
            continue;
        };
        if tables.contains(&key.as_str()) {
            found.extend(table.iter().map(|(name, value)| {
                let renamed = value.get("package").and_then(toml::Value::as_str);
                renamed.unwrap_or(name).to_owned()
            }));
        } else if key == "target" {
            for platform in table.values().filter_map(toml::Value::as_table) {
                found.extend(dependencies(platform, tables));
            }
        }
    }
    found
}

fn manifests() -> BTreeMap<String, toml::Table> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let entries = std::fs::read_dir(crates).unwrap();
    entries
        .map(|entry| {
            let folder = entry.unwrap().path();
            let name = folder.file_name().unwrap().to_string_lossy().into_owned();
            let text = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
            (name, text.parse().unwrap())
        })
        .collect()
}

const ALL_TABLES: &[&str] = &["dependencies", "dev-dependencies", "build-dependencies"];
const BUILT_IN: &[&str] = &["dependencies", "build-dependencies"];

#[test]
fn every_crate_has_a_place_in_the_rule() {
    let ruled: BTreeSet<&str> = MAY_DEPEND_ON.iter().map(|(name, _)| *name).collect();
    let manifests = manifests();
    let found: BTreeSet<&str> = manifests.keys().map(String::as_str).collect();
    assert_eq!(found, ruled);
}

#[test]
fn crates_depend_only_on_those_below_them() {
    let manifests = manifests();
    for (name, allowed) in MAY_DEPEND_ON {
        for dependency in dependencies(&manifests[*name], BUILT_IN) {
            // The front door's package is called like the project.
            let ours = if dependency == "truecut" {
                Some("truecut")
            } else {
                dependency.strip_prefix("truecut-")
            };
            if let Some(ours) = ours {
                assert!(allowed.contains(&ours), "{name} must not depend on {ours}");
            }
        }
    }
}

#[test]
fn heavy_libraries_stay_where_they_belong() {
    for (name, manifest) in manifests() {
        for dependency in dependencies(&manifest, ALL_TABLES) {
            for (library, places) in ONLY_IN {
                let is_it =
                    dependency == *library || dependency.starts_with(&format!("{library}-"));
                assert!(
                    !is_it || places.contains(&name.as_str()),
                    "{name} must not use {dependency}"
                );
            }
        }
    }
}

#[test]
fn the_core_uses_mathematics_only() {
    let found = dependencies(&manifests()["core"], BUILT_IN);
    let strangers: Vec<&String> = found
        .iter()
        .filter(|name| !CORE_MAY_USE.contains(&name.as_str()))
        .collect();
    assert!(strangers.is_empty(), "core must not use {strangers:?}");
}

/// `unsafe_code = forbid` of the workspace, but where macros write it; there it is denied, and no
/// line of ours lifts that.
#[test]
fn no_crate_has_unsafe_code_of_its_own() {
    for (name, manifest) in manifests() {
        let lints = manifest["lints"].as_table().unwrap();
        if !OWN_LINTS.contains(&name.as_str()) {
            assert_eq!(lints.get("workspace"), Some(&true.into()), "{name}");
            continue;
        }
        assert_eq!(
            lints["rust"]["unsafe_code"].as_str(),
            Some("deny"),
            "{name}"
        );
        for (file, text) in sources() {
            let is_of_it = file.contains(&format!("crates/{name}/src/"));
            let lifts = ["unsafe {", "unsafe fn", "unsafe impl", "allow(unsafe_code)"];
            let found = lifts.iter().find(|word| is_of_it && text.contains(**word));
            assert_eq!(found, None, "{file}");
        }
    }
}

/// The rule would hold of anything if the reader saw nothing.
#[test]
fn the_reader_sees_every_kind_of_dependency() {
    let manifest: toml::Table = "
        [dependencies]
        one = '1'
        alias = { package = 'two', version = '1' }
        [target.'cfg(unix)'.dependencies]
        three = '1'
        [dev-dependencies]
        four = '1'
    "
    .parse()
    .unwrap();
    let names = |tables| {
        dependencies(&manifest, tables)
            .into_iter()
            .collect::<Vec<_>>()
    };
    assert_eq!(names(BUILT_IN), ["one", "three", "two"]);
    assert_eq!(names(ALL_TABLES), ["four", "one", "three", "two"]);
}

/// Rust files of the crates, of the tests and of the fuzzing.
fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut folders = vec![root.join("crates"), root.join("fuzz"), root.join("tests")];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let text = std::fs::read_to_string(&path).expect("text");
                let name = path.strip_prefix(&root).expect("below it").display();
                found.push((name.to_string(), text));
            }
        }
    }
    assert!(found.len() > 500, "{} files", found.len());
    found
}

#[test]
fn files_are_short() {
    let long = |(name, text): &(String, String)| {
        let lines = text.lines().count();
        (name.contains("/src/") && lines > 400).then(|| format!("{name}: {lines} lines"))
    };
    let long: Vec<String> = sources().iter().filter_map(long).collect();
    assert_eq!(long, [""; 0]);
}

/// Whether a file of this name is compiled for tests only, or is a room of the rule.
fn may_open(name: &str) -> bool {
    !name.contains("/src/")
        || name.contains("/tests/")
        || ["/tests.rs", "/testing.rs", "/contract.rs"]
            .iter()
            .any(|end| name.ends_with(end))
        || MAY_OPEN.iter().any(|place| name.starts_with(place))
}

#[test]
fn files_are_read_and_written_in_one_room() {
    let mut past = Vec::new();
    for (name, text) in sources() {
        // Up to its module of tests; what else is compiled for tests alone keeps the rule, too.
        let tests = "#[cfg(test)]\nmod tests {";
        let production = text.split(tests).next().unwrap_or_default();
        if !may_open(&name) {
            let calls = PAST_FILES.iter().filter(|call| production.contains(**call));
            past.extend(calls.map(|call| format!("{name}: {call}")));
        }
    }
    assert_eq!(past, [""; 0]);
}

#[test]
fn comments_are_no_wider_than_the_page() {
    let mut wide = Vec::new();
    for (name, text) in sources() {
        for (i, line) in text.lines().enumerate() {
            if line.trim_start().starts_with("//") && line.chars().count() > 100 {
                wide.push(format!("{name}:{}", i + 1));
            }
        }
    }
    assert_eq!(wide, [""; 0]);
}

/// Where a crate's tests make one program, a file that its `main.rs` does not name is not compiled:
/// its tests would never run, and nothing would say so.
#[test]
fn every_file_of_tests_is_compiled() {
    let mut judged = 0;
    let mut left_out = Vec::new();
    for (name, manifest) in manifests() {
        let discovered = |package: &toml::Value| package.get("autotests")?.as_bool();
        if manifest.get("package").and_then(discovered) != Some(false) {
            continue;
        }
        let crates = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates");
        let folder = Path::new(crates).join(&name).join("tests");
        let main = std::fs::read_to_string(folder.join("main.rs")).expect("its main.rs");
        for entry in std::fs::read_dir(&folder).expect("tests") {
            let path = entry.expect("entry").path();
            let rust = path.extension().is_some_and(|ending| ending == "rs");
            let module = path.file_stem().expect("a name").to_string_lossy();
            if (rust || path.join("mod.rs").exists()) && module != "main" {
                judged += 1;
                if !main.contains(&format!("\nmod {module};\n")) {
                    left_out.push(format!("crates/{name}/tests/{module}"));
                }
            }
        }
    }
    assert!(judged > 50, "{judged} files of tests");
    assert_eq!(left_out, [""; 0]);
}

/// A method with a body of its own that a wrapper does not pass on is another model's answer.
#[test]
fn a_model_that_keeps_predictions_passes_everything_on() {
    let sources: BTreeMap<String, String> = sources().into_iter().collect();
    let methods = |file: &str, begin: &str| -> BTreeSet<String> {
        let text = &sources[file];
        let begins = text.find(begin).unwrap_or_else(|| panic!("{begin}"));
        let block = &text[begins..];
        let block = &block[..block.find("\n}\n").expect("its end")];
        let lines = block
            .lines()
            .filter_map(|line| line.strip_prefix("    fn "));
        lines
            .map(|line| line.split(['(', '<']).next().unwrap_or_default().to_owned())
            .collect()
    };
    let asked = methods("crates/discrepancy/src/model.rs", "pub trait Model");
    let passed = methods(
        "crates/truecut/src/predictions.rs",
        "impl Model for KeptModel",
    );
    assert!(asked.len() > 10, "{asked:?}");
    assert_eq!(passed, asked);
}
