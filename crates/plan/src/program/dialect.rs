//! What a robot-program dialect is: one room each, reached through [`Dialect`] alone.

use std::fmt::Debug;
use std::path::Path;

use nalgebra::Isometry3;
use schemars::{JsonSchema, Schema, generate::SchemaSettings};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use truecut_arm::Robot;

use super::error::{OptionFault, ProgramError, ProgramErrorKind};
use super::moves::{Program, Tool};

/// A dialect's own options by key, as a path job's `[program]` gives them.
pub type Options = Map<String, Value>;

/// Reads the text of a file; a program may lie in several.
pub type ReadText<'a> = dyn Fn(&Path) -> std::io::Result<String> + 'a;

/// A language in which robots are programmed.
///
/// Those in [`DIALECTS`](super::DIALECTS) are named by path jobs and known by the endings of their
/// files; one of a user's own is passed as `&Mine`. `truecut_plan::program::contract` (feature
/// `contract`) holds the tests that each must pass.
pub trait Dialect: Debug + Sync {
    /// Name in path jobs: `dialect = "jbi"`.
    fn name(&self) -> &'static str;
    /// What one of its files is called in sentences: "job", "module".
    fn noun(&self) -> &'static str;
    /// What its files are, with their endings: "an ABB module (.mod)".
    fn about(&self) -> &'static str;
    /// Endings of its files without the dot, at least one. Read in upper and lower case.
    fn extensions(&self) -> &'static [&'static str];
    /// Words in the names of the arms that are programmed in it, in small letters.
    fn makers(&self) -> &'static [&'static str] {
        &[]
    }
    /// Whether its controllers may be set to Japanese: comments are Shift-JIS then.
    fn may_be_japanese(&self) -> bool {
        false
    }
    /// What its controllers limit that no URDF says, and so is not checked.
    fn limits_note(&self) -> Option<&'static str> {
        None
    }
    /// How closely a program comes back that was written and read.
    fn resolution(&self) -> Resolution;
    /// How it holds the angle of a turntable.
    fn turntable(&self) -> TurntableUnit;
    /// Whether its files say where the base frame stands in the world.
    fn holds_base(&self) -> bool;
    /// Schema of the table of its options. No option is required by the schema: what writing needs
    /// and reading does not is for [`check`](Self::check).
    /// By default there are none.
    fn options(&self) -> Schema {
        schema_of::<NoOptions>()
    }
    /// Checks options before anything is written.
    ///
    /// # Errors
    /// The first option that is missing, or has a value that it must not have.
    fn check(&self, options: &Options) -> Result<(), OptionFault> {
        table::<NoOptions>(options).map(drop)
    }
    /// Checks a program's name before anything is planned.
    ///
    /// # Errors
    /// A name that the language does not take.
    fn check_name(&self, _name: &str) -> Result<(), ProgramErrorKind> {
        Ok(())
    }
    /// The robot's own tool under the name or number that the options give it.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    fn tool(&self, robot: &Robot, _options: &Options) -> Result<Tool, OptionFault> {
        Ok(Tool::of(robot, "wheel", 0))
    }
    /// Writes a program; of several files the first is the one to start.
    ///
    /// # Errors
    /// If the dialect cannot say the program, or the program contradicts itself.
    fn write(
        &self,
        program: &Program,
        robot: &Robot,
        settings: &Settings,
    ) -> Result<Vec<ProgramFile>, ProgramError>;
    /// Names of the jobs of their own into which a long program was split when it was written, by
    /// the text of its first file. By default a program is one file.
    fn parts(&self, _name: &str, _first_file: &str) -> Vec<String> {
        Vec::new()
    }
    /// Reads a program from `file` and those that it names.
    ///
    /// # Errors
    /// With file and line: what the dialect does not have, or the robot cannot reach.
    fn read(
        &self,
        file: &Path,
        text: &ReadText<'_>,
        robot: &Robot,
        frames: &Frames,
        settings: &Settings,
    ) -> Result<Program, ProgramError>;
}

/// Path jobs tell dialects apart by their names.
impl PartialEq for dyn Dialect {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// The table of a dialect that has no options of its own.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct NoOptions {}

/// A file of a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProgramFile {
    /// Name with its ending.
    pub name: String,
    pub text: String,
}

/// Frames of a program for dialects whose files do not hold them.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    pub tool: Tool,
    pub world_from_base: Isometry3<f64>,
}

/// What a dialect needs beside the program.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    pub options: Options,
    /// Pulses per degree of the turntable's motor.
    pub pulses_per_deg: Option<f64>,
    /// Speed of the turntable beside a move of the robot, share of its top speed.
    pub turntable_share: f64,
    /// Name or number of the digital output that runs the spindle.
    pub spindle_signal: Option<String>,
}

impl Default for Settings {
    /// No options, pulses not known, turntable at full speed, no signal for the spindle.
    fn default() -> Self {
        Self {
            options: Options::new(),
            pulses_per_deg: None,
            turntable_share: 1.0,
            spindle_signal: None,
        }
    }
}

/// Largest differences between a program and what is read of its files.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// Of the tool's place, m.
    pub position_m: f64,
    /// Of its attitude, rad.
    pub attitude_rad: f64,
    /// Of the turntable's angle, rad; with pulses, half of one may come on top.
    pub turntable_rad: f64,
    /// Of a speed on a line, m/s.
    pub speed_m_per_s: f64,
    /// Of the speed of a move by joints, share of the top speed.
    pub share: f64,
    /// Of a zone, m; `None` if the dialect tells only whether a point is stopped at.
    pub zone_m: Option<f64>,
    /// Whether zones that overlap come back smaller, so that they do not.
    pub parts_zones: bool,
}

/// How a dialect holds the angle of a turntable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TurntableUnit {
    Degrees,
    /// [`Settings::pulses_per_deg`] must be given.
    Pulses,
    /// Not at all.
    None,
}

/// Stands in every file that is written.
pub(super) const NOT_LOADED: &str = "not loaded on a controller";

impl Settings {
    /// The number of the spindle's output, for dialects that number them.
    pub(super) fn spindle_number(&self) -> Result<Option<u32>, OptionFault> {
        let number = |text: &String| {
            text.parse().map_err(|_| OptionFault::Value {
                key: "spindle_signal",
                value: format!("\"{text}\""),
                rule: "the number of an output".to_owned(),
            })
        };
        self.spindle_signal.as_ref().map(number).transpose()
    }
}

/// Options as the table that a dialect declares.
pub(super) fn table<T: DeserializeOwned + JsonSchema>(options: &Options) -> Result<T, OptionFault> {
    let schema = schema_of::<T>();
    let known = schema.get("properties").and_then(Value::as_object);
    let known: Vec<&str> =
        known.map_or_else(Vec::new, |of| of.keys().map(String::as_str).collect());
    if let Some(key) = options.keys().find(|key| !known.contains(&key.as_str())) {
        let known = match known.is_empty() {
            true => "none".to_owned(),
            false => known.join(", "),
        };
        let key = key.clone();
        return Err(OptionFault::Unknown { key, known });
    }
    serde_json::from_value(Value::Object(options.clone()))
        .map_err(|error| OptionFault::Table(error.to_string()))
}

/// Schema of a dialect's table of options, without references.
pub(super) fn schema_of<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::default().with(|settings| settings.inline_subschemas = true);
    settings.into_generator().into_root_schema_for::<T>()
}
