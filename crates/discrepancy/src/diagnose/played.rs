//! Play searched over its width. Where the load changes sign a link crosses the play and bounces:
//! when it does so, and how hard, changes with the width so much that a fit finds its way from a
//! width that is off by a tenth at most, while all else that play does is what a zero that is off
//! or a softer joint does, too.

use rayon::prelude::*;
use truecut_scenario::effect::EffectKind;

use super::fit::Fit;
use super::noise::Noise;
use super::problem::{Found, Point, Problem};
use super::race::Race;
use super::scan::with_one_more;
use super::search::Search;
use super::signature::with;

/// Of the best fit's gain, what a fit must have that may stand for play.
const NEAR_THE_BEST: f64 = 0.5;
/// Widths, in parts of twice the offset or amplitude that was fitted: a load that keeps its sign
/// mostly holds the link at one end of the play.
const ABOUT_AN_OFFSET: [f64; 9] = [0.8, 0.85, 0.9, 0.95, 1.0, 1.05, 1.1, 1.2, 1.3];
/// In octaves of the typical width, from and to where all joints are searched, and steps of each.
const OCTAVES: [i32; 2] = [-2, 5];
const STEPS: i32 = 4;
/// Widths from which fits are started.
const FROM: usize = 2;

impl Search<'_, '_> {
    /// Fits of play in joints whose zero or compliance explains nearly as much as anything.
    pub(super) fn played(&mut self, base: &Fit, trials: &[Fit], orders: &[usize]) -> Vec<Fit> {
        let problem = self.problem;
        let (singles, most) = with_one_more(base, trials);
        let gain = |trial: &Fit| base.objective - trial.objective;
        let mut found = Vec::new();
        for play in problem.searched() {
            let of_play = &problem.candidates[play];
            if of_play.kind != EffectKind::JointBacklash || base.point.holds(play) {
                continue;
            }
            let alike = singles.iter().filter(|trial| {
                let last = trial.point.effects.last();
                let of_last = last.map(|last| &problem.candidates[last.candidate]);
                gain(trial) > NEAR_THE_BEST * most
                    && of_last.is_some_and(|one| {
                        one.target == of_play.target && stands_for_play(one.kind)
                    })
            });
            let alike: Vec<&Fit> = alike.copied().collect();
            if alike.is_empty() {
                continue;
            }
            let starts = self.best_widths(base, play, &alike);
            // The moments of the blows jump with the width: a fit may end beside the best
            // width, by far better than all others, without a step that tells so.
            let is_good = |fit: &Fit| fit.converged || gain(fit) > most;
            found.extend(self.fit_such(starts, orders, Race::Extending(base), is_good));
        }
        found
    }

    /// The widths at which the data are met best as they are.
    fn best_widths(&self, base: &Fit, play: usize, alike: &[&Fit]) -> Vec<Point> {
        let (problem, train) = (self.problem, &self.problem.split.train);
        let widths = widths(problem, play, alike);
        if problem.left() < widths.len() {
            return Vec::new();
        }
        let at = |width: f64| {
            let found = Found {
                values: vec![width],
                ..problem.neutral(play)
            };
            with(&base.point, found)
        };
        let objective = |width: &f64| -> f64 {
            problem.predict(&at(*width)).map_or(f64::INFINITY, |now| {
                let residual = problem.data.residual(&now);
                Noise::white(&residual, train, &problem.floor).objective(train)
            })
        };
        let profile: Vec<f64> = widths.par_iter().map(objective).collect();
        let is_lowest = |i: &usize| {
            let beside = &profile[i.saturating_sub(1)..(i + 2).min(profile.len())];
            profile[*i].is_finite() && beside.iter().all(|one| *one >= profile[*i])
        };
        let mut lowest: Vec<usize> = (0..widths.len()).filter(is_lowest).collect();
        lowest.sort_by(|a, b| profile[*a].total_cmp(&profile[*b]));
        lowest.truncate(FROM);
        lowest.into_iter().map(|i| at(widths[i])).collect()
    }
}

/// Whether an effect does what play does where the load keeps its sign, or does it to all of it, or
/// where the sign follows the angle.
fn stands_for_play(kind: EffectKind) -> bool {
    use EffectKind as K;
    matches!(
        kind,
        K::JointZero
            | K::JointRipple
            | K::JointStiffness
            | K::JointCubicStiffness
            | K::JointHysteresis
            | K::JointBacklash
    )
}

/// Widths to look at, from the smallest.
fn widths(problem: &Problem, play: usize, alike: &[&Fit]) -> Vec<f64> {
    let typical = problem.candidates[play].scale[0];
    let steps = OCTAVES[0] * STEPS..=OCTAVES[1] * STEPS;
    let mut widths: Vec<f64> = steps
        .map(|k| typical * (f64::from(k) / f64::from(STEPS)).exp2())
        .collect();
    for fit in alike {
        let last = fit.point.effects.last().expect("it has an effect");
        let whole = match problem.candidates[last.candidate].kind {
            EffectKind::JointZero => Some(2.0 * last.values[0].abs()),
            EffectKind::JointRipple => Some(2.0 * last.values[0].hypot(last.values[1])),
            _ => None,
        };
        if let Some(whole) = whole {
            widths.extend(ABOUT_AN_OFFSET.map(|part| part * whole));
        }
    }
    let info = &problem.infos(play)[0];
    widths.retain(|width| (info.min..=info.max).contains(width));
    widths.sort_by(f64::total_cmp);
    widths.dedup();
    widths
}
