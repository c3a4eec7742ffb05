//! What controllers ask of a program: postures, loads, frames, blends.

use std::path::Path;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::{FrameId, Robot};
use truecut_plan::program::{
    Frames, Motion, PathPoint, Program, Settings, Tool, TravelOptions, Zone, dialect_named,
    maker_note,
};

use super::{assets, folder};

/// A Universal Robots arm has no wrist centre and no closed form here: lines are followed by the
/// posture before, all the way.
#[test]
fn a_script_brings_back_the_postures_of_an_arm_without_a_wrist_centre() {
    let robot = assets::robot("ur10e");
    let down = UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.3);
    let points: Vec<PathPoint> = (0..6)
        .map(|i| PathPoint {
            base_from_tool: Isometry3::from_parts(
                Translation3::new(0.6, 0.2 + 0.02 * f64::from(i), 0.4),
                down,
            ),
            motion: Motion::Linear {
                speed_m_per_s: 0.05,
            },
            turntable_rad: None,
        })
        .collect();
    let tool = Tool::of(&robot, "wheel", 0);
    let (base, travel) = (Isometry3::identity(), TravelOptions::default());
    let written = Program::along(&robot, "LINE", tool.clone(), base, &points, &travel);
    let written = written.expect("a program");
    let dialect = dialect_named("urscript").expect("the dialect");
    let settings = Settings::default();
    let files = dialect
        .write(&written, &robot, &settings)
        .expect("a script");
    assert!(files[0].text.contains("not loaded on a controller"));
    assert_eq!(
        files[0].text.matches("movel(p[").count(),
        5,
        "{}",
        files[0].text
    );
    let frames = Frames {
        tool,
        world_from_base: base,
    };
    let text = |_: &Path| Ok(files[0].text.clone());
    let read = dialect.read(Path::new("LINE.script"), &text, &robot, &frames, &settings);
    for (a, b) in written.moves.iter().zip(read.expect("a program").moves) {
        let apart = a.posture.iter().zip(&b.posture).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-5, "{a:?} {b:?}");
    }
}

/// What robot.toml says of the tool's load is what programs tell the controller; without it each
/// says that it is not known.
#[test]
fn the_load_of_the_tool_is_the_robots_own() {
    let urdf = folder("../../assets/robots/hp20/robot.urdf");
    let load = "[tool_load]\nmass_kg = 6.5\ncenter_m = [0.01, 0.0, 0.12]\n";
    let model = std::fs::read_to_string(&urdf).expect("the asset");
    let config = |text: &str| {
        let config = Some((text, Path::new("robot.toml")));
        Robot::from_texts((&model, &urdf), config, None)
    };
    let tool = |robot: &Robot| Tool::of(robot, "wheel", 0).load;
    let known = tool(&config(load).expect("a robot")).expect("a load");
    assert_eq!((known.mass_kg, known.centre_m.z), (6.5, 0.12));
    assert_eq!(tool(&config("").expect("a robot")), None);
    let error = config(&load.replace("6.5", "-6.5")).expect_err("a mass below zero");
    let report = error.to_string();
    assert!(
        report.contains("robot.toml:2: ") && report.contains("mass_kg` is -6.5"),
        "{report}"
    );
}

#[test]
fn a_language_of_another_maker_is_noted() {
    let robot = assets::robot("hp20");
    let note = |name: &str| maker_note(dialect_named(name).expect("a dialect"), &robot);
    assert_eq!(note("jbi"), None);
    let rapid = note("rapid").expect("a note");
    assert!(
        rapid.contains("HP20") && rapid.contains("not in rapid"),
        "{rapid}"
    );
}

/// Two points on a line, with this tool number and zone.
fn line(number: u8, zone_m: f64, ends_m: [f64; 3]) -> (Robot, Program) {
    let robot = assets::robot("hp20");
    let down = UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.0);
    let points = ends_m.map(|y| PathPoint {
        base_from_tool: Isometry3::from_parts(Translation3::new(0.9, y, 0.35), down),
        motion: Motion::Linear {
            speed_m_per_s: 0.02,
        },
        turntable_rad: None,
    });
    let tool = Tool::of(&robot, "wheel", number);
    let (base, options) = (Isometry3::identity(), TravelOptions::default());
    let mut program = Program::along(&robot, "LINE", tool, base, &points, &options).unwrap();
    for step in &mut program.moves {
        step.zone = Zone::Within(zone_m);
    }
    (robot, program)
}

