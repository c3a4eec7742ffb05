//! Bad input, one fixture a fault, given to the program itself: one error, with file, line, value
//! and rule; exit code 2.
//!
//! A fixture says in its head what to expect:
//!
//! ```toml
//! # What the fault is.
//! # set: key=value          given to the program as --set; may be repeated
//! # expect: text            must stand in the report; may be repeated
//! # line: 12                the report must name this line of the fixture
//! ```

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const BAD_INPUT: i32 = 2;

fn fixtures(folder: &str, extension: &str, least: usize) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/invalid_input")
        .join(folder);
    let entries = std::fs::read_dir(&folder).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|found| found == extension));
    files.sort();
    assert!(
        files.len() >= least,
        "{} holds only {} fixtures",
        folder.display(),
        files.len()
    );
    files
}

fn truecut(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_truecut"));
    // Reports are drawn with the letters that the locale has.
    command
        .args(arguments)
        .env("NO_COLOR", "1")
        .env("LC_ALL", "C.UTF-8")
        .output()
        .unwrap()
}

/// The values of `# key: value` lines.
fn notes<'a>(text: &'a str, key: &str) -> Vec<&'a str> {
    let head = format!("# {key}: ");
    text.lines()
        .filter_map(|line| line.strip_prefix(&head))
        .collect()
}

/// What is wrong with how a command of the program took the fixture; empty if nothing is.
fn complaints(command: &str, file: &Path) -> Vec<String> {
    complaints_of(&[command, file.to_str().unwrap()], file)
}

/// As [`complaints`], of a command that names the file in its own way.
fn complaints_of(command: &[&str], file: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(file).unwrap();
    let out = tempfile::tempdir().unwrap();
    let mut arguments = command.to_vec();
    arguments.extend(["--out", out.path().to_str().unwrap()]);
    for set in notes(&text, "set") {
        arguments.extend(["--set", set]);
    }
    let output = truecut(&arguments);
    let report = String::from_utf8_lossy(&output.stderr);
    let mut complaints = Vec::new();
    if output.status.code() != Some(BAD_INPUT) {
        complaints.push(format!("ended with {}", output.status));
    }
    let name = file.file_name().unwrap().to_str().unwrap();
    let expected = notes(&text, "expect");
    if expected.is_empty() {
        complaints.push("expects nothing".to_owned());
    }
    for wanted in expected.into_iter().chain([name]) {
        if !report.contains(wanted) {
            complaints.push(format!("does not say: {wanted}"));
        }
    }
    for line in notes(&text, "line") {
        if !report.contains(&format!("{name}:{line}:")) {
            complaints.push(format!("does not name line {line}"));
        }
    }
    if report.contains("panicked") || report.matches('×').count() != 1 {
        complaints.push("is not one error".to_owned());
    }
    if !complaints.is_empty() {
        complaints.push(format!("it said:\n{report}"));
    }
    complaints
}

