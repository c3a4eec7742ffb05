//! Effects on edge, foot, wheel and sensors, against their equations.

use crate::support::{chamfer, column, load, mean, polish, run, run_with, wheel};
use std::f64::consts::TAU;
use truecut_core::wheel::pneumatic::PneumaticWheel;
use truecut_recording::Recording;
use truecut_scenario::effect::{Effect, EffectKind, Target};

fn whole(kind: EffectKind, values: &[f64]) -> Effect {
    Effect {
        kind,
        target: Target::Whole,
        values: values.to_vec(),
    }
}

const SPINDLE_RAD_S: f64 = 10.0 * std::f64::consts::PI;

#[test]
fn verify_coefficients_scale_the_force_and_wear_grows_with_the_path() {
    let scenario = chamfer(1, 0.6);
    let nominal = run(&scenario, &[]);
    let factor = run(&scenario, &[whole(EffectKind::CuttingCoefficient, &[1.25])]);
    let worn = run(&scenario, &[whole(EffectKind::CuttingWear, &[0.2])]);
    for axis in ["x", "y", "z"] {
        let name = format!("cutting.force_{axis}");
        let (n, f, w) = (
            column(&nominal, &name),
            column(&factor, &name),
            column(&worn, &name),
        );
        for (i, t) in nominal.time_s.iter().enumerate() {
            let path = 0.021 * SPINDLE_RAD_S * t;
            assert!(
                (f[i] - 1.25 * n[i]).abs() < 1e-9 * n[i].abs().max(1.0),
                "{t}"
            );
            assert!(
                (w[i] - (1.0 + 0.2 * path) * n[i]).abs() < 1e-9 * n[i].abs().max(1.0),
                "{t}"
            );
        }
    }
}

#[test]
fn verify_edge_force_is_per_length_of_edge() {
    let scenario = chamfer(1, 0.4);
    let nominal = run(&scenario, &[]);
    let blunt = run(
        &scenario,
        &[whole(EffectKind::CuttingEdgeForce, &[5e3, 0.0, 0.0])],
    );
    let depth = column(&nominal, "cutting.engaged_depth");
    let (n, b) = (
        column(&nominal, "cutting.force_x"),
        column(&blunt, "cutting.force_x"),
    );
    for i in 0..n.len() {
        let expected = 5e3 * depth[i] / 45f64.to_radians().cos();
        assert!((b[i] - n[i] - expected).abs() < 1e-9, "{i}");
    }
}

/// At 45° a millimetre outwards is a millimetre deeper; what stands back is less deep.
#[test]
fn verify_geometry_of_the_first_edge() {
    for (effect, shift) in [
        (whole(EffectKind::CuttingDepthOffset, &[3e-5]), None),
        (
            whole(EffectKind::CuttingWornTooth, &[2e-5]),
            Some([-2e-5, 0.0, 0.0]),
        ),
        (
            whole(EffectKind::CuttingRunout, &[1e-5, 7e-6]),
            Some([1e-5, 0.0, 0.0]),
        ),
        (
            whole(EffectKind::CuttingHoleOffset, &[2e-5, -1e-5]),
            Some([0.0, -2e-5, 1e-5]),
        ),
    ] {
        let [constant, cosine, sine] = shift.unwrap_or([3e-5, 0.0, 0.0]);
        let scenario = chamfer(2, 0.4);
        let nominal = run(&scenario, &[]);
        let with = run(&scenario, std::slice::from_ref(&effect));
        let (n, w) = (
            column(&nominal, "cutting.engaged_depth"),
            column(&with, "cutting.engaged_depth"),
        );
        let angle = column(&with, "cutting.edge_angle");
        for i in 0..n.len() {
            let expected = constant + cosine * angle[i].cos() + sine * angle[i].sin();
            assert!((w[i] - n[i] - expected).abs() < 1e-12, "{effect}: {i}");
        }
    }
}

