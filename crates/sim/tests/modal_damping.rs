//! Damping ratios of modes in a run, against the decay of each mode in closed form.

use crate::support::{ARM_POSTURE, column, finished, load};
use nalgebra::Vector3;
use truecut_arm::{FrameId, Robot};
use truecut_recording::Recording;
use truecut_scenario::Scenario;
use truecut_sim::run::{Engine, Run};

const RATIOS: [f64; 6] = [0.02, 0.05, 0.01, 0.03, 0.015, 0.04];
const RELEASED_N: [f64; 3] = [12.0, 20.0, -7.0];

fn released(ratios: &[f64]) -> Scenario {
    let settings = format!("{ARM_POSTURE}\ngravity = false\ndamping_ratio = {ratios:?}");
    let forces = format!("release_n = {RELEASED_N:?}");
    load("irb6600_175_255", &settings, "duration_s = 1.0", &forces)
}

fn run(scenario: &Scenario, engine: Engine) -> Recording {
    finished(Run {
        engine,
        ..Run::of(scenario)
    })
}

/// Displacement since the release, process axes.
fn closed_form(scenario: &Scenario, ratios: &[f64], time_s: f64) -> Vector3<f64> {
    let robot = Robot::load(&scenario.robot.urdf, None, None).expect("the asset loads");
    let q = &scenario.robot.posture_rad;
    let axes = robot.world_from_process(q).rotation.inverse();
    let modes = robot.tip_modes(q, FrameId::Tool, None).expect("stiff");
    let mut sum = Vector3::zeros();
    for (k, mode) in modes.iter().enumerate() {
        let (shape, omega) = (axes * mode.shape_per_sqrt_kg, mode.natural_frequency_rad_s);
        let zeta = ratios[k.min(ratios.len() - 1)];
        let root = (1.0 - zeta * zeta).sqrt();
        let (sin, cos) = (omega * root * time_s).sin_cos();
        let decay = (-zeta * omega * time_s).exp() * (cos + zeta / root * sin);
        let rest = shape * (shape.dot(&Vector3::from(RELEASED_N)) / (omega * omega));
        sum += rest * (decay - 1.0);
    }
    sum
}

/// Every mode rings down at its own ratio, in rapier and linearised; rapier's fastest modes are out
/// of tune by (ωh)²/24.
#[test]
fn verify_modes_decay_at_their_own_ratios_in_both_engines() {
    for ratios in [&RATIOS[..], &[0.03]] {
        let scenario = released(ratios);
        for (engine, bound) in [(Engine::Rapier, 2e-3), (Engine::REDUCED, 2e-4)] {
            let recording = run(&scenario, engine);
            let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
            for (i, time_s) in recording.time_s.iter().enumerate().step_by(7) {
                let at = |axis: &str| column(&recording, &format!("tool.displacement_{axis}"))[i];
                let found = Vector3::new(at("x"), at("y"), at("z"));
                let expected = closed_form(&scenario, ratios, *time_s);
                worst = worst.max((found - expected).norm());
                largest = largest.max(expected.norm());
            }
            println!("{ratios:?} {engine:?}: {:.2e}", worst / largest);
            assert!(worst < bound * largest, "{engine:?}: {}", worst / largest);
        }
    }
}
