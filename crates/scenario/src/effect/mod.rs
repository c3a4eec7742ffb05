//! Effects: physical things that the nominal model leaves out. Types only; the physics is in `core`.
//!
//! An effect is a kind, what it acts on, and a size. At its neutral size it is exactly the nominal model.

mod catalogue;

pub use catalogue::{EffectKind, Family, ParameterInfo, TargetKind};

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
    /// One value for each of [`EffectKind::parameters`], in their units.
    pub values: Vec<f64>,
}

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

    /// Whether the effect, by its size, changes nothing.
    pub fn is_neutral(&self) -> bool {
        let sizes = self.kind.parameters().iter().zip(&self.values);
        sizes
            .filter(|(p, _)| p.is_size)
            .all(|(p, v)| *v == p.neutral)
    }
}
