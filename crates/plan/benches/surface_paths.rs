//! Lines on the bumpy hub spoke, 20 000 points: laid on the face, then followed by the HP20.

use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Translation3;
use truecut_arm::Robot;
use truecut_plan::program::TravelOptions;
use truecut_plan::surface::PatchFile;
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

criterion_group!(benches, surface_paths);
criterion_main!(benches);
