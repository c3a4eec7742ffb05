//! Plunges, ramps and helices.

use super::*;
use crate::cutting::chamfer::CuttingCoefficients;

/// Legs through points in space, mm.
pub(super) fn through(points_mm: &[[f64; 3]]) -> Vec<Leg> {
    let at = |p: &[f64; 3]| Vector3::from(*p) * 1e-3;
    let pairs = points_mm.windows(2).enumerate();
    let leg = |(k, pair): (usize, &[[f64; 3]])| Leg {
        from_m: at(&pair[0]),
        to_m: at(&pair[1]),
        rapid: false,
        point: k + 1,
    };
    pairs.map(leg).collect()
}

fn sinking(way: &[Leg], holes: &[Hole], radius_m: f64, grid_m: f64) -> Meant {
    follow(
        way,
        BLOCK,
        holes,
        None,
        &Profile::flat(radius_m),
        grid_m,
        true,
    )
    .unwrap()
}

pub(super) fn centre_cutting(radius_m: f64, teeth: usize) -> Cutter {
    Cutter {
        centre_cutting: true,
        ..Cutter::straight(radius_m, teeth)
    }
}

/// Coefficients whose axial forces come from ends alone.
fn in_plane() -> CuttingCoefficients {
    CuttingCoefficients {
        axial_pa: 0.0,
        edge_axial_n_per_m: 0.0,
        ..aluminium()
    }
}

/// Mean force and moment while the tip is between two depths, and the volume of all chips.
fn led(cut: &mut LayeredCut, way: &[Leg], c_m: f64, depths_mm: [f64; 2]) -> ([f64; 4], f64) {
    let (mut sums, mut count, mut chips_m3) = ([0.0; 4], 0.0, 0.0);
    lead(cut, way, c_m, rigid, |cut, at, _| {
        let loads = cut.evaluate(at);
        chips_m3 += loads.removal_m3_per_rad * TAU / STEPS as f64;
        if at.place_m.z < depths_mm[0] * 1e-3 && at.place_m.z > depths_mm[1] * 1e-3 {
            let force = loads.force_on_tool_n;
            let each = [force.x, force.y, force.z, loads.moment_on_tool_n_m.z];
            sums = std::array::from_fn(|k| sums[k] + each[k]);
            count += 1.0;
        }
    });
    (sums.map(|sum| sum / count), chips_m3)
}

/// Straight down: each tooth's end is an edge of length R - a (a a hole about the axis) with a chip
/// as thick as the tool sinks by in a pitch; on a face of the block half of each turn.
#[test]
fn verify_forces_of_a_plunge() {
    for seed in 400..412 {
        let mut draw = draws(seed);
        let (r, depth, c_mm) = (draw(3.0, 6.0), draw(2.0, 5.0), draw(0.01, 0.06));
        let grid_m = draw(0.1e-3, 0.3e-3);
        let (teeth, helix) = (2 + seed as usize % 3, draw(0.0, 0.6));
        let in_hole = seed % 3 == 1;
        let x = if seed % 3 == 2 { 0.0 } else { draw(15.0, 35.0) };
        let share = if seed % 3 == 2 { 0.5 } else { 1.0 };
        let a = if in_hole { draw(0.2, 0.7) * r } else { 0.0 };
        let hole = Hole {
            centre_m: Vector2::new(x, 20.0) * 1e-3,
            radius_m: a * 1e-3,
        };
        let holes = if in_hole { vec![hole] } else { Vec::new() };
        let way = through(&[[x, 20.0, 0.4], [x, 20.0, -depth]]);
        let meant = sinking(&way, &holes, r * 1e-3, grid_m);
        let cutter = Cutter {
            helix_angle_rad: helix,
            ..centre_cutting(r * 1e-3, teeth)
        };
        let k = aluminium();
        let mut cut = cut_of(cutter, &meant, way[0].from_m);
        let whole_m3 = cut.stock().volume_m3();
        let bounds = [-0.3, -0.9 * depth];
        let (mean, chips_m3) = led(&mut cut, &way, c_mm * 1e-3, bounds);
        let (n, chip_m) = (teeth as f64 * share, c_mm * 1e-3);
        let thrust = n * (k.radial_pa * chip_m + k.edge_radial_n_per_m) * (r - a) * 1e-3;
        let per_m = k.tangential_pa * chip_m + k.edge_tangential_n_per_m;
        let torque = n * per_m * 0.5 * (r * r - a * a) * 1e-6;
        // On the grid the hole's rim is known to a node.
        let rough = if in_hole { 3e-2 } else { 5e-3 };
        assert!(
            (mean[2] / thrust - 1.0).abs() < rough,
            "{seed} {mean:?} {thrust}"
        );
        assert!(
            (mean[3].abs() / torque - 1.0).abs() < rough,
            "{seed} {mean:?} {torque}"
        );
        let exact_m3 = share * PI * (r * r - a * a) * depth * 1e-9;
        // The tool starts in air, and ends within a step of the depth.
        assert!(
            (chips_m3 / exact_m3 - 1.0).abs() < 2.0 * rough,
            "{seed} {chips_m3} {exact_m3}"
        );
        let removed_m3 = whole_m3 - cut.stock().volume_m3();
        assert!(
            (removed_m3 / exact_m3 - 1.0).abs() < 5e-3,
            "{seed} {removed_m3} {exact_m3}"
        );
        super::solid::check(cut.stock());
    }
}

