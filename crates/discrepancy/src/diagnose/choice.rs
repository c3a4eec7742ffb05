//! The choice among fits: by what they gain on blocks that they were not fitted to, beyond chance
//! and in noise of any memory.

use super::data::Rows;
use super::derivatives::difference;
use super::fit::Fit;
use super::memory::{LEAST_GENERALISATION, distance, stands_far_out, stands_out};
use super::problem::Problem;
use super::screen::critical;
use super::search::{DECISIVE, Search};
use super::smooth::price;
use super::validate::{Paired, compare, gain_in_size, objective, rms};

/// The validation gain must be beyond so many standard errors; detection on the training rows has
/// come before, and it is there that chance is kept out.
pub(super) const LEAST_T: f64 = 1.0;
/// So much of the gain that rules chance out suffices for what stands far out of noise of any
/// memory: an autoregression that may be as good as a random walk follows a constant at little
/// cost, although what is left beside it does not wander at all.
const FAR_OUT_PART: f64 = 0.5;
/// In standard errors.
const CLEARLY_BEHIND: f64 = 2.0;
/// Part of what the best gains on the validation blocks that another may lack there.
const SLIGHT: f64 = 0.01;

impl Search<'_, '_> {
    /// The trial to take: of those that earn their place and are not clearly behind the best on the
    /// validation blocks, the fewest effects, and among these the best by the information
    /// criterion.
    pub(super) fn choose(
        &self,
        base: &Fit,
        trials: &[Fit],
        orders: &[usize],
        tests: usize,
    ) -> Option<usize> {
        let validation = &self.problem.split.validation;
        let passing: Vec<usize> = (0..trials.len())
            .filter(|&i| self.is_detected(base, &trials[i], tests) && self.earns(base, &trials[i]))
            .collect();
        let common = passing
            .iter()
            .copied()
            .min_by(|&a, &b| trials[a].objective.total_cmp(&trials[b].objective))?;
        let noise = &trials[common].noise;
        let gain = |i: usize| compare(&base.residual, &trials[i].residual, noise, validation).gain;
        let best = passing
            .iter()
            .copied()
            .max_by(|&a, &b| gain(a).total_cmp(&gain(b)))?;
        let value = |i: usize| criterion(self.problem, &trials[i], orders);
        // What the blocks do not ask for, the moment at which play is crossed, other rows may.
        let is_ahead = |i: usize| {
            let added = &trials[i].point.effects[base.point.effects.len()..];
            let dof = added.iter().map(|f| f.values.len()).sum();
            let bar = critical(self.problem.options.family_wise_error, tests, dof);
            value(i) + bar < value(best)
        };
        let near = passing.iter().copied().filter(|&i| {
            let behind = compare(
                &trials[i].residual,
                &trials[best].residual,
                noise,
                validation,
            );
            // Two models that say all but the same differ by next to nothing, and that may be many
            // standard errors.
            behind.t() <= CLEARLY_BEHIND
                || behind.gain < DECISIVE
                || behind.gain < SLIGHT * gain(best) && is_ahead(i)
        });
        let order = |a: &usize, b: &usize| {
            let effects = |i: usize| trials[i].point.effects.len();
            effects(*a)
                .cmp(&effects(*b))
                .then(value(*a).total_cmp(&value(*b)))
        };
        let near: Vec<usize> = near.collect();
        let best = near.iter().copied().min_by(order)?;
        // Where the data do not decide, a cause in the machine comes before one in a sensor.
        let undecided = near.into_iter().filter(|&i| {
            trials[i].point.effects.len() == trials[best].point.effects.len()
                && value(i) < value(best) + DECISIVE
        });
        let sensors = |i: usize| instrumental(self.problem, &trials[i]);
        let taken = undecided.min_by(|a, b| sensors(*a).cmp(&sensors(*b)).then(order(a, b)))?;
        // A simpler one from which it does not stand out is what it generalises.
        let simpler = passing.into_iter().filter(|&i| {
            trials[i].point.effects.len() == trials[taken].point.effects.len()
                && weight(self.problem, &trials[i]) < weight(self.problem, &trials[taken])
                && !stands_out_of_special(self.problem, &trials[i], &trials[taken])
        });
        simpler.min_by(order).or(Some(taken))
    }

