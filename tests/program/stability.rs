//! `truecut lobes` and `truecut posture`: what they print and write, and that a plan can be run.

use std::path::Path;

use super::Desk;

const PATH_600: &str = "scenarios/milling/path_600.toml";

fn repository() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .canonicalize()
        .unwrap()
}

/// Runs the program, which must end well, and gives what it printed.
fn told(desk: &Desk, arguments: &[&str]) -> String {
    let output = desk.truecut(arguments);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    let report = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}:\n{told}{report}");
    told
}

#[test]
fn lobes_draws_tabulates_and_runs() {
    let desk = Desk::new();
    let example = repository().join(PATH_600);
    let range = ["--rpm", "400,700", "--deepest", "0.4"];
    let size = ["--size", "12", "--runs", "2"];
    let arguments = [&["lobes", example.to_str().unwrap()][..], &range, &size].concat();
    let printed = told(&desk, &arguments);
    // The same at speeds of the diagram that leave it out.
    let coarse = [
        "--rpm",
        "100,250",
        "--deepest",
        "0.4",
        "--size",
        "3",
        "--runs",
        "0",
    ];
    let out = ["--out", "out/coarse"];
    let elsewhere = told(&desk, &[&arguments[..2], &coarse, &out].concat());
    let own = |text: &str| -> String {
        let line = text
            .lines()
            .find(|line| line.contains("limits at 600.0 rpm"));
        line.unwrap().to_owned()
    };
    assert_eq!(own(&printed), own(&elsewhere));
    for wanted in [
        "limits at 600.0 rpm",
        "2 of 2 runs do what the theory says",
        "mode coupling",
    ] {
        assert!(printed.contains(wanted), "{wanted}:\n{printed}");
    }
    let folder = desk.path("out/path_600");
    let names = [
        "lobes.svg",
        "lobes.rrd",
        "lobes.parquet",
        "lobes_limits.parquet",
        "lobes_runs.parquet",
        "lobes.json",
    ];
    for name in names {
        assert!(folder.join(name).is_file(), "{name}");
    }
    let limits = truecut_telemetry::read_table(&folder.join("lobes_limits.parquet"), true).unwrap();
    let column = |name: &str| {
        let index = limits.columns.iter().position(|c| c.name == name);
        limits.columns[index.unwrap_or_else(|| panic!("{name}"))]
            .values
            .clone()
    };
    let json = std::fs::read_to_string(folder.join("lobes.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let speeds = json["speeds"].as_array().unwrap();
    let [depths, errors] = ["limit_depth", "limit_error"].map(column);
    for (i, at) in speeds.iter().enumerate() {
        let same = |json: &serde_json::Value, mm: f64| match json.as_f64() {
            Some(m) => (m * 1e3 - mm).abs() <= 1e-12 * mm,
            None => mm.is_nan(),
        };
        assert!(same(&at["limit"]["depth_m"], depths[i]), "{at}");
        assert!(same(&at["limit_error_m"], errors[i]), "{at}");
    }
    assert_eq!(speeds.len(), depths.len());
    assert_eq!(json["runs"].as_array().unwrap().len(), 2);
    // Four teeth in a slot: zero order is exact.
    let pairs = column("limit_depth")
        .into_iter()
        .zip(column("zero_order_depth"));
    let both: Vec<(f64, f64)> = pairs
        .filter(|(a, b)| a.is_finite() && b.is_finite())
        .collect();
    assert!(both.len() > 6, "{both:?}");
    assert!(
        both.iter().all(|(a, b)| (a / b - 1.0).abs() < 0.01),
        "{both:?}"
    );
}

/// Along a path from CAM the keys that are told make a scenario that runs, and options of straight
/// cuts are refused.
#[test]
fn a_posture_along_a_path_can_be_taken() {
    let desk = Desk::new();
    let example = repository().join("scenarios/milling/pocket.toml");
    let name = example.to_str().unwrap();
    let printed = told(&desk, &["posture", name, "--runs", "1"]);
    for wanted in [
        "best posture",
        "scenario's own",
        "in the best posture",
        "completed",
    ] {
        assert!(printed.contains(wanted), "{wanted}:\n{printed}");
    }
    assert!(!printed.contains("as the scenario has it"), "{printed}");
    // Tool modes limit this cut, which no posture changes.
    assert!(
        printed.contains("no turn is better than the scenario's own"),
        "{printed}"
    );
    assert!(!printed.contains("To take the best posture"), "{printed}");
    let at = desk.path("out/pocket/posture.json");
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(at).unwrap()).unwrap();
    let keys = json["keys"].as_object().unwrap();
    assert!(
        keys.contains_key("process.path_milling.path.spin_deg"),
        "{keys:?}"
    );
    let mut call = vec!["run".to_owned(), name.to_owned(), "--no-rrd".to_owned()];
    for (key, value) in keys {
        call.extend([
            "--set".to_owned(),
            format!("{key}={}", value.as_str().unwrap()),
        ]);
    }
    let call: Vec<&str> = call.iter().map(String::as_str).collect();
    told(&desk, &call);
    desk.refused(
        &["posture", name, "--maps"],
        &["--maps is for [process.milling]"],
    );
    let straight = repository().join(PATH_600);
    let straight = straight.to_str().unwrap();
    desk.refused(
        &["posture", straight, "--runs", "1"],
        &["--runs is for milling along a path"],
    );
}

#[test]
fn posture_writes_a_scenario_that_runs() {
    let desk = Desk::new();
    let example = repository().join(PATH_600);
    let name = example.to_str().unwrap();
    let printed = told(&desk, &["posture", name, "--criterion", "mode-coupling"]);
    for wanted in [
        "planned by 6-DoF mode coupling: stable all along",
        "not by each criterion, though: planar flutter (",
        "6-DoF mode coupling (planned by)",
        "truecut run",
    ] {
        assert!(printed.contains(wanted), "{wanted}:\n{printed}");
    }
    let folder = desk.path("out/path_600");
    for name in [
        "posture.svg",
        "posture.rrd",
        "posture.parquet",
        "posture_map.parquet",
    ] {
        assert!(folder.join(name).is_file(), "{name}");
    }
    // The shipped scenario claims that it chatters; planned, it does not, and says so.
    let planned = folder.join("path_600_planned.toml");
    let arguments = [
        "run",
        planned.to_str().unwrap(),
        "--no-rrd",
        "--set",
        "run.duration_s=3",
    ];
    let output = desk.truecut(&arguments);
    let printed = String::from_utf8_lossy(&output.stdout);
    let report = String::from_utf8_lossy(&output.stderr);
    assert_eq!(
        output.status.code(),
        Some(super::CLAIM_FAILED),
        "{printed}{report}"
    );
    assert!(
        printed.contains("✗") && printed.contains("chatters"),
        "{printed}"
    );
}

/// A diagram that would begin where no limit is known would be empty.
#[test]
fn a_range_beyond_what_is_known_is_refused() {
    let desk = Desk::new();
    let own_surface = repository().join("scenarios/milling/own_surface.toml");
    let name = own_surface.to_str().unwrap();
    let output = desk.truecut(&["lobes", name, "--rpm", "1e9,2e9", "--set", SLOW]);
    let report = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(super::BAD_INPUT), "{report}");
    assert!(
        report.contains("--rpm begins at 1000000000 rpm"),
        "{report}"
    );
}

