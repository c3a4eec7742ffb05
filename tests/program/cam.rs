//! `truecut path` of poses: where the arm begins, and which tool it has; `truecut program` with it.

use super::Desk;
use super::path::{hp20, told};

/// Two poses straight down before the arm, the tool turned by -90 deg.
fn poses_before_the_arm(desk: &Desk) {
    let head = "x_mm,y_mm,z_mm,feed_mm_per_s,roll_deg,pitch_deg,yaw_deg\n";
    let rows = "900,0,500,,180,0,-90\n900,0,480,20,180,0,-90\n";
    std::fs::write(desk.path("poses.csv"), format!("{head}{rows}")).unwrap();
}

/// Joints of the first point of the path that was written.
fn first_posture(desk: &Desk) -> Vec<f64> {
    let table = std::fs::read_to_string(desk.path("out/poses/path.csv")).unwrap();
    let mut lines = table.lines();
    let heads: Vec<&str> = lines.next().unwrap().split(',').collect();
    let cells: Vec<&str> = lines.next().unwrap().split(',').collect();
    let joint = |j: usize| heads.iter().position(|head| *head == format!("j{j}"));
    let value = |j: usize| cells[joint(j).unwrap()].parse().unwrap();
    (1..=6).map(value).collect()
}

#[test]
fn poses_begin_at_rest_or_near_the_posture_given() {
    let desk = Desk::new();
    poses_before_the_arm(&desk);
    let path = |more: &[&str]| {
        let robot = hp20();
        let head = ["path", "poses.csv", "--robot", &robot];
        desk.truecut(&[&head, more].concat())
    };
    let output = path(&[]);
    assert!(output.status.success(), "{}", told(&output));
    let rest = first_posture(&desk);
    assert!(rest[0].abs() < 90.0 && rest[3].abs() < 90.0, "{rest:?}");
    assert!(rest[5].abs() <= 180.0, "{rest:?}");
    // Joint 6 a whole turn on.
    let turned = if rest[5] > 0.0 {
        rest[5] - 360.0
    } else {
        rest[5] + 360.0
    };
    let wish: Vec<String> = rest[..5]
        .iter()
        .chain(&[turned])
        .map(f64::to_string)
        .collect();
    let wish = wish.join(",");
    let output = path(&["--posture-deg", &wish]);
    assert!(output.status.success(), "{}", told(&output));
    let near = first_posture(&desk);
    assert!((near[5] - turned).abs() < 1e-3, "{near:?}");

    let spun = path(&["--spin-deg", "30"]);
    assert_eq!(spun.status.code(), Some(2));
    for part in ["poses.csv", "--spin-deg 30", "whole attitude"] {
        assert!(told(&spun).contains(part), "{}", told(&spun));
    }
    let short = path(&["--posture-deg", "1,2,3"]);
    assert_eq!(short.status.code(), Some(2));
    assert!(told(&short).contains("3 values"), "{}", told(&short));
    let far = path(&["--posture-deg", "0,0,0,0,0,999"]);
    assert_eq!(far.status.code(), Some(2));
    assert!(told(&far).contains("joint_6"), "{}", told(&far));
}

/// A tool of 250 mm in a file beside: a program written with it is run through with it, and without
/// any the note says that the flange is the tool.
#[test]
fn the_tool_of_another_file_is_used_and_a_missing_one_told() {
    let desk = Desk::new();
    poses_before_the_arm(&desk);
    let bare = desk.path("robot_alone.urdf");
    std::fs::copy(hp20(), &bare).unwrap();
    std::fs::write(
        desk.path("tool.toml"),
        "[frames.tool]\nxyz_m = [0.0, 0.0, 0.25]\n",
    )
    .unwrap();
    let run = |verb: &str, file: &str, more: &[&str]| {
        let robot = ["--robot", "robot_alone.urdf"];
        desk.truecut(&[&[verb, file][..], &robot, more].concat())
    };
    let dialect = [
        "--dialect",
        "jbi",
        "--option",
        "date=2026-01-31 12:00",
        "--option",
        "tool_number=1",
    ];
    let written = run(
        "path",
        "poses.csv",
        &[&dialect[..], &["--config", "tool.toml"]].concat(),
    );
    assert!(written.status.success(), "{}", told(&written));
    assert!(
        !told(&written).contains("no robot.toml"),
        "{}",
        told(&written)
    );
    let path = ["--path", "out/poses/path.csv"];
    let read = run(
        "program",
        "out/poses/POSES.JBI",
        &[&path[..], &["--config", "tool.toml"]].concat(),
    );
    assert!(read.status.success(), "{}", told(&read));
    let without = run("program", "out/poses/POSES.JBI", &path);
    assert!(
        told(&without).contains("no robot.toml"),
        "{}",
        told(&without)
    );
}

#[test]
fn a_folder_is_no_recording() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("out")).unwrap();
    let output = desk.truecut(&["view", "out"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(told(&output).contains("is a folder"), "{}", told(&output));
}