    /// Whether chance is ruled out: on the training rows, where a pair counts for all the pairs
    /// there are, and for noise of any memory, unless what is left without it is larger than noise
    /// that is known can be: that may be followed by an autoregression as well as noise, and be as
    /// slow as noise of any memory, but its size tells. What stands far out of noise of any memory
    /// needs no more than half the gain.
    fn is_detected(&self, base: &Fit, trial: &Fit, tests: usize) -> bool {
        let added = &trial.point.effects[base.point.effects.len()..];
        let dof = added.iter().map(|f| f.values.len()).sum();
        let bar_of = |tests, dof| critical(self.problem.options.family_wise_error, tests, dof);
        let bar = bar_of(tests.pow(added.len() as u32), dof);
        // Of more numbers, and of pairs, the best are as much further out by chance.
        let scale = (bar / bar_of(tests, 1)).sqrt();
        let in_size = gain_in_size(self.problem, base, trial, &self.problem.split.train);
        let gain = base.objective - trial.objective + in_size;
        let residuals = [&base.residual, &trial.residual];
        if gain <= bar {
            let is_near = gain > FAR_OUT_PART * bar;
            return is_near && stands_far_out(self.problem, gain, scale, residuals);
        }
        gain > bar && (in_size > bar || stands_out(self.problem, gain, scale, residuals))
    }

    /// Whether the larger model predicts the validation blocks better: beyond chance, and enough to
    /// matter.
    pub(super) fn earns(&self, small: &Fit, large: &Fit) -> bool {
        let paired = self.paired(small, large);
        paired.t() > LEAST_T
            && paired.practical >= self.problem.options.min_gain
            && is_beyond_numerics(self.problem, small, large)
    }

    pub(super) fn paired(&self, small: &Fit, large: &Fit) -> Paired {
        compare(
            &small.residual,
            &large.residual,
            &large.noise,
            &self.problem.split.validation,
        )
    }
}

/// Whether a generalisation stands out of what it generalises: in noise of any memory, or since
/// that leaves more than noise that is known can be. Slow noise has the shape of a drift, but not
/// any size.
pub(super) fn stands_out_of_special(problem: &Problem, special: &Fit, general: &Fit) -> bool {
    distance(problem, &special.residual, &general.residual) > LEAST_GENERALISATION
        || gain_in_size(problem, special, general, &problem.split.development) > DECISIVE
}

/// What changes no output by more than this part of what it does by itself is lost in the error of
/// the simulation (benches/README.md).
const NUMERICAL: f64 = 5e-4;

/// Whether two models differ by more than the simulation errs.
fn is_beyond_numerics(problem: &Problem, small: &Fit, large: &Fit) -> bool {
    let rows = &problem.split.development;
    let change = rms(&difference(&small.residual, &large.residual, 1.0), rows);
    change
        .iter()
        .enumerate()
        .any(|(c, change)| *change > NUMERICAL * problem.own_motion[c])
}

/// Bayesian information criterion on training and validation rows together, with noise of the given
/// orders. A shape parameter counts twice: it is searched over all its range, from several starts.
/// A curve counts by its evidence.
pub(super) fn criterion(problem: &Problem, trial: &Fit, orders: &[usize]) -> f64 {
    criterion_at(problem, trial, orders, &problem.split.development)
}

/// The same at some rows.
pub(super) fn criterion_at(problem: &Problem, trial: &Fit, orders: &[usize], rows: &Rows) -> f64 {
    objective(problem, &trial.residual, rows, orders)
        + weight(problem, trial) * (rows.len() as f64).ln()
        + price(problem, trial, rows)
}

/// Number of effects that are of sensors or their clock.
fn instrumental(problem: &Problem, trial: &Fit) -> usize {
    let kinds = trial.point.effects.iter();
    let kinds = kinds.map(|found| problem.candidates[found.candidate].kind);
    kinds.filter(|kind| kind.family().is_instrumental()).count()
}

/// Number of parameters of the effects, without those of a curve, which has a price of its own;
/// those searched from several starts counted twice.
pub(super) fn weight(problem: &Problem, trial: &Fit) -> f64 {
    let infos = trial
        .point
        .effects
        .iter()
        .filter(|f| !problem.curves().contains(&f.candidate))
        .flat_map(|f| problem.infos(f.candidate));
    infos
        .map(|info| {
            if info.is_size || info.starts.is_empty() {
                1.0
            } else {
                2.0
            }
        })
        .sum()
}