/// With one of two edges missing the other takes the feed of both: the chip of a one-edged tool.
#[test]
fn verify_a_missing_edge_leaves_its_chip_to_the_other() {
    let missing = run(
        &chamfer(2, 0.6),
        &[whole(EffectKind::CuttingWornTooth, &[1e-3])],
    );
    let area = column(&missing, "cutting.chip_area");
    let depth = column(&missing, "cutting.depth");
    for i in (0..area.len()).filter(|i| missing.time_s[*i] > 0.2) {
        let edge = depth[i] + 25e-6;
        let expected = 0.5 * (edge.powi(2) - (edge - 50e-6).powi(2));
        assert!(
            (area[i] / expected - 1.0).abs() < 1e-6,
            "{i}: {} {expected}",
            area[i]
        );
    }
    // And the tool is pushed aside once a revolution, which two good edges do not do.
    let swing = |r: &truecut_recording::Recording| {
        column(r, "cutting.force_y")
            .iter()
            .fold(0.0, |a: f64, v| a.max(v.abs()))
    };
    assert!(swing(&missing) > 5.0 && swing(&run(&chamfer(2, 0.6), &[])) < 1e-9);
}

/// A slower spindle under the same feed in time: other angle, same depth over time.
#[test]
fn verify_spindle_speed_turns_the_edge_not_the_feed() {
    let scenario = chamfer(1, 0.3);
    let (nominal, slow) = (
        run(&scenario, &[]),
        run(&scenario, &[whole(EffectKind::SpindleSpeed, &[0.9])]),
    );
    let (n, s) = (
        column(&nominal, "cutting.depth"),
        column(&slow, "cutting.depth"),
    );
    let angle = column(&slow, "cutting.edge_angle");
    let first = angle[0];
    for (i, t) in slow.time_s.iter().enumerate() {
        assert!((n[i] - s[i]).abs() < 1e-15);
        let apart = (angle[i] - first - 0.9 * SPINDLE_RAD_S * t).rem_euclid(TAU);
        assert!(apart.min(TAU - apart) < 1e-9, "{t}");
    }
}

#[test]
fn verify_foot_presses_less_as_its_pressure_sinks() {
    let scenario = load(
        "rig_planar",
        "gravity = false",
        "duration_s = 0.5",
        "[process.load.foot]\npressure_mpa = 0.3\nbore_mm = 32\ncylinders = 2\ngas_length_mm = 50\npolytropic_exponent = 1.4\nseal_stiction_n = 0\n\
         [process.load.foot.friction]\nlaw = \"coulomb\"\nmu = 0.15",
    );
    let recording = run(&scenario, &[whole(EffectKind::FootPressureLoss, &[0.4])]);
    let normal = column(&recording, "foot.normal_force");
    let x = column(&recording, "tool.displacement_x");
    let area = 2.0 * std::f64::consts::PI * 0.032f64.powi(2) / 4.0;
    assert!((normal[0] / (0.3e6 * area) - 1.0).abs() < 1e-12);
    // What is lost lets the arm come on, against the gas that is left.
    for (i, t) in recording.time_s.iter().enumerate() {
        let pressure = 0.3e6 * (-0.4 * t).exp();
        let gas = 1.4 * (pressure + 101_325.0) * area / 0.05;
        let expected = pressure * area + gas * x[i];
        assert!((normal[i] / expected - 1.0).abs() < 1e-9, "{t}");
    }
    assert!(x[x.len() - 1] > 1e-5);
    let last = normal.len() - 1;
    assert!(normal[last] < 0.85 * normal[0]);
}

/// While it slides the foot's friction lies on `mu N (1 - drop (1 - exp(-v / v_d)))`, times its
/// factor.
#[test]
fn verify_foot_friction_lies_on_its_curve() {
    let scenario = chamfer(1, 0.5);
    let effects = [
        whole(EffectKind::FootFriction, &[1.3]),
        whole(EffectKind::FootFrictionFalling, &[0.5, 2e-4]),
    ];
    let recording = run(&scenario, &effects);
    let get = |name: &str| column(&recording, name);
    let (sliding, speed, normal) = (
        get("foot.sliding"),
        get("foot.slip_speed"),
        get("foot.normal_force"),
    );
    let (fy, fz) = (get("foot.friction_y"), get("foot.friction_z"));
    let mut slid = 0;
    for i in (0..speed.len()).filter(|i| sliding[*i] == 1.0 && normal[*i] > 1.0) {
        let expected = 1.3 * 0.15 * normal[i] * (1.0 - 0.5 * (1.0 - (-speed[i] / 2e-4).exp()));
        assert!((fy[i].hypot(fz[i]) / expected - 1.0).abs() < 1e-4, "{i}");
        slid += 1;
    }
    assert!(slid > 300, "{slid}");
}

