//! One effect at twice the noise.

use truecut_scenario::effect::{Effect, EffectKind, Target};

use super::slide::{INTERVAL_S, SUBSTEPS, Slide, Truth};
use super::*;

pub fn joint(kind: EffectKind, values: &[f64]) -> Effect {
    super::force::effect(kind, values)
}

fn hidden() -> Vec<Effect> {
    let channel = |kind, name: &str, value| Effect {
        kind,
        target: Target::Channel(name.into()),
        values: vec![value],
    };
    vec![
        joint(EffectKind::JointStiffness, &[0.8]),
        joint(EffectKind::JointDamping, &[2.0]),
        joint(EffectKind::JointViscous, &[60.0]),
        joint(EffectKind::JointCoulomb, &[15.0]),
        joint(EffectKind::JointAsymmetricViscous, &[90.0, 30.0]),
        joint(EffectKind::JointAsymmetricCoulomb, &[25.0, 8.0]),
        joint(EffectKind::JointStribeck, &[20.0, 0.03]),
        joint(EffectKind::JointBacklash, &[3e-4]),
        joint(EffectKind::JointCubicStiffness, &[2e9]),
        joint(EffectKind::JointRipple, &[1e-4, 5e-5, 85.0]),
        joint(EffectKind::JointCounterbalance, &[5.0, 80.0]),
        joint(EffectKind::JointOffset, &[-12.0]),
        channel(EffectKind::SensorGain, "joint1.drive_force", 1.07),
        channel(EffectKind::SensorOffset, "joint1.position", 2e-4),
        channel(EffectKind::SensorDelay, "joint1.drive_force", 0.003),
    ]
}

/// Hidden by a simulation with four times finer steps than the model's, and a mass off by half its
/// uncertainty.
pub fn diagnosed(
    effects: &[Effect],
    extra_n: &dyn Fn(f64, f64, f64) -> f64,
    ratio: f64,
    colour: Colour,
    seed: u64,
) -> Answer {
    let model = Slide::new(2000);
    let fine = Slide::stepped(2000, 4 * SUBSTEPS);
    let truth = |effects, extra_n| Truth {
        mass_kg: 20.2,
        effects,
        extra_n,
    };
    let (nominal, changed) = (
        fine.simulate(&truth(&[], &|_, _, _| 0.0), 1.0),
        fine.simulate(&truth(effects, extra_n), 1.0),
    );
    let levels = levels(&nominal, &changed, ratio);
    let data = observed(&changed, &levels, colour, seed, INTERVAL_S);
    run(&model, &data)
}

fn count_found(ratio: f64, colour: Colour, seed: u64) -> usize {
    let found = |effect: &Effect| {
        let answer = diagnosed(
            std::slice::from_ref(effect),
            &|_, _, _| 0.0,
            ratio,
            colour,
            seed,
        );
        let found = is_found(&answer, std::slice::from_ref(effect));
        println!(
            "{} {} {:?}: {}",
            if found { "ok  " } else { "MISS" },
            effect.kind.name(),
            effect.values,
            describe(&answer)
        );
        usize::from(found)
    };
    hidden().iter().map(found).sum()
}

/// At least 95 of 100, over two realisations of the noise.
fn check(colour: Colour, seeds: [u64; 2]) {
    let found: usize = seeds
        .iter()
        .map(|seed| count_found(2.0, colour, *seed))
        .sum();
    let all = seeds.len() * hidden().len();
    assert!(100 * found >= 95 * all, "{found} of {all}");
}

#[test]
fn single_effects_at_twice_white_noise_are_named() {
    check(WHITE, [711, 712]);
}

#[test]
fn single_effects_at_twice_coloured_noise_are_named() {
    check(COLOURED, [713, 714]);
}
