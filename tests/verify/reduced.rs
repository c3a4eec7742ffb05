//! The linearised, exactly stepped arm beside the arm in rapier, and beside closed forms.

use crate::support::{channel, recording, repository, scalar, scenario};
use std::path::Path;
use truecut_recording::{Outcome, Recording, Window, compare};
use truecut_scenario::{ProcessSpec, Scenario};
use truecut_sim::run::{Engine, Run};

fn overridden(scenario: &Scenario, overrides: &[(&str, &str)]) -> Scenario {
    let overrides: Vec<_> = (overrides.iter())
        .map(|(k, v)| ((*k).to_string(), (*v).to_string()))
        .collect();
    (scenario.with_overrides(&overrides)).unwrap_or_else(|e| panic!("{e:?}"))
}

fn reduced(scenario: &Scenario) -> Recording {
    recording(Engine::REDUCED, scenario, &[])
}

fn text(body: &str) -> Scenario {
    let at = repository().join("scenarios/arm/of_a_test.toml");
    Scenario::from_str(&at, body, &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

const TOOL: [&str; 3] = [
    "tool.displacement_x",
    "tool.displacement_y",
    "tool.displacement_z",
];
/// Forces that are compared: the first that a run has, of its process or of its transmissions.
const FORCES: [&[&str]; 8] = [
    &[
        "dynamometer.force_x",
        "dynamometer.force_y",
        "dynamometer.force_z",
    ],
    &["path_milling.force_x", "path_milling.force_y"],
    &["wheel.normal_force"],
    &["brush.bristle_force"],
    &["polish.normal_force"],
    &["surface_polish.normal_force"],
    &["belt.normal_force"],
    &["joint1.transmission_torque", "joint2.transmission_torque"],
];

/// A shipped scenario, how much of it is run (s, all where none is given), and the most that tool
/// displacement and force ([`FORCES`]) may be apart, as NRMSE in percent. The first pair holds at
/// the reduced plant's own default step, the second at rapier's.
type Bound = (&'static str, Option<&'static str>, [f64; 2], [f64; 2]);

/// Every shipped scenario that is not a sweep, of those that stand still; and of each process that
/// leads the tool along a path the first lines, of a replay all. The bounds are what this test
/// measured (it prints it), rounded up: the arm in rapier against the reduced one, in one build.
/// What differs at rapier's step is the linearisation, and what rapier errs by itself: the reduced
/// plant meets process forces to fourth order, rapier to second. With a free rod chip regeneration
/// magnifies any difference.
const BOUNDS: [Bound; 20] = [
    ("arm/contour.toml", None, [1e-4, 5e-3], [1e-4, 5e-3]),
    ("arm/free_decay.toml", None, [0.04, 0.03], [0.04, 0.03]),
    ("arm/frequency_sweep.toml", None, [0.01, 0.01], [0.01, 0.01]),
    ("arm/static_load.toml", None, [0.06, 0.06], [0.06, 0.06]),
    (
        "chamfer/backward_high.toml",
        None,
        [0.005, 0.1],
        [0.003, 0.05],
    ),
    (
        "chamfer/backward_low.toml",
        None,
        [0.01, 0.03],
        [0.01, 0.01],
    ),
    (
        "chamfer/backward_rod_free.toml",
        None,
        [0.3, 0.8],
        [0.3, 0.8],
    ),
    (
        "chamfer/backward_sufficient.toml",
        None,
        [0.005, 0.1],
        [0.003, 0.05],
    ),
    ("chamfer/forward_300.toml", None, [0.01, 0.02], [0.01, 0.01]),
    (
        "chamfer/forward_400.toml",
        None,
        [0.015, 0.02],
        [0.015, 0.01],
    ),
    (
        "chamfer/forward_rod_free.toml",
        None,
        [0.3, 0.8],
        [0.3, 0.8],
    ),
    (
        "chamfer/planar_low.toml",
        None,
        [0.012, 0.08],
        [0.001, 0.03],
    ),
    ("wheel/plate.toml", None, [0.001, 0.12], [0.001, 0.12]),
    (
        "finishing/block_edge_brush.toml",
        None,
        [1e-5, 1e-4],
        [1e-5, 1e-4],
    ),
    (
        "finishing/hub_spoke_belt.toml",
        Some("1.5"),
        [3e-5, 3e-3],
        [3e-5, 3e-3],
    ),
    (
        "finishing/mould_free.toml",
        Some("3.0"),
        [1e-6, 1e-4],
        [1e-6, 1e-4],
    ),
    (
        "finishing/cover_polish.toml",
        Some("3.0"),
        [2e-4, 3e-3],
        [2e-4, 3e-3],
    ),
    (
        "milling/pocket.toml",
        Some("1.7"),
        [1e-5, 0.1],
        [1e-5, 1e-4],
    ),
    ("milling/swarf.toml", Some("1.9"), [1e-5, 0.1], [1e-5, 1e-4]),
    ("diagnosis/elbow.toml", None, [1e-4, 1e-3], [1e-5, 4e-4]),
];

/// A scenario of the table with the part of it that is run.
fn listed((name, duration_s, ..): &Bound) -> Scenario {
    let duration = duration_s.map(|duration_s| ("run.duration_s", duration_s));
    overridden(&scenario(name), duration.as_slice())
}

/// How far the reduced arm is from rapier's in tool displacement and in force, percent.
fn apart(theirs: &Recording, ours: &Recording) -> [f64; 2] {
    assert_eq!(ours.outcome, Outcome::Completed);
    let nrmse = |channels: &[&str]| {
        let difference = compare(theirs, ours, channels, Window::default());
        difference.map(|difference| difference.nrmse * 1e2)
    };
    let force = FORCES.into_iter().find_map(|channels| nrmse(channels).ok());
    [
        nrmse(&TOOL).expect("every run has it"),
        force.unwrap_or(0.0),
    ]
}

#[test]
fn regress_reduced_against_rapier_in_every_process() {
    let mut far = Vec::new();
    for bound in &BOUNDS {
        let (name, _, own_step, rapiers_step) = bound;
        let scenario = listed(bound);
        let theirs = recording(Engine::Rapier, &scenario, &[]);
        let step_ms = format!("{:?}", 1e3 * scalar(&theirs, "run.time_step"));
        let same_step = overridden(&scenario, &[("run.time_step_ms", &step_ms)]);
        for (label, ours, most) in [
            ("own", reduced(&scenario), own_step),
            ("rapier's", reduced(&same_step), rapiers_step),
        ] {
            let [tool, force] = apart(&theirs, &ours);
            println!("{name}, {label} step: tool {tool:.5} %, force {force:.5} %");
            // What is no number is too far, too.
            if !(tool <= most[0] && force <= most[1]) {
                far.push(format!("{name} ({label} step): {tool} {force}"));
            }
        }
    }
    assert!(far.is_empty(), "{far:#?}");
}

/// Milling has its own comparison, in `crates/sim/tests/milling/reduced.rs`.
#[test]
fn every_process_and_every_scenario_that_stands_still_is_compared() {
    let compared: Vec<String> = (BOUNDS.iter())
        .map(|bound| listed(bound).process.name().to_owned())
        .chain(["milling".to_owned()])
        .collect();
    for name in ProcessSpec::NAMES {
        assert!(
            compared.iter().any(|one| one == name),
            "{name} is not compared"
        );
    }
    let root = repository().join("scenarios");
    for folder in ["arm", "chamfer", "wheel"] {
        for entry in std::fs::read_dir(root.join(folder)).expect("shipped") {
            let path = entry.expect("shipped").path();
            // A path from CAM lies beside its scenario.
            if path.extension().is_none_or(|ending| ending != "toml") {
                continue;
            }
            let name = path.strip_prefix(&root).expect("below");
            let sweep = scenario(&name.display().to_string()).sweep.is_some();
            let listed = BOUNDS.iter().any(|(n, ..)| Path::new(n) == name);
            assert!(sweep || listed, "{} is not compared", name.display());
        }
    }
}

const RIG: &str = r#"
name = "rig"
[robot]
urdf = "../../assets/robots/rig_1dof/robot.urdf"
gravity = false
"#;

/// The mass on a spring, released: 100 kg, 1e6 N/m, damping ratio 2 %.
#[test]
fn verify_free_decay_of_the_rig_is_exact_at_any_step() {
    let (omega, zeta, x0) = (100.0f64, 0.02f64, 1e-3);
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    for step_ms in ["0.05", "0.3", "1.0", "5.0", "15.0"] {
        let body = format!(
            "{RIG}[run]\nduration_s = 3.0\ntime_step_ms = {step_ms}\n\
             [process.load]\nrelease_n = [1000.0, 0.0, 0.0]\n"
        );
        let run = reduced(&text(&body));
        let x = channel(&run, "tool.displacement_x");
        let v = channel(&run, "tool.velocity_x");
        let mut worst: (f64, f64) = (0.0, 0.0);
        for ((t, x), v) in run.time_s.iter().zip(x).zip(v) {
            let (sin, cos) = (damped * t).sin_cos();
            let decay = x0 * (-zeta * omega * t).exp();
            let exact = decay * (cos + zeta * omega / damped * sin) - x0;
            let speed = -decay * omega * omega / damped * sin;
            worst.0 = worst.0.max((x - exact).abs() / x0);
            worst.1 = worst.1.max((v - speed).abs() / (x0 * omega));
        }
        println!("step {step_ms} ms: {worst:?}");
        assert!(worst.0 < 1e-9 && worst.1 < 1e-9, "{step_ms}: {worst:?}");
    }
}

/// A sine force on the rig is met to (w h)²/12 of the motion: halving the step quarters the error.
#[test]
fn verify_a_given_force_is_met_to_second_order() {
    let run = |step_ms: &str| {
        reduced(&text(&format!(
            "{RIG}[run]\nduration_s = 2.0\ntime_step_ms = {step_ms}\nrecord_interval_ms = 8.0\n\
             [process.load.sweep]\namplitude_n = [100.0, 0.0, 0.0]\nfrom_hz = 1\nto_hz = 12\n"
        )))
    };
    let reference = run("0.01");
    let error = |step_ms: &str| {
        let apart = compare(&reference, &run(step_ms), &TOOL[..1], Window::default());
        apart.expect("same channels").nrmse
    };
    let errors = ["4.0", "2.0", "1.0", "0.5"].map(error);
    println!("{errors:?}");
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.7..4.3).contains(&ratio), "{errors:?}");
    }
}

