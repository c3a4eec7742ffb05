//! A residual that is there for a while only.

use serde::Serialize;

use crate::stats::distributions::{f_tail, family_wise};
use crate::stats::{Ar, counted, default_order_cap, ratio};

/// The shortest stretch that holds most of the residual's square, where that is a small part of the
/// record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stretch {
    /// Row at which it begins.
    pub from: usize,
    /// Row after its end.
    pub until: usize,
    /// Part of the residual's square about its median that lies in it.
    pub share: f64,
    /// Part of the valid samples that it is.
    pub part: f64,
    /// Probability that innovations of one size, those of an autoregressive model of the residual
    /// outside, differ so much inside and outside, counted over all stretches of that length.
    pub p_value: f64,
}

/// Part of the square that is asked of a stretch.
const SHARE: f64 = 0.8;
/// And the part of the record that it is at most: of what is there all along, four fifths lie in
/// four fifths.
const MOST: f64 = 0.25;

/// `None` where no short stretch holds most of the residual.
pub fn stretch(residual: &[f64], valid: &[bool]) -> Option<Stretch> {
    let mut sorted: Vec<f64> = counted(residual, valid).collect();
    sorted.sort_by(f64::total_cmp);
    let median = *sorted.get(sorted.len() / 2)?;
    let centred: Vec<f64> = residual.iter().map(|x| x - median).collect();
    let rows = centred.iter().zip(valid);
    let squares: Vec<f64> = rows
        .map(|(x, valid)| if *valid { x * x } else { 0.0 })
        .collect();
    let whole: f64 = squares.iter().sum();
    let (from, until) = shortest(&squares, SHARE * whole)?;
    let count = |rows: std::ops::Range<usize>| valid[rows].iter().filter(|one| **one).count();
    let part = ratio(count(from..until) as f64, sorted.len() as f64);
    if part > MOST {
        return None;
    }
    // What is there inside would be followed as noise by a model of all rows.
    let rows = valid.iter().enumerate();
    let noise: Vec<bool> = rows
        .map(|(row, valid)| *valid && !(from..until).contains(&row))
        .collect();
    let model = Ar::fit(&centred, &noise, default_order_cap(sorted.len()))?;
    let (white, exists) = model.whiten(&centred, valid);
    let mean_square = |is_inside: bool| {
        let rows = white.iter().zip(&exists).enumerate();
        let own =
            rows.filter(|(row, (_, exists))| **exists && (from..until).contains(row) == is_inside);
        let (sum, count) = own.fold((0.0, 0.0), |(sum, count), (_, (x, _))| {
            (sum + x * x, count + 1.0)
        });
        (ratio(sum, count), count)
    };
    let ((inside, above), (outside, below)) = (mean_square(true), mean_square(false));
    let p_value = f_tail(ratio(inside, outside), above, below);
    Some(Stretch {
        from,
        until,
        share: ratio(squares[from..until].iter().sum(), whole),
        part,
        p_value: family_wise(p_value, part.powi(-2)),
    })
}

/// The shortest stretch whose sum is at least so much.
fn shortest(values: &[f64], least: f64) -> Option<(usize, usize)> {
    let (mut from, mut sum) = (0, 0.0);
    let mut best: Option<(usize, usize)> = None;
    for (row, value) in values.iter().enumerate() {
        sum += value;
        while from < row && sum - values[from] >= least {
            sum -= values[from];
            from += 1;
        }
        let is_shorter = best.is_none_or(|(start, end)| row + 1 - from < end - start);
        if sum >= least && least > 0.0 && is_shorter {
            best = Some((from, row + 1));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::LEVEL;
    use crate::testing::{Colour, noise};

    const SAMPLES: usize = 3000;
    const COLOURS: [Colour; 4] = [
        Colour::White,
        Colour::Ar1(0.5),
        Colour::Ar1(0.95),
        Colour::Pink,
    ];

    /// Noise of any colour, with a constant beside it, is no event more often than is said.
    #[test]
    fn verify_noise_is_there_all_along() {
        for (k, colour) in COLOURS.into_iter().enumerate() {
            let alarms = (0..500).filter(|seed| {
                let mut values = noise(colour, SAMPLES, 1000 * k as u64 + seed);
                values.iter_mut().for_each(|x| *x += 5.0);
                stretch(&values, &[true; SAMPLES]).is_some_and(|one| one.p_value < LEVEL)
            });
            let alarms = alarms.count();
            assert!(alarms <= 11, "{colour:?}: {alarms} of 500");
        }
    }

    /// A friction that drags for a fortieth to a fifth of the record, at a place drawn from a seed.
    #[test]
    fn verify_an_event_is_found_with_its_ends() {
        for seed in 0..60 {
            let length = 75 + 9 * seed as usize;
            let from = (seed as usize * 397) % (SAMPLES - length);
            let mut values = noise(COLOURS[seed as usize % 3], SAMPLES, seed);
            for (row, x) in values.iter_mut().enumerate().skip(from).take(length) {
                *x += 40.0 * (0.05 * row as f64).sin().signum();
            }
            let found = stretch(&values, &[true; SAMPLES]).expect("an event");
            assert!(found.p_value < LEVEL, "seed {seed}: {found:?}");
            let room = length / 4;
            assert!(found.from.abs_diff(from) <= room, "{from}: {found:?}");
            assert!(found.until.abs_diff(from + length) <= room, "{found:?}");
        }
    }
}
