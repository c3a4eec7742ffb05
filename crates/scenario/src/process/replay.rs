//! The `[process.replay]` table: measured inputs drive the model.

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::process::{Facts, Knob, ModesIn, Parts, PostureFrom, Room};
use crate::units::{from_mm, from_rpm};

/// Measured inputs, the channels of `[data]` with role "input", drive the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplaySpec {
    /// Which way.
    pub mode: ReplayMode,
    /// Factor on how far the inputs depart from where they begin.
    pub amplitude_factor: f64,
    /// Factor on how fast the inputs are played.
    pub speed_factor: f64,
    /// The cut that is observed (mode "observe"), if it is one of turning.
    pub turning: Option<Turning>,
}

/// What is known of a turning cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    /// Speed of the workpiece.
    pub spindle_rad_s: f64,
    /// Depth of cut.
    pub depth_m: f64,
}

/// Which way a measurement is replayed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReplayMode {
    /// Commands and forces in, motion out.
    Forward,
    /// Measured motion in, drive forces out.
    Inverse {
        /// Cutoff of the filter through which the measured coordinates go before they are
        /// differentiated.
        differentiate_cutoff_hz: f64,
        /// Cutoff of the filter through which measured and predicted drive forces go.
        compare_cutoff_hz: f64,
    },
    /// No model: every channel is predicted to be constant, at its mean.
    Observe,
}

/// Modes by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum ModeName {
    /// Commands and forces in, motion out.
    #[default]
    Forward,
    /// Measured motion in, drive forces out.
    Inverse,
    /// No model: every channel is predicted to be constant, at its mean.
    Observe,
}

/// Measured inputs drive the model.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ReplayTable {
    /// Which way. Default: "forward".
    mode: Option<ModeName>,
    /// Cutoff of the zero-phase filter before differentiation (mode "inverse"). Default: 20.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a filter passes something"))]
    differentiate_cutoff_hz: Option<f64>,
    /// Cutoff of the zero-phase filter on measured and predicted drive forces (mode "inverse").
    /// Default: 10.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a filter passes something"))]
    compare_cutoff_hz: Option<f64>,
    /// Factor on the inputs, about their first values: to plan another experiment (mode "forward").
    /// Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "an experiment moves"))]
    amplitude_factor: Option<f64>,
    /// Factor on the speed at which the inputs are played: to plan another experiment (mode
    /// "forward"). Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "time runs forward"))]
    speed_factor: Option<f64>,
    /// Speed of the workpiece of a turning cut that is observed (mode "observe", with depth_mm).
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the spindle turns"))]
    spindle_rpm: Option<f64>,
    /// Depth of a turning cut that is observed (mode "observe", with spindle_rpm).
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a cut has a depth"))]
    depth_mm: Option<f64>,
}

// Ten times and five times the motion's own bandwidth of some 2 Hz, as identification of robots
// takes it (`gautier1997`).
const DEFAULT_DIFFERENTIATE_CUTOFF_HZ: f64 = 20.0;
const DEFAULT_COMPARE_CUTOFF_HZ: f64 = 10.0;

impl ReplayTable {
    fn turning(&self, check: &mut Check) -> Option<Turning> {
        let who = "an observed cut";
        let (rpm, depth) = (self.spindle_rpm, self.depth_mm);
        if rpm.is_none() && depth.is_none() {
            return None;
        }
        let rpm = check.needed("process.replay", "spindle_rpm", rpm, who)?;
        let depth = check.needed("process.replay", "depth_mm", depth, who)?;
        Some(Turning {
            spindle_rad_s: from_rpm(rpm),
            depth_m: from_mm(depth),
        })
    }

    pub(crate) fn resolve(self, check: &mut Check) -> ReplaySpec {
        let mode = self.mode.unwrap_or_default();
        if mode != ModeName::Inverse {
            let keys = ["differentiate_cutoff_hz", "compare_cutoff_hz"];
            check.ignored("process.replay", &keys, "the mode is not \"inverse\"");
        }
        if mode != ModeName::Forward {
            let keys = ["amplitude_factor", "speed_factor"];
            check.ignored("process.replay", &keys, "the mode is not \"forward\"");
        }
        if mode != ModeName::Observe {
            let keys = ["spindle_rpm", "depth_mm"];
            check.ignored("process.replay", &keys, "the mode is not \"observe\"");
        }
        ReplaySpec {
            turning: self.turning(check),
            amplitude_factor: self.amplitude_factor.unwrap_or(1.0),
            speed_factor: self.speed_factor.unwrap_or(1.0),
            mode: match mode {
                ModeName::Forward => ReplayMode::Forward,
                ModeName::Observe => ReplayMode::Observe,
                ModeName::Inverse => ReplayMode::Inverse {
                    differentiate_cutoff_hz: (self.differentiate_cutoff_hz)
                        .unwrap_or(DEFAULT_DIFFERENTIATE_CUTOFF_HZ),
                    compare_cutoff_hz: (self.compare_cutoff_hz)
                        .unwrap_or(DEFAULT_COMPARE_CUTOFF_HZ),
                },
            },
        }
    }
}

/// What a person could change at the machine.
const KNOBS: &[Knob] = &[
    Knob::new(
        "process.replay.amplitude_factor",
        "amplitude of the inputs",
        &[0.3, 2.0],
    )
    .or(1.0),
    Knob::new(
        "process.replay.speed_factor",
        "speed of the inputs",
        &[0.3, 2.0],
    )
    .or(1.0),
];

impl Room for ReplaySpec {
    type Table = ReplayTable;

    fn resolve(table: ReplayTable, _folder: &Path, check: &mut Check) -> Option<Self> {
        Some(table.resolve(check))
    }

    fn facts(&self) -> Facts {
        Facts {
            rate_rad_s: self.turning.map(|cut| cut.spindle_rad_s),
            natural_duration_s: Some(f64::INFINITY),
            signals: &["tool.displacement_x"],
            knobs: KNOBS,
            files: &[],
            needs_drive: None,
            modes: ModesIn::Elsewhere("a replay takes its forces from the data"),
            needs_robot: self.mode != ReplayMode::Observe,
            replays: true,
            posture: PostureFrom::Scenario,
            parts: Parts::NONE,
        }
    }
}
