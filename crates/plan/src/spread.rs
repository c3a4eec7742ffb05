//! Limits and stability of an arm and a cut that are not known exactly, by sampling.
//!
//! Draws come in [`SETS`] sets. Each fills the space of what is uncertain evenly and is independent
//! of the others, so that their means differ by what sampling leaves: that gives the standard
//! error. All places and speeds see the same draws, so that what is compared differs by the places
//! alone.

use std::sync::Arc;

use nalgebra::Matrix3;
use rayon::prelude::*;
use truecut_arm::Robot;
use truecut_core::chatter::averaged::{mode_coupling_limit, zero_order_limit};
use truecut_core::chatter::limit::first_depth_m;
use truecut_core::chatter::spectral_elements::SpectralElements;

use crate::assess::{assess_without_error, modes_in_cut};
use crate::assessment::Stability;
use crate::criterion::{Criterion, Cut};
use crate::error::PlanError;
use crate::plan::Plan;
use crate::planner::Planner;
use crate::reach::Family;

/// Independent sets of draws.
pub const SETS: usize = 8;
/// Draws of a set where the first of them do not agree on whether a cut is stable.
pub const DRAWS: usize = 128;
/// Draws of a set that every place sees.
const FIRST_DRAWS: usize = 32;
/// Parts of the draws below the ends and the middle of a band.
const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];
/// Even steps of the scan for a limit of a diagram, and parts of the zero-order limit, which tells
/// where a thin unstable island lies, that are looked at besides.
const SCAN_STEPS: usize = 20;
const ZERO_ORDER_PARTS: [f64; 2] = [1.001, 1.02];
/// Relative width to which a limit is narrowed.
const NARROWED: f64 = 1e-3;

/// An arm and a cut as they may be.
#[derive(Debug, Clone)]
pub struct Variant {
    pub robot: Arc<Robot>,
    pub cut: Cut,
}

/// What is said of one draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawn {
    /// A criterion's value: an anisotropy, or a limit depth in m, infinite where there is none.
    pub value: f64,
    pub stability: Stability,
}

/// A part of the draws, and the standard error that sampling leaves in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probability {
    pub value: f64,
    pub standard_error: f64,
}

/// What is said of all draws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Values below which 5, 50 and 95 % of the draws lie.
    pub quantiles: [f64; 3],
    /// That the cut is stable, and that vibration grows in it ([`Stability`]).
    pub stable: Probability,
    pub grows: Probability,
    /// How many draws there were.
    pub draws: usize,
}

/// Asks for some draws of each set, and for all of them where these do not agree on whether the cut
/// is stable.
///
/// # Errors
/// The first error of a draw.
pub fn spread<V: Sync, E: Send>(
    sets: &[Vec<V>],
    of: impl Fn(&V) -> Result<Drawn, E> + Sync,
) -> Result<Spread, E> {
    let ask = |set: &[V]| -> Result<Vec<Drawn>, E> { set.par_iter().map(&of).collect() };
    let first = |set: &Vec<V>| set.len().min(FIRST_DRAWS);
    let mut found: Vec<Vec<Drawn>> = (sets.par_iter())
        .map(|set| ask(&set[..first(set)]))
        .collect::<Result<_, E>>()?;
    let mut all = found.iter().flatten().map(|drawn| drawn.stability);
    let one = all.next();
    if all.any(|other| Some(other) != one) {
        let rest: Vec<Vec<Drawn>> = (sets.par_iter())
            .map(|set| ask(&set[first(set)..]))
            .collect::<Result<_, E>>()?;
        for (set, rest) in found.iter_mut().zip(rest) {
            set.extend(rest);
        }
    }
    Ok(Spread::of(&found))
}

