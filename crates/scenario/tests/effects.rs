//! The `[[effect]]` tables: read, refused, written.

use std::path::Path;

use truecut_recording::Unit;
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Target, TargetKind};

const TEXT: &str = include_str!("chamfer_d.toml");

fn with(entries: &str) -> Result<Scenario, String> {
    let text = format!("{TEXT}\n{entries}");
    Scenario::from_str(Path::new("d.toml"), &text, &[]).map_err(|error| {
        let problems: Vec<String> = error.problems().map(ToString::to_string).collect();
        assert_eq!(problems.len(), 1, "{problems:?}");
        problems.concat()
    })
}

fn refusal(entry: &str) -> String {
    with(&format!("[[effect]]\n{entry}\n")).expect_err(entry)
}

/// Of every kind one effect, no size neutral, with digits that a short text would lose.
fn one_of_each() -> Vec<Effect> {
    let of_kind = |(index, kind): (usize, &EffectKind)| Effect {
        kind: *kind,
        target: match kind.target() {
            TargetKind::Whole => Target::Whole,
            TargetKind::Joint => Target::Joint(index % 6),
            TargetKind::Axis => Target::Axis(index % 3),
            TargetKind::Channel => Target::Channel("tool.displacement_y".into()),
        },
        values: (kind.parameters().iter())
            .map(|info| {
                let wish = info.neutral + (1.0 + index as f64).sqrt() / 3.0 * info.max.min(1.0);
                wish.min(info.max)
            })
            .collect(),
    };
    EffectKind::ALL.iter().enumerate().map(of_kind).collect()
}

#[test]
fn entries_are_read_with_either_kind_of_joint_key() {
    let scenario = with(
        "[[effect]]\nkind = \"joint_coulomb\"\njoint = 2\nfriction_n_m = 20.4\n\
         [[effect]]\nkind = \"joint_stribeck\"\njoint = 1\nexcess_n = 3\n\
         [[effect]]\nkind = \"base_compliance\"\naxis = \"y\"\ncompliance_rad_per_n_m = 1e-7\n\
         [[effect]]\nkind = \"sensor_gain\"\nchannel = \"tool.displacement_x\"\nfactor = 1.1\n",
    )
    .unwrap();
    let [coulomb, stribeck, base, gain] = &scenario.effects[..] else {
        panic!("{:?}", scenario.effects)
    };
    assert_eq!(
        (coulomb.kind, &coulomb.target),
        (EffectKind::JointCoulomb, &Target::Joint(1))
    );
    assert_eq!(coulomb.values, [20.4]);
    assert_eq!(
        stribeck.values,
        [3.0, 0.01],
        "what only shapes takes its neutral value"
    );
    assert_eq!((&base.target, base.values[0]), (&Target::Axis(1), 1e-7));
    assert_eq!(gain.target, Target::Channel("tool.displacement_x".into()));
    let rotary: Vec<_> = (0..4).map(|i| scenario.effect_is_rotary(i)).collect();
    assert_eq!(rotary, [Some(true), Some(false), None, None]);
}

#[test]
fn every_fault_is_one_problem_with_place_value_and_rule() {
    for (entry, wanted) in [
        (
            "kind = \"joint_colomb\"\njoint = 1\nfriction_n = 2",
            "`effect.0.kind` is \"joint_colomb\"",
        ),
        (
            "joint = 1\nfriction_n = 2",
            "missing key `kind` in [effect.0]",
        ),
        (
            "kind = \"joint_coulomb\"\njoint = 1\nfricton_n = 2",
            "did you mean `friction_n`?",
        ),
        (
            "kind = \"joint_coulomb\"\njoint = 1",
            "needs `friction_n` on a prismatic joint or `friction_n_m`",
        ),
        ("kind = \"payload\"", "missing key `mass_kg` in [effect.0]"),
        (
            "kind = \"joint_coulomb\"\naxis = \"x\"\nfriction_n = 2",
            "`axis` does not belong in [effect.0]",
        ),
        (
            "kind = \"joint_coulomb\"\nfriction_n = 2",
            "missing key `joint` in [effect.0]",
        ),
        (
            "kind = \"joint_coulomb\"\njoint = 0\nfriction_n = 2",
            "joints are counted from 1",
        ),
        (
            "kind = \"joint_coulomb\"\njoint = 1\nfriction_n = -2",
            "is -2, but must be at least 0: level of joint_coulomb",
        ),
        (
            "kind = \"joint_stiffness\"\njoint = 1\nfactor = 0.01",
            "must be at least 0.05",
        ),
        (
            "kind = \"joint_asymmetric_coulomb\"\njoint = 1\nfriction_positive_n = 2\nfriction_negative_n_m = 2",
            "mixes keys of rotary and prismatic joints",
        ),
        (
            "kind = \"payload\"\njoint = 1\nmass_kg = 1",
            "unknown key `joint` in [effect.0]",
        ),
        (
            "kind = \"payload\"\nmass_kg = 1\n[[effect]]\nkind = \"payload\"\nmass_kg = 2",
            "[effect.1] is `payload` like [effect.0]",
        ),
    ] {
        let message = refusal(entry);
        assert!(message.contains(wanted), "{entry}: {message}");
    }
}

