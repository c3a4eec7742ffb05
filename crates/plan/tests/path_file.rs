//! An arm led along a file: what is filtered, where corners are rounded, what a robot program says.

use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use truecut_arm::{FrameId, Robot};
use truecut_plan::cam::{CamOptions, Rapid, WorkSetup};
use truecut_plan::motion::trajectory::WINDOW_S;
use truecut_plan::path_file::{PathFile, PathFileKind, PathFileMotion};
use truecut_plan::program::{
    Motion, Options, PathPoint, Program, ProgramError, Settings, Start, Tool, TravelOptions,
    dialect_named,
};

use crate::assets;

const INTERVAL_S: f64 = 1e-3;
const LONGEST_S: f64 = 1e4;
/// Mean of the time after the middle of Hann's window, of its width: 1/8 − 1/(2π²).
const MEAN_AFTER: f64 = 0.125 - 0.5 / (PI * PI);

fn cam(file: &Path, world_from_work: Isometry3<f64>) -> PathFile {
    PathFile {
        file: file.to_owned(),
        kind: PathFileKind::Cam {
            options: CamOptions::default(),
            setup: WorkSetup {
                world_from_work,
                spin_rad: None,
                rapid: Rapid::Line {
                    speed_m_per_s: 0.25,
                },
                joint_share: 1.0,
                zone_m: None,
            },
            tool_from_tip: Isometry3::identity(),
        },
        joint_share: 1.0,
    }
}

fn written(folder: &Path, name: &str, text: &str) -> PathBuf {
    let file = folder.join(name);
    std::fs::write(&file, text).expect("a file in a folder of its own");
    file
}

fn led(path: &PathFile, robot: &Robot) -> Result<PathFileMotion, ProgramError> {
    path.motion(robot, Start::AtRest, INTERVAL_S, LONGEST_S)
}

