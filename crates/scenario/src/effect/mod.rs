//! Effects: physical things that the nominal model leaves out. Types only; the physics is in
//! `core`.
//!
//! An effect is a kind, what it acts on, and a size. At its neutral size it is exactly the nominal
//! model.

mod catalogue;
pub(crate) mod table;
pub(crate) mod text;

use truecut_core::joint_law::Curve;
use truecut_recording::Unit;

pub use catalogue::{
    BaseEffect, ClockEffect, CurveEffect, CuttingEffect, EffectKind, Family, FootEffect,
    JointEffect, MillingEffect, Model, ParameterInfo, RobotEffect, SensorEffect, Signal,
    TargetKind, Typed, WheelEffect,
};

/// Unit of a key of the catalogue; a key has the same one in every kind.
pub(crate) fn unit_of_key(key: &str) -> Unit {
    let mut known = EffectKind::ALL.iter().flat_map(|kind| kind.parameters());
    known
        .find_map(|info| match key {
            _ if key == info.key => Some(info.unit),
            _ if key == info.rotary_key => Some(info.rotary_unit),
            _ => None,
        })
        .unwrap_or(Unit::One)
}

/// What an effect acts on.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Target {
    /// The whole robot, tool or process: there is only one.
    Whole,
    /// A joint of the chain, counted from 0 (from 1 in files and channel names).
    Joint(usize),
    /// A world axis: 0, 1, 2 for x, y, z.
    Axis(usize),
    /// A recorded channel, by name.
    Channel(String),
}

/// One effect with its size.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// What it is.
    pub kind: EffectKind,
    /// What it acts on; fits [`EffectKind::target`].
    pub target: Target,
    /// One value for each of [`EffectKind::parameters`], in their units; of a curve's last as many
    /// as it has places.
    pub values: Vec<f64>,
}

/// Most values of a curve.
pub(crate) const MOST_PLACES: usize = 200;

impl Effect {
    /// The effect at the size at which it changes nothing.
    pub fn neutral(kind: EffectKind, target: Target) -> Effect {
        let values = kind.parameters().iter().map(|p| p.neutral).collect();
        Effect {
            kind,
            target,
            values,
        }
    }

    /// Whether the effect fits its kind: target, number of values, bounds.
    ///
    /// # Errors
    /// What does not fit, with value and bound.
    pub fn check(&self) -> Result<(), String> {
        let (wanted, known) = (self.kind.target(), self.kind.parameters());
        let fits = match self.target {
            Target::Whole => wanted == TargetKind::Whole,
            Target::Joint(_) => wanted == TargetKind::Joint,
            Target::Axis(axis) => wanted == TargetKind::Axis && axis < 3,
            Target::Channel(_) => wanted == TargetKind::Channel,
        };
        if !fits {
            return Err(format!(
                "`{self}`: an effect of this kind does not act on that"
            ));
        }
        let most = match self.kind.is_curve() {
            true => known.len() - 1 + MOST_PLACES,
            false => known.len(),
        };
        if !(known.len()..=most).contains(&self.values.len()) {
            let (got, needs) = (self.values.len(), known.len());
            return Err(format!("`{self}` has {got} values, but must have {needs}"));
        }
        for (info, value) in self.infos().zip(&self.values) {
            if !(info.min..=info.max).contains(value) {
                return Err(format!(
                    "`{}` of `{self}` is {value}, but must be from {} to {}",
                    info.key, info.min, info.max
                ));
            }
        }
        Ok(())
    }

    /// What each value is: the last for all that a curve has of it.
    fn infos(&self) -> impl Iterator<Item = &'static ParameterInfo> {
        let known = self.kind.parameters();
        known.iter().chain(known.iter().last().into_iter().cycle())
    }

    /// The values that have a name of their own; `None` if there are too few of a curve.
    fn named(&self) -> Option<&[f64]> {
        match self.kind.is_curve() {
            true => self.values.get(..self.kind.parameters().len()),
            false => Some(&self.values),
        }
    }

    /// The curve of an effect that is one ([`EffectKind::is_curve`]).
    pub fn curve(&self) -> Option<Curve> {
        let (ends, values) = match self.kind.is_curve() {
            true => self.values.split_at_checked(2)?,
            false => return None,
        };
        Curve::new(ends[0], ends[1], values)
    }

    /// Whether the effect has a parameter with this key and within these bounds; then it is set.
    pub(crate) fn set(&mut self, key: &str, value: f64) -> bool {
        let is_meant = |info: &ParameterInfo| info.key == key || info.rotary_key == key;
        let mut known = self.kind.parameters().iter().zip(&mut self.values);
        let Some((info, slot)) = known.find(|(info, _)| is_meant(info)) else {
            return false;
        };
        let is_within = (info.min..=info.max).contains(&value);
        if is_within {
            *slot = value;
        }
        is_within
    }

    /// Whether the effect, by its size, changes nothing.
    pub fn is_neutral(&self) -> bool {
        let sizes = self.infos().zip(&self.values);
        sizes
            .filter(|(p, _)| p.is_size)
            .all(|(p, v)| *v == p.neutral)
    }
}

impl std::fmt::Display for Effect {
    /// Kind and target: `joint_coulomb of joint 2`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.kind.name())?;
        match &self.target {
            Target::Whole => Ok(()),
            Target::Joint(joint) => write!(f, " of joint {}", joint + 1),
            Target::Axis(axis) => {
                write!(f, " about {}", ["x", "y", "z"].get(*axis).unwrap_or(&"?"))
            }
            Target::Channel(channel) => write!(f, " of {channel}"),
        }
    }
}
