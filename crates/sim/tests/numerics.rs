//! The step scheme: frequency, damping, energy and order, on systems whose answer is known.
//!
//! If the leapfrog reading of rapier's step were broken (first kick not halved, damping not
//! centred, Coriolis terms left as rapier takes them), the order would fall to one and the energy
//! would drift; these tests would see it long before a chamfer did.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use truecut_recording::{Outcome, Recording};
use truecut_scenario::Scenario;
use truecut_sim::run::Run;

fn run(text: &str) -> Recording {
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/arm/numerics.toml");
    let scenario = Scenario::from_str(&at, text, &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let finished = Run::of(&scenario).execute();
    finished.unwrap_or_else(|e| panic!("{e}")).recording
}

fn column<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    let index = recording.header.index_of(name).expect("channel");
    &recording.columns[index]
}

/// Free decay of the mass on a spring, without transmission damping.
fn undamped_rig(step: &str, duration_s: f64) -> Recording {
    run(&format!(
        r#"
name = "rig"
[robot]
urdf = "../../assets/robots/rig_1dof/robot.urdf"
damping_scale = 0.0
gravity = false
[run]
duration_s = {duration_s}
{step}
[process.load]
release_n = [1000.0, 0.0, 0.0]
"#
    ))
}

/// Frequency and damping ratio of a decay, from all upward zero crossings and the peaks between
/// them.
fn frequency_and_damping(time: &[f64], x: &[f64]) -> (f64, f64) {
    let mean = 0.0;
    let mut crossings = Vec::new();
    let mut peaks = Vec::new();
    for i in 1..x.len() - 1 {
        if x[i - 1] < mean && x[i] >= mean {
            let part = x[i - 1] / (x[i - 1] - x[i]);
            crossings.push(time[i - 1] + part * (time[i] - time[i - 1]));
        }
        if x[i] > x[i - 1] && x[i] >= x[i + 1] {
            // vertex of the parabola through three samples
            let (a, b, c) = (x[i - 1], x[i], x[i + 1]);
            peaks.push(b - (a - c).powi(2) / (8.0 * (a - 2.0 * b + c)));
        }
    }
    let cycles = (crossings.len() - 1) as f64;
    let frequency = cycles / (crossings[crossings.len() - 1] - crossings[0]);
    let decay = (peaks[0] / peaks[peaks.len() - 1]).ln() / (peaks.len() - 1) as f64;
    (frequency, decay / std::f64::consts::TAU)
}

/// Displacement of the tool from where it would rest.
fn about_rest(recording: &Recording) -> Vec<f64> {
    let x = column(recording, "tool.displacement_x");
    let rest = 0.5
        * (x.iter().copied().fold(f64::MIN, f64::max) + x.iter().copied().fold(f64::MAX, f64::min));
    x.iter().map(|x| x - rest).collect()
}

#[test]
fn verify_free_decay_keeps_frequency_and_amplitude_at_the_default_step() {
    let recording = undamped_rig("", 10.0);
    let natural = (1.0e6f64 / 100.0).sqrt() / std::f64::consts::TAU;
    let (f, zeta) = frequency_and_damping(&recording.time_s, &about_rest(&recording));
    println!(
        "frequency error {:.2e}, numerical damping ratio {:.2e}",
        f / natural - 1.0,
        zeta
    );
    assert!((f / natural - 1.0).abs() <= 5e-4, "{f} against {natural}");
    assert!(zeta.abs() <= 1e-5, "{zeta}");
}

#[test]
fn verify_damped_decay_has_the_damping_of_the_joint() {
    let text = r#"
name = "rig"
[robot]
urdf = "../../assets/robots/rig_1dof/robot.urdf"
gravity = false
[run]
duration_s = 2.0
[process.load]
release_n = [1000.0, 0.0, 0.0]
"#;
    let recording = run(text);
    let x = column(&recording, "tool.displacement_x");
    let rest = -1000.0 / 1.0e6;
    let x: Vec<f64> = x.iter().map(|x| x - rest).collect();
    let (_, zeta) = frequency_and_damping(&recording.time_s, &x);
    // logarithmic decrement of a ratio ζ is 2πζ/√(1-ζ²)
    let expected = 0.02 / (1.0f64 - 0.02 * 0.02).sqrt();
    assert!(
        (zeta / expected - 1.0).abs() < 1e-4,
        "{zeta} against {expected}"
    );
}

