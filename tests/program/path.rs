//! `truecut path` and `truecut program`: from a face to a robot program and back.

use std::path::{Path, PathBuf};

use super::{CLAIM_FAILED, Desk};

pub(super) fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .canonicalize()
        .unwrap()
}

/// The shipped job in the desk's folder, its paths made absolute, with some lines in the place of
/// others.
fn job(desk: &Desk, name: &str, changes: &[(&str, &str)]) -> String {
    let shipped = repository().join("scenarios/finishing/hub_spoke.toml");
    let mut text = std::fs::read_to_string(shipped).unwrap();
    text = text.replace("../..", repository().to_str().unwrap());
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let file = desk.path(&format!("{name}.toml"));
    std::fs::write(&file, text).unwrap();
    file.to_str().unwrap().to_owned()
}

pub(super) fn told(output: &std::process::Output) -> String {
    let (out, err) = (&output.stdout, &output.stderr);
    format!(
        "{}{}",
        String::from_utf8_lossy(out),
        String::from_utf8_lossy(err)
    )
}

pub(super) fn hp20() -> String {
    let urdf = repository().join("assets/robots/hp20/robot.urdf");
    urdf.to_str().unwrap().to_owned()
}

#[test]
fn a_spoke_becomes_a_job_that_leads_along_the_same_path() {
    let desk = Desk::new();
    let file = job(&desk, "spoke", &[]);
    let output = desk.truecut(&["path", &file]);
    assert!(output.status.success(), "{}", told(&output));
    for wanted in ["5 copies, brought by a turntable", "swath", "joint speed"] {
        assert!(
            told(&output).contains(wanted),
            "{wanted}:\n{}",
            told(&output)
        );
    }
    let svg = std::fs::read_to_string(desk.path("out/spoke/path.svg")).unwrap();
    assert!(svg.contains("Lines on the face") && !svg.contains("NaN"));
    let read = |more: &[&str]| {
        let robot = hp20();
        let head = ["program", "out/spoke/SPOKE.JBI", "--robot", &robot];
        desk.truecut(&[&head, more].concat())
    };
    let path = ["--path", "out/spoke/path.csv"];
    let good = read(&[&path[..], &["--pulses-per-deg", "1000"]].concat());
    assert!(good.status.success(), "{}", told(&good));
    assert!(
        told(&good).contains("✓ from the path at most"),
        "{}",
        told(&good)
    );
    // The turntable's pulses cannot be turned into an angle without their number; the job's line is
    // named.
    let without = read(&path);
    assert_eq!(without.status.code(), Some(super::BAD_INPUT));
    assert!(told(&without).contains("SPOKE.JBI:"), "{}", told(&without));
}

/// Of a joint whose speed limit nobody gives, nothing is said of how fast it is.
#[test]
fn a_joint_without_a_speed_limit_is_not_called_slow_enough() {
    let read_back = |limited: usize| {
        let desk = Desk::new();
        let known = std::fs::read_to_string(hp20()).unwrap();
        // Zero is what exporters write where nothing is known.
        let mut parts = known.split(" velocity=\"");
        let mut urdf = parts.next().unwrap().to_owned();
        for (joint, part) in parts.enumerate() {
            let (value, rest) = part.split_once('"').unwrap();
            let value = if joint < limited { value } else { "0" };
            urdf += &format!(" velocity=\"{value}\"{rest}");
        }
        std::fs::write(desk.path("robot.urdf"), urdf).unwrap();
        let known = repository().join("assets/robots/hp20/robot.toml");
        std::fs::copy(known, desk.path("robot.toml")).unwrap();
        let shipped = (
            "urdf = \"".to_owned() + &hp20(),
            format!("urdf = \"{}", desk.path("robot.urdf").display()),
        );
        let file = job(&desk, "spoke", &[(&shipped.0, &shipped.1)]);
        let planned = told(&desk.truecut(&["path", &file]));
        let robot = desk.path("robot.urdf").display().to_string();
        let shown = desk.truecut(&[
            "program",
            "out/spoke/SPOKE.JBI",
            "--robot",
            &robot,
            "--pulses-per-deg",
            "1000",
        ]);
        assert!(shown.status.success(), "{}", told(&shown));
        (planned, told(&shown))
    };
    let (planned, shown) = read_back(0);
    assert!(!planned.contains("joint speed "), "{planned}");
    assert!(
        shown.contains("speeds not judged since no joint has a speed limit"),
        "{shown}"
    );
    let (planned, shown) = read_back(2);
    assert!(planned.contains("joint speed "), "{planned}");
    assert!(
        shown.contains("none of the 2 joints with a speed limit too fast (4 without one)"),
        "{shown}"
    );
}

