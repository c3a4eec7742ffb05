//! Bull-nose and ball cutters.

use super::sinking::through;
use super::*;
use crate::cutting::chamfer::CuttingCoefficients;

fn round(profile: Profile, teeth: usize, helix_angle_rad: f64) -> Cutter {
    Cutter {
        corner_radius_m: profile.corner_radius_m,
        helix_angle_rad,
        centre_cutting: profile.end_radius_m() == 0.0,
        ..Cutter::straight(profile.radius_m, teeth)
    }
}

fn meant_round(way: &[Leg], cutter: &Cutter, grid_m: f64) -> Meant {
    let profile = cutter.profile();
    let ends_cut = cutter.centre_cutting;
    follow(way, BLOCK, &[], None, &profile, grid_m, ends_cut).unwrap()
}

/// Balls and bull noses, m, drawn: every second one a ball.
fn drawn(seed: u64, draw: &mut impl FnMut(f64, f64) -> f64) -> Profile {
    let radius_m = draw(3e-3, 6e-3);
    match seed % 2 {
        0 => Profile::ball(radius_m),
        _ => Profile {
            radius_m,
            corner_radius_m: radius_m * draw(0.3, 0.8),
        },
    }
}

/// Mean force of a revolution where at each height teeth cut up to an angle, by the generalised
/// model of Engin and Altintas (2001), with positive axial coefficients into the spindle:
/// h = c sin φ sin κ over db = dz/sin κ.
fn mean_n(
    cutter: &Cutter,
    k: &CuttingCoefficients,
    c_m: f64,
    depth_m: f64,
    exit_rad: impl Fn(f64) -> f64,
) -> Vector3<f64> {
    let (r, corner) = (cutter.radius_m, cutter.corner_radius_m);
    let mut sum = Vector3::zeros();
    let mut add = |radius_m: f64, kappa: f64, db: f64| {
        let exit = exit_rad(radius_m);
        let count = 400;
        for i in 0..count {
            let phi = exit * (f64::from(i) + 0.5) / f64::from(count);
            let h = c_m * phi.sin() * kappa.sin();
            let [t, n, a] = [
                (k.tangential_pa, k.edge_tangential_n_per_m),
                (k.radial_pa, k.edge_radial_n_per_m),
                (k.axial_pa, k.edge_axial_n_per_m),
            ]
            .map(|(cutting, edge)| (cutting * h + edge) * db);
            let rows = nalgebra::Matrix3::new(
                -phi.sin() * kappa.sin(),
                -phi.cos(),
                phi.sin() * kappa.cos(),
                -phi.cos() * kappa.sin(),
                phi.sin(),
                phi.cos() * kappa.cos(),
                kappa.cos(),
                0.0,
                kappa.sin(),
            );
            sum += rows * Vector3::new(n, t, a) * (exit / f64::from(count));
        }
    };
    let last = match depth_m < corner {
        true => (1.0 - depth_m / corner).acos(),
        false => FRAC_PI_2,
    };
    for i in 0..600 {
        let kappa = last * (f64::from(i) + 0.5) / 600.0;
        add(
            r - corner + corner * kappa.sin(),
            kappa,
            corner * last / 600.0,
        );
    }
    if depth_m > corner {
        add(r, FRAC_PI_2, depth_m - corner);
    }
    sum * (cutter.teeth as f64 / TAU)
}

/// Mean over whole revolutions from the tenth on of a leg before which a rigid tool has been led
/// along others.
fn mean_of(cutter: Cutter, before: &[Leg], leg: Leg, grid_m: f64, c_m: f64) -> Vector3<f64> {
    let meant = meant_round(before, &cutter, grid_m);
    let mut cut = cut_of(cutter, &meant, leg.from_m);
    cut.stock = meant.target.clone();
    cut.floor_m = meant.floor_m.clone().unwrap();
    let mut found: Vec<Vector3<f64>> = Vec::new();
    lead(&mut cut, &[leg], c_m, rigid, |cut, at, _| {
        if at.rotation_rad > 10.0 * TAU - 1e-9 {
            found.push(cut.evaluate(at).force_on_tool_n);
        }
    });
    let count = found.len() / STEPS * STEPS;
    assert!(count >= 4 * STEPS);
    found[..count].iter().sum::<Vector3<f64>>() / count as f64
}

