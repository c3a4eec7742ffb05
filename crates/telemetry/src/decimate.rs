//! Fewer points that still show every extreme.

/// Rows a second that a plot gets at most. A screen shows no more, and the file stays small; the
/// Parquet file keeps every row.
pub(crate) const ROWS_PER_SECOND: f64 = 1000.0;
/// As [`ROWS_PER_SECOND`], for plots that are not seen at once.
pub(crate) const BEHIND_ROWS_PER_SECOND: f64 = 250.0;

/// The rows worth drawing of channels that share a plot: of every interval the smallest and the
/// largest value of each channel, in their order. The more channels, the longer the interval, so
/// that the rate is kept. All rows if they are no denser than that; first and last alone if no
/// channel changes.
pub(crate) fn rows_to_draw(
    time_s: &[f64],
    channels: &[&[f64]],
    rows_per_second: f64,
    keep: &mut Vec<usize>,
) {
    keep.clear();
    let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else {
        return;
    };
    let rows = time_s.len();
    if channels
        .iter()
        .all(|values| values.iter().all(|value| *value == values[0]))
    {
        keep.push(0);
        keep.extend((rows > 1).then_some(rows - 1));
        return;
    }
    let step_s = (last - first) / (rows - 1).max(1) as f64;
    let extremes_at_most = 2 * channels.len();
    let interval = (extremes_at_most as f64 / rows_per_second / step_s).round() as usize;
    if interval <= extremes_at_most {
        keep.extend(0..rows);
        return;
    }
    for start in (0..rows).step_by(interval) {
        let end = rows.min(start + interval);
        let drawn = keep.len();
        for values in channels {
            let (low, high) = extremes(&values[start..end]);
            keep.push(start + low);
            keep.push(start + high);
        }
        keep[drawn..].sort_unstable();
        keep.dedup();
    }
}

/// Places of the smallest and the largest value. A NaN is both, so that it is drawn as the gap that
/// it is.
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

    fn kept(step_s: f64, channels: &[&[f64]]) -> Vec<usize> {
        let time_s: Vec<f64> = (0..channels[0].len())
            .map(|row| row as f64 * step_s)
            .collect();
        let mut keep = Vec::new();
        rows_to_draw(&time_s, channels, ROWS_PER_SECOND, &mut keep);
        keep
    }

    #[test]
    fn every_extreme_of_every_channel_survives() {
        let wave = |phase: f64| -> Vec<f64> {
            (0..4000)
                .map(|row| (0.01 * row as f64 + phase).sin() + 1e-3 * f64::from(row % 7))
                .collect()
        };
        let channels = [wave(0.0), wave(1.0), wave(2.0)];
        let channels: Vec<&[f64]> = channels.iter().map(Vec::as_slice).collect();
        let keep = kept(2.5e-4, &channels);
        assert!(
            keep.windows(2).all(|pair| pair[0] < pair[1]),
            "in order, none twice"
        );
        assert!(keep.len() <= 1000, "{} rows for one second", keep.len());
        for values in &channels {
            for start in (0..4000).step_by(24) {
                let bucket = &values[start..4000.min(start + 24)];
                let rows = keep.iter().filter(|row| (start..start + 24).contains(*row));
                let drawn: Vec<f64> = rows.map(|row| values[*row]).collect();
                assert!(drawn.contains(&bucket.iter().copied().fold(f64::INFINITY, f64::min)));
                assert!(drawn.contains(&bucket.iter().copied().fold(f64::NEG_INFINITY, f64::max)));
            }
        }
    }

    #[test]
    fn sparse_rows_are_all_kept_and_constants_take_two() {
        assert_eq!(kept(1e-3, &[&[1.0, 2.0, 1.0]]), [0, 1, 2]);
        assert_eq!(kept(1e-5, &[&[3.0; 500], &[4.0; 500]]), [0, 499]);
        assert_eq!(kept(1e-3, &[&[1.0]]), [0]);
        assert!(kept(1e-3, &[&[]]).is_empty());
    }

    #[test]
    fn a_nan_is_drawn() {
        let mut values: Vec<f64> = (0..100).map(f64::from).collect();
        values[37] = f64::NAN;
        assert!(kept(2.5e-4, &[&values]).contains(&37));
    }
}
