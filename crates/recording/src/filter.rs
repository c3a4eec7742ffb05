//! Butterworth low-pass filters without delay, and derivatives.
//!
//! The filter is a cascade of second-order sections (bilinear transform with pre-warped cutoff),
//! run forward and backward over the data, which is continued at both ends by its own point
//! reflection. `oppenheim2010`, sections 7.2 and 5.4; the treatment of the ends is that of
//! `gustafsson1996`, in the form that numerical libraries use: steady state for the first value.

use std::f64::consts::PI;

/// One second-order section, `a0 = 1`; transposed direct form II.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SecondOrderSection {
    b: [f64; 3],
    a: [f64; 2],
}

/// Part of what lies beyond a filter that counts as noise; the variance itself is uncertain.
const BEYOND_FILTER: f64 = 1.1;
/// Median of the square of a standard normal number: of χ² with one degree of freedom.
const MEDIAN_OF_SQUARES: f64 = 0.454_936;

/// Standard deviation that a filter leaves of noise of which it takes `taken`, at samples whose
/// noise has the part `white_kept` of the variance of white noise of this size, since they lie
/// between others. By the median of the squares: of a jump, which friction makes at each reversal,
/// and of a spike a filter takes much, for a short time.
pub fn left_of_noise(noise: f64, taken: impl Iterator<Item = f64>, white_kept: f64) -> f64 {
    let mut squares: Vec<f64> = taken.map(|taken| taken * taken).collect();
    let middle = squares.len() / 2;
    if squares.is_empty() {
        return 0.0;
    }
    let (_, median, _) = squares.select_nth_unstable_by(middle, f64::total_cmp);
    let left = noise.powi(2) - BEYOND_FILTER * *median / (MEDIAN_OF_SQUARES * white_kept);
    left.max(0.0).sqrt()
}

/// A Butterworth low-pass filter.
#[derive(Clone, Debug, PartialEq)]
pub struct Butterworth {
    sections: Vec<SecondOrderSection>,
    order: usize,
}

impl Butterworth {
    /// A filter of this order whose gain at `cutoff_hz` is 1/√2, for samples at `rate_hz`. A cutoff
    /// at or above half the rate passes everything: the filter then has no section.
    ///
    /// # Panics
    /// If the order is 0, or cutoff or rate are not positive.
    pub fn low_pass(order: usize, cutoff_hz: f64, rate_hz: f64) -> Butterworth {
        assert!(order > 0 && cutoff_hz > 0.0 && rate_hz > 0.0);
        let mut sections = Vec::new();
        if cutoff_hz < 0.5 * rate_hz {
            let warped = (PI * cutoff_hz / rate_hz).tan();
            for pair in 0..order / 2 {
                // Poles -sin θ ± j cos θ: s² + 2 sin θ s + 1.
                let angle = PI * (2 * pair + 1) as f64 / (2 * order) as f64;
                sections.push(SecondOrderSection::second_order(warped, 2.0 * angle.sin()));
            }
            if order % 2 == 1 {
                sections.push(SecondOrderSection::first_order(warped));
            }
        }
        Butterworth { sections, order }
    }

    /// Part of the standard deviation of white noise that a low-pass filter of this order leaves,
    /// run forward and backward: the root of the mean of its gain to the fourth power over all
    /// frequencies.
    pub fn white_share(order: usize, cutoff_hz: f64, rate_hz: f64) -> f64 {
        const FREQUENCIES: usize = 4096;
        if cutoff_hz >= 0.5 * rate_hz {
            return 1.0;
        }
        let power = |k: usize| {
            let cycles = 0.5 * (k as f64 + 0.5) / FREQUENCIES as f64;
            Butterworth::zero_phase_gain(order, cutoff_hz / rate_hz, cycles).powi(2)
        };
        ((0..FREQUENCIES).map(power).sum::<f64>() / FREQUENCIES as f64).sqrt()
    }

