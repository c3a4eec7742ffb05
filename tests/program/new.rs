//! Scenarios to begin with.

use std::path::PathBuf;

use super::Desk;

fn robot(name: &str) -> String {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    folder
        .join(name)
        .join("robot.urdf")
        .canonicalize()
        .unwrap()
        .display()
        .to_string()
}

/// What a tool does on an arm: written, read back without a fault, run to its end.
#[test]
fn every_scenario_to_begin_with_runs_on_arms_of_two_makers() {
    let desk = Desk::new();
    for arm in ["irb6600_175_255", "hp20"] {
        for process in ["load", "chamfer", "milling", "polish"] {
            let (file, urdf) = (format!("{arm}_{process}.toml"), robot(arm));
            let said = desk.ends(0, &["new", process, "--robot", &urdf, "-o", &file]);
            assert!(said.contains(&format!("truecut run {file}")), "{said}");
            let output = desk.truecut(&["run", &file, "--no-rrd"]);
            let (out, code) = (
                String::from_utf8_lossy(&output.stdout),
                output.status.code(),
            );
            // Its claims ask for what the user is to say.
            assert!(matches!(code, Some(0 | 1)), "{file}: {code:?} {out}");
            assert!(out.contains("completed"), "{file}: {out}");
        }
    }
}

