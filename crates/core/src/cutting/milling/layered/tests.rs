use super::block::{Block, Hole};
use super::cut::{LayeredCut, ToolPlace};
use super::walls::Walls;
use super::way::{Leg, Meant, WayFault, follow};
use crate::cutting::milling::cutter::Cutter;
use crate::cutting::milling::examples::aluminium;
use crate::cutting::milling::profile::Profile;
use nalgebra::{Vector2, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

mod mesh;
mod round;
mod sinking;
mod solid;
mod straight;

const BLOCK: Block = Block {
    least_m: Vector3::new(0.0, 0.0, -10e-3),
    most_m: Vector3::new(50e-3, 40e-3, 0.0),
};
/// Steps of a revolution.
const STEPS: usize = 120;

fn draws(seed: u64) -> impl FnMut(f64, f64) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move |low, high| Uniform::new(low, high).unwrap().sample(&mut random)
}

/// Legs through points (mm) at one depth, the first in air.
fn legs(points_mm: &[[f64; 2]], depth_mm: f64) -> Vec<Leg> {
    let at = |p: &[f64; 2]| Vector3::new(p[0], p[1], depth_mm) * 1e-3;
    let pairs = points_mm.windows(2).enumerate();
    pairs
        .map(|(k, pair)| Leg {
            from_m: at(&pair[0]),
            to_m: at(&pair[1]),
            rapid: false,
            point: k + 1,
        })
        .collect()
}

/// Points of an arc in chords of 0.5 um, mm.
fn arc_mm(centre: [f64; 2], radius: f64, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
    let count = ((to - from).abs() / (8.0 * 0.5e-3 / radius).sqrt()).ceil();
    let at = |k: usize| from + (to - from) * k as f64 / count;
    (0..=count as usize)
        .map(|k| {
            let (sin, cos) = at(k).sin_cos();
            [centre[0] + radius * cos, centre[1] + radius * sin]
        })
        .collect()
}

fn meant(legs: &[Leg], holes: &[Hole], radius_m: f64, grid_m: f64) -> Meant {
    follow(
        legs,
        BLOCK,
        holes,
        None,
        &Profile::flat(radius_m),
        grid_m,
        false,
    )
    .unwrap()
}

/// Leads a tool along legs; `off` is its displacement by rotation, `each` sees every state before
/// it is committed, with the direction of the feed.
fn lead(
    cut: &mut LayeredCut,
    legs: &[Leg],
    feed_per_tooth_m: f64,
    off: impl Fn(f64) -> Vector3<f64>,
    mut each: impl FnMut(&mut LayeredCut, &ToolPlace, Vector2<f64>),
) {
    let step_m = feed_per_tooth_m * cut.cutter.teeth as f64 / STEPS as f64;
    let whole_m: f64 = legs.iter().map(|leg| (leg.to_m - leg.from_m).norm()).sum();
    let (mut leg, mut begun_m) = (0, 0.0);
    for k in 0..(whole_m / step_m) as usize {
        let way_m = step_m * k as f64;
        let length = |leg: usize| (legs[leg].to_m - legs[leg].from_m).norm();
        while way_m > begun_m + length(leg) && leg + 1 < legs.len() {
            begun_m += length(leg);
            leg += 1;
        }
        let along = (legs[leg].to_m - legs[leg].from_m) / length(leg);
        let rotation_rad = TAU * k as f64 / STEPS as f64;
        let at = ToolPlace {
            rotation_rad,
            place_m: legs[leg].from_m + along * (way_m - begun_m) + off(rotation_rad),
            sinks: along.z < -1e-6,
            ..ToolPlace::default()
        };
        each(cut, &at, along.xy());
        cut.commit(&at);
    }
    cut.finish();
}

fn rigid(_: f64) -> Vector3<f64> {
    Vector3::zeros()
}

fn cut_of(cutter: Cutter, meant: &Meant, start_m: Vector3<f64>) -> LayeredCut {
    let walls = Walls::new(meant.stations.clone(), cutter.radius_m);
    LayeredCut::new(cutter, aluminium(), meant.stock.clone(), walls, start_m)
}

