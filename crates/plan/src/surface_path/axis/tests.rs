//! Axes along lines on faces drawn at random.

use super::*;
use crate::surface::drawn::{self, seeded};
use crate::surface_path::wheel::tests::PUBLISHED;

/// Places along u, 2 mm apart, at a v.
fn places(surface: &dyn Surface, v: f64) -> Vec<Place> {
    let place = |k: u32| Place::at(surface, [f64::from(k) / 80.0, v], [1.0, 0.0]);
    (0..=80).map(|k| place(k).expect("a normal")).collect()
}

/// Largest turn of the axis from place to place, deg.
fn most_deg(chosen: &[AxisTrial]) -> f64 {
    let pairs = chosen.windows(2);
    let turns = pairs.map(|w| w[0].axis.dot(&w[1].axis).abs().min(1.0).acos());
    turns.fold(0.0, f64::max).to_degrees()
}

/// Whether a chain of candidates that keep the limit leads from end to end by at most `most`
/// degrees from place to place.
fn has_chain(places: &[Place], limit_m: f64, most: usize) -> bool {
    let mut open = [true; TRIED];
    for place in places {
        let Ok(costs) = place.costs(&PUBLISHED, limit_m) else {
            return false;
        };
        let near = |k: usize| (0..=2 * most).any(|d| open[(k + TRIED + d - most) % TRIED]);
        open = std::array::from_fn(|k| costs[k].is_finite() && near(k));
    }
    open.iter().any(|open| *open)
}

/// On patches drawn at random, with a limit little above the least that a line can keep, the
/// axis turns by no more than 15° in 2 mm wherever there is a line of axes that turns by 3° at
/// most; the choice place by place leaps on some of them.
#[test]
fn the_axis_never_leaps_where_it_can_be_turned_on_the_way() {
    let (mut chains, mut leaps) = (0, 0);
    for seed in 0..24 {
        let patch = drawn::patch(&drawn::heights(seed), 6e-3, 12e-3);
        let places = places(&patch, 0.1 + 0.8 * f64::from(seed) / 24.0);
        let limits_m = (2..60).map(|k| 0.02e-3 * f64::from(k));
        let mut holding = limits_m.filter(|limit_m| has_chain(&places, *limit_m, 3));
        let Some(limit_m) = holding.next() else {
            continue;
        };
        chains += 1;
        let chosen = widest_along(&places, &PUBLISHED, limit_m).expect("axes");
        let alone = places.iter().map(|place| {
            let one = Place::at(&patch, place.uv, [1.0, 0.0]).expect("a normal");
            let mut one = widest_along(&[one], &PUBLISHED, limit_m).expect("an axis");
            one.remove(0)
        });
        let alone: Vec<AxisTrial> = alone.collect();
        assert!(
            chosen.iter().all(|one| one.edge_gap_m <= limit_m),
            "seed {seed}"
        );
        let most = most_deg(&chosen);
        assert!(most < 15.0, "seed {seed}: {most}");
        leaps += usize::from(most_deg(&alone) > 15.0);
    }
    assert!(chains > 15 && leaps > 3, "{chains} {leaps}");
}