/// Down a ramp along a slot: axial force is that of ends that sink by the slope's part of the feed.
/// Removed volume is the space below the flat disc, by quadrature.
#[test]
fn verify_forces_and_volume_of_a_ramp() {
    for seed in 420..426 {
        let mut draw = draws(seed);
        let (r, slope, c_mm) = (draw(3.0, 5.0), draw(0.04, 0.2), draw(0.05, 0.12));
        let (x, length) = (14.0, draw(14.0, 20.0));
        let way = through(&[[x, 20.0, 0.0], [x + length, 20.0, -slope * length]]);
        let meant = sinking(&way, &[], r * 1e-3, draw(0.15e-3, 0.3e-3));
        let cutter = centre_cutting(r * 1e-3, 2);
        let walls = Walls::new(meant.stations.clone(), cutter.radius_m);
        let k = in_plane();
        let start_m = way[0].from_m;
        let mut cut = LayeredCut::new(cutter, k, meant.stock.clone(), walls, start_m);
        let whole_m3 = cut.stock().volume_m3();
        let bounds = [-0.3 * slope * length, -0.95 * slope * length];
        let (mean, chips_m3) = led(&mut cut, &way, c_mm * 1e-3, bounds);
        let chip_m = c_mm * 1e-3 * slope / 1.0_f64.hypot(slope);
        let thrust = 2.0 * (k.radial_pa * chip_m + k.edge_radial_n_per_m) * r * 1e-3;
        assert!(
            (mean[2] / thrust - 1.0).abs() < 5e-3,
            "{seed} {} {thrust}",
            mean[2]
        );
        let exact_m3 = below_a_ramp_mm3(r, length, slope) * 1e-9;
        let removed_m3 = whole_m3 - cut.stock().volume_m3();
        let meant_m3 = whole_m3 - meant.target.volume_m3();
        for (name, found) in [
            ("chips", chips_m3),
            ("stock", removed_m3),
            ("meant", meant_m3),
        ] {
            assert!(
                (found / exact_m3 - 1.0).abs() < 1e-2,
                "{seed} {name} {found} {exact_m3}"
            );
        }
        super::solid::check(cut.stock());
        let lowest_m = meant.floor_m.unwrap().into_iter().fold(0.0, f64::min);
        assert!(
            (lowest_m + slope * length * 1e-3).abs() < 0.02e-3,
            "{lowest_m}"
        );
    }
}

