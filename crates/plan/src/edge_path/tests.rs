use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, PI, TAU};

use nalgebra::Point3;

use super::*;
use crate::surface::drawn::seeded;
use crate::surface::{EdgeFault, Mesh, MeshUse};

const CREASE_RAD: f64 = PI / 6.0;

/// A ring of `count` flats about z, from z = 0 to its height, its radii at the vertices.
fn ring(radii_m: [f64; 2], height_m: f64, count: usize, place: &Isometry3<f64>) -> Mesh {
    let vertex = |i: usize| {
        let angle = TAU * (i / 4) as f64 / count as f64;
        let radius_m = radii_m[i % 2];
        let z = if i % 4 < 2 { 0.0 } else { height_m };
        place * Point3::new(radius_m * angle.cos(), radius_m * angle.sin(), z)
    };
    let vertices: Vec<Vector3<f64>> = (0..4 * count).map(|i| vertex(i).coords).collect();
    let mut triangles = Vec::new();
    for k in 0..count {
        let here = |which: usize| 4 * k + which;
        let next = |which: usize| 4 * ((k + 1) % count) + which;
        // Inner and outer below: 0 and 1, above: 2 and 3.
        for [a, b] in [[1, 3], [3, 2], [2, 0], [0, 1]] {
            triangles.push([here(a), next(a), next(b)]);
            triangles.push([here(a), next(b), here(b)]);
        }
    }
    Mesh::new(&vertices, &triangles, MeshUse::Body).expect("a ring")
}

fn laying(numbers: [f64; 4]) -> EdgeLaying {
    let [radius, indentation, lead, lift] = numbers;
    EdgeLaying {
        radius_m: 0.03 + 0.03 * radius,
        indentation_m: 1e-3 + 2e-3 * indentation,
        lead_m: 0.01 + 0.02 * lead,
        lift_m: 0.01 + 0.05 * lift,
        tilt: None,
        step_m: 2e-3,
        feed_m_per_s: 0.02,
    }
}

fn pose(point: &CamPoint) -> Isometry3<f64> {
    let Attitude::Whole(attitude) = point.attitude else {
        panic!("the attitude is free");
    };
    Isometry3::from_parts(point.place_m.into(), attitude)
}

fn drawn_place(seed: u8) -> Isometry3<f64> {
    let one = || -1.0..1.0_f64;
    let [x, y, z, a, b, c] = seeded(seed, &[one(), one(), one(), one(), one(), one()]);
    Isometry3::new(Vector3::new(x, y, z), Vector3::new(a, b, c) * 3.0)
}