/// Places of the tool, in the work frame.
fn places(
    found: &PathFileMotion,
    robot: &Robot,
    world_from_work: &Isometry3<f64>,
) -> Vec<Vector3<f64>> {
    let knots = found.motion.knots.iter();
    let world = knots.map(|q| robot.world_from_frame(q, FrameId::Tool));
    world
        .map(|pose| (world_from_work.inverse() * pose).translation.vector)
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// At a corner of φ the mean over Hann's window of a motion at v cuts by
    /// v T (1/8 − 1/2π²) sin φ; what is told is what the postures do.
    #[test]
    fn verify_a_corner_is_rounded_as_the_window_says(
        feed_mm_s in 10.0_f64..80.0,
        turn in 0.3_f64..PI / 2.0,
    ) {
        let robot = assets::robot("hp20");
        let folder = tempfile::tempdir().unwrap();
        let end: [f64; 2] = [50.0 + 50.0 * f64::cos(turn), 50.0 * f64::sin(turn)];
        let text = format!(
            "G21 G90 F{:.6}\nG1 X0 Y0 Z0\nG1 X50\nG1 X{:.6} Y{:.6}\nM30\n",
            feed_mm_s * 60.0,
            end[0],
            end[1]
        );
        let file = written(folder.path(), "corner.nc", &text);
        let work = Isometry3::translation(0.9, -0.02, 0.35);
        // The depth is that of the instant in the middle of the corner: to 0.4 % at this interval.
        let found = cam(&file, work).motion(&robot, Start::AtRest, 1e-4, LONGEST_S).unwrap();
        let (off_m, point) = found.motion.off;
        let expected = feed_mm_s * 1e-3 * WINDOW_S * MEAN_AFTER * turn.sin();
        prop_assert!((off_m / expected - 1.0).abs() < 0.01, "{off_m} {expected}");
        prop_assert_eq!(found.lines[point], 3);
        // The postures come off the corner by as much.
        let corner = Vector3::new(0.05, 0.0, 0.0);
        let near = (places(&found, &robot, &work).iter())
            .map(|place| (place - corner).norm())
            .fold(f64::INFINITY, f64::min);
        let both = 2.0 * feed_mm_s * 1e-3 * WINDOW_S * MEAN_AFTER * (0.5 * turn).sin();
        prop_assert!((near / both - 1.0).abs() < 0.01, "{near} {both}");
    }

    /// Where the path turns back, as between plunge and retract, the tool stays short of the end by
    /// v T (1/4 − 1/π²), which is told with the line that leads there.
    #[test]
    fn verify_a_reversal_is_short_by_what_is_told(
        feed_mm_s in 10.0_f64..80.0,
        turn in 0.6 * PI..PI,
    ) {
        let robot = assets::robot("hp20");
        let folder = tempfile::tempdir().unwrap();
        let back = |turn: f64| -> (f64, usize, f64) {
            let [x, y] = [50.0 + 40.0 * turn.cos(), 40.0 * turn.sin()];
            let text = format!(
                "G21 G90 F{:.6}\nG1 X0 Y0 Z0\nG1 X50\nG1 X{x:.6} Y{y:.6}\nM30\n",
                feed_mm_s * 60.0
            );
            let file = written(folder.path(), "back.nc", &text);
            let work = Isometry3::translation(0.9, -0.02, 0.35);
            let found = cam(&file, work).motion(&robot, Start::AtRest, 1e-4, LONGEST_S).unwrap();
            let (off_m, point) = found.motion.off;
            let furthest = (places(&found, &robot, &work).iter()).map(|place| place.x).fold(0.0, f64::max);
            (off_m, found.lines[point], 0.05 - furthest)
        };
        let (told, line, short) = back(PI);
        let expected = feed_mm_s * 1e-3 * WINDOW_S * 2.0 * MEAN_AFTER;
        prop_assert!((told / expected - 1.0).abs() < 0.01, "{told} {expected}");
        prop_assert!((short / expected - 1.0).abs() < 0.01, "{short} {expected}");
        prop_assert!([3, 4].contains(&line), "{line}");
        // Between a right angle and a half turn: no less than it stays short.
        let (told, _, short) = back(turn);
        prop_assert!(told >= 0.999 * short && short > 0.0, "{told} {short}");
    }

    /// A program of lines and moves by joints, written in each dialect, leads through all its
    /// poses; of those that are stopped at, exactly.
    #[test]
    fn every_dialect_leads_the_arm_through_its_poses(
        drawn in prop::collection::vec((prop::array::uniform3(-1.0_f64..1.0), prop::array::uniform3(-0.1_f64..0.1)), 7),
    ) {
        led_by_every_dialect(&drawn);
    }
}

/// Away from its ends a line is run through at the feed, place by place; where it stops (G61), in
/// its corner.
#[test]
fn verify_lines_are_exact_and_stops_are_reached() {
    let robot = assets::robot("hp20");
    let folder = tempfile::tempdir().unwrap();
    let text = "G21 G90 G61 F1800\nG1 X0 Y0 Z0\nG1 X40\nG1 X40 Y30\nM30\n";
    let file = written(folder.path(), "stops.nc", text);
    let work = Isometry3::translation(0.9, -0.02, 0.35);
    let found = led(&cam(&file, work), &robot).unwrap();
    assert!(found.motion.off.0 < 1e-9, "{:?}", found.motion.off);
    assert!((found.motion.length_m - 0.07).abs() < 1e-12);
    let places = places(&found, &robot, &work);
    let corner = Vector3::new(0.04, 0.0, 0.0);
    let near = (places.iter()).map(|place| (place - corner).norm());
    assert!(near.fold(f64::INFINITY, f64::min) < 1e-8);
    // Each line takes its time, a ramp of 0.3 s and the window.
    let expected_s = 0.07 / 0.03 + 2.0 * (0.3 + WINDOW_S);
    let taken_s = (places.len() - 1) as f64 * INTERVAL_S;
    assert!((taken_s - expected_s).abs() < 3.0 * INTERVAL_S, "{taken_s}");
    let fastest = (places.windows(2))
        .map(|pair| (pair[1] - pair[0]).norm() / INTERVAL_S)
        .fold(0.0, f64::max);
    assert!((fastest / 0.03 - 1.0).abs() < 1e-6, "{fastest}");
}

