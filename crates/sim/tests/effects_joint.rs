//! Effects on joints, against closed forms.

use crate::support::{ARM_POSTURE, column, load, peaks, period, run, wheel};
use std::f64::consts::{PI, TAU};
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Target};

fn joint(kind: EffectKind, joint: usize, values: &[f64]) -> Effect {
    Effect {
        kind,
        target: Target::Joint(joint),
        values: values.to_vec(),
    }
}

/// 100 kg on 1e6 N/m without damping, drawn aside by `force_n` and let go.
fn decay(force_n: f64, duration_s: f64) -> Scenario {
    load(
        "rig_1dof",
        "damping_scale = 0.0\ngravity = false",
        &format!("duration_s = {duration_s}"),
        &format!("release_n = [{force_n}, 0.0, 0.0]"),
    )
}

/// The same carriage without drive, pushed by a constant force.
fn pushed(force_n: f64, step_ms: f64, duration_s: f64) -> Scenario {
    load(
        "rig_1dof",
        "drive = \"force\"\ngravity = false",
        &format!("duration_s = {duration_s}\ntime_step_ms = {step_ms}"),
        &format!("constant_n = [{force_n}, 0.0, 0.0]"),
    )
}

/// Dry friction takes `4F/k` off the amplitude in every cycle, and then holds.
#[test]
fn verify_coulomb_takes_four_f_over_k_a_cycle() {
    let friction = 20.0;
    let recording = run(
        &decay(1000.0, 1.5),
        &[joint(EffectKind::JointCoulomb, 0, &[friction])],
    );
    let x = column(&recording, "joint1.position");
    let found = peaks(x);
    for pair in found.windows(2).take(8) {
        let lost = pair[0] - pair[1];
        assert!((lost / (4.0 * friction / 1e6) - 1.0).abs() < 0.01, "{lost}");
    }
    let tail = &x[x.len() - 200..];
    assert!(tail.iter().all(|v| *v == tail[0]), "held to the bit");
    assert!(tail[0].abs() <= friction / 1e6);
}

/// Friction that grows with the load makes the spring weaker by `1 - s` on the way in and stiffer
/// by `1 + s` on the way out: a swing ends at `√((1 - s)/(1 + s))` of its beginning and lasts
/// `π/2ω (1/√(1 - s) + 1/√(1 + s))`.
#[test]
fn verify_load_friction_takes_its_part_of_every_swing() {
    let share = 0.05;
    let recording = run(
        &decay(1000.0, 1.0),
        &[joint(EffectKind::JointLoadFriction, 0, &[share])],
    );
    let x = column(&recording, "joint1.position");
    let found = peaks(x);
    assert!(found.len() > 8);
    let kept = (1.0 - share) / (1.0 + share);
    for pair in found.windows(2).take(8) {
        assert!((pair[1] / pair[0] / kept - 1.0).abs() < 1e-3, "{pair:?}");
    }
    let cycle = PI / 100.0 * ((1.0 - share).powf(-0.5) + (1.0 + share).powf(-0.5));
    let ratio = period(&recording, x) / cycle;
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
}

/// Across the play the carriage flies at `ω A`: `T = 2π/ω + 2 gap / (ω A)`, and it starts half the
/// gap out.
#[test]
fn verify_backlash_is_free_play() {
    let gap = 4e-4;
    let recording = run(
        &decay(1000.0, 2.0),
        &[joint(EffectKind::JointBacklash, 0, &[gap])],
    );
    let x = column(&recording, "joint1.position");
    assert!((x[0] - (1e-3 + 0.5 * gap)).abs() < 1e-12, "{}", x[0]);
    let expected = TAU / 100.0 + 2.0 * gap / (100.0 * 1e-3);
    assert!((period(&recording, x) / expected - 1.0).abs() < 1e-3);
    let force = column(&recording, "joint1.transmission_force");
    let inside = x.iter().zip(force).filter(|(x, _)| x.abs() < 0.49 * gap);
    assert!(inside.clone().count() > 100 && inside.into_iter().all(|(_, f)| *f == 0.0));
}

/// At rest under F the wind-up w carries `k w + k3 w³ = F`.
#[test]
fn verify_cubic_stiffness_at_rest() {
    let cubic = 5e11;
    let recording = run(
        &decay(1000.0, 0.01),
        &[joint(EffectKind::JointCubicStiffness, 0, &[cubic])],
    );
    let w = column(&recording, "joint1.position")[0];
    assert!(w < 0.9e-3);
    assert!(
        ((1e6 * w + cubic * w.powi(3)) / 1000.0 - 1.0).abs() < 1e-9,
        "{w}"
    );
}

