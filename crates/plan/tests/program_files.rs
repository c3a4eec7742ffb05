//! What the files look like, how long programs are split, and what is refused.

use crate::assets::robot;
use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use truecut_arm::{Robot, ToolLoad};
use truecut_plan::program::{
    Frames, Motion, PathPoint, Program, Settings, SpindleSwitch, Tool, TravelOptions,
    dialect_named, jbi, rapid,
};

/// Approach by joints, then a line of `count` points with the tool down, the turntable turning
/// beside it.
fn program(robot: &Robot, count: u32) -> Program {
    let down = UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.1, 0.2);
    let points: Vec<PathPoint> = (0..count)
        .map(|i| PathPoint {
            base_from_tool: Isometry3::from_parts(
                Translation3::new(0.9, 0.001 * f64::from(i) - 0.1, 0.6),
                down,
            ),
            motion: match i {
                0 => Motion::Joint { share: 0.1 },
                _ => Motion::Linear {
                    speed_m_per_s: 0.02,
                },
            },
            turntable_rad: Some((0.5 * f64::from(i)).to_radians()),
        })
        .collect();
    let mut tool = Tool::of(robot, "wheel", 2);
    tool.flange_from_tool.translation.vector.z = 0.25;
    let base = Isometry3::translation(0.1, 0.0, 0.2);
    let travel = TravelOptions::default();
    let mut program = Program::along(robot, "POLISH", tool, base, &points, &travel).unwrap();
    program.comment = "hub spoke, belt 40 mm".to_owned();
    program
}

fn options() -> jbi::JbiOptions {
    let date = jbi::JobDate::new(2026, 1, 31, 12, 0).unwrap();
    jbi::JbiOptions {
        station_pulses_per_deg: Some(1000.0),
        station_share: 0.5,
        ..jbi::JbiOptions::new(date)
    }
}

#[test]
fn regress_a_job() {
    let robot = robot("hp20");
    let files = jbi::write(&program(&robot, 3), &robot, &options()).unwrap();
    assert_eq!(files.len(), 1);
    let text = &files[0].text;
    assert_eq!(text.matches("\r\n").count(), text.matches('\n').count());
    insta::assert_snapshot!(text.replace("\r\n", "\n"));
}

#[test]
fn regress_a_module() {
    let robot = robot("irb6600_175_255");
    let options = rapid::RapidOptions::default();
    let text = rapid::write(&program(&robot, 3), &robot, &options).unwrap();
    assert_eq!(text.matches("\r\n").count(), text.matches('\n').count());
    insta::assert_snapshot!(text.replace("\r\n", "\n"));
}

/// A point that the path says twice is no line of a KRL program; what the spindle does there stays.
#[test]
fn a_krl_program_has_no_line_to_where_the_tool_stands() {
    let robot = robot("hp20");
    let mut whole = program(&robot, 3);
    let repeated = [0, 0, 1, 2, 2];
    whole.moves = (repeated.iter().enumerate())
        .map(|(path_point, &of)| {
            let mut step = whole.moves[of].clone();
            step.path_point = path_point;
            if path_point > 0 {
                step.motion = Motion::Linear {
                    speed_m_per_s: 0.02,
                };
            }
            step
        })
        .collect();
    whole.spindle = [(1, true), (5, false)]
        .map(|(before, on)| SpindleSwitch { before, on })
        .to_vec();
    let dialect = dialect_named("krl").expect("a dialect");
    let settings = Settings {
        spindle_signal: Some("3".to_owned()),
        ..Settings::default()
    };
    let files = dialect.write(&whole, &robot, &settings).unwrap();
    for name in ["XP1", "XP4"] {
        assert!(files.iter().all(|file| !file.text.contains(name)), "{name}");
    }
    let frames = Frames {
        tool: whole.tool.clone(),
        world_from_base: whole.world_from_base,
    };
    let text = |path: &Path| {
        let found = files.iter().find(|file| Path::new(&file.name) == path);
        let found = found.map(|file| file.text.clone());
        found.ok_or_else(|| std::io::ErrorKind::NotFound.into())
    };
    let main = Path::new(&files[0].name);
    let read = dialect
        .read(main, &text, &robot, &frames, &settings)
        .unwrap();
    let points: Vec<usize> = read.moves.iter().map(|step| step.path_point).collect();
    assert_eq!(points, [0, 2, 3]);
    let switches = read.spindle.iter().map(|one| (one.before, one.on));
    assert_eq!(switches.collect::<Vec<_>>(), [(1, true), (3, false)]);
}

