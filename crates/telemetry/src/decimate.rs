//! Fewer points that still show every extreme.

/// Points a second that the viewer gets at most. A screen shows no more, and the file stays small; the
/// Parquet file keeps every row.
pub(crate) const POINTS_PER_SECOND: f64 = 1000.0;

/// The rows worth drawing of one channel: of every interval the smallest and the largest value, in their
/// order. All rows if they are no denser than that; first and last alone if the channel does not change.
pub(crate) fn rows_to_draw(time_s: &[f64], values: &[f64], keep: &mut Vec<usize>) {
    keep.clear();
    let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else { return };
    let rows = time_s.len();
    if values.iter().all(|value| *value == values[0]) {
        keep.push(0);
        keep.extend((rows > 1).then_some(rows - 1));
        return;
    }
    let step_s = (last - first) / (rows - 1).max(1) as f64;
    let interval = (2.0 / POINTS_PER_SECOND / step_s).round() as usize;
    if interval <= 2 {
        keep.extend(0..rows);
        return;
    }
    for start in (0..rows).step_by(interval) {
        let bucket = &values[start..rows.min(start + interval)];
        let (low, high) = extremes(bucket);
        keep.push(start + low.min(high));
        keep.extend((low != high).then_some(start + low.max(high)));
    }
}

/// Places of the smallest and the largest value. A NaN is both, so that it is drawn as the gap that it is.
fn extremes(bucket: &[f64]) -> (usize, usize) {
    let (mut low, mut high) = (0, 0);
    for (place, value) in bucket.iter().enumerate() {
        if value.is_nan() {
            return (place, place);
        }
        if *value < bucket[low] {
            low = place;
        }
        if *value > bucket[high] {
            high = place;
        }
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(step_s: f64, values: &[f64]) -> Vec<usize> {
        let time_s: Vec<f64> = (0..values.len()).map(|row| row as f64 * step_s).collect();
        let mut keep = Vec::new();
        rows_to_draw(&time_s, values, &mut keep);
        keep
    }

    #[test]
    fn verify_every_extreme_survives() {
        let values: Vec<f64> = (0..4000).map(|row| (0.01 * row as f64).sin() + 1e-3 * f64::from(row % 7)).collect();
        let keep = kept(2.5e-4, &values);
        assert!(keep.windows(2).all(|pair| pair[0] < pair[1]), "in order");
        assert!(keep.len() <= 1000, "{} points for one second", keep.len());
        for (bucket, start) in values.chunks(8).zip((0..).step_by(8)) {
            let drawn: Vec<f64> =
                keep.iter().filter(|row| (start..start + 8).contains(*row)).map(|row| values[*row]).collect();
            assert!(drawn.contains(&bucket.iter().copied().fold(f64::INFINITY, f64::min)));
            assert!(drawn.contains(&bucket.iter().copied().fold(f64::NEG_INFINITY, f64::max)));
        }
    }

    #[test]
    fn sparse_rows_are_all_kept_and_a_constant_takes_two() {
        assert_eq!(kept(1e-3, &[1.0, 2.0, 1.0]), [0, 1, 2]);
        assert_eq!(kept(1e-5, &[3.0; 500]), [0, 499]);
        assert_eq!(kept(1e-3, &[1.0]), [0]);
        assert!(kept(1e-3, &[]).is_empty());
    }

    #[test]
    fn a_nan_is_drawn() {
        let mut values: Vec<f64> = (0..100).map(f64::from).collect();
        values[37] = f64::NAN;
        assert!(kept(2.5e-4, &values).contains(&37));
    }
}
