//! Tools that turn as they go.

use super::*;

/// A tool whose axis turns by 20 to 40 degrees on its way: chips, stock and path agree.
#[test]
fn verify_chips_of_a_tool_that_turns_are_what_the_stock_loses() {
    // Flat, ball and bull nose.
    for seed in 230..233 {
        let mut draw = draws(seed);
        let profile = drawn(seed, &mut draw);
        let cutter = with_corner(profile, 2, draw(0.0, 0.6));
        let depth_mm = draw(1.0, 2.5);
        let at = |x_mm: f64, forwards: f64, aside: f64| {
            pose([x_mm, 15.0, -depth_mm], leaning(forwards, aside))
        };
        let (side, turned) = (draw(-0.2, 0.2), draw(0.35, 0.7));
        let from = at(-7.0, 0.45, side);
        let way = leg(from, at(14.0, 0.45 - 0.6 * turned, side + 0.5 * turned));
        let meant = follow(&[way], stock(0.15e-3), &profile).unwrap();
        let whole_m3 = meant.stock.surface().volume_m3();
        let target_m3 = whole_m3 - meant.target.surface().volume_m3();
        let mut cut = SwivelCut::new(cutter, aluminium(), meant.stock, &at_start(&way));
        let mut chips_m3 = 0.0;
        lead(&mut cut, &way, 0.08e-3, |cut, at| {
            chips_m3 += cut.evaluate(at).removal_m3_per_rad * TAU / STEPS as f64;
        });
        let removed_m3 = whole_m3 - cut.stock().surface().volume_m3();
        let off = [chips_m3, target_m3].map(|one| one / removed_m3 - 1.0);
        println!("{seed}: chips {:.2e}, target {:.2e} off", off[0], off[1]);
        assert!(
            off[0].abs() < 0.005 && off[1].abs() < 0.01,
            "{seed}: {off:?}"
        );
    }
}

/// A rapid way through stock, a heel that drags, a start in the stock and a miss are told.
#[test]
fn what_a_tool_that_leans_cannot_do_is_told() {
    let flat = Profile::flat(4e-3);
    let way =
        |from: Isometry3<f64>, to: Isometry3<f64>| follow(&[leg(from, to)], stock(0.3e-3), &flat);
    let forwards = leaning(0.2, 0.0);
    let at = |x_mm: f64, axes: Rotation3<f64>| pose([x_mm, 15.0, -1.0], axes);
    assert!(way(at(-8.0, forwards), at(10.0, forwards)).is_ok());
    let back = leaning(-0.2, 0.0);
    let fault = way(at(-8.0, back), at(10.0, back)).unwrap_err();
    assert!(
        matches!(fault, WayFault::LeadsDown { point: 1, sinks, .. } if (sinks - 0.2_f64.sin()).abs() < 1e-9)
    );
    let fault = way(at(10.0, forwards), at(12.0, forwards)).unwrap_err();
    assert_eq!(fault, WayFault::StartsInStock);
    let above = |x_mm: f64| pose([x_mm, 15.0, 1.0], forwards);
    assert_eq!(way(above(-8.0), above(10.0)).unwrap_err(), WayFault::Misses);
    let rapid = SwivelLeg {
        rapid: true,
        ..leg(at(-8.0, forwards), at(10.0, forwards))
    };
    let fault = follow(&[rapid], stock(0.3e-3), &flat).unwrap_err();
    assert!(matches!(fault, WayFault::Rapid { point: 1, .. }));
}

/// A ball leaves the same floor however it leans, and however it turns about its middle.
#[test]
fn verify_the_floor_of_a_ball_does_not_know_how_it_leans() {
    let radius_m = 4e-3;
    let profile = Profile::ball(radius_m);
    let about_middle = |x_mm: f64, axes: Rotation3<f64>| {
        let middle_mm = Vector3::new(x_mm, 15.0, 2.5);
        let tip_mm = middle_mm - axes * (Vector3::z() * radius_m * 1e3);
        pose(tip_mm.into(), axes)
    };
    let (from, to) = (leaning(0.3, -0.3), leaning(-0.2, 0.4));
    // In pieces, or the tip would go straight where the middle should.
    let at = |k: usize| {
        let share = k as f64 / 60.0;
        let axes = Unit::new_normalize((from * Vector3::z()).lerp(&(to * Vector3::z()), share));
        about_middle(-10.0 + 30.0 * share, turned_to(&from, &axes))
    };
    let legs: Vec<SwivelLeg> = (0..60).map(|k| leg(at(k), at(k + 1))).collect();
    let grid_m = 0.2e-3;
    let found = follow(&legs, stock(grid_m), &profile).unwrap().target;
    let mut looked_at = 0;
    for x in 5..15 {
        for y in -4..=4 {
            let (x_m, off_m) = (f64::from(x) * 1e-3, f64::from(y) * 0.4e-3);
            let floor_m = 2.5e-3 - (radius_m * radius_m - off_m * off_m).sqrt();
            let place = Vector3::new(x_m, 15e-3 + off_m, floor_m);
            // To the square of the grid, and what its middle leaves a straight way by.
            let beyond_m = found.beyond_m(&place);
            assert!(beyond_m.abs() < 3e-6, "{x} {y}: {beyond_m}");
            looked_at += 1;
        }
    }
    assert_eq!(looked_at, 90);
}

/// The rim of a flat end that leans forwards leaves a trough, half of an ellipse.
#[test]
fn verify_the_floor_of_a_flat_end_that_leans() {
    for seed in 260..264 {
        let mut draw = draws(seed);
        let (r_m, lean_rad, grid_m) = (draw(3e-3, 5e-3), draw(0.05, 0.5), draw(0.1e-3, 0.25e-3));
        let at = |x_mm: f64| pose([x_mm, 15.0, -1.0], leaning(lean_rad, 0.0));
        let meant = follow(
            &[leg(at(-9.0), at(20.0))],
            stock(grid_m),
            &Profile::flat(r_m),
        );
        let target = meant.unwrap().target;
        let mut worst = 0.0_f64;
        for x in 5..12 {
            for share in [-0.8_f64, -0.55, -0.3, 0.0, 0.25, 0.5, 0.75] {
                let floor_m = -1e-3 - r_m * lean_rad.sin() * (1.0_f64 - share * share).sqrt();
                let place = |z_m: f64| Vector3::new(f64::from(x) * 1e-3, 15e-3 + share * r_m, z_m);
                let (mut low, mut high) = (floor_m - grid_m, floor_m + grid_m);
                for _ in 0..30 {
                    let middle = 0.5 * (low + high);
                    match target.beyond_m(&place(middle)) > 0.0 {
                        true => low = middle,
                        false => high = middle,
                    }
                }
                worst = worst.max((low - floor_m).abs() / grid_m);
            }
        }
        println!("{seed}: {worst} of the grid");
        assert!(worst < 1.0 / 40.0, "{seed}: {worst}");
    }
}