/// By how much energy moves, of the most that is kinetic, where an arm without damping swings for
/// 10 s after a force of this size is let go.
fn drift(step_ms: f64, size: f64) -> f64 {
    let [x, y, z] = [3000.0, 2000.0, -1000.0].map(|force| size * force);
    let body = format!(
        "name = \"arm\"\n[robot]\nurdf = \"../../assets/robots/irb6600_175_255/robot.urdf\"\n\
         posture_deg = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]\ndamping_scale = 0.0\ngravity = false\n\
         [run]\nduration_s = 10.0\ntime_step_ms = {step_ms:?}\n\
         [process.load]\nrelease_n = [{x:?}, {y:?}, {z:?}]\n"
    );
    let run = reduced(&text(&body));
    let kinetic = channel(&run, "energy.kinetic");
    let total: Vec<f64> = (kinetic.iter().zip(channel(&run, "energy.potential")))
        .map(|(k, p)| k + p)
        .collect();
    let most = kinetic.iter().copied().fold(0.0, f64::max);
    let drift = (total.iter().map(|e| (e - total[0]).abs())).fold(0.0, f64::max);
    println!(
        "step {step_ms} ms, force {size}: energy moves by {:.1e} of the swing",
        drift / most
    );
    drift / most
}

/// Without damping the arm keeps its energy: the recurrence is the motion itself, so that what
/// moves goes with the size of the swing, and with the step at least squared.
#[test]
fn verify_undamped_arm_keeps_its_energy() {
    for step_ms in [1.0, 2.5] {
        let [large, small] = [0.1, 0.01].map(|size| drift(step_ms, size));
        assert!((0.08..0.12).contains(&(small / large)));
    }
    let [coarse, fine] = [1.0, 0.5].map(|step_ms| drift(step_ms, 0.01));
    assert!(coarse < 2e-5 && fine < 0.3 * coarse);
}

