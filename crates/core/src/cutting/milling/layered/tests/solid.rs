//! The surface of what is left, as a solid.

use super::super::outline::{Facing, Triangle};
use super::super::stock::LayeredStock;
use super::*;
use std::collections::{BTreeMap, BTreeSet};

/// A vertex as a mesh file has it: millimetres in single precision.
type Vertex = [u32; 3];

fn vertex(corner_m: &Vector3<f64>) -> Vertex {
    // Adding 0 makes -0 the same place as 0.
    [corner_m.x, corner_m.y, corner_m.z].map(|x| (1e3 * x as f32 + 0.0).to_bits())
}

fn volume_m3(surface: &[Triangle]) -> f64 {
    let apex = surface.first().map_or(Vector3::zeros(), |t| t.corners_m[0]);
    let each = surface.iter().map(|triangle| {
        let [a, b, c] = triangle.corners_m.map(|corner| corner - apex);
        a.dot(&b.cross(&c)) / 6.0
    });
    each.sum()
}

/// Each edge is gone along once each way, each vertex has one ring of triangles about it, and the
/// volume is that of the grid.
pub(super) fn check(stock: &LayeredStock) {
    let surface = stock.surface();
    let mut ways = BTreeSet::new();
    let mut rings: BTreeMap<Vertex, BTreeMap<Vertex, Vertex>> = BTreeMap::new();
    for triangle in &surface {
        let corners = triangle.corners_m.map(|corner| vertex(&corner));
        for k in 0..3 {
            let [at, next, last] = [0, 1, 2].map(|step| corners[(k + step) % 3]);
            assert_ne!(at, next, "{triangle:?}");
            assert!(
                ways.insert((at, next)),
                "an edge of two solids: {triangle:?}"
            );
            rings.entry(at).or_default().insert(next, last);
        }
        let [a, b, c] = triangle.corners_m;
        let normal = (b - a).cross(&(c - a)).normalize();
        let up = match triangle.facing {
            Facing::Floor => 1.0,
            Facing::Under => -1.0,
            Facing::Wall { .. } => 0.0,
        };
        assert!((normal.z - up).abs() < 1e-9, "{triangle:?}");
    }
    for (from, to) in &ways {
        assert!(
            ways.contains(&(*to, *from)),
            "an open edge: {from:?} {to:?}"
        );
    }
    for (at, ring) in &rings {
        let first = *ring.keys().next().unwrap();
        let (mut gone, mut next) = (1, ring[&first]);
        while next != first {
            next = ring[&next];
            gone += 1;
        }
        assert_eq!(gone, ring.len(), "two solids touch at {at:?}");
    }
    let (mesh_m3, grid_m3) = (volume_m3(&surface), stock.volume_m3());
    assert!(
        (mesh_m3 - grid_m3).abs() <= 1e-9 * stock.block.volume_m3(),
        "{mesh_m3} {grid_m3}"
    );
}

/// No triangle is so small or so low that programs which read meshes take it for a defect.
fn check_shapes(stock: &LayeredStock) {
    let diagonal_m = (stock.block.most_m - stock.block.least_m).norm();
    for triangle in stock.surface() {
        let [a, b, c] = triangle.corners_m;
        let longest_m = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let height_m = (b - a).cross(&(c - a)).norm() / longest_m;
        assert!(longest_m > 1e-4 * diagonal_m, "{longest_m} {triangle:?}");
        assert!(height_m > 1e-6 * diagonal_m, "{height_m} {triangle:?}");
    }
}

