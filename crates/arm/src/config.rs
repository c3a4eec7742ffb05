//! `robot.toml`: what a URDF cannot say. Transmissions with the source of every value, and the
//! tool and foot frames.
//!
//! ```toml
//! name = "Planar rig"                      # optional, default the URDF's name
//!
//! [frames.tool]                            # relative to the flange (the URDF tip link)
//! xyz_m = [0.0, 0.0, 0.30]
//! rpy_deg = [0.0, 0.0, 0.0]                # fixed axes x, y, z, as in URDF
//! [frames.foot]                            # optional, default the tool frame
//! xyz_m = [0.0, 0.0, 0.30]
//!
//! [[joint]]
//! name = "joint_1"                         # of the URDF; joints left out keep the URDF's values
//! stiffness_nm_per_rad = 2.117e6           # a prismatic joint has stiffness_n_per_m,
//! linear_to_rad = 0.01                     # optional wind-up at which the spring's line ends,
//!                                          #   linear_to_m
//! damping_nm_s_per_rad = 2011.15           #   damping_n_s_per_m,
//! dry_friction_nm = 0.0                    #   dry_friction_n
//! rotor_inertia_kg_m2 = 0.0                #   and rotor_mass_kg; all on the gear's joint side
//! pulses_per_deg = 1345.0                  # optional, pulses_per_mm: encoder counts of a
//!                                          #   controller that writes them
//! [joint.servo]                            # optional
//! position_gain_per_s = 20.0
//! velocity_gain_nm_s_per_rad = 1.0e4       #   velocity_gain_n_s_per_m
//! torque_limit_nm = 1.0e4                  #   force_limit_n
//! velocity_feed_forward = 1.0              # optional share of the command's velocity, default 1
//! [joint.source]                           # one for each value above
//! stiffness = "data sheet of the reducer"
//! linear_to = "data sheet of the reducer"
//! damping = "estimated: 2 % at the first mode"
//! dry_friction = "estimated: neglected"
//! rotor_inertia = "estimated"
//! servo = "estimated"
//! pulses = "parameter file of the controller"
//!
//! [[link]]                                 # optional: in place of the URDF's values
//! name = "link_1"                          # of the URDF
//! mass_kg = 62.0
//! center_m = [0.1, 0.0, 0.2]               # in the link frame
//! inertia_kg_m2 = [1.2, 1.4, 0.9, 0.0, 0.1, 0.0] # about the centre: xx, yy, zz, xy, xz, yz
//! source = "CAD"
//! [masses]
//! total_kg = 425.0                         # optional: what all links must sum to
//! ```

use std::path::Path;

use nalgebra::Isometry3;

use crate::error::{ArmError, ArmErrorKind, several};
use crate::model::{Chain, JointKind, ToolLoad, Transmission};

mod frames;
mod links;
mod raw;
mod structure;

use raw::{Number, RawConfig, RawFrame, RawJoint, RawServo};

/// What a `robot.toml` says beside the transmissions, which it writes into the chain.
#[derive(Debug)]
pub(crate) struct Config {
    pub(crate) name: Option<String>,
    pub(crate) flange_from_tool: Isometry3<f64>,
    pub(crate) flange_from_foot: Isometry3<f64>,
    pub(crate) tool_load: Option<ToolLoad>,
    /// What speaks against its frames.
    pub(crate) doubts: Vec<String>,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            name: None,
            flange_from_tool: Isometry3::identity(),
            flange_from_foot: Isometry3::identity(),
            tool_load: None,
            doubts: Vec::new(),
        }
    }
}

/// A `robot.toml` that has been read, before it is known which links and joints there are.
pub(crate) struct ConfigFile<'a> {
    raw: RawConfig,
    text: &'a str,
    pub(crate) path: &'a Path,
}

impl<'a> ConfigFile<'a> {
    /// Reads `text` as the `robot.toml` at `path`.
    ///
    /// # Errors
    /// Every key, type and length that is wrong.
    pub(crate) fn parse(text: &'a str, path: &'a Path) -> Result<Self, ArmError> {
        let reader = ConfigReader::new(text, path);
        if let Some(at) = truecut_files::too_deep(text) {
            let most = truecut_files::MOST_NESTED;
            let rule = format!("arrays and inline tables nest more than {most} deep");
            return Err(reader.error(at, ArmErrorKind::Toml(rule)));
        }
        let broken = structure::check(text).into_iter();
        let broken = broken.map(|b| reader.error(b.at, ArmErrorKind::Toml(b.message)));
        if let Some(error) = several(broken.collect()) {
            return Err(error);
        }
        let raw = toml::from_str(text).map_err(|error: toml::de::Error| {
            let line = error.span().map(|span| reader.line(span.start));
            let message = error
                .message()
                .replace('\n', "; ")
                .replace("f64", "a number");
            ArmError::in_file(path, line, ArmErrorKind::Toml(message))
        })?;
        Ok(Self { raw, text, path })
    }