/// Without modes of the tool a diagram ends where those of the arm do; both dampings are told.
#[test]
fn lobes_say_what_is_missing_above_the_modes_of_the_arm() {
    let desk = Desk::new();
    let own_surface = repository().join("scenarios/milling/own_surface.toml");
    let arguments = [
        "lobes",
        own_surface.to_str().unwrap(),
        "--rpm",
        "1500,12000",
        "--size",
        "8",
        "--runs",
        "0",
    ];
    let printed = told(&desk, &[&arguments[..], &["--set", SLOW]].concat());
    for wanted in ["limits at 1500 rpm: spectral", "% in every mode of the arm"] {
        assert!(printed.contains(wanted), "{wanted}:\n{printed}");
    }
    let fast = [
        "--set",
        "process.milling.spindle_rpm=12000",
        "--set",
        "robot.damping_ratio=[0.02]",
    ];
    let printed = told(&desk, &[&arguments[..], &fast].concat());
    for wanted in [
        "limits at 12000 rpm: not known",
        "above 2569 rpm teeth pass at more than twice the frequency of the fastest mode, 85.6 Hz",
        "[[process.milling.cutter.mode]]",
    ] {
        assert!(printed.contains(wanted), "{wanted}:\n{printed}");
    }
}

/// The shipped path with the stiffness of two joints uncertain.
fn uncertain(desk: &Desk) -> std::path::PathBuf {
    let assets = repository().join("assets");
    let text = std::fs::read_to_string(repository().join(PATH_600)).unwrap();
    let mut text = text.replace("../../assets", assets.to_str().unwrap());
    for (index, joint) in ["joint_1", "joint_2"].iter().enumerate() {
        text += &format!(
            "\n[[robot.joint]]\nname = \"{joint}\"\nstiffness_factor = 1.0\n\
             [[uncertain]]\nkey = \"robot.joint.{index}.stiffness_factor\"\nrelative = 0.2\n"
        );
    }
    let at = desk.path("uncertain.toml");
    std::fs::write(&at, text).unwrap();
    at
}

#[test]
fn what_is_uncertain_is_drawn() {
    let desk = Desk::new();
    let scenario = uncertain(&desk);
    let name = scenario.to_str().unwrap();
    let lobes = [
        "lobes", name, "--rpm", "500,600", "--size", "2", "--runs", "0",
    ];
    let printed = told(&desk, &lobes);
    let report = |file: &str| -> serde_json::Value {
        let text = std::fs::read_to_string(desk.path("out/uncertain").join(file)).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let json = report("lobes.json");
    let own = &json["uncertain"]["own"];
    let ordered = |spread: &serde_json::Value| {
        let values = ["low", "median", "high"].map(|key| spread[key].as_f64().unwrap());
        assert!(values.is_sorted() && values[0] < values[2], "{spread}");
    };
    ordered(own);
    let percent = 100.0 * own["probability_stable"].as_f64().unwrap();
    let wanted = truecut_recording::significant(percent, 3);
    for wanted in [
        &format!("stable with a probability of {wanted} %"),
        "uncertain: robot.joint.0.stiffness_factor, robot.joint.1.stiffness_factor (",
    ] {
        assert!(printed.contains(wanted), "{wanted}:\n{printed}");
    }
    json["uncertain"]["speeds"]
        .as_array()
        .unwrap()
        .iter()
        .for_each(ordered);
    let plan = ["posture", name, "--criterion", "mode-coupling"];
    let printed = told(&desk, &plan);
    let json = report("posture_uncertain.json");
    for list in ["plan", "own", "angles_at_mid_path"] {
        let list = json[list].as_array().unwrap();
        assert!(list.len() > 10, "{json}");
    }
    assert!(
        printed.contains("angles at mid-path that are stable"),
        "{printed}"
    );
}

const SLOW: &str = "process.milling.spindle_rpm=1500";
