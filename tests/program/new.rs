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
            "out of reach at (9.0",
        ),
        (
            "load",
            &urdf,
            &["--posture-deg", "1,2"],
            "has 2 values, but the chain has 6 rotary joints",
        ),
        ("load", &"none.urdf".to_owned(), &[], "none.urdf"),
        ("load", &rig, &[], "truecut robot init"),
    ] {
        let call = [&["new", process, "--robot", urdf, "-o", "a"], given].concat();
        desk.refused(&call, &[said]);
        assert!(!desk.path("a").exists(), "{call:?}");
    }
}
