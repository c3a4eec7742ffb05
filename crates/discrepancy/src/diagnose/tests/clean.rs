//! False alarms.

use super::force::{Force, INTERVAL_S, MASS_KG};
use super::*;

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

/// The longest memory of all: power as 1/f down to a tenth of the record's lowest frequency.
#[test]
fn pink_noise_raises_no_alarm() {
    let alarms = alarms(Colour::Pink, 7000..7300);
    assert!(alarms <= 6, "{alarms} of 300");
}