/// Fifteen revolutions and some along x from a place, mm.
fn on_along_x(from_mm: [f64; 3], cutter: &Cutter, c_m: f64) -> Leg {
    let [x, y, z] = from_mm;
    let way_mm = 15.5e3 * c_m * cutter.teeth as f64;
    through(&[from_mm, [x + way_mm, y, z]])[0]
}

/// Slots, shallower and deeper than the corner.
#[test]
fn verify_mean_force_of_slots_with_round_corners() {
    for seed in 100..108 {
        let mut draw = draws(seed);
        let profile = drawn(seed, &mut draw);
        let cutter = round(profile, 2 + seed as usize % 3, draw(0.3, 0.7));
        let depth_m = profile.corner_radius_m * draw(0.15, 1.4);
        // Chips are linear in the feed but for c/2ρ.
        let c_m = draw(5e-6, 15e-6);
        let depth_mm = -depth_m * 1e3;
        let before = legs(&[[-8.0, 20.0], [8.0, 20.0]], depth_mm);
        let leg = on_along_x([8.0, 20.0, depth_mm], &cutter, c_m);
        let found = mean_of(cutter, &before, leg, draw(0.1e-3, 0.2e-3), c_m);
        let expected = mean_n(&cutter, &aluminium(), c_m, depth_m, |_| PI);
        let apart = (found - expected).norm() / expected.norm();
        assert!(
            apart < 7e-3,
            "{seed} {profile:?} {depth_m}: {found} {expected}"
        );
    }
}

/// A line beside a slot at the same depth: at each height teeth cut where the slot did not reach.
#[test]
fn verify_mean_force_of_a_line_beside_a_slot() {
    for seed in 110..116 {
        let mut draw = draws(seed);
        let profile = drawn(seed, &mut draw);
        let cutter = round(profile, 2, draw(0.3, 0.7));
        let depth_m = profile.corner_radius_m * draw(0.3, 0.9);
        let apart_m = profile.radius_m * draw(0.15, 0.6);
        let c_m = draw(5e-6, 15e-6);
        let (y, depth_mm) = (20.0, -depth_m * 1e3);
        let beside = y + apart_m * 1e3;
        let mut before = legs(&[[-8.0, y], [16.0, y]], depth_mm);
        let over = [
            [16.0, y, depth_mm],
            [16.0, y, 3.0],
            [-8.0, beside, 3.0],
            [-8.0, beside, depth_mm],
        ];
        let mut over = through(&over);
        over.iter_mut().for_each(|leg| leg.rapid = true);
        before.extend(over);
        before.extend(legs(&[[-8.0, beside], [8.0, beside]], depth_mm));
        let leg = on_along_x([8.0, beside, depth_mm], &cutter, c_m);
        let found = mean_of(cutter, &before, leg, draw(0.08e-3, 0.15e-3), c_m);
        // y of the stock that is left at a radius: beyond radius - apart.
        let exit_rad = |radius_m: f64| (1.0 - apart_m / radius_m).max(-1.0).acos();
        let expected = mean_n(&cutter, &aluminium(), c_m, depth_m, exit_rad);
        let error = (found - expected).norm() / expected.norm();
        assert!(error < 0.015, "{seed} {profile:?}: {found} {expected}");
    }
}

/// ∫ρ dh and ∫ρ² dh from the tip up.
fn integrals(profile: &Profile, depth_m: f64) -> [f64; 2] {
    let count = 200_000;
    let dh = depth_m / f64::from(count);
    (0..count).fold([0.0; 2], |sum, i| {
        let radius_m = profile.radius_at_m(dh * (f64::from(i) + 0.5));
        [sum[0] + radius_m * dh, sum[1] + radius_m * radius_m * dh]
    })
}