/// Volume that a disc of radius r takes which sinks along its way from a face on, mm³.
fn below_a_ramp_mm3(r: f64, length: f64, slope: f64) -> f64 {
    let step = 0.01;
    let mut sum = 0.0;
    let rows = (r / step) as usize;
    for row in 0..rows {
        let y = step * (row as f64 + 0.5);
        let half = (r * r - y * y).sqrt();
        let columns = ((length + 2.0 * half) / step) as usize;
        for column in 0..columns {
            // Last place of the axis from which the disc reaches.
            let x = -half + step * (column as f64 + 0.5);
            sum += 2.0 * slope * (x + half).clamp(0.0, length) * step * step;
        }
    }
    sum
}

/// Down a helix within its own width, and once round at the bottom: a round hole.
#[test]
fn verify_volume_of_a_hole_by_helix() {
    for seed in 430..432 {
        let mut draw = draws(seed);
        let (r, depth, turns) = (draw(3.0, 5.0), draw(1.0, 2.5), 3.0);
        let a = draw(0.4, 0.8) * r;
        let mut points = Vec::new();
        // Each point lies at a depth, and so a layer, of its own.
        let count = 180;
        for k in 0..=count {
            let angle = TAU * turns * k as f64 / count as f64;
            let z = 0.1 - (0.1 + depth) * k as f64 / count as f64;
            points.push([25.0 + a * angle.cos(), 20.0 + a * angle.sin(), z]);
        }
        for [x, y] in arc_mm([25.0, 20.0], a, [0.0, TAU]) {
            points.push([x, y, -depth]);
        }
        points.dedup();
        let way = through(&points);
        let meant = sinking(&way, &[], r * 1e-3, 0.25e-3);
        let mut cut = cut_of(centre_cutting(r * 1e-3, 2), &meant, way[0].from_m);
        let whole_m3 = cut.stock().volume_m3();
        let (_, chips_m3) = led(&mut cut, &way, 0.1e-3, [0.0, -1.0]);
        let exact_m3 = PI * (r + a) * (r + a) * depth * 1e-9;
        let removed_m3 = whole_m3 - cut.stock().volume_m3();
        assert!(
            (removed_m3 / exact_m3 - 1.0).abs() < 5e-3,
            "{seed} {removed_m3} {exact_m3}"
        );
        assert!(
            (chips_m3 / exact_m3 - 1.0).abs() < 1e-2,
            "{seed} {chips_m3} {exact_m3}"
        );
    }
}

/// On a level path ends stand clear: a cutter that could plunge cuts as one that cannot.
#[test]
fn ends_do_not_cut_on_a_level_path() {
    let way = legs(&[[-8.0, 20.0], [12.0, 20.0]], -2.0);
    let [plain, other] = [false, true].map(|ends_cut| {
        let meant = follow(
            &way,
            BLOCK,
            &[],
            None,
            &Profile::flat(4e-3),
            0.3e-3,
            ends_cut,
        )
        .unwrap();
        let cutter = Cutter {
            centre_cutting: ends_cut,
            ..Cutter::straight(4e-3, 2)
        };
        let mut cut = cut_of(cutter, &meant, way[0].from_m);
        led(&mut cut, &way, 0.1e-3, [-1.0, -3.0])
    });
    assert_eq!(plain, other);
}

