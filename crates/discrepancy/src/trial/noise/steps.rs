//! Readings that come in steps.

use super::without_memory;
use crate::stats::ratio;

/// Least samples for each reading that is told from others, where few readings come again.
const LEAST_ALIKE: usize = 4;
/// Least different readings that tell a grid by their distances, where hardly any comes again.
const LEAST_DIFFERENT: usize = 32;
/// Parts of the distances, from the smallest, one of which is a single step.
const SINGLE_STEP: [f64; 4] = [0.02, 0.1, 0.25, 0.5];
/// Part of the range below which a distance is rounding of the numbers.
const DUST: f64 = 1e-9;
/// Part of the readings that lie on the grid at least.
const NEARLY_ALL: f64 = 0.9;
/// Part of a step by which a reading may lie off the grid of steps: rounding of the numbers.
const OFF_GRID: f64 = 1e-3;
/// Noise of at least this part of a step carries readings over the next one by chance: what
/// rounding leaves is noise then, as any sample shows it.
const DITHERED: f64 = 0.5;

/// The step of readings by whose rounding they err alike when a motion comes again, which no other
/// period shows; 0 where they have none. `share` is the part of the deviation of white noise that
/// the filter of the output leaves: rounding of what holds still goes through it, rounding of what
/// moves on with every sample does not.
pub(crate) fn held_step(values: &[f64], valid: &[bool], share: f64) -> f64 {
    let step = grid(values, valid);
    if step == 0.0 || without_memory(values, valid) >= DITHERED * step {
        return 0.0;
    }
    let pairs = values.windows(2).zip(valid.windows(2));
    let pairs = pairs.filter(|(_, valid)| valid[0] && valid[1]);
    let (mut count, mut moved) = (0.0, 0.0);
    for (pair, _) in pairs {
        count += 1.0;
        moved += f64::from(u8::from((pair[1] - pair[0]).abs() > 0.5 * step));
    }
    let slow = (2.0 * (1.0 - ratio(moved, count))).min(1.0);
    step * (slow + (1.0 - slow) * share * share).sqrt()
}

/// The step of a grid on which nearly all readings lie; 0 if there is none. What bridges a gap lies
/// off it: of readings that come several times all are to lie on it, of others nearly all.
fn grid(values: &[f64], valid: &[bool]) -> f64 {
    let kept = values.iter().zip(valid).filter(|(_, valid)| **valid);
    let mut sorted: Vec<f64> = kept.map(|(x, _)| *x).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else {
        return 0.0;
    };
    let dust = DUST * (last - first);
    let alike: Vec<&[f64]> = (sorted.chunk_by(|a, b| b - a <= dust))
        .filter(|alike| alike.len() >= LEAST_ALIKE)
        .collect();
    let on_grid: usize = alike.iter().map(|alike| alike.len()).sum();
    let steps = alike.windows(2).map(|pair| pair[1][0] - pair[0][0]);
    let steps: Vec<f64> = steps.collect();
    let nearly_all = on_grid as f64 >= NEARLY_ALL * sorted.len() as f64;
    if nearly_all && let Some(step) = steps.iter().copied().reduce(f64::min) {
        let all_on = steps.iter().all(|other| is_whole(other / step));
        return if all_on { step } else { 0.0 };
    }
    grid_of_distances(&sorted, dust)
}

/// The same of readings of which hardly any comes again: more steps than samples.
fn grid_of_distances(sorted: &[f64], dust: f64) -> f64 {
    let pairs = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    let mut distances: Vec<f64> = pairs.filter(|distance| *distance > dust).collect();
    if distances.len() < LEAST_DIFFERENT {
        return 0.0;
    }
    distances.sort_by(f64::total_cmp);
    let is_step = |step: &f64| {
        let on = distances.iter().filter(|other| is_whole(*other / step));
        on.count() as f64 >= NEARLY_ALL * distances.len() as f64
    };
    let at = |part: f64| distances[(part * distances.len() as f64) as usize];
    SINGLE_STEP.map(at).into_iter().find(is_step).unwrap_or(0.0)
}

fn is_whole(steps: f64) -> bool {
    (steps - steps.round()).abs() <= OFF_GRID * steps.clamp(1.0, 50.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, noise};

    /// Steps far above the noise hold readings still, and are told; noise of the size of a step
    /// moves them.
    #[test]
    fn verify_steps_are_told_where_they_hold_readings_still() {
        for seed in 0..20 {
            let drawn = noise(Colour::White, 3000, seed);
            let step = 0.5 + 0.1 * seed as f64;
            let rounded = |level: f64| -> Vec<f64> {
                let moved = |k: usize| 3.0 * (0.01 * k as f64 + seed as f64).sin();
                let rows = drawn.iter().enumerate();
                rows.map(|(k, n)| ((moved(k) + level * step * n) / step).round() * step)
                    .collect()
            };
            let valid = vec![true; 3000];
            let found = held_step(&rounded(0.05), &valid, 0.3);
            assert!((found / step - 1.0).abs() < 1e-9, "{found} for {step}");
            assert_eq!(held_step(&rounded(1.0), &valid, 0.3), 0.0);
        }
    }

    /// Of an encoder that has more steps on its way than the record has samples hardly a reading
    /// comes again, but where it stands still; of what has no steps none is told, however it lies.
    #[test]
    fn verify_steps_are_told_where_hardly_a_reading_comes_again() {
        let valid = vec![true; 3000];
        for seed in 0..20 {
            let drawn = noise(Colour::White, 3000, seed);
            let (step, travel) = (0.5 + 0.1 * seed as f64, 3e3 * (1 + seed % 5) as f64);
            let moved = |k: usize| travel * (2e-3 * k.min(2500) as f64).sin();
            let smooth: Vec<f64> = (0..3000).map(|k| step * moved(k)).collect();
            let mut read: Vec<f64> = (smooth.iter().zip(&drawn))
                .map(|(x, n)| (x / step + 0.05 * n).round() * step)
                .collect();
            assert!((grid(&read, &valid) / step - 1.0).abs() < 1e-6, "{seed}");
            for k in (7..3000).step_by(60) {
                read[k] = 0.5 * (read[k - 1] + read[k + 1]) + 0.3 * step;
            }
            assert!(
                (grid(&read, &valid) / step - 1.0).abs() < 1e-6,
                "{seed}: gaps"
            );
            assert_eq!(grid(&smooth, &valid), 0.0, "{seed}");
            let noisy: Vec<f64> = smooth.iter().zip(&drawn).map(|(x, n)| x + n).collect();
            assert_eq!(grid(&noisy, &valid), 0.0, "{seed}");
        }
    }

    /// Where readings move on with every sample, rounding is white, and a filter takes it as such.
    #[test]
    fn verify_steps_of_what_moves_on_are_filtered() {
        let valid = vec![true; 3000];
        for seed in 0..20 {
            let step = 0.5 + 0.1 * seed as f64;
            let moved = |k: usize| 200.0 * step * (0.02 * k as f64 + seed as f64).sin();
            let readings: Vec<f64> = (0..3000)
                .map(|k| (moved(k) / step).round() * step)
                .collect();
            let found = held_step(&readings, &valid, 0.2) / step;
            assert!((0.15..0.5).contains(&found), "{found}");
        }
    }
}