#[test]
fn verify_stiffness_and_damping_factors() {
    let recording = run(
        &decay(1000.0, 1.0),
        &[joint(EffectKind::JointStiffness, 0, &[0.49])],
    );
    let x = column(&recording, "joint1.position");
    assert!((x[0] - 1e-3 / 0.49).abs() < 1e-12);
    assert!((period(&recording, x) / (TAU / 70.0) - 1.0).abs() < 1e-3);

    let damped = load(
        "rig_1dof",
        "gravity = false",
        "duration_s = 1.0",
        "release_n = [1000.0, 0.0, 0.0]",
    );
    for (effect, damping) in [
        (joint(EffectKind::JointDamping, 0, &[2.5]), 1000.0),
        (joint(EffectKind::JointViscous, 0, &[350.0]), 750.0),
        (
            joint(EffectKind::JointAsymmetricViscous, 0, &[350.0, 350.0]),
            750.0,
        ),
    ] {
        let recording = run(&damped, &[effect]);
        let found = peaks(column(&recording, "joint1.position"));
        let decay = (found[0] / found[4]).ln() / 4.0;
        let ratio: f64 = damping / (2.0 * 1e4);
        let expected = TAU * ratio / (1.0 - ratio * ratio).sqrt();
        assert!(
            (decay / expected - 1.0).abs() < 2e-3,
            "{damping}: {decay} {expected}"
        );
    }
}

/// `v = F/c (1 - exp(-c t/m))`, with an error that falls with the square of the step.
#[test]
fn verify_viscous_friction_is_of_second_order() {
    let (force, c, mass) = (50.0, 2000.0, 100.0);
    for kind in [EffectKind::JointViscous, EffectKind::JointAsymmetricViscous] {
        let error = |step_ms: f64| {
            let values = [c, 3.0 * c];
            let values = &values[..kind.parameters().len()];
            let recording = run(&pushed(force, step_ms, 0.1), &[joint(kind, 0, values)]);
            let x = column(&recording, "joint1.position");
            let t = recording.time_s[x.len() - 1];
            let tau = mass / c;
            let exact = force / c * (t + tau * (-t / tau).exp_m1());
            (x[x.len() - 1] - exact).abs() / exact
        };
        let (coarse, fine) = (error(2.0), error(0.5));
        assert!(
            fine < 1e-4 && (10.0..25.0).contains(&(coarse / fine)),
            "{coarse} {fine}"
        );
    }
}

/// With free joints the link's friction still acts: it holds below its level and takes it off
/// above.
#[test]
fn verify_link_friction_acts_without_a_drive() {
    for (effects, level) in [
        (vec![joint(EffectKind::JointCoulomb, 0, &[30.0])], 30.0),
        (
            vec![joint(EffectKind::JointAsymmetricCoulomb, 0, &[30.0, 70.0])],
            30.0,
        ),
        (
            vec![
                joint(EffectKind::JointCoulomb, 0, &[10.0]),
                joint(EffectKind::JointAsymmetricCoulomb, 0, &[20.0, 0.0]),
            ],
            30.0,
        ),
        (vec![joint(EffectKind::JointOffset, 0, &[-30.0])], 30.0),
    ] {
        let recording = run(&pushed(80.0, 0.25, 0.2), &effects);
        let x = column(&recording, "joint1.position");
        let t = recording.time_s[x.len() - 1];
        let expected = 0.5 * (80.0 - level) / 100.0 * t * t;
        assert!(
            (x[x.len() - 1] / expected - 1.0).abs() < 1e-6,
            "{effects:?}"
        );
    }
    let held = run(
        &pushed(29.9, 0.25, 0.2),
        &[joint(EffectKind::JointCoulomb, 0, &[30.0])],
    );
    assert!(column(&held, "joint1.position").iter().all(|x| *x == 0.0));
    let peak = [
        joint(EffectKind::JointCoulomb, 0, &[20.0]),
        joint(EffectKind::JointStribeck, 0, &[10.0, 1e-3]),
    ];
    let held = run(&pushed(29.9, 0.25, 0.2), &peak);
    assert!(column(&held, "joint1.position").iter().all(|x| *x == 0.0));
    // Broken away, it is soon faster than the Stribeck speed and rubs with Coulomb's level alone.
    let moving = run(&pushed(31.0, 0.25, 0.5), &peak);
    let v = column(&moving, "joint1.velocity");
    let rate = (v[v.len() - 1] - v[v.len() - 401]) / 0.1;
    assert!(
        (rate / ((31.0 - 20.0) / 100.0) - 1.0).abs() < 1e-3,
        "{rate}"
    );
}

