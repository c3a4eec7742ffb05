//! The worked example: ρ 20 mm, d 0.6 mm, θ 20°, block of 100 × 60 mm, 20 mm/s, ω2 1.5 rad/s.
//! Numbers:
//! `docs/physics/precession.md`, computed anew by `tests/reference/precession.py`.

use std::f64::consts::TAU;

use super::*;
use proptest::prelude::*;

fn wheel() -> PrecessionWheel {
    wheel_with(1.0)
}

fn wheel_with(spin_rad_s: f64) -> PrecessionWheel {
    let tilt_rad = 20f64.to_radians();
    PrecessionWheel::new(20e-3, 0.6e-3, tilt_rad, spin_rad_s).expect("good")
}

fn block() -> Boundary {
    Boundary::rectangle(0.1, 0.06).expect("closed")
}

fn mm(x: f64, y: f64) -> Vector2<f64> {
    Vector2::new(x, y) * 1e-3
}

fn arcs_deg(set: &AngleSet) -> Vec<(f64, f64)> {
    let AngleSet::Arcs(arcs) = set else {
        panic!("not all angles")
    };
    let deg = |arc: &Arc| (arc.from_rad.to_degrees(), arc.to_rad.to_degrees());
    arcs.iter().map(deg).collect()
}

/// Sliding velocity of a spinning wheel's surface in the plane of the face, from the middle of the
/// patch: that of a rigid body, ω1 × r less its part along N.
fn sliding_m_per_s(
    wheel: &PrecessionWheel,
    spin_rad_s: f64,
    angle_rad: f64,
    from_middle_m: &Vector2<f64>,
) -> Vector2<f64> {
    let arm = Vector3::new(from_middle_m.x, from_middle_m.y, -wheel.centre_height_m());
    (wheel.axis(angle_rad) * spin_rad_s).cross(&arm).xy()
}

/// Least cos β at an edge at distance δ with its whole chord in the patch: ε(δ) = √(r² − δ²) / h.
fn least_cosine(wheel: &PrecessionWheel, distance_m: f64) -> f64 {
    (wheel.patch_radius_m().powi(2) - distance_m.powi(2)).sqrt() / wheel.lever_m()
}

/// The angle of a set nearest to an angle, within half a turn of it.
fn nearest_rad(set: &AngleSet, angle_rad: f64) -> f64 {
    let AngleSet::Arcs(arcs) = set else {
        return angle_rad;
    };
    if set.contains(angle_rad) {
        return angle_rad;
    }
    let ends = arcs.iter().flat_map(|arc| [arc.from_rad, arc.to_rad]);
    ends.map(|end| angle_rad + wrapped(end - angle_rad))
        .min_by(|a, b| (a - angle_rad).abs().total_cmp(&(b - angle_rad).abs()))
        .expect("some angle")
}

/// Printed to 1e-3 mm.
#[test]
fn verify_patch_and_lever() {
    let wheel = wheel();
    assert!((wheel.patch_radius_m() - 4.862e-3).abs() <= 1e-6);
    assert!((wheel.lever_m() - 7.061e-3).abs() <= 1e-6);
    assert!((least_cosine(&wheel, 0.0) - 0.689).abs() <= 1e-3);
}

