//! What the rest of the program may ask of a process without knowing which one it is.

use std::path::PathBuf;

use truecut_core::wheel::force_control::ForceControl;

use crate::foot::FootSpec;

/// Facts of a process with its parameters. There is no default: a new fact asks every process.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// Angular speed of what turns (spindle, wheel, workpiece), rad/s, above 0; `None` if nothing
    /// turns, or not at one speed.
    pub rate_rad_s: Option<f64>,
    /// How long the process takes by itself, s; infinite if its data or the plan of its path says;
    /// `None` if it does not end by itself.
    pub natural_duration_s: Option<f64>,
    /// Channels of its recording that say where the machine was and how hard it pressed: what a
    /// comparison leaves unexplained may follow them. Only those that a run has are looked at.
    pub signals: &'static [&'static str],
    /// Numbers that a person could change at the machine for another experiment.
    pub knobs: &'static [Knob],
    /// Dotted keys below the process's table that hold the path of a file, relative to the
    /// scenario's folder.
    pub files: &'static [&'static str],
    /// What presses on the workpiece and so needs a driven arm, as a dotted key below `process`;
    /// `None` if the joints may be free.
    pub needs_drive: Option<&'static str>,
    /// Whether there is an arm at all.
    pub needs_robot: bool,
    /// Whether `[[tool.mode]]` and `[[workpiece.mode]]` belong to it.
    pub modes: ModesIn,
    /// Whether measured inputs drive it.
    pub replays: bool,
    /// Where the posture comes from in which the arm starts.
    pub posture: PostureFrom,
    /// What effects find to act on.
    pub parts: Parts,
}

/// Where a scenario gives modes of tool and workpiece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModesIn {
    /// In `[[tool.mode]]` and `[[workpiece.mode]]`.
    Scenario,
    /// Not there, and why.
    Elsewhere(&'static str),
}

/// A number of a scenario that can be set at the machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knob {
    /// Dotted key in the scenario.
    pub key: &'static str,
    /// What it is, in words.
    pub words: &'static str,
    /// Factors on its value that are worth an experiment.
    pub factors: &'static [f64],
    /// Value where the scenario gives none; without one there is nothing to vary then.
    pub default: Option<f64>,
}

impl Knob {
    /// A number that is varied only where the scenario gives it.
    #[must_use]
    pub const fn new(key: &'static str, words: &'static str, factors: &'static [f64]) -> Knob {
        Knob {
            key,
            words,
            factors,
            default: None,
        }
    }

    /// The same number with its value where the scenario gives none.
    #[must_use]
    pub const fn or(self, default: f64) -> Knob {
        Knob {
            default: Some(default),
            ..self
        }
    }
}

/// Where the posture comes from in which the arm starts.
#[derive(Debug, Clone, PartialEq)]
pub enum PostureFrom {
    /// The scenario's `[robot]` table.
    Scenario,
    /// The path job in this file.
    Job(PathBuf),
    /// A taught program, whose first posture it is.
    Taught,
    /// The first point of a path, near to the scenario's posture, if it gives one.
    Path,
}

/// What of a process the families of effects find to act on.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts {
    /// Number of chamfering edges.
    pub edges: Option<usize>,
    /// The pressure foot.
    pub foot: Option<FootSpec>,
    /// The wheel, belt or brush.
    pub wheel: Option<WheelPart>,
}

/// What of a wheel effects find to act on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelPart {
    /// What holds its force.
    pub hold: WheelHold,
    /// Whether what it takes off shows in a channel.
    pub shows_removal: bool,
    /// Whether it turns, so that an eccentricity comes back with each turn.
    pub turns: bool,
    /// Whether it runs over edges at which grains can jam.
    pub over_edges: bool,
    /// By how much it is typically pressed in, m.
    pub indentation_m: f64,
}

/// What holds the force of a wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WheelHold {
    /// The path; the process has no force control.
    Path,
    /// The path; a force control could be chosen.
    Position,
    /// A force control, N.
    Force(f64),
}

impl Parts {
    /// Nothing that effects on a process act on.
    pub const NONE: Parts = Parts {
        edges: None,
        foot: None,
        wheel: None,
    };
}

/// What holds the force of a wheel that may have a force control.
pub(crate) fn hold(control: &ForceControl) -> WheelHold {
    (control.force_n()).map_or(WheelHold::Position, WheelHold::Force)
}
