//! Where a file from CAM does not say the way: nothing is led to a place that was not said.

use std::path::Path;

use nalgebra::Vector3;
use proptest::prelude::*;
use truecut_plan::cam::{self, Attitude, CamOptions, CamPath};
use truecut_plan::program::ProgramError;

fn read(text: &str, name: &str) -> Result<CamPath, ProgramError> {
    cam::read(text, Path::new(name), &CamOptions::default())
}

fn gcode(text: &str) -> CamPath {
    read(text, "x.nc").expect(text)
}

/// Places in mm, rounded to a micrometre, with their lines.
fn places(path: &CamPath) -> Vec<(usize, [f64; 3])> {
    let mm = |m: f64| (m * 1e6).round() / 1e3 + 0.0;
    let each = path.points.iter();
    each.map(|point| (point.line, point.place_m.map(mm).into()))
        .collect()
}

fn is_noted(path: &CamPath, line: usize, quote: &str) -> bool {
    let head = format!("line {line}: ");
    let here = |note: &String| note.starts_with(&head) && note.contains(quote);
    path.notes.iter().any(here)
}

/// Heads as posts write them: X and Y before the height, which is not 0.
#[test]
fn a_path_begins_where_all_axes_have_a_place() {
    let heads = [
        "G28 G91 Z0.\nG90\nG0 X20. Y30.\nG43 Z50. H1\n",
        "G91 G28 Z0.\nG90\nG0 X20. Y30. S5000 M3\nG43 H1 Z50.\n",
        "G53 G0 Z0.\nG90\nG0 X20. Y30.\nG43 H01 Z50.\n",
        "G90\nG0 Z50.000\nG0 X1.\nG0 X20.000 Y30.000\n",
        "G91\nG0 X7. Y8. Z-9.\nG90 G0 X20. Y30.\nZ50.\n",
    ];
    for head in heads {
        let path = gcode(&format!("{head}G1 Z-2. F300.\nM30\n"));
        let wanted = [(4, [20.0, 30.0, 50.0]), (5, [20.0, 30.0, -2.0])];
        assert_eq!(places(&path), wanted, "{head}");
        assert_eq!(path.points[0].feed_m_per_s, None);
        assert!(
            is_noted(&path, 4, "the path begins here"),
            "{:?}",
            path.notes
        );
    }
    let plain = gcode("G21 G90 G0 X20 Y30 Z50\nG1 Z-2 F300\n");
    assert_eq!(plain.notes, Vec::<String>::new());
}

/// The only retract between two pockets is the machine's own.
#[test]
fn a_retract_of_the_machine_leads_out_and_back_at_the_greatest_height() {
    for own in ["G53 G0 Z0.", "G28 G91 Z0.\nG90", "G30 G91 Z0.\nG90"] {
        let text = format!(
            "G90 G0 X10 Y10 Z50\nG1 Z-8 F300\nX30\n{own}\nG0 X5 Y5\nG0 X60 Y30\nG43 H01 Z20\nG1 Z-8\nX70\n{own}\nM30\n"
        );
        let path = gcode(&text);
        let found: Vec<[f64; 3]> = places(&path).into_iter().map(|(_, mm)| mm).collect();
        let wanted = [
            [10.0, 10.0, 50.0],
            [10.0, 10.0, -8.0],
            [30.0, 10.0, -8.0],
            [30.0, 10.0, 50.0],
            [60.0, 30.0, 50.0],
            [60.0, 30.0, 20.0],
            [60.0, 30.0, -8.0],
            [70.0, 30.0, -8.0],
            [70.0, 30.0, 50.0],
        ];
        assert_eq!(found, wanted, "{own}");
        let rapid: Vec<bool> = path
            .points
            .iter()
            .map(|p| p.feed_m_per_s.is_none())
            .collect();
        let cuts = [1, 2, 6, 7];
        let wanted: Vec<bool> = (0..9).map(|k| !cuts.contains(&k)).collect();
        assert_eq!(rapid, wanted, "{own}");
        assert!(is_noted(&path, 4, "Z 50.000 mm"), "{:?}", path.notes);
    }
}

