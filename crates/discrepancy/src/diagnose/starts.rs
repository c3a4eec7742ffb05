//! Points from which fits begin.

use super::fit::Fit;
use super::problem::{Found, Point};
use super::screen::Ranked;

/// Values of two starts that differ by no more than this factor lead to the same end.
const ALIKE: f64 = 2.0;

/// The model with these effects more.
pub(super) fn extended(base: &Fit, added: &[&Ranked]) -> Point {
    let mut point = base.point.clone();
    point.effects.extend(added.iter().map(|r| Found {
        candidate: r.candidate(),
        values: r.start.clone(),
        smoothing: 0.0,
    }));
    point
}

/// Whether both start with the same effects from values that are nearly the same, wherever the
/// nominal ones are.
pub(super) fn is_like(a: &Point, b: &Point) -> bool {
    let same = |a: &Found, b: &Found| {
        let mut pairs = a.values.iter().zip(&b.values);
        a.candidate == b.candidate
            && pairs.all(|(x, y)| x == y || x / y > 1.0 / ALIKE && x / y < ALIKE)
    };
    a.effects.len() == b.effects.len() && a.effects.iter().zip(&b.effects).all(|(a, b)| same(a, b))
}

/// The best start and those of other shapes that promise half as much.
pub(super) fn all_starts(base: &Fit, ranked: &Ranked) -> Vec<Point> {
    let mut starts = vec![extended(base, &[ranked])];
    for other in &ranked.others {
        let mut ranked = ranked.clone();
        ranked.start.clone_from(other);
        starts.push(extended(base, &[&ranked]));
    }
    starts
}

/// The point with one effect less.
pub(super) fn without(point: &Point, index: usize) -> Point {
    let mut point = point.clone();
    point.effects.remove(index);
    point
}
