//! The `[[effect]]` tables of a scenario file.
//!
//! Each kind has keys of its own, so the schema of an entry is a choice among one schema per kind;
//! the catalogue is where keys and bounds come from.

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Map, Value as Json, json};

use super::{Effect, EffectKind, MOST_PLACES, ParameterInfo, Target, TargetKind};
use crate::check::Check;
use crate::fault::Fault;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Keys that say what an effect acts on.
const TARGET_KEYS: [&str; 3] = ["joint", "axis", "channel"];

/// One physical thing that the nominal model leaves out.
#[derive(Debug, Deserialize)]
#[serde(transparent)]
pub(crate) struct EffectTable(Map<String, Json>);

/// The effects of a file.
#[derive(Debug, Clone, Default)]
pub(crate) struct ReadEffects {
    pub effects: Vec<Effect>,
    /// Whether each was given with the keys of a rotary joint; `None` where both kinds of joint
    /// share them.
    pub rotary: Vec<Option<bool>>,
}

impl TargetKind {
    /// The key that names the target.
    pub(crate) fn key(self) -> Option<&'static str> {
        match self {
            TargetKind::Whole => None,
            TargetKind::Joint => Some("joint"),
            TargetKind::Axis => Some("axis"),
            TargetKind::Channel => Some("channel"),
        }
    }
}

impl ParameterInfo {
    /// Whether rotary and prismatic joints have different keys.
    pub(crate) fn depends_on_joint(&self) -> bool {
        self.key != self.rotary_key
    }
}

impl JsonSchema for EffectTable {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "EffectTable".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let names: Vec<&str> = EffectKind::ALL.iter().map(|kind| kind.name()).collect();
        let mut properties = Map::new();
        properties.insert(
            "kind".into(),
            json!({ "type": "string", "enum": names, "description": "What it is." }),
        );
        for key in TARGET_KEYS {
            properties.insert(key.into(), target_schema(key));
        }
        for info in EffectKind::ALL.iter().flat_map(|kind| kind.parameters()) {
            for key in [info.key, info.rotary_key] {
                properties.insert(key.into(), number_schema(key));
            }
        }
        for info in EffectKind::ALL.iter().filter_map(|kind| listed(*kind)) {
            for key in [info.key, info.rotary_key] {
                properties.insert(key.into(), list_schema(key));
            }
        }
        let variants: Vec<Json> = EffectKind::ALL.iter().map(|kind| variant(*kind)).collect();
        schemars::json_schema!({
            "type": "object",
            "description": "One physical thing that the nominal model leaves out.",
            "properties": properties,
            "required": ["kind"],
            "x-tag": "kind",
            "oneOf": variants
        })
    }
}

fn target_schema(key: &str) -> Json {
    match key {
        "joint" => json!({
            "type": "integer",
            "minimum": 1,
            "x-rule": "joints are counted from 1",
            "description": "Joint of the chain, counted from 1.",
        }),
        "axis" => json!({
            "type": "string",
            "enum": AXES,
            "description": "Axis of the world.",
        }),
        _ => json!({
            "type": "string",
            "description": "Name of a channel of the recording.",
        }),
    }
}

/// Schema of a number wherever it stands; its bounds depend on the kind.
fn number_schema(key: &str) -> Json {
    json!({ "type": "number", "description": kinds_with(key) })
}

/// A sentence on the kinds that have a key.
fn kinds_with(key: &str) -> String {
    let has = |kind: &&EffectKind| {
        let mut known = kind.parameters().iter();
        known.any(|info| key == info.key || key == info.rotary_key)
    };
    let kinds: Vec<&str> = (EffectKind::ALL.iter().filter(has))
        .map(|kind| kind.name())
        .collect();
    format!("Of {}.", kinds.join(", "))
}

/// The parameter that is given as a list, if the kind has one.
fn listed(kind: EffectKind) -> Option<&'static ParameterInfo> {
    let last = kind.parameters().last();
    last.filter(|_| kind.is_curve())
}

fn list_schema(key: &str) -> Json {
    json!({ "type": "array", "items": { "type": "number" }, "description": kinds_with(key) })
}

