//! A wheel on a carrier whose tool is held, or moves, over a plane.

use super::tests::{WHEEL, held, plane};
use super::*;

const DT_S: f64 = 1e-4;
/// How far the tool's path reaches into the plane.
const DEPTH_M: f64 = 0.3e-3;
const CONSTANT: ForceControl = ForceControl::ConstantForce {
    force_n: 30.0,
    damping_n_s_per_m: 2000.0,
    fastest_m_per_s: 0.05,
    stroke_m: 2e-3,
    stiction_n: 0.0,
};

fn compliant(preload_n: f64, damping_n_s_per_m: f64) -> ForceControl {
    ForceControl::Compliant {
        mass_kg: 1.5,
        stiffness_n_per_m: 2e3,
        damping_n_s_per_m,
        preload_n,
        stroke_m: 2e-3,
        stiction_n: 0.0,
    }
}

/// The process with a carrier, run over a plane with the tool so deep in it, m, and so fast towards
/// it, m/s. `see` is given the loads on the tool and the process after each step.
fn run_pressed(
    control: ForceControl,
    steps: usize,
    depth: impl Fn(f64) -> (f64, f64),
    mut see: impl FnMut(f64, &Wrench, &Belt),
) {
    let setup = BeltSetup {
        control,
        ..plane(WHEEL)
    };
    let mut belt = Belt::new(setup.clone());
    if depth(0.0).0 > 0.0 {
        // It begins pressed on, not in the air.
        belt.carrier = Offset::default();
    }
    for step in 0..steps {
        let time_s = step as f64 * DT_S;
        let (depth_m, rate_m_per_s) = depth(time_s);
        let mut state = held(&setup, [0.5, 0.5], Vector3::y(), depth_m, Vector3::zeros());
        state.time_s = time_s;
        state.tool.velocity_m_per_s = -Vector3::z() * rate_m_per_s;
        let loads = belt.evaluate(&state);
        belt.commit(&state, &loads, &ContactOutcomes::default(), DT_S);
        see(time_s, &loads.wrenches[0], &belt);
    }
}

/// Whatever the path's depth, the force comes to what is asked; a face that comes closer at a
/// steady speed w presses by `c w` more, which is what drives the carrier back. The tool is pushed
/// by all of it.
#[test]
fn verify_a_held_force_does_not_depend_on_the_path() {
    for depth_m in [-0.4e-3, 0.0, DEPTH_M, 0.9e-3] {
        let mut last = (0.0, 0.0);
        run_pressed(
            CONSTANT,
            4000,
            |_| (depth_m, 0.0),
            |_, on_tool, belt| {
                last = (belt.last.contact.normal_n, on_tool.force_n.z);
            },
        );
        assert!((last.0 - 30.0).abs() < 1e-6, "{depth_m}: {}", last.0);
        assert!((last.1 - 30.0).abs() < 1e-6, "{depth_m}: {}", last.1);
    }
    let w = 1.5e-3;
    let mut last = 0.0;
    run_pressed(
        CONSTANT,
        8000,
        |t| (w * t - 0.5e-3, w),
        |_, _, belt| last = belt.last.contact.normal_n,
    );
    // The slope of the force grows a little with what the carrier has not yet made up for.
    assert!((last - 30.0 - 2000.0 * w).abs() < 0.01, "{last}");
}

/// About its balance the carrier's mass swings between its own spring and the contact's.
#[test]
fn verify_a_compliant_carrier_swings_on_both_springs() {
    let setup = plane(WHEEL);
    let force = |d: f64| setup.wheel.normal_force_n(d, setup.wheel.radius_m);
    let h = 1e-3 * DEPTH_M;
    let contact = (force(DEPTH_M + h) - force(DEPTH_M - h)) / (2.0 * h);
    let expected_hz = ((2e3 + contact) / 1.5).sqrt() / TAU;
    // A little less than what the path alone presses with: it begins a little off its balance, and
    // nothing damps it. The contact is softer where it presses less, which takes 2e-3 off the
    // frequency.
    let preload_n = 0.99 * force(DEPTH_M);
    let rest_m = (preload_n - force(DEPTH_M)) / (2e3 + contact);
    let (mut crossings, mut before) = (Vec::new(), 0.0);
    let still = |_| (DEPTH_M, 0.0);
    run_pressed(compliant(preload_n, 0.0), 8000, still, |time_s, _, belt| {
        let off = belt.carrier.offset_m - rest_m;
        if before < 0.0 && off >= 0.0 {
            crossings.push(time_s);
        }
        before = off;
    });
    let count = crossings.len() as f64 - 1.0;
    let found_hz = count / (crossings[crossings.len() - 1] - crossings[0]);
    assert!(count > 20.0, "{count}");
    assert!(
        (found_hz / expected_hz - 1.0).abs() < 4e-3,
        "{found_hz} {expected_hz}"
    );
    // Damped it comes to rest, and its spring gives the tool what the contact gives the wheel;
    // friction passes across the carrier.
    let (mut end, mut on_tool) = (0.0, Vector3::zeros());
    let damped = compliant(preload_n, 60.0);
    run_pressed(damped, 8000, still, |_, wrench, belt| {
        (end, on_tool) = (belt.carrier.offset_m, wrench.force_n);
    });
    assert!((end / rest_m - 1.0).abs() < 0.01, "{end} {rest_m}");
    assert!(
        (on_tool.z / (preload_n - 2e3 * end) - 1.0).abs() < 1e-6,
        "{on_tool}"
    );
    assert!(
        (on_tool.x / (0.3 * on_tool.z) - 1.0).abs() < 1e-3,
        "{on_tool}"
    );
}

/// Lifted, a carrier goes to the end of its stroke; pressed beyond the other end it is a rigid
/// wheel.
#[test]
fn verify_stops_end_the_stroke() {
    for control in [CONSTANT, compliant(30.0, 0.0)] {
        let mut end = 0.0;
        let lifted = |_| (-20e-3, 0.0);
        run_pressed(control, 4000, lifted, |_, on_tool, belt| {
            end = belt.last.carrier_m;
            assert_eq!(on_tool.force_n.x, 0.0);
        });
        assert_eq!(end, 2e-3);
        let mut last = (0.0, 0.0);
        run_pressed(
            control,
            8000,
            |t| ((t * 0.02).min(3.5e-3), 0.0),
            |_, on_tool, belt| {
                last = (belt.last.carrier_m, on_tool.force_n.z);
            },
        );
        let rigid = WHEEL.normal_force_n(1.5e-3, WHEEL.radius_m);
        assert_eq!(last.0, -2e-3);
        assert!((last.1 / rigid - 1.0).abs() < 1e-4, "{} {rigid}", last.1);
    }
}
