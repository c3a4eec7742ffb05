//! `truecut identify`: what it prints and writes, and that its stiffnesses can be used.

use std::path::Path;

use super::Desk;

fn repository() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .canonicalize()
        .unwrap()
}

#[test]
fn identify_tells_stiffness_and_modes_and_its_entries_serve_as_robot_toml() {
    let desk = Desk::new();
    let example = repository().join("scenarios/identification/arm.toml");
    let output = desk.truecut(&["identify", example.to_str().unwrap()]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{told}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    for wanted in [
        "joint_1",
        "no load turns it",
        "with identified stiffness",
        "6.04",
    ] {
        assert!(told.contains(wanted), "{wanted}:\n{told}");
    }
    for name in ["stiffness.json", "stiffness.svg", "modes.json", "modes.svg"] {
        assert!(desk.path("out/arm").join(name).is_file(), "{name}");
    }
    // The entries are read as robot.toml: joint 6 has none, and is named by a scenario that needs
    // it.
    let robot = repository().join("assets/robots/irb6600_175_255/robot.urdf");
    std::fs::copy(&robot, desk.path("robot.urdf")).unwrap();
    std::fs::copy(desk.path("out/arm/stiffness.toml"), desk.path("robot.toml")).unwrap();
    let output = desk.truecut(&["robot", "robot.urdf"]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{told}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(told.contains("identified from loads.csv"), "{told}");
}

/// Modes from FRFs at the tool tip are entries of a milling scenario.
#[test]
fn modes_of_the_tool_serve_in_a_milling_scenario() {
    let desk = Desk::new();
    let example = repository().join("scenarios/identification/tool_tip.toml");
    let output = desk.truecut(&["identify", example.to_str().unwrap()]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{told}");
    assert_eq!(told.matches("tool mode at").count(), 2, "{told}");
    let entries = std::fs::read_to_string(desk.path("out/tool_tip/tool_modes.toml")).unwrap();
    let milling = repository().join("scenarios/milling/own_surface.toml");
    let text = std::fs::read_to_string(milling).unwrap();
    let assets = repository().join("assets");
    let text = text.replace("../../assets", assets.to_str().unwrap());
    std::fs::write(desk.path("with_tool.toml"), format!("{text}\n{entries}")).unwrap();
    let size = ["--size", "6", "--runs", "0", "--rpm", "9000,12000"];
    let output = desk.truecut(&[&["lobes", "with_tool.toml"][..], &size].concat());
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    let report = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}{report}");
    assert!(!told.contains("gives no modes of theirs"), "{told}");
}

/// FRFs in µm/N that the file says are in m/N: frequencies and damping are as before.
#[test]
fn a_unit_of_frfs_that_makes_a_tool_softer_than_any_is_told() {
    let desk = Desk::new();
    let folder = repository().join("scenarios/identification");
    let text = std::fs::read_to_string(folder.join("tool_tip.toml")).unwrap();
    let assets = repository().join("assets");
    let text = text.replace("../../assets", assets.to_str().unwrap());
    let data = folder.join("tool_tip.csv");
    let text = text.replace("tool_tip.csv", data.to_str().unwrap());
    let doubt = "is a unit of the FRFs wrong";
    for (unit, is_told) in [("\"um\"", false), ("\"m\"", true)] {
        std::fs::write(desk.path("tip.toml"), text.replace("\"um\"", unit)).unwrap();
        let output = desk.truecut(&["identify", "tip.toml"]);
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{told}");
        assert_eq!(told.contains(doubt), is_told, "{told}");
        assert_eq!(
            told.contains("It looks like um taken for m"),
            is_told,
            "{told}"
        );
    }
}

#[test]
fn the_schema_of_the_identification_file_is_printed() {
    let output = Desk::new().truecut(&["schema", "--identification"]);
    let schema: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(schema["title"], "truecut identification");
    assert!(schema.pointer("/properties/stiffness").is_some());
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let output = Desk::new().truecut(&["identify", "nowhere.toml"]);
    let report = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(super::BAD_INPUT));
    assert!(report.contains("nowhere.toml"), "{report}");
}
