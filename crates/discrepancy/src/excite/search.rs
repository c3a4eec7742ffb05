//! The search for the best motion: an evolution strategy with covariance adaptation
//! (`hansen2016`) from random motions on, the same for the same seed.

use std::cell::{Cell, RefCell};
use std::convert::Infallible;

use basin::{CmaEs, CostFunction, DenseMatrix, Executor, PopulationProgress};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Deviation of the numbers of the first generation about those that it begins with.
const FIRST_STEP: f64 = 0.4;
/// The covariance is taken apart every so many generations.
const REFRESHED: u64 = 5;

/// The numbers of a random motion.
pub(super) fn drawn(dimension: usize, seed: u64, index: usize) -> Vec<f64> {
    let mut draw = ChaCha8Rng::seed_from_u64(seed);
    draw.set_stream(index as u64);
    (0..dimension)
        .map(|_| StandardNormal.sample(&mut draw))
        .collect()
}

struct Objective<'a> {
    cost: &'a dyn Fn(&[f64]) -> f64,
    tried: Cell<usize>,
    progress: &'a dyn Fn(usize),
    /// The least cost with its numbers.
    best: RefCell<(f64, Vec<f64>)>,
}

/// The search takes its problem away; what was best stays here.
struct Kept<'a, 'b>(&'a Objective<'b>);

impl CostFunction for Kept<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Infallible;

    fn cost(&self, numbers: &Vec<f64>) -> Result<f64, Infallible> {
        let objective = self.0;
        let cost = (objective.cost)(numbers);
        objective.tried.set(objective.tried.get() + 1);
        (objective.progress)(objective.tried.get());
        let mut best = objective.best.borrow_mut();
        if cost < best.0 {
            *best = (cost, numbers.clone());
        }
        Ok(cost)
    }
}

/// The best numbers found from `start` on within about so many trials, and how many were made.
pub(super) fn search(
    start: Vec<f64>,
    seed: u64,
    evaluations: usize,
    cost: &dyn Fn(&[f64]) -> f64,
    progress: &dyn Fn(usize),
) -> (Vec<f64>, usize) {
    let generation = CmaEs::<Vec<f64>, DenseMatrix>::default_lambda(start.len()) + 1;
    let generations = evaluations.div_ceil(generation).saturating_sub(1).max(1);
    let objective = Objective {
        cost,
        progress,
        tried: Cell::new(0),
        best: RefCell::new((f64::INFINITY, start.clone())),
    };
    let solver = CmaEs::<_, DenseMatrix>::new(seed, FIRST_STEP).with_eigen_update_period(REFRESHED);
    let kept = Kept(&objective);
    let executor = Executor::new(kept, solver, PopulationProgress::from_point(start));
    let Ok(_) = executor.max_iter(generations as u64).run();
    let tried = objective.tried.get();
    (objective.best.into_inner().1, tried)
}
