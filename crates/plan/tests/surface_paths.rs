//! Paths on surfaces, followed by the HP20: planned and taught segments, symmetry, what cannot be
//! followed.

use std::path::Path;

use nalgebra::{Isometry3, Translation3, Unit, Vector3};
use truecut_arm::{FrameId, Robot};
use truecut_plan::program::TravelOptions;
use truecut_plan::surface::PatchFile;
use truecut_plan::surface_path::{
    AxisRule, ContactWheel, FeedAlong, PathOptions, Segment, Strategy, SurfacePath, TaughtPoints,
    copies, plan_path, solve,
};

use crate::assets;

const WHEEL: ContactWheel = ContactWheel {
    radius_m: 0.04,
    width_m: 0.025,
    indentation_m: 0.5e-3,
    line_load_n_per_m: 1200.0,
    modulus_pa: 8e6,
};

/// A posture of the published example with the shoulder in front, θ5 > 0.
const START_DEG: [f64; 6] = [-6.2, 6.516, -34.775, -3.616, -31.231, -80.996];

/// A fifth of a radian from point to point.
const OPTIONS: fn() -> TravelOptions = || TravelOptions {
    largest_step: 0.2,
    ..TravelOptions::default()
};

fn asset(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets")
        .join(name)
}

fn robot() -> Robot {
    assets::robot("hp20")
}

fn start() -> Vec<f64> {
    START_DEG.map(f64::to_radians).to_vec()
}

fn spoke(step_m: f64) -> SurfacePath {
    let patch = PatchFile::load(&asset("surfaces/hub_spoke.toml")).expect("the asset");
    let options = PathOptions {
        // On top of the bumps the surface is curved by 10 1/m or more in every direction: a
        // stricter limit leaves no axis there.
        rule: AxisRule::WidestSwath {
            edge_gap_limit_m: 1e-3,
        },
        overlap: 0.2,
        step_m,
        margin_m: 0.0,
    };
    let (surface, strategy) = (patch.surface.as_ref(), Strategy::IsoParametric);
    plan_path(surface, None, &WHEEL, strategy, FeedAlong::U, &options).expect("a path")
}

/// The path where the arm reaches it, the spoke lying 1 m before the arm.
fn before_the_arm(path: &SurfacePath) -> Vec<Segment> {
    let to_place = Translation3::new(1.0, -0.1, 0.45);
    let line = |line: Vec<Isometry3<f64>>| {
        Segment::Planned(line.iter().map(|pose| to_place * pose).collect())
    };
    path.poses(0.03).into_iter().map(line).collect()
}

fn poses(segment: &Segment) -> Vec<Isometry3<f64>> {
    match segment {
        Segment::Planned(poses) => poses.clone(),
        Segment::Taught(_) => panic!("planned"),
    }
}

/// The arm's own kinematics put the tool where the plan wants it, at each of 20 000 points.
#[test]
fn twenty_thousand_points_are_reached() {
    let robot = robot();
    let segments = before_the_arm(&spoke(0.035e-3));
    let solved = solve(&robot, &segments, &start(), &OPTIONS()).expect("reached");
    let poses: Vec<_> = segments.iter().flat_map(poses).collect();
    let postures: Vec<_> = solved.iter().flatten().collect();
    assert!(poses.len() >= 20_000, "{}", poses.len());
    assert_eq!(poses.len(), postures.len());
    for (pose, q) in poses.iter().zip(postures) {
        let reached = robot.world_from_frame(q, FrameId::Tool);
        assert!((reached.translation.vector - pose.translation.vector).norm() < 1e-9);
        assert!(reached.rotation.angle_to(&pose.rotation) < 1e-7);
    }
}

#[test]
fn verify_copies_are_turned_about_the_axis() {
    let pose = Isometry3::translation(0.3, 0.0, 0.1);
    let centre = Vector3::new(0.1, 0.0, 0.0);
    let all = copies(&[pose], &centre, &Vector3::z_axis(), 5);
    assert_eq!(all.len(), 5);
    for (k, copy) in all.iter().enumerate() {
        let angle = std::f64::consts::TAU * k as f64 / 5.0;
        let expected = centre + Vector3::new(0.2 * angle.cos(), 0.2 * angle.sin(), 0.1);
        assert!((copy[0].translation.vector - expected).norm() < 1e-15);
    }
    let once = copies(&all[4], &centre, &Unit::new_normalize(Vector3::z()), 5);
    assert!((once[1][0].translation.vector - pose.translation.vector).norm() < 1e-15);
}