/// Exact stop counts at the ends of blocks: a circle of 20 mm with a line after it takes as long
/// under G61 as under G64, but for one more time of coming to rest and up again. Within the circle
/// the window takes v² T² (1/24 − 1/4π²)/r = 3.3 µm off, and a chord lies up to 10 µm off.
#[test]
fn verify_a_circle_is_passed_without_a_stop() {
    let robot = assets::robot("hp20");
    let folder = tempfile::tempdir().unwrap();
    let work = Isometry3::translation(0.9, -0.02, 0.35);
    let wanted_m = TAU * 0.02 + 0.04;
    for (mode, stretches) in [("G61", 2.0), ("G64", 1.0)] {
        let text = format!("G21 G90 G17 {mode} F1200\nG0 X0 Y0 Z0\nG2 X0 Y0 I20\nG1 X40\nM30\n");
        let file = written(folder.path(), &format!("{mode}.nc"), &text);
        let found = led(&cam(&file, work), &robot).unwrap();
        let length_m = found.motion.length_m;
        let apart = length_m / wanted_m - 1.0;
        assert!(apart.abs() < 2e-4, "{mode}: {length_m} {wanted_m}");
        let expected_s = length_m / 0.02 + stretches * (0.3 + WINDOW_S);
        let taken_s = (found.motion.knots.len() - 1) as f64 * INTERVAL_S;
        let late_s = taken_s - expected_s;
        assert!(late_s.abs() < 3.0 * INTERVAL_S, "{mode}: {taken_s} s");
        // Of the corner at the circle's end G64 takes 0.15 mm off.
        let (off_m, _) = found.motion.off;
        match mode {
            "G61" => assert!(off_m < 2e-5, "{off_m}"),
            _ => assert!(off_m > 1e-4, "{off_m}"),
        }
    }
}

/// A block that repeats the place before is no line, and no corner lies far from it: at the start,
/// in the middle and at the end.
#[test]
fn a_point_that_is_said_twice_changes_nothing_of_what_is_told() {
    let robot = assets::robot("hp20");
    let folder = tempfile::tempdir().unwrap();
    let work = Isometry3::translation(0.9, -0.02, 0.35);
    let blocks = ["G1 X0 Y0 Z0", "G1 X30", "G1 Y20", "G1 X0"];
    let found = |name: &str, repeated: &[usize]| {
        let mut text = "G21 G90 F1200\n".to_owned();
        for (i, block) in blocks.iter().enumerate() {
            let times = if repeated.contains(&i) { 2 } else { 1 };
            (0..times).for_each(|_| text.push_str(&format!("{block}\n")));
        }
        text.push_str("M30\n");
        let file = written(folder.path(), name, &text);
        led(&cam(&file, work), &robot).unwrap().motion
    };
    let once = found("once.nc", &[]);
    assert!((1e-5..1e-3).contains(&once.off.0), "{:?}", once.off);
    for repeated in [&[1][..], &[0], &[3], &[0, 1, 2, 3]] {
        let twice = found("twice.nc", repeated);
        assert_eq!(twice.knots, once.knots);
        let apart_m = (twice.off.0 - once.off.0).abs();
        assert!(
            apart_m < 1e-12,
            "{repeated:?}: {:?} {:?}",
            twice.off,
            once.off
        );
        let mut done_s = twice.reached_s.clone();
        done_s.dedup();
        assert_eq!(done_s, once.reached_s, "{repeated:?}");
    }
}

