//! A path of 20 000 points: branches chosen, written and read back.

use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use truecut_arm::Robot;
use truecut_plan::program::{Motion, PathPoint, Program, Tool, TravelOptions, jbi};

/// A raster over 200 mm by 200 mm, the tool tilting and turning on the way.
fn raster() -> Vec<PathPoint> {
    let point = |i: i32| {
        let (row, column) = (i / 200, i % 200);
        let along = if row % 2 == 0 { column } else { 199 - column };
        let place = Translation3::new(
            0.8 + 0.001 * f64::from(along),
            -0.1 + 0.002 * f64::from(row),
            0.5,
        );
        let turn = 0.3 * (0.01 * f64::from(i)).sin();
        PathPoint {
            base_from_tool: Isometry3::from_parts(
                place,
                UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.3, turn),
            ),
            motion: Motion::Linear {
                speed_m_per_s: 0.02,
            },
            turntable_rad: None,
        }
    };
    (0..20_000).map(point).collect()
}

fn programs(c: &mut Criterion) {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/hp20/robot.urdf");
    let robot = Robot::load(&urdf, None, None).expect("the asset loads");
    let points = raster();
    let travel = TravelOptions::default();
    let base = Isometry3::identity();
    let plan = || {
        let tool = Tool::of(&robot, "wheel", 1);
        Program::along(&robot, "RASTER", tool, base, &points, &travel).expect("a program")
    };
    let program = plan();
    let date = jbi::JobDate::new(2026, 1, 31, 12, 0).expect("a date");
    let options = jbi::JbiOptions::new(date);
    let mut group = c.benchmark_group("programs");
    group.sample_size(10);
    group.bench_function("shortest travel, 20 000 points", |b| b.iter(plan));
    group.bench_function("written as jobs and read back, 20 000 points", |b| {
        b.iter(|| {
            let files = jbi::write(&program, &robot, &options).expect("jobs");
            let read = files[1..].iter().map(|file| {
                let job = jbi::JbiJob::parse(&file.text, file.name.as_ref()).expect("a job");
                let part = job.program(&robot, &program.tool, &base, None);
                part.expect("a program").moves.len()
            });
            assert_eq!(read.sum::<usize>(), 20_000);
        });
    });
    group.finish();
}

criterion_group!(benches, programs);
criterion_main!(benches);
