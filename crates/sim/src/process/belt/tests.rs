//! The contact of a wheel that is held somewhere, against closed forms.

use super::contact::BeltContact;
use super::*;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3};
use truecut_core::roughness::Polishing;
use truecut_plan::surface::{Domain, Forms, Jet, PlanePatch, Surface};

/// A slack belt.
pub(super) const WHEEL: BeltWheel = BeltWheel {
    radius_m: 40e-3,
    width_m: 25e-3,
    contact_modulus_pa: 8e6,
    poisson: 0.48,
    rubber_m: 15e-3,
    tension_n: 0.0,
    damping_pa_s_per_m: 0.0,
};

/// Part of a round bar along x, 0.2 m long, from −1 to 1 rad about its top.
#[derive(Debug)]
struct Bar {
    radius_m: f64,
}

impl Surface for Bar {
    fn domain(&self) -> Domain {
        Domain::UNIT
    }

    fn jet(&self, u: f64, v: f64) -> Jet {
        let [u, v] = [u, v].map(|t| t.clamp(0.0, 1.0));
        let (sin, cos) = (2.0 * u - 1.0).sin_cos();
        // Angles turn about x: from z towards −y.
        let out = Vector3::new(0.0, -sin, cos);
        let around = Vector3::new(0.0, -cos, -sin);
        let along = Vector3::x() * 0.2;
        Jet {
            point_m: out * self.radius_m + along * v,
            first_m: [around * (2.0 * self.radius_m), along],
            second_m: [
                out * (-4.0 * self.radius_m),
                Vector3::zeros(),
                Vector3::zeros(),
            ],
        }
    }
}

fn setup(surface: Box<dyn Surface + Send>, wheel: BeltWheel) -> BeltSetup {
    let patch = Arc::new(PatchFile {
        surface,
        boundary: None,
        fit: None,
    });
    let cells = Cells::of(&patch, 1e-3);
    BeltSetup {
        eccentricity: Eccentricity::default(),
        layer: Arc::new(wheel.layer()),
        wheel,
        control: ForceControl::Position,
        belt_m_per_s: 20.0,
        abrasive: Abrasive {
            mu: 0.3,
            preston_per_pa: 4e-12,
            polishing: Polishing {
                initial_m: 3e-6,
                final_m: 0.4e-6,
                dose_j_per_m2: 1e6,
            },
        },
        copies: vec![CopyAt {
            from_s: 0.0,
            world_from_patch: Isometry3::identity(),
        }],
        process_from_world: UnitQuaternion::identity(),
        area_m2: Arc::new(cells.areas_m2(&patch)),
        is_face: Arc::new(cells_within(&cells, patch.clone())),
        cells,
        swept: [[0.0, 1.0]; 2],
        indentation_m: 0.3e-3,
        first_normal: Vector3::z(),
        chord_m: 0.0,
        expected_depth_m: 1e-6,
        patch,
    }
}

/// Where the tool stands with the wheel's axis along `axis` (tangent) and its centre at this height
/// over (u, v), shifted.
pub(super) fn held(
    setup: &BeltSetup,
    uv: [f64; 2],
    axis: Vector3<f64>,
    depth_m: f64,
    off: Vector3<f64>,
) -> ToolState {
    let jet = setup.patch.surface.jet(uv[0], uv[1]);
    let normal = Forms::of(&jet).unwrap().normal.into_inner();
    let (y, z) = (axis.normalize(), -normal);
    let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[y.cross(&z), y, z]));
    let centre = jet.point_m + normal * (setup.wheel.radius_m - depth_m) + off;
    ToolState {
        world_from_tool: Isometry3::from_parts(
            centre.into(),
            UnitQuaternion::from_rotation_matrix(&axes),
        ),
        ..ToolState::default()
    }
}

fn contact(setup: &BeltSetup, state: &ToolState) -> BeltContact {
    Belt::new(setup.clone()).contact_state(state).0
}

pub(super) fn plane(wheel: BeltWheel) -> BeltSetup {
    let (x, y) = (Vector3::x() * 0.1, Vector3::y() * 0.06);
    setup(
        Box::new(PlanePatch::new(Vector3::zeros(), x, y).unwrap()),
        wheel,
    )
}