/// Schema of the entries of one kind.
fn variant(kind: EffectKind) -> Json {
    let mut properties = Map::new();
    let mut required = vec!["kind"];
    properties.insert(
        "kind".into(),
        json!({ "type": "string", "const": kind.name() }),
    );
    let target = kind.target().key();
    if let Some(key) = target {
        properties.insert(key.into(), target_schema(key));
        required.push(key);
    }
    for info in kind.parameters() {
        for key in [info.key, info.rotary_key] {
            let rule = format!("{} of {}", uncapitalised(info.description), kind.name());
            let mut schema = json!({
                "type": "number",
                "minimum": info.min,
                "maximum": info.max,
                "x-rule": rule,
                "description": info.description,
            });
            if listed(kind).is_some_and(|listed| listed.key == info.key) {
                schema = json!({
                    "type": "array",
                    "items": schema,
                    "minItems": 1,
                    "maxItems": MOST_PLACES,
                    "x-rule": rule,
                    "description": info.description,
                });
            }
            properties.insert(key.into(), schema);
        }
        if info.is_size && !info.depends_on_joint() {
            required.push(info.key);
        }
    }
    let instead: Map<String, Json> = TARGET_KEYS
        .iter()
        .filter(|key| !properties.contains_key(**key))
        .filter_map(|key| Some(((*key).to_owned(), Json::from(target?))))
        .collect();
    json!({
        "type": "object",
        "description": kind.description(),
        "properties": properties,
        "required": required,
        "x-instead": instead,
        "additionalProperties": false,
    })
}

fn uncapitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map(|first| first.to_lowercase().chain(letters).collect())
        .unwrap_or_default()
}

/// Reads all entries; faults go to `check`.
pub(crate) fn resolve(tables: Vec<EffectTable>, check: &mut Check) -> ReadEffects {
    let mut read = ReadEffects::default();
    for (index, table) in tables.into_iter().enumerate() {
        let path = format!("effect.{index}");
        let Some((effect, rotary)) = table.resolve(&path, check) else {
            continue;
        };
        let twin = |other: &Effect| other.kind == effect.kind && other.target == effect.target;
        if let Some(first) = read.effects.iter().position(twin) {
            let message = format!(
                "[{path}] is `{effect}` like [effect.{first}]: an effect is given once for what it acts on"
            );
            check.refuse(Fault::value(
                &format!("{path}.kind"),
                message,
                "a second time",
            ));
            continue;
        }
        read.effects.push(effect);
        read.rotary.push(rotary);
    }
    read
}

impl EffectTable {
    /// The effect, and whether its keys were those of a rotary joint. `None` after recording a
    /// fault.
    fn resolve(&self, path: &str, check: &mut Check) -> Option<(Effect, Option<bool>)> {
        let kind = EffectKind::from_name(self.0.get("kind")?.as_str()?)?;
        let target = self.target(kind)?;
        let given = |key: &str| match self.0.get(key)? {
            Json::Array(list) => list.iter().map(Json::as_f64).collect(),
            one => Some(vec![one.as_f64()?]),
        };
        let mut rotary = None;
        let mut values = Vec::with_capacity(kind.parameters().len());
        for info in kind.parameters() {
            let mut pick = (given(info.key), false);
            if info.depends_on_joint() {
                let of_rotary = given(info.rotary_key);
                let both = of_rotary.is_some() && pick.0.is_some();
                if of_rotary.is_some() {
                    pick = (of_rotary, true);
                }
                let mixed = pick.0.is_some() && rotary.is_some_and(|other| other != pick.1);
                if both || mixed {
                    check.refuse(mixed_keys(path, info, kind));
                    return None;
                }
                if pick.0.is_some() {
                    rotary = Some(pick.1);
                }
            }
            if pick.0.is_none() && info.is_size {
                check.refuse(missing_size(path, info, kind));
                return None;
            }
            values.extend(pick.0.unwrap_or_else(|| vec![info.neutral]));
        }
        let effect = Effect {
            kind,
            target,
            values,
        };
        Some((effect, rotary))
    }

    fn target(&self, kind: EffectKind) -> Option<Target> {
        let text = |key: &str| self.0.get(key).and_then(Json::as_str);
        Some(match kind.target() {
            TargetKind::Whole => Target::Whole,
            TargetKind::Joint => {
                let number = self.0.get("joint").and_then(Json::as_u64)?;
                Target::Joint(usize::try_from(number).ok()?.checked_sub(1)?)
            }
            TargetKind::Axis => {
                Target::Axis(AXES.iter().position(|axis| text("axis") == Some(axis))?)
            }
            TargetKind::Channel => Target::Channel(text("channel")?.to_owned()),
        })
    }
}

fn mixed_keys(path: &str, info: &ParameterInfo, kind: EffectKind) -> Fault {
    let message = format!(
        "[{path}] mixes keys of rotary and prismatic joints: {} takes `{}` on a prismatic joint or `{}` on a \
         rotary one",
        kind.name(),
        info.key,
        info.rotary_key
    );
    Fault::key(
        &format!("{path}.{}", info.rotary_key),
        message,
        "of the other kind of joint",
    )
}

fn missing_size(path: &str, info: &ParameterInfo, kind: EffectKind) -> Fault {
    let message = format!(
        "missing key in [{path}]: {} needs `{}` on a prismatic joint or `{}` on a rotary one",
        kind.name(),
        info.key,
        info.rotary_key
    );
    Fault::key(
        &format!("{path}.{}", info.key),
        message,
        "its size is missing here",
    )
}
