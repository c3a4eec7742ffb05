//! Delay and gain between the simulated and the measured channel.

use serde::Serialize;
use truecut_recording::fft::{forward, inverse};
use truecut_recording::significant;

use super::dependence::direction;
use super::series::{Estimate, Explanatory, Kind, Pair, centred, least_squares, rms};
use super::{LEVEL, Setting, dependences, lines, moving};
use crate::stats::distributions::family_wise;
use crate::stats::spectrum::padded_length;
use crate::stats::{Background, ratio, sum_covariance};

/// `measured(t) ≈ offset + gain · simulated(t − delay)`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Alignment {
    /// Delay of the measured channel, s.
    pub delay_s: Estimate,
    /// Gain, measured over simulated.
    pub gain: Estimate,
    /// Fraction of the residual's variance about its mean that delay and gain explain.
    pub explained_share: f64,
    /// A pattern that they leave. Standard errors hold where what is left is noise: with a pattern
    /// left, delay and gain do not describe the difference, however small their errors.
    pub pattern_left: Option<PatternLeft>,
}

/// What the residual still follows after delay and gain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PatternLeft {
    /// The signal.
    pub signal: String,
    /// What kind it is; none for a spectral line.
    pub kind: Option<Kind>,
    /// Its part of the variance that is no noise: that of the pattern and of delay and gain.
    pub share: f64,
}

/// Longest delay tried, as a fraction of the record.
const LONGEST_DELAY: f64 = 0.1;
/// Least correlation at the best delay for the channels to count as related.
const LEAST_CORRELATION: f64 = 0.8;
/// Up to this part, of the variance that is no noise, delay and gain explain more than a pattern.
const PREVAILING: f64 = 0.5;
/// A smaller part than this does not call the rest into question: interpolation and model are no
/// better.
const NEGLIGIBLE: f64 = 0.01;
/// Samples on either side that an interpolation uses.
const REACH: isize = 12;

/// Least squares, started at the peak of the cross-correlation; the simulated channel is
/// interpolated by a windowed sinc. Standard errors hold for noise with the colour of the residual.
/// `None` if the channels do not correlate or one of them is constant.
pub fn align(pair: &Pair<'_>, setting: &Setting<'_>) -> Option<Alignment> {
    let interval_s = setting.interval_s;
    let mut delay = coarse_delay(pair)?;
    let mut fit = fit_at(pair, delay)?;
    for _ in 0..20 {
        let step = fit.step.clamp(-1.0, 1.0);
        delay += step;
        fit = fit_at(pair, delay)?;
        if step.abs() < 1e-6 {
            break;
        }
    }
    if delay.abs() > LONGEST_DELAY * pair.measured.len() as f64 + 1.0 {
        return None;
    }
    let before = rms(&centred(&pair.residual(), pair.valid), pair.valid);
    let after = rms(&fit.remainder, &fit.valid);
    let background = Background::of_regression(&fit.target, &fit.valid, &fit.columns);
    let (errors, degrees) = match &background {
        Some(background) => {
            let inner = sum_covariance(&fit.columns, background);
            let covariance = &fit.inverse * inner.matrix * &fit.inverse;
            ([0, 1].map(|i| covariance[(i, i)].sqrt()), inner.degrees)
        }
        None => ([0.0; 2], f64::INFINITY),
    };
    let delay_error = errors[1] / fit.gain.abs() * interval_s;
    let explained_share = (1.0 - ratio(after, before).powi(2)).max(0.0);
    Some(Alignment {
        delay_s: Estimate::new(delay * interval_s, 0.0, delay_error, degrees),
        gain: Estimate::new(fit.gain, 1.0, errors[0], degrees),
        explained_share,
        pattern_left: pattern_left(pair, &fit, explained_share, setting),
    })
}