const ARM: &str = r#"
name = "arm"
[robot]
urdf = "../../assets/robots/irb6600_175_255/robot.urdf"
posture_deg = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]
"#;

fn energy_drift(recording: &Recording) -> f64 {
    assert_eq!(recording.outcome, Outcome::Completed);
    let kinetic = column(recording, "energy.kinetic");
    let potential = column(recording, "energy.potential");
    let total: Vec<f64> = kinetic.iter().zip(potential).map(|(k, p)| k + p).collect();
    let exchanged = kinetic.iter().copied().fold(0.0, f64::max);
    let drift = total
        .iter()
        .map(|e| (e - total[0]).abs())
        .fold(0.0, f64::max);
    drift / exchanged
}

#[test]
fn verify_undamped_arm_on_its_springs_keeps_its_energy_for_ten_seconds() {
    let recording = run(&format!(
        "{ARM}damping_scale = 0.0\n[run]\nduration_s = 10.0\n[process.load]\nrelease_n = [3000.0, 2000.0, -1000.0]\n"
    ));
    let drift = energy_drift(&recording);
    println!("energy drift on springs {drift:.2e}");
    // The leapfrog's energy swings by about (ω dt)²/4 of a mode's share, at most 3e-3 for the
    // fastest mode at the default step; the mean over a second must not drift.
    let kinetic = column(&recording, "energy.kinetic");
    let potential = column(&recording, "energy.potential");
    let n = kinetic.len();
    let second = n / 10;
    let mean = |from: usize| -> f64 {
        (from..from + second)
            .map(|i| kinetic[i] + potential[i])
            .sum::<f64>()
            / second as f64
    };
    let exchanged = kinetic.iter().copied().fold(0.0, f64::max);
    let secular = (mean(n - second) - mean(0)).abs() / exchanged;
    println!("secular drift {secular:.2e}");
    assert!(secular <= 1e-3, "{secular}");
    assert!(drift <= 1e-3, "{drift}");
}

/// The arm with joints that turn without end, so that a free fall meets no stop.
fn endless_arm() -> &'static Path {
    static URDF: OnceLock<PathBuf> = OnceLock::new();
    URDF.get_or_init(write_endless_arm)
}

fn write_endless_arm() -> PathBuf {
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    let urdf = std::fs::read_to_string(robots.join("irb6600_175_255/robot.urdf")).expect("asset");
    let at = Path::new(env!("CARGO_TARGET_TMPDIR")).join("endless_arm.urdf");
    std::fs::write(
        &at,
        urdf.replace("type=\"revolute\"", "type=\"continuous\""),
    )
    .expect("writable");
    at
}

fn falling(step_ms: f64, duration_s: f64) -> Recording {
    // Free joints, let go in a posture from which all links swing.
    let urdf = endless_arm();
    run(&format!(
        r#"
name = "fall"
[robot]
urdf = {urdf:?}
posture_deg = [0.0, -20.0, 20.0, 10.0, 30.0, 0.0]
drive = "force"
[run]
duration_s = {duration_s}
time_step_ms = {step_ms}
[process.load]
"#
    ))
}

#[test]
fn verify_falling_arm_keeps_its_energy_for_two_seconds() {
    let recording = falling(0.25, 2.0);
    println!(
        "{:?} at {} s",
        recording.outcome,
        recording.time_s.last().unwrap()
    );
    let drift = energy_drift(&recording);
    println!("energy drift falling {drift:.2e}");
    assert!(drift <= 1e-3, "{drift}");
}

