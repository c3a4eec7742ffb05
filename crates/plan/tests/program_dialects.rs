//! Files as people write them in the five dialects, and what of them is refused.

mod assets;

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::{FrameId, Robot};
use truecut_plan::program::{
    Finding, FindingKind, Frames, MOST_POINTS, Motion, PathPoint, Program, ProgramError,
    ReplayOptions, Settings, SpindleSwitch, Tool, TravelOptions, Zone, dialect_named, dialect_of,
    maker_note, read_text,
};

fn read_with(file: &Path, settings: &Settings) -> Result<Program, ProgramError> {
    let robot = assets::robot("hp20");
    let dialect = dialect_of(file).expect("a dialect");
    let frames = Frames {
        tool: Tool::of(&robot, "wheel", 0),
        world_from_base: Isometry3::identity(),
    };
    dialect.read(file, &read_text, &robot, &frames, settings)
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn sample(name: &str) -> Program {
    let settings = Settings {
        spindle_signal: Some(
            if name.ends_with(".mod") {
                "doSpindle"
            } else {
                "3"
            }
            .to_owned(),
        ),
        ..Settings::default()
    };
    let file = folder("tests/samples").join(name);
    read_with(&file, &settings).unwrap_or_else(|error| panic!("{error}"))
}

/// The same part in each language: approach, a line of 100 mm, half a circle of 50 mm back, away.
fn is_the_part(program: &Program) {
    let pose = |i: usize| program.world_from_base * program.moves[i].base_from_tool;
    let place = |i: usize| pose(i).translation.vector * 1e3;
    let last = program.moves.len() - 1;
    let wanted = [
        (0, [900.0, -50.0, 400.0]),
        (1, [900.0, -50.0, 350.0]),
        (2, [900.0, 50.0, 350.0]),
        (last - 1, [900.0, -50.0, 350.0]),
        (last, [900.0, -50.0, 400.0]),
    ];
    for (i, place_mm) in wanted {
        let apart = (place(i) - Vector3::from(place_mm)).norm();
        assert!(apart < 2e-3, "{}: move {i} at {}", program.name, place(i));
    }
    let down = pose(1).rotation * Vector3::z();
    assert!((down + Vector3::z()).norm() < 1e-4, "{down}");
    // Half a circle about (900, 0, 350) through x = 950.
    for i in 3..last - 1 {
        let spoke = place(i) - Vector3::new(900.0, 0.0, 350.0);
        assert!(
            (spoke.norm() - 50.0).abs() < 2e-3 && spoke.x > 0.0,
            "{spoke}"
        );
    }
    assert!(program.moves.len() > 50, "{} moves", program.moves.len());
    let cut = program.moves[2].motion;
    assert!(
        matches!(cut, Motion::Linear { speed_m_per_s } if (speed_m_per_s - 0.02).abs() < 1e-9),
        "{cut:?}"
    );
    assert!(matches!(program.moves[0].motion, Motion::Joint { .. }));
    let switches = [(1, true), (last, false)];
    let switches = switches.map(|(before, on)| SpindleSwitch { before, on });
    assert_eq!(program.spindle, switches, "{}", program.name);
    assert_eq!(program.moves[last].zone, Zone::Stop);
}

#[test]
fn rapid_as_people_write_it_is_read() {
    let program = sample("part.mod");
    is_the_part(&program);
    assert_eq!(program.moves[1].zone, Zone::Within(0.01));
    let load = program.tool.load.expect("a load");
    assert!((load.mass_kg - 4.2).abs() < 1e-12);
    for quote in [
        "WaitTime is left aside",
        "Set is left aside",
        "of the type loaddata",
    ] {
        assert!(
            program.notes.iter().any(|note| note.contains(quote)),
            "{:?}",
            program.notes
        );
    }
}

#[test]
fn krl_as_people_write_it_is_read() {
    let program = sample("part.src");
    is_the_part(&program);
    assert_eq!(program.moves[1].zone, Zone::Within(0.01));
    assert!(
        program.notes.iter().any(|note| note.contains("WAIT")),
        "{:?}",
        program.notes
    );
}

#[test]
fn urscript_as_people_write_it_is_read() {
    let program = sample("part.script");
    is_the_part(&program);
    assert_eq!(program.moves[1].zone, Zone::Within(0.01));
    assert!((program.tool.load.expect("a load").mass_kg - 4.2).abs() < 1e-12);
}

#[test]
fn ls_as_people_write_it_is_read() {
    let program = sample("part.LS");
    is_the_part(&program);
    assert_eq!(program.moves[1].zone, Zone::Unstated);
    assert_eq!(program.tool.number, 1);
}

/// A job of a controller set to Japanese: its comments are Shift-JIS.
#[test]
fn a_job_with_shift_jis_comments_is_read() {
    let program = sample("part.JBI");
    assert_eq!(program.comment, "研磨");
    assert_eq!(program.moves.len(), 2);
    assert_eq!(program.moves[0].zone, Zone::Stop);
    assert_eq!(program.moves[1].zone, Zone::Unstated);
}

/// File, line of the fault, quotes.
const FAULTS: &[(&str, usize, &[&str])] = &[
    ("loop.src", 4, &["`FOR`", "branches, loops"]),
    ("no_speed.src", 3, &["`LIN`", "$VEL.CP"]),
    ("missing_position.src", 2, &["no XP1 to move to"]),
    ("no_end.src", 2, &["ends here"]),
    ("subprogram.src", 3, &["`GRIND`", "subprograms"]),
    ("four_axes.src", 2, &["has 4 fields", "6 are wanted"]),
    ("two_tools.src", 3, &["the tool", "one is read"]),
    ("no_z.src", 2, &["a position", "one with Z"]),
    ("circle_of_a_line.src", 4, &["the circle", "three points"]),
    ("unreachable.src", 4, &["path point 1", "reach"]),
    ("while.script", 2, &["`while`", "movej, movel"]),
    ("timed.script", 2, &["the time t is 2", "by its speed"]),
    ("unknown_name.script", 2, &["`home`", "a value before"]),
    (
        "pose_of_five.script",
        2,
        &["a pose has 5 fields", "6 are wanted"],
    ),
    ("five_joints.script", 2, &["holds 5 joints", "has 6"]),
    ("no_end.script", 2, &["ends here"]),
    (
        "negative_speed.script",
        2,
        &["the speed v is -0.1", "above zero"],
    ),
    ("not_a_number.script", 2, &["0x4", "finite number"]),
    (
        "nested_lists.script",
        2,
        &["the depth of calls and lists is 9", "at most 8"],
    ),
    (
        "endless.script",
        2,
        &["the speed in m/s is 1e-320", "at least 1e-6"],
    ),
    ("call.LS", 6, &["`CALL ../OTHER`", "UFRAME_NUM"]),
    ("missing_position.LS", 6, &["no P[2] to move to"]),
    ("timed.LS", 6, &["`2sec`", "mm/sec"]),
    ("two_groups.LS", 12, &["GP2", "one group"]),
    ("other_letters.LS", 9, &["X U T", "'N U T, 0, 0, 0'"]),
    ("two_turns.LS", 9, &["N U T", "'N U T, 0, 0, 0'"]),
    ("no_end.LS", 12, &["ends here", "/END"]),
    ("position_twice.LS", 13, &["P[1] is given twice", "line 7"]),
    ("no_such_branch.LS", 5, &["no posture", "N U B"]),
    ("five_joints.LS", 5, &["holds 5 joints", "has 6"]),
    (
        "skip.LS",
        6,
        &["SKIP CONDITION", "an instruction that moves nothing"],
    ),
    ("level.LS", 5, &["CNT is 101", "0 to 100"]),
    (
        "endless.MOD",
        10,
        &["the share of the top speed is", "at least 1e-6"],
    ),
    ("if.MOD", 11, &["`IF`", "MoveJ, MoveL"]),
    (
        "far_circle.script",
        16,
        &["a coordinate in mm is 2147484548", "no arm reaches"],
    ),
    ("two_tools.MOD", 11, &["`tool0`", "one tool is read"]),
    (
        "calls_itself.MOD",
        11,
        &["the depth of calls is 17", "at most 16"],
    ),
    ("offset_of_nothing.MOD", 11, &["no p9 to move to"]),
    ("call_up.JBI", 19, &["../OTHER", "A-Z, 0-9"]),
    (
        "RECUR.JBI",
        20,
        &["that is called is RECUR", "not under way"],
    ),
    (
        "ABSENT.JBI",
        20,
        &["that is called is NOWHERE", "NOWHERE.JBI"],
    ),
    ("level.JBI", 19, &["PL is 9", "from 0 to 8"]),
];

#[test]
fn every_faulty_program_is_refused_with_file_line_value_and_rule() {
    let fixtures = folder("../../tests/invalid_input/dialects");
    for (name, line, quotes) in FAULTS {
        let file = fixtures.join(name);
        let error = read_with(&file, &Settings::default()).expect_err(name);
        let report = error.to_string();
        assert_eq!(error.line(), Some(*line), "{report}");
        for quote in *quotes {
            assert!(report.contains(quote), "`{quote}` is not in: {report}");
        }
    }
    let files = std::fs::read_dir(fixtures).expect("fixtures");
    let names = files.map(|file| file.expect("a file").file_name().into_string());
    let names = names.map(|name| name.expect("a name"));
    let unlisted: Vec<String> = names
        .filter(|name| !FAULTS.iter().any(|f| f.0 == name))
        .collect();
    assert!(unlisted.is_empty(), "{unlisted:?}");
}

#[test]
fn no_dialect_writes_a_speed_that_no_arm_has() {
    let robot = assets::robot("hp20");
    let mut program = sample("part.LS");
    for name in ["jbi", "rapid", "krl", "urscript", "ls"] {
        let dialect = dialect_named(name).expect(name);
        let mut settings = Settings::default();
        if name == "jbi" {
            let date = serde_json::json!("2026-01-31 12:00");
            settings.options.insert("date".to_owned(), date);
        }
        let mut write = |speed_m_per_s: f64| {
            program.moves[1].motion = Motion::Linear { speed_m_per_s };
            dialect.write(&program, &robot, &settings)
        };
        write(1.0).expect(name);
        let error = write(11.0).expect_err(name).to_string();
        assert!(
            error.contains("speed in m/s is 11") && error.contains("at most 10"),
            "{error}"
        );
    }
}

/// However short a step takes: a joint that would have to be there at once is too fast.
#[test]
fn a_speed_beyond_all_bounds_is_too_fast_for_the_joints() {
    let robot = assets::robot("hp20");
    let mut program = sample("part.LS");
    for speed_m_per_s in [50.0, 1e8, 1e300] {
        program.moves[1].motion = Motion::Linear { speed_m_per_s };
        let replay = program.replay(&robot, &ReplayOptions::default());
        let is_fast = |one: &Finding| matches!(one.kind, FindingKind::TooFast { .. });
        assert!(replay.findings.iter().any(is_fast), "{speed_m_per_s}");
        let fastest = replay.fastest.expect("a line").0;
        assert!(fastest > 1.0, "{speed_m_per_s}: {fastest}");
    }
}

/// A program of one move too many, and the line of that move: in a job and in an `.LS` the line of
/// its position, which comes before.
fn one_too_many(name: &str) -> (String, usize) {
    let count = MOST_POINTS + 1;
    let lines = |one: &dyn Fn(usize) -> String| (0..count).map(one).collect::<String>();
    match name {
        "long.mod" => {
            let one = "MoveL [[900,0,500],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v100,z1,tool0;\n";
            let body = lines(&|_| one.to_owned());
            (
                format!("MODULE long\nPROC main()\n{body}ENDPROC\nENDMODULE\n"),
                2 + count,
            )
        }
        "long.src" => {
            let body = lines(&|_| "LIN {X 900,Y 0,Z 500,A 0,B 90,C 0,S 2,T 0}\n".to_owned());
            (format!("DEF long()\n$VEL.CP=0.1\n{body}END\n"), 2 + count)
        }
        "long.ls" => {
            let moves = lines(&|i| format!("{}:L P[{}] 100mm/sec FINE ;\n", i + 1, i + 1));
            let positions = lines(&|i| {
                let numbers = "X = 900 mm, Y = 0 mm, Z = 500 mm, W = 180 deg, P = 0 deg, R = 0 deg";
                format!(
                    "P[{}]{{\nGP1:\nUF : 0, UT : 1, CONFIG : 'N U T, 0, 0, 0',\n{numbers}\n}};\n",
                    i + 1
                )
            });
            let text = format!("/PROG LONG\n/MN\n{moves}/POS\n{positions}/END\n");
            (text, 3 + count + 5 * (count - 1) + 1)
        }
        _ => {
            let head = "/JOB\n//NAME LONG\n//POS\n///NPOS 500001,0,0,0,0,0\n///TOOL 0\n///POSTYPE BASE\n\
                        ///RECTAN\n///RCONF 1,0,0,0,0,0\n";
            let positions =
                lines(&|i| format!("C{i:05}=900.000,0.000,500.000,180.0000,0.0000,0.0000\n"));
            (format!("{head}{positions}//INST\n"), 8 + count)
        }
    }
}

/// Every dialect is refused at the move that is one too many, before postures are looked for.
#[test]
fn a_program_of_too_many_moves_is_refused_at_the_first_of_them() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["long.mod", "long.src", "long.ls", "long.JBI"] {
        let (text, line) = one_too_many(name);
        let file = folder.path().join(name);
        std::fs::write(&file, text).expect("a program");
        let error = read_with(&file, &Settings::default()).expect_err("too many");
        assert_eq!(error.line(), Some(line), "{name}: {error}");
        let rule = format!("at most {MOST_POINTS}");
        assert!(error.to_string().contains(&rule), "{name}: {error}");
    }
}

