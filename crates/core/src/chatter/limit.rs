//! The depth at which a cut first becomes unstable.

use std::convert::Infallible;

use super::multiplier::Multiplier;
use super::spectral_elements::{AtSpeed, SpectralElements};
use crate::roots::{bisect, illinois, try_bisect_while};

/// Where stability is first lost as the depth grows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstLimit {
    pub depth_m: f64,
    /// By how much the discretisation in time puts the limit wrong, m: estimated from a finer one,
    /// which finds the limit at about `depth_m` less this. What the search leaves
    /// ([`LimitSearch::relative_width`]) is not in it.
    pub error_m: f64,
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
    of: &SpectralElements,
    tooth_period_s: f64,
    search: &LimitSearch,
) -> Option<FirstLimit> {
    let at = of.at(tooth_period_s);
    let depth = |i: usize| search.deepest_m * i as f64 / search.scan_steps as f64;
    let (stable_m, unstable) = scanned(&at, (1..=search.scan_steps).map(depth))?;
    let least_m = 1e-6 * search.deepest_m;
    Some(narrowed(
        &at,
        stable_m,
        unstable,
        search.relative_width,
        least_m,
    ))
}

/// Smallest depth at which the cut becomes unstable, m, as seen from rising depths that are looked
/// at, narrowed to a relative width: with fewer multipliers than [`first_limit`], since ln |μ| is
/// followed to its root, and without an error.
pub fn first_depth_m(
    at: &AtSpeed<'_>,
    depths_m: impl IntoIterator<Item = f64>,
    relative_width: f64,
) -> Option<f64> {
    let (stable_m, unstable) = scanned(at, depths_m)?;
    let growth = |multiplier: &Multiplier| multiplier.magnitude().ln();
    let mut depth_m = unstable.depth_m;
    let below = growth(&at.multiplier(stable_m));
    let values = [-below, -growth(&unstable.multiplier)];
    illinois([stable_m, depth_m], values, relative_width, |x| {
        depth_m = x;
        -growth(&at.multiplier(x))
    });
    Some(depth_m)
}

/// The first unstable one of rising depths, and the one before it; 0 before the first.
fn scanned(at: &AtSpeed<'_>, depths_m: impl IntoIterator<Item = f64>) -> Option<(f64, FirstLimit)> {
    let mut stable_m = 0.0;
    for depth_m in depths_m {
        let multiplier = at.multiplier(depth_m);
        if !multiplier.is_stable() {
            let unstable = FirstLimit {
                depth_m,
                error_m: 0.0,
                multiplier,
            };
            return Some((stable_m, unstable));
        }
        stable_m = depth_m;
    }
    None
}

/// The limit between a stable depth and an unstable one, to a relative width or, where it is less,
/// to `least_m`.
pub fn narrowed(
    at: &AtSpeed<'_>,
    stable_m: f64,
    unstable: FirstLimit,
    relative_width: f64,
    least_m: f64,
) -> FirstLimit {
    let mut multiplier = unstable.multiplier;
    let wide = |[low, high]: [f64; 2]| high - low > relative_width * high && high > least_m;
    let Ok([_, depth_m]) = try_bisect_while([stable_m, unstable.depth_m], wide, |depth_m| {
        let found = at.multiplier(depth_m);
        if !found.is_stable() {
            multiplier = found;
        }
        Ok::<_, Infallible>(!found.is_stable())
    });
    FirstLimit {
        depth_m,
        error_m: error_m(at, depth_m, &multiplier),
        multiplier,
    }
}

/// Part of a depth over which the change of ln |μ| is taken.
const APART: f64 = 1e-3;
/// From this part of the depth on an error is found by looking for the finer limit, in brackets of
/// so many times the first estimate: the growth need not be straight so far.
const LARGE: f64 = 1e-4;
const BRACKETS: [f64; 3] = [2.0, 8.0, 32.0];
/// Relative width to which an error is then found.
const ERROR_WIDTH: f64 = 1e-2;

/// Distance to the limit at a finer resolution: what ln |μ| changes by, over its slope.
fn error_m(at: &AtSpeed<'_>, depth_m: f64, multiplier: &Multiplier) -> f64 {
    let finer = at.finer();
    let growth = |at: &AtSpeed<'_>, depth_m| at.multiplier(depth_m).magnitude().ln();
    let here = multiplier.magnitude().ln();
    let apart_m = APART * depth_m;
    let slope_per_m = (growth(at, depth_m + apart_m) - here) / apart_m;
    let first_m = ((growth(&finer, depth_m) - here) / slope_per_m).abs();
    if first_m < LARGE * depth_m {
        return first_m;
    }
    let unstable = |depth_m: f64| growth(&finer, depth_m) > 0.0;
    let bracket = BRACKETS.iter().find_map(|wide| {
        let [low, high] = [-wide, *wide].map(|side| (depth_m + side * first_m).max(0.0));
        (!unstable(low) && unstable(high)).then_some([low, high])
    });
    let Some(bracket) = bracket else {
        return first_m;
    };
    let halvings = (bracket[1] - bracket[0]) / (ERROR_WIDTH * first_m);
    let [_, limit_m] = bisect(bracket, halvings.log2().ceil() as usize, unstable);
    (limit_m - depth_m).abs()
}