/// Free joints: a prismatic rig falls on a parabola under a constant force, to the last digits.
#[test]
fn verify_force_drive_of_the_rig_is_a_parabola() {
    let body = format!(
        "{RIG}drive = \"force\"\n[run]\nduration_s = 0.5\ntime_step_ms = 10.0\n\
         [process.load]\nconstant_n = [50.0, 0.0, 0.0]\n"
    );
    let run = reduced(&text(&body));
    let x = channel(&run, "tool.displacement_x");
    for (t, x) in run.time_s.iter().zip(x) {
        let exact = 0.5 * 50.0 / 100.0 * t * t;
        assert!((x - exact).abs() < 1e-13, "{t}: {x} against {exact}");
    }
}

/// Free revolute joints: the arm falls. Mass is renewed along the way, velocity products act.
#[test]
fn regress_a_falling_arm_against_rapier() {
    let body = "name = \"arm\"\n[robot]\nurdf = \"../../assets/robots/irb6600_175_255/robot.urdf\"\n\
                posture_deg = [10, -5, 10, 5, 20, 0]\ndrive = \"force\"\n\
                [run]\nduration_s = 0.35\ntime_step_ms = 0.25\n[process.load]\nconstant_n = [0.0, 50.0, 0.0]\n";
    let scenario = text(body);
    let theirs = recording(Engine::Rapier, &scenario, &[]);
    let ours = reduced(&scenario);
    assert_eq!(ours.outcome, Outcome::Completed);
    let apart = compare(&theirs, &ours, &TOOL, Window::default()).expect("same channels");
    println!("falling arm: {:.4} %", apart.nrmse * 1e2);
    assert!(apart.nrmse < 2e-4, "{}", apart.nrmse);
}

