//! Growth of vibration, read off a motion in the time domain.
//!
//! Forced vibration repeats with the teeth (with the revolution, if they differ), so that the
//! change `d(t) = x(t) − x(t − T)` is free of it and grows like the rest, e^{σt}. A tool that
//! travels changes its posture and with it, slowly, what is forced; the change of the change,
//! `d(t) − d(t − T)`, grows alike and does not see that. Its level is taken in windows of two of
//! its own periods, and σ is the slope of the levels' logarithm. What saturates is left out: once d
//! is no longer small beside the feed per tooth, teeth leave the cut and nothing is linear any
//! more. A motion that never is small has the slope of its levels as they are, from the quietest to
//! the loudest after it.
//!
//! A tool that is knocked on its way, where its path turns or its teeth meet an edge, rings anew. A
//! level that leaps within a window is no growth, which is even: the slope is that of the levels
//! after the last leap, or, where they are few, the common one of all between leaps.

use nalgebra::Vector3;

/// What a motion does in the long run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Growth {
    /// σ, 1/s; negative where vibration dies away. `None` if there is too little of the motion, or
    /// nothing but rounding.
    pub rate_per_s: Option<f64>,
    /// Largest d in the windows from which σ comes, m: beyond the linear range where the motion
    /// never is within it for long.
    pub largest_m: f64,
    /// Level of d in the last window, root mean square, m.
    pub last_level_m: f64,
}

/// How a motion is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthOptions {
    /// Period of what is forced, s.
    pub period_s: f64,
    /// Largest d that counts as linear, m.
    pub linear_m: f64,
}

/// Fewest windows for a slope.
const FEWEST_WINDOWS: usize = 4;
/// Levels below this part of the linear range are rounding.
const FLOOR: f64 = 1e-7;
/// Part of the linear stretch, from its end, over which the slope is taken: fast modes have died
/// away before.
const LATE: f64 = 0.6;

/// Growth of a motion sampled at constant intervals. `None` if it lasts for less than five periods,
/// or a sample is not finite.
pub fn growth(
    motion_m: &[Vector3<f64>],
    interval_s: f64,
    options: &GrowthOptions,
) -> Option<Growth> {
    let period = options.period_s / interval_s;
    let first = changes(motion_m, period)?;
    let second = changes(&first, period)?;
    let first = &first[first.len() - second.len()..];
    let window = window_samples(&second, period);
    let hop = (window / 2).max(1);
    let levels: Vec<(f64, f64)> = (0..=second.len() - window)
        .step_by(hop)
        .map(|at| {
            let peak = first[at..at + window]
                .iter()
                .map(Vector3::norm)
                .fold(0.0, f64::max);
            (level(&second[at..at + window]), peak)
        })
        .collect();
    let last_level_m = level(&first[first.len() - window..]);
    let floor_m = FLOOR * options.linear_m;
    let stretch = longest_within(&levels, floor_m, options.linear_m);
    let mut late = late_part(&levels, stretch, options.linear_m);
    if late.len() < FEWEST_WINDOWS {
        late = as_it_is(&levels, floor_m);
    }
    let taken = &levels[late];
    let rate_per_s = (taken.len() >= FEWEST_WINDOWS).then(|| {
        let logarithms: Vec<f64> = taken.iter().map(|level| level.0.ln()).collect();
        slope(&logarithms) / (hop as f64 * interval_s)
    });
    Some(Growth {
        rate_per_s,
        largest_m: taken.iter().map(|level| level.1).fold(0.0, f64::max),
        last_level_m,
    })
}

/// Samples through which a motion is interpolated: the place between the third and the fourth.
const POINTS: usize = 6;

