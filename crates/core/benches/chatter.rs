//! Cost of stability diagrams.

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use std::hint::black_box;
use truecut_core::chatter::averaged::{mode_coupling_limit, zero_order_limit};
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_core::chatter::{DirectionalMatrix, TipMode};
use truecut_core::cutting::milling::engagement::Engagement;

fn arm() -> Vec<TipMode> {
    [6.0, 10.0, 19.1, 25.4, 39.3, 79.9]
        .iter()
        .enumerate()
        .map(|(i, hz)| TipMode {
            natural_frequency_rad_s: TAU * hz,
            damping_ratio: 0.02,
            shape_per_sqrt_kg: Vector3::new(
                0.04 * (1.0 + i as f64).sin(),
                0.05 * (2.0 * i as f64).cos(),
                0.03,
            ),
        })
        .collect()
}

/// Sum of |μ| over a diagram of `side` speeds by `side` depths.
fn diagram(elements: &SpectralElements, side: usize, slowest_s: f64, deepest_m: f64) -> f64 {
    let mut sum = 0.0;
    for i in 0..side {
        let at = elements.at(slowest_s / (1.0 + 4.0 * i as f64 / side as f64));
        for j in 0..side {
            let depth = deepest_m * (j + 1) as f64 / side as f64;
            sum += at.multiplier(depth).magnitude();
        }
    }
    sum
}

fn lobes(c: &mut Criterion) {
    let mut group = c.benchmark_group("lobe diagram");
    group.sample_size(10);
    let one = [TipMode::of_mass(TAU * 922.0, 0.011, 0.03993, &Vector3::x())];
    let slot = DirectionalMatrix::planar(2, 6e8, 1.0 / 3.0, Engagement::SLOT);
    let elements = SpectralElements::new(&one, &slot);
    group.bench_function("one mode, 100 x 100, one thread", |b| {
        b.iter(|| diagram(black_box(&elements), 100, 6e-3, 4e-3));
    });
    let two = [
        TipMode::of_stiffness(TAU * 603.0, 0.039, 5.59e6, &Vector3::x()),
        TipMode::of_stiffness(TAU * 666.0, 0.035, 5.715e6, &Vector3::y()),
    ];
    let elements = SpectralElements::new(&two, &slot);
    group.bench_function("two modes, 100 x 100, one thread", |b| {
        b.iter(|| diagram(black_box(&elements), 100, 6e-3, 4e-3));
    });
    let six = arm();
    let steel = DirectionalMatrix::planar(4, 2e9, 0.3, Engagement::SLOT);
    let elements = SpectralElements::new(&six, &steel);
    group.bench_function("six modes, 100 x 100, one thread", |b| {
        b.iter(|| diagram(black_box(&elements), 100, 20e-3, 4e-3));
    });
    group.finish();
}

fn limits(c: &mut Criterion) {
    let six = arm();
    let average = DirectionalMatrix::planar(4, 2e9, 0.3, Engagement::SLOT).average_pa();
    c.bench_function("mode-coupling limit of six modes", |b| {
        b.iter(|| mode_coupling_limit(black_box(&six), &average));
    });
    c.bench_function("zero-order limit of six modes", |b| {
        b.iter(|| zero_order_limit(black_box(&six), &average, 6.25e-3));
    });
}

criterion_group!(benches, lobes, limits);
criterion_main!(benches);
