//! Tools and workpieces that bend in processes which know nothing of it: `[[tool.mode]]`,
//! `[[workpiece.mode]]`.

use crate::support::{self, ARM_POSTURE, column, finished, load, scenario};
use nalgebra::{Complex, DMatrix, DVector, Matrix2, Matrix4, Vector3};
use std::f64::consts::TAU;
use truecut_arm::{FrameId, Load, Robot};
use truecut_core::chatter::AttachedMode;
use truecut_recording::Recording;
use truecut_scenario::Scenario;
use truecut_sim::run::{Engine, Run};

/// Modes of a tool: frequency (Hz), damping ratio, stiffness (N/µm), direction in the tool frame.
const MODES: [(f64, f64, f64, [f64; 3]); 2] = [
    (420.0, 0.04, 6.0, [1.0, 0.3, 0.2]),
    (650.0, 0.03, 9.0, [-0.2, 1.0, 0.1]),
];
const FORCE_N: f64 = 100.0;

fn table(name: &str, modes: &[(f64, f64, f64, [f64; 3])]) -> String {
    let rows = modes.iter().map(|(hz, zeta, stiffness, direction)| {
        format!(
            "[[{name}.mode]]\nfrequency_hz = {hz}\ndamping_ratio = {zeta}\n\
             stiffness_n_per_um = {stiffness}\ndirection = {direction:?}\n"
        )
    });
    rows.collect()
}

fn attached(modes: &[(f64, f64, f64, [f64; 3])]) -> Vec<AttachedMode> {
    let of =
        |&(hz, zeta, stiffness, direction)| AttachedMode::new(hz, zeta, stiffness * 1e6, direction);
    modes.iter().map(of).collect()
}

fn with(base: &Scenario, tables: &str) -> Scenario {
    scenario(&format!("{}\n{tables}", base.effective_text()))
}

fn run(scenario: &Scenario, engine: Engine) -> Recording {
    finished(Run {
        engine,
        ..Run::of(scenario)
    })
}

/// Part of a channel at a frequency over the last of the run, as a complex amplitude of exp(iωt).
fn amplitude(recording: &Recording, name: &str, hz: f64, over_s: f64) -> Complex<f64> {
    let end = recording.time_s[recording.time_s.len() - 1];
    let cycles = (over_s * hz).round();
    let rows = recording.time_s.iter().zip(column(recording, name));
    let (mut sum, mut count) = (Complex::new(0.0, 0.0), 0.0);
    for (t, value) in rows.filter(|(t, _)| **t > end - cycles / hz) {
        sum += Complex::from_polar(2.0, -TAU * hz * t) * value;
        count += 1.0;
    }
    sum / count
}

/// A force that turns acts on the arm through its tool: arm and modes answer as the assembled
/// matrices say, from below the modes to above them, in rapier and linearised.
#[test]
fn verify_arm_and_tool_answer_a_turning_force_as_the_assembled_matrices() {
    for hz in [150.0, 390.0, 560.0, 900.0] {
        let settings = format!("{ARM_POSTURE}\ngravity = false");
        let forces =
            format!("[process.load.rotating]\namplitude_n = {FORCE_N}\nfrequency_hz = {hz}");
        let rigid = load("irb6600_175_255", &settings, "duration_s = 0.6", &forces);
        let bent = with(&rigid, &table("tool", &MODES));
        let expected = response(&bent, hz);
        for engine in [Engine::Rapier, Engine::REDUCED] {
            let recording = run(&bent, engine);
            for (number, expected) in (1..).zip(expected.iter()) {
                let name = format!("load.tool_mode{number}_deflection");
                let found = amplitude(&recording, &name, hz, 0.2);
                let apart = (found - expected).norm() / expected.norm();
                println!("{hz} Hz, mode {number}: {apart:.2e}");
                assert!(apart < 0.01, "{hz} Hz {number}: {found} for {expected}");
            }
        }
    }
}