/// Both upper rims of rings drawn at random, turned anyhow: the brush's axis lies along the circle,
/// its centre midway between top and wall, off the rim by the radius less the indentation, and it
/// turns counter-clockwise seen from above. On rims of many flats the circle is the closed form.
#[test]
fn verify_a_brush_follows_the_rims_of_drawn_rings() {
    let share = || 0.0..1.0_f64;
    for seed in 0..20 {
        let place = drawn_place(seed);
        let [inner, wall, height, at] = seeded(seed, &[share(), share(), share(), share()]);
        let inner_m = 0.02 + 0.03 * inner;
        let radii_m = [inner_m, inner_m + 0.01 + 0.02 * wall];
        let height_m = 0.005 + 0.02 * height;
        let mesh = ring(radii_m, height_m, 240, &place);
        let laying = laying(seeded(seed, &[share(), share(), share(), share()]));
        for (radius_m, side) in [(radii_m[0], -1.0), (radii_m[1], 1.0)] {
            let angle = TAU * at;
            let picked = Vector3::new(radius_m * angle.cos(), radius_m * angle.sin(), height_m);
            let picked_m = (place * Point3::from(picked)).coords;
            let edge = mesh.edge_at(&picked_m, CREASE_RAD).expect("a rim");
            assert!(edge.closed);
            let chords_m = 240.0 * 2.0 * radius_m * (PI / 240.0).sin();
            assert!((edge.length_m() - chords_m).abs() < 1e-9);
            let begin_m = edge.points_m[0];
            let half_chord_off_m = radius_m * (1.0 - (PI / 240.0).cos());
            assert!((begin_m - picked_m).norm() < 1.01 * half_chord_off_m);

            let path = laying.path(&[edge]).expect("a way");
            let mut turned = 0.0;
            let mut before: Option<f64> = None;
            for point in &path.points {
                let in_ring = place.inverse() * pose(point);
                let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|a| in_ring * a);
                assert!((x.cross(&y) - z).norm() < 1e-12);
                // From the tool's centre along its z to the height of the rim.
                let centre = in_ring.translation.vector;
                let away_m = (height_m - centre.z) / z.z;
                let rim = centre + z * away_m;
                let outward = Vector3::new(rim.x, rim.y, 0.0) / rim.xy().norm();
                assert!((rim.xy().norm() - radius_m).abs() < 3.0 * half_chord_off_m);
                let deepest_m = laying.radius_m - laying.indentation_m;
                let lifted_m = laying.radius_m + laying.lift_m;
                assert!(
                    away_m > deepest_m - 1e-9 && away_m < lifted_m + 1e-9,
                    "{away_m}"
                );
                let expected = (Vector3::z() + outward * side) * FRAC_1_SQRT_2;
                assert!((z + expected).norm() < 0.03, "seed {seed}: {z} {expected}");
                assert!(
                    (y - Vector3::z().cross(&outward)).norm() < 0.03,
                    "seed {seed}"
                );
                let at = rim.y.atan2(rim.x);
                turned += before.map_or(0.0, |last| (at - last + PI).rem_euclid(TAU) - PI);
                before = Some(at);
            }
            let over_m =
                laying.lead_m * (1.0 + laying.lift_m / (laying.lift_m + laying.indentation_m));
            assert!((turned - TAU - over_m / radius_m).abs() < 0.02, "{turned}");
        }
    }
}

/// Where a closed edge is gone over twice the indentations add up to the one of elsewhere.
#[test]
fn verify_the_indentation_is_the_same_all_around_a_closed_edge() {
    for seed in 0..10 {
        let share = || 0.0..1.0_f64;
        let laying = laying(seeded(seed, &[share(), share(), share(), share()]));
        let mesh = ring([0.04, 0.06], 0.01, 90, &Isometry3::identity());
        let edge = mesh.edge_at(&Vector3::new(0.06, 0.0, 0.01), CREASE_RAD);
        let edge = edge.expect("a rim");
        let length_m = edge.length_m();
        let path = laying.path(&[edge]).expect("a way");
        let depths = path.points.iter().map(|point| {
            let pose = pose(point);
            let z = pose * Vector3::z();
            let away_m = (0.01 - pose.translation.z) / z.z;
            let rim = pose.translation.vector + z * away_m;
            (
                rim.y.atan2(rim.x).rem_euclid(TAU) / TAU * length_m,
                laying.radius_m - away_m,
            )
        });
        let depths: Vec<(f64, f64)> = depths.collect();
        // As functions of the way along the edge, run over twice.
        let mut along = vec![0.0];
        for pair in depths.windows(2) {
            along.push(along[along.len() - 1] + (pair[1].0 - pair[0].0).rem_euclid(length_m));
        }
        let depth_at = |s: f64| {
            let at = along.partition_point(|x| *x <= s);
            if at == 0 || at == along.len() {
                return 0.0;
            }
            let share = (s - along[at - 1]) / (along[at] - along[at - 1]);
            let depth = depths[at - 1].1 + share * (depths[at].1 - depths[at - 1].1);
            depth.max(0.0)
        };
        for k in 0..500 {
            let s = length_m * f64::from(k) / 500.0;
            let sum_m = depth_at(s) + depth_at(s + length_m);
            let off_m = (sum_m - laying.indentation_m).abs();
            // Chords of 2 mm over points of the rim lie up to 0.05 mm off.
            assert!(off_m < 2e-4, "seed {seed}: {sum_m} at {s}");
        }
    }
}

