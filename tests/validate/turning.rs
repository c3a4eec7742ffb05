//! Diagnosis of the forces of a turning cut.

use std::f64::consts::TAU;
use std::path::Path;

use crate::support::{NoData, data_file, diagnosed, extended, measured, named, scenario};
use truecut_discrepancy::compare::{ChannelComparison, compare_recordings};
use truecut_discrepancy::diagnose::Verdict;
use truecut_scenario::effect::EffectKind;
use truecut_scenario::{ProcessSpec, Scenario};
use truecut_sim::run::{Claims, Run};

/// What `truecut compare` says of the passive force, the largest.
fn compared(scenario: &Scenario, file: &Path) -> ChannelComparison {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        panic!("a replay")
    };
    let turning = replay.turning.expect("a turning cut");
    let data = measured(scenario, file);
    let run = Run {
        measured: Some(&data),
        claims: Claims::Ignore,
        ..Run::of(scenario)
    };
    let finished = run.execute().unwrap();
    let compared = finished.compared.expect("no plant");
    let speed = Some(turning.spindle_rad_s / TAU);
    let all = compare_recordings(&finished.recording, &compared, speed).unwrap();
    let mut channels = all.channels.into_iter();
    channels
        .find(|one| one.channel == "dynamometer.force_z")
        .expect("it was measured")
}

/// Size of the line so many times per revolution; 0 if there is none.
fn line(channel: &ChannelComparison, per_revolution: u32) -> f64 {
    let found = channel
        .lines
        .iter()
        .find(|line| line.per_revolution.map(u64::from) == Some(u64::from(per_revolution)));
    found.map_or(0.0, |line| line.residual)
}

/// Once per revolution (17.6 Hz) the workpiece runs out; that is named. Three times per revolution
/// the chuck's jaws show: no effect of the library does that, so it is described, before and after,
/// and given no name.
pub fn validate_turning_runout_is_named_and_the_chuck_is_described() -> Result<(), NoData> {
    let file = data_file("turning_forces/f416_a100.csv")?;
    let nominal = scenario("turning.toml");
    let answer = diagnosed(&nominal, &file);
    assert_eq!(
        answer.diagnosis.verdict,
        Verdict::Named,
        "{}",
        answer.diagnosis.reason
    );
    // It is not all: the forces do not turn quite in step, as those of a depth would.
    assert_eq!(named(&answer), [(EffectKind::CuttingRunout, None)]);
    let runout = &answer.effects[0].values;
    let size_um = 1e6 * runout[0].hypot(runout[1]);

    let before = compared(&nominal, &file);
    let after = compared(&extended(&nominal, &answer), &file);
    let told = |channel: &ChannelComparison| (line(channel, 1), line(channel, 3));
    let (before, after) = (told(&before), told(&after));
    eprintln!("runout {size_um:.2} um; lines before {before:.2?} N, after {after:.2?} N");
    // The line of 6 N in 730 N is a part in 120 of the depth of 1 mm.
    assert!((6.0..10.0).contains(&size_um), "{size_um} um");
    assert!(
        before.0 > 5.0 && after.0 < 0.4 * before.0,
        "once per revolution"
    );
    assert!(after.1 > 2.5 && after.1 > 0.9 * before.1, "three times");
    Ok(())
}
