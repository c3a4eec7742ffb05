//! The search for the best motion: an evolution strategy with covariance adaptation
//! (`hansen2016`) from random motions on, the same for the same seed.

use std::cell::RefCell;
use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};

use basin::{CmaEs, CostFunction, DenseMatrix, Executor, PopulationProgress};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

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
    cost: &'a (dyn Fn(&[f64]) -> f64 + Sync),
    tried: &'a AtomicUsize,
    progress: &'a (dyn Fn(usize) + Sync),
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
        (objective.progress)(objective.tried.fetch_add(1, Ordering::Relaxed) + 1);
        let mut best = objective.best.borrow_mut();
        if cost < best.0 {
            *best = (cost, numbers.clone());
        }
        Ok(cost)
    }
}

/// The best numbers found within about so many trials, and their cost: of searches from each of the
/// starts on, which share the trials.
pub(super) fn search(
    starts: Vec<Vec<f64>>,
    seed: u64,
    evaluations: usize,
    cost: &(dyn Fn(&[f64]) -> f64 + Sync),
    progress: &(dyn Fn(usize) + Sync),
) -> (f64, Vec<f64>) {
    let tried = AtomicUsize::new(0);
    let share = evaluations.div_ceil(starts.len());
    let ends: Vec<(f64, Vec<f64>)> = (starts.into_par_iter())
        .map(|start| {
            let objective = Objective {
                cost,
                progress,
                tried: &tried,
                best: RefCell::new((f64::INFINITY, start.clone())),
            };
            from(start, seed, share, objective)
        })
        .collect();
    let best = ends.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    best.unwrap_or((f64::INFINITY, Vec::new()))
}

fn from(start: Vec<f64>, seed: u64, evaluations: usize, objective: Objective) -> (f64, Vec<f64>) {
    let generation = CmaEs::<Vec<f64>, DenseMatrix>::default_lambda(start.len()) + 1;
    let generations = evaluations.div_ceil(generation).saturating_sub(1).max(1);
    let solver = CmaEs::<_, DenseMatrix>::new(seed, FIRST_STEP).with_eigen_update_period(REFRESHED);
    let kept = Kept(&objective);
    let executor = Executor::new(kept, solver, PopulationProgress::from_point(start));
    let Ok(_) = executor.max_iter(generations as u64).run();
    objective.best.into_inner()
}
