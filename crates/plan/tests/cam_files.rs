//! Paths from CAM: what is read.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use nalgebra::{Isometry3, Vector3};
use truecut_plan::cam::{self, Attitude, CamOptions, CamPath};
use truecut_plan::program::{Program, ProgramError, Settings, Start, Zone, dialect_named};

use crate::assets;
use crate::cam_run;

fn read(text: &str, name: &str) -> Result<CamPath, ProgramError> {
    cam::read(text, Path::new(name), &CamOptions::default())
}

fn gcode(text: &str) -> CamPath {
    read(text, "x.nc").expect("G-code")
}

fn places_mm(path: &CamPath) -> Vec<[f64; 3]> {
    let each = path.points.iter();
    each.map(|point| (point.place_m * 1e3).into()).collect()
}

fn near(found: [f64; 3], wanted: [f64; 3]) -> bool {
    found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9)
}

#[test]
fn modes_hold_until_they_are_changed() {
    let path =
        gcode("G0 X0 Y0 Z0 G20\nG91 G0 X1 Y1 (inches, steps)\nX1\nG21 G90 G1 X0 F600 ; mm\nY0\n");
    let found = places_mm(&path);
    let wanted = [
        [0.0; 3],
        [25.4, 25.4, 0.0],
        [50.8, 25.4, 0.0],
        [0.0, 25.4, 0.0],
        [0.0; 3],
    ];
    assert!(
        found.iter().zip(wanted).all(|(a, b)| near(*a, b)),
        "{found:?}"
    );
    let feeds: Vec<Option<f64>> = path.points.iter().map(|p| p.feed_m_per_s).collect();
    assert_eq!(feeds, [None, None, None, Some(0.01), Some(0.01)]);
    let lines: Vec<usize> = path.points.iter().map(|p| p.line).collect();
    assert_eq!(lines, [1, 2, 3, 4, 5]);
}

/// A file that was cut short anywhere says so, if it was to end with what it began with.
#[test]
fn a_file_without_its_end_is_told() {
    let whole = "%\nG21 G90\nG0 X1 Y1 Z5\nG1 Z0 F600\nX20\nY50\n";
    let is_told = |text: &str| {
        let notes = gcode(text).notes;
        notes
            .iter()
            .any(|note| note.contains("it may be cut short"))
    };
    for end in ["M30\n%\n", "M2\n", "%\n"] {
        assert!(!is_told(&format!("{whole}{end}")), "{end}");
    }
    assert!(!is_told(&whole[2..]), "no tape, no end");
    for length in whole.find("Z5").unwrap()..whole.len() {
        let text = &whole[..length];
        let read = read(text, "x.nc");
        assert!(read.is_err() || is_told(text), "{text}");
    }
}

/// Length of a helix: the root of the squares of turn and rise. Chords that lie within a millionth
/// of the radius are too short by a third of that.
#[test]
fn verify_a_helix_has_its_length() {
    let fine = CamOptions {
        chord_m: 1e-8,
        ..CamOptions::default()
    };
    let text = "G21 G90 G0 X10 Y0 Z0\nG3 X10 Y0 Z4 I-10 J0 F600\n";
    let path = cam::read(text, Path::new("x.nc"), &fine).expect("a helix");
    let length: f64 = (path.points.windows(2))
        .map(|pair| (pair[1].place_m - pair[0].place_m).norm())
        .sum();
    let wanted = (TAU * 0.01).hypot(0.004);
    assert!((length - wanted).abs() < 1e-6 * wanted, "{length} {wanted}");
}

/// Four arcs from (0, 0) to (10, 10): clockwise and counter-clockwise, the short way and the long
/// one (a negative radius).
#[test]
fn verify_arcs_by_radius_have_their_centres() {
    for (code, radius, centre) in [
        (2, 10.0, [10.0, 0.0]),
        (3, 10.0, [0.0, 10.0]),
        (2, -10.0, [0.0, 10.0]),
        (3, -10.0, [10.0, 0.0]),
    ] {
        let path = gcode(&format!(
            "G90 G0 X0 Y0 Z0\nG{code} X10 Y10 R{radius} F600\n"
        ));
        let centre = Vector3::new(centre[0], centre[1], 0.0) * 1e-3;
        let mut turned = 0.0;
        for pair in path.points.windows(2) {
            let [a, b] = [pair[0].place_m - centre, pair[1].place_m - centre];
            assert!((b.norm() - 0.01).abs() < 1e-12);
            turned += a.cross(&b).z.atan2(a.dot(&b));
        }
        let sign = if code == 3 { 1.0 } else { -1.0 };
        let wanted = if radius > 0.0 { 0.5 * PI } else { 1.5 * PI };
        assert!(
            (turned - sign * wanted).abs() < 1e-9,
            "G{code} R{radius}: {turned}"
        );
    }
}