#[test]
fn every_bad_scenario_is_refused_with_place_value_and_rule() {
    let mut wrong = Vec::new();
    for file in fixtures("", "toml", 100) {
        let complaints = complaints("run", &file);
        if !complaints.is_empty() {
            wrong.push(format!("{}: {}", file.display(), complaints.join("\n  ")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn every_bad_fit_is_refused_with_place_value_and_rule() {
    let mut wrong = Vec::new();
    for file in fixtures("fit", "toml", 2) {
        let complaints = complaints("fit", &file);
        if !complaints.is_empty() {
            wrong.push(format!("{}: {}", file.display(), complaints.join("\n  ")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn every_bad_excitation_is_refused_with_place_value_and_rule() {
    let mut wrong = Vec::new();
    for file in fixtures("excite", "toml", 14) {
        let complaints = complaints("excite", &file);
        if !complaints.is_empty() {
            wrong.push(format!("{}: {}", file.display(), complaints.join("\n  ")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn every_bad_identification_is_refused_with_place_value_and_rule() {
    let mut wrong = Vec::new();
    for file in fixtures("identify", "toml", 16) {
        let complaints = complaints("identify", &file);
        if !complaints.is_empty() {
            wrong.push(format!("{}: {}", file.display(), complaints.join("\n  ")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// Paths and cuts for which no posture can be planned. A diagram refuses what is no milling, too.
#[test]
fn every_bad_plan_is_refused_with_place_value_and_rule() {
    let mut wrong = Vec::new();
    for file in fixtures("posture", "toml", 6) {
        let of_process = file.ends_with("not_milling.toml");
        let commands = if of_process {
            &["posture", "lobes"][..]
        } else {
            &["posture"]
        };
        for command in commands {
            let complaints = complaints(command, &file);
            if !complaints.is_empty() {
                let text = complaints.join("\n  ");
                wrong.push(format!("{command} {}: {text}", file.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// Faults that show only where a scenario is held against its data; a comparison refuses them like
/// a diagnosis, unless the fault is one of searching.
#[test]
fn every_bad_diagnosis_is_refused_with_place_value_and_rule() {
    let mut wrong = Vec::new();
    for file in fixtures("diagnose", "toml", 4) {
        let of_search = file.ends_with("times_in_milliseconds.toml")
            || file.ends_with("thinned_to_too_few.toml");
        let commands = if of_search {
            &["diagnose"][..]
        } else {
            &["diagnose", "compare"]
        };
        for command in commands {
            let complaints = complaints(command, &file);
            if !complaints.is_empty() {
                let text = complaints.join("\n  ");
                wrong.push(format!("{command} {}: {text}", file.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// Two recordings of which nothing can be learnt about a change.
#[test]
fn every_bad_pair_of_recordings_is_refused() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shipped = |name: &str| root.join("scenarios/diagnosis").join(name);
    let fixtures: Vec<PathBuf> = fixtures("between", "csv", 4);
    let bad = |name: &str| {
        let found = fixtures.iter().find(|file| file.ends_with(name));
        found.unwrap_or_else(|| panic!("{name}")).clone()
    };
    let same = shipped("elbow.csv");
    let between = |second: &Path, out: &Path| {
        let scenario = shipped("elbow.toml");
        let paths: [&Path; 4] = [&scenario, &same, second, out];
        let paths = paths.map(|path| path.to_str().unwrap());
        let [scenario, first, second, out] = paths;
        truecut(&[
            "diagnose",
            scenario,
            "--between",
            first,
            second,
            "--out",
            out,
        ])
    };
    for (second, wanted) in [
        (same.clone(), "elbow.csv: both recordings are this file"),
        (
            bad("part_of_the_first.csv"),
            "samples in a row are those of",
        ),
        (bad("without_height.csv"), "height_mm"),
        (
            bad("height_stands_still.csv"),
            "tool.position_z is not measured here",
        ),
        (bad("too_short.csv"), "too_short.csv"),
        (shipped("nowhere.csv"), "nowhere.csv"),
    ] {
        let out = tempfile::tempdir().unwrap();
        let output = between(&second, out.path());
        let report = String::from_utf8_lossy(&output.stderr);
        assert_eq!(
            output.status.code(),
            Some(BAD_INPUT),
            "{second:?}: {report}"
        );
        assert!(report.contains(wanted), "{second:?}: {report}");
        assert_eq!(report.matches('×').count(), 1, "{second:?}: {report}");
        assert!(!report.contains("panicked"), "{second:?}: {report}");
    }

    // A folder where the answer goes is told before anything is searched.
    let out = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(out.path().join("elbow/between.json")).unwrap();
    let output = between(&bad("part_of_the_first.csv"), out.path());
    let report = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(BAD_INPUT), "{report}");
    assert!(report.contains("between.json: it is a folder"), "{report}");
}

/// The messages themselves are tested beside the reader of URDF files; here, that the program shows
/// them with the line that they are about.
#[test]
fn every_bad_robot_is_refused_at_its_line() {
    for file in fixtures("urdf", "urdf", 16) {
        // What has no mass answers questions of kinematics; `robot_without_masses.toml` runs it.
        if file.ends_with("zero_mass.urdf") {
            continue;
        }
        let output = truecut(&["robot", file.to_str().unwrap()]);
        let report = String::from_utf8_lossy(&output.stderr);
        assert_eq!(
            output.status.code(),
            Some(BAD_INPUT),
            "{}:\n{report}",
            file.display()
        );
        let name = file.file_name().unwrap().to_str().unwrap();
        assert!(
            report.contains(name) && !report.contains("panicked"),
            "{report}"
        );
        assert_eq!(report.matches('×').count(), 1, "{report}");
        let of_one_line = !["no_links.urdf", "ambiguous_tip.urdf"].contains(&name);
        assert_eq!(
            report.contains(&format!("{name}:")) && report.contains('│'),
            of_one_line,
            "{report}"
        );
    }
}

#[test]
fn arguments_that_make_no_sense_are_refused() {
    for (arguments, wanted) in [
        (&["run"][..], "SCENARIO"),
        (
            &["run", "nowhere.toml"],
            "cannot read scenario nowhere.toml",
        ),
        (&["run", "x.toml", "--set", "depth"], "write KEY=VALUE"),
        (&["run", "x.toml", "--jobs", "0"], "--jobs"),
        (
            &["run", "x.toml", "--jobs", "100000"],
            "--jobs is 100000, but must be at most 1024",
        ),
        (&["check", "nowhere"], "nowhere: no such file or folder"),
        (&["view", "nowhere.rrd"], "nowhere.rrd: no such file"),
        (
            &["robot", "nowhere.urdf"],
            "nowhere.urdf: cannot read the file",
        ),
        (
            &["lobes", "x.toml", "--rpm", "900,300"],
            "write FROM,TO, two numbers above 0 that rise",
        ),
        (&["lobes", "x.toml", "--size", "1"], "--size"),
        (&["posture", "x.toml", "--criterion", "hope"], "--criterion"),
        (
            &["posture", "x.toml", "--least-decay", "1"],
            "must be a number from 0 to less than 1",
        ),
        (&["fly"], "unrecognized subcommand"),
        (&["diagnose", "x.toml", "--between", "a.csv"], "--between"),
        (
            &[
                "diagnose",
                "x.toml",
                "--between",
                "a.csv",
                "b.csv",
                "--data",
                "c.csv",
            ],
            "cannot be used with",
        ),
        (
            &[
                "diagnose",
                "x.toml",
                "--between",
                "a.csv",
                "b.csv",
                "--between",
                "c.csv",
                "d.csv",
            ],
            "cannot be used multiple times",
        ),
        (
            &["compare", "x.toml", "--rpm", "-5"],
            "must be a number above 0",
        ),
        (
            &["robot", "x.urdf", "--posture-deg", "1,x"],
            "must be a number",
        ),
        (&["path", "x.nc"], "needs --robot"),
        (
            &["path", "x.nc", "--work-xyz-mm", "900,0"],
            "three numbers with commas",
        ),
        (
            &["path", "x.toml", "--spin-deg", "9"],
            "have no effect on a path job",
        ),
        (&["path", "x.nc", "--dialect", "val3"], "--dialect"),
        (&["part", "nowhere.stl"], "nowhere.stl"),
        (&["part", "x.stl", "--unit", "foot"], "--unit"),
        (
            &["part", "x.stl", "--crease-deg", "180"],
            "must be below 180",
        ),
        (&["part", "x.stl", "--weld-mm", "-1"], "from 0 on"),
    ] {
        let output = truecut(arguments);
        let report = String::from_utf8_lossy(&output.stderr);
        assert_eq!(
            output.status.code(),
            Some(BAD_INPUT),
            "{arguments:?}: {report}"
        );
        assert!(report.contains(wanted), "{arguments:?}: {report}");
    }
}

/// The messages themselves are tested beside the readers; here, that the program shows each as one
/// error that names the file, and leaves nothing behind.
#[test]
fn every_bad_part_is_refused_by_name() {
    let out = tempfile::tempdir().unwrap();
    for (ending, least) in [("stl", 5), ("obj", 4), ("ply", 3), ("step", 2)] {
        for file in fixtures("part", ending, least) {
            let name = file.file_name().unwrap().to_str().unwrap();
            let folder = out.path().to_str().unwrap();
            let output = truecut(&["part", file.to_str().unwrap(), "--out", folder]);
            let report = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(BAD_INPUT), "{name}: {report}");
            assert_eq!(report.matches('×').count(), 1, "{name}: {report}");
            assert!(
                report.contains(name) && !report.contains("panicked"),
                "{report}"
            );
        }
    }
    assert_eq!(std::fs::read_dir(out.path()).unwrap().count(), 0);
}

/// Paths on faces and the programs that follow them; a fault in a file that the job names is told
/// with that file's line.
#[test]
fn every_bad_path_job_is_refused_with_place_value_and_rule() {
    let mut wrong = Vec::new();
    for file in fixtures("path", "toml", 28) {
        let complaints = complaints("path", &file);
        if !complaints.is_empty() {
            wrong.push(format!("{}: {}", file.display(), complaints.join("\n  ")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// Cells are read before the path that goes through them.
#[test]
fn every_bad_cell_is_refused_with_place_value_and_rule() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let robot = root.join("assets/robots/hp20/robot.urdf");
    let mut wrong = Vec::new();
    for file in fixtures("cell", "toml", 10) {
        let cell = file.to_str().unwrap();
        let command = [
            "path",
            "x.nc",
            "--robot",
            robot.to_str().unwrap(),
            "--cell",
            cell,
        ];
        let complaints = complaints_of(&command, &file);
        if !complaints.is_empty() {
            wrong.push(format!("{}: {}", file.display(), complaints.join("\n  ")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// The messages themselves are tested beside the readers, with their lines; here, that the program
/// shows each as one error at its place.
#[test]
fn every_bad_cam_file_and_robot_program_is_refused_at_its_line() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let robot = root.join("assets/robots/hp20/robot.urdf");
    let (robot, out) = (robot.to_str().unwrap(), tempfile::tempdir().unwrap());
    let place = ["--dialect", "krl", "--work-xyz-mm", "900,0,300", "--out"];
    let of_cam = ["nc", "apt", "csv"].map(|ending| ("path", "cam", ending));
    let endings = ["src", "script", "LS", "MOD", "JBI"];
    let of_programs = endings.map(|ending| ("program", "dialects", ending));
    for (command, folder, ending) in of_cam.into_iter().chain(of_programs) {
        for file in fixtures(folder, ending, 2) {
            let name = file.file_name().unwrap().to_str().unwrap();
            let mut arguments = vec![command, file.to_str().unwrap(), "--robot", robot];
            if command == "path" {
                arguments.extend(place);
                arguments.push(out.path().to_str().unwrap());
            }
            let output = truecut(&arguments);
            let report = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(BAD_INPUT), "{name}: {report}");
            let placed = report.contains(&format!("{name}:")) && !report.contains("panicked");
            assert!(
                placed && report.matches('×').count() == 1,
                "{name}: {report}"
            );
        }
    }
}