#[test]
fn verify_seals_hold_the_rod() {
    let scenario = chamfer(1, 0.5);
    let free = run(&scenario, &[]);
    let held = run(&scenario, &[whole(EffectKind::FootSealStiction, &[97.0])]);
    let last =
        |r: &truecut_recording::Recording, name: &str| *column(r, name).last().expect("rows");
    // A held rod is stiffer than the arm by fifty times: the tool hardly moves along the feed.
    let moved = |r| last(r, "tool.displacement_x").abs();
    assert!(
        moved(&held) < 0.1 * moved(&free),
        "{} {}",
        moved(&held),
        moved(&free)
    );
}

/// `δ = N/k + x + e sin φ + C cos φ + S sin φ`, and the force is that of the changed stiffness.
#[test]
fn verify_wheel_runs_out_and_presses_by_its_stiffness() {
    let scenario = wheel();
    let effects = [
        whole(EffectKind::WheelEccentricity, &[1e-5, -3e-5]),
        whole(EffectKind::WheelStiffness, &[1.4]),
    ];
    let recording = run(&scenario, &effects);
    let stiffness = 1.4 * 40e3;
    let (x, vx) = (
        column(&recording, "tool.displacement_x"),
        column(&recording, "tool.velocity_x"),
    );
    let (delta, normal) = (
        column(&recording, "wheel.indentation"),
        column(&recording, "wheel.normal_force"),
    );
    let spin = 1200.0 * TAU / 60.0;
    for (i, t) in recording.time_s.iter().enumerate() {
        let (s, c) = (spin * t).sin_cos();
        let expected = 30.0 / stiffness + x[i] + (20e-6 - 3e-5) * s + 1e-5 * c;
        assert!((delta[i] - expected).abs() < 1e-12, "{t}");
        let rate = vx[i] + spin * ((20e-6 - 3e-5) * c - 1e-5 * s);
        assert!(
            (normal[i] - (stiffness * delta[i] + 50.0 * rate).max(0.0)).abs() < 1e-6,
            "{t}"
        );
    }
}

/// The wheel's law with modulus and pressure times the factor, Coulomb's friction with its own;
/// Preston's depth is in proportion.
#[test]
fn the_run_applies_the_factors_of_a_polishing_wheel() {
    let scenario = polish();
    let effects = [
        whole(EffectKind::WheelStiffness, &[1.3]),
        whole(EffectKind::WheelFriction, &[1.5]),
        whole(EffectKind::WheelRemoval, &[0.8]),
    ];
    let (nominal, with) = (run(&scenario, &[]), run(&scenario, &effects));
    let stiffer = PneumaticWheel {
        radius_m: 20e-3,
        pressure_pa: 1.3 * 0.1e6,
        shell_thickness_m: 5e-3,
        youngs_modulus_pa: 1.3 * 4e6,
        poisson: 0.49,
        damping_pa_s_per_m: 0.0,
    };
    let shell = stiffer.shell();
    let normal = column(&with, "polish.normal_force");
    let depth = column(&with, "polish.indentation");
    let friction = ["polish.friction_x", "polish.friction_y"].map(|name| column(&with, name));
    for row in 0..normal.len() {
        let expected = stiffer.patch(&shell, depth[row]).free_force_n();
        assert!((normal[row] / expected - 1.0).abs() < 1e-3, "{row}");
        // the patch slides at one angle but for the spin about its middle
        let share = friction[0][row].hypot(friction[1][row]) / normal[row];
        assert!(share > 0.85 * 0.45 && share < 0.45, "{row}: {share}");
    }
    // the carrier holds nearly the same force
    let taken = |recording: &Recording| {
        *column(recording, "polish.removed_volume")
            .last()
            .expect("rows")
    };
    let ratio = taken(&with) / taken(&nominal);
    assert!((ratio / 0.8 - 1.0).abs() < 0.1, "{ratio}");
    let less = run(&scenario, &[whole(EffectKind::WheelRemoval, &[0.8])]);
    assert!((taken(&less) / taken(&nominal) - 0.8).abs() < 1e-12);
}

