//! A link that is not as long as its file says, in place of causes that imitate it.
//!
//! To an arm that moves slowly what a link carries elsewhere is the link's own centre elsewhere, so
//! that a length is not looked for by itself. What the joints beyond feel of it takes more causes:
//! a wrong centre with a spring that balances, a payload, gains.

use truecut_scenario::effect::EffectKind;

use super::DiagnoseError;
use super::choice::criterion;
use super::fit::Fit;
use super::problem::{Found, Point, Problem};
use super::race::Race;
use super::search::{DECISIVE, Outcome, Search, settled};

/// What acts by the weight of links, or is taken for it.
const OF_WEIGHT: [EffectKind; 11] = [
    EffectKind::LinkMass,
    EffectKind::LinkCenter,
    EffectKind::JointRotor,
    EffectKind::JointCounterbalance,
    EffectKind::JointOffset,
    EffectKind::JointZero,
    EffectKind::Payload,
    EffectKind::BaseTilt,
    EffectKind::SensorGain,
    EffectKind::SensorOffset,
    EffectKind::ClockRate,
];

impl Search<'_, '_> {
    /// Takes a length in place of the causes of weight, or of all, where that is clearly the better
    /// model; whether it was.
    pub(super) fn lengths(&mut self, outcome: &mut Outcome) -> Result<bool, DiagnoseError> {
        let problem = self.problem;
        let chosen = &outcome.chosen.point;
        let of_weight = |own: &Found| OF_WEIGHT.contains(&problem.candidates[own.candidate].kind);
        if problem.lengths().next().is_none() || !chosen.effects.iter().any(of_weight) {
            return Ok(false);
        }
        let mut others = chosen.clone();
        others.effects.retain(|own| !of_weight(own));
        let mut rests = vec![others];
        if !rests[0].effects.is_empty() {
            rests.push(outcome.base.point.clone());
        }
        let starts = rests.iter().flat_map(|rest| {
            let absent = problem.lengths().filter(|&one| !rest.holds(one));
            absent.map(|one| beside(problem, rest, one))
        });
        let orders = outcome.orders.clone();
        let fits = self.fit_all(starts.collect(), &orders, Race::None(None));
        let value = |fit: &Fit| criterion(problem, fit, &orders);
        let best = (fits.into_iter()).min_by(|a, b| value(a).total_cmp(&value(b)));
        let better = best.filter(|best| value(best) + DECISIVE < value(&outcome.chosen));
        let Some(better) = better else {
            return Ok(false);
        };
        outcome.rivals.clear();
        (outcome.chosen, outcome.orders) = settled(problem, better)?;
        Ok(true)
    }
}

fn beside(problem: &Problem, rest: &Point, length: usize) -> Point {
    let mut point = rest.clone();
    point.effects.push(problem.neutral(length));
    point
}