/// A slot that ends in the block: its section times its length, and half a body of revolution.
#[test]
fn verify_removed_volume_of_round_slots() {
    for seed in 120..124 {
        let mut draw = draws(seed);
        let profile = drawn(seed, &mut draw);
        let cutter = round(profile, 2, draw(0.0, 0.6));
        let depth_m = profile.corner_radius_m * draw(0.2, 1.5);
        let length_m = draw(6e-3, 9e-3);
        let way = legs(&[[-6.5, 20.0], [length_m * 1e3, 20.0]], -depth_m * 1e3);
        let meant = meant_round(&way, &cutter, draw(0.15e-3, 0.25e-3));
        let mut cut = cut_of(cutter, &meant, way[0].from_m);
        let whole_m3 = cut.stock().volume_m3();
        let mut chips_m3 = 0.0;
        // The last teeth fall short of the end by up to their feed.
        lead(&mut cut, &way, 0.04e-3, rigid, |cut, at, _| {
            chips_m3 += cut.evaluate(at).removal_m3_per_rad * TAU / STEPS as f64;
        });
        let [section, square] = integrals(&profile, depth_m);
        let exact_m3 = 2.0 * section * length_m + FRAC_PI_2 * square;
        let removed_m3 = whole_m3 - cut.stock().volume_m3();
        let meant_m3 = whole_m3 - meant.target.volume_m3();
        for (name, found_m3) in [
            ("stock", removed_m3),
            ("chips", chips_m3),
            ("path", meant_m3),
        ] {
            let off = found_m3 / exact_m3 - 1.0;
            assert!(off.abs() < 5e-3, "{seed} {profile:?} {name}: {off}");
        }
        solid::check(cut.stock());
    }
}

/// Lines apart by s leave cusps of s²/8R between them, by path and teeth.
#[test]
fn verify_cusps_between_lines() {
    for seed in 130..134 {
        let mut draw = draws(seed);
        let profile = drawn(seed, &mut draw);
        let cutter = round(profile, 2, 0.5);
        let depth_m = 0.8e-3;
        // Nodes stand on the middle line at y = 20 mm.
        let apart_m = 2.0 * profile.end_radius_m() + profile.corner_radius_m * draw(0.1, 0.5);
        let (low, high) = (20.0 - 0.5e3 * apart_m, 20.0 + 0.5e3 * apart_m);
        let way = legs(
            &[[-8.0, low], [12.0, low], [12.0, high], [-8.0, high]],
            -depth_m * 1e3,
        );
        let meant = meant_round(&way, &cutter, 0.2e-3);
        let mut cut = cut_of(cutter, &meant, way[0].from_m);
        let c_m = 0.1e-3;
        lead(&mut cut, &way, c_m, rigid, |_, _, _| {});
        let cusp_m = profile.cusp_m(apart_m).expect("lines meet");
        let s = apart_m - 2.0 * profile.end_radius_m();
        let textbook_m = s * s / (8.0 * profile.corner_radius_m);
        assert!((cusp_m / textbook_m - 1.0).abs() < 0.02);
        for x in [2e-3, 4e-3, 5e-3] {
            let node = cut.stock().nearest(&Vector2::new(x, 20e-3));
            let written_m = meant.floor_m.as_ref().unwrap()[node] + depth_m;
            assert!(
                (written_m - cusp_m).abs() < 1e-9,
                "{seed}: {written_m} {cusp_m}"
            );
            let left_m = cut.floor_m()[node] + depth_m;
            let marks_m = (2.0 * c_m).powi(2) / (8.0 * profile.corner_radius_m);
            assert!(
                (-1e-8..marks_m).contains(&(left_m - cusp_m)),
                "{left_m} {cusp_m}"
            );
        }
    }
}

