//! Cubic splines through samples at any rising times.

/// Slopes at the knots of the cubic spline through them (`deboor2001`): value, slope and bend are
/// continuous, and slopes err by the fourth power of the interval. At both ends it has the slope of
/// the cubic through the four knots there; fewer than four are met by what goes through all.
pub fn spline_slopes(times: &[f64], values: &[f64]) -> Vec<f64> {
    let n = times.len().min(values.len());
    if n < 2 {
        return vec![0.0; n];
    }
    let secant = |i: usize| (values[i + 1] - values[i]) / (times[i + 1] - times[i]);
    let first = end_slope(&times[..n.min(4)], &values[..n.min(4)]);
    let reversed = |x: &[f64]| x[n.saturating_sub(4)..n].iter().rev().copied().collect();
    let (back_times, back_values): (Vec<f64>, Vec<f64>) = (reversed(times), reversed(values));
    let last = end_slope(&back_times, &back_values);
    // h[i] s[i-1] + 2 (h[i-1] + h[i]) s[i] + h[i-1] s[i+1] = 3 (h[i] d[i-1] + h[i-1] d[i]), by
    // Thomas's elimination; h intervals, d secants
    let (mut above, mut slopes) = (vec![0.0; n], vec![0.0; n]);
    (slopes[0], slopes[n - 1]) = (first, last);
    for i in 1..n - 1 {
        let (before, after) = (times[i] - times[i - 1], times[i + 1] - times[i]);
        let pivot = 2.0 * (before + after) - after * above[i - 1];
        above[i] = before / pivot;
        let right = 3.0 * (after * secant(i - 1) + before * secant(i));
        slopes[i] = (right - after * slopes[i - 1]) / pivot;
    }
    for i in (1..n - 1).rev() {
        slopes[i] -= above[i] * slopes[i + 1];
    }
    slopes
}

/// Slope at the first of two to four knots of the polynomial through all of them, by divided
/// differences.
fn end_slope(times: &[f64], values: &[f64]) -> f64 {
    let mut differences = values.to_vec();
    let (mut slope, mut product) = (0.0, 1.0);
    for order in 1..times.len() {
        for i in 0..times.len() - order {
            let apart = times[i + order] - times[i];
            differences[i] = (differences[i + 1] - differences[i]) / apart;
        }
        slope += product * differences[0];
        product *= times[0] - times[order];
    }
    slope
}

/// Value at the share `part` of an interval of `length` of the cubic with these values and slopes
/// at its ends.
pub(crate) fn between([from, to]: [f64; 2], slopes: [f64; 2], length: f64, part: f64) -> f64 {
    let [first, last] = slopes.map(|slope| slope * length - (to - from));
    let rest = 1.0 - part;
    from + (to - from) * part + part * rest * (rest * first - part * last)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rising times, apart by 0.6 to 1.4 of `h`.
    fn uneven(count: usize, h: f64) -> Vec<f64> {
        let moved = |i: usize| i as f64 + 0.2 * (1.7 * i as f64).sin();
        (0..=count).map(|i| h * moved(i)).collect()
    }

    #[test]
    fn verify_a_spline_meets_cubics() {
        let cubic = |x: f64| 0.3 - 2.0 * x + 5.0 * x * x - 0.8 * x * x * x;
        let slope = |x: f64| -2.0 + 10.0 * x - 2.4 * x * x;
        for count in [3, 4, 12] {
            let times = uneven(count, 1.0);
            let values: Vec<f64> = times.iter().map(|x| cubic(*x)).collect();
            let slopes = spline_slopes(&times, &values);
            for (x, found) in times.iter().zip(&slopes) {
                assert!((found - slope(*x)).abs() < 1e-9, "{count} {x}");
            }
            let x = 0.3 * times[1] + 0.7 * times[2];
            let ends = [values[1], values[2]];
            let found = between(ends, [slopes[1], slopes[2]], times[2] - times[1], 0.7);
            assert!((found - cubic(x)).abs() < 1e-9, "{count}");
        }
    }

    #[test]
    fn verify_slopes_are_of_fourth_order() {
        let worst = |count: usize| {
            let times: Vec<f64> = (0..=count).map(|i| 6.0 / count as f64 * i as f64).collect();
            let values: Vec<f64> = times.iter().map(|t| t.sin()).collect();
            let slopes = spline_slopes(&times, &values).into_iter().zip(&times);
            let errors = slopes.map(|(slope, t)| (slope - t.cos()).abs());
            errors.skip(count / 4).take(count / 2).fold(0.0, f64::max)
        };
        let ratio = worst(40) / worst(80);
        assert!((14.0..18.0).contains(&ratio), "{ratio}");
    }
}