/// Straight along a face, radial depths drawn: acos(1 - a/r).
#[test]
fn verify_immersion_of_a_straight_cut() {
    for seed in 0..6 {
        let mut draw = draws(seed);
        let (radius_mm, grid_m) = (draw(4.0, 8.0), draw(0.1e-3, 0.45e-3));
        let radial_mm = draw(0.1, 1.9) * radius_mm;
        let y_mm = radial_mm - radius_mm;
        let way = legs(&[[-10.0, y_mm], [14.0, y_mm]], -2.0);
        let meant = meant(&way, &[], radius_mm * 1e-3, grid_m);
        let mut cut = cut_of(Cutter::straight(radius_mm * 1e-3, 2), &meant, way[0].from_m);
        let expected = (1.0 - radial_mm / radius_mm).acos();
        let mut seen = 0;
        lead(&mut cut, &way, 0.1e-3, rigid, |cut, at, feed| {
            if at.place_m.x > 12e-3 && (at.rotation_rad % 1.0) < 0.1 {
                let found = cut.immersion(at, &feed).unwrap();
                assert!(
                    (found.engaged_rad / expected - 1.0).abs() < 5e-3,
                    "{seed} {found:?}"
                );
                assert!(
                    found.entry_rad < 1e-3,
                    "up-milling enters at its wall: {found:?}"
                );
                seen += 1;
            }
        });
        assert!(seen > 10);
    }
}

/// A slot that turns by a right angle: s behind the corner the rim has left what the first leg cut,
/// pi - asin(1 - s/r).
#[test]
fn verify_immersion_behind_a_corner_of_a_slot() {
    for seed in 10..14 {
        let mut draw = draws(seed);
        let (radius_mm, grid_m) = (draw(4.0, 7.0), draw(0.1e-3, 0.4e-3));
        let (x, y) = (draw(18.0, 25.0), draw(12.0, 16.0));
        let way = legs(&[[-10.0, y], [x, y], [x, y + 1.5 * radius_mm]], -1.0);
        let meant = meant(&way, &[], radius_mm * 1e-3, grid_m);
        let mut cut = cut_of(Cutter::straight(radius_mm * 1e-3, 2), &meant, way[0].from_m);
        let mut seen = 0;
        lead(&mut cut, &way, 0.2e-3, rigid, |cut, at, feed| {
            let s = (at.place_m.y * 1e3 - y) / radius_mm;
            if s > 0.15 && s < 0.95 && (at.rotation_rad % 0.7) < 0.06 {
                let found = cut.immersion(at, &feed).unwrap().engaged_rad;
                let expected = PI - (1.0 - s).asin();
                assert!(
                    (found / expected - 1.0).abs() < 5e-3,
                    "{s}: {found} {expected}"
                );
                seen += 1;
            }
        });
        assert!(seen > 20, "{seen}");
    }
}

/// On a circle within a round hole that it widens: by the law of cosines.
#[test]
fn verify_immersion_on_an_arc() {
    for seed in 20..24 {
        let mut draw = draws(seed);
        let (r, grid_m) = (draw(4.0, 6.0), draw(0.1e-3, 0.35e-3));
        let hole_mm = r + draw(2.0, 5.0);
        let path_mm = hole_mm - r + draw(0.3, 1.5) * r.min(hole_mm - 1.0) * 0.5;
        let middle = [25.0, 20.0];
        let hole = Hole {
            centre_m: Vector2::new(25e-3, 20e-3),
            radius_m: hole_mm * 1e-3,
        };
        let mut points = vec![[25.0, 20.0]];
        points.extend(arc_mm(middle, path_mm, [0.0, 2.5]));
        let way = legs(&points, -3.0);
        let meant = meant(&way, &[hole], r * 1e-3, grid_m);
        let mut cut = cut_of(Cutter::straight(r * 1e-3, 3), &meant, way[0].from_m);
        let cosine = (hole_mm * hole_mm - path_mm * path_mm - r * r) / (2.0 * path_mm * r);
        let mut seen = 0;
        lead(&mut cut, &way, 0.1e-3, rigid, |cut, at, _| {
            let from = at.place_m.xy() - hole.centre_m;
            let turned = from.y.atan2(from.x);
            if turned > 1.4 && turned < 2.45 && (at.rotation_rad % 1.0) < 0.06 {
                // Along the circle, not along the chord.
                let feed = Vector2::new(-from.y, from.x).normalize();
                let found = cut.immersion(at, &feed).unwrap();
                let expected = cosine.acos();
                assert!(
                    (found.engaged_rad / expected - 1.0).abs() < 5e-3,
                    "{seed}: {found:?} {expected}"
                );
                seen += 1;
            }
        });
        assert!(seen > 10, "{seen}");
    }
}