/// Elastic-plastic friction takes energy in every swing, the more the larger, and none appears.
#[test]
fn verify_hysteresis_damps_by_its_loop() {
    let (amplitude, yield_windup) = (30.0, 1e-4);
    let recording = run(
        &decay(1000.0, 1.0),
        &[joint(
            EffectKind::JointHysteresis,
            0,
            &[amplitude, yield_windup],
        )],
    );
    let found = peaks(column(&recording, "joint1.position"));
    for pair in found.windows(2).take(6) {
        // The loop of the mean amplitude is what a cycle takes from k A²/2.
        let mean = 0.5 * (pair[0] + pair[1]);
        let loop_area = 4.0 * amplitude * (mean - yield_windup * (mean / yield_windup).tanh());
        let lost = 0.5 * 1e6 * (pair[0].powi(2) - pair[1].powi(2));
        assert!((lost / loop_area - 1.0).abs() < 0.05, "{lost} {loop_area}");
    }
}

/// Slowly fed, the link follows motor coordinate plus transmission error.
#[test]
fn verify_ripple_moves_a_slowly_fed_link() {
    let (cosine, sine, cycles) = (2e-5, -1e-5, 10.0);
    let scenario = wheel();
    let nominal = run(&scenario, &[]);
    let with = run(
        &scenario,
        &[joint(EffectKind::JointRipple, 1, &[cosine, sine, cycles])],
    );
    let command = column(&with, "joint2.command");
    let (a, b) = (
        column(&nominal, "joint2.position"),
        column(&with, "joint2.position"),
    );
    assert!((command[command.len() - 1] - command[0]).abs() > 0.07);
    for i in (0..command.len()).step_by(50) {
        let (s, c) = (TAU * cycles * command[i]).sin_cos();
        let expected = cosine * c + sine * s;
        assert!(
            (b[i] - a[i] - expected).abs() < 0.03 * 2.3e-5,
            "{}: {}",
            b[i] - a[i],
            expected
        );
    }
}

/// A spring that balances the link takes its torque off the transmission.
#[test]
fn verify_counterbalance_relieves_the_transmission() {
    let scenario = load(
        "irb6600_175_255",
        ARM_POSTURE,
        "duration_s = 0.01",
        "constant_n = [0.0, 0.0, 0.0]",
    );
    let (cosine, sine) = (900.0, -400.0);
    let nominal = run(&scenario, &[]);
    let with = run(
        &scenario,
        &[joint(EffectKind::JointCounterbalance, 1, &[cosine, sine])],
    );
    let q = column(&with, "joint2.angle")[0];
    let relieved = column(&nominal, "joint2.transmission_torque")[0]
        - column(&with, "joint2.transmission_torque")[0];
    let expected = cosine * q.cos() + sine * q.sin();
    assert!(
        (relieved / expected - 1.0).abs() < 2e-3,
        "{relieved} {expected}"
    );
    let drift = column(&with, "joint2.velocity")
        .iter()
        .fold(0.0, |a: f64, v| a.max(v.abs()));
    assert!(drift < 1e-9, "it starts at rest: {drift}");
}

/// A curve through a spring's torque relieves the transmission as the spring does, at rest and in
/// motion: what is left is the spline's own error, the fourth power of the distance of its values.
#[test]
fn verify_a_curve_over_the_position_is_the_spring_it_follows() {
    let scenario = load(
        "irb6600_175_255",
        ARM_POSTURE,
        "duration_s = 0.2",
        "release_n = [800.0, -600.0, 900.0]",
    );
    let (cosine, sine) = (900.0, -400.0);
    let spring = run(
        &scenario,
        &[joint(EffectKind::JointCounterbalance, 1, &[cosine, sine])],
    );
    let angles = column(&spring, "joint2.angle");
    let low = angles.iter().copied().fold(f64::INFINITY, f64::min) - 0.05;
    let error = |places: usize| {
        let high = low + 0.4;
        let at = |i: usize| low + (high - low) * i as f64 / (places - 1) as f64;
        let torque = |i: usize| cosine * at(i).cos() + sine * at(i).sin();
        let values: Vec<f64> = [low, high]
            .into_iter()
            .chain((0..places).map(torque))
            .collect();
        let curve = run(
            &scenario,
            &[joint(EffectKind::JointPositionCurve, 1, &values)],
        );
        let pairs = column(&curve, "joint2.angle").iter().zip(angles);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let swing = angles
        .iter()
        .map(|a| (a - angles[0]).abs())
        .fold(0.0, f64::max);
    let [coarse, fine] = [5, 33].map(error);
    assert!(
        fine < 1e-4 * swing && fine < coarse,
        "{fine} {coarse} of {swing}"
    );
}

/// Constant friction over the position is Coulomb's to the bit; friction that rises with the speed
/// is the viscous one by direction.
#[test]
fn verify_curves_of_friction_have_the_named_laws_as_limits() {
    let scenario = decay(50.0, 0.5);
    let x = |effects: &[Effect]| column(&run(&scenario, effects), "joint1.position").to_vec();
    let dry = x(&[joint(EffectKind::JointCoulomb, 0, &[3.0])]);
    for values in [&[-1.0, 1.0, 3.0][..], &[-1.0, 1.0, 3.0, 3.0, 3.0, 3.0]] {
        assert_eq!(
            x(&[joint(EffectKind::JointFrictionByPosition, 0, values)]),
            dry
        );
    }
    let viscous = x(&[joint(
        EffectKind::JointAsymmetricViscous,
        0,
        &[200.0, 200.0],
    )]);
    let line = [0.0, 2.0, 0.0, 100.0, 200.0, 300.0, 400.0];
    let curve = x(&[joint(EffectKind::JointFrictionBySpeed, 0, &line)]);
    let largest = viscous.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    let pairs = curve.iter().zip(&viscous);
    let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-9 * largest, "{apart} of {largest}");
}

