//! Files as people write them in the five dialects; what of them is refused; what controllers ask
//! of those that are written.

use crate::assets;
mod controllers;
mod documented;
mod misread;
mod refused;

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Vector3};
use truecut_plan::program::{
    Frames, Motion, Program, ProgramError, Settings, SpindleSwitch, Tool, Zone, dialect_of,
    read_text,
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
        "1 digital outputs are set that are not the spindle's",
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