/// Complex amplitudes of the modes' deflections under the turning force, m.
fn response(scenario: &Scenario, hz: f64) -> Vec<Complex<f64>> {
    let robot = Robot::load(&scenario.robot.urdf, None, None).expect("the asset loads");
    let q = &scenario.robot.posture_rad;
    let axes = robot.tool_axes(q);
    let modes: Vec<AttachedMode> = attached(&MODES)
        .iter()
        .map(|one| one.turned(&axes))
        .collect();
    let arm = robot
        .linearised(q, FrameId::Tool, &Load::none())
        .and_then(|arm| arm.with_tool(&modes))
        .expect("stiff");
    let omega = TAU * hz;
    let complex = |m: &DMatrix<f64>, factor: Complex<f64>| m.map(|x| factor * x);
    let dynamic = complex(&arm.stiffness, 1.0.into())
        + complex(&arm.damping, Complex::new(0.0, omega))
        + complex(&arm.mass, (-omega * omega).into());
    // (0, cos ωt, sin ωt) is the real part of (0, 1, -i) exp(iωt).
    let process = robot.world_from_process(q).rotation;
    let parts = [process * Vector3::y(), process * Vector3::z()].map(|axis| axis * FORCE_N);
    let force = |axis: &Vector3<f64>| -> DVector<f64> { arm.tip_jacobian.tr_mul(axis) };
    let (real, imaginary) = (force(&parts[0]), force(&parts[1]));
    let forces = DVector::from_fn(real.len(), |i, _| Complex::new(real[i], -imaginary[i]));
    let moved = dynamic.lu().solve(&forces).expect("regular");
    let own = moved.len() - modes.len();
    moved.iter().skip(own).copied().collect()
}

/// A workpiece that bends has no part in the arm's motion under a given force, and swings by
/// itself.
#[test]
fn verify_a_workpiece_swings_by_itself() {
    let settings = format!("{ARM_POSTURE}\ngravity = false");
    let forces = format!("[process.load.rotating]\namplitude_n = {FORCE_N}\nfrequency_hz = 300");
    let rigid = load(
        "irb6600_175_255",
        &settings,
        "duration_s = 0.5\ntime_step_ms = 0.05",
        &forces,
    );
    let robot = Robot::load(&rigid.robot.urdf, None, None).expect("the asset loads");
    let along = robot.world_from_process(&rigid.robot.posture_rad).rotation * Vector3::y();
    let modes = [(400.0, 0.05, 5.0, along.into())];
    let bent = with(&rigid, &table("workpiece", &modes));
    let (found, plain) = (run(&bent, Engine::Rapier), run(&rigid, Engine::Rapier));
    let name = "load.workpiece_mode1_deflection";
    assert_eq!(found.columns[..plain.columns.len()], plain.columns[..]);
    let amplitude = amplitude(&found, name, 300.0, 0.2);
    let share: f64 = 300.0 / 400.0;
    let expected = FORCE_N / 5e6 / Complex::new(1.0 - share * share, 2.0 * 0.05 * share);
    assert!(
        (amplitude - expected).norm() < 2e-3 * expected.norm(),
        "{amplitude}, {expected}"
    );
}

const CHAMFER: &str = r#"
name = "chamfer"
[robot]
urdf = "../../assets/robots/rig_planar/robot.urdf"
gravity = false
stiffness_scale = 1e4
inertia_scale = 1e3
[run]
duration_s = 1.0
[process.chamfer]
direction = "forward"
edges = 1
spindle_rpm = 300
feed_mm_per_rev = 0.1
depth_mm = 1.0
half_angle_deg = 45
hole_diameter_mm = 42
[process.chamfer.cutting]
axial_mpa = 1960
in_plane_mpa = 2140
in_plane_angle_deg = 20
edge_axial_n_per_mm = 5
"#;

/// Along its axis a cutter stands off by what the axial force bends it, and the edge is that much
/// less deep.
#[test]
fn verify_a_cutter_stands_off_by_its_axial_force() {
    let stiff = scenario(CHAMFER);
    let bent = with(
        &stiff,
        &table("tool", &[(2000.0, 0.1, 4.0, [0.0, 0.0, 1.0])]),
    );
    let recording = run(&bent, Engine::Rapier);
    let of = |name: &str| column(&recording, name);
    let rows = recording
        .time_s
        .iter()
        .enumerate()
        .filter(|(_, t)| **t > 0.3);
    let mut largest = 0.0_f64;
    for (i, time_s) in rows {
        let force_n = of("cutting.force_x")[i];
        let bent_m = of("chamfer.tool_mode1_deflection")[i].abs();
        largest = largest.max(force_n.abs());
        assert!(
            (bent_m * 4e6 - force_n.abs()).abs() < 0.02 * force_n.abs(),
            "{time_s} s"
        );
        // Feed per revolution, one edge: it stands a feed deeper than what has been cut.
        let nominal_m = of("cutting.depth")[i] + 0.1e-3;
        let short_m = nominal_m - of("cutting.engaged_depth")[i];
        assert!(
            (short_m - bent_m).abs() < 0.02 * bent_m + 1e-8,
            "{time_s} s: {short_m}, {bent_m}"
        );
    }
    assert!(largest > 100.0, "{largest}");
}

