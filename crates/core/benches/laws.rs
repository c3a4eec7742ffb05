//! Cost of the analytic laws that run in every step.

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Matrix2, Vector2};
use std::hint::black_box;
use truecut_core::cutting::chamfer::{ChipArea, CuttingCoefficients};
use truecut_core::cutting::rim::Rim;
use truecut_core::friction::{Approach, FrictionLaw, solve_planar};
use truecut_core::pressure_foot::{FootMemory, PressureFoot};
use truecut_core::wheel::Strip;

fn friction(c: &mut Criterion) {
    let body = Approach {
        inverse_mass: Matrix2::new(2e-3, 4e-4, 4e-4, 3e-3),
        velocity_before_m_per_s: Vector2::new(2e-3, -1e-3),
        free_velocity_m_per_s: Vector2::new(2.1e-3, -1.2e-3),
    };
    let stribeck = FrictionLaw::Stribeck {
        mu: 0.15,
        mu_static: 0.18,
        stribeck_speed_m_per_s: 1e-3,
    };
    let coulomb = FrictionLaw::Coulomb { mu: 0.15 };
    for (name, law, normal) in [
        ("friction, sticks", coulomb, 4e4),
        ("friction, slides", coulomb, 400.0),
        ("friction, Stribeck slides", stribeck, 400.0),
    ] {
        c.bench_function(name, |b| {
            b.iter(|| solve_planar(black_box(&body), law, normal, 2.5e-4));
        });
    }
}

fn cutting(c: &mut Criterion) {
    let chip = ChipArea {
        half_angle_rad: 0.8,
    };
    let k = CuttingCoefficients::from_resultant(1.96e9, 2.14e9, 0.3);
    c.bench_function("chip area and force", |b| {
        b.iter(|| {
            let area = chip.between_m2(black_box(5.2e-4), 4.7e-4);
            k.forces_n(area, chip.edge_length_m(5.2e-4))
                .on_tool_n(black_box(1.2), -1.0)
        });
    });
    let mut rim = Rim::new(1440, |_| 0.0, &[0.0], |_| 0.0);
    let mut angle = 0.0;
    c.bench_function("rim, read and cut", |b| {
        b.iter(|| {
            angle += 7.8e-3;
            let before = rim.depth_at_m(angle);
            rim.cut(0, angle, black_box(before + 1e-9));
        });
    });
}

fn contacts(c: &mut Criterion) {
    let foot = PressureFoot {
        preload_n: 482.5,
        gas_stiffness_n_per_m: 1.8e4,
        seal_stiction_n: 97.0,
        rod_stiffness_n_per_m: 5e7,
    };
    let memory = FootMemory::default();
    c.bench_function("pressure foot", |b| {
        b.iter(|| foot.force(black_box(1e-6), &memory));
    });
    let mut strip = Strip::new(0.2, 0.025, 400);
    c.bench_function("Preston removal", |b| {
        b.iter(|| strip.remove(black_box(0.1), 1e-2, 1e-12));
    });
}

criterion_group!(laws, friction, cutting, contacts);
criterion_main!(laws);
