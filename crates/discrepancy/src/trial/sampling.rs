//! A simulated channel at the times of measured samples.

/// Values at `times_s` by Hermite's cubic through the rows, with slopes from their neighbours
/// (Catmull and Rom): third order between equal steps, exact at the rows. Beyond the ends the first
/// and last rows hold.
pub(crate) fn at(rows_s: &[f64], values: &[f64], times_s: &[f64]) -> Vec<f64> {
    let mut row = 0;
    let last = rows_s.len().saturating_sub(1);
    (times_s.iter())
        .map(|&time| {
            while row + 1 < last && rows_s[row + 1] <= time {
                row += 1;
            }
            if last == 0 || time <= rows_s[0] {
                return values.first().copied().unwrap_or(f64::NAN);
            }
            if time >= rows_s[last] {
                return values[last];
            }
            between(rows_s, values, row, time)
        })
        .collect()
}

fn between(rows_s: &[f64], values: &[f64], row: usize, time: f64) -> f64 {
    let last = rows_s.len() - 1;
    let step = rows_s[row + 1] - rows_s[row];
    let slope = |i: usize| {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
        (values[after] - values[before]) / (rows_s[after] - rows_s[before])
    };
    let s = (time - rows_s[row]) / step;
    let (a, b) = (values[row], values[row + 1]);
    let (u, v) = (slope(row) * step, slope(row + 1) * step);
    let (s2, s3) = (s * s, s * s * s);
    a * (2.0 * s3 - 3.0 * s2 + 1.0)
        + u * (s3 - 2.0 * s2 + s)
        + b * (3.0 * s2 - 2.0 * s3)
        + v * (s3 - s2)
}

#[cfg(test)]
mod tests {
    use super::at;

    #[test]
    fn verify_a_parabola_is_met_exactly_between_rows() {
        let rows: Vec<f64> = (0..20).map(|i| 0.1 * f64::from(i)).collect();
        let values: Vec<f64> = rows.iter().map(|t| 3.0 * t * t - t).collect();
        let times = [0.0, 0.25, 0.731, 1.2];
        for (time, value) in times.iter().zip(at(&rows, &values, &times)) {
            assert!((value - (3.0 * time * time - time)).abs() < 1e-12);
        }
    }

    #[test]
    fn beyond_the_ends_the_last_row_holds() {
        assert_eq!(at(&[0.0, 1.0], &[2.0, 5.0], &[-1.0, 3.0]), [2.0, 5.0]);
    }
}