    /// Gain of a low-pass filter of this order, run forward and backward; cutoff and frequency in
    /// cycles per sample, below a half.
    pub fn zero_phase_gain(order: usize, cutoff: f64, cycles: f64) -> f64 {
        let [warped, w] = [cutoff, cycles].map(|cycles| (PI * cycles).tan());
        1.0 / (1.0 + (w / warped).powi(2 * order as i32))
    }

    /// Runs the filter forward and backward: no delay, and the gain of the filter squared (so that
    /// the gain at the cutoff is 1/2).
    pub fn zero_phase(&self, values: &[f64]) -> Vec<f64> {
        if self.sections.is_empty() || values.len() < 2 {
            return values.to_vec();
        }
        let pad = (3 * (self.order + 1)).min(values.len() - 1);
        let (first, last) = (values[0], values[values.len() - 1]);
        let mut padded = Vec::with_capacity(values.len() + 2 * pad);
        padded.extend((1..=pad).rev().map(|k| 2.0 * first - values[k]));
        padded.extend_from_slice(values);
        padded.extend((1..=pad).map(|k| 2.0 * last - values[values.len() - 1 - k]));
        for _ in 0..2 {
            self.run(&mut padded);
            padded.reverse();
        }
        padded[pad..pad + values.len()].to_vec()
    }

    /// One pass, from the steady state of the first value.
    fn run(&self, values: &mut [f64]) {
        for section in &self.sections {
            let SecondOrderSection { b, a } = section;
            let mut state = section.steady_state().map(|z| z * values[0]);
            for value in values.iter_mut() {
                let x = *value;
                let y = b[0] * x + state[0];
                state = [b[1] * x - a[0] * y + state[1], b[2] * x - a[1] * y];
                *value = y;
            }
        }
    }
}

impl SecondOrderSection {
    fn second_order(w: f64, damping: f64) -> SecondOrderSection {
        let norm = 1.0 + damping * w + w * w;
        let gain = w * w / norm;
        SecondOrderSection {
            b: [gain, 2.0 * gain, gain],
            a: [
                2.0 * (w * w - 1.0) / norm,
                (1.0 - damping * w + w * w) / norm,
            ],
        }
    }

    fn first_order(w: f64) -> SecondOrderSection {
        let gain = w / (1.0 + w);
        SecondOrderSection {
            b: [gain, gain, 0.0],
            a: [(w - 1.0) / (w + 1.0), 0.0],
        }
    }

    /// States for a constant input of 1, whose output is 1.
    fn steady_state(&self) -> [f64; 2] {
        [1.0 - self.b[0], self.b[2] - self.a[1]]
    }
}

/// Weights of the differences across one, two and three intervals in a derivative that is exact for
/// polynomials up to the sixth degree (`fornberg1988`, table 1).
const SIXTH_ORDER: [f64; 3] = [3.0 / 2.0, -3.0 / 5.0, 1.0 / 10.0];
/// Likewise, in the derivative at the middle of the polynomial of fourth degree that fits seven
/// samples best (`savitzky1964`).
const OVER_SEVEN: [f64; 3] = [29.0 / 63.0, 67.0 / 63.0, -11.0 / 21.0];
/// The same of nine samples.
const OVER_NINE: [f64; 4] = [
    126.0 * 2.0 / 1188.0,
    193.0 * 4.0 / 1188.0,
    142.0 * 6.0 / 1188.0,
    -86.0 * 8.0 / 1188.0,
];

/// Derivative of uniform samples: central differences; at both ends the difference of two samples,
/// since a formula of higher order there would multiply noise. At a frequency of x radians an
/// interval it is small by x^2 / 6.
///
/// # Panics
/// If the interval is not positive.
pub fn differentiate(values: &[f64], interval_s: f64) -> Vec<f64> {
    assert!(interval_s > 0.0);
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|k| {
            let (from, to) = (k.saturating_sub(1), (k + 1).min(last));
            let steps = (to - from).max(1) as f64;
            (values[to] - values[from]) / (steps * interval_s)
        })
        .collect()
}