/// Edges are deburred by taught points between two planned segments; they come back exactly as they
/// were recorded.
#[test]
fn taught_points_are_mixed_with_planned_segments() {
    let (robot, mut segments) = (robot(), before_the_arm(&spoke(2e-3)));
    let text = "j1,j2,j3,j4,j5,j6\n-6,7,-34,-4,-31,-81\n-5,8.5,-33,-4,-32,-80\n";
    let taught = TaughtPoints::from_text(text, Path::new("edges.csv"), &robot).expect("two points");
    segments.insert(1, Segment::Taught(taught.clone()));
    let solved = solve(&robot, &segments, &start(), &OPTIONS()).expect("reached");
    assert_eq!(solved[1], taught.postures);
    assert!((taught.postures[1][1] - 8.5_f64.to_radians()).abs() < 1e-15);
}

/// The table that `truecut path` writes serves: the columns of the joints are found by their names.
#[test]
fn taught_columns_are_found_by_name_and_others_left_aside() {
    let robot = robot();
    let read = |text: &str| TaughtPoints::from_text(text, Path::new("path.csv"), &robot);
    let bare = read("j1,j2,j3,j4,j5,j6\n-6,7,-34,-4,-31,-81\n-5,8.5,-33,-4,-32,-80\n");
    let table = "point,line,x_mm,j6,j1,j2,j3,j4,j5,feed_mm_per_s\n\
                 0,2,1080.0,-81,-6,7,-34,-4,-31,\n1,3,1081.0,-80,-5,8.5,-33,-4,-32,20.000\n";
    assert_eq!(read(table).expect("a table"), bare.expect("taught points"));
    for (text, told) in [
        ("j1,j2,j3,j4,j5,j6,j6\n0,0,0,0,0,0,0\n", "once each"),
        ("j1,j2,j3,j4,j5,j6,j7\n0,0,0,0,0,0,0\n", "6 joints"),
        ("x_mm,j1,j2,j3,j4,j5,j6\n0,0,0,0,0,0\n", "7 columns"),
    ] {
        let error = read(text).expect_err(text).to_string();
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn taught_files_with_faults_are_refused_by_line() {
    let robot = robot();
    let refuse = |text: &str| {
        let refused = TaughtPoints::from_text(text, Path::new("edges.csv"), &robot);
        refused.expect_err("a fault").to_string()
    };
    let head = "j1,j2,j3,j4,j5,j6\n";
    let five = refuse("j1,j2,j3,j4,j5\n1,2,3,4,5\n");
    assert!(
        five.starts_with("edges.csv:1: ") && five.contains("6 joints"),
        "{five}"
    );
    let short = refuse(&format!("{head}0,0,0,0,0,0\n1,2,3\n"));
    assert!(short.starts_with("edges.csv:3: 3 values"), "{short}");
    let nan = refuse(&format!("{head}0,0,nan,0,0,0\n"));
    assert!(nan.starts_with("edges.csv:2: \"nan\""), "{nan}");
    let far = refuse(&format!("{head}0,0,0,0,0,999\n"));
    assert!(far.starts_with("edges.csv:2: "), "{far}");
    assert!(refuse(head).contains("no taught point"));
}

#[test]
fn points_that_cannot_be_reached_are_named() {
    let robot = robot();
    let poses = poses(&before_the_arm(&spoke(5e-3))[0]);
    let away: Vec<_> = (poses.iter().enumerate())
        .map(|(k, pose)| Translation3::new(0.02 * k as f64, 0.0, 0.0) * pose)
        .collect();
    let segments = [
        Segment::Planned(poses[..5].to_vec()),
        Segment::Planned(away),
    ];
    let refused = solve(&robot, &segments, &start(), &OPTIONS());
    let told = refused.expect_err("it leaves").to_string();
    assert!(
        told.contains("segment 2") && told.contains("path point "),
        "{told}"
    );
    let strict = TravelOptions {
        largest_step: 1e-4,
        ..OPTIONS()
    };
    let refused = solve(&robot, &segments[..1], &start(), &strict).expect_err("too strict");
    assert!(
        refused.to_string().contains("would have to jump"),
        "{refused}"
    );
}