impl Spread {
    fn of(sets: &[Vec<Drawn>]) -> Self {
        let mut values: Vec<f64> = sets.iter().flatten().map(|drawn| drawn.value).collect();
        values.sort_by(f64::total_cmp);
        let last = values.len().saturating_sub(1);
        let quantile = |part: f64| {
            let rank = (part * values.len() as f64).ceil() as usize;
            (values.get(rank.saturating_sub(1).min(last))).map_or(f64::NAN, |value| *value)
        };
        Self {
            quantiles: QUANTILES.map(quantile),
            stable: Probability::of(sets, Stability::Stable),
            grows: Probability::of(sets, Stability::Unstable),
            draws: values.len(),
        }
    }
}

impl Probability {
    fn of(sets: &[Vec<Drawn>], what: Stability) -> Self {
        let part = |set: &Vec<Drawn>| {
            let count = set.iter().filter(|drawn| drawn.stability == what).count();
            count as f64 / set.len().max(1) as f64
        };
        let parts: Vec<f64> = sets.iter().map(part).collect();
        let count = parts.len() as f64;
        let value = parts.iter().sum::<f64>() / count;
        let square = parts.iter().map(|part| (part - value).powi(2)).sum::<f64>();
        Self {
            value,
            standard_error: (square / (count * (count - 1.0)).max(1.0)).sqrt(),
        }
    }
}

/// Where and in which theory limits of a diagram are asked for.
#[derive(Debug, Clone, Copy)]
pub struct LimitOf<'a> {
    pub posture: &'a [f64],
    pub world_from_milling: Matrix3<f64>,
    /// Whether teeth meet the surface that earlier teeth left; else mode coupling limits the cut.
    pub regeneration: bool,
}

impl LimitOf<'_> {
    /// Limits at a spindle speed down to a depth; stable is the cut's own depth below the limit.
    ///
    /// # Errors
    /// If an arm has no modes there.
    pub fn at_speed(
        &self,
        sets: &[Vec<Variant>],
        spindle_rad_s: f64,
        deepest_m: f64,
    ) -> Result<Spread, PlanError> {
        spread(sets, |variant| {
            let (cut, axes) = (&variant.cut, &self.world_from_milling);
            let modes = modes_in_cut(
                &variant.robot,
                self.posture,
                axes,
                &cut.attached.at(spindle_rad_s),
            )?;
            let directional = cut.directional();
            let limit_m = if self.regeneration {
                let period_s = cut.nominal.cutter.tooth_period_s(spindle_rad_s);
                let zero = zero_order_limit(&modes, directional.averaged(period_s), period_s);
                let step_m = deepest_m / SCAN_STEPS as f64;
                let mut depths_m: Vec<f64> = (1..=SCAN_STEPS).map(|i| step_m * i as f64).collect();
                let parts = zero
                    .iter()
                    .flat_map(|zero| ZERO_ORDER_PARTS.map(|part| part * zero.depth_m));
                depths_m.extend(parts.filter(|depth_m| *depth_m < deepest_m));
                depths_m.sort_by(f64::total_cmp);
                let elements = SpectralElements::new(&modes, &directional);
                first_depth_m(&elements.at(period_s), depths_m, NARROWED)
            } else {
                let limit = mode_coupling_limit(&modes, directional.averaged(cut.tooth_period_s()));
                limit.map(|limit| limit.depth_m)
            };
            let value = limit_m.unwrap_or(f64::INFINITY);
            Ok(Drawn {
                value,
                stability: if cut.nominal.axial_depth_m < value {
                    Stability::Stable
                } else {
                    Stability::Unstable
                },
            })
        })
    }
}

