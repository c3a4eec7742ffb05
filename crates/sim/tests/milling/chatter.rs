//! Chatter as a run tells it: its line, its growth, and the end where paths of teeth loop.

use super::limits::benchmark;
use super::support::{RIG, run, run_reduced, scalar, scenario};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use truecut_core::chatter::limit::{FirstLimit, LimitSearch, first_limit};
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_core::chatter::{DirectionalMatrix, TipMode};
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_recording::Outcome;
use truecut_scenario::Scenario;
use truecut_sim::run::{Claims, Engine, Run};

fn mode() -> TipMode {
    TipMode::of_mass(TAU * 922.0, 0.011, 0.03993, &Vector3::x())
}

/// At larger feeds forced vibration moves the onset. The ramp takes sixty teeth.
const SMALL_FEED: [(&str, &str); 3] = [
    ("process.milling.feed_mm_per_tooth", "0.002"),
    ("process.milling.ramp_mm", "0.12"),
    ("process.milling.path.length_mm", "0.6"),
];

/// At the default step, 60 a cycle, the mode is out of tune by 5e-4, which beside a harmonic moves
/// a growth rate by half of 1/s.
const STEPS_PER_CYCLE: f64 = 150.0;

/// The rig's cut in up-milling, as theory has it.
fn theory(immersion: f64, rpm: f64) -> (SpectralElements, f64, FirstLimit) {
    let up = Engagement::up(immersion, 1.0).expect("partial");
    let process = DirectionalMatrix::planar(2, 6e8, 1.0 / 3.0, up);
    let elements = SpectralElements::new(&[mode()], &process);
    let period_s = 30.0 / rpm;
    let limit = first_limit(&elements, period_s, &LimitSearch::to_depth(5e-3));
    let limit = limit.expect("a limit");
    (elements, period_s, limit)
}

fn up(cut: &Scenario, more: &[(&str, &str)]) -> Scenario {
    let engagement = ("process.milling.engagement", "up");
    let all = more.iter().chain([&engagement]);
    let all: Vec<_> = all
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    cut.with_overrides(&all).expect("a cut")
}

/// At a lobe's best speed the vibration stands beside a harmonic of the teeth, 10 Hz from 933 Hz at
/// 7000 rpm, and the forced vibration is far larger. Line and growth rate are those of theory.
#[test]
fn verify_line_and_growth_beside_a_harmonic() {
    for (immersion, rpm) in [(0.3, 7e3), (0.5, 9.3e3), (0.3, 14e3)] {
        let (elements, period_s, limit) = theory(immersion, rpm);
        let theory_hz = elements.at(period_s).chatter_hz(limit.depth_m);
        for share in [0.95, 1.03] {
            let depth_m = share * limit.depth_m;
            let steps = (STEPS_PER_CYCLE * 922.0 * period_s).ceil();
            let step_ms = format!("{:?}", 1e3 * period_s / steps);
            let cut = up(&benchmark(immersion, rpm, depth_m), &SMALL_FEED);
            let cut = up(&cut, &[("run.time_step_ms", &step_ms)]);
            let recording = run_reduced(&cut);
            let hz = scalar(&recording, "milling.chatter_frequency");
            let rate = scalar(&recording, "milling.growth_rate");
            let theory = elements
                .at(period_s)
                .multiplier(depth_m)
                .growth_per_s(period_s);
            println!(
                "a/D {immersion}, {rpm} rpm, {share}: {hz:.2} of {theory_hz:.2} Hz, {rate:.3} of {theory:.3} /s"
            );
            assert!((hz / theory_hz - 1.0).abs() < 5e-3, "{hz} {theory_hz}");
            assert!(
                rate * theory > 0.0 && (rpm > 7e3 || (rate - theory).abs() < 0.3),
                "{rate} {theory}"
            );
        }
    }
}

/// From rest at full depth and 0.1 mm a tooth vibration never is small beside the feed. The line is
/// the mode's all the same, and the growth rate is a number: that of the levels as they are, here
/// against the logarithm of root mean squares of the change from tooth to tooth.
#[test]
fn verify_line_and_growth_of_vibration_that_never_is_small() {
    let overrides = [
        ("process.milling.spindle_rpm", "7000.0".to_owned()),
        ("process.milling.feed_mm_per_tooth", "0.1".to_owned()),
        ("process.milling.axial_depth_mm", "1.0".to_owned()),
        ("process.milling.radial_depth_mm", "6.0".to_owned()),
        ("process.milling.path.length_mm", "9.0".to_owned()),
    ];
    let recording = run(&up(&scenario(RIG, &overrides), &[]));
    let hz = scalar(&recording, "milling.chatter_frequency");
    let amplitude_m = scalar(&recording, "milling.chatter_amplitude");
    assert!((hz / 923.6 - 1.0).abs() < 5e-3, "{hz}");
    assert!((80e-6..160e-6).contains(&amplitude_m), "{amplitude_m}");
    let mut channels = recording.header.channels.iter();
    let place = channels.position(|spec| spec.name == "milling.deflection_x");
    let x = &recording.columns[place.expect("a channel")];
    let step_s = recording.time_s[1] - recording.time_s[0];
    let period = (30.0 / 7e3 / step_s).round() as usize;
    let changes: Vec<f64> = (period..x.len()).map(|i| x[i] - x[i - period]).collect();
    let window = 10 * period;
    let level = |part: &[f64]| (part.iter().map(|d| d * d).sum::<f64>() / window as f64).sqrt();
    let (first, last) = (
        level(&changes[..window]),
        level(&changes[changes.len() - window..]),
    );
    let expected = (last / first).ln() / ((changes.len() - window) as f64 * step_s);
    let rate = scalar(&recording, "milling.growth_rate");
    println!(
        "{hz:.2} Hz, {:.1} um, {rate:.3} of {expected:.3} /s",
        amplitude_m * 1e6
    );
    assert!((rate / expected - 1.0).abs() < 0.15, "{rate} {expected}");
}

/// Three times the limit: vibration grows until the tool is as fast as its teeth, A ω = R Ω, and
/// the run ends with that amplitude, in either engine, with rows up to there.
#[test]
fn a_run_whose_teeth_turn_back_ends_in_chatter() {
    let (_, _, limit) = theory(0.3, 7e3);
    let cut = benchmark(0.3, 7e3, 3.0 * limit.depth_m);
    let more = [("process.milling.path.length_mm", "20.0")];
    let cut = up(&cut, &more);
    let looping_m = 10e-3 * 7e3 / 60.0 / 922.0;
    for engine in [Engine::Rapier, Engine::REDUCED] {
        let run = Run {
            engine,
            claims: Claims::Ignore,
            ..Run::of(&cut)
        };
        let recording = run.execute().unwrap_or_else(|e| panic!("{e}")).recording;
        let Outcome::Chatter {
            time_s,
            amplitude_m,
            ..
        } = recording.outcome
        else {
            panic!("{engine:?}: {}", recording.outcome);
        };
        println!("{engine:?}: {}", recording.outcome);
        assert!(
            (0.8..2.0).contains(&(amplitude_m / looping_m)),
            "{amplitude_m}"
        );
        let last_s = recording.time_s.last().expect("rows");
        assert!(
            *last_s < time_s && time_s - last_s < 1e-3,
            "{last_s} {time_s}"
        );
        let hz = scalar(&recording, "milling.chatter_frequency");
        assert!((900.0..1000.0).contains(&hz), "{hz}");
        assert!(scalar(&recording, "milling.growth_rate") > 0.0);
    }
}