/// x(t) − x(t − T), T in samples. Where T is no whole number of them, x is interpolated to fifth
/// degree (Lagrange).
fn changes(motion: &[Vector3<f64>], period: f64) -> Option<Vec<Vector3<f64>>> {
    let whole = period.ceil() as usize;
    let first = whole + 2;
    let finite = |x: &Vector3<f64>| x.iter().all(|x| x.is_finite());
    if whole < POINTS || motion.len() < 4 * first || !motion.iter().all(finite) {
        return None;
    }
    let place = whole as f64 - period + 2.0;
    let weights: [f64; POINTS] = std::array::from_fn(|k| {
        let others = (0..POINTS).filter(|j| *j != k);
        others
            .map(|j| (place - j as f64) / (k as f64 - j as f64))
            .product()
    });
    let change = |i: usize| {
        let points = &motion[i - first..];
        let then: Vector3<f64> = weights.iter().zip(points).map(|(w, x)| x * *w).sum();
        motion[i] - then
    };
    Some((first..motion.len()).map(change).collect())
}

/// Root mean square under a Hann window, which is blind to where in its period a vibration stands.
fn level(part: &[Vector3<f64>]) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (i, x) in part.iter().enumerate() {
        let sine = (std::f64::consts::PI * (i as f64 + 0.5) / part.len() as f64).sin();
        sum += sine * sine * x.norm_squared();
        weights += sine * sine;
    }
    (sum / weights).sqrt()
}

/// Samples of a window of two periods, of what is forced or of what is not, whichever is longer;
/// the latter by the sign changes of its largest component.
fn window_samples(change: &[Vector3<f64>], period: f64) -> usize {
    let late = &change[change.len() / 2..];
    let size = |axis: usize| late.iter().map(|d| d[axis] * d[axis]).sum::<f64>();
    let axis = (0..3)
        .max_by(|a, b| size(*a).total_cmp(&size(*b)))
        .unwrap_or(0);
    let crossings = late
        .windows(2)
        .filter(|w| w[0][axis] * w[1][axis] < 0.0)
        .count();
    let own_period = 2.0 * late.len() as f64 / crossings.max(1) as f64;
    let most = change.len() / FEWEST_WINDOWS;
    ((2.0 * own_period.max(period)).ceil() as usize).clamp(1, most.max(1))
}

/// The longest stretch of windows that stay below what is linear and above rounding.
fn longest_within(levels: &[(f64, f64)], floor_m: f64, most_m: f64) -> std::ops::Range<usize> {
    let good = |level: &(f64, f64)| level.1 <= most_m && level.0 > floor_m;
    let mut best = 0..0;
    let mut start = 0;
    for (i, level) in levels.iter().enumerate() {
        if !good(level) {
            start = i + 1;
        } else if i + 1 - start > best.len() {
            best = start..i + 1;
        }
    }
    best
}

/// The part of a linear stretch over which the slope is taken: its end; where the motion then
/// leaves the linear range, from its quietest window on, since before that it died away.
fn late_part(
    levels: &[(f64, f64)],
    stretch: std::ops::Range<usize>,
    linear_m: f64,
) -> std::ops::Range<usize> {
    let late = stretch.end - (stretch.len() as f64 * LATE) as usize..stretch.end;
    let outgrown = levels
        .get(stretch.end)
        .is_some_and(|next| next.1 > linear_m);
    let quietest = stretch
        .clone()
        .min_by(|a, b| levels[*a].0.total_cmp(&levels[*b].0));
    match quietest {
        Some(quietest) if outgrown => quietest..stretch.end,
        _ if late.len() < FEWEST_WINDOWS => stretch,
        _ => late,
    }
}

/// The part over which a motion is judged that is not small for long: from its quietest window to
/// the loudest after it, and where that is next to nothing, since it dies away or does neither, its
/// end.
fn as_it_is(levels: &[(f64, f64)], floor_m: f64) -> std::ops::Range<usize> {
    let all = longest_within(levels, floor_m, f64::INFINITY);
    let by_level = |a: &usize, b: &usize| levels[*a].0.total_cmp(&levels[*b].0);
    let quietest = all.clone().min_by(by_level).unwrap_or(all.start);
    let loudest = (quietest..all.end).max_by(by_level).unwrap_or(quietest);
    if loudest - quietest >= FEWEST_WINDOWS {
        return quietest..loudest + 1;
    }
    all.end - (all.len() as f64 * LATE) as usize..all.end
}