/// A position moved by 0.02 mm is found, with its path point.
#[test]
fn a_job_that_leaves_its_path_does_not_hold() {
    let desk = Desk::new();
    let file = job(&desk, "spoke", &[("step_mm = 2", "step_mm = 5")]);
    assert!(desk.truecut(&["path", &file]).status.success());
    let job = desk.path("out/spoke/SPOKE.JBI");
    let text = std::fs::read_to_string(&job).unwrap();
    let line = text
        .lines()
        .find(|line| line.starts_with("C00007="))
        .unwrap();
    let x = line["C00007=".len()..].split(',').next().unwrap();
    let moved = format!("{:.3}", x.parse::<f64>().unwrap() + 0.02);
    let changed = line.replacen(x, &moved, 1);
    std::fs::write(&job, text.replace(line, &changed)).unwrap();
    let robot = hp20();
    let output = desk.truecut(&[
        "program",
        "out/spoke/SPOKE.JBI",
        "--robot",
        &robot,
        "--pulses-per-deg",
        "1000",
        "--path",
        "out/spoke/path.csv",
    ]);
    assert_eq!(
        output.status.code(),
        Some(CLAIM_FAILED),
        "{}",
        told(&output)
    );
    assert!(
        told(&output).contains("✗ from the path at most, at path point 7"),
        "{}",
        told(&output)
    );
}

/// A face out of reach comes to no program, and that of an earlier place goes; a fault of the job
/// leaves it.
#[test]
fn a_job_out_of_reach_leaves_no_earlier_program() {
    let desk = Desk::new();
    let coarse = ("step_mm = 2", "step_mm = 5");
    let place = "xyz_mm = [1000, -100, 450]";
    let written = desk.path("out/spoke/SPOKE.JBI");
    let output = desk.truecut(&["path", &job(&desk, "spoke", &[coarse])]);
    assert!(output.status.success(), "{}", told(&output));
    assert!(written.is_file());

    let wrong = ("step_mm = 2", "step_mm = -2");
    let output = desk.truecut(&["path", &job(&desk, "spoke", &[wrong])]);
    let code = output.status.code();
    assert_eq!(code, Some(super::BAD_INPUT), "{}", told(&output));
    assert!(written.is_file(), "{}", told(&output));

    let far = (place, "xyz_mm = [4000, -100, 450]");
    let output = desk.truecut(&["path", &job(&desk, "spoke", &[coarse, far])]);
    let code = output.status.code();
    assert_eq!(code, Some(super::BAD_INPUT), "{}", told(&output));
    assert!(told(&output).contains("reach"), "{}", told(&output));
    assert!(!written.exists(), "{}", told(&output));
}

