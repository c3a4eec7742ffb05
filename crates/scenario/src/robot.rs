//! The `[robot]` table: which arm, in which posture, driven how.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_arm::{ArmError, ArmErrorKind, Masses, Packages, Reading};

use crate::adjust::{self, JointSpec, JointTable, LinkSpec, LinkTable};
use crate::check::Check;
use crate::fault::Fault;
use crate::units::{from_deg, from_mm};
use crate::xacro_arguments::{ArgumentTable, texts};

/// What a table says of the files of an arm: URDF, transmission data, tip, arguments.
pub(crate) type Files = (
    String,
    Option<String>,
    Option<String>,
    Option<ArgumentTable>,
);

/// The arm that carries the tool.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotSpec {
    /// URDF file; relative paths are resolved against the folder of the scenario file.
    pub urdf: PathBuf,
    /// Transmission data; `None` means `robot.toml` beside the URDF.
    pub config: Option<PathBuf>,
    /// Link whose frame is the flange; `None` means the end of the chain.
    pub tip: Option<String>,
    /// Arguments of the robot's file, where that is xacro, by name.
    pub arguments: BTreeMap<String, String>,
    /// Link-side coordinates of the rotary joints at the start, in chain order; empty means all
    /// zero.
    pub posture_rad: Vec<f64>,
    /// Link-side coordinates of the prismatic joints at the start, in chain order; empty means all
    /// zero.
    pub posture_m: Vec<f64>,
    /// Whether gravity acts (9.81 m/s² along −z of the world).
    pub gravity: bool,
    /// How the joints are driven.
    pub drive: DriveKind,
    /// Factor on all masses and inertias.
    pub inertia_scale: f64,
    /// Factor on all transmission stiffnesses.
    pub stiffness_scale: f64,
    /// Factor on all transmission dampings.
    pub damping_scale: f64,
    /// Damping ratios of the arm's modes in place of the transmissions' damping: one for all, or
    /// one for each, slowest first; empty: the transmissions'.
    pub damping_ratios: Vec<f64>,
    /// Whether the command makes up for the sag under gravity, so that the links start at the
    /// posture.
    pub hold_against_sag: bool,
    /// Links that differ from the URDF.
    pub links: Vec<LinkSpec>,
    /// Joints whose drive differs from robot.toml.
    pub joints: Vec<JointSpec>,
}

impl RobotSpec {
    /// No arm at all.
    pub const NONE: RobotSpec = RobotSpec {
        urdf: PathBuf::new(),
        config: None,
        tip: None,
        arguments: BTreeMap::new(),
        posture_rad: Vec::new(),
        posture_m: Vec::new(),
        gravity: true,
        drive: DriveKind::Position,
        inertia_scale: 1.0,
        stiffness_scale: 1.0,
        damping_scale: 1.0,
        damping_ratios: Vec::new(),
        hold_against_sag: true,
        links: Vec::new(),
        joints: Vec::new(),
    };

    /// The arm of these files (URDF, transmission data, tip, arguments) in a posture, driven by
    /// default.
    pub(crate) fn read(
        folder: &Path,
        (urdf, config, tip, arguments): Files,
        posture_deg: Option<Vec<f64>>,
        posture_mm: Option<Vec<f64>>,
    ) -> RobotSpec {
        let radians = posture_deg.unwrap_or_default().into_iter().map(from_deg);
        let metres = posture_mm.unwrap_or_default().into_iter().map(from_mm);
        RobotSpec {
            urdf: folder.join(urdf),
            config: config.map(|file| folder.join(file)),
            tip,
            arguments: texts(arguments),
            posture_rad: radians.collect(),
            posture_m: metres.collect(),
            ..RobotSpec::NONE
        }
    }