/// The servo's rotor starts at rest with effects as without, and follows the motor side of the
/// ripple.
#[test]
fn verify_a_servo_starts_at_rest_with_effects() {
    let settings = format!("{ARM_POSTURE}\ndrive = \"servo\"");
    let scenario = load(
        "irb6600_175_255",
        &settings,
        "duration_s = 0.05",
        "constant_n = [0.0, 0.0, 0.0]",
    );
    let effects = [
        joint(EffectKind::JointRipple, 1, &[2e-5, 1e-5, 80.0]),
        joint(EffectKind::JointBacklash, 2, &[1e-4]),
        joint(EffectKind::JointCubicStiffness, 1, &[1e11]),
        joint(EffectKind::JointCounterbalance, 2, &[200.0, 100.0]),
    ];
    let with = run(&scenario, &effects);
    for number in 1..=6 {
        let v = column(&with, &format!("joint{number}.velocity"));
        let fastest = v.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        assert!(fastest < 1e-8, "joint {number}: {fastest}");
    }
}

/// The same swing point by point: `m x'' = -k (1 -+ s) x` on the way in and out. The error falls
/// with the square of the step.
#[test]
fn verify_load_friction_converges_to_second_order() {
    let share: f64 = 0.2;
    let [inward, outward] = [1.0 - share, 1.0 + share].map(|part| 100.0 * part.sqrt());
    let [quarter_in, quarter_out] = [inward, outward].map(|omega| PI / 2.0 / omega);
    let exact = |mut t: f64| {
        let mut amplitude = 1e-3;
        while t > quarter_in + quarter_out {
            t -= quarter_in + quarter_out;
            amplitude *= -inward / outward;
        }
        match t - quarter_in {
            after if after > 0.0 => -amplitude * inward / outward * (outward * after).sin(),
            _ => amplitude * (inward * t).cos(),
        }
    };
    let worst = |step_ms: f64| {
        let scenario = load(
            "rig_1dof",
            "damping_scale = 0.0\ngravity = false",
            &format!("duration_s = 0.3\ntime_step_ms = {step_ms}"),
            "release_n = [1000.0, 0.0, 0.0]",
        );
        let effect = joint(EffectKind::JointLoadFriction, 0, &[share]);
        let recording = run(&scenario, &[effect]);
        let x = column(&recording, "joint1.position");
        let off = recording.time_s.iter().zip(x);
        let off = off.map(|(t, x)| (x - exact(*t)).abs());
        off.fold(0.0, f64::max) / 1e-3
    };
    let errors = [0.4, 0.2, 0.1, 0.05].map(worst);
    println!("{errors:?}");
    for pair in errors.windows(2) {
        assert!(pair[0] / pair[1] > 3.0, "{errors:?}");
    }
}

/// One mode's damping ratio is the joint's damping said otherwise: what the transmission passes on,
/// and so the friction that grows with it, is the same.
#[test]
fn verify_load_friction_knows_the_damping_of_modes() {
    // 100 kg on 1e6 N/m.
    let ratio: f64 = 0.05;
    let damping = 2.0 * ratio * (1e6_f64 * 100.0).sqrt();
    let own = truecut_arm::Robot::load(&decay(0.0, 0.1).robot.urdf, None, None);
    let own = own.expect("the rig loads").chain.joints[0]
        .transmission
        .damping;
    let swing = |settings: String| {
        let scenario = load(
            "rig_1dof",
            &format!("{settings}\ngravity = false"),
            "duration_s = 0.3\ntime_step_ms = 0.05",
            "release_n = [1000.0, 0.0, 0.0]",
        );
        let effect = joint(EffectKind::JointLoadFriction, 0, &[0.3]);
        column(&run(&scenario, &[effect]), "joint1.position").to_vec()
    };
    let of_joint = swing(format!("damping_scale = {}", damping / own));
    let of_mode = swing(format!("damping_ratio = [{ratio}]"));
    let apart = of_joint.iter().zip(&of_mode).map(|(a, b)| (a - b).abs());
    let worst = apart.fold(0.0, f64::max) / 1e-3;
    assert!(worst < 2e-4, "{worst}");
}