/// Derivative of uniform samples by differences of sixth order, small by x^6 / 140 at a frequency
/// of x radians an interval; within three samples of an end as [`differentiate`].
///
/// # Panics
/// If the interval is not positive.
pub fn differentiate_sixth_order(values: &[f64], interval_s: f64) -> Vec<f64> {
    differentiate_across(values, interval_s, &SIXTH_ORDER)
}

/// Derivative of uniform samples that smooths: of the polynomial of fourth degree through seven
/// samples. Small by 131 x^4 / 630 at a frequency of x radians an interval: less than
/// [`differentiate`] up to x = 0.9. Beyond, where noise is, it passes less of it. Within three
/// samples of an end it is the same.
///
/// # Panics
/// If the interval is not positive.
pub fn differentiate_over_seven(values: &[f64], interval_s: f64) -> Vec<f64> {
    differentiate_across(values, interval_s, &OVER_SEVEN)
}

/// As [`differentiate_over_seven`], through nine samples: small by 179 x^4 / 270, less than
/// [`differentiate`] up to x = 0.5. Within four samples of an end it is the same as that.
///
/// # Panics
/// If the interval is not positive.
pub fn differentiate_over_nine(values: &[f64], interval_s: f64) -> Vec<f64> {
    differentiate_across(values, interval_s, &OVER_NINE)
}