/// Taught points before the lines, the arm alone, an ABB arm's module: read back to the same path.
#[test]
fn a_module_with_taught_points_is_read_back() {
    let desk = Desk::new();
    std::fs::write(
        desk.path("edge.csv"),
        "j1,j2,j3,j4,j5,j6\n5,20,10,5,60,10\n6,21,11,5,61,10\n",
    )
    .unwrap();
    let irb = repository().join("assets/robots/irb6600_175_255/robot.urdf");
    let shipped =
        std::fs::read_to_string(repository().join("scenarios/finishing/hub_spoke.toml")).unwrap();
    let head = shipped.find("[symmetry]").unwrap();
    let mut text = shipped[..head].replace("../..", repository().to_str().unwrap());
    text = text
        .replace("hp20", "irb6600_175_255")
        .replace(
            "[-6.2, 6.516, -34.775, -3.616, -31.231, -80.996]",
            "[0, 20, 10, 0, 60, 0]",
        )
        .replace("[1000, -100, 450]", "[1500, -100, 900]")
        .replace("step_mm = 2", "step_mm = 5");
    text.push_str(
        "[[taught]]\nfile = \"edge.csv\"\nwhen = \"before\"\n\n[program]\ndialect = \"rapid\"\nname = \"Spoke\"\n",
    );
    let file = desk.path("spoke.toml");
    std::fs::write(&file, text).unwrap();
    let output = desk.truecut(&["path", file.to_str().unwrap()]);
    assert!(output.status.success(), "{}", told(&output));
    assert!(
        told(&output).contains("2 taught postures a copy"),
        "{}",
        told(&output)
    );
    let csv = std::fs::read_to_string(desk.path("out/spoke/path.csv")).unwrap();
    let first = csv.lines().nth(1).unwrap();
    assert!(
        first.contains(",5.000000,20.000000,10.000000,5.000000,60.000000,10.000000,"),
        "{first}"
    );
    let output = desk.truecut(&[
        "program",
        "out/spoke/Spoke.mod",
        "--robot",
        irb.to_str().unwrap(),
        "--path",
        "out/spoke/path.csv",
    ]);
    assert!(output.status.success(), "{}", told(&output));
}

/// Every key of the path changes the path; the limit of the edge gap, which nothing here comes
/// near, is met by a job that is refused.
#[test]
fn what_the_path_says_changes_the_program() {
    let desk = Desk::new();
    let coarse = ("step_mm = 2", "step_mm = 10");
    let free = ("tool_number = 1", "tool_number = 1\nlargest_step_deg = 40");
    let wide = ("edge_gap_limit_mm = 1.0", "edge_gap_limit_mm = 3.0");
    let csv = |name: &str, change: (&str, &str)| {
        let file = job(&desk, name, &[coarse, free, wide, change]);
        let output = desk.truecut(&["path", &file]);
        assert!(output.status.success(), "{name}: {}", told(&output));
        std::fs::read_to_string(desk.path(&format!("out/{name}/path.csv"))).unwrap()
    };
    let plain = csv("plain", ("overlap = 0.2", "overlap = 0.2"));
    let changes = [
        (
            "along",
            ("overlap = 0.2", "overlap = 0.2\nfeed_along = \"v\""),
        ),
        ("overlap", ("overlap = 0.2", "overlap = 0.4")),
        ("margin", ("lift_mm = 30", "lift_mm = 30\nmargin_mm = 3")),
        ("lift", ("lift_mm = 30", "lift_mm = 20")),
        ("feed", ("feed_mm_per_s = 40", "feed_mm_per_s = 30")),
        (
            "load",
            ("line_load_n_per_mm = 1.2", "line_load_n_per_mm = 2.4"),
        ),
        ("modulus", ("modulus_mpa = 8", "modulus_mpa = 4")),
        ("pressed", ("indentation_mm = 0.5", "indentation_mm = 0.6")),
        ("radius", ("radius_mm = 40", "radius_mm = 35")),
        ("width", ("width_mm = 25", "width_mm = 20")),
        (
            "speed",
            ("tool_number = 1", "tool_number = 1\njoint_speed = 0.5"),
        ),
        (
            "turned",
            (
                "xyz_mm = [1000, -100, 450]",
                "xyz_mm = [1000, -100, 450]\nrpy_deg = [0, 5, 0]",
            ),
        ),
        (
            "planes",
            (
                "strategy = \"iso_parametric\"",
                "strategy = \"parallel_plane\"\nplane_normal = [0.1, 1, 0]",
            ),
        ),
        (
            "ridges",
            (
                "strategy = \"iso_parametric\"",
                "strategy = \"iso_scallop\"\nscallop_mm = 0.2",
            ),
        ),
    ];
    for (name, change) in changes {
        assert_ne!(csv(name, change), plain, "{name}");
    }
}

