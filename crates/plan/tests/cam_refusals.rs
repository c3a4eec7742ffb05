//! Paths from CAM that are refused: with their line, their value and the rule.

use std::path::{Path, PathBuf};

use nalgebra::Isometry3;
use proptest::prelude::*;
use truecut_plan::cam::{self, CamOptions, CamPath};
use truecut_plan::program::{MOST_POINTS, ProgramError, Start};

use crate::assets;
use crate::cam_run;

fn read(text: &str, name: &str) -> Result<CamPath, ProgramError> {
    cam::read(text, Path::new(name), &CamOptions::default())
}

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/invalid_input/cam")
}

/// File, line of the fault, quotes.
const FAULTS: &[(&str, usize, &[&str])] = &[
    (
        "cutter_compensation.nc",
        3,
        &["`G41`", "compensation of the cutter's radius"],
    ),
    ("canned_cycle.nc", 3, &["`G81`", "canned cycles"]),
    ("subprogram.nc", 3, &["`M98`", "subprograms"]),
    ("macro.nc", 3, &["`G65`", "subprograms"]),
    ("unknown_word.nc", 3, &["`Q2`", "one of X Y Z"]),
    ("unknown_code.nc", 3, &["`G5.1`", "a code that is read"]),
    ("unknown_auxiliary.nc", 3, &["`M66`", "a code that is read"]),
    ("open_arc.nc", 4, &["does not close", "0.2000", "0.01 mm"]),
    (
        "small_radius.nc",
        4,
        &["does not close", "9.9", "10.0000 mm"],
    ),
    (
        "far_arc.nc",
        4,
        &["radius of a circle in mm is 9000000000000", "write a line"],
    ),
    (
        "far_point.nc",
        3,
        &["a coordinate in mm is 109", "at most 1000000 mm"],
    ),
    (
        "far_circle.apt",
        4,
        &["radius of a circle in mm is 1000000000000", "write a line"],
    ),
    ("whole_turn_by_radius.nc", 4, &["chord", "needs I, J, K"]),
    (
        "arc_without_centre.nc",
        4,
        &["an arc", "I, J, K or its radius R"],
    ),
    ("centre_off_the_plane.nc", 4, &["K of an arc", "plane G17"]),
    ("feed_missing.nc", 3, &["a move with feed", "F, before it"]),
    ("feed_of_zero.nc", 3, &["the feed F is 0", "above zero"]),
    ("no_motion.nc", 2, &["a place", "G0, G1, G2 or G3"]),
    ("two_tools.nc", 4, &["the tool T is 2", "one tool is read"]),
    ("bad_number.nc", 3, &["`X1.2.3`", "a letter and a number"]),
    (
        "open_comment.nc",
        3,
        &["(to the corner", "ends in its line"],
    ),
    ("word_twice.nc", 3, &["the word X is 6", "once in a block"]),
    ("second_offset.nc", 3, &["offset G is 55", "one work frame"]),
    (
        "several_turns.nc",
        4,
        &["turns P of an arc is 3", "more than one turn"],
    ),
    ("no_axis.nc", 3, &["the tool's axis is 0", "above zero"]),
    ("empty.nc", 3, &["ends here", "any point"]),
    (
        "cut_before_its_height.nc",
        3,
        &["G1 with Z unknown", "no line before it says"],
    ),
    (
        "cut_after_a_machine_move.nc",
        5,
        &["G1 with Z unknown", "G53 in line 3"],
    ),
    ("two_motions.nc", 3, &["the move is G1", "says G0 before"]),
    (
        "feed_of_light.nc",
        3,
        &["the feed F is 99999999999", "at most 10000 mm/s"],
    ),
    (
        "endless.nc",
        3,
        &["the feed F is 0.000001", "at least 0.001 mm/s"],
    ),
    (
        "home_without_rapid.apt",
        6,
        &["a move with feed", "RAPID before", "GOHOME in line 5"],
    ),
    (
        "circle_without_end.apt",
        4,
        &["ends here", "the GOTO that ends the CIRCLE"],
    ),
    ("column_twice.csv", 1, &["the column is x_mm", "given once"]),
    ("two_units.csv", 1, &["units of the place is 2"]),
    ("half_in_two_units.csv", 1, &["units of the place is 2"]),
    (
        "feed_of_light.csv",
        3,
        &["feed_mm_per_s is 1e12", "at most 10000 mm/s"],
    ),
    ("cycle.apt", 4, &["`CYCLE`", "canned cycles"]),
    ("cutcom.apt", 2, &["`CUTCOM`", "compensation"]),
    (
        "second_system.cls",
        8,
        &[
            "MSYS is 100,50,0,0,1,0,-1,0,0",
            "that of line 2",
            "one is read",
        ],
    ),
    (
        "late_system.cls",
        4,
        &["MSYS is 0,0,5", "before the first point"],
    ),
    ("unknown_word.apt", 4, &["`GOFWD`", "GOTO, FROM"]),
    (
        "feed_missing.apt",
        3,
        &["a move with feed", "FEDRAT or RAPID"],
    ),
    (
        "no_axis.apt",
        4,
        &["GOTO of three numbers", "the tool's axis"],
    ),
    ("open_arc.apt", 5, &["does not close", "0.0499", "0.01 mm"]),
    ("per_revolution.apt", 2, &["`MMPR`", "by the minute"]),
    (
        "four_numbers.apt",
        3,
        &["GOTO has 4 fields", "3 are wanted"],
    ),
    ("unit.apt", 1, &["`FEET`", "MM, CM or INCHES"]),
    (
        "open_statement.apt",
        3,
        &["ends here", "the end of the statement"],
    ),
    ("no_attitude.csv", 1, &["the head", "gives the attitude"]),
    ("no_feed.csv", 1, &["the head", "feed_mm_per_s"]),
    ("not_unit.csv", 3, &["qw to qz is 2", "1, to 1e-3"]),
    ("not_a_number.csv", 3, &["y_mm is NaN", "finite number"]),
    ("ragged.csv", 2, &["the table", "as many cells"]),
];