/// Nothing is lost or doubled where a program is cut, and no job is longer than asked.
#[test]
fn a_long_program_is_split_into_jobs_that_another_calls() {
    let robot = robot("hp20");
    let whole = program(&robot, 200);
    let short = jbi::JbiOptions {
        lines_per_job: 64,
        ..options()
    };
    let files = jbi::write(&whole, &robot, &short).unwrap();
    let jobs: Vec<jbi::JbiJob> = files
        .iter()
        .map(|file| {
            let after = file.text.split("NOP\r\n").nth(1).unwrap();
            // NOP and these.
            assert!(after.lines().count() < 64, "{}", file.name);
            jbi::JbiJob::parse(&file.text, Path::new(&file.name)).unwrap()
        })
        .collect();
    let called: Vec<&str> = jobs[1..].iter().map(|job| job.name.as_str()).collect();
    assert_eq!(jobs[0].name, "POLISH");
    let calls: Vec<&str> = (jobs[0].calls.iter())
        .map(|call| call.name.as_str())
        .collect();
    assert_eq!(calls, called);
    assert_eq!(called, ["POLISH01", "POLISH02", "POLISH03", "POLISH04"]);
    let mut read = Vec::new();
    for job in &jobs[1..] {
        let part = job.program(
            &robot,
            &whole.tool,
            &whole.world_from_base,
            short.station_pulses_per_deg,
        );
        read.extend(part.unwrap().moves);
    }
    assert_eq!(read.len(), 200);
    for (a, b) in whole.moves.iter().zip(&read) {
        assert_eq!((a.path_point, a.motion), (b.path_point, b.motion));
        let apart = a.posture.iter().zip(&b.posture).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 2e-5);
    }
}

#[test]
fn what_a_dialect_cannot_hold_is_refused_when_writing() {
    let robot = robot("hp20");
    let good = program(&robot, 3);
    let jbi_refuses = |change: &dyn Fn(&mut Program, &mut jbi::JbiOptions), quotes: &[&str]| {
        let (mut program, mut options) = (good.clone(), options());
        change(&mut program, &mut options);
        let error = jbi::write(&program, &robot, &options)
            .unwrap_err()
            .to_string();
        for quote in quotes {
            assert!(error.contains(quote), "`{quote}` is not in: {error}");
        }
    };
    jbi_refuses(
        &|p, _| p.name = "POLISHING".into(),
        &["\"POLISHING\"", "1 to 8 characters"],
    );
    jbi_refuses(&|p, _| p.name = "polish".into(), &["\"polish\"", "A-Z"]);
    jbi_refuses(
        &|p, _| p.comment = "x".repeat(33),
        &["at most 32 characters"],
    );
    jbi_refuses(&|p, _| p.comment = "línea".into(), &["printable ASCII"]);
    jbi_refuses(
        &|p, _| p.tool.number = 24,
        &["tool number is 24", "0 to 23"],
    );
    jbi_refuses(
        &|_, o| o.lines_per_job = 3,
        &["lines per job is 3", "at least 5"],
    );
    jbi_refuses(
        &|_, o| o.station_pulses_per_deg = None,
        &["pulses per degree of the station"],
    );
    jbi_refuses(
        &|_, o| o.station_share = 0.0,
        &["station's speed is 0", "0.01 to 100 %"],
    );
    jbi_refuses(
        &|p, _| p.moves[1].motion = Motion::Linear { speed_m_per_s: 2.0 },
        &["path point 1", "speed V is 2000", "0.1 to 1500 mm/s"],
    );
    jbi_refuses(
        &|p, _| {
            p.moves[1].motion = Motion::Linear {
                speed_m_per_s: f64::NAN,
            }
        },
        &["path point 1", "NaN", "finite"],
    );
    jbi_refuses(
        &|p, _| p.moves[2].path_point = 1,
        &["path point is 1", "above that of the move before"],
    );
    jbi_refuses(
        &|p, _| p.moves[1].turntable_rad = None,
        &["path point 1", "turntable"],
    );
    jbi_refuses(
        &|p, _| p.moves[1].posture.truncate(5),
        &["holds 5 joints", "has 6"],
    );
    jbi_refuses(
        &|p, _| p.moves[1].posture[2] += 0.01,
        &["path point 1", "from the pose of the move"],
    );
    jbi_refuses(
        &|p, _| p.moves[1].posture[5] += 4.0 * std::f64::consts::PI,
        &["path point 1", "above -360 to 360 deg"],
    );
    jbi_refuses(
        &|p, o| {
            p.name = "POLISH01".into();
            o.lines_per_job = 5;
        },
        &["\"POLISH01\"", "names of the parts"],
    );
    assert!(
        jbi::JobDate::new(2026, 13, 1, 0, 0)
            .unwrap_err()
            .to_string()
            .contains("month")
    );

    let rapid_refuses = |change: &dyn Fn(&mut Program, &mut rapid::RapidOptions), quote: &str| {
        let (mut program, mut options) = (good.clone(), rapid::RapidOptions::default());
        change(&mut program, &mut options);
        let error = rapid::write(&program, &robot, &options)
            .unwrap_err()
            .to_string();
        assert!(error.contains(quote), "`{quote}` is not in: {error}");
    };
    rapid_refuses(
        &|p, _| p.name = "1ST".into(),
        "\"1ST\"; it must be a letter",
    );
    rapid_refuses(&|p, _| p.name = "Module".into(), "no word of the language");
    let weightless = ToolLoad {
        mass_kg: 0.0,
        centre_m: nalgebra::Vector3::zeros(),
    };
    rapid_refuses(&|p, _| p.tool.load = Some(weightless), "mass in kg is 0");
    rapid_refuses(
        &|_, o| o.zone = "z2".into(),
        "\"z2\"; it must be `fine` or one of z0",
    );
    rapid_refuses(
        &|_, o| o.joint_top_m_per_s = -1.0,
        "top speed of joint moves",
    );
    rapid_refuses(
        &|p, _| {
            p.moves[1].motion = Motion::Linear {
                speed_m_per_s: 1e-8,
            }
        },
        "0.001 mm/s",
    );
}

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/invalid_input/program")
}

