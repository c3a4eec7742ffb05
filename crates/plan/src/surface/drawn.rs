//! Patches drawn at random, for tests.

use nalgebra::Vector3;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use super::NurbsPatch;

/// Control points along u and v.
const NET: [usize; 2] = [8, 6];

/// Values of a strategy, the same for the same seed.
pub(crate) fn seeded<S: Strategy>(seed: u8, strategy: &S) -> S::Value {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    strategy.new_tree(&mut runner).expect("a value").current()
}

/// Heights from -1 to 1 for [`patch`].
pub(crate) fn heights(seed: u8) -> Vec<f64> {
    seeded(seed, &prop::collection::vec(-1.0..1.0, NET[0] * NET[1]))
}

/// A cubic patch, 160 by 100 mm, whose control points stand up to `rise_m` off by heights drawn at
/// random; `bow_m` bends it into an arch.
pub(crate) fn patch(heights: &[f64], rise_m: f64, bow_m: f64) -> NurbsPatch {
    let [rows, columns] = NET;
    let share = |k: usize, of: usize| k as f64 / (of - 1) as f64;
    let point = |i: usize, j: usize| {
        let (s, t) = (share(i, rows), share(j, columns));
        let arch = 4.0 * bow_m * s * (1.0 - s);
        let z = 0.04 + arch + rise_m * heights[i * columns + j];
        Vector3::new(0.16 * s, 0.1 * t, z)
    };
    let knots = |points: usize| -> Vec<f64> {
        let inner = points - 3;
        (0..points + 4)
            .map(|k| (k.saturating_sub(3).min(inner)) as f64 / inner as f64)
            .collect()
    };
    let net: Vec<Vec<_>> = (0..rows)
        .map(|i| (0..columns).map(|j| point(i, j)).collect())
        .collect();
    let ones = vec![vec![1.0; columns]; rows];
    NurbsPatch::new([3, 3], NET.map(knots), &net, &ones).expect("a patch")
}
