//! What is refused: files at their line, programs of too many moves, speeds that no arm has.

use truecut_plan::program::{
    Finding, FindingKind, MOST_POINTS, Motion, ReplayOptions, Settings, dialect_named,
};

use super::{assets, folder, read_with, sample};

/// File, line of the fault, quotes.
const FAULTS: &[(&str, usize, &[&str])] = &[
    ("loop.src", 4, &["`FOR`", "branches, loops"]),
    ("no_speed.src", 3, &["`LIN`", "$VEL.CP"]),
    (
        "missing_position.src",
        2,
        &[
            "`XP1` is not read",
            "missing_position.dat, which would declare it, is not there",
            "$config.dat",
        ],
    ),
    ("no_end.src", 2, &["ends here"]),
    (
        "nested_structures.src",
        2,
        &["the depth of structures is 9", "at most 8"],
    ),
    ("subprogram.src", 3, &["`GRIND`", "a subprogram"]),
    ("four_axes.src", 2, &["has 4 fields", "6 are wanted"]),
    ("two_tools.src", 3, &["the tool", "one is read"]),
    ("no_z.src", 2, &["a position", "one with Z"]),
    ("circle_of_a_line.src", 4, &["the circle", "three points"]),
    ("unreachable.src", 4, &["path point 1", "reach"]),
    ("while.script", 2, &["`while` is not read", "loops"]),
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
    (
        "call.LS",
        6,
        &["`CALL ../OTHER` is not read", "another program"],
    ),
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
    ("if.MOD", 11, &["`IF` is not read", "branches or loops"]),
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
    ("call_up.JBI", 19, &["../OTHER", "A-Z, a-z, 0-9"]),
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