fn end_of(recording: &Recording) -> [f64; 3] {
    ["tool.position_x", "tool.position_y", "tool.position_z"]
        .map(|name| *column(recording, name).last().expect("rows"))
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// Order from three steps, each half of the one before.
fn order(run_at: impl Fn(f64) -> Recording, step_ms: f64) -> f64 {
    let ends = [4.0, 2.0, 1.0].map(|k| end_of(&run_at(step_ms * k)));
    (distance(ends[0], ends[1]) / distance(ends[1], ends[2])).log2()
}

#[test]
fn verify_smooth_vibration_is_of_second_order() {
    let vibration = |step_ms: f64| {
        run(&format!(
            "{ARM}[run]\nduration_s = 0.5\ntime_step_ms = {step_ms}\n[process.load]\nconstant_n = [1000.0, 0.0, 0.0]\n[process.load.rotating]\namplitude_n = 500.0\nfrequency_hz = 11.0\n"
        ))
    };
    let order = order(vibration, 0.0625);
    println!("order of smooth vibration {order:.3}");
    assert!(order >= 1.8, "{order}");
}

#[test]
fn verify_gross_motion_is_of_second_order() {
    let order = order(|step_ms| falling(step_ms, 1.0), 0.125);
    println!("order of gross motion {order:.3}");
    assert!(order >= 1.8, "{order}");
}

#[test]
fn two_runs_are_identical_to_the_bit() {
    let a = falling(0.5, 0.5);
    let b = falling(0.5, 0.5);
    assert_eq!(a.columns, b.columns);
}

/// The mass of `rig_1dof` on a servo.
fn on_a_servo(of_the_run: &str, load: &str) -> Recording {
    run(&format!(
        r#"
name = "servo"
[robot]
urdf = "../../assets/robots/rig_1dof/robot.urdf"
gravity = false
drive = "servo"
[run]
{of_the_run}
[process.load]
{load}
"#
    ))
}

/// A servo without integral action gives way by `F / (k_v k_p)`, behind it the transmission by
/// `F / K`; and a force beyond its limit is not held at all.
#[test]
fn verify_servo_droops_and_saturates() {
    let servo = |force_n: f64, duration_s: f64| {
        on_a_servo(
            &format!("duration_s = {duration_s}"),
            &format!("constant_n = [{force_n}, 0.0, 0.0]"),
        )
    };
    let held = servo(500.0, 3.0);
    assert_eq!(held.outcome, Outcome::Completed);
    let end = *column(&held, "tool.displacement_x").last().expect("rows");
    let expected = 500.0 / 1.0e6 + 500.0 / (1.0e3 * 20.0);
    println!(
        "servo droop {:.5} mm, expected {:.5} mm",
        end * 1e3,
        expected * 1e3
    );
    assert!(
        (end / expected - 1.0).abs() < 1e-3,
        "{end} against {expected}"
    );

    // 25 kN against a limit of 20 kN: the rest accelerates rotor and mass.
    let pushed = servo(25.0e3, 0.1);
    let velocity = *column(&pushed, "joint1.velocity").last().expect("rows");
    let free = (25.0e3 - 20.0e3) / (100.0 + 5.0) * 0.1;
    assert!(velocity > 0.8 * free, "{velocity} against {free}");
}

/// A servo that cannot hold the load of the start: its rotor is accelerated from the first instant.
/// Taken as if that began half a step earlier or later, the motion would be of first order.
#[test]
fn verify_a_saturated_servo_starts_in_second_order() {
    let let_go = |step_ms: f64| {
        on_a_servo(
            &format!("duration_s = 0.02\ntime_step_ms = {step_ms}\noverload = \"warn\""),
            "release_n = [30.0e3, 0.0, 0.0]",
        )
    };
    let saturated = let_go(0.05);
    let torque = column(&saturated, "joint1.drive_force");
    assert!(torque.iter().all(|it| it.abs() > 19.9e3), "{torque:?}");
    let order = order(let_go, 0.025);
    println!("order of a saturated start {order:.3}");
    assert!(order >= 1.8, "{order}");
}