/// A middle at `e + (C, S)` is the nominal wheel whose eccentricity is that sum.
#[test]
fn verify_an_eccentric_polishing_wheel_is_the_sum_of_two_places() {
    let with = run(
        &polish(),
        &[whole(EffectKind::WheelEccentricity, &[2e-5, -3e-5])],
    );
    let angle = 30f64.to_radians();
    let (x, y) = (5e-5 * angle.cos() + 2e-5, 5e-5 * angle.sin() - 3e-5);
    let sum = [
        ("process.polish.eccentricity_um", 1e6 * x.hypot(y)),
        (
            "process.polish.eccentricity_angle_deg",
            y.atan2(x).to_degrees(),
        ),
    ];
    let sum = sum.map(|(key, value)| (key.to_owned(), format!("{value:?}")));
    let nominal = run_with(&polish(), &sum);
    for name in ["polish.normal_force", "tool.displacement_x"] {
        let pairs = column(&with, name).iter().zip(column(&nominal, name));
        let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-9, "{name}: {apart}");
    }
}

/// The preload is shifted; dry friction of the carrier's guide lets the force differ by up to its
/// level from what the spring asks for.
#[test]
fn verify_force_control_is_off_and_sticks() {
    let scenario = polish();
    let off = run(&scenario, &[whole(EffectKind::WheelForceOffset, &[0.5])]);
    let stuck = run(&scenario, &[whole(EffectKind::WheelForceStiction, &[0.4])]);
    let lacking = |recording: &Recording, preload: f64| -> Vec<f64> {
        let force = column(recording, "polish.normal_force").iter();
        let offset = column(recording, "polish.carrier_offset").iter();
        force
            .zip(offset)
            .map(|(f, x)| preload - 200.0 * x - f)
            .collect()
    };
    let last = |values: Vec<f64>| values[values.len() / 2..].to_vec();
    let balance = mean(&last(lacking(&off, 4.5)));
    assert!(balance.abs() < 0.03, "{balance}");
    let offset = column(&stuck, "polish.carrier_offset");
    let resting = offset.windows(2).filter(|pair| pair[0] == pair[1]).count();
    assert!(resting > offset.len() / 10, "{resting} of {}", offset.len());
    let resting_rows = (1..offset.len()).filter(|row| offset[*row] == offset[row - 1]);
    let lacks = lacking(&stuck, 4.0);
    for row in resting_rows.skip(1) {
        assert!(lacks[row].abs() < 0.4 + 1e-6, "{row}: {}", lacks[row]);
    }
}

/// Sensors change what is recorded of their channel, all in one chain, and nothing else.
#[test]
fn a_sensor_measures_the_recorded_channel() {
    let scenario = load(
        "rig_1dof",
        "gravity = false",
        "duration_s = 0.3\nrecord_interval_ms = 1",
        "release_n = [1000.0, 0.0, 0.0]",
    );
    let sensor = |kind, values: &[f64]| Effect {
        kind,
        target: Target::Channel("joint1.position".into()),
        values: values.to_vec(),
    };
    let effects = [
        sensor(EffectKind::SensorDelay, &[0.0123]),
        sensor(EffectKind::SensorGain, &[1.1]),
        sensor(EffectKind::SensorOffset, &[1e-4]),
        sensor(EffectKind::SensorDrift, &[2e-4, 0.1]),
        sensor(EffectKind::SensorLowPass, &[0.003]),
    ];
    let nominal = run(&scenario, &[]);
    let measured = run(&scenario, &effects);
    let model = truecut_sim::measurement::Sensors::new(&effects).of("joint1.position");
    let mut expected = column(&nominal, "joint1.position").to_vec();
    model.apply(&nominal.time_s, &mut expected);
    let got = column(&measured, "joint1.position");
    assert!(
        got.iter()
            .zip(&expected)
            .all(|(a, b)| (a - b).abs() < 1e-15)
    );
    assert_eq!(
        column(&nominal, "joint1.velocity"),
        column(&measured, "joint1.velocity")
    );
}
