//! The laws against closed forms.

use super::*;
use std::f64::consts::TAU;

fn spindle(damping: f64) -> ForceControl {
    ForceControl::Compliant {
        mass_kg: 2.0,
        stiffness_n_per_m: 5e3,
        damping_n_s_per_m: damping,
        preload_n: 20.0,
        stroke_m: 15e-3,
        stiction_n: 0.0,
    }
}

#[test]
fn verify_compliant_end_effector_rings_at_its_frequency_and_keeps_its_energy() {
    let omega = (5e3_f64 / 2.0).sqrt();
    let dt = TAU / omega / 500.0;
    let rest = 20.0 / 5e3;
    let mut s = Offset::default();
    for i in 1..=5000 {
        s = spindle(0.0).step(&s, 0.0, dt);
        let expected = rest * (1.0 - (omega * f64::from(i) * dt).cos());
        assert!((s.offset_m - expected).abs() < 2e-3 * rest, "{i}");
    }
    // where the rate is, half a step ago
    let middle = s.offset_m - 0.5 * dt * s.rate_m_per_s - rest;
    let energy = s.rate_m_per_s.powi(2) + 2500.0 * middle.powi(2);
    assert!((energy / (2500.0 * rest * rest) - 1.0).abs() < 1e-4);
    let mut later = s;
    for _ in 0..50_000 {
        later = spindle(0.0).step(&later, 0.0, dt);
    }
    let middle = later.offset_m - 0.5 * dt * later.rate_m_per_s - rest;
    let kept = later.rate_m_per_s.powi(2) + 2500.0 * middle.powi(2);
    assert!((kept / energy - 1.0).abs() < 1e-9, "{kept} {energy}");
}

#[test]
fn verify_damped_end_effector_comes_to_rest_at_the_balance_of_forces() {
    let mut s = Offset::default();
    for _ in 0..20_000 {
        s = spindle(200.0).step(&s, 12.0, 1e-3);
    }
    assert!((s.offset_m - 8.0 / 5e3).abs() < 1e-9 && s.rate_m_per_s.abs() < 1e-9);
    for _ in 0..20_000 {
        s = spindle(200.0).step(&s, -200.0, 1e-3);
    }
    assert_eq!(s.offset_m, 15e-3);
}

/// Between its own spring and a contact's nothing damps it, and no step drives it, up to 1/ω: after
/// thirty swings it comes as far as at first.
#[test]
fn verify_a_mass_on_a_contact_keeps_its_swing() {
    let contact = 2e5;
    let omega = ((5e3 + contact) / 2.0_f64).sqrt();
    for steps in [140, 31, 7] {
        let dt = TAU / omega / f64::from(steps);
        let mut s = Offset::at(1e-4);
        let mut farthest = [0.0_f64; 2];
        for i in 0..32 * steps {
            // the preload is what a contact pressed in by 0.1 mm holds
            s = spindle(0.0).step(&s, 20.0 + contact * s.offset_m, dt);
            if i < 2 * steps {
                farthest[0] = farthest[0].max(s.offset_m.abs());
            } else if i >= 30 * steps {
                farthest[1] = farthest[1].max(s.offset_m.abs());
            }
        }
        // The longest steps meet the turning points by chance only.
        let tolerance = if steps < 10 { 0.1 } else { 0.01 };
        let [first, last] = farthest;
        assert!(
            (last / first - 1.0).abs() < tolerance,
            "{steps}: {farthest:?}"
        );
        assert!(
            (first / 1e-4 - 1.0).abs() < 2.0 * tolerance,
            "{steps}: {first}"
        );
    }
}

