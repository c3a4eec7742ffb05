//! What is done to a choice made: the same effects from other sizes, one taken away, one exchanged
//! for another.

use rayon::prelude::*;

use super::DiagnoseError;
use super::choice::{criterion, stands_out_of_special, weight};
use super::fit::{Fit, fit};
use super::noise::Noise;
use super::problem::Point;
use super::race::Race;
use super::screen::{critical, rank};
use super::search::{DECISIVE, Outcome, REFINED, Search, settled};
use super::signature::tests;
use super::starts::{extended, without};
use super::validate::{gain_in_size, objective};

/// Sizes, in parts of those found, from which a fit is made again.
const RESTARTS: [f64; 4] = [-1.0, 0.4, 2.5, 4.0];
/// Most that are fitted.
const RESTARTED: usize = 6;
/// So often an effect is fitted from other sizes before another is looked for at the limit.
const MOST_RESTARTED: usize = 3;
/// By so much, as a difference of minus twice the log-likelihood, another optimum must be better.
const CLEARLY_BETTER: f64 = 10.0;

impl Search<'_, '_> {
    /// Adds effects as long as they earn their place, `most` in all, and takes those away that do
    /// not any more.
    pub(super) fn ascend(
        &mut self,
        outcome: &mut Outcome,
        most: usize,
    ) -> Result<(), DiagnoseError> {
        while self.forward(outcome)? {
            if self.rebased(outcome)? {
                continue;
            }
            let reached = outcome.chosen.point.kinds();
            self.backward(outcome)?;
            if outcome.chosen.point.kinds() != reached {
                // What led there would be found again, and again be taken away.
                self.refused.push(reached);
            }
            // Before many causes that imitate a length have used up the simulations.
            if outcome.chosen.point.effects.len() == 2 {
                self.lengths(outcome)?;
            }
            if outcome.chosen.point.effects.len() >= most {
                outcome.limited = self.finds_more(outcome)?;
                break;
            }
        }
        Ok(())
    }

    /// Whether the nominal model needs no effect where its numbers have been led by the first one:
    /// its own fit had not reached its end, and the effect made up for that. What is left is looked
    /// for anew from there.
    fn rebased(&self, outcome: &mut Outcome) -> Result<bool, DiagnoseError> {
        let [first] = outcome.chosen.point.effects.as_slice() else {
            return Ok(false);
        };
        let (problem, train) = (self.problem, &self.problem.split.train);
        let alpha = problem.options.family_wise_error;
        let bar = critical(alpha, outcome.tests, first.values.len());
        let start = without(&outcome.chosen.point, 0);
        let again = fit(problem, start, train, &outcome.orders, true)?;
        let value = |fit: &Fit| objective(problem, &fit.residual, train, &outcome.orders);
        let is_needed = value(&again) - value(&outcome.chosen) > bar;
        if is_needed || value(&again) > value(&outcome.base) - CLEARLY_BETTER {
            return Ok(false);
        }
        (outcome.base, outcome.orders) = settled(problem, again)?;
        outcome.chosen = outcome.base.clone();
        outcome.signatures.clear();
        for fits in [
            &mut outcome.rivals,
            &mut outcome.singles,
            &mut outcome.pairs,
        ] {
            fits.clear();
        }
        Ok(true)
    }

    /// Where something is left to be found: the effect added last from other sizes, if that
    /// explains clearly more. What is not linear, a phase or the moment of a slip, may have led its
    /// first fit to a lesser optimum.
    pub(super) fn restarted(&mut self, base: &Fit, orders: &[usize]) -> Option<Fit> {
        let last = base.point.effects.len().checked_sub(1)?;
        let infos = self.problem.infos(base.point.effects[last].candidate);
        let sizes: Vec<usize> = (0..infos.len()).filter(|&i| infos[i].is_size).collect();
        let mut groups: Vec<&[usize]> = vec![&sizes];
        if sizes.len() > 1 {
            groups.extend(sizes.chunks(1));
        }
        let moved = groups.iter().flat_map(|g| RESTARTS.map(|f| (*g, f)));
        let starts = moved.map(|(group, factor)| {
            let mut start = base.point.clone();
            for &i in group {
                let (info, value) = (&infos[i], &mut start.effects[last].values[i]);
                let moved = info.neutral + factor * (*value - info.neutral);
                *value = moved.clamp(info.min, info.max);
            }
            start
        });
        let starts = self.nearest(starts.collect(), RESTARTED);
        let trials = self.fit_all(
            starts,
            orders,
            Race::ToBeat(base.objective - CLEARLY_BETTER),
        );
        let best = trials
            .into_iter()
            .min_by(|a, b| a.objective.total_cmp(&b.objective))?;
        (best.objective < base.objective - CLEARLY_BETTER).then_some(best)
    }

    /// The starts whose predictions are nearest to the data, as they are.
    fn nearest(&self, starts: Vec<Point>, count: usize) -> Vec<Point> {
        if starts.len() <= count {
            return starts;
        }
        let (problem, train) = (self.problem, &self.problem.split.train);
        let far = |start: &Point| -> f64 {
            problem.predict(start).map_or(f64::INFINITY, |predicted| {
                let residual = problem.data.residual(&predicted);
                Noise::white(&residual, train, &problem.floor).objective(train)
            })
        };
        let mut starts: Vec<(f64, Point)> = (starts.into_par_iter())
            .map(|start| (far(&start), start))
            .collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        (starts.into_iter().take(count))
            .map(|(_, start)| start)
            .collect()
    }

