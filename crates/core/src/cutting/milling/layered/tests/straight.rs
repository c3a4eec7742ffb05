//! Against the law of the straight cut.

use super::*;
use crate::cutting::milling::cut::{MillingCut, MillingParameters, ToolState};
use crate::cutting::milling::cutter::Runout;
use crate::cutting::milling::dexel::{FinishedSurface, RayGrid, Wall};
use crate::cutting::milling::engagement::Stock;
use crate::cutting::milling::layered::walls::Side;

/// The same tool, vibrating, cuts a block by this law and by that of the straight cut. Where
/// nothing older than two revolutions matters, forces are equal but for outlines on the grid; in
/// the mean they are, the walls to 0.1 um (the straight law keeps a wall's arcs over two
/// revolutions' feed alone, which vibration of 5 um does not exceed).
#[test]
fn verify_straight_cut_is_that_of_the_straight_law() {
    for seed in 50..55 {
        let mut draw = draws(seed);
        let (r_m, depth_m, c_m) = (draw(4e-3, 7e-3), draw(0.5e-3, 3e-3), draw(0.06e-3, 0.15e-3));
        let radial_m = draw(0.2, 1.6) * r_m;
        let y_m = radial_m - r_m;
        let cutter = Cutter {
            helix_angle_rad: draw(0.0, 0.6),
            runout: Runout {
                offset_m: draw(0.0, 2e-6),
                angle_rad: draw(0.0, 6.0),
            },
            ..Cutter::straight(r_m, 3)
        };
        let (turns, sizes) = ([draw(0.3, 3.0), draw(3.0, 12.0)], [draw(1e-6, 4e-6), 1e-6]);
        let off = move |rotation: f64| {
            let [a, b] = turns.map(|turn| turn * rotation);
            Vector3::new(
                sizes[0] * a.sin(),
                sizes[0] * a.cos() + sizes[1] * b.sin(),
                0.0,
            )
        };
        let way = legs(&[[-12.0, y_m * 1e3], [10.0, y_m * 1e3]], -depth_m * 1e3);
        let meant = meant(&way, &[], r_m, 0.1e-3);
        let mut cut = cut_of(cutter, &meant, way[0].from_m + off(0.0));
        let straight =
            |revolutions| straight_of(cutter, y_m, depth_m, (c_m, revolutions), off(0.0));
        let (mut straight, mut older) = (straight(2), straight(12));
        let (mut compared, mut all) = (0, 0);
        let mut sums_n = [Vector3::zeros(); 2];
        let (mut worst_n, mut largest_n) = (0.0_f64, 0.0_f64);
        lead(&mut cut, &way, c_m, off, |cut, at, _| {
            let state = ToolState {
                rotation_rad: at.rotation_rad,
                displacement_m: off(at.rotation_rad),
                ..ToolState::default()
            };
            let (ours, theirs) = (cut.evaluate(at), older.evaluate(&state));
            if theirs.thickest_chip_m > 0.0 {
                all += 1;
                largest_n = largest_n.max(theirs.force_on_tool_n.norm());
                sums_n[0] += ours.force_on_tool_n;
                sums_n[1] += theirs.force_on_tool_n;
                let recent = straight.evaluate(&state).force_on_tool_n;
                if (recent - theirs.force_on_tool_n).norm() < 1e-9 {
                    let error = (ours.force_on_tool_n - theirs.force_on_tool_n).norm();
                    worst_n = worst_n.max(error);
                    compared += 1;
                }
            }
            straight.commit(&state);
            older.commit(&state);
        });
        assert!(
            compared > all / 3 && all > 500,
            "{seed}: {compared} of {all}"
        );
        assert!(
            worst_n < 5e-3 * largest_n,
            "{seed}: {worst_n} of {largest_n}"
        );
        let error = (sums_n[0] - sums_n[1]).norm() / sums_n[1].norm();
        assert!(error < 2e-3, "{seed}: {error}");
        let finished = straight.finished().unwrap();
        let (grid, theirs) = (finished.grid(), finished.wall(0).left_m());
        let mut walls = 0;
        for (station, left_m) in cut.walls().left_m() {
            assert_eq!(station.side, Side::Left);
            if !(2e-3..8e-3).contains(&station.from_m.x) {
                continue;
            }
            let x_m = station.from_m.x + 12e-3;
            let ray = ((x_m - grid.start_m) / grid.spacing_m).round() as usize;
            let near = &theirs[ray - 1..=ray + 1];
            let nearest = near.iter().map(|left| (left - left_m).abs());
            assert!(
                nearest.fold(f64::INFINITY, f64::min) < 1e-7,
                "{seed} {left_m} {near:?}"
            );
            walls += 1;
        }
        assert!(walls > 15, "{walls}");
    }
}

/// The straight law on the same block: its wall on the entry side, y = +r.
fn straight_of(
    cutter: Cutter,
    y_m: f64,
    depth_m: f64,
    (feed_m, revolutions): (f64, usize),
    start_m: Vector3<f64>,
) -> MillingCut {
    let parameters = MillingParameters {
        cutter,
        coefficients: aluminium(),
        stock: Stock {
            x_min_m: 12e-3,
            x_max_m: f64::INFINITY,
            y_min_m: -y_m,
            y_max_m: f64::INFINITY,
            top_m: depth_m,
        },
        feed_per_tooth_m: feed_m,
        regeneration: true,
        steady_displacement_m: start_m,
        passes: revolutions * cutter.teeth,
        slice_lag_rad: 0.02,
    };
    let grid = RayGrid {
        start_m: 12e-3,
        spacing_m: 2e-6,
        count: 5000,
    };
    let rows = [(Wall::Entry, 0.5 * depth_m)];
    MillingCut::new(parameters, Some(FinishedSurface::new(grid, &rows, &[])))
}
