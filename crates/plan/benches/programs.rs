//! A path of 20 000 points: branches chosen, written and read back.

use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use truecut_arm::Robot;
use truecut_plan::program::{
    DIALECTS, Frames, Motion, PathPoint, Program, Settings, Tool, TravelOptions,
};

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

/// Largest distance (m) and angle (deg) between the poses of two programs.
fn worst(a: &Program, b: &Program) -> [f64; 2] {
    assert_eq!(a.moves.len(), b.moves.len());
    let mut worst = [0.0_f64; 2];
    for (a, b) in a.moves.iter().zip(&b.moves) {
        let (a, b) = (&a.base_from_tool, &b.base_from_tool);
        worst[0] = worst[0].max((a.translation.vector - b.translation.vector).norm());
        worst[1] = worst[1].max(a.rotation.angle_to(&b.rotation).to_degrees());
    }
    worst
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
    let frames = Frames {
        tool: program.tool.clone(),
        world_from_base: base,
    };
    let mut group = c.benchmark_group("programs");
    group.sample_size(10);
    group.bench_function("shortest travel, 20 000 points", |b| b.iter(plan));
    for dialect in DIALECTS {
        let date =
            (dialect.name() == "jbi").then(|| ("date".to_owned(), "2026-01-31 12:00".into()));
        let settings = Settings {
            options: date.into_iter().collect(),
            ..Settings::default()
        };
        let name = format!("written in {} and read back, 20 000 points", dialect.name());
        group.bench_function(name, |b| {
            b.iter(|| {
                let files = dialect.write(&program, &robot, &settings).expect("files");
                let text = |path: &Path| {
                    let found = files.iter().find(|file| path == Path::new(&file.name));
                    let found = found.map(|file| file.text.clone());
                    found.ok_or_else(|| std::io::ErrorKind::NotFound.into())
                };
                let main = Path::new(&files[0].name);
                let read = dialect.read(main, &text, &robot, &frames, &settings);
                let read = read.expect("a program");
                let worst = worst(&program, &read);
                assert!(
                    worst[0] <= 1e-5 && worst[1] <= 0.01,
                    "{}: {worst:?}",
                    dialect.name()
                );
            });
        });
    }
    group.finish();
}

criterion_group!(benches, programs);
criterion_main!(benches);
