//! Cubic interpolation between even knots: value and slope per interval.

/// Hermite's cubic from `p0` to `p1` with slopes `m0` and `m1` per interval, at a share `u` of it.
#[must_use]
pub fn hermite([p0, p1]: [f64; 2], [m0, m1]: [f64; 2], u: f64) -> [f64; 2] {
    let (rise, bend) = (p1 - p0, m0 + m1 - 2.0 * (p1 - p0));
    [
        p0 + u * (m0 + u * (rise - m0 + (u - 1.0) * bend)),
        m0 + u * (2.0 * (rise - m0 - bend) + 3.0 * u * bend),
    ]
}

/// Slope at knot `i` of even knots 0 to `last`, per interval: by differences exact for parabolas,
/// central within, one-sided at both ends.
#[must_use]
pub fn slope(knot: impl Fn(usize) -> f64, last: usize, i: usize) -> f64 {
    let p = |i: usize| knot(i.min(last));
    match i {
        _ if last < 2 => p(last) - p(0),
        0 => -1.5 * p(0) + 2.0 * p(1) - 0.5 * p(2),
        i if i >= last => 1.5 * p(last) - 2.0 * p(last - 1) + 0.5 * p(last - 2),
        i => 0.5 * (p(i + 1) - p(i - 1)),
    }
}

/// Slopes at even knots, per interval, of the cubic spline through them (`deboor2001`): value,
/// slope and bend are continuous, and slopes err by the fourth power of the interval. At both ends
/// it has the slope of the cubic through the four knots there. Fewer than four are met by parabolas.
#[must_use]
pub fn spline_slopes(knots: &[f64]) -> Vec<f64> {
    let n = knots.len();
    if n < 4 {
        return (0..n).map(|i| slope(|k| knots[k], n - 1, i)).collect();
    }
    let end = |p: [f64; 4]| (-11.0 * p[0] + 18.0 * p[1] - 9.0 * p[2] + 2.0 * p[3]) / 6.0;
    let first = end([knots[0], knots[1], knots[2], knots[3]]);
    let last = -end([knots[n - 1], knots[n - 2], knots[n - 3], knots[n - 4]]);
    // s[i - 1] + 4 s[i] + s[i + 1] = 3 (p[i + 1] - p[i - 1]), by Thomas's elimination
    let (mut above, mut slopes) = (vec![0.0; n], vec![0.0; n]);
    (slopes[0], slopes[n - 1]) = (first, last);
    for i in 1..n - 1 {
        let pivot = 4.0 - above[i - 1];
        above[i] = 1.0 / pivot;
        slopes[i] = (3.0 * (knots[i + 1] - knots[i - 1]) - slopes[i - 1]) / pivot;
    }
    for i in (1..n - 1).rev() {
        slopes[i] -= above[i] * slopes[i + 1];
    }
    slopes
}

/// Lagrange's cubic through four knots, at a share `u` of the interval between the middle ones.
#[must_use]
pub fn lagrange([p0, p1, p2, p3]: [f64; 4], u: f64) -> [f64; 2] {
    let a = (-p0 + 3.0 * p1 - 3.0 * p2 + p3) / 6.0;
    let b = (p0 - 2.0 * p1 + p2) / 2.0;
    let c = (-2.0 * p0 - 3.0 * p1 + 6.0 * p2 - p3) / 6.0;
    [
        ((a * u + b) * u + c) * u + p1,
        (3.0 * a * u + 2.0 * b) * u + c,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both are exact for cubics.
    #[test]
    fn verify_cubics_are_met_between_knots() {
        let f = |x: f64| 0.2 + x * (0.3 + x * (-0.7 + 0.4 * x));
        let d = |x: f64| 0.3 + x * (-1.4 + 1.2 * x);
        for u in [0.0, 0.13, 0.5, 0.81, 1.0] {
            let found = [
                hermite([f(0.0), f(1.0)], [d(0.0), d(1.0)], u),
                lagrange([f(-1.0), f(0.0), f(1.0), f(2.0)], u),
            ];
            for [value, slope] in found {
                assert!(
                    (value - f(u)).abs() < 1e-14 && (slope - d(u)).abs() < 1e-13,
                    "{u}"
                );
            }
        }
    }

    #[test]
    fn verify_slopes_of_a_parabola() {
        let f = |i: usize| 0.3 - 2.0 * i as f64 + 5.0 * (i as f64).powi(2);
        for i in 0..=7 {
            assert!(
                (slope(f, 7, i) - (10.0 * i as f64 - 2.0)).abs() < 1e-12,
                "{i}"
            );
        }
    }

    /// A spline meets cubics, and its slopes err by the fourth power of the interval.
    #[test]
    fn verify_spline_slopes_are_of_fourth_order() {
        let cubic = |x: f64| 0.3 - 2.0 * x + 5.0 * x * x - 0.8 * x * x * x;
        let knots: Vec<f64> = (0..12).map(|i| cubic(i as f64)).collect();
        for (i, slope) in spline_slopes(&knots).iter().enumerate() {
            let x = i as f64;
            assert!((slope - (-2.0 + 10.0 * x - 2.4 * x * x)).abs() < 1e-10);
        }
        let worst = |count: usize| {
            let h = 6.0 / count as f64;
            let knots: Vec<f64> = (0..=count).map(|i| (h * i as f64).sin()).collect();
            let slopes = spline_slopes(&knots).into_iter().enumerate();
            let errors = slopes.map(|(i, s)| (s / h - (h * i as f64).cos()).abs());
            let inner = errors.skip(count / 4).take(count / 2);
            inner.fold(0.0, f64::max)
        };
        let ratio = worst(40) / worst(80);
        assert!((14.0..18.0).contains(&ratio), "{ratio}");
    }
}
