//! False alarms.

use super::force::{Force, INTERVAL_S, MASS_KG};
use super::*;
use crate::diagnose::{Progress, Stage};
use std::sync::Mutex;

/// Of 300 clean data sets, those in which anything is named or suspected. The mass is off by half
/// its uncertainty.
fn alarms(colour: Colour, seeds: std::ops::Range<u64>) -> usize {
    let model = Force::new(1200, 0.1);
    let truth = vec![model.force(1.025 * MASS_KG, &[])];
    let alarm = |seed: u64| {
        let data = observed(&truth, &[5.0], colour, seed, INTERVAL_S);
        let answer = run(&model, &data);
        let alarm = answer.diagnosis.verdict != Verdict::NothingBeyondNoise;
        if alarm {
            println!("seed {seed}: {}", describe(&answer));
        }
        usize::from(alarm)
    };
    seeds.map(alarm).sum()
}

#[test]
fn white_noise_raises_no_alarm() {
    let alarms = alarms(WHITE, 7000..7300);
    assert!(alarms <= 6, "{alarms} of 300");
}

#[test]
fn coloured_noise_raises_no_alarm() {
    let alarms = alarms(COLOURED, 7000..7300);
    assert!(alarms <= 6, "{alarms} of 300");
}

/// Every simulation is told as it is made, with what it is for, in the order of their numbers:
/// a stage of one slow arm is hundreds of them.
#[test]
fn every_simulation_is_told() {
    let model = Force::new(1200, 0.1);
    let truth = vec![model.force(1.025 * MASS_KG, &[])];
    let data = observed(&truth, &[5.0], WHITE, 7000, INTERVAL_S);
    let seen = Mutex::new(Vec::new());
    let progress = |now: Progress| seen.lock().unwrap().push(now);
    let answer = diagnose(&model, &data, &Options::default(), &progress).unwrap();
    let seen = seen.into_inner().unwrap();
    let counts: Vec<usize> = seen.iter().map(|now| now.predictions).collect();
    assert!(counts.is_sorted(), "{counts:?}");
    let made = answer.diagnosis.work.predictions;
    assert!(
        made > 0 && counts.len() > made,
        "{} of {made}",
        counts.len()
    );
    assert_eq!(counts.last(), Some(&made));
    let stages = [seen.first(), seen.last()].map(|now| now.map(|now| now.stage));
    assert_eq!(stages, [Some(Stage::Nominal), Some(Stage::SetUps)]);
}

/// The longest memory of all: power as 1/f down to a tenth of the record's lowest frequency.
#[test]
fn pink_noise_raises_no_alarm() {
    let alarms = alarms(Colour::Pink, 7000..7300);
    assert!(alarms <= 6, "{alarms} of 300");
}