/// Blocks cut by drawn legs at one to four depths: slots, pockets, islands, through the block, on
/// lines of the grid and off them, corners that touch.
#[test]
fn drawn_stock_is_left_as_a_solid() {
    for seed in 100..140 {
        let mut draw = draws(seed);
        let grid_mm = [0.25, 0.4, draw(0.2, 0.6)][seed as usize % 3];
        let r = draw(2.0, 6.0);
        let radius_mm = if seed % 2 == 0 {
            (r / grid_mm).round() * grid_mm
        } else {
            r
        };
        let on_grid = seed % 4 < 2;
        let snap = |x: f64| {
            if on_grid {
                (x / grid_mm).round() * grid_mm
            } else {
                x
            }
        };
        let depths: Vec<f64> = (0..1 + seed % 4)
            .map(|k| if k == 3 { -10.0 } else { -draw(0.05, 9.0) })
            .collect();
        let mut way = Vec::new();
        for depth in depths {
            let points: Vec<[f64; 2]> = (0..2 + seed % 5)
                .map(|_| [snap(draw(-8.0, 58.0)), snap(draw(-8.0, 48.0))])
                .collect();
            // Every other leg along an axis.
            let mut bent = vec![points[0]];
            for pair in points.windows(2) {
                if draw(0.0, 1.0) < 0.7 {
                    bent.push([pair[1][0], pair[0][1]]);
                }
                bent.push(pair[1]);
            }
            way.extend(legs(&bent, depth));
        }
        let hole = Hole {
            centre_m: Vector2::new(snap(draw(5.0, 45.0)), snap(draw(5.0, 35.0))) * 1e-3,
            radius_m: radius_mm * 1e-3,
        };
        let depths: Vec<f64> = way.iter().map(|leg| leg.from_m.z).collect();
        let mut stock = LayeredStock::new(BLOCK, &[hole], grid_mm * 1e-3, &depths);
        for leg in &way {
            stock.cut_leg(
                [leg.from_m, leg.to_m],
                &Profile::flat(radius_mm * 1e-3),
                false,
            );
        }
        check(&stock);
        check_shapes(&stock);
    }
}

/// What teeth that vibrate leave in layers, each with its own helix, and outlines that end on
/// nodes, touch at corners and cross from layer to layer: distances drawn node by node.
#[test]
fn any_distances_on_the_grid_are_a_solid() {
    let small = Block {
        least_m: Vector3::new(-0.71, 0.33, -3e-3),
        most_m: Vector3::new(-0.71 + 6e-3, 0.33 + 4e-3, 0.0),
    };
    for seed in 200..260 {
        let mut draw = draws(seed);
        let mut stock = LayeredStock::new(small, &[], 0.5e-3, &[-1e-3, -2e-3]);
        let count = stock.nodes()[0] * stock.nodes()[1];
        let common: Vec<f64> = (0..count).map(|_| draw(-1e-3, 1e-3)).collect();
        for layer in stock.layers_mut() {
            for (value, common) in layer.values_mut().iter_mut().zip(&common) {
                *value = match draw(0.0, 4.0) as usize {
                    0 => *common,
                    1 => common + draw(-2e-6, 2e-6),
                    2 => [0.0, -0.0, 1e-18, -1e-18, 1e-7][draw(0.0, 5.0) as usize],
                    _ => draw(-1e-3, 1e-3),
                };
            }
        }
        check(&stock);
    }
}

/// The outline of a straight slot lies where the slot does, to the lattice's step.
#[test]
fn verify_volume_of_a_solid_with_a_slot() {
    for seed in 300..306 {
        let mut draw = draws(seed);
        let (r, y, depth) = (draw(2.0, 6.0), draw(12.0, 28.0), draw(0.5, 9.0));
        let leg = legs(&[[-10.0, y], [60.0, y]], -depth);
        let mut stock = LayeredStock::new(BLOCK, &[], 0.3e-3, &[-depth * 1e-3]);
        stock.cut_leg(
            [leg[0].from_m, leg[0].to_m],
            &Profile::flat(r * 1e-3),
            false,
        );
        check(&stock);
        let exact_m3 = BLOCK.volume_m3() - 2.0 * r * depth * 50e-9;
        // Two walls, each off by half a step of a hundred thousandth of the diagonal.
        let step_mm = 1e-5 * (50.0_f64.powi(2) + 40.0 * 40.0 + 100.0).sqrt();
        let off_m3 = (stock.volume_m3() - exact_m3).abs();
        assert!(off_m3 <= step_mm * depth * 50e-9, "{seed}: {off_m3}");
    }
}