/// Clockwise from the start the arc first leaves along the plane's second axis: in G18, which is
/// seen against y, G2 turns from z to x.
#[test]
fn verify_the_sense_of_arcs_in_the_three_planes() {
    for (plane, end, first, second) in [
        ("G17", "X10 Y10 I10 J0", 0, 1),
        ("G18", "Z10 X10 K10 I0", 2, 0),
        ("G19", "Y10 Z10 J10 K0", 1, 2),
    ] {
        let path = gcode(&format!("G90 G0 X0 Y0 Z0\n{plane} G2 {end} F600\n"));
        let half = path.points[path.points.len() / 2].place_m * 1e3;
        assert!(half[second] - half[first] > 1.0, "{plane}: {half}");
    }
}

#[test]
fn the_axis_follows_rotary_words_or_vectors() {
    let path = gcode("G90 G43.4 G0 X0 Y0 Z0\nG1 X1 A90 F600\nA0 B90\nB90 C90\n");
    let axes = path.points.iter().map(|p| match p.attitude {
        Attitude::Axis(axis) => axis.into_inner().into(),
        Attitude::Whole(_) => [0.0; 3],
    });
    let axes: Vec<[f64; 3]> = axes.collect();
    let wanted = [
        [0.0, 0.0, 1.0],
        [0.0, -1.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    assert!(
        axes.iter().zip(wanted).all(|(a, b)| near(*a, b)),
        "{axes:?}"
    );
    let path = gcode("G90 G0 X0 Y0 Z0\nG1 X1 I3 J0 K4 F600\n");
    let Attitude::Axis(axis) = path.points[1].attitude else {
        panic!("no axis");
    };
    assert!(near(axis.into_inner().into(), [0.6, 0.0, 0.8]));
}

#[test]
fn what_moves_nothing_is_noted_by_its_line() {
    let path = gcode(
        "G90 G0 X0 Y0 Z5\nT3 M6\nS9000 M3\nG28 G91 Z0\nG90 G0 Z5\nG1 X5 F600 M8\nM5\nM30\nX9\n",
    );
    // Already out: the machine's own move adds no point.
    assert_eq!(path.points.len(), 3);
    assert_eq!(path.switches().collect::<Vec<_>>(), [(1, true), (3, false)]);
    assert_eq!(path.spindle[0].rpm, Some(9000.0));
    for quote in ["line 2: T3", "line 4: G28", "line 6: M8"] {
        assert!(
            path.notes.iter().any(|note| note.starts_with(quote)),
            "{:?}",
            path.notes
        );
    }
}

#[test]
fn a_unit_that_the_file_does_not_say_is_noted() {
    let is_noted = |text| {
        let notes = gcode(text).notes;
        notes.iter().any(|note| note.contains("units of 1 mm"))
    };
    assert!(is_noted("G90 G0 X0 Y0 Z5\nG1 X5 F600\n"));
    assert!(!is_noted("G21 G90 G0 X0 Y0 Z5\nG1 X5 F600\n"));
    assert!(!is_noted("G20 G90 G0 X0 Y0 Z5\nG1 X5 F60\n"));
}

#[test]
fn apt_gives_points_axes_feeds_and_arcs() {
    let text = "PARTNO/PLATE $$ a comment\nUNITS/MM\nMULTAX/ON\nLOADTL/2\nSPINDL/RPM,8000,CLW\n\
                FROM/0,0,50,0,0,1\nFEDRAT/600,MMPM\nGOTO/10,0,0,$\n0,0,1\nCIRCLE/0,0,0,0,0,1,10\n\
                GOTO/0,10,0,0,0,1\nRAPID\nGOTO/0,10,50,0,0,1\nSPINDL/OFF\nFINI\n";
    let path = read(text, "x.apt").expect("APT");
    let points = &path.points;
    let last = points.len() - 1;
    assert_eq!(
        [points[0].line, points[1].line, points[last].line],
        [6, 8, 13]
    );
    let feeds = [points[0], points[1], points[last - 1], points[last]].map(|p| p.feed_m_per_s);
    assert_eq!(feeds, [None, Some(0.01), Some(0.01), None]);
    for point in &points[1..last] {
        assert!((point.place_m.norm() - 0.01).abs() < 1e-12);
    }
    assert!(
        points.len() > 8,
        "a quarter of a circle in {} points",
        points.len()
    );
    let switches: Vec<(usize, bool)> = path.switches().collect();
    assert_eq!(switches, [(0, true), (points.len(), false)]);
    let inches = read("UNITS/INCHES\nFEDRAT/60,IPM\nGOTO/1,0,0\n", "x.apt").expect("APT");
    assert!((inches.points[0].place_m.x - 0.0254).abs() < 1e-15);
    assert!((inches.points[0].feed_m_per_s.expect("a feed") - 0.0254).abs() < 1e-15);
}

fn follow(text: &str, file: &Path) -> Result<Program, ProgramError> {
    let path = cam::read(text, file, &CamOptions::default())?;
    let before = Isometry3::translation(0.9, 0.0, 0.3);
    cam_run::follow(Start::AtRest, &assets::robot("hp20"), &path, file, before)
}

#[test]
fn the_tool_points_against_its_axis_into_the_work() {
    let text = "G90 G0 X0 Y0 Z20\nG1 Z0 F600\nX10 A20\n";
    let program = follow(text, Path::new("x.nc")).expect("a program");
    let axis = program.moves[2].base_from_tool.rotation * Vector3::z();
    let lean = 20_f64.to_radians();
    assert!(
        (axis - Vector3::new(0.0, lean.sin(), -lean.cos())).norm() < 1e-9,
        "{axis}"
    );
    let place = program.moves[2].base_from_tool.translation.vector;
    assert!(
        (place - Vector3::new(0.91, 0.0, 0.3)).norm() < 1e-12,
        "{place}"
    );
}

/// A whole turn, a helix and a line, with or without exact stop.
fn curved(mode: &str) -> String {
    format!(
        "G21 G90 G17 {mode} F600\nG0 X0 Y0 Z0\nG2 X0 Y0 I20 J0\nG3 X10 Y10 Z4 R10\nG1 X20\nM30\n"
    )
}

/// Exact stop counts where blocks end: points within arcs and helices are passed, and nothing else
/// tells the path from one under G64.
#[test]
fn exact_stop_is_at_the_ends_of_blocks() {
    let [exact, blended] = ["G61", "G64"].map(|mode| gcode(&curved(mode)).points);
    assert!(exact.len() > 80, "{} points", exact.len());
    for (k, point) in exact.iter().enumerate() {
        let next = exact.get(k + 1);
        let ends = next.is_none_or(|next| next.line != point.line);
        assert_eq!(point.stops, ends, "point {k} of line {}", point.line);
        let passed = cam::CamPoint {
            stops: false,
            ..*point
        };
        assert_eq!(passed, blended[k], "point {k}");
    }
    assert_eq!(exact.len(), blended.len());
}

/// A program under G61 has one `fine` a block, and the zone of G64 within arcs.
#[test]
fn exact_stop_is_written_once_a_block() {
    let robot = assets::robot("hp20");
    let rapid = dialect_named("rapid").expect("a dialect");
    // The first and the last point are stopped at in either.
    for (mode, zones, fine) in [("G61", 4, 4), ("G64", 1, 2)] {
        let program = follow(&curved(mode), Path::new("x.nc")).expect("a program");
        let stops = program.moves.iter().filter(|one| one.zone == Zone::Stop);
        assert_eq!(stops.count(), zones, "{mode}");
        let files = rapid.write(&program, &robot, &Settings::default());
        let files = files.expect("a module");
        let text = &files[0].text;
        assert_eq!(text.matches(",fine,").count(), fine, "{mode}");
        let passed = program.moves.len() - fine;
        assert_eq!(text.matches(",z1,").count(), passed, "{mode}");
    }
}

/// Whatever delimits the cells, in whatever unit the columns are named.
#[test]
fn poses_of_other_units_and_delimiters_are_the_same_path() {
    let read =
        |text: &str| cam::read(text, Path::new("p.csv"), &CamOptions::default()).expect(text);
    let plain = read(
        "x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg,feed_mm_per_s\n100.5,-20,3,180,0,90,\n101.5,-20,3,180,0,90,15\n",
    );
    let turned = std::f64::consts::PI;
    let others = [
        "x_mm;y_mm;z_mm;roll_deg;pitch_deg;yaw_deg;feed_mm_per_s\r\n100,5;-20;3;180;0;90;\r\n101,5;-20;3;180;0;90;15\r\n"
            .to_owned(),
        "x_m\ty_m\tz_m\troll_deg\tpitch_deg\tyaw_deg\tfeed_mm_per_min\n.1005\t-.02\t.003\t180\t0\t90\t\n\
         .1015\t-.02\t.003\t180\t0\t90\t900\n"
            .to_owned(),
        format!(
            "feed_m_per_s,yaw_rad,roll_rad,pitch_rad,x_mm,y_mm,z_mm\r,{0},{turned},0,100.5,-20,3\r.015,{0},{turned},0,\
             101.5,-20,3\r",
            0.5 * turned
        ),
    ];
    for text in others {
        let other = read(&text);
        assert_eq!(other.points.len(), 2, "{text}");
        for (a, b) in plain.points.iter().zip(&other.points) {
            assert!((a.place_m - b.place_m).norm() < 1e-12, "{text}");
            let feeds = [a, b].map(|it| it.feed_m_per_s.unwrap_or(0.0));
            assert!((feeds[0] - feeds[1]).abs() < 1e-12, "{text}");
            let (cam::Attitude::Whole(a), cam::Attitude::Whole(b)) = (&a.attitude, &b.attitude)
            else {
                panic!("{text}");
            };
            assert!(a.angle_to(b) < 1e-9, "{text}");
        }
    }
}