/// G28 goes by way of the point that it gives; the spindle stops where the file stops it.
#[test]
fn the_point_on_the_way_and_the_spindle_keep_their_places() {
    let text =
        "G90 G0 X0 Y0 Z5 S900 M3\nG1 Z-3 F300\nG28 X1 Y2 Z80\nM5\nG0 X0 Y0 Z5\nM3\nG1 Z-3\nM30\n";
    let path = gcode(text);
    let found: Vec<[f64; 3]> = places(&path).into_iter().map(|(_, mm)| mm).collect();
    let wanted = [
        [0.0, 0.0, 5.0],
        [0.0, 0.0, -3.0],
        [1.0, 2.0, 80.0],
        [0.0, 0.0, 80.0],
        [0.0, 0.0, 5.0],
        [0.0, 0.0, -3.0],
    ];
    assert_eq!(found, wanted);
    let switches: Vec<(usize, bool)> = path.switches().collect();
    assert_eq!(switches, [(0, true), (3, false), (5, true)]);
}

/// A cut that begins at a place that the file does not say.
#[test]
fn a_cut_from_an_unknown_place_is_refused_with_the_axes_and_why() {
    for (text, line, quotes) in [
        (
            "G90 G0 X1 Y1\nG1 Z-8 F300\n",
            2,
            ["G1 with Z unknown", "no line before it says"],
        ),
        (
            "G90\nG1 X5 Y5 F300\n",
            2,
            ["G1 with X, Y, Z unknown", "no line before it says"],
        ),
        (
            "G91\nG0 X1 Y1 Z1\nG1 Z-1 F300\n",
            3,
            ["G1 with X, Y, Z unknown", "a rapid in G90"],
        ),
        (
            "G90 G0 X0 Y0 Z5\nG53 G0 Z0\nG0 X9 Y9\nG1 Z-8 F300\n",
            4,
            ["G1 with Z unknown", "G53 in line 2"],
        ),
        (
            "G90 G0 X0 Y0 Z5\nG28\nG2 X9 Y9 Z5 I4.5 J4.5 F300\n",
            3,
            ["G2 with X, Y, Z unknown", "G28 in line 2"],
        ),
        (
            "G90 G0 X0 Y0 Z5 A0\nG28 A0\nG1 X9 F300\n",
            3,
            ["G1 with A unknown", "G28 in line 2"],
        ),
    ] {
        let error = read(text, "x.nc").expect_err(text);
        assert_eq!(error.line(), Some(line), "{error}");
        for quote in quotes {
            assert!(error.to_string().contains(quote), "{error}");
        }
    }
}

/// The tool comes back in another attitude: out along the first axis, across where it is out along
/// both, and in along the second. No file leaves the way to chance where it turns further.
#[test]
fn a_tool_that_leans_leaves_and_comes_back_along_its_axes() {
    let text = "G90 G43.4 G0 X0 Y0 Z50 B0\nG1 Z0 F600\nG53 G0 Z0\nG0 X80 Y0 Z10 B90\nG1 X60\nM30\n";
    let path = gcode(text);
    let found: Vec<[f64; 3]> = places(&path).into_iter().map(|(_, mm)| mm).collect();
    let wanted = [
        [0.0, 0.0, 50.0],
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 50.0],
        [80.0, 0.0, 50.0],
        [80.0, 0.0, 10.0],
        [60.0, 0.0, 10.0],
    ];
    assert_eq!(found, wanted);
    let leans = |k: usize| match path.points[k].attitude {
        Attitude::Axis(axis) => axis.angle(&Vector3::z()).to_degrees().round(),
        Attitude::Whole(_) => f64::NAN,
    };
    assert_eq!([2, 3, 4].map(leans), [0.0, 0.0, 90.0]);
    let turned = text.replace("B90", "B120");
    let error = read(&turned, "x.nc").expect_err("too far");
    assert_eq!(error.line(), Some(4), "{error}");
    assert!(error.to_string().contains("120.000"), "{error}");
}

#[test]
fn apt_goes_home_and_comes_back_in_rapid_traverse() {
    let head = "UNITS/MM\nFROM/0,0,40\nFEDRAT/600,MMPM\nGOTO/0,0,-5\n";
    for word in ["GOHOME", "RETRCT"] {
        let path = read(
            &format!("{head}{word}\nRAPID\nGOTO/50,0,10\nGOTO/50,0,-5\nFINI\n"),
            "x.apt",
        );
        let path = path.expect(word);
        let found: Vec<[f64; 3]> = places(&path).into_iter().map(|(_, mm)| mm).collect();
        let wanted = [
            [0.0, 0.0, 40.0],
            [0.0, 0.0, -5.0],
            [0.0, 0.0, 40.0],
            [50.0, 0.0, 40.0],
            [50.0, 0.0, 10.0],
            [50.0, 0.0, -5.0],
        ];
        assert_eq!(found, wanted, "{word}");
        assert!(is_noted(&path, 5, word), "{:?}", path.notes);
        let error = read(&format!("{head}{word}\nGOTO/50,0,10\nFINI\n"), "x.apt");
        let error = error.expect_err(word);
        assert_eq!(error.line(), Some(6), "{error}");
        assert!(
            error.to_string().contains(&format!("{word} in line 5")),
            "{error}"
        );
    }
}