/// Least of the largest turns from place to place that any line of candidates has, by search in
/// space, without feeds: bisected, whether a line leads from end to end.
fn least_turn_deg(places: &[Place], limit_m: f64) -> f64 {
    let axes = |place: &Place| -> Vec<Unit<Vector3<f64>>> {
        let all = (0..TRIED).map(|k| place.candidate(k));
        let fit = |axis: &Unit<Vector3<f64>>| {
            let found = place.trial(&PUBLISHED, *axis);
            found.is_ok_and(|one| one.edge_gap_m <= limit_m)
        };
        all.filter(fit).collect()
    };
    let all: Vec<_> = places.iter().map(axes).collect();
    let leads = |most_deg: f64| {
        let least_cos = most_deg.to_radians().cos();
        let mut open = all[0].clone();
        for next in &all[1..] {
            let near = |to: &Unit<Vector3<f64>>| open.iter().any(|a| a.dot(to).abs() >= least_cos);
            open = next.iter().copied().filter(near).collect();
        }
        !open.is_empty()
    };
    let (mut low, mut high) = (0.0, 90.0);
    for _ in 0..12 {
        let middle = 0.5 * (low + high);
        if leads(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

/// On patches drawn at random, with a limit that binds nowhere, along lines whose feed turns
/// sharply at a place drawn at random: a line of axes that turns little is there, and the axis
/// does not turn with the feed.
#[test]
fn the_axis_does_not_turn_with_a_feed_that_turns_sharply() {
    for seed in 0..12 {
        let patch = drawn::patch(&drawn::heights(seed), 2e-3, 4e-3);
        let (kink, slope) = drawn::seeded(seed, &(5..12_u32, 0.6..1.0_f64));
        let place = |k: u32| {
            let u = f64::from(k) / 16.0;
            let off = u - f64::from(kink) / 16.0;
            // Down to the kink and up again.
            let sense = if k < kink { -1.0 } else { 1.0 };
            let v = 0.1 + slope * off.abs();
            Place::at(&patch, [u, v], [1.0, sense * slope]).expect("a normal")
        };
        let places: Vec<Place> = (0..=16).map(place).collect();
        let feeds = places.windows(2);
        let feeds = feeds.map(|w| w[0].feed.angle(&w[1].feed).to_degrees());
        let feed_deg = feeds.fold(0.0, f64::max);
        let limit_m = 1.0;
        let chosen = widest_along(&places, &PUBLISHED, limit_m).expect("axes");
        let (most_deg, least_deg) = (most_deg(&chosen), least_turn_deg(&places, limit_m));
        assert!(feed_deg > 30.0 && least_deg < 5.0, "{feed_deg} {least_deg}");
        assert!(
            most_deg < 0.3 * feed_deg,
            "seed {seed}: {most_deg} of {feed_deg}"
        );
    }
}

/// On a plane the axis keeps its angle all along: as near to across the feed as a swath takes
/// that is 2 % less than the widest, √(W² + 4b²).
#[test]
fn verify_the_axis_keeps_its_angle_on_a_plane() {
    let (along, up) = (Vector3::x() * 0.1, Vector3::y() * 0.06);
    let plane = crate::surface::PlanePatch::new(Vector3::zeros(), along, up).expect("a plane");
    let chosen = widest_along(&places(&plane, 0.5), &PUBLISHED, 1e-3).expect("axes");
    let widest_rad = (2.0 * chosen[0].half_width_m / PUBLISHED.width_m).atan();
    let off_rad = (widest_rad - (1.0 - AS_WIDE).acos()).max(0.0);
    let found = chosen.iter().map(|one| FRAC_PI_2 - one.psi_rad);
    let degree = 1_f64.to_radians();
    assert!(found.clone().all(|found| (found - off_rad).abs() < degree));
    let first = FRAC_PI_2 - chosen[0].psi_rad;
    assert!(found.clone().all(|found| (found - first).abs() < 1e-9));
}

/// Candidates that are too far off to be the best are left out: the costs are, to the bit, those
/// over all of them.
#[test]
fn candidates_that_are_left_out_are_never_the_best() {
    let cost = || proptest::collection::vec(0.0..1.0_f64, TRIED);
    for seed in 0..200 {
        let (costs, spread, feed_rad, way) =
            seeded(seed, &(cost(), -4.0..1.0_f64, -PI..PI, -9.0..1.0_f64));
        let mut row: Costs = std::array::from_fn(|k| costs[k] * 10_f64.powf(spread));
        if seed % 4 == 0 {
            row.iter_mut()
                .step_by(7)
                .for_each(|one| *one = f64::INFINITY);
        }
        let (turns, way) = (turns(feed_rad), 10_f64.powf(way));
        let per_way = 1.0 / way.max(SHORT);
        let over_all: Costs = std::array::from_fn(|j| {
            let each = (0..TRIED).map(|i| row[i] + turns.squared[TRIED + j - i] * per_way);
            each.fold(f64::INFINITY, f64::min)
        });
        assert_eq!(reached(&row, &turns, way), over_all, "seed {seed}");
    }
}