/// Two axes, a quill and a flange that hangs head down, as the file of such an arm has it; the tool
/// points where `roll` turns it, and the quill begins at `up`, m.
fn scara(desk: &Desk, roll: &str, up: f64) -> String {
    let inertia = |mass: f64, far: f64| {
        let (slim, wide) = (mass * 1e-3, mass * (1e-3 + far * far / 3.0));
        format!(
            "<inertial><origin xyz=\"{far} 0 0\"/><mass value=\"{mass}\"/><inertia ixx=\"{slim}\" \
             iyy=\"{wide}\" izz=\"{wide}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>"
        )
    };
    let mut text = "<robot name=\"scara\"><link name=\"l0\"/>".to_owned();
    for (at, (kind, xyz, axis, range, effort, mass, far)) in [
        (
            "revolute",
            "0 0 0.42",
            "0 0 1",
            (-2.3, 2.3),
            300.0,
            7.0,
            0.17,
        ),
        (
            "revolute",
            "0.35 0 0",
            "0 0 1",
            (-2.5, 2.5),
            150.0,
            5.0,
            0.14,
        ),
        (
            "prismatic",
            "0.27 0 0",
            "0 0 -1",
            (up, 0.21),
            900.0,
            1.6,
            0.0,
        ),
        (
            "revolute",
            "0 0 -0.1",
            "0 0 -1",
            (-6.2, 6.2),
            40.0,
            0.4,
            0.0,
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let (low, high) = range;
        text += &format!(
            "<link name=\"l{0}\">{1}</link><joint name=\"j{0}\" type=\"{kind}\"><parent \
             link=\"l{at}\"/><child link=\"l{0}\"/><origin xyz=\"{xyz}\"/><axis xyz=\"{axis}\"/><limit \
             lower=\"{low}\" upper=\"{high}\" effort=\"{effort}\" velocity=\"3\"/></joint>",
            at + 1,
            inertia(mass, far)
        );
    }
    std::fs::write(desk.path("scara.urdf"), text + "</robot>").unwrap();
    desk.ends(
        0,
        &["robot", "init", "scara.urdf", "--payload", "6", "--force"],
    );
    let config = std::fs::read_to_string(desk.path("robot.toml")).unwrap();
    let straight = "[frames.tool]\nxyz_m = [0.0, 0.0, 0.0]\nrpy_deg = [0.0";
    assert!(config.contains(straight), "{config}");
    let turned = straight.replace("rpy_deg = [0.0", &format!("rpy_deg = [{roll}"));
    let config = config.replacen(straight, &turned, 1);
    std::fs::write(desk.path("robot.toml"), config).unwrap();
    "scara.urdf".to_owned()
}

/// Slides are given in mm beside the angles, and a tool that never points down is told.
#[test]
fn an_arm_with_a_slide_has_scenarios_to_begin_with() {
    let desk = Desk::new();
    let urdf = scara(&desk, "180.0", 0.0);
    for process in ["load", "chamfer", "milling"] {
        let file = format!("{process}.toml");
        desk.ends(0, &["new", process, "--robot", &urdf, "-o", &file]);
        let output = desk.truecut(&["run", &file, "--no-rrd"]);
        let out = String::from_utf8_lossy(&output.stdout);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{file}: {out}");
        assert!(out.contains("completed"), "{file}: {out}");
    }
    // Half a turn as it is written to nine digits: the arm reaches the exact attitude alone.
    let pose = "0.5,0.1,0.2,3.14159265,0,0";
    let rows = desk.ends(0, &["robot", &urdf, "--ik", pose, "--slide-mm", "120"]);
    assert!(rows.lines().count() > 1, "{rows}");
    let call = ["new", "polish", "--robot", &urdf, "-o", "polish.toml"];
    let told = "polishing leans the wheel and leads the lean round, but the tool's z axis is (";
    desk.refused(&call, &[told, "-1.000) in every posture"]);
    let given = ["--posture-deg", "10,40,120,-5"];
    let call = ["new", "load", "--robot", &urdf, "-o", "own.toml"];
    desk.ends(0, &[&call[..], &given].concat());
    let text = std::fs::read_to_string(desk.path("own.toml")).unwrap();
    assert!(text.contains("posture_deg = [10.0, 40.0, -5.0]"), "{text}");
    assert!(text.contains("posture_mm = [120.0]"), "{text}");
    let urdf = scara(&desk, "0.0", 0.0);
    let call = ["new", "milling", "--robot", &urdf, "-o", "up.toml"];
    let told = "its z axis is (0.000, 0.000, 1.000) in every posture";
    desk.refused(&call, &[told, "[frames.tool] in robot.toml"]);
}

/// Where a place leads the tool, what cannot stand at zero begins in the middle of its range.
#[test]
fn an_arm_that_cannot_stand_at_zero_begins_within_its_limits() {
    let desk = Desk::new();
    let urdf = scara(&desk, "180.0", 0.05);
    let call = ["new", "milling", "--robot", &urdf, "-o", "milling.toml"];
    desk.ends(0, &call);
    let text = std::fs::read_to_string(desk.path("milling.toml")).unwrap();
    assert!(text.contains("posture_mm = [130.0]"), "{text}");
    let output = desk.truecut(&["run", "milling.toml", "--no-rrd"]);
    let out = String::from_utf8_lossy(&output.stdout);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{out}");
    assert!(out.contains("completed"), "{out}");
    // Slides are lengths in what is told of their posture, and in what is written.
    let call = ["lobes", "milling.toml", "--size", "4", "--runs", "0"];
    let told = desk.ends(0, &call);
    let line = told
        .lines()
        .find(|line| line.trim_start().starts_with("posture "));
    let (angles, places) = line.unwrap().split_once(" deg; slides ").unwrap();
    assert_eq!(angles.split(", ").count(), 3, "{told}");
    let place_mm: f64 = places.strip_suffix(" mm").unwrap().parse().unwrap();
    assert!((50.0..=210.0).contains(&place_mm), "{told}");
    let json = std::fs::read_to_string(desk.path("out/milling/lobes.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["posture_rad"].as_array().unwrap().len(), 3, "{json}");
    let place_m = json["posture_m"][0].as_f64().unwrap();
    assert!((1e3 * place_m - place_mm).abs() < 0.006, "{json}");
}

#[test]
fn what_is_given_is_taken() {
    let desk = Desk::new();
    let urdf = robot("hp20");
    let call = [
        "new",
        "load",
        "--robot",
        &urdf,
        "--posture-deg",
        "0,20,-20,0,-50,0",
        "--name",
        "Mine",
    ];
    desk.ends(0, &call);
    let text = std::fs::read_to_string(desk.path("scenario.toml")).unwrap();
    assert!(
        text.contains("name = \"Mine\"") && text.contains("[0.0, 20.0, -20.0, 0.0, -50.0, 0.0]"),
        "{text}"
    );
    // What is there is kept.
    desk.refused(&call, &["scenario.toml is there already", "--out"]);
    let rig = robot("ur10e");
    for (process, urdf, given, said) in [
        (
            "load",
            &urdf,
            &["--place-mm", "1,2,3"][..],
            "--place-mm has no effect",
        ),
        (
            "polish",
            &urdf,
            &["--posture-deg", "1,2,3"],
            "--posture-deg has no effect",
        ),
        ("polish", &urdf, &["--place-mm", "1,2"], "must have three"),
        (
            "polish",
            &urdf,
            &["--place-mm", "9000,0,0"],
            "out of reach at (9, 0",
        ),
        (
            "load",
            &urdf,
            &["--posture-deg", "1,2"],
            "has 2 values, but the chain has 6 joints, slides included",
        ),
        ("load", &"none.urdf".to_owned(), &[], "none.urdf"),
        ("load", &rig, &[], "truecut robot init"),
    ] {
        let call = [&["new", process, "--robot", urdf, "-o", "a"], given].concat();
        desk.refused(&call, &[said]);
        assert!(!desk.path("a").exists(), "{call:?}");
    }
}

/// Arguments of the robot's file stand in the scenario, which reads the same robot.
#[test]
fn arguments_of_a_xacro_file_go_into_the_scenario() {
    let desk = Desk::new();
    let own = PathBuf::from(robot("rig_1dof"));
    let text = std::fs::read_to_string(&own).unwrap();
    let text = text.replacen(
        "<robot name=\"rig_1dof\">",
        "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" name=\"rig_1dof\">\
         <xacro:arg name=\"mass\" default=\"100\"/>",
        1,
    );
    let text = text.replacen("name=\"carriage\"", "name=\"$(arg side)\"", 1);
    let text = text.replace("link=\"carriage\"", "link=\"$(arg side)\"");
    std::fs::write(desk.path("rig.xacro"), text).unwrap();
    std::fs::copy(own.with_file_name("robot.toml"), desk.path("robot.toml")).unwrap();
    let call = ["new", "load", "--robot", "rig.xacro"];
    desk.refused(
        &call,
        &["\"side\"", "--arg side=VALUE", "`arguments` of [robot]"],
    );
    let unknown = ["--arg", "side=left", "--arg", "mas=50"];
    desk.refused(&[&call[..], &unknown].concat(), &["did you mean \"mass\"?"]);
    let given = ["--arg", "side=left", "--arg", "mass=50"];
    desk.ends(0, &[&call[..], &given].concat());
    let scenario = std::fs::read_to_string(desk.path("scenario.toml")).unwrap();
    let key = "\narguments = { \"mass\" = \"50\", \"side\" = \"left\" }\n";
    assert!(scenario.contains(key), "{scenario}");
    // What lies beside the scenario goes with it.
    assert!(scenario.contains("\nurdf = 'rig.xacro'\n"), "{scenario}");
    desk.refused(
        &["run", "scenario.toml", "--set", "robot.arguments.mas=50"],
        &["did you mean \"mass\"?", "(given by --set)"],
    );
}
