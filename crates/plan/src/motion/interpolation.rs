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
}
