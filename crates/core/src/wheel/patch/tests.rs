use super::*;
use crate::wheel::belt::BeltWheel;
use crate::wheel::belt::tests::wheel as slack;
use crate::wheel::pneumatic::PneumaticWheel;
use crate::wheel::pneumatic::tests::{pressed, wheel as ball};
use nalgebra::Isometry2;
use std::f64::consts::TAU;

fn belt() -> BeltWheel {
    BeltWheel {
        tension_n: 100.0,
        ..slack()
    }
}

const PRECESSING: fn() -> Sliding = || Sliding::about(Point2::new(-7e-3, 0.0), 100.0, 0.3);

fn at(x: f64, y: f64, angle: f64) -> Isometry2<f64> {
    Isometry2::new(Vector2::new(x, y), angle).inverse()
}

fn loads(
    patch: &Patch,
    face: &Face,
    pose: Isometry2<f64>,
    sliding: &Sliding,
    n: usize,
) -> PatchLoads {
    patch.loads(face, &pose, sliding, &Quadrature::new(n), |_| {})
}

/// Forces within a share of the whole, moments of that at the patch's reach.
fn assert_close(found: &PatchLoads, expected: &PatchLoads, reach_m: f64, share: f64) {
    let close = |a: f64, b: f64, of: f64| assert!((a - b).abs() < share * of, "{a} {b}");
    let (normal, friction) = (expected.normal_n, expected.friction_n.norm());
    close(found.normal_n, normal, normal);
    close(found.sliding_w, expected.sliding_w, expected.sliding_w);
    close(found.friction_n.x, expected.friction_n.x, friction);
    close(found.friction_n.y, expected.friction_n.y, friction);
    let lever = friction * reach_m;
    close(found.spin_moment_n_m, expected.spin_moment_n_m, lever);
    let (first, moment) = (found.first_moment_n_m, expected.first_moment_n_m);
    close(first.x, moment.x, normal * reach_m);
    close(first.y, moment.y, normal * reach_m);
}

#[test]
fn verify_far_from_edges_it_is_the_free_law() {
    let face = Face::rectangle(0.1, 0.06).unwrap();
    let r = belt().relative_radius_m(0.0).unwrap();
    for patch in [
        pressed(&ball(), 0.8e-3),
        belt().patch(&belt().layer(), 0.4e-3, r),
    ] {
        for face in [&face, &Face::unbounded()] {
            let l = loads(&patch, face, at(0.05, 0.03, 0.4), &Sliding::default(), 16);
            assert!(
                (l.normal_n / patch.free_force_n() - 1.0).abs() < 1e-6,
                "{l:?}"
            );
            assert_eq!(l.edge_n, 0.0);
            assert!(l.first_moment_n_m.norm() < 1e-9 * l.normal_n);
        }
    }
}

/// A whole patch that turns about a point beside it, against a sum over rings.
#[test]
fn verify_a_whole_patch_is_the_sum_over_its_rings() {
    let damped = PneumaticWheel {
        damping_pa_s_per_m: 1e4,
        ..ball()
    };
    let patch = pressed(&damped, 0.8e-3);
    let sliding = Sliding {
        approach_m_per_s: 0.02,
        ..PRECESSING()
    };
    let found = loads(&patch, &Face::unbounded(), at(0.0, 0.0, 0.0), &sliding, 16);
    let (rings, spokes) = (1500, 240);
    let (ring_m, spoke_rad) = (
        patch.contact_m() / f64::from(rings),
        TAU / f64::from(spokes),
    );
    let mut expected = PatchLoads::default();
    for ring in 0..rings {
        let rho = (f64::from(ring) + 0.5) * ring_m;
        for spoke in 0..spokes {
            let (sine, cosine) = (f64::from(spoke) * spoke_rad).sin_cos();
            let (x, y) = (rho * cosine, rho * sine);
            let force_n = patch.moving_pressure_pa(x, y, &sliding) * rho * ring_m * spoke_rad;
            expected.add(Point2::new(x, y), force_n, &sliding);
        }
    }
    assert_close(&found, &expected, patch.contact_m(), 1e-5);
}