/// A tool on a level path whose arm swings it into the floor again and again, by more than what
/// still counts as its level: of what lies below the level each place becomes a chip once.
#[test]
fn verify_chips_of_a_tool_that_dives_into_the_floor_are_what_it_takes() {
    for seed in 70..73 {
        let mut draw = draws(seed);
        let (r_m, depth_m, grid_m) = (draw(4e-3, 6e-3), draw(0.4e-3, 2e-3), draw(0.1e-3, 0.2e-3));
        let (dive_m, revolutions) = (draw(0.15e-3, 0.4e-3), draw(2.5, 6.0));
        let way = legs(&[[-7.0, 20.0], [12.0, 20.0]], -depth_m * 1e3);
        let meant = meant(&way, &[], r_m, grid_m);
        let mut cut = cut_of(Cutter::straight(r_m, 2), &meant, way[0].from_m);
        let whole_m3 = cut.stock().volume_m3();
        let off = |rotation: f64| {
            let down = (rotation / TAU / revolutions).fract() > 0.5;
            Vector3::new(0.0, 0.0, if down { -dive_m } else { 0.0 })
        };
        let mut chips_m3 = 0.0;
        lead(&mut cut, &way, 0.1e-3, off, |cut, at, _| {
            chips_m3 += cut.evaluate(at).removal_m3_per_rad * TAU / STEPS as f64;
        });
        let stock = cut.stock();
        let size = stock.block.most_m - stock.block.least_m;
        let cells = stock.nodes().map(|count| (count - 1) as f64);
        let cell_m2 = size.x / cells[0] * size.y / cells[1];
        let below = cut.floor_m().iter().map(|z| (-depth_m - z).max(0.0));
        let dived_m3 = below.sum::<f64>() * cell_m2;
        let taken_m3 = whole_m3 - stock.volume_m3() + dived_m3;
        assert!(dived_m3 > 0.05 * taken_m3, "{seed}: it does not dive");
        let off = chips_m3 / taken_m3 - 1.0;
        assert!(off.abs() < 0.015, "{seed}: {off}");
    }
}

/// A tool on a level path whose arm swings it up from its floor and down onto it further on: of
/// what stood under it there nothing is left to become a chip at its side. Chips do not depend on
/// the grid, as what is taken by the nodes of its floor does.
#[test]
fn verify_chips_of_a_tool_that_comes_down_onto_its_floor_are_what_it_takes() {
    for seed in 80..86 {
        let mut draw = draws(seed);
        let (r_m, depth_m, grid_m) = (draw(4e-3, 6e-3), draw(1e-3, 2e-3), draw(0.1e-3, 0.2e-3));
        let (swing_m, revolutions) = (draw(0.2e-3, 0.45e-3), draw(8.0, 14.0));
        let cutter = Cutter::straight(r_m, 2);
        let way = legs(&[[-7.0, 20.0], [12.0, 20.0]], -depth_m * 1e3);
        let off = |rotation: f64| Vector3::z() * swing_m * (1.0 + (rotation / revolutions).sin());
        let [coarse, fine] = [grid_m, 0.5 * grid_m].map(|grid_m| {
            let profile = cutter.profile();
            let meant = follow(&way, BLOCK, &[], None, &profile, grid_m, false).unwrap();
            let mut cut = cut_of(cutter, &meant, way[0].from_m);
            let mut chips_m3 = 0.0;
            lead(&mut cut, &way, 0.1e-3, off, |cut, at, _| {
                chips_m3 += cut.evaluate(at).removal_m3_per_rad * TAU / STEPS as f64;
            });
            (chips_m3, taken_m3(&cut))
        });
        let off = [coarse.0 / fine.1 - 1.0, coarse.0 / fine.0 - 1.0];
        println!("{seed}: swings by {:.2} mm, {off:?} off", 2e3 * swing_m);
        assert!(off[0].abs() < 0.01, "{seed}: {off:?}");
        assert!(off[1].abs() < 0.003, "{seed}: {off:?}");
    }
}

/// What stood above the floor, by its nodes.
fn taken_m3(cut: &LayeredCut) -> f64 {
    let stock = cut.stock();
    let (size, nodes) = (stock.block.most_m - stock.block.least_m, stock.nodes());
    let cell_m2 = size.x / (nodes[0] - 1) as f64 * size.y / (nodes[1] - 1) as f64;
    // A node on the block's face stands for half a cell.
    let share = |node: usize| match node.is_multiple_of(nodes[0]) {
        true => 0.5,
        false => 1.0,
    };
    let floor = cut.floor_m().iter().enumerate();
    let each_m = floor.map(|(node, z)| share(node) * (-z).max(0.0));
    cell_m2 * each_m.sum::<f64>()
}
