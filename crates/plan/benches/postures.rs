//! Cost of a thousand postures, and of a stability diagram of an arm.

#[path = "../../arm/tests/milling_arm/mod.rs"]
mod milling_arm;
#[path = "../tests/support/mod.rs"]
mod support;

use std::hint::black_box;

use criterion::{Criterion as Bench, criterion_group, criterion_main};
use milling_arm::robot;
use nalgebra::{Matrix3, Vector3};
use support::slot;
use truecut_arm::{Elbow, Shoulder};
use truecut_core::chatter::DirectionalMatrix;
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_plan::lobes::{LobeRequest, lobes};
use truecut_plan::motion::branch::BranchWish;
use truecut_plan::{Criterion, Cut, Family, Planner, PlannerOptions, ToolPath, modes_in_cut};

fn cut() -> Cut {
    let steel = DirectionalMatrix::planar(4, 2e9, 0.3, Engagement::SLOT);
    slot(&steel, 0.3e-3, 600.0)
}

const FAMILY: Family = Family {
    shoulder: Shoulder::Front,
    elbow: Elbow::Upper,
};

/// Seventeen places, sixty angles within reach: a thousand postures, from inverse kinematics to the
/// limit.
fn postures(bench: &mut Bench) {
    let points = [[1.05, -1.45, 0.87], [1.35, -1.45, 0.87]].map(Vector3::from);
    let path = ToolPath::new(&points, -Vector3::z_axis(), Vector3::x()).expect("a path");
    let (robot, cut) = (robot(), cut());
    let options = PlannerOptions {
        segment_m: 0.15,
        halvings: 2,
        branch: BranchWish {
            shoulder: Some(FAMILY.shoulder),
            elbow: Some(FAMILY.elbow),
            wrist: None,
        },
        ..PlannerOptions::default()
    };
    let mut group = bench.benchmark_group("a thousand postures");
    group.sample_size(10);
    for criterion in [Criterion::ModeCoupling, Criterion::Regenerative] {
        group.bench_function(criterion.to_string(), |b| {
            b.iter(|| {
                let planner = Planner::new(&robot, &path, &cut, &options).expect("in reach");
                let map = planner.map(criterion, FAMILY, 17).expect("modes");
                let count = map.assessments.iter().flatten().flatten().count();
                assert!((950..1100).contains(&count), "{count}");
                black_box(map)
            });
        });
    }
    group.finish();
}

fn diagram(bench: &mut Bench) {
    let (robot, cut) = (robot(), cut());
    let degrees: [f64; 6] = [-52.5034, 9.8275, 38.4479, -170.0007, 48.7107, 173.3639];
    let axes = Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::z()]);
    let posture = degrees.map(f64::to_radians);
    let modes = modes_in_cut(&robot, &posture, &axes, &cut.attached).expect("stiffness");
    let mut group = bench.benchmark_group("diagram of an arm, 100 x 100");
    group.sample_size(10);
    for (name, range_rpm) in [
        ("300 to 3000 rpm", [300.0, 3000.0]),
        ("60 to 750 rpm", [60.0, 750.0]),
    ] {
        let request = LobeRequest {
            spindle_rad_s: range_rpm.map(|rpm: f64| rpm * std::f64::consts::TAU / 60.0),
            deepest_m: 1e-3,
            speeds: 100,
            depths: 100,
        };
        group.bench_function(name, |b| {
            b.iter(|| {
                lobes(&|_| Ok(modes.clone()), black_box(&cut), &request, &|_| {}).expect("modes")
            })
        });
    }
    group.finish();
}

criterion_group!(benches, postures, diagram);
criterion_main!(benches);