/// A slot that ends in the block: the exact solid, by the stock, by the chips and as the path means
/// it.
#[test]
fn verify_removed_volume_of_slots_and_by_chips() {
    for seed in 30..34 {
        let mut draw = draws(seed);
        let (r, grid_m) = (draw(4.0, 7.0), draw(0.15e-3, 0.5e-3));
        let (depth, length) = (draw(0.5, 4.0), draw(12.0, 25.0));
        let way = legs(&[[-8.0, 20.0], [length, 20.0]], -depth);
        let meant = meant(&way, &[], r * 1e-3, grid_m);
        let cutter = Cutter {
            helix_angle_rad: draw(0.0, 0.7),
            ..Cutter::straight(r * 1e-3, 2)
        };
        let mut cut = cut_of(cutter, &meant, way[0].from_m);
        let mut chips_m3 = 0.0;
        let whole_m3 = cut.stock().volume_m3();
        assert!((whole_m3 / BLOCK.volume_m3() - 1.0).abs() < 1e-12);
        lead(&mut cut, &way, 0.1e-3, rigid, |cut, at, _| {
            chips_m3 += cut.evaluate(at).removal_m3_per_rad * TAU / STEPS as f64;
        });
        let exact_m3 = (2.0 * r * length + FRAC_PI_2 * r * r) * depth * 1e-9;
        let removed_m3 = whole_m3 - cut.stock().volume_m3();
        assert!(
            (removed_m3 / exact_m3 - 1.0).abs() < 5e-3,
            "{removed_m3} {exact_m3}"
        );
        assert!(
            (chips_m3 / exact_m3 - 1.0).abs() < 5e-3,
            "{chips_m3} {exact_m3}"
        );
        let meant_m3 = whole_m3 - meant.target.volume_m3();
        assert!(
            (meant_m3 / exact_m3 - 1.0).abs() < 5e-3,
            "{meant_m3} {exact_m3}"
        );
    }
}

/// A square pocket ring, its inner corners round: outside a square with round corners, inside an
/// island with sharp ones.
#[test]
fn verify_removed_volume_of_a_ring() {
    for (seed, depths) in [(40, vec![-2.0]), (41, vec![-1.5, -3.0])] {
        let mut draw = draws(seed);
        let (r, a) = (draw(3.0, 4.0), draw(18.0, 22.0));
        let (x, y) = (25.0 - 0.5 * a, 20.0 - 0.5 * a);
        let hole = Hole {
            centre_m: Vector2::new(x, y) * 1e-3,
            radius_m: 1.02e-3 * r,
        };
        let mut way = Vec::new();
        let mut before: Option<Vector3<f64>> = None;
        for depth in &depths {
            let round = legs(
                &[[x, y], [x + a, y], [x + a, y + a], [x, y + a], [x, y]],
                *depth,
            );
            if let Some(from_m) = before {
                way.push(Leg {
                    from_m,
                    to_m: round[0].from_m,
                    rapid: false,
                    point: 0,
                });
            }
            before = round.last().map(|leg| leg.to_m);
            way.extend(round);
        }
        let meant = meant(&way, &[hole], r * 1e-3, 0.25e-3);
        let mut cut = cut_of(Cutter::straight(r * 1e-3, 2), &meant, way[0].from_m);
        let whole_m3 = cut.stock().volume_m3();
        lead(&mut cut, &way, 0.2e-3, rigid, |_, _, _| {});
        let outer = (a + 2.0 * r).powi(2) - (4.0 - PI) * r * r;
        let in_hole = 1.02 * 1.02 * r * r * PI;
        // Of the hole what lies outside of the ring's corner.
        let ring = outer - (a - 2.0 * r).powi(2) - in_hole + outside_corner(r, 1.02 * r);
        let exact_m3 = ring * depths.last().unwrap().abs() * 1e-9;
        let removed_m3 = whole_m3 - cut.stock().volume_m3();
        assert!(
            (removed_m3 / exact_m3 - 1.0).abs() < 5e-3,
            "{removed_m3} {exact_m3}"
        );
        solid::check(cut.stock());
    }
}