    /// How the arm's files are read.
    pub fn reading(&self, masses: Masses) -> Reading<'_> {
        Reading {
            config: self.config.as_deref(),
            tip: self.tip.as_deref(),
            masses,
            packages: Packages::from_environment([]),
            arguments: self.arguments.clone(),
        }
    }

    /// The dotted key that a fault of the arm's files is about, where it has no line there.
    pub fn key_of(&self, error: &ArmError) -> String {
        let of_config = error.path().is_some() && error.path() == self.config.as_deref();
        match error.kind() {
            ArmErrorKind::XacroArgument { name, .. } => format!("robot.arguments.{name}"),
            _ if of_config => "robot.config".to_owned(),
            _ => "robot.urdf".to_owned(),
        }
    }
}

/// How the joints are driven.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DriveKind {
    /// The motor follows the command exactly; the transmission between motor and link is elastic.
    #[default]
    Position,
    /// The motor is a rotor under a position and a velocity loop, with a limited torque.
    Servo,
    /// No motor and no transmission: the joints are free.
    Force,
}

impl RobotSpec {
    /// Sets a number that nothing else is resolved from, by its key below `robot` and in SI.
    /// Whether there is one.
    pub(crate) fn set(&mut self, key: &[&str], value: f64) -> bool {
        let has_transmissions = self.drive != DriveKind::Force;
        let of_modes = !self.damping_ratios.is_empty();
        let slot = match *key {
            ["inertia_scale"] => Some(&mut self.inertia_scale),
            ["posture_deg", index] => entry(&mut self.posture_rad, index),
            ["posture_mm", index] => entry(&mut self.posture_m, index),
            ["stiffness_scale"] if has_transmissions => Some(&mut self.stiffness_scale),
            ["damping_scale"] if has_transmissions && !of_modes => Some(&mut self.damping_scale),
            ["link", index, own] => entry(&mut self.links, index).and_then(|link| match own {
                "mass_factor" => Some(&mut link.mass_factor),
                "center_x_mm" => Some(&mut link.center_m[0]),
                "center_y_mm" => Some(&mut link.center_m[1]),
                "center_z_mm" => Some(&mut link.center_m[2]),
                _ => None,
            }),
            ["joint", index, own] => entry(&mut self.joints, index).and_then(|joint| match own {
                "rotor_inertia_factor" => Some(&mut joint.rotor_inertia_factor),
                "stiffness_factor" if has_transmissions => Some(&mut joint.stiffness_factor),
                "damping_factor" if has_transmissions && !of_modes => {
                    Some(&mut joint.damping_factor)
                }
                _ => None,
            }),
            _ => None,
        };
        slot.map(|slot| *slot = value).is_some()
    }
}

fn entry<'a, T>(list: &'a mut [T], index: &str) -> Option<&'a mut T> {
    list.get_mut(index.parse::<usize>().ok()?)
}

/// The arm, its posture and its drive.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RobotTable {
    /// URDF file, relative to the scenario file.
    urdf: String,
    /// Transmission data, relative to the scenario file. Default: robot.toml beside the URDF.
    config: Option<String>,
    /// Link whose frame is the flange. Default: the end of the chain.
    tip: Option<String>,
    /// Arguments of a xacro file, by name: texts, numbers or truths. Default: those of the file.
    arguments: Option<ArgumentTable>,
    /// Rotary joints at the start, in chain order. Default: all zero.
    posture_deg: Option<Vec<f64>>,
    /// Prismatic joints at the start, in chain order. Default: all zero.
    posture_mm: Option<Vec<f64>>,
    /// Whether gravity acts. Default: true.
    gravity: Option<bool>,
    /// How the joints are driven. Default: "position".
    drive: Option<DriveKind>,
    /// Factor on all masses and inertias. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "masses are positive"))]
    inertia_scale: Option<f64>,
    /// Factor on all transmission stiffnesses. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "stiffnesses are positive"))]
    stiffness_scale: Option<f64>,
    /// Factor on all transmission dampings. Default: 1.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "negative damping would create energy"))]
    damping_scale: Option<f64>,
    /// Damping ratios of the arm's modes at its start, in place of the transmissions' damping: one
    /// for all modes, or one for each, slowest first (drive "position"). Default: the
    /// transmissions'.
    #[schemars(extend("minItems" = 1, "maxItems" = 12))]
    damping_ratio: Option<Vec<f64>>,
    /// Whether the command makes up for the sag under gravity. Default: true.
    hold_against_sag: Option<bool>,
    /// Links whose inertial values differ from the URDF.
    link: Option<Vec<LinkTable>>,
    /// Joints whose drive differs from robot.toml.
    joint: Option<Vec<JointTable>>,
}

