//! The catalogue: every kind of effect, its target, its parameters, their units and bounds.

mod define;
mod list;
mod parameter;

pub use list::{
    BaseEffect, ClockEffect, CurveEffect, CuttingEffect, EffectKind, Family, FootEffect,
    JointEffect, MillingEffect, RobotEffect, SensorEffect, Typed, WheelEffect,
};

use truecut_recording::Unit;

/// What an effect of a kind acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TargetKind {
    /// There is only one.
    Whole,
    /// Key `joint`.
    Joint,
    /// Key `axis`.
    Axis,
    /// Key `channel`.
    Channel,
}

/// One parameter of a kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterInfo {
    /// Key in the file, for prismatic joints and whatever is not a joint. Ends in the unit, which
    /// is SI.
    pub key: &'static str,
    /// Key in the file for a rotary joint.
    pub rotary_key: &'static str,
    /// Unit, for prismatic joints and whatever is not a joint. [`Unit::One`] for the channel's own
    /// unit.
    pub unit: Unit,
    /// Unit for a rotary joint.
    pub rotary_unit: Unit,
    /// Value at which the effect changes nothing.
    pub neutral: f64,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
    /// Whether it measures the effect's size. The others only shape it, and mean nothing at size
    /// zero.
    pub is_size: bool,
    /// Values worth starting a search from; empty where they follow from the data.
    pub starts: &'static [f64],
    /// One line.
    pub description: &'static str,
}

/// Models in which an effect plays a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Model {
    /// A plant whose joints are driven through their transmissions.
    Driven,
    /// A plant on whose links the drives act directly: `drive = "force"`.
    Free,
    /// Inverse dynamics of measured motion.
    Inverse,
    /// The means of a steady machine.
    Steady,
}

/// The signal whose course the trace of an effect follows, with others of its family in any
/// mixture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Signal {
    /// The speed of its joint, as a friction does.
    Speed,
    /// The load of its joint or of the foot, as a transmission or a friction does.
    Load,
    /// The angle of its joint, as a transmission does.
    Angle,
}

impl Family {
    /// Whether it is about what is measured, not about what happens.
    pub fn is_instrumental(self) -> bool {
        matches!(self, Family::Clock | Family::Sensor)
    }
}

impl EffectKind {
    /// The kind's name in files.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// The kind of a name.
    pub fn from_name(name: &str) -> Option<EffectKind> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }

    /// Where it belongs.
    pub fn family(self) -> Family {
        self.entry().family
    }

    /// What it acts on.
    pub fn target(self) -> TargetKind {
        self.entry().target
    }

    /// One line for a reader.
    pub fn description(self) -> &'static str {
        self.entry().description
    }

    /// Its parameters.
    pub fn parameters(self) -> &'static [ParameterInfo] {
        self.entry().parameters
    }

    /// Whether it plays a part in a model.
    pub fn acts_in(self, model: Model) -> bool {
        self.entry().models.contains(&model)
    }

    /// The signal that its trace follows, if it is one of the mixtures that are looked for.
    pub fn follows(self) -> Option<Signal> {
        self.entry().follows
    }

    /// Whether it is a curve without a name: its first two parameters are the ends over which it is
    /// given, and there are as many values of the third as are wanted.
    pub fn is_curve(self) -> bool {
        self.family() == Family::Curve
    }

    /// Whether it holds `other` as a limit.
    pub fn generalises(self, other: EffectKind) -> bool {
        self.entry().limits.contains(&other)
    }
}
