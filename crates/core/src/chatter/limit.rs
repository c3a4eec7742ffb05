//! The depth at which a cut first becomes unstable.

use std::convert::Infallible;

use super::semi_discretisation::{Multiplier, SemiDiscretisation};
use crate::roots::try_bisect_while;

/// Where stability is first lost as the depth grows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstLimit {
    pub depth_m: f64,
    /// The multiplier just above the limit.
    pub multiplier: Multiplier,
}

/// How the first limit is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitSearch {
    /// Deepest cut looked at, m.
    pub deepest_m: f64,
    /// Number of even steps in which depth is raised; an unstable island thinner than one may be
    /// missed.
    pub scan_steps: usize,
    /// Relative width to which the limit is narrowed. A cut that is unstable at any depth has a
    /// limit of less than a millionth of the deepest.
    pub relative_width: f64,
}

impl LimitSearch {
    /// Sixty steps, narrowed to 1e-4.
    pub fn to_depth(deepest_m: f64) -> Self {
        Self {
            deepest_m,
            scan_steps: 60,
            relative_width: 1e-4,
        }
    }
}

/// Smallest depth at which the dominant multiplier leaves the unit circle at a tooth period, m: a
/// scan upwards, then bisection. `None` if all depths up to the deepest are stable.
pub fn first_limit(
    of: &SemiDiscretisation,
    tooth_period_s: f64,
    search: &LimitSearch,
) -> Option<FirstLimit> {
    let at = |depth_m: f64| of.multiplier(tooth_period_s, depth_m);
    let depth = |i: usize| search.deepest_m * i as f64 / search.scan_steps as f64;
    let (step, mut multiplier) = (1..=search.scan_steps)
        .map(|i| (i, at(depth(i))))
        .find(|(_, multiplier)| !multiplier.is_stable())?;
    let wide = |[low, high]: [f64; 2]| {
        high - low > search.relative_width * high && high > 1e-6 * search.deepest_m
    };
    let Ok([_, depth_m]) = try_bisect_while([depth(step - 1), depth(step)], wide, |depth_m| {
        let found = at(depth_m);
        if !found.is_stable() {
            multiplier = found;
        }
        Ok::<_, Infallible>(!found.is_stable())
    });
    Some(FirstLimit {
        depth_m,
        multiplier,
    })
}
