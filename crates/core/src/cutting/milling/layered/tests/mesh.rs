//! Stock from a closed mesh.

use super::super::solid::{Solid, SolidFault};
use super::super::stock::LayeredStock;
use super::*;

/// A body between levels with a polygon each, from below; the upper one of two levels at one height
/// is a step.
fn body(levels: &[(f64, Vec<[f64; 2]>)]) -> Vec<[Vector3<f64>; 3]> {
    let at = |(z, ring): &(f64, Vec<[f64; 2]>), k: usize| {
        let [x, y] = ring[k % ring.len()];
        Vector3::new(x, y, *z)
    };
    let (first, last) = (&levels[0], &levels[levels.len() - 1]);
    let mut triangles = Vec::new();
    for k in 1..first.1.len() - 1 {
        triangles.push([at(first, 0), at(first, k + 1), at(first, k)]);
        triangles.push([at(last, 0), at(last, k), at(last, k + 1)]);
    }
    for pair in levels.windows(2) {
        for k in 0..pair[0].1.len() {
            let [a, b] = [at(&pair[0], k), at(&pair[0], k + 1)];
            let [c, d] = [at(&pair[1], k), at(&pair[1], k + 1)];
            triangles.push([a, b, d]);
            triangles.push([a, d, c]);
        }
    }
    triangles
}

/// A polygon about a place, its first corner turned.
fn ring(centre: [f64; 2], radius: f64, corners: usize, turned: f64) -> Vec<[f64; 2]> {
    let at = |k: usize| {
        let (sin, cos) = (turned + TAU * k as f64 / corners as f64).sin_cos();
        [centre[0] + radius * cos, centre[1] + radius * sin]
    };
    (0..corners).map(at).collect()
}

fn polygon_m2(radius: f64, corners: usize) -> f64 {
    0.5 * corners as f64 * radius * radius * (TAU / corners as f64).sin()
}

fn filled(solid: &Solid, grid_m: f64) -> LayeredStock {
    let depths = solid.depths_m(grid_m);
    let mut stock = LayeredStock::new(solid.block(grid_m), &[], grid_m, &depths);
    stock.keep_within(solid);
    stock
}

#[test]
fn verify_stepped_and_tapered_bodies_have_their_volume() {
    let mut draw = draws(29);
    for _ in 0..6 {
        let corners = draw(5.0, 90.0) as usize;
        let (wide, narrow) = (draw(15e-3, 25e-3), draw(6e-3, 12e-3));
        let (step, height) = (draw(2e-3, 6e-3), draw(2e-3, 6e-3));
        let (middle, turned) = ([draw(-0.1, 0.1), draw(-0.1, 0.1)], draw(0.0, TAU));
        let at = |radius| ring(middle, radius, corners, turned);
        let (low, high) = (polygon_m2(wide, corners), polygon_m2(narrow, corners));
        let upright = [
            (0.0, at(wide)),
            (step, at(wide)),
            (step, at(narrow)),
            (step + height, at(narrow)),
        ];
        let tapered = [(0.0, at(wide)), (step + height, at(narrow))];
        let frustum_m3 = (step + height) / 3.0 * (low + high + (low * high).sqrt());
        for (levels, exact_m3) in [
            (&upright[..], low * step + high * height),
            (&tapered[..], frustum_m3),
        ] {
            let solid = Solid::new(body(levels)).unwrap();
            let stock = filled(&solid, 0.3e-3);
            super::solid::check(&stock);
            let share = stock.volume_m3() / exact_m3 - 1.0;
            assert!(share.abs() < 1e-3, "{corners} corners: {share}");
        }
    }
}

#[test]
fn regress_a_box_as_a_mesh_is_cut_as_the_block_is() {
    let mut draw = draws(30);
    let (r, depth) = (draw(3e-3, 5e-3), draw(1.0, 4.0));
    let grid_m = r * 0.05;
    let corners = vec![[0.0, 0.0], [50e-3, 0.0], [50e-3, 40e-3], [0.0, 40e-3]];
    let solid = Solid::new(body(&[(-10e-3, corners.clone()), (0.0, corners)])).unwrap();
    let way = legs(&[[-8.0, 17.0], [30.0, 17.0], [30.0, 60.0]], -depth);
    let block = solid.block(grid_m);
    let of_mesh = follow(
        &way,
        block,
        &[],
        Some(&solid),
        &Profile::flat(r),
        grid_m,
        false,
    )
    .unwrap();
    let of_block = meant(&way, &[], r, grid_m);
    super::solid::check(&of_mesh.target);
    let removed = |one: &Meant| one.stock.volume_m3() - one.target.volume_m3();
    let share = removed(&of_mesh) / removed(&of_block) - 1.0;
    assert!(share.abs() < 2e-3, "{share}");
    assert_eq!(of_mesh.stock.layers().len(), of_block.stock.layers().len());
}

#[test]
fn verify_a_plunge_beside_a_step_begins_at_the_lower_face() {
    // The lower face lies at -3 mm, the upper one of the middle at 0.
    let (wide, narrow) = (
        ring([0.0, 0.0], 30e-3, 40, 0.1),
        ring([0.0, 0.0], 8e-3, 40, 0.1),
    );
    let levels = [
        (-9e-3, wide.clone()),
        (-3e-3, wide),
        (-3e-3, narrow.clone()),
        (0.0, narrow),
    ];
    let solid = Solid::new(body(&levels)).unwrap();
    let at = |z: f64| Vector3::new(18e-3, 0.0, z);
    let way = [Leg {
        from_m: at(2e-3),
        to_m: at(-5e-3),
        rapid: false,
        point: 1,
    }];
    let block = solid.block(0.3e-3);
    let meant = follow(
        &way,
        block,
        &[],
        Some(&solid),
        &Profile::flat(4e-3),
        0.3e-3,
        true,
    )
    .unwrap();
    let cutter = sinking::centre_cutting(4e-3, 2);
    let walls = Walls::new(Vec::new(), cutter.radius_m);
    let cut = LayeredCut::new(cutter, aluminium(), meant.stock, walls, at(2e-3));
    let force_n = |tip_m: f64| {
        let place = ToolPlace {
            rotation_rad: 1.0,
            place_m: at(tip_m),
            sinks: true,
            ..ToolPlace::default()
        };
        cut.evaluate(&place).force_on_tool_n.norm()
    };
    for above_m in [-0.1e-3, -1e-3, -2.9e-3] {
        assert_eq!(force_n(above_m), 0.0, "{above_m}");
    }
    assert!(force_n(-3.05e-3) > 1.0);
}

#[test]
fn verify_an_undercut_is_refused_where_it_is() {
    let (wide, narrow) = (
        ring([0.0, 0.0], 20e-3, 12, 0.0),
        ring([0.0, 0.0], 10e-3, 12, 0.0),
    );
    let levels = [
        (0.0, narrow.clone()),
        (4e-3, narrow),
        (4e-3, wide.clone()),
        (9e-3, wide),
    ];
    let SolidFault::Undercut { at_m } = Solid::new(body(&levels)).unwrap_err();
    assert!((at_m.z - 4e-3).abs() < 1e-12 && (9e-3..21e-3).contains(&at_m.xy().norm()));
}