#[test]
fn what_has_no_effect_or_may_be_cut_short_is_told() {
    let inch = CamOptions {
        unit_m: 0.0254,
        ..CamOptions::default()
    };
    let text = "G21 G90 G0 X0 Y0 Z5\n/G1 Z0 F600\n";
    let path = cam::read(text, Path::new("x.nc"), &inch).expect(text);
    assert!(is_noted(&path, 1, "G21"), "{:?}", path.notes);
    assert!(is_noted(&path, 2, "begins with /"), "{:?}", path.notes);
    assert!(gcode(text).notes.iter().all(|note| !note.contains("G21")));
    let long = read(
        "FROM/0,0,5,0,0,1.5\nRAPID\nGOTO/0,0,9,0,0,1\nFINI\n",
        "x.apt",
    );
    let long = long.expect("APT");
    assert!(is_noted(&long, 1, "not a unit vector"), "{:?}", long.notes);
    assert_eq!(long.notes.len(), 1);
    let open = read("FEDRAT/600,MMPM\nGOTO/0,0,5\n", "x.apt").expect("APT");
    assert!(is_noted(&open, 2, "without FINI"), "{:?}", open.notes);
}

/// Where the moves with feed contradict the spindle of a scenario.
#[test]
fn what_the_file_says_of_the_spindle_is_compared() {
    let told = |words: &str, rpm: f64| {
        let text = format!("G90 {words} G0 X0 Y0 Z5\nG1 Z0 F600\n");
        gcode(&text).spindle_at_cuts().contradictions(rpm)
    };
    assert_eq!(told("S6000 M3", 6000.0), Vec::<String>::new());
    assert_eq!(told("M3", 6000.0), Vec::<String>::new());
    for (words, quote) in [
        ("", "does not start the spindle"),
        ("S6000", "does not start the spindle"),
        ("S6000 M4", "counter-clockwise"),
        ("S12000 M3", "at 12000 1/min"),
    ] {
        let told = told(words, 6000.0);
        assert_eq!(told.len(), 1, "{words}: {told:?}");
        assert!(
            told[0].starts_with("line 2: ") && told[0].contains(quote),
            "{told:?}"
        );
    }
    let apt = "FROM/0,0,5\nSPINDL/RPM,4000,CCLW\nFEDRAT/600,MMPM\nGOTO/0,0,0\nFINI\n";
    let apt = read(apt, "x.apt").expect("APT").spindle_at_cuts();
    assert_eq!(
        (apt.counter, apt.off, apt.rpm),
        (Some(4), None, vec![(4, 4000.0)])
    );
}

proptest! {
    /// Whatever a file leaves out, the tool goes across no lower than the highest place that the
    /// file says, and no point has a coordinate that it does not say.
    #[test]
    fn no_rapid_goes_across_below_the_height_of_the_file(
        blocks in prop::collection::vec((0..4_usize, 1..9_i32, 1..9_i32, -9..9_i32), 1..30),
    ) {
        let mut text = String::from("G90 G0 X0 Y0 Z20\nF600\n");
        for (kind, x, y, z) in blocks {
            text += &match kind {
                0 => "G53 G0 Z0\n".to_owned(),
                1 => format!("G0 X{x} Y{y}\n"),
                2 => format!("G0 Z{z}\n"),
                _ => format!("G1 X{x} Z{z}\n"),
            };
        }
        let Ok(path) = read(&text, "x.nc") else {
            // A cut after a retract.
            prop_assert!(text.contains("G53"));
            return Ok(());
        };
        let lines: Vec<&str> = text.lines().collect();
        let mut known = true;
        let mut at = 0;
        for pair in path.points.windows(2) {
            let (a, b) = (pair[0].place_m, pair[1].place_m);
            for &said in &lines[at..pair[1].line.max(at)] {
                known = said != "G53 G0 Z0" && (known || said.contains('Z'));
            }
            at = pair[1].line;
            let across = (a - b).xy().norm() > 1e-9;
            let said = lines[pair[1].line - 1];
            // Moves across come of blocks that say them with a known height, or go at the top.
            if across && !said.contains('X') {
                prop_assert!((a.z - 0.02).abs() < 1e-12 && (b.z - 0.02).abs() < 1e-12, "{}", text);
            }
            if across && said.starts_with("G0 X") {
                prop_assert!(known, "{}", text);
            }
        }
    }
}