/// A belt's patch is summed in two rows where its velocity hardly changes, and by the rule for any
/// patch on a face whose borders are far.
#[test]
fn verify_a_narrow_patch_is_any_patch() {
    let wheel = BeltWheel {
        damping_pa_s_per_m: 1e5,
        ..belt()
    };
    let r = wheel.relative_radius_m(9.0).unwrap();
    let far = Face::rectangle(0.1, 0.06).unwrap();
    for (depth_m, share) in [
        (0.1e-3, 0.0),
        (0.4e-3, 0.5),
        (0.4e-3, 0.99),
        (0.8e-3, -0.99),
    ] {
        let patch = wheel.patch(&wheel.layer(), depth_m, r);
        let velocity_m_per_s = Vector2::new(-4.0, 1.5);
        let reach_m = patch.contact_m().hypot(0.5 * wheel.width_m);
        let sliding = Sliding {
            velocity_m_per_s,
            spin_rad_s: share * 0.02 * velocity_m_per_s.norm() / reach_m,
            approach_m_per_s: 0.02,
            mu: 0.3,
        };
        assert!(patch.is_narrow(&Face::unbounded(), &[], &sliding).is_some());
        let narrow = loads(&patch, &Face::unbounded(), at(0.0, 0.0, 0.0), &sliding, 12);
        let any = loads(&patch, &far, at(0.05, 0.03, 0.4), &sliding, 48);
        assert_close(&narrow, &any, reach_m, 1e-6);
    }
}

/// Where a belt leaves the face: what the bed holds beyond pulls the belt down as steeply as the
/// wheel's surface falls there.
#[test]
fn verify_a_belt_leaves_without_a_kink() {
    let r = belt().relative_radius_m(0.0).unwrap();
    for tension_n in [0.1, 10.0, 100.0, 1000.0] {
        for depth_m in [1e-6, 0.1e-3, 0.4e-3, 2e-3] {
            let patch = BeltWheel {
                tension_n,
                ..belt()
            }
            .patch(&belt().layer(), depth_m, r);
            let c = patch.contact_m();
            let left = patch.bed_indentation_at_m(c, 0.0);
            assert!(left > 0.0 && c > 0.0, "{tension_n} {depth_m}");
            // N w'^2 = 2 Psi, the bed's energy per area to the indentation, by Simpson's rule over
            // its root
            let rows = 200;
            let at_root = |k: usize| {
                let root = left.sqrt() * k as f64 / rows as f64;
                2.0 * root * patch.bed.pressure_pa(root * root)
            };
            let energy: f64 = (0..rows / 2)
                .map(|k| at_root(2 * k) + 4.0 * at_root(2 * k + 1) + at_root(2 * k + 2))
                .sum::<f64>()
                * left.sqrt()
                / (3.0 * rows as f64);
            let pull = patch.bed.tension_n_per_m * (c / patch.shape.radius_m()).powi(2);
            assert!((2.0 * energy / pull - 1.0).abs() < 1e-9, "{energy} {pull}");
        }
    }
}

#[test]
fn verify_mirrored_edges_give_mirrored_loads() {
    let face = Face::rectangle(0.1, 0.06).unwrap();
    let patch = pressed(&ball(), 0.8e-3);
    let rest = Sliding::default();
    let right = loads(&patch, &face, at(0.099, 0.03, 0.0), &rest, 16);
    let left = loads(&patch, &face, at(0.001, 0.03, 0.0), &rest, 16);
    let top = loads(&patch, &face, at(0.05, 0.059, 0.0), &rest, 16);
    let turned = loads(&patch, &face, at(0.099, 0.03, 0.7), &rest, 16);
    assert!(right.edge_n > 0.02 * right.normal_n);
    for other in [left, top, turned] {
        assert!(
            (other.normal_n / right.normal_n - 1.0).abs() < 1e-4,
            "{other:?} {right:?}"
        );
        assert!((other.first_moment_n_m.norm() / right.first_moment_n_m.norm() - 1.0).abs() < 1e-3);
    }
    assert!((left.first_moment_n_m + right.first_moment_n_m).norm() < 1e-9);
}

#[test]
fn verify_force_passes_an_edge_without_a_jump() {
    let face = Face::rectangle(0.1, 0.06).unwrap();
    let r = belt().relative_radius_m(0.0).unwrap();
    for patch in [
        pressed(&ball(), 0.8e-3),
        belt().patch(&belt().layer(), 0.4e-3, r),
    ] {
        let whole = patch.free_force_n();
        let reach = patch.undeformed_half_length_m();
        let n = 2000;
        let force = |i: i32| {
            let x = 0.1 + 1.2 * reach * f64::from(i) / f64::from(n);
            loads(&patch, &face, at(x, 0.03, 0.0), &Sliding::default(), 16).normal_n
        };
        let mut last = force(-n);
        assert!((last / whole - 1.0).abs() < 1e-6);
        for i in 1 - n..=n {
            let now = force(i);
            assert!(
                (now - last).abs() < 0.01 * whole,
                "{i}: {last} to {now} of {whole}"
            );
            last = now;
        }
        assert_eq!(last, 0.0);
    }
}