/// The largest pattern that is clear of noise, whatever size that has, if it contradicts delay and
/// gain: one that lags as they do, or one that is larger than all that they explain.
fn pattern_left(
    pair: &Pair<'_>,
    fit: &DelayFit,
    explained: f64,
    setting: &Setting<'_>,
) -> Option<PatternLeft> {
    let of_pattern = |(signal, kind, share): (String, Option<Kind>, f64), least: f64| {
        let variance = (1.0 - explained) * share;
        let share = ratio(variance, variance + explained);
        (share > least).then_some(PatternLeft {
            signal,
            kind,
            share,
        })
    };
    let others = dependences(&fit.remainder, &fit.valid, setting).into_iter();
    let others = others.filter(|one| one.kind != Kind::Velocity && one.p_value < LEVEL);
    let others = others.map(|one| (one.signal, Some(one.kind), one.share));
    let others = (others.chain(rhythm(pair, fit, setting)))
        .filter_map(|found| of_pattern(found, PREVAILING));
    let reversals = (reversals(fit, setting).into_iter())
        .filter_map(|(name, share)| of_pattern((name, Some(Kind::Velocity), share), NEGLIGIBLE));
    others
        .chain(reversals)
        .max_by(|a, b| a.share.total_cmp(&b.share))
}

/// The spectral lines that are left, named for the strongest, and their part of it.
fn rhythm(
    pair: &Pair<'_>,
    fit: &DelayFit,
    setting: &Setting<'_>,
) -> Option<(String, Option<Kind>, f64)> {
    let pair = Pair {
        valid: &fit.valid,
        ..*pair
    };
    let (interval_s, spindle_hz) = (setting.interval_s, setting.spindle_hz);
    let (found, _) = lines(&pair, &fit.remainder, interval_s, spindle_hz, LEVEL);
    let strongest = found.first()?;
    let squares: f64 = found.iter().map(|line| 0.5 * line.residual.powi(2)).sum();
    let share = ratio(squares, rms(&fit.remainder, &fit.valid).powi(2)).min(1.0);
    let name = format!("line at {} Hz", significant(strongest.frequency_hz, 4));
    Some((name, None, share))
}

/// Velocities whose sign is clear beside delay and gain, and its part of what they leave. The
/// three are fitted together: dry friction lags as a delay does, and what a delay leaves of it
/// would count as noise.
fn reversals(fit: &DelayFit, setting: &Setting<'_>) -> Vec<(String, f64)> {
    let left: f64 = fit.remainder.iter().map(|x| x * x).sum();
    let test = |signal: &Explanatory| {
        let mut columns = fit.columns.clone();
        columns.push(centred(&direction(signal, &fit.valid), &fit.valid));
        let (sizes, inverse) = least_squares(&columns, &fit.target)?;
        let background = Background::of_regression(&fit.target, &fit.valid, &columns)?;
        let inner = sum_covariance(&columns, &background);
        let covariance = &inverse * inner.matrix * &inverse;
        let size = Estimate::new(sizes[2], 0.0, covariance[(2, 2)].sqrt(), inner.degrees);
        let share = ratio(sizes[2].powi(2) / inverse[(2, 2)], left);
        Some((signal.spec.name.clone(), size.p_value, share))
    };
    let tested: Vec<_> = moving(setting)
        .filter(|signal| signal.kind == Kind::Velocity)
        .filter_map(test)
        .collect();
    let count = tested.len() as f64;
    let clear = (tested.into_iter()).filter(|one| family_wise(one.1, count) < LEVEL);
    clear.map(|(name, _, share)| (name, share)).collect()
}

