//! The search: screening, fits, choice on the validation blocks, forward, in pairs, by replacement
//! and backward.

use rayon::prelude::*;

use super::answer::FitRecord;
use super::fit::{Fit, fit, unfitted};
use super::noise::Noise;
use super::orders::rippled;
use super::pairs::pairs;
use super::problem::{Point, Problem};
use super::race::{Race, run};
use super::ringing::ringing;
use super::screen::{Ranked, critical, rank};
use super::signature::{Signature, signatures, tests};
use super::starts::{all_starts, extended, is_like};
use super::unite::united;
use super::{DiagnoseError, Stage};

/// Where the search ended.
#[derive(Clone)]
pub(super) struct Outcome {
    /// The nominal model, refitted.
    pub base: Fit,
    /// The model chosen; fitted to the training rows.
    pub chosen: Fit,
    /// Orders of the noise of the model chosen.
    pub orders: Vec<usize>,
    /// Other models of as many effects that were fitted.
    pub rivals: Vec<Fit>,
    /// Models of one effect less that say the same.
    pub united: Vec<Fit>,
    /// Pairs of effects that were fitted to begin with.
    pub pairs: Vec<Fit>,
    /// And single effects.
    pub singles: Vec<Fit>,
    /// The last screening: what is left to be seen beyond the model chosen.
    pub ranking: Vec<Ranked>,
    /// Signatures tested in the last screening.
    pub tests: usize,
    /// Signatures of the nominal model, refitted. Beside effects they serve as well: those of the
    /// best are taken anew there.
    pub signatures: Vec<Signature>,
    /// A discrepancy was detected, and no fit of it ended well.
    pub failed: bool,
    /// The simulations allowed were used up while something was left to be fitted.
    pub stopped: bool,
    /// As many causes as may be named together were found, and more is there.
    pub limited: bool,
    /// All fits.
    pub fits: Vec<FitRecord>,
}

/// Odds of 20 to 1, as a difference of minus twice the log-likelihood.
pub(super) const DECISIVE: f64 = 6.0;
/// A gain of so many times the critical one is no chance: if its fits fail, the search has failed.
const STRONG: f64 = 4.0;
/// Simulations that a round of fits takes at least.
const LEAST_LEFT: usize = 40;
/// Simulations that a fit takes, roughly.
const OF_A_FIT: usize = 25;
pub(super) const REFINED: usize = 12;
/// There, signatures are those without the effects.
const REFINED_BESIDE_EFFECTS: usize = 24;
/// In standard deviations of a nominal parameter.
const FAR_SIGMA: f64 = 0.5;
const PAIRED: usize = 30;
/// Candidates that are fitted for their promise under white noise.
const WHITE: usize = 4;
const REPLACEMENTS: usize = 3;

pub(super) struct Search<'a, 'b> {
    pub(super) problem: &'a Problem<'b>,
    fits: Vec<FitRecord>,
    failed: bool,
    /// Effects that were taken together and did not all earn their place, sorted.
    pub(super) refused: Vec<Vec<usize>>,
}

/// Runs the search.
///
/// # Errors
/// The nominal model cannot be simulated.
pub(super) fn search(problem: &Problem) -> Result<Outcome, DiagnoseError> {
    problem.report(Stage::Refit);
    let train = &problem.split.train;
    let predicted = problem.predict(&problem.start())?;
    let orders = Noise::orders(&problem.data.residual(&predicted), train, &problem.floor);
    let (base, orders) = settled(problem, refit(problem, &orders)?)?;
    let mut search = Search {
        problem,
        fits: Vec::new(),
        failed: false,
        refused: Vec::new(),
    };
    let mut outcome = Outcome {
        chosen: base.clone(),
        base,
        orders,
        rivals: Vec::new(),
        united: Vec::new(),
        pairs: Vec::new(),
        singles: Vec::new(),
        ranking: Vec::new(),
        tests: 0,
        signatures: Vec::new(),
        failed: false,
        stopped: false,
        limited: false,
        fits: Vec::new(),
    };
    let most = problem.options.max_effects;
    search.ascend(&mut outcome, most)?;
    let count = |outcome: &Outcome| outcome.chosen.point.effects.len();
    if (outcome.limited || count(&outcome) == 0) && search.together(&mut outcome)? {
        let most = count(&outcome) + most;
        outcome.limited = false;
        while search.forward(&mut outcome)? {
            search.thin(&mut outcome)?;
            if count(&outcome) >= most {
                outcome.limited = search.finds_more(&outcome)?;
                break;
            }
        }
    }
    // What a delay leaves is seen beside it only, and others stand in its place.
    if search.delays(&mut outcome)? && count(&outcome) < most {
        search.ascend(&mut outcome, most)?;
    }
    let before = outcome.chosen.point.kinds();
    if (2..=most).contains(&count(&outcome)) {
        problem.report(Stage::Alternatives);
        for _ in 0..REPLACEMENTS {
            if !search.replace(&mut outcome)? {
                break;
            }
        }
    }
    search.prefer_the_first(&mut outcome)?;
    if outcome.chosen.point.kinds() != before && count(&outcome) <= most {
        search.backward(&mut outcome)?;
    }
    if search.lengths(&mut outcome)? && count(&outcome) < most {
        search.ascend(&mut outcome, most)?;
    }
    // What a delay leaves is seen beside it only: before, others stood in its place.
    if search.delays(&mut outcome)? && count(&outcome) < most {
        search.ascend(&mut outcome, most)?;
    }
    search.simplify(&mut outcome)?;
    outcome.united = united(problem, &outcome);
    outcome.failed = search.failed && outcome.chosen.point.effects.is_empty();
    outcome.fits = search.fits;
    Ok(outcome)
}

