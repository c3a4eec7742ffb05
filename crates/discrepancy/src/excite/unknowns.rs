//! What a motion is asked to show, by name, and what is unknown beside it.

use truecut_recording::nearest;
use truecut_scenario::effect::{Effect, EffectKind, Target, TargetKind};
use truecut_scenario::{FitSpec, Scenario, Unknown};
use truecut_sim::SimError;
use truecut_sim::facts::robot_facts;

use crate::diagnose::{Cause, Diagnosis};

/// A parameter beside those of `[fit]`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Extra {
    pub name: String,
    pub unit: String,
    /// The value about which it is looked at, SI.
    pub value: f64,
    /// What is known of it beforehand: deviation, SI.
    pub sigma: Option<f64>,
    pub is_asked: bool,
    pub what: What,
}

/// Where the value of a parameter stands.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum What {
    /// A parameter of one of the effects.
    Effect { effect: usize, parameter: usize },
    /// The key of an `[[uncertain]]`.
    Key(String),
}

/// All parameters that are unknown.
#[derive(Debug, Clone)]
pub(super) struct Unknowns {
    pub fit: Option<FitSpec>,
    /// Names of parameters of `[fit]` that are asked for, or of whole kinds; all if none is named.
    pub asked_of_fit: Option<Vec<String>>,
    /// Effects that the parameters are of, at the sizes they are looked at.
    pub effects: Vec<Effect>,
    pub extra: Vec<Extra>,
}

/// Unknowns of `[fit]` by name, with how the names of their parameters begin.
const KINDS: [(Unknown, &str, &str); 6] = [
    (Unknown::Links, "links", "link "),
    (Unknown::Payload, "payload", "payload "),
    (Unknown::Rotors, "rotors", "rotor "),
    (Unknown::Viscous, "viscous", "viscous "),
    (Unknown::Coulomb, "coulomb", "coulomb "),
    (Unknown::Offset, "offset", "offset "),
];

impl Unknowns {
    /// Those of the scenario: of `[fit]`, else its effects and uncertain values; and what is named
    /// beside them.
    ///
    /// # Errors
    /// A name that means nothing; nothing unknown at all.
    pub fn of(scenario: &Scenario, asked: Option<&[String]>) -> Result<Unknowns, SimError> {
        let mut unknowns = Unknowns {
            fit: scenario.fit.clone(),
            asked_of_fit: None,
            effects: Vec::new(),
            extra: Vec::new(),
        };
        if unknowns.fit.is_none() {
            for effect in &scenario.effects {
                unknowns.add_effect(scenario, effect.clone(), asked.is_none())?;
            }
            for one in &scenario.uncertain {
                unknowns.add_key(scenario, &one.key, asked.is_none());
            }
        }
        for name in asked.unwrap_or_default() {
            unknowns.ask(scenario, name)?;
        }
        if asked.is_some() && unknowns.asked_of_fit.is_none() {
            unknowns.asked_of_fit = Some(Vec::new());
        }
        if unknowns.fit.is_none() && unknowns.extra.is_empty() {
            let message = "nothing is unknown: name a parameter with --for, or give [fit], [[effect]] or [[uncertain]]";
            return Err(SimError::scenario(ASKED, message));
        }
        Ok(unknowns)
    }

    /// The causes and the alternatives of a diagnosis, at the sizes found.
    ///
    /// # Errors
    /// A cause that this program does not know; less than two explanations.
    pub fn of_diagnosis(scenario: &Scenario, diagnosis: &Diagnosis) -> Result<Unknowns, SimError> {
        let mut unknowns = Unknowns {
            fit: None,
            asked_of_fit: None,
            effects: Vec::new(),
            extra: Vec::new(),
        };
        for one in &scenario.uncertain {
            unknowns.add_key(scenario, &one.key, false);
        }
        let others = diagnosis.alternatives.iter().flat_map(|one| &one.causes);
        for cause in diagnosis.causes.iter().chain(others) {
            let effect = effect_of(cause)
                .ok_or_else(|| refused(format!("names {}, which is no effect", cause.kind)))?;
            unknowns.add_effect(scenario, effect, true)?;
        }
        Ok(unknowns)
    }

