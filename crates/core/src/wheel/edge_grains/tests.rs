//! Closed forms of the grains' law.

use super::*;

/// Grains of 40 µm, 30 ± 8 µm out of a rubber of 2 MPa (E, ν 0.5; k_t 0.75 k_n).
fn grains(modulus_pa: f64) -> BondedGrains {
    let normal_n_per_m = 2.0 * modulus_pa / 0.75 * 40e-6;
    BondedGrains {
        radius_m: 40e-6,
        protrusion_m: 30e-6,
        spread_m: 8e-6,
        strength_n: 40e-3,
        normal_n_per_m,
        tangential_n_per_m: 0.75 * normal_n_per_m,
    }
}

fn corner(radius_m: f64, mu: f64, along: f64) -> Corner {
    Corner {
        radius_m,
        mu,
        velocity_m_per_s: [-0.7, along],
    }
}

const PER_M2: f64 = 16e6;
const PRESSURE_PA: f64 = 0.12e6;

#[test]
fn verify_the_gap_bears_the_pressure_on_a_sum_over_heights() {
    for (modulus, pressure) in [(4e6, 0.12e6), (8e6, 0.12e6), (4e6, 0.002e6), (2e6, 0.05e6)] {
        let g = grains(modulus);
        let gap = g.gap_m(pressure, PER_M2);
        let n = 200_000;
        let (mut all, mut deep, mut over) = (0.0, 0.0, 0.0);
        for k in 0..n {
            let z = -10.0 + 20.0 * (f64::from(k) + 0.5) / f64::from(n);
            let depth = (g.protrusion_m + z * g.spread_m - gap).max(0.0);
            let weight = density(z) * 20.0 / f64::from(n);
            all += weight * depth * g.normal_n_per_m;
            if depth >= 20e-6 {
                deep += weight * depth * g.normal_n_per_m;
                over += weight;
            }
        }
        assert!((PER_M2 * all / pressure - 1.0).abs() < 1e-6, "{modulus}");
        let [mean, beyond] = g.mean_forces_n(gap, 20e-6);
        assert!((mean / all - 1.0).abs() < 1e-6);
        assert!((beyond - deep).abs() < 1e-4 * all);
        assert!((g.share_beyond(gap, 20e-6) - over).abs() < 1e-4);
    }
    assert_eq!(
        grains(2e6).gap_m(PRESSURE_PA, PER_M2),
        0.0,
        "the rubber touches"
    );
}

/// Shares of the closed form by the tables of the normal distribution.
#[test]
fn verify_shares_that_jam() {
    let cases = [
        (2e6, 0.3, 0.398),
        (2e6, 0.5, 0.739),
        (2e6, 0.8, 0.949),
        (4e6, 0.5, 0.180),
        (4e6, 0.8, 0.532),
        (8e6, 0.5, 0.018),
    ];
    for (modulus, mu, expected) in cases {
        let g = grains(modulus);
        let gap = g.gap_m(PRESSURE_PA, PER_M2);
        let share = g.share_beyond(gap, g.jam_depth_m(&corner(5e-6, mu, 0.0)));
        assert!((share - expected).abs() < 1e-3, "{modulus} {mu}: {share}");
    }
}

/// Bed and layer of grains under the same pressure in series: what is missing when so many
/// grains of an area go is what the bed loses at the deflection that is held.
#[test]
fn verify_neighbours_take_over_what_the_bed_does_not_lose() {
    let g = grains(4e6);
    let bed_pa_per_m = 2e8;
    let pressed = |per_m2: f64| {
        // p = b (d + s(p)) by bisection; d gives the pressure with all of them
        let d = PRESSURE_PA / bed_pa_per_m - g.gap_m(PRESSURE_PA, PER_M2);
        let [low, _] = crate::roots::bisect([1e3, 1e6], 60, |p| {
            p > bed_pa_per_m * (d + g.gap_m(p, per_m2))
        });
        low
    };
    let gap = g.gap_m(PRESSURE_PA, PER_M2);
    let part = 1e-3;
    let lost = (PRESSURE_PA - pressed(PER_M2 * (1.0 - part))) / (part * PRESSURE_PA);
    let unshared = g.unshared(bed_pa_per_m, gap, PER_M2);
    assert!((lost / unshared - 1.0).abs() < 0.01, "{lost} {unshared}");
    assert!(unshared > 0.01 && unshared < 0.1);
    assert_eq!(g.unshared(bed_pa_per_m, 0.0, PER_M2), 0.0);
}