/// Servo drives: rotors turn beside the arm. The stretched arm gives way by 4.6 mm under 1 kN; what
/// is apart is of second order in that, and falls with the force.
#[test]
fn regress_servo_drive_against_rapier() {
    for (robot, force_n, bound) in [
        ("rig_1dof", 2000.0, 1e-4),
        ("irb6600_175_255", 1000.0, 6e-3),
        ("irb6600_175_255", 100.0, 6e-4),
    ] {
        let scenario = text(&format!(
            "name = \"servo\"\n[robot]\nurdf = \"../../assets/robots/{robot}/robot.urdf\"\n\
             drive = \"servo\"\n[run]\nduration_s = 2.0\n\
             [process.load]\nconstant_n = [{force_n:?}, 0.0, 0.0]\n"
        ));
        let theirs = recording(Engine::Rapier, &scenario, &[]);
        let apart = compare(&theirs, &reduced(&scenario), &TOOL, Window::default());
        let nrmse = apart.expect("same channels").nrmse;
        println!("{robot} on servos, {force_n} N: {:.4} %", nrmse * 1e2);
        assert!(nrmse < bound, "{robot}: {nrmse}");
    }
}

/// The same run twice, and by rows instead of a recorder, is the same to the bit.
#[test]
fn reduced_runs_are_the_same_to_the_bit() {
    let scenario = overridden(
        &scenario("chamfer/backward_low.toml"),
        &[("run.record_interval_ms", "2")],
    );
    let (first, second) = (reduced(&scenario), reduced(&scenario));
    assert_eq!(first.columns, second.columns);
    let run = Run {
        engine: Engine::REDUCED,
        ..Run::of(&scenario)
    };
    let rows = run.rows(&[], None).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(rows.time_s, first.time_s);
    for (row, time_s) in rows.time_s.iter().enumerate() {
        assert!((time_s - 2e-3 * row as f64).abs() < 1e-12);
    }
    assert_eq!(rows.columns, first.columns);
}

/// A step that leaves the fastest mode too few points is refused, naming the key.
#[test]
fn regress_a_step_too_long_for_the_reduced_plant_is_refused() {
    let scenario = overridden(
        &scenario("arm/free_decay.toml"),
        &[("run.time_step_ms", "3")],
    );
    let run = Run {
        engine: Engine::REDUCED,
        ..Run::of(&scenario)
    };
    let error = (run.rows(&[], None)).expect_err("3 ms for a mode of 88 Hz passed");
    let message = error.to_string();
    assert!(
        message.contains("run.time_step_ms") && message.contains("4 steps"),
        "{message}"
    );
}