/// The delay in whole samples at which the channels correlate best, without sign.
fn coarse_delay(pair: &Pair<'_>) -> Option<f64> {
    let count = pair.measured.len();
    let measured = centred(pair.measured, pair.valid);
    let simulated = centred(pair.simulated, pair.valid);
    let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let scale = norm(&measured) * norm(&simulated);
    if scale.is_nan() || scale <= 0.0 {
        return None;
    }
    let length = padded_length(count);
    let product = forward(simulated, length)
        .into_iter()
        .zip(forward(measured, length));
    let correlation = inverse(product.map(|(x, y)| x.conj() * y).collect(), length);
    let reach = (LONGEST_DELAY * count as f64) as usize;
    // The shorter of two equal delays wins: it comes first.
    let mut best = (0.0, 0.0);
    for lag in 0..=reach {
        for (delay, index) in [(lag as f64, lag), (-(lag as f64), (length - lag) % length)] {
            let size = correlation[index].abs() / scale;
            if size > best.0 + 1e-12 {
                best = (size, delay);
            }
        }
    }
    (best.0 >= LEAST_CORRELATION).then_some(best.1)
}

/// The regression at one delay.
struct DelayFit {
    gain: f64,
    /// First-order correction of the delay, samples.
    step: f64,
    columns: Vec<Vec<f64>>,
    inverse: nalgebra::DMatrix<f64>,
    /// The measured channel without its mean, and the residual of the regression.
    target: Vec<f64>,
    remainder: Vec<f64>,
    valid: Vec<bool>,
}

fn fit_at(pair: &Pair<'_>, delay: f64) -> Option<DelayFit> {
    const HALF_STEP: f64 = 0.05;
    let shifts = [0.0, HALF_STEP, -HALF_STEP].map(|step| shift(pair.simulated, delay + step));
    let reached = |row: usize| shifts.iter().all(|(_, reached)| reached[row]);
    let valid: Vec<bool> = pair
        .valid
        .iter()
        .enumerate()
        .map(|(row, valid)| *valid && reached(row))
        .collect();
    let [shifted, later, earlier] = shifts.map(|(values, _)| values);
    let slope: Vec<f64> = earlier
        .iter()
        .zip(&later)
        .map(|(e, l)| (e - l) / (2.0 * HALF_STEP))
        .collect();
    let columns = vec![centred(&shifted, &valid), centred(&slope, &valid)];
    let target = centred(pair.measured, &valid);
    let (coefficients, inverse) = least_squares(&columns, &target)?;
    let gain = coefficients[0];
    let remainder = (0..target.len())
        .map(|row| target[row] - gain * columns[0][row] - coefficients[1] * columns[1][row])
        .collect();
    // y ≈ g x(t − d) − g δ x′(t − d)
    let step = -coefficients[1] / gain;
    (gain != 0.0 && step.is_finite()).then_some(DelayFit {
        gain,
        step,
        columns,
        inverse,
        target,
        remainder,
        valid,
    })
}

/// The series `delay` samples later, and where all samples needed for it exist.
fn shift(values: &[f64], delay: f64) -> (Vec<f64>, Vec<bool>) {
    let count = values.len() as isize;
    let whole = delay.floor();
    let part = delay - whole;
    let weights: Vec<f64> = (-REACH + 1..=REACH)
        .map(|tap| kernel(tap as f64 - (1.0 - part)))
        .collect();
    // Normalised so that a constant is reproduced.
    let sum: f64 = weights.iter().sum();
    let mut shifted = vec![0.0; values.len()];
    let mut reached = vec![false; values.len()];
    for row in 0..count {
        // The sample at row − delay lies between `base` and `base + 1`.
        let base = row - whole as isize - 1;
        let first = base - REACH + 1;
        if first < 0 || base + REACH >= count {
            continue;
        }
        let taps = &values[first as usize..(base + REACH + 1) as usize];
        shifted[row as usize] = taps.iter().zip(&weights).map(|(x, w)| x * w).sum::<f64>() / sum;
        reached[row as usize] = true;
    }
    (shifted, reached)
}

/// sinc under a Hann window as wide as the reach.
fn kernel(distance: f64) -> f64 {
    let turn = std::f64::consts::PI * distance;
    let sinc = if turn.abs() < 1e-12 {
        1.0
    } else {
        turn.sin() / turn
    };
    sinc * (0.5 + 0.5 * (turn / REACH as f64).cos())
}
