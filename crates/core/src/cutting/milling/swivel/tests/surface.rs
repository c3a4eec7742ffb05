//! The surface of what is left.

use super::*;
use crate::cutting::milling::layered::block::Hole;
use nalgebra::Vector2;

/// Every edge lies between two triangles, once in each direction.
fn is_closed(triangles: &[[usize; 3]]) -> bool {
    let mut edges: HashMap<[usize; 2], i32> = HashMap::new();
    for [a, b, c] in triangles {
        for edge in [[*a, *b], [*b, *c], [*c, *a]] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    edges
        .iter()
        .all(|([a, b], count)| *count == 1 && edges.get(&[*b, *a]) == Some(&1))
}

/// A whole block and one with a hole: closed, and of their volumes.
#[test]
fn verify_volume_of_a_block_with_holes() {
    for seed in 240..244 {
        let mut draw = draws(seed);
        let grid_m = draw(0.2e-3, 0.4e-3);
        let hole = Hole {
            centre_m: Vector2::new(draw(12e-3, 28e-3), draw(14e-3, 16e-3)),
            radius_m: draw(4e-3, 8e-3),
        };
        for (holes, gone) in [(&[][..], 0.0), (&[hole][..], PI * hole.radius_m.powi(2))] {
            let layers = LayeredStock::new(BLOCK, holes, grid_m, &[-3e-3]);
            let surface = DistanceField::new(&layers, grid_m).surface();
            assert!(is_closed(&surface.triangles), "{seed}");
            let expected_m3 = BLOCK.volume_m3() - gone * 5e-3;
            let error = surface.volume_m3() / expected_m3 - 1.0;
            assert!(error.abs() < 1e-3, "{seed}: {error}");
        }
    }
}

/// Slots of balls along x, however they lean: what lies below a face of a cylinder, closed form.
#[test]
fn verify_volume_of_slots_of_leaning_balls() {
    for seed in 250..254 {
        let mut draw = draws(seed);
        let profile = Profile::ball(draw(3e-3, 5e-3));
        let axes = leaning(draw(-0.4, 0.4), draw(-0.3, 0.3));
        let (r, depth_m) = (profile.radius_m, draw(0.5e-3, 2.5e-3));
        let middle_mm = (r - depth_m) * 1e3;
        let at = |x_mm: f64| {
            let tip = Vector3::new(x_mm, 15.0, middle_mm) - axes * (Vector3::z() * r * 1e3);
            pose(tip.into(), axes)
        };
        let meant = follow(&[leg(at(-8.0), at(48.0))], stock(0.2e-3), &profile).unwrap();
        let [whole, left] = [&meant.stock, &meant.target].map(|one| one.surface());
        assert!(is_closed(&left.triangles), "{seed}");
        let half = ((r - depth_m) / r).acos();
        let segment_m2 = r * r * (half - half.sin() * half.cos());
        let error = (whole.volume_m3() - left.volume_m3()) / (segment_m2 * 40e-3) - 1.0;
        println!("{seed}: {error:.2e}");
        assert!(error.abs() < 5e-3, "{seed}: {error}");
    }
}

/// What is left of a part cut too little is told along its normal, on a slope too.
#[test]
fn verify_what_is_left_is_told_along_the_normal() {
    let (profile, axes) = (Profile::flat(4e-3), leaning(0.25, 0.2));
    let cut = |off_m: f64| {
        let at = |x_mm: f64| {
            let up = axes * (Vector3::z() * off_m);
            let mut pose = pose([x_mm, 15.0, -1.5], axes);
            pose.translation.vector += up;
            pose
        };
        let meant = follow(&[leg(at(-10.0), at(50.0))], stock(0.2e-3), &profile);
        meant.unwrap()
    };
    let (meant, higher) = (cut(0.0), cut(30e-6).target);
    let mut left: Vec<f64> = Vec::new();
    for place in &higher.surface().places_m {
        // At its ends an ellipse is bent too much for the grid.
        if (10e-3..30e-3).contains(&place.x)
            && (place.y - 15e-3).abs() < 3e-3
            && let Some(one) = meant.left_m(place)
        {
            left.push(one);
        }
    }
    // Walls move along themselves, the trough of the rim, a part of an ellipse, mostly upwards;
    // where cells have nodes that are cut and not beside one that is not, to some of the grid.
    let most = left.iter().copied().fold(0.0, f64::max);
    let least = left.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(
        left.len() > 2000 && most < 38e-6 && least > -3e-6,
        "{most} {least}"
    );
    let floor = left.iter().filter(|left| **left > 25e-6).count();
    assert!(floor > left.len() / 3, "{floor} of {}", left.len());
}

/// An error beyond what is known counts as that much; faces that the stock had before do not count.
#[test]
fn what_is_far_off_counts_and_what_was_there_before_does_not() {
    let (profile, grid_m) = (Profile::flat(4e-3), 0.3e-3);
    let hole = Hole {
        centre_m: Vector2::new(20e-3, 15e-3),
        radius_m: 2e-3,
    };
    let cut = |z_mm: f64| {
        let layers = LayeredStock::new(BLOCK, &[hole], grid_m, &[]);
        let at = |x_mm: f64| pose([x_mm, 15.0, z_mm], leaning(0.1, 0.0));
        let way = leg(at(-10.0), at(50.0));
        follow(&[way], DistanceField::new(&layers, grid_m), &profile).unwrap()
    };
    let meant = cut(-1.5);
    // Within what is cut distances are those from a body's faces, by down to 1/√2 short.
    for (z_mm, least, most) in [(-3.0, -0.76e-3, -0.7e-3), (-0.5, 0.7e-3, 1.1e-3)] {
        let mut floor = 0;
        for place in &cut(z_mm).target.surface().places_m {
            let Some(left_m) = meant.left_m(place) else {
                continue;
            };
            let off = place.xy() - hole.centre_m;
            assert!(
                off.norm() > hole.radius_m - 0.1e-3,
                "{place} lies in the hole"
            );
            if (place.y - 15e-3).abs() < 1e-3 && off.norm() > hole.radius_m + 1e-3 {
                assert!(
                    (least..most).contains(&left_m),
                    "{z_mm}: {left_m} at {place}"
                );
                floor += 1;
            }
        }
        assert!(floor > 300, "{floor}");
    }
}
