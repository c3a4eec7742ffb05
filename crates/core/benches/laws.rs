//! Cost of the analytic laws that run in every step.

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Isometry2, Matrix2, Point2, Vector2, Vector3};
use std::hint::black_box;
use truecut_core::cutting::chamfer::{ChipArea, CuttingCoefficients};
use truecut_core::cutting::milling::cut::{MillingCut, MillingParameters, ToolState};
use truecut_core::cutting::milling::cutter::Cutter;
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_core::cutting::rim::Rim;
use truecut_core::friction::{Approach, FrictionLaw, solve_planar};
use truecut_core::pressure_foot::{FootMemory, PressureFoot};
use truecut_core::wheel::Strip;
use truecut_core::wheel::face::Face;
use truecut_core::wheel::patch::Sliding;
use truecut_core::wheel::pneumatic::PneumaticWheel;
use truecut_core::wheel::quadrature::Quadrature;
use truecut_core::wheel::removal::{Placement, SurfaceGrid};

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
    let chip = ChipArea::new(0.8);
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

fn milling(c: &mut Criterion) {
    let cutter = Cutter {
        helix_angle_rad: 0.52,
        ..Cutter::straight(8e-3, 4)
    };
    let parameters = MillingParameters {
        cutter,
        coefficients: CuttingCoefficients::from_resultant(2e8, 2.1e9, 0.29),
        stock: Engagement::SLOT.stock(&cutter, 0.3e-3),
        feed_per_tooth_m: 0.1e-3,
        regeneration: true,
        steady_displacement_m: Vector3::zeros(),
        passes: 8,
        slice_lag_rad: 0.02,
    };
    let mut cut = MillingCut::new(parameters, None);
    let mut rotation_rad = 0.0;
    c.bench_function(
        "milling, evaluate and commit, four teeth, eight passes",
        |b| {
            b.iter(|| {
                rotation_rad += 0.025;
                let state = ToolState {
                    rotation_rad,
                    displacement_m: Vector3::new(1e-6, -2e-6, black_box(1e-7)),
                    ..ToolState::default()
                };
                let loads = cut.evaluate(&state);
                cut.commit(&state);
                loads
            });
        },
    );
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

fn finishing(c: &mut Criterion) {
    let wheel = PneumaticWheel {
        radius_m: 20e-3,
        pressure_pa: 0.1e6,
        shell_thickness_m: 5e-3,
        youngs_modulus_pa: 4e6,
        poisson: 0.49,
        damping_pa_s_per_m: 1e4,
    };
    let shell = wheel.shell();
    let face = Face::rectangle(0.1, 0.06).unwrap();
    let quadrature = Quadrature::default();
    let sliding = Sliding::about(Point2::new(-7e-3, 0.0), 100.0, 0.3);
    let inside = Isometry2::translation(-0.05, -0.03);
    let corner = Isometry2::translation(-0.099, -0.0595);
    c.bench_function("patch from indentation", |b| {
        b.iter(|| wheel.patch(&shell, black_box(1.5e-3)));
    });
    let patch = wheel.patch(&shell, 1.5e-3);
    for (name, pose) in [
        ("patch loads, inside", inside),
        ("patch loads, at a corner", corner),
    ] {
        c.bench_function(name, |b| {
            b.iter(|| patch.loads(&face, black_box(&pose), &sliding, &quadrature, |_| {}));
        });
    }
    let mut grid = SurfaceGrid::plane(200, 120, 0.1, 0.06);
    let placement = Placement {
        at_cells: Vector2::new(100.0, 60.0),
        patch_from_cells_m: Matrix2::identity() * 0.5e-3,
    };
    let mut scratch = Vec::new();
    c.bench_function("Preston removal on a grid of 0.5 mm", |b| {
        b.iter(|| {
            grid.spread(
                &placement,
                patch.window_m(),
                1e-3,
                4e-11,
                &mut scratch,
                |x, y| patch.moving_pressure_pa(x, y, &sliding) * sliding.at_m_per_s(x, y).norm(),
            );
        });
    });
}

criterion_group!(laws, friction, cutting, milling, contacts, finishing);
criterion_main!(laws);