/// An edge of a block, run over from the end that the point is nearer to, and tilted to either
/// side.
#[test]
fn verify_a_straight_edge_is_run_over_with_its_leads_and_tilt() {
    let (vertices, triangles) = crate::surface::mesh_tests::block();
    let mesh = Mesh::new(&vertices, &triangles, MeshUse::Body).expect("a block");
    let picked = Vector3::new(0.07, 0.0, 0.02);
    let edge = mesh.edge_at(&picked, CREASE_RAD).expect("an edge");
    assert!(!edge.closed && edge.points_m.len() == 2);
    let edges = [edge.clone().reversed(), edge];
    for towards in [Vector3::z_axis(), -Vector3::z_axis()] {
        let mut laying = laying([0.5; 4]);
        laying.tilt = Some(Tilt {
            angle_rad: 0.25,
            towards,
        });
        let path = laying.path(&edges).expect("a way");
        assert_eq!(path.points.len(), 8);
        let angle = FRAC_PI_4 + 0.25 * towards.z;
        let off = Vector3::new(0.0, -angle.cos(), angle.sin());
        let (deep_m, high_m) = (
            laying.radius_m - laying.indentation_m,
            laying.radius_m + laying.lift_m,
        );
        let run = [
            (-laying.lead_m, high_m),
            (-laying.lead_m, deep_m),
            (0.1 + laying.lead_m, deep_m),
            (0.1 + laying.lead_m, high_m),
        ];
        let expected = run
            .into_iter()
            .chain(run.into_iter().map(|(x, h)| (0.1 - x, h)));
        for (k, (point, (x, stands_off_m))) in path.points.iter().zip(expected).enumerate() {
            let place_m = Vector3::new(x, 0.0, 0.02) + off * stands_off_m;
            assert!(
                (point.place_m - place_m).norm() < 1e-12,
                "{k}: {}",
                point.place_m
            );
            let along = if k < 4 { Vector3::x() } else { -Vector3::x() };
            assert!((pose(point) * Vector3::y() - along).norm() < 1e-12);
            assert!((pose(point) * Vector3::z() + off).norm() < 1e-12);
            assert_eq!(
                (point.line, point.feed_m_per_s.is_none()),
                (k / 4 + 1, k % 4 == 0)
            );
        }
    }
}

#[test]
fn what_cannot_be_laid_is_refused() {
    let (vertices, triangles) = crate::surface::mesh_tests::block();
    let mesh = Mesh::new(&vertices, &triangles, MeshUse::Body).expect("a block");
    let off = mesh.edge_at(&Vector3::new(0.07, 0.001, 0.02), CREASE_RAD);
    assert!(
        matches!(off, Err(EdgeFault::OffTheEdge { away_mm, .. }) if (away_mm - 1.0).abs() < 1e-9)
    );
    let blunt = mesh.edge_at(&Vector3::new(0.07, 0.0, 0.02), 0.6 * PI);
    assert!(matches!(blunt, Err(EdgeFault::None { .. })));
    let edge = mesh.edge_at(&Vector3::new(0.07, 0.0, 0.02), CREASE_RAD);
    let edge = edge.expect("an edge");
    let mut laying = laying([0.5; 4]);
    laying.tilt = Some(Tilt {
        angle_rad: 0.25,
        towards: Vector3::x_axis(),
    });
    let refused = laying.path(std::slice::from_ref(&edge));
    assert!(matches!(refused, Err((0, EdgePathError::NoSide { .. }))));
    laying.tilt = None;
    laying.step_m = 1e-8;
    let refused = laying.path(&[edge]);
    assert!(matches!(refused, Err((0, EdgePathError::TooMany { .. }))));
    laying.step_m = 2e-3;
    let ring = ring([0.002, 0.01], 0.01, 90, &Isometry3::identity());
    let rim = ring.edge_at(&Vector3::new(0.002, 0.0, 0.01), CREASE_RAD);
    let refused = laying.path(&[rim.expect("a rim")]);
    assert!(matches!(
        refused,
        Err((0, EdgePathError::ShorterThanLead { .. }))
    ));
}