/// Places in a box of 100 mm, attitudes about downwards.
fn led_by_every_dialect(drawn: &[([f64; 3], [f64; 3])]) {
    let robot = assets::robot("hp20");
    let down = UnitQuaternion::from_euler_angles(PI, 0.0, 0.0);
    let point = |(k, (place, turn)): (usize, &([f64; 3], [f64; 3]))| PathPoint {
        base_from_tool: Isometry3::from_parts(
            Translation3::from(Vector3::new(0.9, 0.0, 0.4) + Vector3::from(*place) * 0.05),
            down * UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]),
        ),
        motion: match k {
            0 | 4 => Motion::Joint { share: 0.25 },
            _ => Motion::Linear {
                speed_m_per_s: 0.05,
            },
        },
        turntable_rad: None,
    };
    let points: Vec<PathPoint> = drawn.iter().enumerate().map(point).collect();
    let base = Isometry3::identity();
    let tool = Tool::of(&robot, "tool0", 1);
    // Between two points drawn freely a joint may go further than from contact to contact.
    let options = TravelOptions {
        largest_step: PI,
        ..TravelOptions::default()
    };
    let program = Program::along(&robot, "LED", tool, base, &points, &options).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for name in ["jbi", "rapid", "krl", "urscript", "ls"] {
        let dialect = dialect_named(name).unwrap();
        let mut options = Options::new();
        if name == "jbi" {
            options.insert("date".to_owned(), "2026-01-31 12:00".into());
        }
        let settings = Settings {
            options,
            ..Settings::default()
        };
        let files = dialect.write(&program, &robot, &settings).unwrap();
        for one in &files {
            written(folder.path(), &one.name, &one.text);
        }
        let path = PathFile {
            file: folder.path().join(&files[0].name),
            kind: PathFileKind::Program {
                dialect,
                world_from_base: base,
            },
            joint_share: 1.0,
        };
        let found = led(&path, &robot).unwrap_or_else(|error| panic!("{name}: {error}"));
        let places = places(&found, &robot, &base);
        for (k, point) in points.iter().enumerate() {
            let wanted = point.base_from_tool.translation.vector;
            let near = places.iter().map(|place| (place - wanted).norm());
            let near = near.fold(f64::INFINITY, f64::min);
            // The first, the last and those before and at a move by joints are stopped at.
            let allowed = match k {
                0 | 3 | 4 | 6 => 2e-6,
                _ => 0.05 * (2.0 * WINDOW_S * MEAN_AFTER + INTERVAL_S),
            };
            assert!(near <= allowed, "{name}, point {k}: {near}");
        }
    }
}

/// What no arm can be led along is told with the line of the file.
#[test]
fn what_cannot_be_led_is_told_with_its_line() {
    let robot = assets::robot("hp20");
    let folder = tempfile::tempdir().unwrap();
    let work = Isometry3::translation(0.9, 0.0, 0.35);
    for (name, text, line, says) in [
        (
            "far.nc",
            "G21 F600\nG1 X0 Y0 Z0\nG1 X3000\n",
            Some(3),
            "reach",
        ),
        ("still.nc", "G21 F600\nG1 X0 Y0 Z0\n", None, "one place"),
        (
            "fast.nc",
            "G21 F600\nG1 X-480 Y-400 Z0\nG1 X-470\nG1 Y400 F500000\n",
            Some(4),
            "deg/s",
        ),
        (
            "comp.nc",
            "G21 F600\nG1 X0 Y0 Z0\nG41 D1\nG1 X3\n",
            Some(3),
            "G41",
        ),
        (
            "slow.nc",
            "G21 F600\nG1 X0 Y0 Z0\nG1 X30 F0.1\n",
            Some(3),
            "faster feed",
        ),
        (
            "endless.nc",
            "G21 F600\nG1 X0 Y0 Z0\nG1 X30 F0.01\n",
            Some(3),
            "at least 0.001 mm/s (0.06 mm/min)",
        ),
    ] {
        let file = written(folder.path(), name, text);
        let error = led(&cam(&file, work), &robot).expect_err(name);
        assert_eq!(error.line(), line, "{name}: {error}");
        assert_eq!(error.path(), Some(file.as_path()), "{name}");
        assert!(error.to_string().contains(says), "{name}: {error}");
    }
}