/// As G-code of as many points: refused before postures are looked for, at the first move too many.
#[test]
fn a_script_of_too_many_moves_is_refused_at_the_first() {
    let mut text = String::from("def long():\n");
    for _ in 0..=MOST_POINTS {
        text.push_str("  movej([0,0,0,0,0.5,0], a=1, v=1)\n");
    }
    text.push_str("end\n");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("long.script");
    std::fs::write(&file, text).expect("a script");
    let error = read_with(&file, &Settings::default()).expect_err("too many");
    assert_eq!(error.line(), Some(MOST_POINTS + 2), "{error}");
    assert!(
        error.to_string().contains(&MOST_POINTS.to_string()),
        "{error}"
    );
}

/// A job between whose moves others are called, and two that call each other.
#[test]
fn jobs_are_read_in_the_order_of_their_calls() {
    let job = |name: &str, y_mm: [f64; 2], between: &str| {
        let place = |y: f64| format!("900.000,{y:.3},600.000,180.0000,0.0000,0.0000");
        let [a, b] = y_mm.map(place);
        format!(
            "/JOB\n//NAME {name}\n//POS\n///NPOS 2,0,0,0,0,0\n///TOOL 1\n///POSTYPE BASE\n///RECTAN\n\
             ///RCONF 0,0,0,0,0,0\nC00000={a}\nC00001={b}\n//INST\n///DATE 2026/01/31 12:00\n\
             ///ATTR SC,RW\n///GROUP1 RB1\nNOP\nMOVJ C00000 VJ=10.00\nDOUT OT#(3) ON\n{between}\
             DOUT OT#(3) OFF\nMOVL C00001 V=20.0\nEND\n"
        )
    };
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: String| {
        let file = folder.path().join(format!("{name}.JBI"));
        std::fs::write(&file, text).expect("a job");
        file
    };
    let main = write(
        "MAIN",
        job("MAIN", [0.0, 50.0], "CALL JOB:PART\nCALL JOB:PART\n"),
    );
    write("PART", job("PART", [10.0, 20.0], "CALL JOB:LEAF\n"));
    write("LEAF", job("LEAF", [14.0, 16.0], ""));
    let settings = Settings {
        spindle_signal: Some("3".to_owned()),
        ..Settings::default()
    };
    let program = read_with(&main, &settings).expect("jobs");
    let y_mm = program
        .moves
        .iter()
        .map(|one| one.base_from_tool.translation.y * 1e3);
    let y_mm: Vec<f64> = y_mm.map(f64::round).collect();
    let part = [10.0, 14.0, 16.0, 20.0];
    assert_eq!(y_mm, [&[0.0][..], &part, &part, &[50.0]].concat());
    let switches: Vec<(usize, bool)> = (program.spindle.iter())
        .map(|one| (one.before, one.on))
        .collect();
    let wanted = [
        (1, true),
        (2, true),
        (3, true),
        (3, false),
        (4, false),
        (6, true),
    ];
    assert_eq!(switches[..6], wanted);
    assert_eq!(switches.last(), Some(&(9, false)));

    let one = write("ONE", job("ONE", [0.0, 1.0], "CALL JOB:TWO\n"));
    write("TWO", job("TWO", [0.0, 1.0], "CALL JOB:ONE\n"));
    let error = read_with(&one, &settings).expect_err("a circle of calls");
    assert!(
        error.path().expect("a file").ends_with("TWO.JBI"),
        "{error}"
    );
    assert_eq!(error.line(), Some(18), "{error}");
}

/// A Universal Robots arm has no wrist centre and no closed form here: lines are followed by the
/// posture before, all the way.
#[test]
fn a_script_brings_back_the_postures_of_an_arm_without_a_wrist_centre() {
    let robot = assets::robot("ur10e");
    let down = nalgebra::UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.3);
    let points: Vec<PathPoint> = (0..6)
        .map(|i| PathPoint {
            base_from_tool: Isometry3::from_parts(
                nalgebra::Translation3::new(0.6, 0.2 + 0.02 * f64::from(i), 0.4),
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