impl RobotTable {
    /// The arm, which every process needs but a replay that only observes.
    pub(crate) fn resolve_optional(
        table: Option<RobotTable>,
        is_needed: bool,
        folder: &Path,
        check: &mut Check,
    ) -> RobotSpec {
        match table {
            Some(_) if !is_needed => {
                let message =
                    "[robot] has no effect: a replay in mode \"observe\" has no model".to_owned();
                check.refuse(Fault::key("robot", message, "has no effect here"));
                RobotSpec::NONE
            }
            Some(table) => table.resolve(folder, check),
            None if !is_needed => RobotSpec::NONE,
            None => {
                let message = "missing key `robot` in the file".to_owned();
                let fault = Fault::key("robot", message, "`robot` is missing here");
                check.refuse(fault.with_help("`robot`: The arm, its posture and its drive."));
                RobotSpec::NONE
            }
        }
    }

    pub(crate) fn resolve(self, folder: &Path, check: &mut Check) -> RobotSpec {
        let drive = self.drive.unwrap_or_default();
        let gravity = self.gravity.unwrap_or(true);
        if drive == DriveKind::Force {
            let keys = ["stiffness_scale", "damping_scale", "hold_against_sag"];
            check.ignored("robot", &keys, "with drive = \"force\" the joints are free");
        } else if !gravity {
            check.ignored(
                "robot",
                &["hold_against_sag"],
                "without gravity nothing sags",
            );
        }
        let damping_ratios = damping_ratios(self.damping_ratio, drive, check);
        let ignored: (&[&str], &str) = match drive {
            DriveKind::Force => (
                &["stiffness_factor", "damping_factor"],
                "with drive = \"force\" the joints are free",
            ),
            _ if !damping_ratios.is_empty() => (&["damping_factor"], MODAL_DAMPING),
            _ => (&[], ""),
        };
        let files = (self.urdf, self.config, self.tip, self.arguments);
        RobotSpec {
            damping_ratios,
            gravity,
            drive,
            inertia_scale: self.inertia_scale.unwrap_or(1.0),
            stiffness_scale: self.stiffness_scale.unwrap_or(1.0),
            damping_scale: self.damping_scale.unwrap_or(1.0),
            hold_against_sag: self.hold_against_sag.unwrap_or(true),
            links: adjust::links(self.link, check),
            joints: adjust::joints(self.joint, ignored, check),
            ..RobotSpec::read(folder, files, self.posture_deg, self.posture_mm)
        }
    }
}

/// Why nothing scales the damping of transmissions.
const MODAL_DAMPING: &str = "robot.damping_ratio takes the place of the damping that it scales";

/// Damping ratios of modes, each from 0 to below 1.
fn damping_ratios(given: Option<Vec<f64>>, drive: DriveKind, check: &mut Check) -> Vec<f64> {
    if drive != DriveKind::Position {
        let because = "only drive = \"position\" takes the damping of modes";
        check.ignored("robot", &["damping_ratio"], because);
    } else if given.is_some() {
        check.ignored("robot", &["damping_scale"], MODAL_DAMPING);
    }
    let ratios = given.unwrap_or_default();
    let vibrates = |ratio: &f64| (0.0..1.0).contains(ratio);
    if let Some(wrong) = ratios.iter().find(|ratio| !vibrates(ratio)) {
        let is = format!("has {wrong}, but must have values from 0 to below 1: modes vibrate");
        check.wrong("robot", "damping_ratio", is, "no damping ratio");
    }
    ratios
}