/// δ = 2 mm from the upper edge: ε, β_max and the least outward velocity over the chord at five β,
/// to 1e-3 (mm, of ω1 = 1).
#[test]
fn verify_boundary_test_point() {
    let (wheel, block, point) = (wheel(), block(), mm(50.0, 58.0));
    let epsilon = least_cosine(&wheel, 2e-3);
    assert!((epsilon - 0.6276).abs() <= 1e-3);
    // Printed to a hundredth of a degree.
    let widest = arcs_deg(&wheel.allowed(&block, &point, EdgeRule::Exact(ChordExtent::Full)));
    assert!((0.5 * (widest[0].1 - widest[0].0) - 51.12).abs() <= 5e-3);
    let expected_mm = [
        (0.0, 2.471),
        (45.0, 0.527),
        (60.0, -0.847),
        (80.0, -3.012),
        (180.0, -10.80),
    ];
    for (beta_deg, expected) in expected_mm {
        let angle = f64::to_radians(beta_deg);
        let velocity = sliding_m_per_s(&wheel, 1.0, angle, &Vector2::zeros());
        assert!((velocity.x.abs().atan2(velocity.y) - angle).abs() < 1e-12);
        let found = wheel
            .edge_motion(&block, &point, angle)
            .least_outward_m_per_s
            * 1e3;
        let tolerance = if beta_deg == 180.0 { 5e-3 } else { 1e-3 };
        assert!((found - expected).abs() <= tolerance, "{beta_deg}: {found}");
    }
}

/// Near a corner: what the source's rule allows, whole chords, and chords clipped to the block, to
/// a hundredth of a degree.
#[test]
fn verify_corner_angles() {
    let rules = [
        (EdgeRule::Paper { epsilon: 0.0 }, (270.0, 360.0)),
        (EdgeRule::Exact(ChordExtent::Full), (308.88, 327.19)),
        (EdgeRule::Exact(ChordExtent::Clipped), (308.88, 343.55)),
    ];
    for (rule, expected) in rules {
        let found = arcs_deg(&wheel().allowed(&block(), &mm(97.0, 58.0), rule));
        assert_eq!(found.len(), 1, "{found:?}");
        let (from, to) = found[0];
        assert!(
            (from - expected.0).abs() <= 6e-3 && (to - expected.1).abs() <= 6e-3,
            "{rule:?}: {found:?}"
        );
    }
}

/// Serpentine of 16 lines along x, 4 mm apart, joined at the ends: the point after `s_mm`.
fn raster(s_mm: f64) -> Vector2<f64> {
    let line = (s_mm / 104.0).floor().min(15.0);
    let along = s_mm - 104.0 * line;
    let forward = line % 2.0 == 0.0;
    let x = along.min(100.0);
    let y = 4.0 * line + (along - 100.0).max(0.0);
    mm(if forward { x } else { 100.0 - x }, y)
}

/// Points with inward edge velocity (%), mean inward share of the chord, and fastest change of the
/// angle (rad/s), where each point of the raster takes the allowed angle nearest to 1.5 t on its
/// own.
fn table(rule: EdgeRule) -> (f64, f64, f64) {
    let (wheel, block) = (wheel(), block());
    let (mut zone, mut inward, mut share, mut fastest) = (0.0, 0.0, 0.0, 0.0_f64);
    let mut before = None;
    for k in 0..=4150 {
        let point = raster(0.4 * f64::from(k));
        let nominal = 1.5 * 0.02 * f64::from(k);
        let set = wheel
            .require_allowed(&block, &point, rule)
            .expect("some angle");
        let angle = nearest_rad(&set, nominal);
        if let Some(before) = before {
            fastest = fastest.max(wrapped(angle - before).abs() / 0.02);
        }
        before = Some(angle);
        let motion = wheel.edge_motion(&block, &point, angle);
        if motion.edges == 0 {
            continue;
        }
        zone += 1.0;
        // 1e-9 mm per rad/s, as the table counts.
        if motion.least_outward_m_per_s < -1e-12 {
            inward += 1.0;
            share += motion.inward_share;
        }
    }
    assert_eq!(zone, 1451.0);
    (100.0 * inward / zone, share / zone, fastest)
}

