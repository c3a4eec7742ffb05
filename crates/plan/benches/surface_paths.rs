//! Lines on the bumpy hub spoke, 20 000 points: laid on the face, then followed by the HP20. And
//! from the file of a part in 200 000 triangles to lines on its face.

use std::fmt::Write as _;
use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Translation3, Vector3};
use truecut_arm::Robot;
use truecut_plan::program::TravelOptions;
use truecut_plan::surface::{MeshFace, MeshFile, PatchFile};
use truecut_plan::surface_path::{
    AxisRule, ContactWheel, FeedAlong, PathOptions, Segment, Strategy, SurfacePath, plan_path,
    solve,
};

const WHEEL: ContactWheel = ContactWheel {
    radius_m: 0.04,
    width_m: 0.025,
    indentation_m: 0.5e-3,
    line_load_n_per_m: 1200.0,
    modulus_pa: 8e6,
};

/// The shoulder in front, the wrist not flipped.
const START_DEG: [f64; 6] = [-6.2, 6.516, -34.775, -3.616, -31.231, -80.996];

fn laid(patch: &PatchFile) -> SurfacePath {
    let options = PathOptions {
        rule: AxisRule::WidestSwath {
            edge_gap_limit_m: 1e-3,
        },
        overlap: 0.2,
        step_m: 0.035e-3,
        margin_m: 0.0,
    };
    let (surface, strategy) = (patch.surface.as_ref(), Strategy::IsoParametric);
    plan_path(surface, None, &WHEEL, strategy, FeedAlong::U, &options).expect("a path")
}

/// Quads along each side of the block's top and bottom.
const FINE: usize = 222;

/// Height of the block's top, mm.
fn top_mm(x: f64, y: f64) -> f64 {
    20.0 + 3.0 * (0.04 * x).sin() + 2.0 * (0.05 * y).cos()
}

/// A block of 100 by 100 mm under a wavy top, as an OBJ file.
fn block() -> String {
    let mut text = String::new();
    let at_mm = |k: usize| 100.0 * k as f64 / FINE as f64;
    for is_top in [true, false] {
        for k in 0..(FINE + 1) * (FINE + 1) {
            let (x, y) = (at_mm(k / (FINE + 1)), at_mm(k % (FINE + 1)));
            let z = if is_top { top_mm(x, y) } else { 0.0 };
            let _ = writeln!(text, "v {x} {y} {z}");
        }
    }
    let below = (FINE + 1) * (FINE + 1);
    let corner = |i: usize, j: usize| i * (FINE + 1) + j + 1;
    for k in 0..FINE * FINE {
        let (i, j) = (k / FINE, k % FINE);
        let [a, b, c, d] = [
            corner(i, j),
            corner(i + 1, j),
            corner(i + 1, j + 1),
            corner(i, j + 1),
        ];
        let _ = writeln!(text, "f {a} {b} {c} {d}");
        let [a, b, c, d] = [a, b, c, d].map(|k| k + below);
        let _ = writeln!(text, "f {a} {d} {c} {b}");
    }
    let mut around: Vec<usize> = (0..FINE).map(|i| corner(i, 0)).collect();
    around.extend((0..FINE).map(|j| corner(FINE, j)));
    around.extend((1..=FINE).rev().map(|i| corner(i, FINE)));
    around.extend((1..=FINE).rev().map(|j| corner(0, j)));
    for (a, b) in around.iter().zip(around.iter().cycle().skip(1)) {
        let _ = writeln!(text, "f {a} {} {} {b}", a + below, b + below);
    }
    text
}

/// From a file of 199 000 triangles to lines on its top.
fn faces(c: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("block.obj");
    std::fs::write(&file, block()).expect("written");
    let face = MeshFace {
        mesh: MeshFile { file, unit_m: 1e-3 },
        point_m: Vector3::new(50.0, 50.0, top_mm(50.0, 50.0)) * 1e-3,
        crease_rad: 0.5,
        deviation_m: 0.03e-3,
        u_along: None,
    };
    let options = PathOptions {
        rule: AxisRule::WidestSwath {
            edge_gap_limit_m: 1e-3,
        },
        overlap: 0.2,
        step_m: 2e-3,
        margin_m: 0.0,
    };
    let lines = |patch: &PatchFile| {
        let (surface, strategy) = (patch.surface.as_ref(), Strategy::IsoParametric);
        plan_path(surface, None, &WHEEL, strategy, FeedAlong::U, &options).expect("a path")
    };
    let mut group = c.benchmark_group("faces of meshes");
    group.sample_size(10);
    group.bench_function("lines on a mesh of 199 000 triangles, from its file", |b| {
        b.iter(|| lines(&face.load().expect("a face")));
    });
    group.finish();
}

/// The spoke lies 1 m before the arm.
fn before_the_arm(path: &SurfacePath) -> Vec<Segment> {
    let to_place = Translation3::new(1.0, -0.1, 0.45);
    let lines = path.poses(0.03).into_iter();
    lines
        .map(|line| Segment::Planned(line.iter().map(|pose| to_place * pose).collect()))
        .collect()
}

fn surface_paths(c: &mut Criterion) {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
    let patch = PatchFile::load(&assets.join("surfaces/hub_spoke.toml")).expect("the asset");
    let robot = Robot::load(&assets.join("robots/hp20/robot.urdf"), None, None).expect("the asset");
    let segments = before_the_arm(&laid(&patch));
    let start = START_DEG.map(f64::to_radians);
    let travel = TravelOptions {
        largest_step: 0.2,
        ..TravelOptions::default()
    };
    let mut group = c.benchmark_group("surface paths");
    group.sample_size(10);
    group.bench_function("laid, 20 000 points", |b| b.iter(|| laid(&patch)));
    group.bench_function("followed by the arm, 20 000 points", |b| {
        b.iter(|| solve(&robot, &segments, &start, &travel).expect("reached"));
    });
    group.finish();
}

criterion_group!(benches, surface_paths, faces);
criterion_main!(benches);