    fn ask(&mut self, scenario: &Scenario, name: &str) -> Result<(), SimError> {
        if let Some(fit) = &self.fit {
            let kind = KINDS.iter().find(|(kind, word, start)| {
                fit.unknowns.contains(kind) && (name == *word || name.starts_with(start))
            });
            // An effect of a joint that is an unknown of the fit, too.
            let of_effect = joint_effect(name).and_then(|(word, joint)| {
                let same = |(kind, own, _): &&(Unknown, &str, &str)| {
                    *own == word && fit.unknowns.contains(kind)
                };
                let found = KINDS.iter().find(same)?;
                Some(format!("{}{joint}", found.2))
            });
            if let Some(own) = of_effect.or_else(|| kind.map(|_| name.to_owned())) {
                self.asked_of_fit.get_or_insert_default().push(own);
                return Ok(());
            }
        }
        if scenario.uncertain.iter().any(|one| one.key == name) {
            self.add_key(scenario, name, true);
            return Ok(());
        }
        for effect in named_effects(scenario, name)? {
            self.add_effect(scenario, effect, true)?;
        }
        Ok(())
    }

    fn add_key(&mut self, scenario: &Scenario, key: &str, is_asked: bool) {
        if let Some(known) = self.extra.iter_mut().find(|one| one.name == key) {
            known.is_asked |= is_asked;
            return;
        }
        let own = scenario.uncertain.iter().find(|one| one.key == key);
        self.extra.extend(own.map(|one| Extra {
            name: key.to_owned(),
            unit: truecut_scenario::si_symbol(key),
            value: one.value,
            sigma: Some(one.sigma),
            is_asked,
            what: What::Key(key.to_owned()),
        }));
    }

    fn add_effect(
        &mut self,
        scenario: &Scenario,
        effect: Effect,
        is_asked: bool,
    ) -> Result<(), SimError> {
        let same = |own: &Effect| own.kind == effect.kind && own.target == effect.target;
        if let Some(known) = self.effects.iter().position(same) {
            for extra in &mut self.extra {
                let of = matches!(extra.what, What::Effect { effect, .. } if effect == known);
                extra.is_asked |= of && is_asked;
            }
            return Ok(());
        }
        let rotary = match effect.target {
            Target::Joint(joint) => {
                let facts = robot_facts(scenario)?;
                let Some(fact) = facts.joints.get(joint) else {
                    let count = facts.joints.len();
                    return Err(refused(format!(
                        "names {effect}, but the chain has {count} joints"
                    )));
                };
                fact.rotary
            }
            _ => false,
        };
        if let Some(why) = truecut_sim::misfit(scenario, &effect) {
            return Err(refused(format!("names what plays no part: {why}")));
        }
        let is_neutral = effect.is_neutral();
        let index = self.effects.len();
        let infos = effect.kind.parameters().iter();
        for (parameter, (info, value)) in infos.zip(&effect.values).enumerate() {
            // A shape means nothing at size zero.
            if is_neutral && !info.is_size {
                continue;
            }
            let (key, unit) = match rotary {
                true => (info.rotary_key, info.rotary_unit),
                false => (info.key, info.unit),
            };
            self.extra.push(Extra {
                name: format!("{} {key}", name_of(&effect)),
                unit: unit.to_string(),
                value: *value,
                sigma: None,
                is_asked,
                what: What::Effect {
                    effect: index,
                    parameter,
                },
            });
        }
        self.effects.push(effect);
        Ok(())
    }
}

/// Kind and target as they are named on the command line: `joint_coulomb.2`.
pub(super) fn name_of(effect: &Effect) -> String {
    let kind = effect.kind.name();
    match &effect.target {
        Target::Whole => kind.to_owned(),
        Target::Joint(joint) => format!("{kind}.{}", joint + 1),
        Target::Axis(axis) => format!("{kind}.{}", ["x", "y", "z"][*axis]),
        Target::Channel(channel) => format!("{kind}.{channel}"),
    }
}

/// `joint_coulomb.2` as a word of `[fit]` and a number.
fn joint_effect(name: &str) -> Option<(&str, &str)> {
    name.strip_prefix("joint_")?.split_once('.')
}