/// The whole table. Tolerances: 0.15 % points of the points, 0.005 of the share (two programs
/// sample the chord differently), half a digit of the fastest change.
#[test]
fn verify_raster_table() {
    let rows = [
        (EdgeRule::None, 70.99, 0.541, 1.5),
        (EdgeRule::Paper { epsilon: 0.0 }, 70.78, 0.326, 157.1),
        (EdgeRule::Paper { epsilon: 0.2 }, 69.47, 0.207, 136.9),
        (EdgeRule::Exact(ChordExtent::Full), 0.0, 0.0, 116.9),
    ];
    for (rule, points, share, fastest) in rows {
        let found = table(rule);
        assert!((found.0 - points).abs() <= 0.15, "{rule:?}: {found:?}");
        assert!((found.1 - share).abs() <= 0.005, "{rule:?}: {found:?}");
        assert!((found.2 - fastest).abs() <= 0.06, "{rule:?}: {found:?}");
        let exact = rule == EdgeRule::Exact(ChordExtent::Full);
        assert_eq!(exact, found.0 == 0.0 && found.1 == 0.0);
    }
}

/// Whole chords in a corner need r ≤ h/√2; chords that end at the corner only r ≤ h.
#[test]
fn verify_corner_feasibility() {
    let with_ratio = |ratio: f64| {
        let tilt = (wheel().patch_radius_m() / (ratio * 19.4e-3)).atan();
        PrecessionWheel::new(20e-3, 0.6e-3, tilt, 1.0).expect("good")
    };
    let empty = |ratio: f64, extent| {
        let set = with_ratio(ratio).allowed(&block(), &mm(100.0, 60.0), EdgeRule::Exact(extent));
        set.is_empty()
    };
    // r / h just either side of the bounds.
    assert!(!empty(0.707, ChordExtent::Full) && empty(0.708, ChordExtent::Full));
    assert!(!empty(0.9999, ChordExtent::Clipped) && empty(1.0001, ChordExtent::Clipped));
}

#[test]
fn edges_too_close_are_refused_with_the_reason() {
    let narrow = Boundary::rectangle(0.1, 0.009).expect("closed");
    let rule = EdgeRule::Exact(ChordExtent::Clipped);
    let refused = |wheel: &PrecessionWheel, point| {
        let error = wheel.require_allowed(&narrow, &point, rule);
        error.expect_err("no angle").to_string()
    };
    let both = refused(&wheel(), mm(50.0, 4.5));
    assert!(
        both.contains("2 edges")
            && both.contains("(50.000, 4.500) mm")
            && both.contains("9.724 mm"),
        "{both}"
    );
    let upright = PrecessionWheel::new(20e-3, 0.6e-3, 0.1, 1.0).expect("good");
    let one = refused(&upright, mm(50.0, 0.0));
    assert!(one.contains("cos beta >= 2.498"), "{one}");
}

#[test]
fn what_is_no_boundary_is_refused() {
    let refuse = |points: &[(f64, f64)]| {
        let points: Vec<_> = points.iter().map(|(x, y)| mm(*x, *y)).collect();
        Boundary::new(&points).expect_err("refused").to_string()
    };
    let open = refuse(&[(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)]);
    assert!(
        open.contains("open") && open.contains("9.0000 mm"),
        "{open}"
    );
    let bow = refuse(&[(0.0, 0.0), (9.0, 9.0), (9.0, 0.0), (0.0, 9.0), (0.0, 0.0)]);
    assert!(bow.contains("segments 1 and 3 meet"), "{bow}");
    let spike = refuse(&[(0.0, 0.0), (9.0, 0.0), (5.0, 0.0), (5.0, 5.0), (0.0, 0.0)]);
    assert!(spike.contains("segments 1 and 2 meet"), "{spike}");
    let inverted = refuse(&[(0.0, 0.0), (0.0, 9.0), (9.0, 9.0), (0.0, 0.0)]);
    assert!(inverted.contains("clockwise"), "{inverted}");
    let flat = refuse(&[(0.0, 0.0), (0.0, 9.0), (0.0, 0.0)]);
    assert!(flat.contains("3 points"), "{flat}");
    let double = refuse(&[(0.0, 0.0), (9.0, 0.0), (9.0, 0.0), (0.0, 9.0), (0.0, 0.0)]);
    assert!(double.contains("points 2 and 3"), "{double}");
    let nan = refuse(&[(0.0, 0.0), (f64::NAN, 0.0), (9.0, 9.0), (0.0, 0.0)]);
    assert!(nan.contains("point 2"), "{nan}");
    for (radius, compression, tilt, spin) in [
        (0.0, 1e-4, 0.3, 1.0),
        (1e-2, 1e-2, 0.3, 1.0),
        (1e-2, 1e-3, 1.6, 1.0),
        (1e-2, 1e-3, 0.3, 0.0),
    ] {
        assert!(PrecessionWheel::new(radius, compression, tilt, spin).is_err());
    }
}