/// More nominal parameters than these are refitted from their values alone.
const MOST_STARTED: usize = 4;

/// Nominal parameters refitted: from their values, from either side of them, and with the first
/// steps under white noise, since an autoregression takes a wrong constant or a late slip for
/// noise. The likeliest end counts.
fn refit(problem: &Problem, orders: &[usize]) -> Result<Fit, DiagnoseError> {
    let train = &problem.split.train;
    let nominal = problem.start();
    let mut starts = vec![nominal.clone()];
    if problem.nominal.len() <= MOST_STARTED {
        for (i, parameter) in problem.nominal.iter().enumerate() {
            for side in [-1.0, 1.0] {
                let mut start = nominal.clone();
                start.nominal[i] += side * parameter.sigma;
                starts.push(start);
            }
        }
    }
    let others = || -> Vec<_> {
        let fits = starts.into_par_iter();
        fits.map(|start| fit(problem, start, train, orders, false))
            .collect()
    };
    let (best, fits) = rayon::join(
        || fit(problem, nominal.clone(), train, orders, true),
        others,
    );
    let mut best = best?;
    for other in fits.into_iter().flatten() {
        if other.objective < best.objective {
            best = other;
        }
    }
    Ok(best)
}

/// The same model with noise of the orders that its own residual asks for.
pub(super) fn settled(problem: &Problem, first: Fit) -> Result<(Fit, Vec<usize>), DiagnoseError> {
    let train = &problem.split.train;
    let orders = Noise::orders(&first.residual, train, &problem.floor);
    Ok((fit(problem, first.point, train, &orders, true)?, orders))
}

impl Search<'_, '_> {
    /// Adds the effect, or the pair, that explains most; false where nothing earns its place.
    pub(super) fn forward(&mut self, outcome: &mut Outcome) -> Result<bool, DiagnoseError> {
        let problem = self.problem;
        let base = &outcome.chosen;
        // Looking for another effect takes as many simulations as looking for the first did.
        if !base.point.effects.is_empty() && problem.left() < outcome.tests + LEAST_LEFT {
            outcome.stopped = true;
            return Ok(false);
        }
        problem.report(Stage::Screening(base.point.effects.len()));
        let train = &problem.split.train;
        outcome.tests = tests(problem, &base.point);
        if outcome.signatures.is_empty() {
            outcome.signatures = signatures(problem, base);
            outcome.signatures.extend(rippled(problem, base));
            outcome.signatures.extend(ringing(problem, base));
        }
        let found = &outcome.signatures;
        let (ranking, mut starts) = self.screened(base, found, &outcome.orders, outcome.tests);
        if base.point.effects.is_empty() && !starts.is_empty() && self.is_far(base) {
            // Nominal values may have been drawn there by what is to be found. What is promising
            // from where they were is found with the same signatures; those of the best are taken
            // anew there.
            let unmoved = unfitted(problem, problem.start(), train, &outcome.orders)?;
            let (_, others) = self.screened(&unmoved, found, &outcome.orders, outcome.tests);
            starts.retain(|start| !others.iter().any(|other| is_like(start, other)));
            starts.extend(others);
        }
        starts.retain(|start| !self.refused.contains(&start.kinds()));
        outcome.ranking = ranking;
        outcome.stopped = !starts.is_empty() && problem.left() < LEAST_LEFT;
        if starts.is_empty() || outcome.stopped {
            return Ok(false);
        }
        if let Some(better) = self.restarted(base, &outcome.orders) {
            (outcome.chosen, outcome.orders) = settled(problem, better)?;
            return Ok(true);
        }
        problem.report(Stage::Fitting(base.point.effects.len()));
        let strong = outcome.ranking.iter().any(|r| {
            let alpha = problem.options.family_wise_error;
            r.gain > STRONG * critical(alpha, outcome.tests, r.start.len())
        });
        let mut trials = self.fit_all(starts, &outcome.orders, Race::Extending(base));
        trials.extend(self.scanned(base, &trials, &outcome.orders));
        if base.point.effects.is_empty() {
            trials.extend(self.played(base, &trials, &outcome.orders));
        }
        self.failed |= trials.is_empty() && strong;
        if base.point.effects.is_empty() {
            let of = |count: usize| {
                let alike = trials.iter().filter(|t| t.point.effects.len() == count);
                alike.cloned().collect()
            };
            (outcome.singles, outcome.pairs) = (of(1), of(2));
        }
        let Some(best) = self.choose(base, &trials, &outcome.orders, outcome.tests) else {
            return Ok(false);
        };
        let count = trials[best].point.effects.len();
        outcome.rivals = trials
            .iter()
            .enumerate()
            .filter(|(i, t)| *i != best && t.point.effects.len() == count)
            .map(|(_, t)| t.clone())
            .collect();
        (outcome.chosen, outcome.orders) = settled(problem, trials[best].clone())?;
        Ok(true)
    }

