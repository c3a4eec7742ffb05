//! One number from a stretch of one channel. Plain functions on slices; `time_s` ascends and is as
//! long as `values`.
//!
//! A NaN anywhere gives NaN: a number must not look good because the bad rows fell out.

/// The largest of |x|.
pub fn peak(values: &[f64]) -> f64 {
    extreme(values.iter().map(|value| value.abs()), f64::max)
}

/// The largest value.
pub fn max(values: &[f64]) -> f64 {
    extreme(values.iter().copied(), f64::max)
}

/// The smallest value.
pub fn min(values: &[f64]) -> f64 {
    extreme(values.iter().copied(), f64::min)
}

/// Largest minus smallest.
pub fn range(values: &[f64]) -> f64 {
    max(values) - min(values)
}

/// f64::max and f64::min drop a NaN, so it is carried by hand.
fn extreme(values: impl Iterator<Item = f64>, choose: fn(f64, f64) -> f64) -> f64 {
    values
        .reduce(|best, value| {
            if best.is_nan() || value.is_nan() {
                f64::NAN
            } else {
                choose(best, value)
            }
        })
        .unwrap_or(f64::NAN)
}

/// Mean over time, by the trapezoidal rule.
pub fn mean(time_s: &[f64], values: &[f64]) -> f64 {
    mean_of(time_s, values, |value| value)
}

/// Root of the mean square over time, by the trapezoidal rule.
pub fn rms(time_s: &[f64], values: &[f64]) -> f64 {
    mean_of(time_s, values, |value| value * value).sqrt()
}

fn mean_of(time_s: &[f64], values: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    match values {
        [] => f64::NAN,
        [only] => f(*only),
        _ => integral(time_s, values, f) / (time_s[time_s.len() - 1] - time_s[0]),
    }
}

fn integral(time_s: &[f64], values: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    let intervals = time_s.windows(2).zip(values.windows(2));
    intervals
        .map(|(time, value)| 0.5 * (time[1] - time[0]) * (f(value[0]) + f(value[1])))
        .sum()
}

/// How long |x| is above the threshold. A row stands for half of the time to each neighbour, so
/// that a flag that is up in k rows lasts k steps.
pub fn duration_above(time_s: &[f64], values: &[f64], threshold: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    // NaN stays NaN in the sum instead of comparing as "not above".
    integral(time_s, values, |value| {
        if value.is_nan() {
            value
        } else {
            f64::from(u8::from(value.abs() > threshold))
        }
    })
}

/// The first time from which |x| stays above the threshold for at least `hold_s`; `None` if there
/// is none. What is still above at the end counts only if it has been so for `hold_s`.
pub fn first_time_above(
    time_s: &[f64],
    values: &[f64],
    threshold: f64,
    hold_s: f64,
) -> Option<f64> {
    let mut since = None;
    for (&time, &value) in time_s.iter().zip(values) {
        if value.abs() > threshold {
            let start = *since.get_or_insert(time);
            // Times are sums of steps: a hair less than the hold time is enough.
            if time - start >= hold_s * (1.0 - 1e-9) {
                return Some(start);
            }
        } else {
            since = None;
        }
    }
    None
}

/// The largest length of the vector with these components.
pub fn peak_norm(components: &[&[f64]]) -> f64 {
    let rows = components
        .iter()
        .map(|component| component.len())
        .min()
        .unwrap_or(0);
    let norms = (0..rows).map(|row| {
        components
            .iter()
            .map(|c| c[row] * c[row])
            .sum::<f64>()
            .sqrt()
    });
    extreme(norms, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(rows: usize, step_s: f64, frequency_hz: f64) -> (Vec<f64>, Vec<f64>) {
        let time_s: Vec<f64> = (0..rows).map(|row| row as f64 * step_s).collect();
        let values = time_s
            .iter()
            .map(|t| (std::f64::consts::TAU * frequency_hz * t).sin())
            .collect();
        (time_s, values)
    }

    #[test]
    fn verify_mean_and_rms_of_a_sine() {
        let (time_s, values) = sine(2001, 1e-3, 5.0); // ten whole periods
        assert!(mean(&time_s, &values).abs() < 1e-12);
        // The trapezoidal rule is exact for whole periods of a band-limited signal; what is left is
        // rounding.
        assert!((rms(&time_s, &values) - 0.5_f64.sqrt()).abs() < 1e-12);
        assert!((range(&values) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn verify_uneven_steps_are_weighted_by_time() {
        let time_s = [0.0, 1.0, 4.0];
        // ∫ = ½·1·(0+2) + ½·3·(2+4) = 10, over 4 s.
        assert!((mean(&time_s, &[0.0, 2.0, 4.0]) - 2.5).abs() < 1e-15);
    }

    #[test]
    fn verify_extremes() {
        let values = [1.0, -3.0, 2.0];
        assert_eq!(
            (peak(&values), max(&values), min(&values), range(&values)),
            (3.0, 2.0, -3.0, 5.0)
        );
        assert_eq!(peak_norm(&[&[3.0, 0.0], &[4.0, 1.0]]), 5.0);
    }

    #[test]
    fn verify_a_flag_up_in_k_rows_lasts_k_steps() {
        let time_s: Vec<f64> = (0..101).map(|row| f64::from(row) * 0.01).collect();
        let flag: Vec<f64> = (0..101)
            .map(|row| f64::from(u8::from((20..45).contains(&row))))
            .collect();
        assert!((duration_above(&time_s, &flag, 0.5) - 0.25).abs() < 1e-12);
        assert!(
            (duration_above(&time_s, &vec![1.0; 101], 0.5) - 1.0).abs() < 1e-12,
            "always up: the whole run"
        );
        assert_eq!(duration_above(&time_s, &flag, 2.0), 0.0);
    }

    #[test]
    fn first_time_above_skips_what_does_not_last() {
        let time_s: Vec<f64> = (0..100).map(f64::from).collect();
        let mut values = vec![0.0; 100];
        values[10] = -5.0; // one row only
        values[30..40].fill(-5.0); // nine intervals
        assert_eq!(first_time_above(&time_s, &values, 1.0, 0.0), Some(10.0));
        assert_eq!(first_time_above(&time_s, &values, 1.0, 9.0), Some(30.0));
        assert_eq!(first_time_above(&time_s, &values, 1.0, 9.5), None);
    }

    #[test]
    fn nan_is_carried() {
        let time_s = [0.0, 1.0, 2.0];
        let values = [1.0, f64::NAN, 2.0];
        for result in [
            peak(&values),
            max(&values),
            min(&values),
            range(&values),
            rms(&time_s, &values),
        ] {
            assert!(result.is_nan());
        }
        assert!(duration_above(&time_s, &values, 0.5).is_nan());
        assert!(peak_norm(&[&values, &[1.0, 1.0, 1.0]]).is_nan());
        assert!(peak(&[]).is_nan(), "nothing is not zero");
    }
}