#[test]
fn every_faulty_path_is_refused_with_file_line_value_and_rule() {
    for (file, line, quotes) in FAULTS {
        let path = fixtures().join(file);
        let text = std::fs::read_to_string(&path).expect(file);
        let error = cam::read(&text, &path, &CamOptions::default()).expect_err(file);
        let report = error.to_string();
        assert_eq!(error.line(), Some(*line), "{report}");
        for quote in *quotes {
            assert!(report.contains(quote), "`{quote}` is not in: {report}");
        }
    }
    let files = std::fs::read_dir(fixtures()).expect("fixtures");
    let names = files.map(|file| file.expect("a file").file_name().into_string());
    let names = names.map(|name| name.expect("a name"));
    let unlisted: Vec<String> = names
        .filter(|name| name != "unreachable.nc" && !FAULTS.iter().any(|f| f.0 == name))
        .collect();
    assert!(unlisted.is_empty(), "{unlisted:?}");
}

#[test]
fn a_point_out_of_reach_is_named_by_its_line() {
    let file = fixtures().join("unreachable.nc");
    let text = std::fs::read_to_string(&file).expect("the fixture");
    let path = cam::read(&text, &file, &CamOptions::default()).expect("G-code");
    let before = Isometry3::translation(0.9, 0.0, 0.3);
    let robot = assets::robot("hp20");
    let followed = cam_run::follow(Start::AtRest, &robot, &path, &file, before);
    let error = followed.expect_err("out of reach");
    assert_eq!(error.line(), Some(5), "{error}");
    assert!(error.to_string().contains("reach"), "{error}");
}

/// A million lines: refused by the number of their points, at the line of the first one too many.
#[test]
fn a_million_lines_are_refused_at_the_first_point_too_many() {
    let mut text = String::from("G21 G90 G0 X0 Y0 Z0\nG1 F600\n");
    for i in 0..1_000_000 {
        text.push_str(if i % 2 == 0 { "X1\n" } else { "X0\n" });
    }
    let error = read(&text, "x.nc").expect_err("too many");
    let report = error.to_string();
    assert!(report.contains(&MOST_POINTS.to_string()), "{report}");
    assert_eq!(error.line(), Some(MOST_POINTS + 2), "{report}");

    let mut poses = String::from("# bench\nx_mm,y_mm,z_mm,feed_mm_per_s,i,j,k\n");
    for i in 0..1_000_000 {
        poses.push_str(if i % 2 == 0 { "1,0,0,10,0,0,1\n" } else { "\n" });
    }
    assert!(read(&poses, "x.csv").is_ok_and(|path| path.points.len() == MOST_POINTS));
    poses.push_str("0,0,0,10,0,0,1\n");
    let error = read(&poses, "x.csv").expect_err("too many");
    assert_eq!(error.line(), Some(1_000_003), "{error}");
    assert!(error.to_string().contains("at most 500000"), "{error}");
}

proptest! {
    /// Any text is read, or refused with its name and a line that it has.
    #[test]
    fn any_text_is_answered(text in "([GMXYZIJKRFSTABC][-+.0-9]{1,4} ?|\\n|\\(|\\)|;|/|GOTO/|CIRCLE/|,|\\$){0,60}") {
        for name in ["x.nc", "x.apt", "x.csv"] {
            if let Err(error) = read(&text, name) {
                prop_assert_eq!(error.path(), Some(Path::new(name)));
                let line = error.line().expect("a line");
                prop_assert!((1..=text.lines().count() + 1).contains(&line), "{}", error);
            }
        }
    }
}