/// A face with a notch, so that edges end in reflex corners too.
fn notched() -> Boundary {
    let outer = [
        (0.0, 0.0),
        (30.0, 0.0),
        (30.0, 12.0),
        (18.0, 12.0),
        (15.0, 25.0),
        (0.0, 25.0),
        (0.0, 0.0),
    ];
    Boundary::new(&outer.map(|(x, y)| mm(x, y))).expect("closed")
}

proptest! {
    /// The closed form on a chord is the velocity of a rigid body, ω1 × r less its part along N, by
    /// the normal, for either spin.
    #[test]
    fn verify_chord_velocity_is_the_rigid_body_s(
        x in 0.0..30.0_f64, y in 0.0..25.0_f64, angle in 0.0..TAU, reverse: bool,
    ) {
        let spin_rad_s = if reverse { -3.0 } else { 3.0 };
        let wheel = wheel_with(spin_rad_s);
        let (face, point) = (notched(), mm(x, y));
        let mut least = f64::INFINITY;
        for edge in face.edges() {
            for k in 0..=400 {
                let on_edge = edge.from_m.lerp(&edge.to_m, f64::from(k) / 400.0) - point;
                if on_edge.norm() > wheel.patch_radius_m() {
                    continue;
                }
                let rigid = sliding_m_per_s(&wheel, spin_rad_s, angle, &on_edge);
                let along = (edge.to_m - edge.from_m).normalize();
                least = least.min(rigid.dot(&Vector2::new(along.y, -along.x)));
            }
        }
        let motion = wheel.edge_motion(&face, &point, angle);
        // Samples lie up to 30 mm / 400 apart; the velocity changes by ω1 cos θ per length.
        if least.is_finite() {
            prop_assert!(least >= motion.least_outward_m_per_s - 1e-12);
            prop_assert!(least <= motion.least_outward_m_per_s + 3.0 * 0.075e-3);
        }
        prop_assert_eq!(motion.inward_share > 1e-9, motion.least_outward_m_per_s < -1e-9 * 3e-3);
    }

    /// An angle is allowed by the exact rule if and only if nothing moves inward; and what is
    /// allowed around a point is allowed at every point within reach.
    #[test]
    fn the_exact_rule_is_the_absence_of_inward_motion(
        x in 0.0..30.0_f64, y in 0.0..25.0_f64, angle in 0.0..TAU, reverse: bool,
        reach in 0.0..0.3_f64, at in 0.0..TAU,
    ) {
        let wheel = wheel_with(if reverse { -1.0 } else { 1.0 });
        let (face, point, rule) = (notched(), mm(x, y), EdgeRule::Exact(ChordExtent::Clipped));
        let least = wheel.edge_motion(&face, &point, angle).least_outward_m_per_s;
        if least.abs() > 1e-9 {
            prop_assert_eq!(wheel.allowed(&face, &point, rule).contains(angle), least > 0.0);
        }
        let near = point + mm(at.cos(), at.sin()) * reach;
        if wheel.allowed_around(&face, &point, reach * 1e-3, rule).contains(angle) {
            prop_assert!(wheel.edge_motion(&face, &near, angle).least_outward_m_per_s >= -1e-12);
        }
    }
}