/// A wheel out of centre presses through two springs in series, its own and the spindle's.
#[test]
fn verify_a_wheel_presses_through_its_spindle_in_series() {
    let stiff =
        "gravity = false\nstiffness_scale = 1e4\ninertia_scale = 1e3\n[run]\noverload = \"warn\"";
    let text = support::wheel().effective_text();
    assert!(!text.contains("[run]"));
    let rigid = scenario(&text.replace("gravity = false", stiff));
    let modes = [(1500.0, 0.05, 0.08, [0.0, 0.0, 1.0])];
    let bent = with(&rigid, &table("tool", &modes));
    let swing = |scenario: &Scenario| {
        let recording = run(scenario, Engine::Rapier);
        let hz = scenario.process.facts().rate_rad_s.expect("it turns") / TAU;
        amplitude(&recording, "wheel.normal_force", hz, 0.5).norm()
    };
    let (own, series) = (swing(&rigid), swing(&bent));
    let wheel_n_per_m = rigid
        .number("process.wheel.stiffness_n_per_mm")
        .expect("given")
        * 1e3;
    let expected = 0.08e6 / (0.08e6 + wheel_n_per_m);
    println!("{own} N, {series} N: {} of {expected}", series / own);
    assert!((series / own / expected - 1.0).abs() < 0.01);
}

/// A mode that moves much of the arm's mass at its tool point, at the default step: released, it
/// rings at the frequency of the assembled masses. The rig is one oscillator along its tool.
#[test]
fn verify_a_heavy_mode_rings_at_its_frequency() {
    let (arm_kg, arm_n_per_m, arm_n_s_per_m) = (557.3, 0.8646e6, 878.0356075);
    let forces = "release_n = [500.0, 0.0, 0.0]";
    let rigid = load("rig_planar", "gravity = false", "duration_s = 0.5", forces);
    for share in [0.005, 0.02, 0.1, 0.3] {
        let mass_kg = share * arm_kg;
        let stiffness_n_per_m = mass_kg * (TAU * 135.0_f64).powi(2);
        let modes = [(135.0, 0.005, stiffness_n_per_m * 1e-6, [0.0, 0.0, 1.0])];
        let recording = run(&with(&rigid, &table("tool", &modes)), Engine::Rapier);
        let found_hz = ringing_hz(&recording, "load.tool_mode1_deflection");
        let own = attached(&modes)[0];
        let mass = Matrix2::new(arm_kg, mass_kg, mass_kg, mass_kg);
        let inverse = mass.try_inverse().expect("the arm is heavier");
        let diagonal = |a: f64, b: f64| Matrix2::new(a, 0.0, 0.0, b);
        let mut state = Matrix4::zeros();
        state.fixed_view_mut::<2, 2>(0, 2).fill_with_identity();
        let stiffness = inverse * diagonal(arm_n_per_m, own.stiffness_n_per_m);
        state.fixed_view_mut::<2, 2>(2, 0).copy_from(&-stiffness);
        let damping = inverse * diagonal(arm_n_s_per_m, own.damping_n_s_per_m());
        state.fixed_view_mut::<2, 2>(2, 2).copy_from(&-damping);
        let roots = state.complex_eigenvalues();
        let expected_hz = roots.iter().map(|root| root.im / TAU).fold(0.0, f64::max);
        let off = found_hz / expected_hz - 1.0;
        println!(
            "{share}: {found_hz} Hz of {expected_hz}: {off:.1e}, step {} s",
            recording.time_s[1]
        );
        assert!(off.abs() < 5e-4, "{share}: {found_hz} Hz of {expected_hz}");
    }
}

/// Frequency between the first and the last rising crossing of zero of the second difference over
/// some quarter of a period, which has next to nothing of the arm's slow swing.
fn ringing_hz(recording: &Recording, name: &str) -> f64 {
    let (time, given) = (&recording.time_s, column(recording, name));
    let apart = (0.25 / 135.0 / time[1]).round() as usize;
    let bend = |i: usize| given[i + apart] - 2.0 * given[i] + given[i - apart];
    let crossings: Vec<f64> = (apart + 1..given.len() - apart)
        .map(|i| (i, bend(i - 1), bend(i)))
        .filter(|(_, before, now)| *before < 0.0 && *now >= 0.0)
        .map(|(i, before, now)| time[i - 1] + before / (before - now) * (time[i] - time[i - 1]))
        .collect();
    let last = crossings.len() - 1;
    last as f64 / (crossings[last] - crossings[0])
}
