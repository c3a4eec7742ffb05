//! What processes tell of themselves, held against the shipped scenarios.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use truecut_scenario::{ProcessSpec, Scenario};

/// All scenarios in the folders below `scenarios/`; files of another format stand among them.
fn shipped() -> Vec<Scenario> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut files = Vec::new();
    collect(&root, &mut files);
    assert!(!files.is_empty(), "no scenarios below {}", root.display());
    let read = |file: &PathBuf| {
        let text = std::fs::read_to_string(file).unwrap();
        let is_scenario = text.lines().any(|line| line.starts_with("[process"));
        is_scenario.then(|| Scenario::load(file, &[]).unwrap_or_else(|e| panic!("{e:?}")))
    };
    files.iter().filter_map(read).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            files.push(path);
        }
    }
}

/// Whether the schema of the format has the dotted key.
fn is_key(key: &str) -> bool {
    let schema = Scenario::json_schema();
    let mut here = &schema;
    for part in key.split('.') {
        let alternatives = here.get("anyOf").and_then(|any| any.as_array());
        here = alternatives.map_or(here, |any| &any[0]);
        let Some(next) = here.pointer(&format!("/properties/{part}")) else {
            return false;
        };
        here = next;
    }
    true
}

#[test]
fn no_two_processes_share_a_name_and_each_is_documented() {
    let names: BTreeSet<&str> = ProcessSpec::NAMES.iter().copied().collect();
    assert_eq!(names.len(), ProcessSpec::NAMES.len());
    let schema = Scenario::json_schema();
    for name in names {
        let pointer = format!("/properties/process/properties/{name}/description");
        let text = schema.pointer(&pointer).and_then(|text| text.as_str());
        assert!(text.is_some_and(|text| !text.is_empty()), "{name}");
    }
}

#[test]
fn every_knob_is_a_key_and_every_process_has_one_that_shipped_scenarios_give() {
    let mut given = BTreeMap::new();
    for scenario in shipped() {
        let name = scenario.process.name().to_owned();
        for knob in scenario.process.facts().knobs {
            let has = scenario.number(knob.key).or(knob.default).is_some();
            *given.entry(name.clone()).or_insert(false) |= has;
            assert!(is_key(knob.key), "`{}` is no key of a scenario", knob.key);
            let of_process = format!("process.{name}.");
            assert!(knob.key.starts_with(&of_process), "{}", knob.key);
            assert!(!knob.factors.is_empty() && !knob.factors.contains(&1.0));
        }
    }
    for name in ProcessSpec::NAMES {
        assert_eq!(given.get(*name), Some(&true), "{name}");
    }
}

#[test]
fn every_file_that_a_process_reads_is_a_key() {
    for scenario in shipped() {
        for key in scenario.process.facts().files {
            let key = format!("process.{}.{key}", scenario.process.name());
            assert!(is_key(&key), "`{key}` is no key of a scenario");
        }
    }
}

#[test]
fn what_turns_turns_at_a_speed_above_zero() {
    for scenario in shipped() {
        let rate_rad_s = scenario.process.facts().rate_rad_s;
        assert!(rate_rad_s.is_none_or(|rate| rate > 0.0 && rate.is_finite()));
    }
}
