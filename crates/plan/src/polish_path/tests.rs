use super::*;
use crate::cam::Attitude;
use crate::surface::cylinder::CylinderPatch;
use crate::surface::drawn::{heights, patch as drawn_patch, seeded};
use crate::surface::{PlanePatch, Surface};

const LAYING: PolishLaying = PolishLaying {
    radius_m: 20e-3,
    indentation_m: 0.4e-3,
    tilt_rad: 0.35,
    turn_rad_s: 3.0,
    start_rad: 0.4,
    spacing_m: 3e-3,
    contact_m: 3e-3,
    inset_m: 5e-3,
    step_m: 2e-3,
    lift_m: 12e-3,
    feed_m_per_s: 15e-3,
};

fn face(surface: impl Surface + Send + 'static, boundary: Option<Boundary>) -> PatchFile {
    PatchFile {
        surface: Box::new(surface),
        boundary,
        fit: None,
    }
}

fn bar(radius_m: f64) -> PatchFile {
    let (axis, zero) = (Vector3::y_axis(), Vector3::z_axis());
    let bar = CylinderPatch::new(Vector3::zeros(), axis, zero, radius_m, [-0.6, 0.6], 0.06);
    face(bar, None)
}

fn plane(boundary: Option<Boundary>) -> PatchFile {
    let sides = [Vector3::x() * 0.1, Vector3::y() * 0.06];
    face(
        PlanePatch::new(Vector3::zeros(), sides[0], sides[1]).unwrap(),
        boundary,
    )
}

fn laid(laying: &PolishLaying, patch: &PatchFile) -> PolishPath {
    laying.path(patch).unwrap_or_else(|error| panic!("{error}"))
}

/// Pieces with their lifted ends.
fn pieces(path: &PolishPath) -> Vec<Vec<crate::cam::CamPoint>> {
    let of = |line: usize| {
        let all = path.path.points.iter().copied();
        all.filter(|point| point.line == line).collect()
    };
    (1..=path.contacts_m.len()).map(of).collect()
}

fn axis(point: &crate::cam::CamPoint) -> Vector3<f64> {
    match point.attitude {
        Attitude::Whole(rotation) => -(rotation * Vector3::z()),
        Attitude::Axis(axis) => axis.into_inner(),
    }
}

/// Round drawn bars the centre runs on a circle of ρ + R − d, `(ρ + R − d)/ρ` as fast as the
/// contact; the axis leans by the tilt from the normal, towards an angle that turns with the way
/// fed; lines share the width between the insets evenly.
#[test]
fn verify_places_axes_and_feeds_about_drawn_bars() {
    for seed in 0..12 {
        let (radius_m, tilt_rad, turn_rad_s) =
            seeded(seed, &(0.03..0.3_f64, 0.1..1.0_f64, 0.5..8.0_f64));
        let laying = PolishLaying {
            tilt_rad,
            turn_rad_s: if seed % 2 == 0 {
                turn_rad_s
            } else {
                -turn_rad_s
            },
            ..LAYING
        };
        let path = laid(&laying, &bar(radius_m));
        let circle_m = radius_m + laying.radius_m - laying.indentation_m;
        let mut fed_m = 0.0;
        let pieces = pieces(&path);
        assert_eq!(pieces.len(), 18);
        for (k, points) in pieces.iter().enumerate() {
            let on_face = &points[1..points.len() - 1];
            let y_m = 5e-3 + 50e-3 * k as f64 / 17.0;
            for (at, point) in on_face.iter().enumerate() {
                let radial = Vector3::new(point.place_m.x, 0.0, point.place_m.z);
                assert!((radial.norm() - circle_m).abs() < 1e-12);
                assert!(
                    (point.place_m.y - y_m).abs() < 1e-9,
                    "{} {y_m}",
                    point.place_m.y
                );
                let normal = radial.normalize();
                if at > 0 {
                    let chord_m = (path.contacts_m[k][at] - path.contacts_m[k][at - 1]).norm();
                    fed_m += chord_m;
                    let feed = point.feed_m_per_s.unwrap();
                    let centre_m = (point.place_m - on_face[at - 1].place_m).norm();
                    assert!((feed / laying.feed_m_per_s - circle_m / radius_m).abs() < 1e-9);
                    assert!((centre_m / chord_m - circle_m / radius_m).abs() < 1e-9);
                }
                let axis = axis(point);
                assert!((axis.dot(&normal).acos() - tilt_rad).abs() < 1e-9);
                let along = Vector3::y().cross(&normal);
                let angle = axis.dot(&normal.cross(&along)).atan2(axis.dot(&along));
                let turned = laying.turn_rad_s * fed_m / laying.feed_m_per_s;
                let off = (angle - 0.4 - turned).rem_euclid(std::f64::consts::TAU);
                assert!(
                    off.min(std::f64::consts::TAU - off) < 1e-6,
                    "seed {seed}: {off}"
                );
            }
            let lifted = [&points[0], &points[points.len() - 1]];
            for point in lifted {
                let radial = Vector3::new(point.place_m.x, 0.0, point.place_m.z);
                assert!((radial.norm() - circle_m - laying.lift_m).abs() < 1e-12);
            }
            assert_eq!(points[0].feed_m_per_s, None);
        }
        // A chord of the circle's lies within it by its sagitta.
        let steps = pieces[0].windows(2).skip(1);
        let largest_m = steps
            .map(|pair| (pair[1].place_m - pair[0].place_m).norm())
            .fold(0.0, f64::max);
        let sagitta_m = circle_m - (circle_m.powi(2) - 0.25 * largest_m.powi(2)).sqrt();
        assert!((path.chord_m / sagitta_m - 1.0).abs() < 0.05 || path.chord_m < sagitta_m);
    }
}

