//! How fast an interval may open along a path.

use crate::intervals::Interval;
use crate::parts::Part;

/// Within each interval of a chain what remains if no end may open outwards by more than `most_rad`
/// from one segment to the next, before or behind; at a corner of the path it may.
///
/// Where two intervals grow together the middle would jump. Within the tube it does not: ends move
/// by `most_rad` at most, and what closes faster is left in time. A chain that moves faster itself
/// is given more, twice as often as it needs.
pub(crate) fn steadied(parts: &[Part], chain: &[Interval], most_rad: f64) -> Vec<Interval> {
    let mut shift_rad = most_rad;
    // A turn and more: nothing is cut off.
    while shift_rad < 2.0 * std::f64::consts::TAU {
        let tube = tube(parts, chain, shift_rad);
        if tube.iter().all(|interval| interval.width_rad() > 0.0) {
            return tube;
        }
        shift_rad *= 2.0;
    }
    chain.to_vec()
}

fn tube(parts: &[Part], chain: &[Interval], shift_rad: f64) -> Vec<Interval> {
    let mut tube = chain.to_vec();
    let along = 1..chain.len();
    let onwards = along.clone().map(|k| (k, k - 1));
    let back = along.rev().map(|k| (k - 1, k));
    for (k, beside) in onwards.chain(back) {
        if parts[k].leg == parts[beside].leg {
            tube[k].from_rad = tube[k].from_rad.max(tube[beside].from_rad - shift_rad);
            tube[k].to_rad = tube[k].to_rad.min(tube[beside].to_rad + shift_rad);
        }
    }
    tube
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parts(count: usize) -> Vec<Part> {
        let part = |k: usize| Part {
            leg: 0,
            from_m: k as f64,
            to_m: k as f64 + 1.0,
            halvings: 0,
        };
        (0..count).map(part).collect()
    }

    fn interval(from_rad: f64, to_rad: f64) -> Interval {
        Interval {
            sheet: 0,
            from_rad,
            to_rad,
        }
    }

    /// Two intervals grow together: the middle goes there step by step. One that closes is left in
    /// time.
    #[test]
    fn an_interval_that_opens_at_once_is_used_step_by_step() {
        let ends = [1.0, 1.0, 4.0, 4.0, 4.0, 4.0, 4.0, 1.2];
        let chain = ends.map(|to| interval(0.0, to));
        let found = steadied(&parts(8), &chain, 0.4);
        let found: Vec<f64> = found.iter().map(|i| i.to_rad).collect();
        let expected = [1.0, 1.0, 1.4, 1.8, 2.2, 2.0, 1.6, 1.2];
        assert!(
            found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-12),
            "{found:?}"
        );
    }

    #[test]
    fn a_corner_does_not_hold_back() {
        let mut parts = parts(2);
        parts[1].leg = 1;
        let chain = [interval(0.0, 1.0), interval(0.5, 3.0)];
        assert_eq!(steadied(&parts, &chain, 0.1), chain);
    }

    proptest! {
        /// Within the chain, never empty, and no further from one to the next than asked unless the
        /// chain itself forbids it.
        #[test]
        fn a_tube_lies_within_its_chain(
            steps in prop::collection::vec((-0.3..0.3_f64, 0.7..2.0_f64), 1..9),
            most in 0.05..0.5_f64,
        ) {
            let mut from = 0.0;
            let chain = steps.iter().map(|(step, wide)| {
                from += step;
                interval(from, from + wide)
            });
            let chain: Vec<Interval> = chain.collect();
            let tube = steadied(&parts(chain.len()), &chain, most);
            for (inner, outer) in tube.iter().zip(&chain) {
                prop_assert!(inner.from_rad >= outer.from_rad && inner.to_rad <= outer.to_rad);
                prop_assert!(inner.width_rad() > 0.0);
            }
            // Ends of the chain move by 0.3 at most on the left; 0.4 then is enough for a tube of
            // 0.7 at least.
            if most >= 0.4 {
                let apart = tube.windows(2).map(|w| w[0].ends_apart_rad(&w[1]));
                prop_assert!(apart.fold(0.0, f64::max) <= most + 1e-12);
            }
        }
    }
}
