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
    /// nothing but noise of computing.
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
/// A motion that never is above this part of the linear range is noise of computing: of a steady
/// cut picometres are left, where this is 25 pm (at 0.05 mm a tooth; a fourth of an atom). What
/// falls or grows through it has a rate.
pub const NOISE: f64 = 1e-5;
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
    let [floor_m, noise_m] = [FLOOR, NOISE].map(|part| part * options.linear_m);
    let mut late = judged(&levels, floor_m, options.linear_m);
    if levels[late.clone()].iter().all(|level| level.0 < noise_m) {
        late = judged(&levels, noise_m, options.linear_m);
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

/// The windows from which the slope is taken, all of them above a floor.
fn judged(levels: &[(f64, f64)], floor_m: f64, linear_m: f64) -> std::ops::Range<usize> {
    let stretch = longest_within(levels, floor_m, linear_m);
    let late = late_part(levels, stretch, linear_m);
    match late.len() {
        FEWEST_WINDOWS.. => late,
        _ => as_it_is(levels, floor_m),
    }
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
mod tests;