/// Slope of evenly spaced values, per step: after the last leap, or the common one between leaps.
fn slope(values: &[f64]) -> f64 {
    let parts = between_leaps(values);
    let last = (parts.iter()).rfind(|part| part.len() >= FEWEST_WINDOWS);
    let taken = last.map_or(&parts[..], std::slice::from_ref);
    let (mut sum, mut squares) = (0.0, 0.0);
    for part in taken {
        let middle = 0.5 * (part.len() - 1) as f64;
        for (i, value) in values[part.clone()].iter().enumerate() {
            let x = i as f64 - middle;
            sum += x * value;
            squares += x * x;
        }
    }
    sum / squares
}

/// Windows this far apart share no sample.
const APART: usize = 2;
/// A leap is over within so many windows: a knock enters a window and is all that is in it once it
/// lies in the next that shares no sample. What rises for longer grows.
const LEAP_WINDOWS: usize = 2 * APART;
/// So many median deviations beyond the median rise from a window to the next are not of the
/// motion's own unevenness.
const UNEVEN: f64 = 6.0;

/// Parts of a series of logarithms of levels without leaps, of two values at least: all of it where
/// the parts are next to nothing. A level at least doubles in a leap, beside its usual rise.
fn between_leaps(values: &[f64]) -> Vec<std::ops::Range<usize>> {
    let rises: Vec<f64> = values.windows(APART + 1).map(|w| w[APART] - w[0]).collect();
    if rises.len() < FEWEST_WINDOWS {
        return std::iter::once(0..values.len()).collect();
    }
    let usual = median(&rises);
    let uneven = median(&rises.iter().map(|r| (r - usual).abs()).collect::<Vec<_>>());
    let most = usual + (UNEVEN * uneven).max(std::f64::consts::LN_2);
    let mut parts = Vec::new();
    let mut start = 0;
    let mut i = 0;
    while i < rises.len() {
        let length = rises[i..].iter().take_while(|rise| **rise > most).count();
        if (1..=LEAP_WINDOWS).contains(&length) {
            parts.push(start..i + 1);
            start = i + length - 1 + APART;
        }
        i += length.max(1);
    }
    parts.push(start..values.len());
    parts.retain(|part| part.len() >= 2);
    match parts.iter().map(ExactSizeIterator::len).sum::<usize>() {
        FEWEST_WINDOWS.. => parts,
        _ => std::iter::once(0..values.len()).collect(),
    }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const STEP_S: f64 = 1e-4;

    fn motion(rate_per_s: f64, period_s: f64, size_m: f64, count: usize) -> Vec<Vector3<f64>> {
        (0..count)
            .map(|i| {
                let t = i as f64 * STEP_S;
                let free = size_m * (rate_per_s * t).exp();
                let fast = size_m * (-30.0 * t).exp() * (TAU * 41.0 * t).cos();
                let forced =
                    2e-5 * (TAU * t / period_s).sin() + 1e-5 * (2.0 * TAU * t / period_s).cos();
                Vector3::new(
                    3e-4 + 1e-4 * t + 1e-6 * t * t + forced + free * (TAU * 9.3 * t).sin() + fast,
                    0.5 * free * (TAU * 9.3 * t + 1.0).sin(),
                    0.0,
                )
            })
            .collect()
    }

    /// A slow mode that grows or decays beside forced vibration ten times as large, a drift and a
    /// fast mode that dies away, tooth periods of whole and of broken numbers of samples.
    #[test]
    fn verify_rate_of_an_exponential() {
        for period_s in [6.25e-3, 7.123e-3] {
            for rate_per_s in [-2.0, -0.4, 0.5, 2.0] {
                let motion = motion(rate_per_s, period_s, 1e-6, 20_000);
                let options = GrowthOptions {
                    period_s,
                    linear_m: 1e-4,
                };
                let found = growth(&motion, STEP_S, &options).expect("long enough");
                let rate = found.rate_per_s.expect("linear");
                assert!(
                    (rate - rate_per_s).abs() < 0.02,
                    "{rate} instead of {rate_per_s}"
                );
            }
        }
    }

    /// A stable tool that is knocked again and again has the rate at which it dies away, not that
    /// of the knocks, however large and wherever they fall; a growing one that is knocked grows.
    #[test]
    fn knocks_are_no_growth() {
        let options = GrowthOptions {
            period_s: 6.25e-3,
            linear_m: 1e-4,
        };
        let knocks = [1.31, 3.87, 4.13, 5.49];
        for (rate_per_s, shift_s) in [(-3.0, 0.0), (-3.0, 0.11), (-1.5, 0.05), (0.5, 0.0)] {
            // Each knock is louder than all before it in a motion that dies away.
            let sizes_m = knocks.map(|at: f64| 1e-9 * (1.2 * at).exp());
            let motion: Vec<Vector3<f64>> = (0..80_000)
                .map(|i| {
                    let t = i as f64 * STEP_S;
                    let mut x = 3e-4 + 1e-5 * t + 2e-5 * (TAU * t / options.period_s).sin();
                    let mut ring = |since: f64, size: f64| {
                        if since > 0.0 {
                            x += size * (rate_per_s * since).exp() * (TAU * 9.3 * since).sin();
                        }
                    };
                    ring(t, 1e-7);
                    for (at, size) in knocks.iter().zip(sizes_m) {
                        ring(t - at - shift_s, size);
                    }
                    Vector3::new(x, 0.0, 0.0)
                })
                .collect();
            let found = growth(&motion, STEP_S, &options).expect("long enough");
            let rate = found.rate_per_s.expect("linear");
            assert!(
                (rate - rate_per_s).abs() < 0.3 * rate_per_s.abs(),
                "{rate} instead of {rate_per_s}, {shift_s}"
            );
        }
    }

    /// A motion that dies away before it grows out of the linear range has the rate of its growth,
    /// whatever came before.
    #[test]
    fn growth_counts_from_the_quietest_window_on() {
        let options = GrowthOptions {
            period_s: 6.25e-3,
            linear_m: 5e-6,
        };
        let mut motion = motion(5.0, 6.25e-3, 1e-8, 12_000);
        for (i, x) in motion.iter_mut().enumerate() {
            let t = i as f64 * STEP_S;
            x.y += 1e-6 * (-8.0 * t).exp() * (TAU * 9.3 * t).sin();
            x.z += 2e-5 / (1.0 + (-80.0 * (t - 1.0)).exp()) * (TAU * 9.3 * t).sin();
        }
        let found = growth(&motion, STEP_S, &options).expect("long enough");
        assert!(found.last_level_m > options.linear_m);
        assert!(found.rate_per_s.is_none_or(|rate| rate > 0.0), "{found:?}");
    }

    /// What has saturated does not count. A motion that is beyond the linear range from the
    /// beginning has the rate at which it grows, and how large it was says so.
    #[test]
    fn growth_ends_where_the_motion_is_no_longer_linear() {
        let options = GrowthOptions {
            period_s: 6.25e-3,
            linear_m: 1e-5,
        };
        let mut motion = motion(3.0, 6.25e-3, 1e-6, 20_000);
        motion.iter_mut().for_each(|x| x.y = x.y.clamp(-3e-5, 3e-5));
        let found = growth(&motion, STEP_S, &options).expect("long enough");
        assert!((found.rate_per_s.expect("linear") - 3.0).abs() < 0.1);
        assert!(found.last_level_m > options.linear_m);
        assert!(found.largest_m <= options.linear_m);
        let narrow = GrowthOptions {
            linear_m: 1e-9,
            ..options
        };
        let grown = growth(&motion[..6_000], STEP_S, &narrow).expect("long enough");
        assert!(
            (grown.rate_per_s.expect("a rate") - 3.0).abs() < 0.1,
            "{grown:?}"
        );
        assert!(grown.largest_m > narrow.linear_m);
        let still = vec![Vector3::repeat(1e-3); 6_000];
        let none = growth(&still, STEP_S, &options).expect("long enough");
        assert_eq!(none.rate_per_s, None);
        assert_eq!(growth(&motion[..100], STEP_S, &options), None);
    }
}
