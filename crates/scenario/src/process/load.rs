//! The `[process.load]` table: given forces at the tool, for free decay, static load, sweeps and
//! plain motion along a path from a file.

use std::f64::consts::TAU;
use std::path::Path;

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Deserialize;
use truecut_plan::path_file::PathFile;

use crate::check::Check;
use crate::fault::Fault;
use crate::foot::{FootSpec, FootTable};
use crate::process::path_file::PathFileTable;
use crate::process::{Facts, Knob, ModesIn, Parts, PostureFrom, Room};
use crate::units::from_deg;

/// Given forces on the tool; what is not given is zero.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadSpec {
    /// Frame of `constant_n`, `release_n` and of the sweep's amplitude.
    pub frame: LoadFrame,
    /// Force from t = 0 on.
    pub constant_n: Vector3<f64>,
    /// Force before t = 0, gone at t = 0: the arm starts in equilibrium with it and then swings.
    pub release_n: Vector3<f64>,
    /// A force whose frequency rises over the run.
    pub sweep: Option<ForceSweep>,
    /// A force that rotates in the process Y–Z plane, whatever `frame` says.
    pub rotating: Option<RotatingForce>,
    /// Pressure foot; `None` means that there is none.
    pub foot: Option<FootSpec>,
    /// Path from CAM, or robot program, along which the arm is led; `None`: it holds its posture.
    pub path: Option<PathFile>,
}

/// Frame in which a force is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LoadFrame {
    /// The process frame: X along the spindle.
    #[default]
    Process,
    /// The world frame: z up.
    World,
}

/// A force whose frequency rises linearly over the whole run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceSweep {
    /// Amplitude.
    pub amplitude_n: Vector3<f64>,
    /// Frequency at the start.
    pub from_hz: f64,
    /// Frequency at the end.
    pub to_hz: f64,
}

/// A force of constant magnitude that rotates from process Y towards process Z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotatingForce {
    /// Magnitude.
    pub amplitude_n: f64,
    /// Revolutions per second.
    pub frequency_hz: f64,
    /// Angle at t = 0, from process Y towards process Z.
    pub start_angle_rad: f64,
}

/// Given forces on the tool.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LoadTable {
    /// Frame of constant_n, release_n and sweep. Default: "process", whose X lies along the
    /// spindle; in "world" z is up.
    frame: Option<LoadFrame>,
    /// Force from t = 0 on, in `frame`. Default: none.
    constant_n: Option<[f64; 3]>,
    /// Force before t = 0, gone at t = 0. Default: none.
    release_n: Option<[f64; 3]>,
    /// A force whose frequency rises linearly over the run.
    sweep: Option<ForceSweepTable>,
    /// A force that rotates in the process Y-Z plane.
    rotating: Option<RotatingForceTable>,
    /// Pressure foot. Default: no foot.
    foot: Option<FootTable>,
    /// Path from a file along which the arm is led. Default: it holds its posture.
    path: Option<PathFileTable>,
}

/// A force whose frequency rises linearly over the run.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ForceSweepTable {
    /// Amplitude.
    amplitude_n: [f64; 3],
    /// Frequency at the start.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a frequency is not negative"))]
    from_hz: f64,
    /// Frequency at the end.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a frequency is positive"))]
    to_hz: f64,
}

/// A rotating force.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct RotatingForceTable {
    /// Magnitude.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "the start angle gives the direction"))]
    amplitude_n: f64,
    /// Revolutions per second.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the force rotates"))]
    frequency_hz: f64,
    /// Angle at t = 0, from process Y towards process Z. Default: 0.
    start_angle_deg: Option<f64>,
}

impl LoadTable {
    /// `None` after recording a fault. `folder` is that of the scenario file.
    pub(crate) fn resolve(self, folder: &Path, check: &mut Check) -> Option<LoadSpec> {
        if self.constant_n.is_none() && self.release_n.is_none() && self.sweep.is_none() {
            let because = "none of constant_n, release_n and sweep is given";
            check.ignored("process.load", &["frame"], because);
        }
        if let Some(sweep) = self
            .sweep
            .as_ref()
            .filter(|sweep| sweep.from_hz >= sweep.to_hz)
        {
            let message = format!(
                "is {}, but must be greater than from_hz = {}: the frequency rises over the run",
                sweep.to_hz, sweep.from_hz
            );
            check.wrong("process.load.sweep", "to_hz", message, "not above from_hz");
        }
        let rotating = self.rotating.map(|force| RotatingForce {
            amplitude_n: force.amplitude_n,
            frequency_hz: force.frequency_hz,
            start_angle_rad: from_deg(force.start_angle_deg.unwrap_or(0.0)),
        });
        // Where nothing turns there is no vibration to be equivalent to.
        let turning_rad_s = rotating.map_or(1.0, |force| TAU * force.frequency_hz);
        if self.path.is_some() && self.foot.is_some() {
            let message = "`process.load.foot` presses on a workpiece, but must not where \
                           [process.load.path] leads the arm: the tool is free on its way";
            let fault = Fault::key(
                "process.load.foot",
                message.to_owned(),
                "presses on the way",
            );
            check.refuse(fault);
        }
        let path = match self.path {
            Some(path) => Some(path.resolve("process.load.path", folder, check)?),
            None => None,
        };
        Some(LoadSpec {
            path,
            frame: self.frame.unwrap_or_default(),
            constant_n: self.constant_n.unwrap_or_default().into(),
            release_n: self.release_n.unwrap_or_default().into(),
            sweep: self.sweep.map(|sweep| ForceSweep {
                amplitude_n: sweep.amplitude_n.into(),
                from_hz: sweep.from_hz,
                to_hz: sweep.to_hz,
            }),
            rotating,
            foot: self
                .foot
                .map(|foot| foot.resolve("process.load.foot", turning_rad_s, check)),
        })
    }
}

/// What a person could change at the machine.
const KNOBS: &[Knob] = &[
    Knob::new(
        "process.load.rotating.amplitude_n",
        "amplitude of the rotating force",
        &[0.5, 2.0],
    ),
    Knob::new(
        "process.load.rotating.frequency_hz",
        "frequency of the rotating force",
        &[0.6, 1.6],
    ),
    Knob::new(
        "process.load.sweep.to_hz",
        "highest frequency of the sweep",
        &[1.5],
    ),
    Knob::new(
        "process.load.foot.pressure_mpa",
        "foot pressure",
        &[0.6, 1.5],
    ),
];

impl Room for LoadSpec {
    type Table = LoadTable;

    fn resolve(table: LoadTable, folder: &Path, check: &mut Check) -> Option<Self> {
        table.resolve(folder, check)
    }

    fn facts(&self) -> Facts {
        Facts {
            rate_rad_s: None,
            natural_duration_s: self.path.as_ref().map(|_| f64::INFINITY),
            signals: &["foot.normal_force", "tool.displacement_x"],
            knobs: KNOBS,
            files: &["path.file"],
            needs_drive: match (&self.path, &self.foot) {
                (Some(_), _) => Some("load.path"),
                (None, foot) => foot.as_ref().map(|_| "load.foot"),
            },
            needs_robot: true,
            modes: ModesIn::Scenario,
            replays: false,
            posture: match self.path {
                Some(_) => PostureFrom::Path,
                None => PostureFrom::Scenario,
            },
            parts: Parts {
                foot: self.foot,
                ..Parts::NONE
            },
        }
    }
}
