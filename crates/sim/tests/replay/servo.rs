//! A servo drives the mass: motion by its transfer function, forces by what the motion needs.

use super::*;

const GAIN_N_S_PER_M: f64 = 9385.0;
const POSITION_GAIN_PER_S: f64 = 160.0;

/// Motion of the mass under the servo: both feed-forward shares, exact from the transfer function
/// in the steady state. `m q'' + k_v q' + k_v k_p q = k_v (k_p c + f c')`.
fn steady_state(t: f64, feed_forward: f64) -> f64 {
    let w = TAU * 1.5;
    let k = GAIN_N_S_PER_M * POSITION_GAIN_PER_S;
    let (re, im) = (k - MASS_KG * w * w, GAIN_N_S_PER_M * w);
    let (nre, nim) = (k, feed_forward * GAIN_N_S_PER_M * w);
    let norm = re * re + im * im;
    let (gre, gim) = ((nre * re + nim * im) / norm, (nim * re - nre * im) / norm);
    0.02 - 0.02 * (gre * (w * t).cos() - gim * (w * t).sin())
}

#[test]
fn verify_rigid_servo_follows_its_transfer_function_to_second_order() {
    let measured = commanded(2001, command);
    let error = |step_ms: f64| {
        let scenario = scenario("servo", "forward", "");
        let step = [("run.time_step_ms".to_owned(), step_ms.to_string())];
        let recording = run(&scenario.with_overrides(&step).unwrap(), &measured);
        let times = wave(1000.0, 500, |t| 1.0 + t);
        let got = sample_at(&recording, "joint1.position", &times).unwrap();
        let errors = times
            .iter()
            .zip(&got)
            .map(|(t, q)| (q - steady_state(*t, 0.0)).abs());
        errors.fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(2.0), error(1.0));
    assert!(coarse < 2e-5 && fine < 5e-6, "{coarse} {fine}");
    assert!(
        (3.5..4.5).contains(&(coarse / fine)),
        "order: {coarse} / {fine}"
    );
}

/// What the servo exerts is what the motion needs, also in the recording.
#[test]
fn verify_recorded_drive_force_moves_the_mass() {
    let measured = commanded(1501, command);
    let recording = run(&scenario("servo", "forward", ""), &measured);
    let force = recording.channel("joint1.drive_force").unwrap();
    let velocity = recording.channel("joint1.velocity").unwrap();
    let dt = recording.time_s[1] - recording.time_s[0];
    for k in 1..velocity.len() - 1 {
        let needed = MASS_KG * (velocity[k + 1] - velocity[k - 1]) / (2.0 * dt);
        assert!(
            (force[k] - needed).abs() < 0.3,
            "{k}: {} beside {needed}",
            force[k]
        );
    }
}

/// Beyond its limit the servo is a constant force: the mass starts with limit / mass.
#[test]
fn verify_saturated_servo_accelerates_uniformly() {
    let step = |t: f64| if t < 0.002 { 0.0 } else { 0.02 };
    let measured = commanded(301, step);
    let recording = run(&scenario("servo", "forward", ""), &measured);
    let velocity = recording.channel("joint1.velocity").unwrap();
    let force = recording.channel("joint1.drive_force").unwrap();
    let at = |t: f64| {
        recording
            .time_s
            .iter()
            .position(|x| *x >= t - 1e-9)
            .unwrap()
    };
    let (a, b) = (at(0.010), at(0.050));
    assert!(force[a..b].iter().all(|f| *f == 351.5));
    let slope = (velocity[b] - velocity[a]) / (recording.time_s[b] - recording.time_s[a]);
    assert!((slope * MASS_KG / 351.5 - 1.0).abs() < 1e-3, "{slope}");
}

/// A force drive gives the mass the measured force: F sin wt moves it by F/(m w) (t - sin(wt)/w).
#[test]
fn verify_measured_drive_force_moves_a_free_mass() {
    let (force, w) = (30.0, TAU * 2.0);
    let measured = data(
        2000.0,
        2001,
        vec![(
            "joint1.drive_force",
            Unit::Newton,
            Role::Input,
            wave(2000.0, 2001, |t| force * (w * t).sin()),
        )],
    );
    let recording = run(&scenario("force", "forward", ""), &measured);
    let position = recording.channel("joint1.position").unwrap();
    for (t, q) in recording.time_s.iter().zip(position) {
        let exact = force / (MASS_KG * w) * (t - (w * t).sin() / w);
        assert!((q - exact).abs() < 2e-6, "{t}: {q} beside {exact}");
    }
}
