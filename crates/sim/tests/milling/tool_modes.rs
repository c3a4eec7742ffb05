//! Modes of tool and workpiece: limits of one alone, runs about them, and both engines.

use super::support::{RIG, run, run_reduced, scalar, scenario};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use truecut_core::chatter::limit::{LimitSearch, first_limit};
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_core::chatter::{AttachedModes, TipMode};
use truecut_recording::Recording;
use truecut_scenario::Scenario;
use truecut_sim::stability::MillingStudy;

/// The mode of benchmark 1 (`insperger2011`).
const MODE: &str = "
frequency_hz = 922
damping_ratio = 0.011
stiffness_n_per_um = 1.34004965
direction = [2, 0, 0]
";
/// The rig of the benchmark hardly moves: 400 kg on a spring of a million times the mode's.
const STILL: [(&str, &str); 5] = [
    ("robot.stiffness_scale", "1e6"),
    ("robot.inertia_scale", "1e4"),
    ("process.milling.spindle_rpm", "5000"),
    ("process.milling.ramp_mm", "1.2"),
    ("process.milling.path.length_mm", "3.6"),
];

const END_MILL: &str = include_str!("../../../../scenarios/milling/end_mill_12.toml");

fn rig(whose: &str, overrides: &[(&str, String)]) -> Scenario {
    let text = format!("{RIG}[[process.milling.{whose}.mode]]{MODE}");
    let is_own = |key: &str| overrides.iter().any(|(own, _)| *own == key);
    let still = STILL.into_iter().filter(|(key, _)| !is_own(key));
    let still = still.map(|(key, value)| (key, value.to_owned()));
    scenario(&text, &still.chain(overrides.to_vec()).collect::<Vec<_>>())
}

/// Limits of one mode, on the tool or on the workpiece, are those of the oscillator alone.
#[test]
fn verify_one_mode_alone_has_the_limits_of_the_oscillator() {
    let alone = [TipMode::of_mass(TAU * 922.0, 0.011, 0.03993, &Vector3::x())];
    for whose in ["cutter", "workpiece"] {
        for rpm in [4000.0, 5000.0, 7000.0, 10_000.0, 16_000.0] {
            let scenario = rig(
                whose,
                &[("process.milling.spindle_rpm", format!("{rpm:?}"))],
            );
            let study = MillingStudy::of(&scenario).expect("milling");
            let modes = study.modes(&[0.0]).expect("stiff");
            assert_eq!(modes.len(), 2);
            let limit = |modes: &[TipMode]| {
                let elements = SpectralElements::new(modes, &study.cut.directional());
                let search = LimitSearch::to_depth(5e-3);
                let found = first_limit(&elements, study.cut.tooth_period_s(), &search);
                found.expect("a limit").depth_m
            };
            let (found, expected) = (limit(&modes), limit(&alone));
            let error = found / expected - 1.0;
            println!("{whose} {rpm}: {:.4} mm, {error:+.2e}", found * 1e3);
            assert!(error.abs() < 5e-3, "{whose} {rpm}: {found} {expected}");
        }
    }
}

/// The limit of 0.852 mm at 5000 rpm in the time domain, the mode stepped beside the arm.
#[test]
fn verify_runs_about_the_limit_of_one_mode() {
    for whose in ["cutter", "workpiece"] {
        for (share, grows) in [(0.95, false), (1.05, true)] {
            let depth = (
                "process.milling.axial_depth_mm",
                format!("{:?}", share * 0.852),
            );
            let end = run_reduced(&rig(whose, &[depth]));
            let rate = scalar(&end, "milling.growth_rate");
            println!("{whose} {share}: {rate:.3} /s");
            assert_eq!(rate > 0.0, grows, "{whose} {share}: {rate}");
        }
    }
}

/// A mode that the cut meets at rest is deflected by force over stiffness.
#[test]
fn verify_a_cut_under_way_starts_with_the_mode_deflected() {
    let still = ("process.milling.ramp_mm", "0".to_owned());
    let end = run_reduced(&rig("cutter", &[still]));
    let deflection = column(&end, "milling.tool_mode1_deflection")[0];
    let force = scalar(&end, "milling.nominal_force_x");
    assert!(
        (deflection * 1.34004965e6 / force - 1.0).abs() < 1e-9,
        "{deflection} {force}"
    );
    let tip = column(&end, "milling.deflection_x")[0];
    assert!((tip / deflection - 1.0).abs() < 1e-5, "{tip} {deflection}");
}