    fn reader(&self) -> ConfigReader<'a> {
        ConfigReader::new(self.text, self.path)
    }

    /// Enters the transmissions into `chain`; adds what is wrong to `faults`.
    pub(crate) fn apply(&self, chain: &mut Chain, faults: &mut Vec<ArmError>) -> Config {
        let reader = self.reader();
        let mut seen: Vec<(&str, usize)> = Vec::new();
        for joint in &self.raw.joint {
            let name = joint.name.get_ref().as_str();
            let line = reader.line(joint.name.span().start);
            let first = seen.iter().find(|(n, _)| *n == name);
            if let Some(kind) = refused(name, first.map(|(_, line)| *line), chain) {
                faults.push(ArmError::in_file(self.path, Some(line), kind));
                continue;
            }
            seen.push((name, line));
            let target = chain.joints.iter_mut().find(|j| j.name == name);
            if let Some(target) = target {
                reader.joint(joint, target.kind, &mut target.transmission, faults);
            }
        }
        let tool = reader.frame("tool", self.raw.frames.tool.as_ref(), faults);
        let foot = reader.frame("foot", self.raw.frames.foot.as_ref(), faults);
        let flange_from_tool = tool.unwrap_or_else(Isometry3::identity);
        Config {
            name: self.raw.name.clone(),
            flange_from_tool,
            flange_from_foot: foot.unwrap_or(flange_from_tool),
            tool_load: self.tool_load(faults),
            doubts: self.frame_doubts(),
        }
    }
}

/// Why there may be no entry for a joint; `first_line` is that of another entry for it.
fn refused(name: &str, first_line: Option<usize>, chain: &Chain) -> Option<ArmErrorKind> {
    let joint = name.to_owned();
    if let Some(first_line) = first_line {
        return Some(ArmErrorKind::DuplicateName {
            element: "joint",
            name: joint,
            first_line,
        });
    }
    if let Some(own) = chain.followers.iter().find(|own| own.name == name) {
        return Some(ArmErrorKind::Follows {
            joint,
            leader: chain.joints[own.follows].name.clone(),
            multiplier: own.multiplier,
            purpose: "it has no transmission of its own",
        });
    }
    let is_known = chain.joints.iter().any(|own| own.name == name);
    (!is_known).then(|| unknown_joint(name, chain))
}

/// JSON Schema of the file, for editors.
#[must_use]
pub fn json_schema() -> schemars::Schema {
    schemars::schema_for!(RawConfig)
}

fn unknown_joint(name: &str, chain: &Chain) -> ArmErrorKind {
    let known: Vec<_> = chain.joints.iter().map(|j| j.name.as_str()).collect();
    ArmErrorKind::UnknownJoint {
        joint: name.to_owned(),
        tip: chain.tip.clone(),
        known: known.join(", "),
    }
}

/// A key in its two spellings, one for each kind of joint.
struct Key<'a> {
    revolute: (&'static str, &'a Number),
    prismatic: (&'static str, &'a Number),
    source: &'static str,
    rule: Rule,
}

/// The key of two fields of a table, for revolute and prismatic joints, with its source and rule.
macro_rules! key {
    ($table:ident.$revolute:ident, $prismatic:ident, $source:literal, $rule:ident) => {
        Key {
            revolute: (stringify!($revolute), &$table.$revolute),
            prismatic: (stringify!($prismatic), &$table.$prismatic),
            source: $source,
            rule: Rule::$rule,
        }
    };
}

mod servo;

#[derive(Clone, Copy)]
enum Rule {
    Positive,
    /// As a stiffness: a steel bar as thick as an arm has 1e9 N m/rad.
    Stiffness,
    NotNegative,
}

/// Of a transmission, N m/rad or N/m: a million times a steel bar as thick as an arm.
const STIFFEST: f64 = 1e15;

impl Rule {
    fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Positive => value > 0.0,
                Self::Stiffness => value > 0.0 && value <= STIFFEST,
                Self::NotNegative => value >= 0.0,
            }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Positive => "a finite number above zero",
            Self::Stiffness => "finite, above zero and at most 1e15: nothing is stiffer",
            Self::NotNegative => "a finite number, zero or above",
        }
    }
}