#[test]
fn verify_edge_presses_harder_the_more_the_layer_is_stretched() {
    let face = Face::rectangle(0.1, 0.06).unwrap();
    let share = |pressure: f64, modulus: f64| {
        let wheel = PneumaticWheel {
            pressure_pa: pressure,
            youngs_modulus_pa: modulus,
            ..ball()
        };
        let patch = pressed(&wheel, wheel.indentation_m(10.0));
        let l = loads(&patch, &face, at(0.1, 0.03, 0.0), &Sliding::default(), 16);
        (l.edge_n, l.normal_n / patch.free_force_n())
    };
    assert!(share(0.0, 4e6).0 == 0.0 && (share(0.0, 4e6).1 - 0.5).abs() < 1e-6);
    let mut last = (0.0, 0.5);
    for pressure in [0.05e6, 0.1e6, 0.2e6] {
        let now = share(pressure, 4e6);
        assert!(now.0 > last.0 && now.1 > last.1, "{pressure}: {now:?}");
        last = now;
    }
    // the stiffer the tread, the less of the force the layer carries
    assert!(share(0.1e6, 16e6).0 < 0.95 * share(0.1e6, 4e6).0);
}

/// Normal force of a patch whose middle lies a distance before a face's end.
fn normal_before_an_end_n(patch: &Patch, distance_m: f64) -> f64 {
    let face = Face::rectangle(0.1, 0.06).unwrap();
    let pose = at(0.1 - distance_m, 0.03, 0.0);
    loads(patch, &face, pose, &Sliding::default(), 24).normal_n
}

/// A belt whose axis lies along the edge: the layer's equation in one dimension, relaxed on a fine
/// grid as an obstacle problem (w at least the indentation on the face, free off it), against patch
/// and edge reaction.
#[test]
fn verify_line_patch_over_an_edge_solves_the_obstacle_problem() {
    let r = 40e-3;
    let patch = belt().patch(&belt().layer(), 0.4e-3, r);
    let (n, h) = (601, 14e-3 / 600.0);
    let x = |i: usize| (i as f64 - 300.0) * h;
    for nodes in [-125.0, -50.0, 0.0, 45.0, 90.0] {
        let edge = nodes * h;
        let mut w: Vec<f64> = (0..n)
            .map(|i| patch.bed_indentation_at_m(x(i), 0.0).max(0.0))
            .collect();
        let spring = patch.bed.tension_n_per_m / (h * h);
        for _ in 0..8000 {
            for i in 1..n - 1 {
                // one Newton step of the node's balance, over-relaxed, then the obstacle
                let q = patch.bed.pressure_pa(w[i]);
                let slope = patch.bed.pressure_pa(w[i] + 1e-9) - q;
                let balance = spring * (w[i - 1] + w[i + 1] - 2.0 * w[i]) - q;
                let free = w[i] + 1.98 * balance / (2.0 * spring + slope.max(0.0) / 1e-9);
                let floor = if x(i) <= edge + 0.1 * h {
                    patch.bed_indentation_at_m(x(i), 0.0)
                } else {
                    0.0
                };
                w[i] = free.max(floor).max(0.0);
            }
        }
        let carried: f64 = w.iter().map(|w| patch.bed.pressure_pa(*w) * h).sum::<f64>() * 25e-3;
        let normal_n = normal_before_an_end_n(&patch, edge);
        assert!(
            (normal_n / carried - 1.0).abs() < 0.01,
            "{edge}: {normal_n} {carried}"
        );
    }
}

#[test]
fn regress_quadrature_converges() {
    let p = Point2::new;
    // an L-shaped face whose inner corner lies under the patch
    let corners = [
        (0., 0.),
        (0.1, 0.),
        (0.1, 0.03),
        (0.05, 0.03),
        (0.05, 0.06),
        (0., 0.06),
    ];
    let face = Face::new(&[corners.map(|(x, y)| p(x, y)).to_vec()]).unwrap();
    let patch = pressed(&ball(), 0.8e-3);
    let pose = || at(0.0505, 0.0292, 0.3);
    let fine = loads(&patch, &face, pose(), &PRECESSING(), 120);
    let error = |n: usize| {
        let l = loads(&patch, &face, pose(), &PRECESSING(), n);
        let moment = (l.spin_moment_n_m / fine.spin_moment_n_m - 1.0).abs();
        (l.normal_n / fine.normal_n - 1.0)
            .abs()
            .max((l.sliding_w / fine.sliding_w - 1.0).abs())
            .max((l.friction_n - fine.friction_n).norm() / fine.friction_n.norm())
            .max(moment)
    };
    assert!(error(16) < 2e-3, "{}", error(16));
    assert!(error(48) < 3e-4, "{}", error(48));
}