/// File, line of the fault, quotes.
const FAULTS: &[(&str, usize, &[&str])] = &[
    ("truncated.JBI", 11, &["ends here", "//INST"]),
    ("no_end.JBI", 20, &["ends here", "before END"]),
    (
        "five_numbers.JBI",
        9,
        &["C00000 has 5 fields", "6 are wanted"],
    ),
    ("not_a_number.JBI", 10, &["C00001 is NaN", "finite number"]),
    (
        "unknown_type.JBI",
        6,
        &["position type CARTESIAN is unknown", "PULSE, BASE"],
    ),
    ("foreign_type.JBI", 6, &["type USER need frames"]),
    ("unused_position.JBI", 11, &["no move goes to C00002"]),
    ("missing_position.JBI", 20, &["no C00005 to move to"]),
    (
        "position_twice.JBI",
        10,
        &["C00000 is given twice", "line 9"],
    ),
    (
        "wrong_count.JBI",
        4,
        &["///NPOS says 4 positions, but 3 follow"],
    ),
    ("flag_of_two.JBI", 8, &["flag of ///RCONF is 2", "0 or 1"]),
    ("too_fast.JBI", 19, &["V is 1500.1", "from 0.1 to 1500"]),
    ("circular.JBI", 19, &["`MOVC` stands where MOVJ, MOVL"]),
    (
        "long_name.JBI",
        2,
        &[
            "\"POLISHING_OF_THE_HUB_OF_THE_WHEEL\"",
            "1 to 32 characters",
        ],
    ),
    (
        "after_end.JBI",
        22,
        &["`MOVJ C00000 VJ=10.00`", "after END"],
    ),
    ("truncated.MOD", 10, &["ends here", "ENDPROC"]),
    ("three_parts.MOD", 6, &["rot has 3 fields", "4 are wanted"]),
    ("not_a_number.MOD", 6, &["trans is NaN", "finite number"]),
    (
        "not_unit.MOD",
        6,
        &["sum of squares of rot is 1.5", "must be 1"],
    ),
    ("no_such_branch.MOD", 6, &["cfx is 8", "from 0 to 7"]),
    ("second_axis.MOD", 6, &["eax_a is 12", "9E+09"]),
    ("missing_target.MOD", 11, &["no p7 to move to"]),
    ("target_twice.MOD", 6, &["p0 is given twice", "line 5"]),
    ("unknown_zone.MOD", 11, &["\"z2\"", "`fine` or one of"]),
    (
        "unknown_tool.MOD",
        11,
        &["`belt`", "declared in the module"],
    ),
    (
        "instruction.MOD",
        11,
        &["`ArcLStart` stands where", "MoveJ"],
    ),
    ("character.MOD", 5, &["`{` stands where"]),
];

