//! Root finding: bisection, Newton's iteration, alone and within a bracket, and regula falsi.

use std::convert::Infallible;

/// Iterations of Newton's and of regula falsi; both are done long before, and halving would be.
const MOST_STEPS: usize = 60;

/// Halves an interval while it is `wide`: a condition fails at its first end and holds at its
/// second, which may lie on either side. Gives the ends last reached.
///
/// # Errors
/// As the condition.
pub fn try_bisect_while<E>(
    ends: [f64; 2],
    mut wide: impl FnMut([f64; 2]) -> bool,
    mut holds: impl FnMut(f64) -> Result<bool, E>,
) -> Result<[f64; 2], E> {
    let [mut before, mut after] = ends;
    while wide([before, after]) {
        let middle = 0.5 * (before + after);
        if holds(middle)? {
            after = middle;
        } else {
            before = middle;
        }
    }
    Ok([before, after])
}

/// [`try_bisect_while`] for so many halvings.
///
/// # Errors
/// As the condition.
pub fn try_bisect<E>(
    ends: [f64; 2],
    halvings: usize,
    holds: impl FnMut(f64) -> Result<bool, E>,
) -> Result<[f64; 2], E> {
    let mut left = 0..halvings;
    try_bisect_while(ends, |_| left.next().is_some(), holds)
}

/// [`try_bisect`] for a condition that cannot fail.
pub fn bisect(ends: [f64; 2], halvings: usize, mut holds: impl FnMut(f64) -> bool) -> [f64; 2] {
    let Ok(found) = try_bisect(ends, halvings, |x| Ok::<_, Infallible>(holds(x)));
    found
}

/// Newton's iteration for functions on which it converges from `start` whatever happens (convex,
/// from the right side). `step` is what is added to x; one of at most `last_step` times |x| is the
/// last, and is taken: convergence is quadratic.
#[inline]
pub fn newton(start: f64, last_step: f64, mut step: impl FnMut(f64) -> f64) -> f64 {
    let mut x = start;
    for _ in 0..MOST_STEPS {
        let change = step(x);
        x += change;
        if change.abs() <= last_step * x.abs() {
            break;
        }
    }
    x
}

/// Newton's iteration within a bracket, which is halved where a step would leave it. `f` gives the
/// function, not above zero at the bracket's first end and not below it at the second, and its
/// slope. A step of at most `last_step`, in units of x, is the last, and is taken.
pub fn newton_within(
    bracket: [f64; 2],
    start: f64,
    last_step: f64,
    mut f: impl FnMut(f64) -> (f64, f64),
) -> f64 {
    let [mut below, mut above] = bracket;
    let kept = |x: f64, below: f64, above: f64| {
        if (below.min(above)..=below.max(above)).contains(&x) {
            x
        } else {
            0.5 * (below + above)
        }
    };
    let mut x = kept(start, below, above);
    for _ in 0..MOST_STEPS {
        let (value, slope) = f(x);
        if value > 0.0 {
            above = x;
        } else {
            below = x;
        }
        let next = kept(x - value / slope, below, above);
        let change = (next - x).abs();
        x = next;
        if change <= last_step {
            break;
        }
    }
    x
}

/// Regula falsi after Illinois for a function that falls from `values[0]` > 0 at `ends[0]` to
/// `values[1]` < 0 at `ends[1]`, to the part `same` of the upper end, in x and in the value. `f` is
/// called last at the root; never, if the bracket is closed already.
pub fn illinois(ends: [f64; 2], values: [f64; 2], same: f64, mut f: impl FnMut(f64) -> f64) {
    let ([mut low, mut high], [mut at_low, mut at_high]) = (ends, values);
    // An end that stays a second time counts half.
    let mut rose = None;
    for trial in 0..MOST_STEPS {
        if high - low <= same * high || at_high >= 0.0 {
            break;
        }
        // Where the function bends within the bracket, halving it is what helps.
        let x = if trial % 4 == 3 {
            0.5 * (low + high)
        } else {
            (low * at_high - high * at_low) / (at_high - at_low)
        };
        let value = f(x);
        if value.abs() <= same * high {
            break;
        }
        let rises = value > 0.0;
        let stays = rose == Some(rises);
        if rises {
            (low, at_low) = (x, value);
            at_high *= if stays { 0.5 } else { 1.0 };
        } else {
            (high, at_high) = (x, value);
            at_low *= if stays { 0.5 } else { 1.0 };
        }
        rose = Some(rises);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_all_find_the_root_of_two() {
        let root = 2f64.sqrt();
        let [low, high] = bisect([0.0, 2.0], 52, |x| x * x >= 2.0);
        assert!(low < root && root <= high && high - low < 1e-15);
        let falling = bisect([2.0, 0.0], 52, |x| x * x <= 2.0);
        assert!((falling[1] - root).abs() < 1e-15);
        let found = newton(2.0, 1e-8, |x| (2.0 - x * x) / (2.0 * x));
        assert!((found - root).abs() < 1e-15);
        // A first step that leaves the bracket, and a bracket that falls.
        for bracket in [[0.0, 2.0], [2.0, 0.0]] {
            let sign = if bracket[0] == 0.0 { 1.0 } else { -1.0 };
            let found = newton_within(bracket, 1e-3, 1e-9, |x| {
                (sign * (x * x - 2.0), sign * 2.0 * x)
            });
            assert!((found - root).abs() < 1e-14, "{found}");
        }
        let mut last = 0.0;
        illinois([0.0, 2.0], [2.0, -2.0], 1e-12, |x| {
            last = x;
            2.0 - x * x
        });
        assert!((last - root).abs() < 1e-11, "{last}");
    }

    #[test]
    fn a_condition_that_fails_ends_the_search() {
        let found = try_bisect([0.0, 1.0], 9, |x| if x < 0.3 { Err(x) } else { Ok(true) });
        assert_eq!(found, Err(0.25));
    }
}
