//! What a motion is apart from its forced part, which repeats with the teeth.
//!
//! At a lobe's best speed vibration stands beside a harmonic of the teeth, far below it in size. It
//! is told apart in time: all samples that stand at one place in the period are forced alike, up to
//! what changes slowly while the tool travels. Their mean and trend over the periods are taken off.
//! That leaves a vibration as it was, unless it is nearer to a harmonic than some two periods of
//! the whole motion, and does not care how large the forced part is.

/// A motion without its forced part.
#[derive(Debug, Clone, PartialEq)]
pub struct Unforced {
    pub values: Vec<f64>,
    /// Time between two of them, as a part of that between two samples of the motion.
    pub interval: f64,
}

/// Fewest periods from which a forced part can be told.
const FEWEST_PERIODS: usize = 4;
/// Samples through which a motion is interpolated.
const POINTS: usize = 6;
/// Part of a sample by which a period counts as a whole number of them.
const WHOLE: f64 = 1e-6;

/// A motion without what repeats with a period of so many samples. Where that is no whole number,
/// the motion is interpolated to fifth degree (Lagrange) at the next denser steps of which a whole
/// number makes a period. `None` if it lasts for less than four periods, or is not finite.
pub fn unforced(motion: &[f64], period: f64) -> Option<Unforced> {
    let short = period.is_nan() || period < POINTS as f64;
    if short || !motion.iter().all(|x| x.is_finite()) {
        return None;
    }
    let whole = (period - WHOLE).ceil();
    let interval = period / whole;
    let mut values = if (period - whole).abs() <= WHOLE {
        motion.to_vec()
    } else {
        resampled(motion, interval)
    };
    let whole = whole as usize;
    let periods = values.len() / whole;
    if periods < FEWEST_PERIODS {
        return None;
    }
    values.drain(..values.len() - periods * whole);
    for place in 0..whole {
        take_trend_off(&mut values[place..], whole, periods);
    }
    Some(Unforced { values, interval })
}

/// Takes mean and trend off every `apart`-th of some values, `count` of them.
fn take_trend_off(values: &mut [f64], apart: usize, count: usize) {
    let middle = 0.5 * (count - 1) as f64;
    let (mut sum, mut moment, mut squares) = (0.0, 0.0, 0.0);
    for k in 0..count {
        let at = k as f64 - middle;
        sum += values[k * apart];
        moment += at * values[k * apart];
        squares += at * at;
    }
    let (mean, slope) = (sum / count as f64, moment / squares);
    for k in 0..count {
        values[k * apart] -= mean + slope * (k as f64 - middle);
    }
}

/// A motion at other steps, through the six samples about each place.
fn resampled(motion: &[f64], interval: f64) -> Vec<f64> {
    let last = motion.len().saturating_sub(POINTS);
    let ends = motion.len().saturating_sub(1) as f64;
    let places = (0..).map(|i| i as f64 * interval);
    let at = |place: f64| {
        let first = (place as usize).saturating_sub(POINTS / 2 - 1).min(last);
        let points = &motion[first..first + POINTS];
        let place = place - first as f64;
        let weight = |k: usize| {
            let others = (0..POINTS).filter(|j| *j != k);
            others
                .map(|j| (place - j as f64) / (k as f64 - j as f64))
                .product::<f64>()
        };
        (points.iter().enumerate())
            .map(|(k, x)| weight(k) * x)
            .sum::<f64>()
    };
    if motion.len() < POINTS {
        return Vec::new();
    }
    places.take_while(|place| *place <= ends).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A vibration at 3.958 times the frequency of the teeth beside forced vibration a hundred
    /// times as large that grows by a third meanwhile, in periods of whole and broken numbers of
    /// samples: what is left is the vibration, to some hundredths: it goes round against the
    /// harmonic eight times only.
    #[test]
    fn verify_vibration_beside_a_harmonic_is_left() {
        for period in [40.0, 41.37] {
            let count = 200 * 42;
            let vibration = |t: f64| 1e-6 * (TAU * 3.958 * t + 0.4).sin();
            let motion: Vec<f64> = (0..count)
                .map(|i| {
                    let t = f64::from(i) / period;
                    let drift = 1.0 + f64::from(i) / (3.0 * f64::from(count));
                    let forced = 1e-4 * drift * ((TAU * t).sin() + 0.3 * (4.0 * TAU * t).cos());
                    3e-4 + 1e-5 * t + forced + vibration(t)
                })
                .collect();
            let left = unforced(&motion, period).expect("long enough");
            let dropped = count as usize - (left.values.len() as f64 * left.interval) as usize;
            assert!(dropped <= 50, "{dropped}");
            // Aligned at the end: both lists end with the last sample.
            let end = f64::from(count - 1) / period;
            let last = (f64::from(count - 1) / left.interval).floor() * left.interval / period;
            let from = last - (left.values.len() - 1) as f64 * left.interval / period;
            assert!(last <= end + 1e-9);
            let (mut square, mut size) = (0.0, 0.0);
            for (i, x) in left.values.iter().enumerate() {
                let true_m = vibration(from + i as f64 * left.interval / period);
                square += (x - true_m).powi(2);
                size += true_m * true_m;
            }
            let error = (square / size).sqrt();
            assert!(error < 0.08, "period {period}: {error}");
        }
    }

    #[test]
    fn what_is_too_short_or_no_number_has_no_unforced_part() {
        assert_eq!(unforced(&[0.0; 30], 10.0), None);
        assert_eq!(unforced(&[f64::NAN; 100], 10.0), None);
        assert_eq!(unforced(&[0.0; 100], 3.0), None);
        let still = unforced(&[1.0; 100], 10.0).expect("long enough");
        assert!(still.values.iter().all(|x| x.abs() < 1e-15));
    }
}
