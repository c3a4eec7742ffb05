//! The paper's tests on the arm: what must come out, with figures.

use crate::support::{lateral_peak, run, scalar};
use truecut_recording::{MetricSpec, Outcome, Recording, Reducer, Window};

fn spindle_line_hz(recording: &Recording, from_s: f64, to_s: f64) -> f64 {
    let metric = MetricSpec::Reduced {
        reducer: Reducer::SpectralLine {
            band_hz: [2.0, 20.0],
        },
        channels: vec!["dynamometer.force_y".into()],
        window: Window {
            from_s: Some(from_s),
            to_s: Some(to_s),
            ..Window::ALL
        },
    };
    metric.evaluate(recording).expect("line").value
}

fn peak_3d(recording: &Recording) -> f64 {
    let axes = ["x", "y", "z"]
        .map(|a| crate::support::channel(recording, &format!("tool.displacement_{a}")));
    (0..recording.time_s.len())
        .map(|i| axes.iter().map(|c| c[i] * c[i]).sum::<f64>().sqrt())
        .fold(0.0, f64::max)
}

#[test]
fn verify_forward_is_quiet_then_moves_at_the_spindle_line() {
    let recording = run("chamfer/forward_300.toml", &[]);
    assert_eq!(recording.outcome, Outcome::Completed);
    let quiet = lateral_peak(&recording, 0.0, 2.0);
    let moving = lateral_peak(&recording, 2.4, 4.0);
    let line = spindle_line_hz(&recording, 2.4, 3.8);
    println!(
        "quiet {:.2} um, moving {:.1} um, line {line:.3} Hz",
        quiet * 1e6,
        moving * 1e6
    );
    assert!(quiet < 5e-6 && moving > 10.0 * quiet);
    assert!((line / 5.0 - 1.0).abs() <= 0.01, "{line}");
}

#[test]
fn verify_resonance_moves_the_tool_three_times_as_far() {
    let at_400 = peak_3d(&run("chamfer/forward_400.toml", &[]));
    let at_300 = peak_3d(&run(
        "chamfer/forward_400.toml",
        &[("process.chamfer.spindle_rpm", "300")],
    ));
    println!(
        "peak 3-D: 400 rpm {:.1} um, 300 rpm {:.1} um",
        at_400 * 1e6,
        at_300 * 1e6
    );
    assert!(at_400 / at_300 >= 3.0, "{}", at_400 / at_300);
}

#[test]
fn verify_sufficient_pressure_sticks_with_even_width() {
    for file in [
        "chamfer/backward_sufficient.toml",
        "chamfer/backward_high.toml",
    ] {
        let recording = run(file, &[]);
        assert!(
            scalar(&recording, "chamfer.first_slip_depth").is_nan(),
            "{file} slips"
        );
        let spread = scalar(&recording, "chamfer.width_spread");
        println!("{file}: width spread {:.4} mm", spread * 1e3);
        assert!(spread <= 0.05e-3, "{file}: {spread}");
    }
}

/// Low pressure: sliding starts at the depth of the general condition, within one revolution's feed
/// on the arm and within 2 % on the planar rig, whatever the angle at which the edge starts.
#[test]
fn verify_low_pressure_slides_at_the_depth_of_the_general_condition() {
    for angle in ["0", "120", "240"] {
        let start = [("process.chamfer.start_angle_deg", angle)];
        let arm = run("chamfer/backward_low.toml", &start);
        let (got, condition) = (
            scalar(&arm, "chamfer.first_slip_depth"),
            scalar(&arm, "theory.slip_depth"),
        );
        println!(
            "arm, {angle} deg: {:.4} mm, condition {:.4} mm",
            got * 1e3,
            condition * 1e3
        );
        assert!(
            (got - condition).abs() <= 0.05e-3,
            "{angle}: {got} against {condition}"
        );
        let rig = run("chamfer/planar_low.toml", &start);
        let (got, condition) = (
            scalar(&rig, "chamfer.first_slip_depth"),
            scalar(&rig, "theory.slip_depth"),
        );
        println!(
            "rig, {angle} deg: {:.4} mm, condition {:.4} mm",
            got * 1e3,
            condition * 1e3
        );
        assert!(
            (got / condition - 1.0).abs() <= 0.02,
            "{angle}: {got} against {condition}"
        );
    }
}

/// The paper's viscous law holds above its own threshold and lets go below it, where the exact law
/// has long since let go: this is the gap between 0.295 and 0.392 MPa.
#[test]
fn verify_equivalent_viscous_law_has_the_papers_threshold() {
    let moved = |law: &str, pressure: &str| {
        let recording = run(
            "chamfer/planar_low.toml",
            &[
                ("process.chamfer.foot.friction.law", law),
                ("process.chamfer.foot.pressure_mpa", pressure),
                ("process.chamfer.dwell_revolutions", "0"),
            ],
        );
        lateral_peak(&recording, 0.0, 10.0)
    };
    let between = moved("equivalent_viscous", "0.32");
    let exact = moved("coulomb", "0.32");
    println!(
        "0.32 MPa: viscous {:.2} um, exact {:.2} um",
        between * 1e6,
        exact * 1e6
    );
    assert!(between < 3e-6, "{between}");
    assert!(exact > 20e-6, "{exact}");
    assert!(moved("equivalent_viscous", "0.05") > 20e-6);
}

/// Halving the step quarters the change of the result, stick and slip included: the slip events
/// fall between steps, but friction acts by its mean over each step.
#[test]
fn regress_peak_displacement_converges_in_the_time_step() {
    let peak = |step: &str| {
        peak_3d(&run(
            "chamfer/forward_300.toml",
            &[("run.time_step_ms", step)],
        ))
    };
    let (coarse, middle, fine) = (peak("0.2"), peak("0.1"), peak("0.05"));
    println!(
        "peak at 0.2, 0.1, 0.05 ms: {:.4} {:.4} {:.4} um",
        coarse * 1e6,
        middle * 1e6,
        fine * 1e6
    );
    let order = ((coarse - middle) / (middle - fine)).log2();
    assert!(order >= 1.8, "{order}");
    assert!((coarse / fine - 1.0).abs() < 1e-3);
}