#[test]
fn verify_friction_opposes_sliding_and_its_power_is_prestons_integral() {
    let face = Face::rectangle(0.1, 0.06).unwrap();
    let patch = pressed(&ball(), 0.8e-3);
    let s = PRECESSING();
    let l = loads(&patch, &face, at(0.05, 0.03, 0.0), &s, 24);
    let power = l.friction_n.dot(&s.velocity_m_per_s) + l.spin_moment_n_m * s.spin_rad_s;
    assert!((power / (s.mu * l.sliding_w) - 1.0).abs() < 1e-9);
    assert!(l.friction_n.norm() < s.mu * l.normal_n * (1.0 + 1e-12));
}

/// Elements that run onto the face over its edge are pressed down within the falling-off length.
#[test]
fn verify_inward_spin_at_the_edge_presses_harder_than_outward() {
    let face = Face::rectangle(0.1, 0.06).unwrap();
    let damped = PneumaticWheel {
        damping_pa_s_per_m: 1e5,
        ..ball()
    };
    let edge = |wheel: &PneumaticWheel, spin: f64| {
        // the edge lies at x = 1 mm of the patch; about a centre below, the surface there moves
        // along ∓x
        let s = Sliding::about(Point2::new(0.0, -7e-3), spin, 0.3);
        let patch = pressed(wheel, 0.8e-3);
        loads(&patch, &face, at(0.099, 0.03, 0.0), &s, 24)
    };
    let (inward, outward) = (edge(&damped, 100.0), edge(&damped, -100.0));
    assert!(
        inward.edge_n > 1.05 * outward.edge_n,
        "{inward:?} {outward:?}"
    );
    assert!(inward.friction_n.x < 0.0 && outward.friction_n.x > 0.0);
    let (a, b) = (edge(&ball(), 100.0), edge(&ball(), -100.0));
    assert!((a.edge_n / b.edge_n - 1.0).abs() < 1e-12);
}

/// The same in two dimensions for a point patch: here the edge reaction is an approximation (planes
/// across the edge), and this says how good.
#[test]
fn verify_point_patch_over_an_edge_is_near_the_obstacle_problem() {
    let patch = pressed(&ball(), 0.8e-3);
    let (n, h) = (181_usize, 0.2e-3);
    let at_node = |i: usize| (i as f64 - 90.0) * h;
    // error in the plane across: largest where the patch hangs off the face by its radius
    for (nodes, tolerance) in [(80.0, 0.01), (-6.0, 0.02), (0.0, 0.01), (6.0, 0.01)] {
        let edge = nodes * h;
        let u = |i: usize, j: usize| patch.bed_indentation_at_m(at_node(j), at_node(i));
        let mut w = vec![0.0_f64; n * n];
        let spring = patch.bed.tension_n_per_m / (h * h);
        for _ in 0..500 {
            for i in 1..n - 1 {
                for j in 1..n - 1 {
                    let k = i * n + j;
                    let q = patch.bed.pressure_pa(w[k]);
                    let slope = (patch.bed.pressure_pa(w[k] + 1e-9) - q) / 1e-9;
                    let around = w[k - 1] + w[k + 1] + w[k - n] + w[k + n];
                    let balance = spring * (around - 4.0 * w[k]) - q;
                    let free = w[k] + 1.95 * balance / (4.0 * spring + slope);
                    let floor = if at_node(j) <= edge + 0.1 * h {
                        u(i, j)
                    } else {
                        0.0
                    };
                    w[k] = free.max(floor).max(0.0);
                }
            }
        }
        // what the face presses: the nodes' balance, which is zero where the layer is free
        let mut pressed = 0.0;
        for i in 1..n - 1 {
            for j in 1..n - 1 {
                let k = i * n + j;
                let around = w[k - 1] + w[k + 1] + w[k - n] + w[k + n];
                pressed += (patch.bed.pressure_pa(w[k]) - spring * (around - 4.0 * w[k])) * h * h;
            }
        }
        let normal_n = normal_before_an_end_n(&patch, edge);
        assert!(
            (normal_n / pressed - 1.0).abs() < tolerance,
            "{nodes}: {normal_n} {pressed}"
        );
    }
}