/// Strips on a plane are one wheel: force, friction along the run, and a moment about the wheel's
/// centre that the friction makes at the lever of the radius less the indentation.
#[test]
fn verify_strips_on_a_plane_are_one_wheel() {
    let taut = BeltWheel {
        tension_n: 80.0,
        ..WHEEL
    };
    for (wheel, d) in [(WHEEL, 0.2e-3), (WHEEL, 0.5e-3), (taut, 0.3e-3)] {
        let setup = plane(wheel);
        let found = contact(
            &setup,
            &held(&setup, [0.5, 0.5], Vector3::y(), d, Vector3::zeros()),
        );
        let expected = wheel.normal_force_n(d, wheel.radius_m);
        assert!(
            (found.normal_n / expected - 1.0).abs() < 1e-4,
            "{} {expected}",
            found.normal_n
        );
        assert!((found.force_n.z - found.normal_n).abs() < 1e-12);
        // y along the axis, z into the face: the tool's x, along which the belt runs, is -x of the
        // plane
        assert!((found.friction_n.x / (0.3 * expected) - 1.0).abs() < 1e-4);
        assert!((found.force_n.x / (0.3 * expected) - 1.0).abs() < 1e-4);
        assert!((found.moment_n_m.y / (-0.3 * expected * (wheel.radius_m - d)) - 1.0).abs() < 1e-3);
        assert!((found.sliding_w / (20.0 * expected) - 1.0).abs() < 1e-4);
        assert!((found.width_m - wheel.width_m).abs() < 1e-12);
    }
}

/// Half beyond a border along the run, and half beyond one across it: a slack belt presses with
/// half of its force.
#[test]
fn verify_half_a_wheel_presses_with_half_of_its_force() {
    let setup = plane(WHEEL);
    let d = 0.4e-3;
    let whole = WHEEL.normal_force_n(d, WHEEL.radius_m);
    for (uv, axis) in [
        ([1.0, 0.5], Vector3::y()),
        ([1.0, 0.5], Vector3::x()),
        ([0.4, 0.0], Vector3::y()),
        ([0.4, 0.0], Vector3::x()),
    ] {
        let found = contact(&setup, &held(&setup, uv, axis, d, Vector3::zeros()));
        assert!(
            (found.normal_n / whole - 0.5).abs() < 1e-3,
            "{uv:?} {axis}: {}",
            found.normal_n / whole
        );
    }
    let beyond = held(&setup, [1.0, 0.5], Vector3::x(), d, Vector3::x() * 12.6e-3);
    assert_eq!(contact(&setup, &beyond).normal_n, 0.0);
    let lifted = held(&setup, [0.5, 0.5], Vector3::y(), -1e-6, Vector3::zeros());
    assert_eq!(contact(&setup, &lifted).normal_n, 0.0);
}

/// A wheel across a round bar touches over the part of its width in which the bar rises to it: the
/// force is the line load at each section's indentation, summed over the width.
#[test]
fn verify_edge_gap_leaves_the_wheel_s_edges_off_a_round_bar() {
    let bar = 60e-3;
    let setup = setup(Box::new(Bar { radius_m: bar }), WHEEL);
    let domain = setup.patch.surface.domain();
    let middle = [domain.u, domain.v].map(|range| 0.5 * (range[0] + range[1]));
    for d in [0.3e-3, 0.8e-3] {
        let state = held(&setup, middle, Vector3::y(), d, Vector3::zeros());
        let found = contact(&setup, &state);
        let line = |y: f64| {
            let indentation_m = d - (bar - (bar * bar - y * y).sqrt());
            let patch = WHEEL.patch(&setup.layer, indentation_m, WHEEL.radius_m);
            patch.free_force_n() / WHEEL.width_m
        };
        let n = 2000;
        let dy = WHEEL.width_m / f64::from(n);
        let expected: f64 = (0..n)
            .map(|k| line((f64::from(k) + 0.5) * dy - 0.5 * WHEEL.width_m) * dy)
            .sum();
        // the sum over nine strips of a force that ends within the width
        assert!(
            (found.force_n.z / expected - 1.0).abs() < 0.02,
            "{d}: {} {expected}",
            found.force_n.z
        );
        let rim = (2.0 * bar * d).sqrt().min(0.5 * WHEEL.width_m);
        assert!((found.width_m - 2.0 * rim).abs() < 2.0 * WHEEL.width_m / 9.0);
        assert!(found.force_n.y.abs() < 1e-9 * expected);
    }
}