impl Planner<'_> {
    /// What a plan's criterion says of `count` of its stations, spread over the path, each by its
    /// place, m.
    ///
    /// # Errors
    /// If an arm has no modes somewhere.
    pub fn spread_along(
        &self,
        plan: &Plan,
        sets: &[Vec<Variant>],
        count: usize,
        progress: &dyn Fn(f64),
    ) -> Result<Vec<(f64, Spread)>, PlanError> {
        let last = plan.points.len() - 1;
        let count = count.clamp(2, last.max(1) + 1);
        let found = (0..count).map(|k| {
            let point = &plan.points[(k * last / (count - 1)).min(last)];
            let spread = self.spread_at(plan.criterion, &point.posture, point.along_m, sets)?;
            progress((k + 1) as f64 / count as f64);
            Ok((point.along_m, spread))
        });
        found.collect()
    }

    /// What a criterion says at a place of every second angle at which a family reaches it, each by
    /// its angle, rad.
    ///
    /// # Errors
    /// If an arm has no modes somewhere.
    pub fn spread_over_angles(
        &self,
        (criterion, family): (Criterion, Family),
        along_m: f64,
        sets: &[Vec<Variant>],
        progress: &dyn Fn(f64),
    ) -> Result<Vec<(f64, Spread)>, PlanError> {
        let column = &self.reach.columns[self.reach.nearest_column(along_m)];
        let angles = self.reach.angles_rad.iter().zip(&column.cells).step_by(2);
        let count = self.reach.angles_rad.len().div_ceil(2) as f64;
        let reached = angles.enumerate().filter_map(|(k, (angle, cell))| {
            progress((k + 1) as f64 / count);
            let candidate = cell.iter().find(|c| Family::from(c.branch) == family)?;
            let found = self.spread_at(criterion, &candidate.posture, column.along_m, sets);
            Some(found.map(|found| (*angle, found)))
        });
        reached.collect()
    }

    fn spread_at(
        &self,
        criterion: Criterion,
        posture: &[f64],
        along_m: f64,
        sets: &[Vec<Variant>],
    ) -> Result<Spread, PlanError> {
        let frame = self.frame(along_m);
        let least_decay = self.options.least_decay;
        spread(sets, |variant| {
            let place = (&*variant.robot, posture, &frame);
            let found = assess_without_error(criterion, place, &variant.cut, least_decay)?;
            Ok(Drawn {
                value: found.value,
                stability: found.stability(),
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn below(limit: f64) -> impl Fn(&f64) -> Result<Drawn, Infallible> + Sync {
        move |value| {
            Ok(Drawn {
                value: *value,
                stability: if *value < limit {
                    Stability::Stable
                } else {
                    Stability::Unstable
                },
            })
        }
    }

    fn even(count: usize, shift: f64) -> Vec<f64> {
        // in an order whose beginning is spread, too
        let place = |i: usize| (i * 37 % count) as f64;
        (0..count)
            .map(|i| (place(i) + shift) / count as f64)
            .collect()
    }

    #[test]
    fn verify_bands_and_probability_of_an_even_spread() {
        let sets: Vec<Vec<f64>> = (0..SETS).map(|k| even(DRAWS, k as f64 / 8.0)).collect();
        let Ok(found) = spread(&sets, below(0.3));
        assert_eq!(found.draws, SETS * DRAWS);
        let near = |a: f64, b: f64| (a - b).abs() < 0.01;
        assert!(near(found.stable.value, 0.3) && near(found.grows.value, 0.7));
        assert!(found.stable.standard_error < 0.01);
        let pairs = found.quantiles.into_iter().zip(QUANTILES);
        assert!(pairs.clone().all(|(a, b)| near(a, b)), "{found:?}");
    }

    /// Where the first draws agree, no more are asked for.
    #[test]
    fn draws_that_agree_are_few() {
        let sets: Vec<Vec<f64>> = (0..SETS).map(|_| even(DRAWS, 0.5)).collect();
        let Ok(found) = spread(&sets, below(2.0));
        assert_eq!(found.draws, SETS * FIRST_DRAWS);
        assert_eq!((found.stable.value, found.grows.value), (1.0, 0.0));
    }

    /// The standard error is that of a mean of independent sets.
    #[test]
    fn verify_standard_error_of_sets() {
        let mut sets = vec![vec![0.0; DRAWS]; SETS];
        sets[0] = vec![1.0; DRAWS];
        let Ok(found) = spread(&sets, below(0.5));
        let [p, n] = [7.0 / 8.0, 8.0_f64];
        let variance = (7.0 * (1.0 - p) * (1.0 - p) + p * p) / 7.0;
        assert_eq!(found.stable.value, p);
        assert!((found.stable.standard_error - (variance / n).sqrt()).abs() < 1e-12);
    }
}