/// A tool that does not vibrate leaves walls where the path means them, in corners, too: but for
/// feed marks and the grid's own error no station has more or less.
#[test]
fn verify_walls_of_a_rigid_tool_about_corners() {
    for (seed, grid_m) in [(44, 0.4e-3), (45, 0.2e-3)] {
        let mut draw = draws(seed);
        let (r, a) = (draw(4.0, 5.0), draw(16.0, 20.0));
        let way = legs(
            &[[-8.0, 10.0], [a, 10.0], [a, 10.0 + a], [14.0, 10.0 + a]],
            -2.0,
        );
        let meant = meant(&way, &[], r * 1e-3, grid_m);
        let mut cut = cut_of(Cutter::straight(r * 1e-3, 2), &meant, way[0].from_m);
        lead(&mut cut, &way, 0.1e-3, rigid, |_, _, _| {});
        let most_m = 0.55 * grid_m * grid_m / (r * 1e-3) + 0.5e-6;
        let mut seen = 0;
        for (station, left_m) in cut.walls().left_m() {
            if left_m.is_finite() {
                assert!(left_m.abs() < most_m, "{seed}: {left_m} {station:?}");
                seen += 1;
            }
        }
        assert!(seen > 100, "{seen}");
    }
}

/// Area of a disc of radius R about the corner of the path that its cutter of radius r, there and
/// on both legs, does not cover: by polar angle in the quarter beyond the corner.
fn outside_corner(r: f64, large: f64) -> f64 {
    let quarter = 0.25 * PI * (large * large - r * r);
    // Beside each leg, beyond the cutter's rim: half a segment of the disc.
    let angle = (r / large).acos();
    let half_segment = 0.5 * large * large * angle - 0.5 * r * (large * large - r * r).sqrt();
    quarter + 2.0 * half_segment
}

/// What a cutter cannot do is told at its point of the path.
#[test]
fn paths_that_cannot_be_cut_are_refused() {
    let r_m = 5e-3;
    let flat = Profile::flat(r_m);
    let refused = |legs: &[Leg]| follow(legs, BLOCK, &[], None, &flat, 0.5e-3, false).unwrap_err();
    let mut way = legs(&[[-10.0, 20.0], [10.0, 20.0], [20.0, 20.0]], -1.0);
    way[1].rapid = true;
    assert!(matches!(refused(&way), WayFault::Rapid { point: 2, .. }));
    let mut way = legs(&[[-10.0, 20.0], [10.0, 20.0], [10.0, 20.0]], -1.0);
    way[1].to_m.z = -2e-3;
    assert!(matches!(refused(&way), WayFault::Plunge { point: 2, .. }));
    assert_eq!(
        refused(&legs(&[[5.0, 5.0], [9.0, 5.0]], -1.0)),
        WayFault::StartsInStock
    );
    assert_eq!(
        refused(&legs(&[[-10.0, -9.0], [40.0, -9.0]], -1.0)),
        WayFault::Misses
    );
    let far = legs(&[[-10.0, 20.0], [120.0, 20.0]], -1.0);
    assert!(matches!(refused(&far), WayFault::Beyond { point: 1, .. }));
}