/// The slack contact is a spring: what it does on a closed way of the wheel over a bar is nothing.
/// The way leads down, along the wheel's own axis, up and back.
#[test]
fn verify_no_work_on_a_closed_way() {
    let mut setup = setup(Box::new(Bar { radius_m: 60e-3 }), WHEEL);
    setup.abrasive.mu = 0.0;
    let domain = setup.patch.surface.domain();
    let middle = [domain.u, domain.v].map(|range| 0.5 * (range[0] + range[1]));
    let belt = Belt::new(setup.clone());
    let corner = |k: usize| {
        [(0.0, 0.0), (0.0, -0.5e-3), (4e-3, -0.5e-3), (4e-3, 0.0)]
            .map(|(y, z)| Vector3::new(0.0, y, z))[k % 4]
    };
    let (mut work, mut size) = (0.0, 0.0_f64);
    for k in 0..4 {
        let way = corner(k + 1) - corner(k);
        let steps = 400;
        for i in 0..steps {
            let off = corner(k) + way * ((f64::from(i) + 0.5) / f64::from(steps));
            let state = held(&setup, middle, Vector3::y(), 0.3e-3, off);
            let force = belt.contact_state(&state).0.force_n;
            let part = force.dot(&way) / f64::from(steps);
            work += part;
            size += part.abs();
        }
    }
    assert!(work.abs() < 2e-4 * size, "{work} of {size}");
}

/// Cells add up to the area of the face: a plane's, and a cylinder's shell.
#[test]
fn verify_areas_of_cells() {
    let flat: f64 = plane(WHEEL).area_m2.iter().sum();
    assert!((flat / 0.006 - 1.0).abs() < 1e-12);
    let round: f64 = setup(Box::new(Bar { radius_m: 60e-3 }), WHEEL)
        .area_m2
        .iter()
        .sum();
    assert!((round / (2.0 * 60e-3 * 0.2) - 1.0).abs() < 1e-12);
}

/// A pass of the wheel straight over a plane leaves `k_p v F'/v_f` under its whole width, also
/// where strips meet, whatever the size of the cells beside that of a strip.
#[test]
fn verify_a_pass_leaves_an_even_depth() {
    for cell_m in [1e-3, 0.7e-3] {
        let mut setup = plane(WHEEL);
        setup.cells = Cells::of(&setup.patch, cell_m);
        setup.area_m2 = Arc::new(setup.cells.areas_m2(&setup.patch));
        setup.is_face = Arc::new(cells_within(&setup.cells, setup.patch.clone()));
        let (d, dt, feed) = (0.4e-3, 1e-3, 0.05);
        let mut belt = Belt::new(setup.clone());
        for step in 0..1200 {
            let off = Vector3::x() * (feed * dt * (f64::from(step) + 0.5) - 30e-3);
            let mut state = held(&setup, [0.5, 0.5], Vector3::y(), d, off);
            state.time_s = f64::from(step) * dt;
            let loads = belt.evaluate(&state);
            belt.commit(&state, &loads, &ContactOutcomes::default(), dt);
        }
        belt.finish();
        let line = WHEEL.normal_force_n(d, WHEEL.radius_m) / WHEEL.width_m;
        let expected = setup.abrasive.preston_per_pa * setup.belt_m_per_s * line / feed;
        let [columns, rows] = setup.cells.count;
        for row in 0..rows {
            let cell = row * columns + columns / 2;
            let off = (setup.cells.middle(cell)[1] - 0.5) * 0.06;
            let depth = belt.worn[0].grid.removed_m()[cell];
            if off.abs() < 0.5 * WHEEL.width_m - 1e-3 {
                assert!(
                    (depth / expected - 1.0).abs() < 0.01,
                    "{off}: {}",
                    depth / expected
                );
            } else if off.abs() > 0.5 * WHEEL.width_m + 1e-3 {
                assert_eq!(depth, 0.0, "{off}");
            }
        }
        let volume = belt.worn[0].grid.volume_m3();
        assert!((volume / belt.watch.preston_m3(&setup) - 1.0).abs() < 1e-9);
    }
}

/// In the frame of a copy that stands elsewhere the contact is the same; the force is turned with
/// the face.
#[test]
fn a_copy_elsewhere_is_the_same_contact() {
    let mut setup = plane(WHEEL);
    let turn = UnitQuaternion::from_euler_angles(0.3, -0.2, 0.9);
    let stands = Isometry3::from_parts(Vector3::new(1.0, -0.2, 0.4).into(), turn);
    setup.copies.push(CopyAt {
        from_s: 2.0,
        world_from_patch: stands,
    });
    let state = held(
        &setup,
        [0.3, 0.6],
        Vector3::new(0.3, 1.0, 0.0),
        0.3e-3,
        Vector3::zeros(),
    );
    let here = Belt::new(setup.clone()).evaluate(&state).wrenches[0];
    let there = ToolState {
        time_s: 3.0,
        world_from_tool: stands * state.world_from_tool,
        ..state
    };
    let moved = Belt::new(setup).evaluate(&there).wrenches[0];
    assert!((moved.force_n - turn * here.force_n).norm() < 1e-9 * here.force_n.norm());
    assert!((moved.moment_n_m - turn * here.moment_n_m).norm() < 1e-9);
    assert!(Point3::from(here.force_n).coords.norm() > 1.0);
}