#[test]
fn overrides_reach_the_keys_of_effects() {
    let text = format!("{TEXT}\n[[effect]]\nkind = \"payload\"\nmass_kg = 1\n");
    let set = |key: &str, value: &str| {
        Scenario::from_str(Path::new("d.toml"), &text, &[(key.into(), value.into())])
    };
    assert_eq!(
        set("effect.0.mass_kg", "2.5").unwrap().effects[0].values[0],
        2.5
    );
    assert_eq!(
        set("effect.0.center_z_m", "0.1").unwrap().effects[0].values[3],
        0.1
    );
    let error = set("effect.0.mass_kg", "2e5").unwrap_err().to_string();
    assert!(error.contains("must be at most 10000"), "{error}");
    assert!(
        set("effect.0.friction_n", "2")
            .unwrap_err()
            .to_string()
            .contains("unknown key")
    );
    assert!(
        set("effect.1.mass_kg", "2")
            .unwrap_err()
            .to_string()
            .contains("no entry 1")
    );
}

#[test]
fn effects_added_in_memory_replace_their_like_and_are_checked() {
    let scenario = with("[[effect]]\nkind = \"payload\"\nmass_kg = 1\n").unwrap();
    let heavy = Effect {
        values: vec![7.0, 0.0, 0.0, 0.1],
        ..Effect::neutral(EffectKind::Payload, Target::Whole)
    };
    let offset = Effect::neutral(EffectKind::JointOffset, Target::Joint(2));
    let extended = scenario
        .with_effects(&[offset.clone(), heavy.clone()])
        .unwrap();
    assert_eq!(extended.effects, [heavy, offset]);
    let longer = extended.with_overrides(&[("run.time_step_ms".into(), "0.1".into())]);
    assert_eq!(
        longer.unwrap().effects,
        extended.effects,
        "overrides keep them"
    );
    for wrong in [
        Effect::neutral(EffectKind::Payload, Target::Joint(0)),
        Effect {
            values: vec![1.0],
            ..Effect::neutral(EffectKind::Payload, Target::Whole)
        },
        Effect {
            values: vec![f64::NAN],
            ..Effect::neutral(EffectKind::SpindleSpeed, Target::Whole)
        },
        Effect {
            values: vec![-1.0],
            ..Effect::neutral(EffectKind::JointCoulomb, Target::Joint(0))
        },
    ] {
        assert!(
            scenario.with_effects(std::slice::from_ref(&wrong)).is_err(),
            "{wrong}"
        );
    }
}

/// What is written reads back as exactly the same effects, whatever the kinds of the joints.
#[test]
fn an_extended_text_reads_back_exactly_and_keeps_the_comments() {
    let commented = format!("# Said by a person.\n{TEXT}# The last word.\n");
    let scenario = Scenario::from_str(Path::new("d.toml"), &commented, &[]).unwrap();
    let effects = one_of_each();
    for rotary in [
        [true; 6],
        [false; 6],
        [true, false, true, false, true, false],
    ] {
        let text = scenario.extended_text(&effects, &rotary);
        assert!(text.starts_with("# Said by a person.\n") && text.contains("# The last word."));
        let again = Scenario::from_str(Path::new("d.toml"), &text, &[]).unwrap();
        assert_eq!(again.effects, effects);
        for (index, effect) in effects.iter().enumerate() {
            if let (Target::Joint(joint), Some(said)) =
                (&effect.target, again.effect_is_rotary(index))
            {
                assert_eq!(said, rotary[*joint], "{effect}");
            }
        }
        assert_eq!(
            again.extended_text(&effects, &rotary),
            text,
            "nothing left to write"
        );
    }
    assert_eq!(scenario.extended_text(&[], &[]), commented);
}