    /// Takes away effects that no longer earn their place beside the others.
    pub(super) fn backward(&mut self, outcome: &mut Outcome) -> Result<(), DiagnoseError> {
        let problem = self.problem;
        while outcome.chosen.point.effects.len() > 1 {
            let last = outcome.chosen.point.effects.len() - 1;
            let starts = (0..=last)
                .map(|i| without(&outcome.chosen.point, i))
                .collect();
            let trials = self.fit_all(starts, &outcome.orders, Race::None(None));
            let idle = trials
                .into_iter()
                .find(|small| !self.earns(small, &outcome.chosen));
            let Some(small) = idle else { break };
            outcome.rivals.clear();
            (outcome.chosen, outcome.orders) = settled(problem, small)?;
        }
        Ok(())
    }

    /// Replaces each effect in turn by others; a clearly better model is taken, or one that is
    /// simpler and as good; all are kept as rivals. Whether one was taken.
    pub(super) fn replace(&mut self, outcome: &mut Outcome) -> Result<bool, DiagnoseError> {
        let problem = self.problem;
        let train = &problem.split.train;
        let mut rivals = Vec::new();
        for i in 0..outcome.chosen.point.effects.len() {
            if problem.left() < 300 {
                break;
            }
            let removed = outcome.chosen.point.effects[i].candidate;
            let Ok(rest) = fit(
                problem,
                without(&outcome.chosen.point, i),
                train,
                &outcome.orders,
                true,
            ) else {
                continue;
            };
            let (signatures, orders) = (&outcome.signatures, &outcome.orders);
            let ranking = rank(problem, &rest, signatures, orders, REFINED / 2);
            let others = ranking.iter().filter(|r| r.candidate() != removed).take(3);
            rivals.extend(self.fit_all(
                others.map(|r| extended(&rest, &[r])).collect(),
                &outcome.orders,
                Race::None(Some(&rest)),
            ));
        }
        let value = |fit: &Fit| criterion(problem, fit, &outcome.orders);
        let here = value(&outcome.chosen);
        let better = rivals.iter().filter(|r| {
            let simpler = weight(problem, r) < weight(problem, &outcome.chosen);
            let clearly = value(r) < here - 10.0 && self.paired(&outcome.chosen, r).gain > 0.0;
            clearly || simpler && value(r) < here
        });
        let better = better.min_by(|a, b| value(a).total_cmp(&value(b))).cloned();
        let taken = better.is_some();
        if let Some(better) = better {
            rivals.push(outcome.chosen.clone());
            rivals.retain(|r| r.point != better.point);
            (outcome.chosen, outcome.orders) = settled(problem, better)?;
        }
        outcome.rivals = rivals;
        Ok(taken)
    }

    /// Takes a pair that was fitted to begin with where it says clearly more, the price of its
    /// parameters paid: an effect that can do much alone is added first, and no exchange of one
    /// effect for another leads from it to two that are there. Likewise a single effect, where
    /// those that were taken on the way to the one chosen have gone since.
    pub(super) fn prefer_the_first(&self, outcome: &mut Outcome) -> Result<(), DiagnoseError> {
        let problem = self.problem;
        let chosen = &outcome.chosen;
        if chosen.point.effects.is_empty() {
            return Ok(());
        }
        let value = |fit: &Fit| criterion(problem, fit, &outcome.orders);
        let here = value(chosen) - DECISIVE;
        // One with more numbers has paid for them; what it generalises it must stand out of.
        let heavier_is_right = |fit: &Fit| {
            self.paired(chosen, fit).gain > 0.0 && stands_out_of_special(problem, chosen, fit)
        };
        // An autoregression of what is left follows what a wrong one leaves as well as noise.
        let development = &problem.split.development;
        let better = |fit: &&Fit| {
            value(fit) < here
                && gain_in_size(problem, fit, chosen, development) < DECISIVE
                && (weight(problem, fit) <= weight(problem, chosen) || heavier_is_right(fit))
        };
        let pairs = outcome.pairs.iter().filter(better);
        let singles = outcome.singles.iter().filter(better);
        let singles = singles.filter(|single| self.paired(chosen, single).gain > 0.0);
        let all = pairs.chain(singles);
        let best = all.min_by(|a, b| value(a).total_cmp(&value(b))).cloned();
        if let Some(best) = best {
            outcome.rivals = match best.point.effects.len() {
                1 => outcome.singles.clone(),
                _ => std::mem::take(&mut outcome.pairs),
            };
            let last = std::mem::replace(&mut outcome.chosen, best.clone());
            outcome.rivals.push(last);
            outcome.rivals.retain(|rival| rival.point != best.point);
            (outcome.chosen, outcome.orders) = settled(problem, best)?;
        }
        Ok(())
    }

    /// Whether one more effect would earn its place. Where the simulations that are left do not
    /// suffice to fit one: whether candidates beyond chance are left.
    pub(super) fn finds_more(&mut self, outcome: &Outcome) -> Result<bool, DiagnoseError> {
        let count = outcome.chosen.point.effects.len();
        let mut next = outcome.clone();
        for _ in 0..MOST_RESTARTED {
            if !self.forward(&mut next)? {
                return Ok(next.stopped && self.sees_more(outcome));
            }
            if next.chosen.point.effects.len() > count {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Whether candidates beyond chance are left.
    fn sees_more(&self, outcome: &Outcome) -> bool {
        let (base, found) = (&outcome.chosen, &outcome.signatures);
        let tests = tests(self.problem, &base.point);
        let (_, starts) = self.screened(base, found, &outcome.orders, tests);
        !starts.is_empty()
    }
}
