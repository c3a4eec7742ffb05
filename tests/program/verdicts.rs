//! Verdicts that a pipeline can trust: each way in which a run ends, in exit code, table, JUnit and
//! summary.

use std::path::Path;

use crate::{BAD_INPUT, CLAIM_FAILED, DIVERGED, Desk, claim};

const OVERLOADED: i32 = 6;
const PLACEHOLDERS: i32 = 7;
const BEYOND_MODEL: i32 = 8;

/// A desk with a scenario of every kind in `all`; the slide's drive gives 20 kN. A load of 30 kN
/// that is there at once swings nearly as far again beyond its rest: 3 times 20 kN less what half a
/// period of damping takes.
fn desk() -> Desk {
    let desk = Desk::new();
    std::fs::create_dir_all(desk.path("all")).unwrap();
    let swings = claim("swings", "min = 1");
    desk.scenario("all/good", "duration_s = 0.1", &swings);
    let still = claim("stands still", "max = 0");
    desk.scenario("all/fails", "duration_s = 0.1", &still);
    desk.scenario("all/overloaded", "duration_s = 0.1", &swings);
    change(
        &desk,
        "all/overloaded",
        "release_n = [100",
        "constant_n = [30000",
    );
    desk.scenario("all/diverges", "duration_s = 60", &swings);
    change(
        &desk,
        "all/diverges",
        "release_n = [100",
        "constant_n = [5000",
    );
    change(&desk, "all/diverges", "[run]", "drive = \"force\"\n[run]");
    std::fs::write(desk.path("all/bad.toml"), "[process.load]\nfrom = 1\n").unwrap();
    desk
}

fn change(desk: &Desk, name: &str, from: &str, to: &str) {
    let path = desk.path(&format!("{name}.toml"));
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{text}");
    std::fs::write(path, text.replace(from, to)).unwrap();
}

/// The test case of a scenario's run in a JUnit file.
fn run_case<'a>(junit: &'a str, name: &str) -> &'a str {
    let start = junit
        .find(&format!("name=\"Rig {name} runs\""))
        .expect(name);
    let rest = &junit[start..];
    &rest[..rest.find("<testcase").unwrap_or(rest.len())]
}