    /// The ranking of all candidates by their signatures, and what is to be fitted.
    pub(super) fn screened(
        &self,
        base: &Fit,
        found: &[Signature],
        orders: &[usize],
        tests: usize,
    ) -> (Vec<Ranked>, Vec<Point>) {
        let refined = match base.point.effects.is_empty() {
            true => REFINED,
            false => REFINED_BESIDE_EFFECTS,
        };
        let ranking = rank(self.problem, base, found, orders, refined);
        let mut starts = self.promising(base, &ranking, tests);
        starts.extend(self.promising_in_white(base, found, &starts, tests));
        (ranking, starts)
    }

    /// Whether a nominal parameter is far from what the scenario has.
    fn is_far(&self, base: &Fit) -> bool {
        let pairs = self.problem.nominal.iter().zip(&base.point.nominal);
        let mut far = pairs.map(|(p, value)| (value - p.value).abs() / p.sigma);
        far.any(|sigmas| sigmas > FAR_SIGMA)
    }

    /// Starting points: single candidates beyond the critical gain, best first, and pairs that gain
    /// clearly more together.
    fn promising(&self, base: &Fit, ranking: &[Ranked], tests: usize) -> Vec<Point> {
        let problem = self.problem;
        let alpha = problem.options.family_wise_error;
        let beyond = |r: &&Ranked| r.gain > critical(alpha, tests, r.start.len());
        let singles: Vec<&Ranked> = ranking
            .iter()
            .filter(beyond)
            .take(problem.options.fitted_candidates)
            .collect();
        let mut starts: Vec<Point> = singles.iter().flat_map(|r| all_starts(base, r)).collect();
        if base.point.effects.len() + 2 <= problem.options.max_effects {
            let pairs = pairs(problem, base, &ranking[..ranking.len().min(PAIRED)], tests);
            starts.extend(pairs.iter().map(|(a, b)| extended(base, &[a, b])));
        }
        starts
    }

    /// Starting points that promise most under white noise. What an autoregression of the residual
    /// takes for noise is found here; whether it is noise is decided by the fits.
    fn promising_in_white(
        &self,
        base: &Fit,
        found: &[Signature],
        starts: &[Point],
        tests: usize,
    ) -> Vec<Point> {
        let problem = self.problem;
        let orders = vec![0; base.residual.len()];
        let ranking = rank(problem, base, found, &orders, 2 * WHITE);
        let alpha = problem.options.family_wise_error;
        let beyond = ranking
            .iter()
            .filter(|r| r.gain > critical(alpha, tests, r.start.len()));
        let last = |point: &Point| point.effects.last().map(|f| f.candidate);
        let added = base.point.effects.len() + 1;
        beyond
            .take(WHITE)
            .filter(|r| {
                let mut single = starts.iter().filter(|s| s.effects.len() == added);
                single.all(|s| last(s) != Some(r.candidate()))
            })
            .map(|r| extended(base, &[r]))
            .collect()
    }

    /// Fits from all starts, best promise first; only as many as the simulations left allow. What
    /// falls far behind in the race is given up.
    pub(super) fn fit_all(&mut self, starts: Vec<Point>, orders: &[usize], race: Race) -> Vec<Fit> {
        self.fit_such(starts, orders, race, |fit| fit.converged)
    }

    /// The same with all ends that are such.
    pub(super) fn fit_such(
        &mut self,
        mut starts: Vec<Point>,
        orders: &[usize],
        race: Race,
        is_such: impl Fn(&Fit) -> bool,
    ) -> Vec<Fit> {
        let problem = self.problem;
        starts.truncate((problem.left() / OF_A_FIT).max(1));
        let mut good = Vec::new();
        for trial in run(problem, starts, orders, race) {
            self.fits.push(FitRecord::new(problem, &trial));
            good.extend(trial.end.ok().filter(&is_such));
        }
        good
    }
}