/// Straight down into full stock by t a tooth: t cos κ along the normal over R dκ, the thrust
/// `N ∫ ((K_rc t cos κ + K_re) cos κ + (K_ac t cos κ + K_ae) sin κ) R dκ`.
#[test]
fn verify_thrust_of_a_plunging_ball() {
    for seed in 140..144 {
        let mut draw = draws(seed);
        let cutter = round(Profile::ball(draw(3e-3, 6e-3)), 2 + seed as usize % 2, 0.4);
        let way = through(&[[20.0, 20.0, 1.0], [20.0, 20.0, -2.5]]);
        let meant = meant_round(&way, &cutter, 0.2e-3);
        let mut cut = cut_of(cutter, &meant, way[0].from_m);
        let t_m = 0.02e-3;
        let k = aluminium();
        let (mut sum, mut expected, mut torque) = (0.0, 0.0, [0.0; 2]);
        let r = cutter.radius_m;
        lead(&mut cut, &way, t_m, rigid, |cut, at, _| {
            if at.place_m.z > -1.5e-3 || at.place_m.z < -2.4e-3 {
                return;
            }
            let loads = cut.evaluate(at);
            sum += loads.force_on_tool_n.z;
            torque[0] += loads.moment_on_tool_n_m.z;
            let last = (1.0 + at.place_m.z / r).acos();
            for i in 0..400 {
                let kappa = last * (f64::from(i) + 0.5) / 400.0;
                let (sin, cos) = kappa.sin_cos();
                let db = r * last / 400.0 * cutter.teeth as f64;
                let h = t_m * cos;
                let normal = k.radial_pa * h + k.edge_radial_n_per_m;
                let along = k.axial_pa * h + k.edge_axial_n_per_m;
                expected += (normal * cos + along * sin) * db;
                let tangential = k.tangential_pa * h + k.edge_tangential_n_per_m;
                torque[1] += tangential * r * sin * db;
            }
        });
        assert!(
            (sum / expected - 1.0).abs() < 0.01,
            "{seed}: {sum} {expected}"
        );
        let [found, expected] = torque;
        assert!(
            (found / expected - 1.0).abs() < 0.01,
            "{seed}: {found} {expected}"
        );
    }
}

/// A ball led down a slope leaves a groove whose bottom is R along the normal below the path of its
/// middle, R (1/cos − 1) lower than its tip.
#[test]
fn verify_floor_of_a_ball_on_a_slope() {
    for seed in 150..154 {
        let mut draw = draws(seed);
        let cutter = round(Profile::ball(draw(3e-3, 6e-3)), 2, 0.5);
        let drop = draw(0.05, 0.25);
        let way = through(&[[-8.0, 20.0, 0.5], [22.0, 20.0, 0.5 - 30.0 * drop]]);
        let meant = meant_round(&way, &cutter, 0.2e-3);
        let mut cut = cut_of(cutter, &meant, way[0].from_m);
        let whole_m3 = cut.stock().volume_m3();
        let mut chips_m3 = 0.0;
        lead(&mut cut, &way, 0.1e-3, rigid, |cut, at, _| {
            chips_m3 += cut.evaluate(at).removal_m3_per_rad * TAU / STEPS as f64;
        });
        let deeper_m = cutter.radius_m * ((1.0 + drop * drop).sqrt() - 1.0);
        for x in [6e-3, 10e-3, 15e-3] {
            let node = cut.stock().nearest(&Vector2::new(x, 20e-3));
            let tip_m = 0.5e-3 - drop * (x + 8e-3);
            let written_m = meant.floor_m.as_ref().unwrap()[node];
            assert!((written_m - tip_m + deeper_m).abs() < 1e-9, "{seed}");
            let off_m = cut.floor_m()[node] - written_m;
            assert!((-0.1e-6..1.5e-6).contains(&off_m), "{seed}: {off_m}");
        }
        let removed_m3 = whole_m3 - cut.stock().volume_m3();
        let meant_m3 = whole_m3 - meant.target.volume_m3();
        assert!(
            (removed_m3 / meant_m3 - 1.0).abs() < 0.01,
            "{removed_m3} {meant_m3}"
        );
        assert!(
            (chips_m3 / meant_m3 - 1.0).abs() < 0.01,
            "{chips_m3} {meant_m3}"
        );
        solid::check(cut.stock());
    }
}