/// Tool frame 0 of a Fanuc controller is the faceplate: positions of a tool in it would lead the
/// faceplate to where the tool shall be.
#[test]
fn a_fanuc_program_of_a_tool_is_not_written_in_the_faceplates_frame() {
    let dialect = dialect_named("ls").expect("a dialect");
    let (robot, mut program) = line(0, 1e-3, [0.0, 0.02, 0.05]);
    let settings = Settings::default();
    let error = dialect
        .write(&program, &robot, &settings)
        .expect_err("frame 0");
    let report = error.to_string();
    assert!(
        report.contains("tool frame is 0") && report.contains("250.000 mm"),
        "{report}"
    );
    // Without an option it is frame 1.
    let tool = dialect.tool(&robot, &settings.options).expect("a tool");
    assert_eq!(tool.number, 1);
    program.tool = tool;
    let files = dialect.write(&program, &robot, &settings).expect("files");
    assert!(files[0].text.contains("UTOOL_NUM=1"));
    // Read back as another's: the faceplate goes where the positions say.
    let text = files[0].text.replace("UTOOL_NUM=1", "UTOOL_NUM=0");
    let text = text.replace("UT : 1", "UT : 0");
    let text = |_: &Path| Ok(text.clone());
    let frames = Frames {
        tool: program.tool.clone(),
        world_from_base: program.world_from_base,
    };
    let read = dialect.read(Path::new("LINE.LS"), &text, &robot, &frames, &settings);
    let read = read.expect("a program");
    let flange = robot.world_from_frame(&read.moves[1].posture, FrameId::Flange);
    let apart = flange.translation.vector - Vector3::new(0.9, 0.02, 0.35);
    assert!(apart.norm() < 2e-6, "{flange}");
}

/// The controller skips a move whose blend overlaps with another: of points 1 mm apart blends of
/// 3 mm come back as less than half of that, of those 30 mm apart as they are.
#[test]
fn blends_of_a_script_do_not_overlap() {
    let dialect = dialect_named("urscript").expect("a dialect");
    let (robot, program) = line(0, 3e-3, [0.0, 0.001, 0.031]);
    let files = dialect
        .write(&program, &robot, &Settings::default())
        .expect("files");
    let blends: Vec<&str> = (files[0].text.lines())
        .filter_map(|line| line.split(", r=").nth(1))
        .collect();
    assert_eq!(blends, ["0.000490)", "0.000490)", "0.003000)"]);
}

/// What each file says first, and that a load which is not known is told as such: none is made up.
#[test]
fn every_file_says_that_no_controller_loaded_it_and_a_load_is_none_of_ours() {
    let (robot, mut program) = line(1, 1e-3, [0.0, 0.02, 0.05]);
    let load = truecut_arm::ToolLoad {
        mass_kg: 6.25,
        centre_m: Vector3::new(0.01, 0.0, 0.12),
    };
    type Quotes = &'static [&'static str];
    // Without a load, and with one: what stands in the files, and what must not.
    let cases: [(&str, [Quotes; 2], Quotes); 5] = [
        ("jbi", [&[], &[]], &["6.25"]),
        (
            "rapid",
            [
                &["is not known: load0", "[0.001,[0.000,0.000,1.000]"],
                &["[6.250,[10.000,0.000,120.000]"],
            ],
            &[],
        ),
        (
            "krl",
            [
                &["$LOAD={M -1,"],
                &["$LOAD={M 6.250,CM {X 10.000,Y 0.000,Z 120.000"],
            ],
            &[],
        ),
        (
            "urscript",
            [
                &["load is not known"],
                &["set_payload(6.250, [0.010000, 0.000000, 0.120000])"],
            ],
            &[],
        ),
        ("ls", [&[], &[]], &["PAYLOAD", "6.25"]),
    ];
    for (name, wanted, never) in cases {
        let dialect = dialect_named(name).expect(name);
        let mut settings = Settings::default();
        if name == "jbi" {
            let date = serde_json::json!("2026-01-31 12:00");
            settings.options.insert("date".to_owned(), date);
        }
        for (load, wanted) in [None, Some(load)].into_iter().zip(wanted) {
            program.tool.load = load;
            let files = dialect.write(&program, &robot, &settings).expect(name);
            for file in &files {
                let text = file.text.to_lowercase();
                assert!(text.contains("not loaded on a controller"), "{}", file.name);
            }
            for quote in wanted {
                assert!(files[0].text.contains(quote), "{quote}: {}", files[0].text);
            }
            for quote in never {
                assert!(!files[0].text.contains(quote), "{quote}: {}", files[0].text);
            }
            let payload = files[0].text.contains("set_payload");
            assert_eq!(payload, name == "urscript" && load.is_some());
        }
    }
}