#[test]
fn every_faulty_program_is_refused_with_file_line_value_and_rule() {
    for (file, line, quotes) in FAULTS {
        let path = fixtures().join(file);
        let text = std::fs::read_to_string(&path).expect(file);
        let error = if file.ends_with(".JBI") {
            jbi::JbiJob::parse(&text, &path).map(drop).expect_err(file)
        } else {
            rapid::RapidModule::parse(&text, &path)
                .map(drop)
                .expect_err(file)
        };
        let report = error.to_string();
        assert_eq!(error.line(), Some(*line), "{report}");
        assert!(report.contains(&format!("{file}:{line}: ")), "{report}");
        for quote in *quotes {
            assert!(report.contains(quote), "`{quote}` is not in: {report}");
        }
    }
    let files = std::fs::read_dir(fixtures()).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let unlisted: Vec<String> = names
        .filter(|name| !name.starts_with("wrong_joints") && !FAULTS.iter().any(|f| f.0 == name))
        .collect();
    assert!(unlisted.is_empty(), "{unlisted:?}");
}

/// What shows only when a robot runs the program: joints of pulses, flags that no posture of the
/// pose has.
#[test]
fn faults_that_the_robot_shows_name_the_position() {
    let robot = robot("hp20");
    let path = fixtures().join("wrong_joints.JBI");
    let text = std::fs::read_to_string(&path).unwrap();
    let job = jbi::JbiJob::parse(&text, &path).unwrap();
    let tool = Tool::of(&robot, "wheel", 1);
    let base = Isometry3::identity();
    let error = job.program(&robot, &tool, &base, Some(1000.0)).unwrap_err();
    let report = error.to_string();
    assert!(
        report.contains("wrong_joints.JBI:8: C00000 holds 5 joints; the robot has 6"),
        "{report}"
    );

    // Front shoulder with a wrist far in front: nothing reaches that from behind.
    let written = program(&robot, 3);
    let text = jbi::write(&written, &robot, &options())
        .unwrap()
        .remove(0)
        .text;
    let (_, rest) = text.split_once("///RCONF ").unwrap();
    let flags = &rest[..11];
    let mut other = flags.to_owned();
    other.replace_range(4..5, if &flags[4..5] == "0" { "1" } else { "0" });
    let text = text.replace(flags, &other);
    let job = jbi::JbiJob::parse(&text, Path::new("POLISH.JBI")).unwrap();
    let error = job
        .program(
            &robot,
            &written.tool,
            &written.world_from_base,
            Some(1000.0),
        )
        .unwrap_err();
    let report = error.to_string();
    assert!(
        report.starts_with("POLISH.JBI:9: path point 0: no posture reaches the pose with RCONF "),
        "{report}"
    );
    assert!(report.contains(&other), "{report}");
}

mod damaged {
    use super::*;
    use proptest::prelude::*;

    const JOB: &str = include_str!("../../../tests/invalid_input/program/unused_position.JBI");
    const MODULE: &str = include_str!("../../../tests/invalid_input/program/missing_target.MOD");

    proptest! {
        /// Damaged files are read, or refused with their name and a line that they have.
        #[test]
        fn damage_is_answered(at in 0..JOB.len().min(MODULE.len()), length in 0_usize..30, patch in "[ -~]{0,8}") {
            let end = |text: &str| (at + length).min(text.len());
            let damage = |text: &str| format!("{}{patch}{}", &text[..at], &text[end(text)..]);
            let job = jbi::JbiJob::parse(&damage(JOB), Path::new("x.JBI")).err();
            let module = rapid::RapidModule::parse(&damage(MODULE), Path::new("x.MOD")).err();
            for (error, name, text) in [(job, "x.JBI", damage(JOB)), (module, "x.MOD", damage(MODULE))] {
                let Some(error) = error else { continue };
                prop_assert_eq!(error.path(), Some(Path::new(name)));
                let line = error.line().expect("a line");
                prop_assert!((1..=text.lines().count() + 1).contains(&line), "{}", error);
                prop_assert!(!error.message().is_empty());
            }
        }
    }
}