/// Against a spring k the error falls as e^{-k t / c}.
#[test]
fn verify_constant_force_is_reached_exponentially_and_within_the_speed_limit() {
    let law = |fastest| ForceControl::ConstantForce {
        force_n: 20.0,
        damping_n_s_per_m: 4e3,
        fastest_m_per_s: fastest,
        stroke_m: f64::INFINITY,
        stiction_n: 0.0,
    };
    let (k, dt) = (2e4, 1e-5);
    let mut s = Offset::default();
    for _ in 0..20_000 {
        s = law(1.0).step(&s, k * s.offset_m, dt);
    }
    let left = 1.0 - k * s.offset_m / 20.0;
    assert!(
        (left / (-k * 0.2 / 4e3_f64).exp() - 1.0).abs() < 1e-3,
        "{left}"
    );
    assert_eq!(law(1e-3).step(&Offset::default(), 0.0, 0.1).offset_m, 1e-4);
    assert_eq!(ForceControl::Position.step(&s, 5.0, dt).offset_m, 0.0);
}

#[test]
fn verify_a_lifted_carrier_rests_where_it_is_left_alone() {
    let soft = |stiffness_n_per_m, preload_n| ForceControl::Compliant {
        mass_kg: 2.0,
        stiffness_n_per_m,
        damping_n_s_per_m: 50.0,
        preload_n,
        stroke_m: 15e-3,
        stiction_n: 0.0,
    };
    for (control, expected) in [
        (soft(5e3, 20.0), 4e-3),
        (soft(5e3, 200.0), 15e-3),
        (soft(0.0, -1.0), -15e-3),
        (ForceControl::Position, 0.0),
    ] {
        assert_eq!(control.lifted_m(), expected);
        let rest = control.step(&Offset::at(expected), 0.0, 1e-3);
        assert!((rest.offset_m - expected).abs() < 1e-15, "{rest:?}");
    }
    assert!(soft(0.0, 0.0).lifted_m().is_finite());
}

/// A mass on a spring under dry friction loses `2 F/k` of its amplitude in every half swing and
/// stops within `F/k` of rest.
#[test]
fn verify_a_rubbing_carrier_loses_the_same_amplitude_in_every_half_swing() {
    let (k, friction) = (5e3, 4.0);
    let guide = ForceControl::Compliant {
        mass_kg: 2.0,
        stiffness_n_per_m: k,
        damping_n_s_per_m: 0.0,
        preload_n: 0.0,
        stroke_m: 15e-3,
        stiction_n: friction,
    };
    let dt = TAU / (k / 2.0_f64).sqrt() / 2000.0;
    let mut s = Offset {
        offset_m: 10.2e-3,
        ..Offset::default()
    };
    let mut turns = Vec::new();
    for _ in 0..20_000 {
        let before = s.rate_m_per_s;
        s = guide.step(&s, 0.0, dt);
        if before != 0.0 && before * s.rate_m_per_s <= 0.0 {
            turns.push(s.offset_m);
        }
    }
    assert_eq!(turns.len(), 6, "{turns:?}");
    for (n, turn) in turns.iter().enumerate() {
        let expected = 10.2e-3 - 2.0 * friction / k * (n as f64 + 1.0);
        assert!((turn.abs() - expected.abs()).abs() < 2e-6, "{n}: {turn}");
    }
    // held: friction is what the spring asks for
    assert_eq!(s.rate_m_per_s, 0.0);
    assert!((s.friction_n - k * s.offset_m).abs() < 1e-9);
}

/// What lacks less than the stiction is not made up for; beyond it the error that stays is the
/// stiction.
#[test]
fn verify_a_sticking_control_leaves_its_stiction_as_an_error() {
    let law = ForceControl::ConstantForce {
        force_n: 20.0,
        damping_n_s_per_m: 4e3,
        fastest_m_per_s: 1.0,
        stroke_m: 5e-3,
        stiction_n: 1.5,
    };
    let (k, dt) = (2e4, 1e-4);
    let mut s = Offset::default();
    for _ in 0..50_000 {
        s = law.step(&s, k * s.offset_m, dt);
    }
    assert!((k * s.offset_m - 18.5).abs() < 1e-6);
    let held = law.step(&s, 21.4, dt);
    assert_eq!(held.offset_m, s.offset_m);
    // off the face it goes to the end of its stroke and stays
    for _ in 0..50_000 {
        s = law.step(&s, 0.0, dt);
    }
    assert_eq!((s.offset_m, s.rate_m_per_s), (5e-3, 0.0));
}