#[test]
fn every_end_of_a_run_has_its_exit_code_and_its_mark_in_one_check() {
    let desk = desk();
    let codes = [
        ("good", 0),
        ("fails", CLAIM_FAILED),
        ("overloaded", OVERLOADED),
        ("diverges", DIVERGED),
        ("bad", BAD_INPUT),
    ];
    for (name, code) in codes {
        let file = format!("all/{name}.toml");
        desk.ends(code, &["run", &file, "--no-rrd"]);
        desk.ends(code, &["check", &file]);
    }
    let out = desk.ends(BAD_INPUT, &["check", "all", "--out", "kept"]);
    assert!(out.contains("1 of 5 scenarios hold"), "{out}");
    assert!(out.contains("what failed is in kept"), "{out}");
    assert!(
        out.contains("overloaded a drive: joint `slide` is asked for 2.9"),
        "{out}"
    );
    let junit = std::fs::read_to_string(desk.path("out/junit.xml")).unwrap();
    for (name, marks) in [
        ("all/good", ["", ""]),
        ("all/fails", ["", ""]),
        ("all/overloaded", ["<failure", "overloaded a drive"]),
        ("all/diverges", ["<failure", "diverged"]),
    ] {
        let case = run_case(&junit, name);
        assert_eq!(case.contains("<failure"), !marks[0].is_empty(), "{case}");
        assert!(marks.iter().all(|mark| case.contains(mark)), "{case}");
    }
    assert!(junit.contains("errors=\"1\""), "{junit}");
    for (name, is_kept) in [("good", false), ("fails", true), ("overloaded", true)] {
        for file in ["summary.json", "recording.parquet", "recording.rrd"] {
            let path = desk.path("kept/all").join(name).join(file);
            assert_eq!(path.is_file(), is_kept, "{}", path.display());
        }
    }
    let summary = std::fs::read_to_string(desk.path("kept/all/overloaded/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let outcome = &summary["outcome"]["overloaded"];
    assert_eq!(outcome["joint"], "slide");
    let share = outcome["share"].as_f64().unwrap();
    assert!((2.8..3.0).contains(&share), "{share}");
    assert_eq!(outcome["limit"], "20000 N");
}

#[test]
fn an_overload_is_told_but_does_not_fail_where_the_scenario_says_so() {
    let desk = desk();
    let warn = ["--set", "run.overload=warn"];
    let run = ["run", "all/overloaded.toml", "--no-rrd"];
    let out = desk.ends(0, &[&run[..], &warn].concat());
    assert!(out.contains("DRIVE OVERLOADED: 2.9"), "{out}");
    desk.ends(0, &[&["check", "all/overloaded.toml"], &warn[..]].concat());
    // A claim of an overloaded run still has its number.
    let out = desk.ends(OVERLOADED, &run);
    assert!(out.contains("✓ swings"), "{out}");
}

/// A force F that is there at once winds a spring k up to (F/k)(1 + exp(-πζ/√(1 - ζ²))): 1.939 mm
/// of the rig's slide under 1 kN, ζ = 0.02.
#[test]
fn verify_a_spring_wound_up_beyond_its_range_is_beyond_the_model() {
    let desk = desk();
    let zeta: f64 = 0.02;
    let swing_m = 1e-3 * (1.0 + (-std::f64::consts::PI * zeta / (1.0 - zeta * zeta).sqrt()).exp());
    let rig = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/rig_1dof/robot.toml");
    let rig = std::fs::read_to_string(rig).unwrap();
    for (name, share, code) in [("within", 1.01, 0), ("beyond", 0.99, BEYOND_MODEL)] {
        let range = format!("linear_to_m = {:?}", share * swing_m);
        let text = rig.replace("linear_to_m = 1.0", &range);
        std::fs::write(desk.path(&format!("{name}_robot.toml")), text).unwrap();
        desk.scenario(name, "duration_s = 0.1", "");
        change(&desk, name, "release_n = [100", "constant_n = [1000");
        let config = format!("config = '{name}_robot.toml'\n[run]");
        change(&desk, name, "[run]", &config);
        let out = desk.ends(code, &["run", &format!("{name}.toml"), "--no-rrd"]);
        let summary = std::fs::read_to_string(desk.path(&format!("out/{name}/summary.json")));
        let summary: serde_json::Value = serde_json::from_str(&summary.unwrap()).unwrap();
        let outcome = &summary["outcome"]["beyond_model"];
        assert_eq!(outcome.is_null(), code == 0, "{summary}");
        if code != 0 {
            let found = outcome["value"].as_f64().unwrap();
            assert!((found / swing_m - 1.0).abs() < 1e-3, "{found}");
            assert!(
                out.contains("the wind-up of joint `slide`") && out.contains("linear_to_m"),
                "{out}"
            );
        }
    }
}

#[test]
fn rows_of_a_sweep_say_where_a_drive_is_overloaded() {
    let desk = desk();
    desk.scenario("sweep", "duration_s = 0.1", "");
    change(&desk, "sweep", "release_n = [100", "constant_n = [10000");
    let path = desk.path("sweep.toml");
    let mut text = std::fs::read_to_string(&path).unwrap();
    text.push_str(
        "[[sweep.axis]]\nkey = \"process.load.constant_n.0\"\nvalues = [10000, 30000]\n\
         [[sweep.column]]\nname = \"way\"\nmetric = \"peak\"\nchannel = \"tool.displacement_x\"\nunit = \"mm\"\n",
    );
    std::fs::write(&path, text).unwrap();
    let out = desk.ends(OVERLOADED, &["run", "sweep.toml"]);
    assert!(out.contains("2 rows, ✗ 1 overloaded"), "{out}");
    assert!(out.contains("30000: overloaded a drive"), "{out}");
    desk.ends(OVERLOADED, &["check", "sweep.toml"]);
}

/// What is meant to be a scenario is never left out in silence: a misspelt process, a syntax error
/// anywhere, a file that is no text. What is of another kind is said.
#[test]
fn a_folder_keeps_no_broken_scenario_from_its_verdict() {
    let desk = Desk::new();
    std::fs::create_dir_all(desk.path("all")).unwrap();
    desk.scenario("all/good", "duration_s = 0.1", &claim("swings", "min = 1"));
    let good = std::fs::read_to_string(desk.path("all/good.toml")).unwrap();
    let misspelt = good.replace("[process.", "[proces.");
    let broken: [(&str, Vec<u8>); 3] = [
        ("misspelt", misspelt.into_bytes()),
        ("cut_off", b"name =".to_vec()),
        ("latin", b"name = \"Fr\xe4sen\"\n[process.load]\n".to_vec()),
    ];
    std::fs::write(desk.path("all/other.toml"), "[package]\nname = \"a\"\n").unwrap();
    let check = |desk: &Desk| {
        let out = desk.truecut(&["check", "all"]);
        let text = String::from_utf8_lossy(&out.stdout).into_owned();
        (out.status.code().unwrap(), text)
    };
    let (code, text) = check(&desk);
    assert_eq!(code, 0, "{text}");
    assert!(
        text.contains("not scenarios, left out: all/other.toml"),
        "{text}"
    );
    for (name, bytes) in broken {
        let path = desk.path(&format!("all/{name}.toml"));
        std::fs::write(&path, bytes).unwrap();
        let (code, text) = check(&desk);
        assert_eq!(code, BAD_INPUT, "{name}: {text}");
        assert!(text.contains(name), "{name}: {text}");
        std::fs::remove_file(&path).unwrap();
    }
}

/// A file that is read is never written over, by --force or without.
#[test]
fn what_is_read_is_not_written_over() {
    let desk = Desk::new();
    desk.scenario("good", "duration_s = 0.1", &claim("swings", "min = 1"));
    let urdf = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets/robots/irb6600_175_255/robot.urdf");
    std::fs::copy(urdf, desk.path("robot.urdf")).unwrap();
    let kept = std::fs::read(desk.path("good.toml")).unwrap();
    let calls: [&[&str]; 2] = [
        &["check", "good.toml", "--junit", "./good.toml"],
        &["export-mjcf", "good.toml", "-o", "good.toml"],
    ];
    for call in calls {
        desk.ends(BAD_INPUT, call);
        assert_eq!(std::fs::read(desk.path("good.toml")).unwrap(), kept);
    }
    let kept = std::fs::read(desk.path("robot.urdf")).unwrap();
    let init = [
        "robot",
        "init",
        "robot.urdf",
        "--mass",
        "100",
        "--payload",
        "10",
    ];
    desk.ends(
        BAD_INPUT,
        &[&init[..], &["--out", "robot.urdf", "--force"]].concat(),
    );
    assert_eq!(std::fs::read(desk.path("robot.urdf")).unwrap(), kept);
}

#[test]
fn running_a_folder_points_to_check() {
    let desk = desk();
    let output = desk.truecut(&["run", "all"]);
    assert_eq!(output.status.code(), Some(BAD_INPUT));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("truecut check all"), "{said}");
}

/// An arm of six equal axes, one above the other, whose links have these masses and inertias.
fn stacked_arm(masses_kg: [f64; 6], inertias_kg_m2: [f64; 6]) -> String {
    let mut text = "<robot name=\"stack\"><link name=\"base\"/>".to_owned();
    let mut parent = "base".to_owned();
    for (index, (mass, inertia)) in masses_kg.iter().zip(inertias_kg_m2).enumerate() {
        let axis = ["0 0 1", "0 1 0"][index % 2];
        text += &format!(
            "<joint name=\"j{index}\" type=\"revolute\"><parent link=\"{parent}\"/>\
             <child link=\"l{index}\"/><origin xyz=\"0 0 0.3\"/><axis xyz=\"{axis}\"/>\
             <limit lower=\"-3\" upper=\"3\" effort=\"1e6\" velocity=\"9\"/></joint>\
             <link name=\"l{index}\"><inertial><origin xyz=\"0 0 0.1\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"{inertia}\" iyy=\"{inertia}\" izz=\"{inertia}\" ixy=\"0\" ixz=\"0\" \
             iyz=\"0\"/></inertial></link>"
        );
        parent = format!("l{index}");
    }
    text + "</robot>"
}

#[test]
fn an_arm_of_placeholders_fails_by_two_signs_and_not_by_one() {
    let desk = Desk::new();
    let own_kg = [90.0, 70.0, 40.0, 20.0, 10.0, 5.0];
    let own = [4.0, 3.0, 1.0, 0.5, 0.2, 0.15];
    let light = own.map(|kg_m2| 1e-2 * kg_m2);
    let arms = [
        ("own", own_kg, own, 0, ""),
        ("one_mass", [30.0; 6], own, 0, "have the same mass, 30 kg"),
        ("one_inertia", own_kg, [1.0; 6], 0, "have the same inertia"),
        ("light", own_kg.map(|kg| 1e-2 * kg), light, 0, "than in any"),
        ("both", [1.0; 6], [1.0; 6], PLACEHOLDERS, "same inertia"),
        ("light_alike", [0.1; 6], light, PLACEHOLDERS, "than in any"),
    ];
    let joint = |index| {
        format!(
            "[[joint]]\nname = \"j{index}\"\nstiffness_nm_per_rad = 1e6\n\
             damping_nm_s_per_rad = 1e3\n[joint.source]\nstiffness = \"a test\"\n\
             damping = \"a test\"\n"
        )
    };
    let joints: String = (0..6).map(joint).collect();
    std::fs::write(desk.path("robot.toml"), joints).unwrap();
    for (name, masses, inertias, code, told) in arms {
        let urdf = format!("{name}.urdf");
        std::fs::write(desk.path(&urdf), stacked_arm(masses, inertias)).unwrap();
        let text = format!(
            "name = \"Rig {name}\"\n[robot]\nurdf = \"{urdf}\"\ndrive = \"position\"\n\
             posture_deg = [0, 20, 0, 40, 0, 30]\n[run]\nduration_s = 0.05\n\
             [process.load]\nconstant_n = [10, 0, 0]\n{}",
            claim("gives way", "max = 1000")
        );
        std::fs::write(desk.path(&format!("{name}.toml")), text).unwrap();
        let run = ["run", &format!("{name}.toml"), "--no-rrd"];
        desk.ends(0, &[&run[..], &["--set", "run.placeholders=warn"]].concat());
        let out = desk.ends(code, &run);
        assert!(out.contains(told), "{out}");
        assert_eq!(out.contains("✗ rests on placeholders"), code != 0, "{out}");
        assert!(out.contains("✓ gives way"), "{out}");
    }
    let junit = ["check", "both.toml", "own.toml", "--junit", "junit.xml"];
    desk.ends(PLACEHOLDERS, &junit);
    let junit = std::fs::read_to_string(desk.path("junit.xml")).unwrap();
    assert!(run_case(&junit, "both").contains("<failure"), "{junit}");
    assert!(!run_case(&junit, "own").contains("<failure"), "{junit}");
    let summary = std::fs::read_to_string(desk.path("out/light_alike/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let signs = &summary["outcome"]["placeholders"]["signs"];
    assert!(signs.as_str().unwrap().contains("same mass"), "{signs}");
}

#[test]
fn what_a_file_says_does_not_act_on_the_terminal_and_long_lines_are_cut() {
    let desk = Desk::new();
    let key = "x".repeat(100_000);
    let texts = [
        format!("name = \"a\"\n{key} = 1\n"),
        "name = \"a\"\n# \u{1b}]0;mine\u{7}\nbad = \"\u{9b}31m\"\n".to_owned(),
        format!("name = \"a\" # \u{1b}[31m\n[run]\nduration_s = \"{key}\"\n"),
    ];
    for text in texts {
        std::fs::write(desk.path("bad.toml"), text).unwrap();
        let output = desk.truecut(&["run", "bad.toml"]);
        assert_eq!(output.status.code(), Some(BAD_INPUT));
        let said = String::from_utf8(output.stderr).unwrap();
        let acts = |c: char| c.is_control() && c != '\n';
        assert!(!said.contains(acts), "{said:?}");
        assert!(
            said.lines().all(|line| line.chars().count() < 500),
            "{}",
            said.len()
        );
        assert!(said.contains("bad.toml:"), "{said}");
    }
}

/// A run, a sweep and a check of an arm whose values are estimates say so, once in each place; of
/// one that is measured they do not.
#[test]
fn estimates_that_act_are_told_in_text_summary_and_junit() {
    let desk = desk();
    let told = "estimated, not measured: stiffness and damping of slide; results are as uncertain";
    let urdf = desk.path("arm.urdf");
    let rig = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/rig_1dof");
    std::fs::copy(rig.join("robot.urdf"), &urdf).unwrap();
    let config = std::fs::read_to_string(rig.join("robot.toml")).unwrap();
    let known = toml::from_str::<toml::Table>(&config).unwrap();
    for (name, source, is_estimate) in [
        ("guessed", "estimated: by a rule", true),
        ("measured", "hammer test", false),
    ] {
        let mut config = known.clone();
        let joint = &mut config["joint"][0];
        for value in ["stiffness", "damping"] {
            joint["source"][value] = source.into();
        }
        for value in ["dry_friction", "rotor_inertia", "servo"] {
            if let Some(other) = joint["source"].get_mut(value) {
                *other = "data sheet".into();
            }
        }
        let text = toml::to_string(&config).unwrap();
        std::fs::write(desk.path(&format!("{name}_robot.toml")), text).unwrap();
        desk.scenario(name, "duration_s = 0.1", "");
        let robot = format!("urdf = 'arm.urdf'\nconfig = '{name}_robot.toml'\n[run]");
        let path = desk.path(&format!("{name}.toml"));
        let text = std::fs::read_to_string(&path).unwrap();
        let (head, rest) = text.split_once("urdf = ").unwrap();
        let (_, rest) = rest.split_once("[run]").unwrap();
        std::fs::write(&path, format!("{head}{robot}{rest}")).unwrap();
        let file = format!("{name}.toml");
        let expected = usize::from(is_estimate);
        let times = |text: &str| text.matches(told).count();
        assert_eq!(times(&desk.ends(0, &["run", &file])), expected, "{name}");
        let summary = desk.path(&format!("out/{name}/summary.json"));
        assert_eq!(times(&std::fs::read_to_string(summary).unwrap()), expected);
        assert_eq!(times(&desk.ends(0, &["check", &file])), expected, "{name}");
        let junit = std::fs::read_to_string(desk.path("out/junit.xml")).unwrap();
        assert_eq!(times(run_case(&junit, name)), expected, "{junit}");
        // Free joints have no transmission that could be guessed.
        let free = ["run", &file, "--no-rrd", "--set", "robot.drive=force"];
        assert_eq!(times(&desk.ends(0, &free)), 0, "{name}");
    }
}
