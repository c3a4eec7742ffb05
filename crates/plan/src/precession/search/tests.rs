use super::*;
use proptest::prelude::*;

fn grid() -> Grid {
    Grid { angles: 72 }
}

fn arc(middle_deg: f64, half_deg: f64) -> AngleSet {
    AngleSet::around(middle_deg.to_radians(), half_deg.to_radians())
}

/// Brute force over all angles: least cost of reaching each, step by step within arcs.
fn least_cost(
    grid: &Grid,
    sets: &[AngleSet],
    times: &[f64],
    nominal: &[f64],
    rates: &[f64],
) -> f64 {
    let n = grid.angles as i64;
    let last = sets.len() - 1;
    let at = |j: i64| j.rem_euclid(n) as f64 * grid.step_rad();
    let cost = |k: usize, j: i64| {
        let held = times[(k + 1).min(last)] - times[k.saturating_sub(1)];
        if sets[k].contains(at(j)) {
            wrapped(at(j) - nominal[k]).powi(2) * held
        } else {
            f64::INFINITY
        }
    };
    let mut costs: Vec<f64> = (0..n).map(|j| cost(0, j)).collect();
    for k in 1..=last {
        let most = (rates[k - 1] * (times[k] - times[k - 1]) / grid.step_rad()) as i64;
        let best = |j: i64| {
            let mut best = costs[j as usize];
            for sign in [-1, 1] {
                for step in 0..=most {
                    if !sets[k - 1].contains(at(j + sign * step)) {
                        break;
                    }
                    best = best.min(costs[(j + sign * step).rem_euclid(n) as usize]);
                }
            }
            best + cost(k, j)
        };
        costs = (0..n).map(best).collect();
    }
    costs.into_iter().fold(f64::INFINITY, f64::min)
}

fn cost_of(trajectory: &[f64], times: &[f64], nominal: &[f64]) -> f64 {
    let last = trajectory.len() - 1;
    let each = (0..=last).map(|k| {
        let held = times[(k + 1).min(last)] - times[k.saturating_sub(1)];
        wrapped(trajectory[k] - nominal[k]).powi(2) * held
    });
    each.sum()
}

/// The trajectory leaves as late as its rate of one angle (5°) a station allows, and waits at the
/// near end of the arc.
#[test]
fn a_course_leaves_in_time_for_what_closes_ahead() {
    let times: Vec<f64> = (0..60).map(|k| f64::from(k) * 0.1).collect();
    let set = |k: usize| match k {
        0..40 => AngleSet::Circle,
        _ => arc(180.0, 20.0),
    };
    let sets: Vec<AngleSet> = (0..60).map(set).collect();
    let trajectory = grid()
        .trajectory(&sets, &times, &[0.0; 60], &[1.0; 59])
        .expect("a sign");
    for (k, angle) in trajectory.iter().enumerate() {
        let expected = (160.0 - 5.0 * (40.0 - k as f64)).clamp(0.0, 160.0);
        let found = wrapped(*angle).abs().to_degrees();
        assert!((found - expected).abs() < 1e-9, "{k}: {found} {expected}");
    }
    let too_soon: Vec<AngleSet> = (0..60)
        .map(|k| {
            if k < 10 {
                arc(0.0, 20.0)
            } else {
                arc(180.0, 20.0)
            }
        })
        .collect();
    let stuck = grid().trajectory(&too_soon, &times, &[0.0; 60], &[1.0; 59]);
    let stuck = stuck.expect_err("no sign");
    assert_eq!((stuck.stations, stuck.narrow), (vec![10], false));
}

#[test]
fn a_set_without_an_angle_of_the_grid_is_narrow() {
    let sets = [AngleSet::Circle, arc(2.5, 1.0), AngleSet::Circle];
    let stuck = grid().trajectory(&sets, &[0.0, 1.0, 2.0], &[0.0; 3], &[1.0; 2]);
    let stuck = stuck.expect_err("too narrow");
    assert_eq!((stuck.stations, stuck.narrow), (vec![1], true));
}

/// The mean of a straight line is the line, away from the ends; of a step of rate it has the
/// acceleration rate/window.
#[test]
fn verify_moving_mean_of_lines() {
    let times: Vec<f64> = (0..=100)
        .map(|k| 0.01 * f64::from(k) + 1e-4 * f64::from(k % 3))
        .collect();
    let values: Vec<f64> = times.iter().map(|t| (t - 0.5).max(0.0)).collect();
    let mean = moving_mean(&times, &values, 0.2, &times);
    for (t, m) in times.iter().zip(&mean) {
        if *t > 0.9 {
            continue;
        }
        let into = (t - 0.4).clamp(0.0, 0.2);
        let exact = if *t > 0.6 { t - 0.5 } else { into * into / 0.4 };
        // The knee of the values lies between two stations.
        assert!((m - exact).abs() < 1e-4, "{t}: {m} {exact}");
    }
}

proptest! {
    /// No trajectory costs less, by brute force; it stays in its sets and moves no faster than
    /// allowed.
    #[test]
    fn verify_course_is_the_best_of_the_grid(
        arcs in prop::collection::vec((0.0..360.0_f64, 20.0..170.0_f64, any::<bool>()), 12),
        rates in prop::collection::vec(0.3..3.0_f64, 35), turn in -2.0..2.0_f64,
    ) {
        let grid = Grid { angles: 72 };
        let time = |k: i32| 0.3 * f64::from(k) + 0.05 * f64::from(k % 2);
        let times: Vec<f64> = (0..36).map(time).collect();
        let nominal: Vec<f64> = times.iter().map(|t| turn * t).collect();
        let sets: Vec<AngleSet> = (0..36).map(|k| {
            let (middle, half, free) = arcs[k / 3];
            if free { AngleSet::Circle } else { arc(middle, half) }
        }).collect();
        let best = least_cost(&grid, &sets, &times, &nominal, &rates);
        match grid.trajectory(&sets, &times, &nominal, &rates) {
            Ok(trajectory) => {
                let cost = cost_of(&trajectory, &times, &nominal);
                prop_assert!((cost - best).abs() <= 1e-9 * best.max(1.0), "{} {}", cost, best);
                for k in 0..36 {
                    prop_assert!(sets[k].contains(trajectory[k]));
                    if k > 0 {
                        let turned = (trajectory[k] - trajectory[k - 1]).abs();
                        prop_assert!(turned / (times[k] - times[k - 1]) <= rates[k - 1] + 1e-9);
                    }
                }
            }
            Err(_) => prop_assert!(best.is_infinite()),
        }
    }
}