/// The effects that a name means: of the scenario, or none yet; without a target on every joint.
fn named_effects(scenario: &Scenario, name: &str) -> Result<Vec<Effect>, SimError> {
    let (kind_name, target) = match name.split_once('.') {
        Some((kind, target)) => (kind, Some(target)),
        None => (name, None),
    };
    let Some(kind) = EffectKind::from_name(kind_name) else {
        return Err(refused(unknown(scenario, name)));
    };
    let targets = match (kind.target(), target) {
        (TargetKind::Whole, None) => vec![Target::Whole],
        (TargetKind::Joint, None) => {
            let joints = robot_facts(scenario)?.joints.len();
            (0..joints).map(Target::Joint).collect()
        }
        (TargetKind::Axis, None) => (0..3).map(Target::Axis).collect(),
        (TargetKind::Joint, Some(number)) => {
            let number: Option<usize> = number.parse().ok().filter(|number| *number > 0);
            number.map(|n| Target::Joint(n - 1)).into_iter().collect()
        }
        (TargetKind::Axis, Some(axis)) => {
            let axis = ["x", "y", "z"].iter().position(|known| *known == axis);
            axis.map(Target::Axis).into_iter().collect()
        }
        (TargetKind::Channel, Some(channel)) => vec![Target::Channel(channel.to_owned())],
        (TargetKind::Whole, Some(_)) | (TargetKind::Channel, None) => Vec::new(),
    };
    if targets.is_empty() {
        let acts_on = match kind.target() {
            TargetKind::Whole => "nothing: there is only one",
            TargetKind::Joint => "a joint, counted from 1",
            TargetKind::Axis => "x, y or z",
            TargetKind::Channel => "a channel",
        };
        return Err(refused(format!(
            "is \"{name}\", but what stands behind the point of {kind_name} must be {acts_on}"
        )));
    }
    Ok((targets.into_iter())
        .map(|target| {
            let own = |one: &&Effect| one.kind == kind && one.target == target;
            let own = scenario.effects.iter().find(own).cloned();
            own.unwrap_or_else(|| Effect::neutral(kind, target.clone()))
        })
        .collect())
}

fn unknown(scenario: &Scenario, name: &str) -> String {
    let own = scenario.uncertain.iter().map(|one| one.key.as_str());
    let fit = scenario.fit.iter().flat_map(|fit| {
        let known = move |one: &&(Unknown, &str, &str)| fit.unknowns.contains(&one.0);
        KINDS.iter().filter(known).map(|one| one.1)
    });
    let kinds = EffectKind::ALL.iter().map(|kind| kind.name());
    let meant = nearest(name, own.chain(fit).chain(kinds));
    let meant = meant.map_or_else(String::new, |near| format!("; did you mean \"{near}\"?"));
    format!(
        "is \"{name}\", which is no unknown of [fit], no kind of effect with its joint (joint_coulomb.2), and no key of an \
         [[uncertain]]{meant}"
    )
}

/// Refuses what is asked for; the message goes on behind its key.
pub(super) fn refused(is: String) -> SimError {
    SimError::scenario(ASKED, format!("`{ASKED}` {is}"))
}

/// The key that says what is asked for.
pub const ASKED: &str = "excite.for";

/// The effect that a diagnosis names, at its size.
pub(super) fn effect_of(cause: &Cause) -> Option<Effect> {
    let kind = EffectKind::from_name(&cause.kind)?;
    let target = match (kind.target(), cause.target.as_deref()) {
        (TargetKind::Whole, _) => Target::Whole,
        (TargetKind::Joint, Some(name)) => {
            let number: usize = name.strip_prefix("joint")?.parse().ok()?;
            Target::Joint(number.checked_sub(1)?)
        }
        (TargetKind::Axis, Some(axis)) => {
            Target::Axis(["x", "y", "z"].iter().position(|known| *known == axis)?)
        }
        (TargetKind::Channel, Some(channel)) => Target::Channel(channel.to_owned()),
        _ => return None,
    };
    let value = |key: &str| cause.parameters.get(key).map(|found| found.value);
    let values = kind.parameters().iter();
    let values = values.map(|info| value(info.key).or_else(|| value(info.rotary_key)));
    Some(Effect {
        kind,
        target,
        values: values.collect::<Option<_>>()?,
    })
}
