//! What is written into a scenario is read back as it was: random effects, random overrides.

use std::path::{Path, PathBuf};

use proptest::collection::vec;
use proptest::prelude::*;
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, ParameterInfo, Target, TargetKind};

const TEXT: &str = include_str!("chamfer_d.toml");

/// A value within its bounds: anywhere, close to one of them, or with all its digits near zero.
fn value(info: &ParameterInfo, (choice, share, tiny): (u8, f64, f64)) -> f64 {
    let (low, high) = (info.min.max(-1e30), info.max.min(1e30));
    let wish = match choice {
        0 => low,
        1 => high,
        2 => info.neutral + tiny,
        3 => (low + (high - low) * share).round(),
        _ => low + (high - low) * share,
    };
    wish.clamp(info.min, info.max)
}

/// Names of channels are any text without control characters.
fn effect() -> impl Strategy<Value = Effect> {
    let kinds = prop::sample::select(EffectKind::ALL.to_vec());
    let shares = vec((0..6_u8, 0.0..1.0_f64, prop::num::f64::NORMAL), 12);
    (kinds, 0..40_usize, "[^\\p{C}]{1,20}", shares).prop_map(|(kind, at, channel, shares)| Effect {
        kind,
        target: match kind.target() {
            TargetKind::Whole => Target::Whole,
            TargetKind::Joint => Target::Joint(at),
            TargetKind::Axis => Target::Axis(at % 3),
            TargetKind::Channel => Target::Channel(channel),
        },
        values: kind
            .parameters()
            .iter()
            .zip(shares)
            .map(|(info, share)| value(info, share))
            .collect(),
    })
}

/// Of the same kind and target the last counts, at the place of the first.
fn merged(effects: &[Effect]) -> Vec<Effect> {
    let mut all: Vec<Effect> = Vec::new();
    for effect in effects {
        match all
            .iter_mut()
            .find(|it| it.kind == effect.kind && it.target == effect.target)
        {
            Some(known) => *known = effect.clone(),
            None => all.push(effect.clone()),
        }
    }
    all
}

fn bits(effects: &[Effect]) -> Vec<(String, Vec<u64>)> {
    // Zero has two signs and is one value.
    let one = |effect: &Effect| {
        let values = effect.values.iter().map(|value| (value + 0.0).to_bits());
        (
            format!("{:?} {:?}", effect.kind, effect.target),
            values.collect(),
        )
    };
    effects.iter().map(one).collect()
}

/// All scenarios that are shipped.
fn shipped() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut folders = vec![root];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|it| it == "toml")
                && Scenario::load(&path, &[]).is_ok()
            {
                files.push(path);
            }
        }
    }
    files.sort();
    assert!(files.len() > 20, "{files:?}");
    files
}

/// Dotted keys of numbers, with their values.
fn numbers(table: &toml::Value, before: &str, found: &mut Vec<(String, f64)>) {
    let key = |name: &str| {
        if before.is_empty() {
            name.to_owned()
        } else {
            format!("{before}.{name}")
        }
    };
    match table {
        toml::Value::Table(table) => {
            // Quoted keys are not dotted ones.
            for (name, inner) in table.iter().filter(|it| !it.0.contains('.')) {
                numbers(inner, &key(name), found);
            }
        }
        toml::Value::Array(list) => {
            for (index, inner) in list.iter().enumerate() {
                numbers(inner, &key(&index.to_string()), found);
            }
        }
        toml::Value::Float(value) => found.push((before.to_owned(), *value)),
        _ => {}
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn effects_come_back_to_the_bit(
        known in vec(effect(), 0..4),
        added in vec(effect(), 1..6),
        rotary in vec(any::<bool>(), 40),
        other in vec(any::<bool>(), 40),
    ) {
        let read = |text: &str| Scenario::from_str(Path::new("d.toml"), text, &[]);
        let base = read(TEXT).unwrap();
        let first = base.extended_text(&known, &rotary);
        let first = read(&first).map_err(|error| TestCaseError::fail(format!("{error}\n{first}")))?;
        prop_assert_eq!(bits(&first.effects), bits(&merged(&known)));
        // Entries that are there keep the keys with which they were written.
        let text = first.extended_text(&added, &other);
        let second = read(&text).map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
        let all: Vec<Effect> = known.iter().chain(&added).cloned().collect();
        prop_assert_eq!(bits(&second.effects), bits(&merged(&all)));
        prop_assert_eq!(second.extended_text(&added, &other), text);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// A scenario with overrides, written as a text and read, is the same scenario; so it is from
    /// another folder.
    #[test]
    fn overrides_come_back_in_the_text(
        at in any::<prop::sample::Index>(),
        drawn in vec((any::<prop::sample::Index>(), 0.9..1.1_f64), 0..4),
        elsewhere in "[a-z]{1,5}(/[a-z ]{1,5}){0,3}",
    ) {
        let files = shipped();
        let file = at.get(&files);
        let text = std::fs::read_to_string(file).unwrap();
        let mut known = Vec::new();
        numbers(&toml::from_str::<toml::Value>(&text).unwrap(), "", &mut known);
        let overrides: Vec<(String, String)> = drawn.iter().filter(|_| !known.is_empty()).map(|(which, factor)| {
            let (key, value) = which.get(&known);
            (key.clone(), format!("{:?}", value * factor))
        }).collect();
        // Rules between keys may refuse some.
        if let Ok(changed) = Scenario::load(file, &overrides) {
            let again = Scenario::from_str(file, &changed.effective_text(), &[]);
            let again = again.map_err(|error| TestCaseError::fail(format!("{}: {error}", file.display())))?;
            prop_assert_eq!(again.effective_text(), changed.effective_text());
            let told = |it: &Scenario| {
                format!("{:?} {:?} {:?} {:?} {:?}", it.process, it.robot, it.run, it.claims, it.effects)
            };
            prop_assert_eq!(told(&again), told(&changed));
            // A folder that is there: on the way up from one that is not, nothing is found.
            let root = tempfile::tempdir().unwrap();
            let folder = root.path().canonicalize().unwrap().join(&elsewhere);
            std::fs::create_dir_all(&folder).unwrap();
            let moved = changed.text_for_folder(&folder, &[], &[]);
            let moved = Scenario::from_str(&folder.join("moved.toml"), &moved, &[]);
            let moved = moved.map_err(|error| TestCaseError::fail(format!("{}: {error}", file.display())))?;
            // A process without an arm names none.
            let files = |it: &Scenario| -> Vec<Option<PathBuf>> {
                let robot = [Some(it.robot.urdf.clone()), it.robot.config.clone()];
                let named = |path: Option<PathBuf>| path.filter(|it| !it.as_os_str().is_empty());
                robot.map(|path| Some(named(path)?.canonicalize().unwrap())).into()
            };
            prop_assert_eq!(files(&moved), files(&changed));
            // And back from there.
            let back = moved.text_for_folder(&file.parent().unwrap().canonicalize().unwrap(), &[], &[]);
            let back = Scenario::from_str(file, &back, &[]);
            let back = back.map_err(|error| TestCaseError::fail(format!("{}: {error}", file.display())))?;
            prop_assert_eq!(files(&back), files(&changed));
            let plain = |it: &Scenario| format!("{:?} {:?}", it.run, it.effects);
            prop_assert_eq!(plain(&back), plain(&changed));
        }
    }
}