/// The arm in rapier and linearised, the end mill's modes beside it: the tip moves alike.
#[test]
fn regress_engines_agree_with_tool_modes() {
    let overrides = [
        ("run.duration_s", "0.1".to_owned()),
        ("run.time_step_ms", "0.0125".to_owned()),
        ("process.milling.ramp_mm", "0.2".to_owned()),
    ];
    let scenario = scenario(END_MILL, &overrides);
    let (rapier, reduced) = (run(&scenario), run_reduced(&scenario));
    for axis in ["x", "y"] {
        let name = format!("milling.deflection_{axis}");
        let (a, b) = (column(&rapier, &name), column(&reduced, &name));
        assert_eq!(a.len(), b.len());
        let range = a
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [low.min(*x), high.max(*x)]
            });
        let apart = a
            .iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        println!("{name}: {:.2e} of the range", apart / (range[1] - range[0]));
        assert!(apart < 1e-3 * (range[1] - range[0]), "{name}");
    }
}

/// A mode over the spindle's speed: at 6000 rpm and 18 000 rpm as given, halfway at 12 000 rpm.
const OVER_SPEED: &str = "[{ spindle_rpm = 6000, frequency_hz = 900 }, \
     { spindle_rpm = 18000, frequency_hz = 800, damping_ratio = 0.05, stiffness_n_per_um = 6 }]";
const FIRST_MODE: &str = "process.milling.cutter.mode.0";

/// The end mill at a speed with its first mode over speed, and with what that is at the speed.
fn over_speed(rpm: f64, [hz, zeta, k]: [f64; 3]) -> [Scenario; 2] {
    let of = |rows: &[(&str, String)]| {
        let mut overrides = vec![
            ("process.milling.spindle_rpm".to_owned(), rpm.to_string()),
            ("run.duration_s".to_owned(), "0.05".to_owned()),
        ];
        let rows = rows.iter();
        overrides.extend(rows.map(|(key, value)| (format!("{FIRST_MODE}.{key}"), value.clone())));
        let overrides: Vec<(&str, String)> = (overrides.iter())
            .map(|(key, value)| (key.as_str(), value.clone()))
            .collect();
        scenario(END_MILL, &overrides)
    };
    [
        of(&[("over_speed", OVER_SPEED.to_owned())]),
        of(&[
            ("frequency_hz", hz.to_string()),
            ("damping_ratio", zeta.to_string()),
            ("stiffness_n_per_um", k.to_string()),
        ]),
    ]
}

/// Runs, limits over the speed and the spread of limits take a mode as it is at their speed.
#[test]
fn a_mode_over_the_spindle_speed_acts_as_it_is_at_that_speed() {
    let rows = [
        (3000.0, [950.0, 0.03, 10.0]),
        (12_000.0, [850.0, 0.04, 8.0]),
        (24_000.0, [800.0, 0.05, 6.0]),
    ];
    for (rpm, mode) in rows {
        let [table, constant] = over_speed(rpm, mode);
        let (found, expected) = (run(&table), run(&constant));
        for name in ["milling.deflection_x", "milling.tool_mode1_deflection"] {
            let pairs = column(&found, name).iter().zip(column(&expected, name));
            let range = pairs.clone().map(|(_, b)| b.abs()).fold(0.0, f64::max);
            let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-9 * range, "{rpm} {name}: {apart} of {range}");
        }
        // From another speed of the same scenario, as a diagram asks.
        let [elsewhere, _] = over_speed(9000.0, mode);
        let modes = |scenario: &Scenario| {
            let study = MillingStudy::of(scenario).expect("milling");
            let posture = study.postures().expect("in reach").knots[0].clone();
            (study.modes_of(&study.robot, &posture, rpm * TAU / 60.0)).expect("stiff")
        };
        for (found, expected) in modes(&elsewhere).iter().zip(modes(&constant)) {
            let (a, b) = (
                found.natural_frequency_rad_s,
                expected.natural_frequency_rad_s,
            );
            assert!((a / b - 1.0).abs() < 1e-12, "{rpm}: {a}, {b}");
        }
        let notes = &found.header.notes;
        let told = notes.iter().any(|note| note.contains("over_speed"));
        assert_eq!(told, rpm > 18_000.0, "{notes:?}");
    }
}

/// The diagram of the end mill is one of millimetres, and without its modes ends where the arm's
/// do.
#[test]
fn verify_the_end_mill_is_limited_by_its_modes() {
    let scenario = scenario(END_MILL, &[]);
    let study = MillingStudy::of(&scenario).expect("milling");
    let posture = &study.postures().expect("in reach").knots[0];
    let modes = study.modes(posture).expect("stiff");
    assert_eq!(modes.len(), 8);
    assert_eq!(study.known_to_rad_s(&modes), None);
    let mut without = study.clone();
    without.cut.attached = AttachedModes::default();
    let arm = without.modes(posture).expect("stiff");
    let known = without.known_to_rad_s(&arm).expect("no tool modes");
    // Twice 85.6 Hz, two teeth.
    assert!((known * 60.0 / TAU / 5139.0 - 1.0).abs() < 1e-2, "{known}");
    assert!(
        without
            .beyond_modes(&arm, known)
            .contains("process.milling.cutter.mode")
    );
}

fn column<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    recording.channel(name).unwrap_or_else(|e| panic!("{e}"))
}