/// On faces drawn at random every contact keeps the inset from the border, and the wheel's centre
/// is nowhere nearer to the face than the indentation says.
#[test]
fn verify_centres_over_drawn_faces_stand_off_by_the_radius() {
    for seed in 0..6 {
        let patch = face(drawn_patch(&heights(seed), 1.0e-3, 4e-3), None);
        let path = laid(&LAYING, &patch);
        let height_m = LAYING.radius_m - LAYING.indentation_m;
        let grid: Vec<Vector3<f64>> = (0..=160 * 100)
            .map(|k| ((k % 160) as f64 / 159.0, (k / 160) as f64 / 100.0))
            .map(|(u, v)| patch.surface.point_m(u, v))
            .collect();
        let borders = FaceBorders::of(&patch).unwrap();
        for points in pieces(&path).iter().step_by(5) {
            for point in points[1..points.len() - 1].iter().step_by(9) {
                let near = grid.iter().map(|at| (at - point.place_m).norm());
                let nearest_m = near.fold(f64::INFINITY, f64::min);
                // Points of the grid are 1 mm apart.
                let above = height_m - 1e-9..height_m + 0.05e-3;
                assert!(above.contains(&nearest_m), "seed {seed}: {nearest_m}");
            }
        }
        for contact_m in path.contacts_m.iter().flatten() {
            let off = |[a, b]: &[Vector3<f64>; 2]| {
                let way = b - a;
                let share = ((contact_m - a).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
                (contact_m - a - way * share).norm()
            };
            let least_m = borders.sides.iter().map(off).fold(f64::INFINITY, f64::min);
            assert!(least_m > 0.998 * LAYING.inset_m, "seed {seed}: {least_m}");
        }
    }
}

/// A hole cuts lines in two, each end the inset off its rim.
#[test]
fn verify_a_hole_cuts_lines() {
    let corner = |x: f64, y: f64| Vector3::new(x, y, 0.0) * 1e-3;
    let outer = [
        (0.0, 0.0),
        (100.0, 0.0),
        (100.0, 60.0),
        (0.0, 60.0),
        (0.0, 0.0),
    ];
    let mut boundary = Boundary::new(&outer.map(|(x, y)| corner(x, y))).unwrap();
    let rim: Vec<Vector3<f64>> = (0..=180)
        .map(|k| (k % 180) as f64 * std::f64::consts::TAU / 180.0)
        .map(|angle| corner(50.0 + 10.0 * angle.cos(), 30.0 + 10.0 * angle.sin()))
        .collect();
    boundary.add_hole(&rim).unwrap();
    let path = laid(&LAYING, &plane(Some(boundary)));
    let mut cut = 0;
    for contacts_m in &path.contacts_m {
        for contact_m in contacts_m {
            let off_m = (contact_m - corner(50.0, 30.0)).norm() - 10e-3;
            assert!(off_m > 0.998 * LAYING.inset_m, "{contact_m}");
        }
        let [first, last] = [contacts_m[0], contacts_m[contacts_m.len() - 1]];
        let x_m = first.x.max(last.x);
        if x_m < 50e-3 {
            cut += 1;
            let rim_m = (15e-3_f64.powi(2) - (first.y - 30e-3).powi(2)).sqrt();
            assert!((x_m - (50e-3 - rim_m)).abs() < 0.1e-3, "{x_m} {rim_m}");
        }
    }
    // Lines are 50 mm / 17 apart; those within 15 mm of the middle are cut.
    assert_eq!(cut, 10);
    assert_eq!(path.contacts_m.len(), 28);
}

#[test]
fn what_is_too_curved_or_too_small_is_told_with_place_value_and_limit() {
    let refuse = |laying: &PolishLaying, patch: &PatchFile| {
        let refused = laying.path(patch).expect_err("no way");
        refused.to_string()
    };
    let told = refuse(&LAYING, &bar(-0.019));
    assert!(
        told.contains("radius of 19.000 mm") && told.contains("20.000 mm"),
        "{told}"
    );
    // 1/R and 1/R + κ: the ratio is 1 + R κ.
    let told = refuse(&LAYING, &bar(0.0199));
    assert!(
        told.contains("ratio 2.005") && told.contains("at most 2"),
        "{told}"
    );
    assert!((laid(&LAYING, &bar(0.0201)).unalike - (1.0 + 20.0 / 20.1)).abs() < 1e-9);
    let wide = PolishLaying {
        inset_m: 31e-3,
        ..LAYING
    };
    let told = refuse(&wide, &plane(None));
    assert!(
        told.contains("60.000 mm wide") && told.contains("31.000 mm"),
        "{told}"
    );
    let fine = PolishLaying {
        step_m: 1e-7,
        ..LAYING
    };
    assert!(refuse(&fine, &plane(None)).contains("points are too many"));
    let close = PolishLaying {
        spacing_m: 1e-5,
        ..LAYING
    };
    assert!(refuse(&close, &plane(None)).contains("lines are too many"));
}