#[test]
fn an_extended_text_changes_known_entries_in_place() {
    let entry = "[[effect]] # found last week\nkind = \"joint_coulomb\"\njoint = 2\nfriction_n_m = 20.4 # guessed\n";
    for entry in [
        entry,
        "[[effect]]\nkind = \"payload\"\nmass_kg = 1 # weighed\n",
    ] {
        let scenario = with(entry).unwrap();
        let mut effect = scenario.effects[0].clone();
        effect.values[0] = 0.1 + 0.2;
        // The entry's own key stays, whatever the joint is said to be.
        let text = scenario.extended_text(&[effect.clone()], &[false, false]);
        let comment = entry
            .lines()
            .last()
            .and_then(|line| line.split_once('#'))
            .unwrap()
            .1;
        assert!(
            text.contains(&format!("0.30000000000000004 #{comment}")),
            "{text}"
        );
        let again = Scenario::from_str(Path::new("d.toml"), &text, &[]).unwrap();
        assert_eq!(again.effects, [effect]);
    }
}

#[test]
fn values_by_name_and_by_position_are_the_same() {
    for mut effect in one_of_each() {
        assert_eq!(effect.typed().unwrap().values(), effect.values, "{effect}");
        effect.values.push(0.0);
        // A curve has as many values as are wanted.
        assert_eq!(
            effect.typed().is_some(),
            effect.curve().is_some(),
            "{effect}"
        );
    }
}

#[test]
fn a_key_has_one_unit_in_all_kinds() {
    let mut units = std::collections::BTreeMap::new();
    for info in EffectKind::ALL.iter().flat_map(|kind| kind.parameters()) {
        for (key, unit) in [(info.key, info.unit), (info.rotary_key, info.rotary_unit)] {
            assert_eq!(*units.entry(key).or_insert(unit), unit, "{key}");
        }
        assert!(
            (info.min..=info.max).contains(&info.neutral),
            "{}",
            info.key
        );
    }
}

/// `"N m/rad^3"` → `"n_m_per_rad3"`, as keys end.
fn ending(unit: Unit) -> String {
    let words = unit.symbol().trim_start_matches('1').replace('/', " per ");
    let letters = words.replace(['^', '(', ')'], "").to_lowercase();
    letters.split_whitespace().collect::<Vec<_>>().join("_")
}

/// What is printed beside a number is what its key says; a key without unit is dimensionless, or of
/// its channel.
#[test]
fn the_unit_of_a_parameter_is_that_of_its_key() {
    const PLAIN: [&str; 7] = [
        "share",
        "factor",
        "drop",
        "cycles",
        "offset",
        "amplitude",
        "damping_ratio",
    ];
    for info in EffectKind::ALL.iter().flat_map(|kind| kind.parameters()) {
        for (key, unit) in [(info.key, info.unit), (info.rotary_key, info.rotary_unit)] {
            if PLAIN.contains(&key) {
                assert_eq!(unit, Unit::One, "{key}");
            } else {
                let ending = ending(unit);
                let known = key == ending || key.ends_with(&format!("_{ending}"));
                assert!(unit != Unit::One && known, "{key}: {unit}");
            }
        }
    }
    assert_eq!(ending(Unit::NewtonMetrePerCubicRadian), "n_m_per_rad3");
    assert_eq!(ending(Unit::RadianPerNewtonMetre), "rad_per_n_m");
    assert_eq!(ending(Unit::PerMetre), "per_m");
}

/// The documentation has a row for every kind and every key.
#[test]
fn the_documented_table_has_every_kind_and_key() {
    let docs = include_str!("../../../docs/effects.md");
    for kind in EffectKind::ALL {
        let row = format!("| `{}` |", kind.name());
        let from = docs.find(&row).unwrap_or_else(|| panic!("{row}"));
        let rows: Vec<&str> = docs[from..].lines().take(kind.parameters().len()).collect();
        for (info, row) in kind.parameters().iter().zip(rows) {
            let keys = if info.key == info.rotary_key {
                format!("`{}`", info.key)
            } else {
                format!("`{}`, `{}`", info.key, info.rotary_key)
            };
            assert!(row.contains(&keys), "{keys}: {row}");
            assert_eq!(row.contains('∘'), !info.is_size, "{row}");
            let cells: Vec<&str> = row.split(" | ").collect();
            let bounds: Vec<f64> = cells[5].split(", ").map(|x| x.parse().unwrap()).collect();
            assert_eq!(bounds, [info.min, info.max], "{row}");
            assert_eq!(cells[4].parse::<f64>().unwrap(), info.neutral, "{row}");
            let units = match (info.unit, info.rotary_unit) {
                (prismatic, rotary) if prismatic != rotary => format!("{prismatic}, {rotary}"),
                // Said in words: the unit of the channel, cycles per turn.
                (Unit::One, _) if cells[3] != "1" => cells[3].to_owned(),
                (unit, _) => unit.to_string(),
            };
            assert_eq!(
                cells[3].replace('³', "^3").replace('²', "^2"),
                units,
                "{row}"
            );
        }
    }
}