struct ConfigReader<'a> {
    path: &'a Path,
    /// Where the lines end, bytes.
    ends: Vec<usize>,
}

impl<'a> ConfigReader<'a> {
    fn new(text: &str, path: &'a Path) -> Self {
        let ends = text.match_indices('\n').map(|(at, _)| at).collect();
        Self { path, ends }
    }

    /// 1-based line of a byte offset.
    fn line(&self, offset: usize) -> usize {
        1 + self.ends.partition_point(|end| *end < offset)
    }

    fn error(&self, offset: usize, kind: ArmErrorKind) -> ArmError {
        ArmError::in_file(self.path, Some(self.line(offset)), kind)
    }

    fn joint(
        &self,
        raw: &RawJoint,
        kind: JointKind,
        transmission: &mut Transmission,
        faults: &mut Vec<ArmError>,
    ) {
        let name = raw.name.get_ref();
        let source = &raw.source;
        let sources = &mut transmission.sources;
        let mut value =
            |key: Key, text: &Option<String>| self.value(name, kind, &key, text.as_deref(), faults);
        let stiffness = key!(
            raw.stiffness_nm_per_rad,
            stiffness_n_per_m,
            "stiffness",
            Stiffness
        );
        if let Some((value, text)) = value(stiffness, &source.stiffness) {
            (transmission.stiffness, sources.stiffness) = (Some(value), text);
        }
        let linear = key!(raw.linear_to_rad, linear_to_m, "linear_to", Positive);
        if let Some((value, text)) = value(linear, &source.linear_to) {
            (transmission.linear_to, sources.linear_to) = (Some(value), text);
        }
        let damping = key!(
            raw.damping_nm_s_per_rad,
            damping_n_s_per_m,
            "damping",
            NotNegative
        );
        if let Some(found) = value(damping, &source.damping) {
            (transmission.damping, sources.damping) = found;
        }
        let friction = key!(
            raw.dry_friction_nm,
            dry_friction_n,
            "dry_friction",
            NotNegative
        );
        if let Some(found) = value(friction, &source.dry_friction) {
            (transmission.dry_friction, sources.dry_friction) = found;
        }
        let rotor = key!(
            raw.rotor_inertia_kg_m2,
            rotor_mass_kg,
            "rotor_inertia",
            NotNegative
        );
        if let Some(found) = value(rotor, &source.rotor_inertia) {
            (transmission.rotor_inertia, sources.rotor_inertia) = found;
        }
        let pulses = key!(raw.pulses_per_deg, pulses_per_mm, "pulses", Positive);
        if let Some((value, text)) = value(pulses, &source.pulses) {
            let per_unit = match kind {
                JointKind::Revolute => value.to_degrees(),
                JointKind::Prismatic => value * 1e3,
            };
            (transmission.pulses_per_unit, sources.pulses) = (Some(per_unit), text);
        }
        if let Some(servo) = &raw.servo
            && let Some((servo, text)) = self.servo(raw, servo, kind, faults)
        {
            (transmission.servo, sources.servo) = (Some(servo), text);
        }
    }

    /// The value of a key with its source, `None` if the key is absent or wrong.
    fn value(
        &self,
        joint: &str,
        kind: JointKind,
        key: &Key,
        source: Option<&str>,
        faults: &mut Vec<ArmError>,
    ) -> Option<(f64, String)> {
        let ((right, number), (wrong, other), kind_name) = match kind {
            JointKind::Revolute => (key.revolute, key.prismatic, "revolute"),
            JointKind::Prismatic => (key.prismatic, key.revolute, "prismatic"),
        };
        let joint = || joint.to_owned();
        if let Some(other) = other.as_ref().filter(|_| wrong != right) {
            let kind = ArmErrorKind::WrongUnitKey {
                joint: joint(),
                kind: kind_name,
                wrong,
                right,
            };
            faults.push(self.error(other.span().start, kind));
            return None;
        }
        let number = number.as_ref()?;
        let (value, at) = (*number.get_ref(), number.span().start);
        let is_good = key.rule.holds(value);
        if !is_good {
            let kind = ArmErrorKind::ConfigValue {
                joint: joint(),
                key: right,
                value,
                rule: key.rule.text(),
            };
            faults.push(self.error(at, kind));
        }
        let text = source.map(str::trim).filter(|text| !text.is_empty());
        if text.is_none() {
            let kind = ArmErrorKind::NoSource {
                joint: joint(),
                key: right,
                source_key: key.source,
            };
            faults.push(self.error(at, kind));
        }
        text.filter(|_| is_good)
            .map(|text| (value, text.to_owned()))
    }
}
