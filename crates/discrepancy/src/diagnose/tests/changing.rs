//! What changes over time, on the slide whose motion is given.

use truecut_scenario::effect::EffectKind;

use super::force::{Force, INTERVAL_S, MASS_KG, effect};
use super::*;

/// The force with an effect from a sample on.
fn from(model: &Force, sample: usize, kind: EffectKind, values: &[f64]) -> Vec<f64> {
    let (without, with) = (
        model.force(MASS_KG, &[]),
        model.force(MASS_KG, &[effect(kind, values)]),
    );
    let rows = without.iter().zip(&with).enumerate();
    rows.map(|(t, (a, b))| if t < sample { *a } else { *b })
        .collect()
}

#[test]
fn regress_a_law_that_sets_in_is_told_with_its_moment() {
    let model = Force::new(2000, 0.1);
    for seed in 0..8 {
        let sample = 500 + 100 * seed as usize;
        let (kind, values) = match seed % 2 {
            0 => (EffectKind::JointCoulomb, vec![25.0]),
            _ => (EffectKind::JointViscous, vec![120.0]),
        };
        let force = from(&model, sample, kind, &values);
        let data = observed(&vec![force], &[1.0], WHITE, 300 + seed, INTERVAL_S);
        let answer = run(&model, &data);
        let told = describe(&answer);
        assert_eq!(answer.diagnosis.verdict, Verdict::UnknownCause, "{told}");
        let moments = answer.diagnosis.changes.iter().filter_map(|one| one.from_s);
        let truth = sample as f64 * INTERVAL_S;
        let near = moments
            .filter(|moment| (moment - truth).abs() < 0.5)
            .count();
        assert!(near > 0, "{truth} s: {:?} {told}", answer.diagnosis.changes);
        assert!(
            answer.diagnosis.reason.contains("changes over time"),
            "{told}"
        );
    }
}

#[test]
fn regress_slow_noise_is_no_change() {
    let model = Force::new(2000, 0.1);
    for (seed, colour) in (0..12).zip([WHITE, COLOURED, Colour::Pink].into_iter().cycle()) {
        let force = model.force(MASS_KG, &[]);
        let data = observed(&vec![force], &[2.0], colour, 400 + seed, INTERVAL_S);
        let answer = run(&model, &data);
        assert!(answer.diagnosis.changes.is_empty(), "{}", describe(&answer));
    }
}