#[test]
fn the_schema_of_the_path_job_is_printed() {
    let output = Desk::new().truecut(&["schema", "--path"]);
    let schema: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(schema["title"], "truecut path job");
    assert!(schema.pointer("/properties/wheel").is_some());
}

/// What is told of a part as JSON names the viewer's file, which is there.
#[test]
fn a_part_in_json_names_its_drawing() {
    let desk = Desk::new();
    let file = repository().join("assets/surfaces/crowned_block.obj");
    let output = desk.truecut(&["part", file.to_str().unwrap(), "--json"]);
    assert!(output.status.success(), "{}", told(&output));
    let part: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(part["faces"].as_array().unwrap().len(), 6);
    assert!(desk.path(part["rrd"].as_str().unwrap()).is_file(), "{part}");
}

/// Every shipped path job is planned, and its program leads along its path.
#[test]
fn shipped_path_jobs_are_planned_and_read_back() {
    let desk = Desk::new();
    let jobs = [
        ("hub_spoke", "SPOKE.JBI", &["--pulses-per-deg", "1000"][..]),
        ("mould_top", "MOULD.JBI", &[]),
        ("crowned_block", "CROWN.JBI", &[]),
    ];
    for (name, program, more) in jobs {
        let file = repository().join(format!("scenarios/finishing/{name}.toml"));
        let output = desk.truecut(&["path", file.to_str().unwrap()]);
        assert!(output.status.success(), "{}", told(&output));
        let (program, path) = (
            format!("out/{name}/{program}"),
            format!("out/{name}/path.csv"),
        );
        let robot = hp20();
        let head = ["program", &program, "--robot", &robot, "--path", &path];
        let output = desk.truecut(&[&head, more].concat());
        assert!(output.status.success(), "{}", told(&output));
        let held = "✓ within limits, clear of singularities";
        assert!(told(&output).contains(held), "{}", told(&output));
    }
}

/// A pocket in G-code becomes a program in each language, and leads along the same path.
#[test]
fn a_cam_file_becomes_a_program_in_every_language() {
    let desk = Desk::new();
    let file = repository().join("tests/crosscheck/cam/pocket_mill.nc");
    let (file, robot) = (file.to_str().unwrap(), hp20());
    for (dialect, written, options) in [
        (
            "jbi",
            "POCKETMI.JBI",
            &["--option", "date=2026-01-31 12:00"][..],
        ),
        ("rapid", "POCKETMI.mod", &[]),
        ("krl", "POCKETMI.src", &[]),
        ("urscript", "POCKETMI.script", &[]),
        ("ls", "POCKETMI.LS", &["--option", "tool_number=2"]),
    ] {
        let place = ["--robot", &robot, "--work-xyz-mm", "900,0,350"];
        let head = ["path", file, "--dialect", dialect, "--out", dialect];
        let output = desk.truecut(&[&head, &place[..], options].concat());
        assert!(output.status.success(), "{dialect}: {}", told(&output));
        assert!(told(&output).contains("line 6: G28"), "{}", told(&output));
        let folder = format!("{dialect}/pocket_mill");
        let (program, path) = (format!("{folder}/{written}"), format!("{folder}/path.csv"));
        let text = std::fs::read_to_string(desk.path(&program)).unwrap();
        let says = text.to_lowercase().contains("not loaded on a controller");
        assert!(says, "{dialect}");
        assert!(desk.path(&format!("{folder}/path.rrd")).exists());
        let output = desk.truecut(&["program", &program, "--robot", &robot, "--path", &path]);
        assert!(output.status.success(), "{dialect}: {}", told(&output));
        let foreign = told(&output).contains("named as an arm that is programmed in jbi");
        assert_eq!(foreign, dialect != "jbi", "{}", told(&output));
    }
}