/// Weighted differences across one, two and more intervals.
fn differentiate_across(values: &[f64], interval_s: f64, weights: &[f64]) -> Vec<f64> {
    let mut slopes = differentiate(values, interval_s);
    let reach = weights.len();
    for k in reach..values.len().saturating_sub(reach) {
        let across = |steps: usize| {
            (values[k + steps] - values[k - steps]) / (2.0 * steps as f64 * interval_s)
        };
        slopes[k] = (1..)
            .zip(weights)
            .map(|(steps, weight)| weight * across(steps))
            .sum();
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_the_share_of_white_noise_is_that_of_an_impulse() {
        for (cutoff_hz, rate_hz) in [(10.0, 200.0), (5.0, 1000.0), (40.0, 100.0), (60.0, 100.0)] {
            // White noise keeps the sum of squares of the response to an impulse (`oppenheim2010`).
            let mut impulse = vec![0.0; 8001];
            impulse[4000] = 1.0;
            let response = Butterworth::low_pass(4, cutoff_hz, rate_hz).zero_phase(&impulse);
            let kept = response.iter().map(|x| x * x).sum::<f64>().sqrt();
            let share = Butterworth::white_share(4, cutoff_hz, rate_hz);
            assert!((share / kept - 1.0).abs() < 1e-6, "{share} {kept}");
        }
    }

    fn signal() -> Vec<f64> {
        (0..60)
            .map(f64::from)
            .map(|k| (0.05 * k).sin() + 0.3 * (0.7 * k).sin() + 0.01 * k)
            .collect()
    }

    /// SciPy 1.17: `sosfiltfilt(butter(order, cutoff, fs=rate, output="sos"), x)` at five samples.
    #[test]
    fn verify_zero_phase_filter_is_that_of_scipy() {
        let places = [0, 1, 17, 40, 59];
        let cases = [
            (
                (4, 50.0, 1000.0),
                [
                    0.004020759608609758,
                    0.06783412680252454,
                    0.9184695339691136,
                    1.302029982511982,
                    0.6312427102143889,
                ],
            ),
            (
                (3, 120.0, 1000.0),
                [
                    0.0011141094246735206,
                    0.18058880647935263,
                    0.8063948508818768,
                    1.3596506178833723,
                    0.6505836227245015,
                ],
            ),
            (
                (2, 5.0, 100.0),
                [
                    -0.009020298595655871,
                    0.05726452198035464,
                    0.9148224101743879,
                    1.3123746347008591,
                    0.6376098370589761,
                ],
            ),
            (
                (1, 10.0, 100.0),
                [
                    0.0013961713255849564,
                    0.1458316829567513,
                    0.834880504147379,
                    1.3398707758241857,
                    0.6462079067494862,
                ],
            ),
        ];
        for ((order, cutoff, rate), expected) in cases {
            let got = Butterworth::low_pass(order, cutoff, rate).zero_phase(&signal());
            for (place, expected) in places.iter().zip(expected) {
                assert!(
                    (got[*place] - expected).abs() < 1e-12,
                    "order {order} at {place}"
                );
            }
        }
    }

    #[test]
    fn verify_gain_at_the_cutoff_is_a_half_without_delay() {
        let (rate, cutoff) = (1000.0, 20.0);
        let wave = |k: usize| (std::f64::consts::TAU * cutoff * k as f64 / rate).sin();
        let values: Vec<f64> = (0..4000).map(wave).collect();
        let smooth = Butterworth::low_pass(4, cutoff, rate).zero_phase(&values);
        for k in 1000..3000 {
            assert!((smooth[k] - 0.5 * values[k]).abs() < 1e-9, "{k}");
        }
    }

    #[test]
    fn a_cutoff_beyond_half_the_rate_changes_nothing() {
        let filter = Butterworth::low_pass(4, 600.0, 1000.0);
        assert_eq!(filter.zero_phase(&signal()), signal());
        assert_eq!(
            Butterworth::low_pass(4, 50.0, 1000.0).zero_phase(&[2.0]),
            [2.0]
        );
    }

    #[test]
    fn verify_derivative_of_a_parabola_is_exact_inside() {
        let values: Vec<f64> = (0..9).map(|k| 0.5 * f64::from(k * k)).collect();
        let slopes = differentiate(&values, 0.5);
        for (k, slope) in slopes.iter().enumerate().take(8).skip(1) {
            assert!((slope - 2.0 * k as f64).abs() < 1e-12, "{k}");
        }
        assert_eq!((slopes[0], slopes[8]), (1.0, 15.0), "half a step inside");
        assert_eq!(differentiate(&[1.0], 0.5), [0.0]);
        assert_eq!(differentiate(&[1.0, 2.0], 0.5), [2.0, 2.0]);
    }

    #[test]
    fn verify_derivatives_are_small_by_what_is_said() {
        for cycles in [0.005, 0.02, 0.08, 0.15] {
            let x = std::f64::consts::TAU * cycles;
            let wave: Vec<f64> = (0..400).map(|k| (x * f64::from(k)).sin()).collect();
            let found = |slopes: Vec<f64>| {
                let pairs = (50..350).map(|k| (slopes[k], x * (x * k as f64).cos()));
                let (squares, products) = pairs.fold((0.0, 0.0), |(squares, products), (a, b)| {
                    (squares + b * b, products + a * b)
                });
                1.0 - products / squares
            };
            let central = found(differentiate(&wave, 1.0));
            assert!(
                (central / (x.powi(2) / 6.0) - 1.0).abs() < 0.06,
                "{central} at {x}"
            );
            let over_seven = found(differentiate_over_seven(&wave, 1.0));
            let said = 131.0 / 630.0 * x.powi(4);
            let is_near = (over_seven - said).abs() < 0.25 * said + 1e-12;
            assert!(is_near || x > 0.6, "{over_seven}, {said} at {x}");
            assert!(over_seven < central || x > 0.9, "{over_seven}, {central}");
            let smoothing = found(differentiate_over_nine(&wave, 1.0));
            let said = 179.0 / 270.0 * x.powi(4);
            let is_near = (smoothing - said).abs() < 0.25 * said + 1e-12;
            assert!(is_near || x > 0.6, "{smoothing}, {said} at {x}");
            // They are alike at x = 0.52.
            let is_nearer = smoothing < central || x > 0.55;
            assert!(is_nearer, "{smoothing}, {central} at {x}");
            assert!(
                smoothing > central || x < 0.55,
                "{smoothing}, {central} at {x}"
            );
            let sixth = found(differentiate_sixth_order(&wave, 1.0));
            let said = x.powi(6) / 140.0;
            assert!(
                (sixth - said).abs() < 0.25 * said + 1e-12,
                "{sixth}, {said} at {x}"
            );
        }
    }
}
