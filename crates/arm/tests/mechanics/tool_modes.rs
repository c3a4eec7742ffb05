//! The arm with modes of its tool: assembled matrices against receptances coupled in series.

use std::f64::consts::TAU;
use std::path::Path;

use nalgebra::{Complex, DMatrix, DVector};
use truecut_arm::{FrameId, LinearArm, Load, Robot};
use truecut_core::chatter::{AttachedMode, AttachedModes};

use super::response::{response, sum_over_modes};

const POSTURE: [f64; 6] = [-0.8444, 0.9568, 0.1197, 0.9453, 1.8750, -0.3831];

fn robot() -> Robot {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/irb6600_175_255");
    Robot::load(
        &root.join("robot.urdf"),
        Some(&root.join("milling.toml")),
        None,
    )
    .expect("loads")
}

fn mode(hz: f64, ratio: f64, n_per_um: f64, direction: [f64; 3]) -> AttachedMode {
    AttachedMode::new(hz, ratio, 1e6 * n_per_um, direction)
}

/// Two modes in one direction and a skew one, in the axes of the tip Jacobian.
fn modes() -> [AttachedMode; 3] {
    [
        mode(1000.0, 0.03, 10.0, [1.0, 0.0, 0.0]),
        mode(2300.0, 0.015, 35.0, [1.0, 0.0, 0.0]),
        mode(870.0, 0.02, 8.0, [0.3, 1.0, 0.2]),
    ]
}

fn arm() -> LinearArm {
    let robot = robot();
    robot
        .linearised(&POSTURE, FrameId::Tool, &Load::none())
        .expect("stiff")
}

type Receptance = DMatrix<Complex<f64>>;

/// The tip's receptance by coupling: the arm without the modes' masses, with receptance H, is
/// pushed by spring and damper p_i of each mode and by what of the force no mode takes; each mass
/// is free, with receptance -1/(m ω²), under its part of the force less p_i.
fn in_series(arm: &LinearArm, modes: &[AttachedMode], hz: f64) -> Receptance {
    let complex = |v: f64| Complex::new(v, 0.0);
    let omega = TAU * hz;
    let mut bare = arm.clone();
    for mode in modes {
        let row = arm.tip_jacobian.tr_mul(&mode.direction);
        bare.mass -= &row * row.transpose() * mode.mass_kg();
    }
    let foot = response(&bare, hz);
    let n = modes.len();
    let directions = DMatrix::from_fn(3, n, |r, c| complex(modes[c].direction[r]));
    let foot = DMatrix::from_fn(3, 3, |r, c| foot[(r, c)]);
    let free = DVector::from_fn(n, |i, _| {
        complex(-1.0 / (modes[i].mass_kg() * omega * omega))
    });
    let spring = DVector::from_fn(n, |i, _| {
        Complex::new(
            modes[i].stiffness_n_per_m,
            omega * modes[i].damping_n_s_per_m(),
        )
    });
    // p = κ (z − nᵀx), z = g (nᵀF − p), x = H (F + N (p − NᵀF)).
    let within = directions.transpose() * &foot * &directions;
    let left = DMatrix::from_fn(n, n, |i, j| {
        let own = if i == j {
            spring[i].inv() + free[i]
        } else {
            complex(0.0)
        };
        own + within[(i, j)]
    });
    let taken = directions.transpose();
    let right =
        DMatrix::from_diagonal(&free) * &taken - directions.transpose() * &foot + &within * &taken;
    let passed = left.lu().solve(&right).expect("regular");
    let unit = DMatrix::<Complex<f64>>::identity(3, 3);
    let foot_moves = &foot * (unit + &directions * (&passed - &taken));
    let masses_move = DMatrix::from_diagonal(&free) * (&taken - &passed);
    &foot_moves + &directions * (masses_move - directions.transpose() * &foot_moves)
}

#[test]
fn verify_assembled_matrices_have_the_receptance_of_the_series() {
    let arm = arm();
    let all = modes();
    for modes in [&all[..1], &all[1..], &all[..]] {
        let together = arm.with_tool(modes).expect("lighter than the arm");
        for hz in [0.5, 7.0, 40.0, 300.0, 868.0, 1003.0, 1500.0, 2310.0, 5000.0] {
            let assembled = response(&together, hz);
            let series = in_series(&arm, modes, hz);
            let size = assembled.map(|c| c.norm()).amax();
            let apart = (0..3).flat_map(|r| (0..3).map(move |c| (r, c)));
            let worst = apart
                .map(|at| (assembled[at] - series[at]).norm())
                .fold(0.0, f64::max);
            assert!(
                worst < 1e-9 * size,
                "{} modes at {hz} Hz: {}",
                modes.len(),
                worst / size
            );
        }
    }
}

/// A stiff tool leaves the arm as it was, and at rest compliances add up.
#[test]
fn verify_a_stiff_tool_changes_nothing_and_compliances_add_up() {
    let arm = arm();
    let before = arm.modes().expect("stable").frequency_hz;
    let stiff = arm
        .with_tool(&[mode(30e3, 0.01, 9000.0, [0.0, 1.0, 0.0])])
        .expect("light");
    let after = stiff.modes().expect("stable").frequency_hz;
    for (a, b) in before.iter().zip(&after) {
        assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
    }
    let modes = modes();
    let together = response(&arm.with_tool(&modes).expect("light"), 0.0);
    let alone = response(&arm, 0.0);
    let added = modes.iter().map(AttachedMode::compliance_m_per_n);
    let sum = added.fold(alone.map(|c| c.re), |sum, one| sum + one);
    assert!((together.map(|c| c.re) - sum).amax() < 1e-9 * sum.amax());
}

/// What the sum over real modes leaves out where tool and arm are damped unlike each other.
#[test]
fn regress_the_sum_over_modes_is_within_half_a_per_cent_of_the_full_damping() {
    let modes = modes();
    let together = arm().with_tool(&modes).expect("light");
    let shapes = together.modes().expect("stable");
    let mut worst = 0.0_f64;
    for step in 0..400 {
        let hz = 400.0 * (3000.0_f64 / 400.0).powf(f64::from(step) / 399.0);
        let full = response(&together, hz);
        let sum = sum_over_modes(&together, &shapes, hz);
        let size = full.map(|c| c.norm()).amax();
        worst = worst.max((full - sum).map(|c| c.norm()).amax() / size);
    }
    println!("{worst:.2e}");
    assert!(worst < 5e-3, "{worst}");
}

/// Modes of the workpiece stand beside the others.
#[test]
fn verify_modes_of_the_workpiece_are_their_own() {
    let robot = robot();
    let workpiece = vec![mode(350.0, 0.01, 4.0, [0.0, 0.0, 1.0])];
    let attached = AttachedModes {
        workpiece,
        ..AttachedModes::default()
    };
    let found = robot.cutting_modes(&POSTURE, &attached).expect("stiff");
    let arm = robot
        .tip_modes(&POSTURE, FrameId::Tool, None)
        .expect("stiff");
    assert_eq!(found[..6], arm[..]);
    assert_eq!(found[6], attached.workpiece[0].held());
}

#[test]
fn a_tool_heavier_than_the_arm_is_refused() {
    let error = arm()
        .with_tool(&[mode(10.0, 0.02, 10.0, [1.0, 0.0, 0.0])])
        .expect_err("2.5 t");
    assert!(
        error.to_string().contains("must weigh less than the arm"),
        "{error}"
    );
}