#[test]
fn verify_a_rounded_edge_or_half_the_pressure_is_quiet_and_outward_nothing_jams() {
    let g = grains(4e6);
    let gap = g.gap_m(PRESSURE_PA, PER_M2);
    let share =
        |gap: f64, radius: f64| g.share_beyond(gap, g.jam_depth_m(&corner(radius, 0.5, 0.0)));
    assert!(share(gap, 5e-6) > 0.15 && share(gap, 30e-6) < 0.005 && share(gap, 60e-6) < 1e-5);
    assert!(share(g.gap_m(0.5 * PRESSURE_PA, PER_M2), 5e-6) < 0.025);
    // the radius at which the deepest is still carried over
    let (deepest, sine) = (25e-6, 0.5_f64.atan().sin());
    let quiet = deepest / (1.0 - sine) - g.radius_m;
    for (radius, jams) in [(quiet - 1e-9, true), (quiet + 1e-9, false)] {
        let pulse = g.pulse(deepest, &corner(radius, 0.5, 0.0)).unwrap();
        assert_eq!(pulse.jams, jams);
    }
    for depth in [5e-6, 20e-6, 44e-6, 60e-6] {
        let outward = Corner {
            velocity_m_per_s: [0.7, 0.1],
            ..corner(5e-6, 0.8, 0.0)
        };
        assert_eq!(g.pulse(depth, &outward), None);
    }
}

#[test]
fn verify_running_obliquely_grains_jam_less_and_not_beyond_the_cone() {
    let g = grains(2e6);
    // stretch along (cos χ, sin χ) in the plane, normal at θ0: within the cone of friction
    let sticks = |depth: f64, mu: f64, chi: f64| {
        let theta = (1.0 - depth / 45e-6).acos();
        let pressed = chi.cos() * theta.sin();
        let rubbed = (chi.cos() * theta.cos()).hypot(chi.sin());
        rubbed <= mu * pressed
    };
    for mu in [0.3, 0.5, 0.8] {
        for degrees in [0.0_f64, 10.0, 15.0, 30.0, 50.0] {
            let chi = degrees.to_radians();
            for depth in [10e-6, 20e-6, 30e-6, 40e-6, 44e-6] {
                let at = corner(5e-6, mu, 0.7 * chi.tan());
                let jams = g.pulse(depth, &at).unwrap().jams;
                assert_eq!(jams, sticks(depth, mu, chi), "{mu} {degrees} {depth}");
            }
        }
    }
}

#[test]
fn verify_pulses_give_the_work_that_a_slow_run_gives() {
    let g = grains(4e6);
    for (depth, mu) in [(5e-6, 0.3), (20e-6, 0.3), (20e-6, 0.5), (30e-6, 0.3)] {
        let pulse = g.pulse(depth, &corner(5e-6, mu, 0.0)).unwrap();
        assert!(!pulse.jams);
        // the climb in small steps of the angle: force over the rubber's way
        let (reach, psi) = (45e-6_f64, f64::atan(mu));
        let from = (1.0 - depth / reach).acos();
        let force = |theta: f64| {
            let lowered = reach * (theta.cos() - from.cos());
            g.normal_n_per_m * lowered * (theta + psi).tan()
        };
        let way =
            |theta: f64| reach * (from.sin() - theta.sin()) + force(theta) / g.tangential_n_per_m;
        let (n, mut work) = (20_000, 0.0);
        for k in 0..n {
            let at = |k: i32| from * (1.0 - f64::from(k) / f64::from(n));
            let mean = 0.5 * (force(at(k)) + force(at(k + 1)));
            work += mean * (way(at(k + 1)) - way(at(k)));
        }
        assert!((0.7 * pulse.impulse_n_s / work - 1.0).abs() < 1e-6);
        assert!((0.7 * pulse.length_s / way(0.0) - 1.0).abs() < 1e-9);
        assert!((force(0.0) / (mu * g.normal_n_per_m * depth) - 1.0).abs() < 1e-9);
    }
    let jam = g.pulse(40e-6, &corner(5e-6, 0.8, 0.1)).unwrap();
    let speed = 0.7_f64.hypot(0.1);
    let energy = 0.5 * g.strength_n.powi(2) / g.tangential_n_per_m;
    assert!(jam.jams && (jam.impulse_n_s * speed / energy - 1.0).abs() < 1e-12);
}

#[test]
fn verify_a_pulse_gives_its_impulse_and_its_square() {
    let g = grains(4e6);
    for (depth, mu) in [(40e-6, 0.5), (12e-6, 0.5)] {
        let pulse = g.pulse(depth, &corner(5e-6, mu, 0.0)).unwrap();
        let n = 4000;
        let step = pulse.length_s / f64::from(n);
        let square: f64 = (0..n)
            .map(|k| {
                let from = pulse.given_n_s(f64::from(k) * step);
                let to = pulse.given_n_s(f64::from(k + 1) * step);
                (to - from).powi(2) / step
            })
            .sum();
        assert!((square / pulse.square_n2_s() - 1.0).abs() < 1e-5);
        assert_eq!(pulse.given_n_s(-1.0), 0.0);
        assert_eq!(pulse.given_n_s(1.0), pulse.impulse_n_s);
    }
}
