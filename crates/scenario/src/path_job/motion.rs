//! The tables `[symmetry]`, `[[taught]]` and `[program]`.

use std::path::Path;

use nalgebra::Unit;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde_json::{Value, json};
use truecut_plan::program::{
    DIALECTS, Dialect, OptionFault, Options, ProgramSetup, Settings, TurntableUnit, dialect_named,
};
use truecut_plan::surface_path::{Symmetry, TaughtFile, TaughtWhen};

use super::tables::place;
use crate::check::Check;
use crate::fault::Fault;
use crate::units::{from_deg, from_mm};

/// What brings the copies to the wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum CarriedBy {
    /// The arm goes to each copy.
    Arm,
    /// A turntable brings each copy to where the first one was.
    Turntable,
}

/// Copies of the face about an axis.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SymmetryTable {
    /// Number of copies, the first included.
    #[schemars(range(min = 2, max = 1000), extend("x-rule" = "a part that stands alone has no symmetry"))]
    count: usize,
    /// A point of the axis, world.
    centre_mm: [f64; 3],
    /// Direction of the axis, world, of any length but zero. Copies follow one another right-handed
    /// about it. Default: [0, 0, 1].
    axis: Option<[f64; 3]>,
    /// What brings the copies to the wheel.
    carried_by: CarriedBy,
    /// Pulses per degree of the turntable; jobs hold its angle in pulses.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "pulses count up with the axis"))]
    pulses_per_deg: Option<f64>,
}

/// Postures recorded on the arm.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct TaughtTable {
    /// CSV file with a column j1, j2, … for each joint (degrees; mm for prismatic joints), relative
    /// to this file.
    file: String,
    /// Played before or after the lines of each copy.
    when: TaughtWhen,
}

/// The robot program.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(transform = with_options)]
pub(super) struct ProgramTable {
    /// The language.
    #[schemars(schema_with = "names")]
    dialect: String,
    /// Name of the program, and of its file.
    name: String,
    /// A remark in its head. Default: none.
    comment: Option<String>,
    /// Speed of moves by joints, a fraction of the top speed. Default: 0.25.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0, "x-rule" = "a fraction of the top speed"))]
    joint_speed: Option<f64>,
    /// Largest motion of one joint from point to point on a line. Default: 10.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "joints move along a line"))]
    largest_step_deg: Option<f64>,
    /// Where the controller's base frame stands in the world. Default: [0, 0, 0].
    base_xyz_mm: Option<[f64; 3]>,
    /// Its roll, pitch and yaw. Default: [0, 0, 0].
    base_rpy_deg: Option<[f64; 3]>,
    /// The dialect's own options; its schema is part of this one.
    #[serde(flatten)]
    #[schemars(skip)]
    options: Options,
}

/// Names of all dialects.
fn names(_: &mut SchemaGenerator) -> Schema {
    let one = |dialect: &&dyn Dialect| json!({ "const": dialect.name(), "type": "string", "description": dialect.about() });
    let all: Vec<Value> = DIALECTS.iter().map(one).collect();
    json_schema!({ "oneOf": all })
}

/// Adds the options of all dialects.
fn with_options(schema: &mut Schema) {
    let own = schema.ensure_object();
    own.insert("additionalProperties".to_owned(), Value::Bool(false));
    let keys = own.get_mut("properties").and_then(Value::as_object_mut);
    let options = DIALECTS.iter().map(|dialect| properties(*dialect));
    if let Some(keys) = keys {
        keys.extend(options.flatten());
    }
}

/// A dialect's options: key and schema.
fn properties(dialect: &dyn Dialect) -> Options {
    let schema = dialect.options();
    let keys = schema.get("properties").and_then(Value::as_object);
    keys.cloned().unwrap_or_default()
}

impl SymmetryTable {
    pub(super) fn resolve(&self, check: &mut Check) -> Symmetry {
        let axis = self.axis.unwrap_or([0.0, 0.0, 1.0]);
        check.direction("symmetry.axis", axis);
        if self.carried_by == CarriedBy::Arm {
            let because = "carried_by = \"arm\" needs no turntable";
            check.ignored("symmetry", &["pulses_per_deg"], because);
        }
        Symmetry {
            count: self.count,
            centre_m: self.centre_mm.map(from_mm).into(),
            axis: Unit::new_normalize(axis.into()),
            turntable: self.carried_by == CarriedBy::Turntable,
        }
    }

    /// Pulses per degree of the turntable, if there is one and if they are given.
    pub(super) fn turntable(&self) -> Option<Option<f64>> {
        (self.carried_by == CarriedBy::Turntable).then_some(self.pulses_per_deg)
    }
}

impl TaughtTable {
    pub(super) fn resolve(self, folder: &Path) -> TaughtFile {
        TaughtFile {
            file: folder.join(self.file),
            when: self.when,
        }
    }
}

impl ProgramTable {
    /// `None` after recording a fault. `turntable` holds the pulses of a turntable, if there is
    /// one.
    pub(super) fn resolve(
        self,
        turntable: Option<Option<f64>>,
        check: &mut Check,
    ) -> Option<ProgramSetup> {
        // The schema knows the names of dialects only.
        let dialect = dialect_named(&self.dialect)?;
        refuse_foreign_options(dialect, check);
        check_turntable(dialect, turntable, check);
        let (own, mut options) = (properties(dialect), self.options);
        options.retain(|key, _| own.contains_key(key));
        if let Err(fault) = dialect.check(&options) {
            refuse_option(dialect, fault, check);
            return None;
        }
        let joint_share = self.joint_speed.unwrap_or(0.25);
        Some(ProgramSetup {
            name: self.name,
            comment: self.comment.unwrap_or_default(),
            dialect,
            settings: Settings {
                options,
                pulses_per_deg: turntable.flatten(),
                turntable_share: joint_share,
                spindle_signal: None,
            },
            joint_share,
            largest_step_rad: from_deg(self.largest_step_deg.unwrap_or(10.0)),
            world_from_base: place(self.base_xyz_mm, self.base_rpy_deg),
        })
    }
}

/// Refuses options that only other dialects have.
fn refuse_foreign_options(dialect: &dyn Dialect, check: &mut Check) {
    let own = properties(dialect);
    let others = DIALECTS.iter().filter(|one| one.name() != dialect.name());
    let foreign: Options = others.flat_map(|one| properties(*one)).collect();
    let foreign = foreign.keys().filter(|key| !own.contains_key(*key));
    let foreign: Vec<&str> = foreign.map(String::as_str).collect();
    let because = format!("dialect = \"{}\" has no such thing", dialect.name());
    check.ignored("program", &foreign, &because);
}

/// Asks for a turntable's pulses where the dialect writes them, and refuses them where it does not.
fn check_turntable(dialect: &dyn Dialect, turntable: Option<Option<f64>>, check: &mut Check) {
    match (dialect.turntable(), turntable) {
        (TurntableUnit::Pulses, Some(pulses)) => {
            let who = format!("a {} with a turntable", dialect.noun());
            check.needed("symmetry", "pulses_per_deg", pulses, &who);
        }
        (TurntableUnit::Pulses | TurntableUnit::None, None) => {}
        (TurntableUnit::None, Some(_)) => {
            let name = dialect.name();
            let message = format!(
                "`carried_by` is \"turntable\", but dialect = \"{name}\" moves none: \"arm\" goes to \
                 each copy"
            );
            check.refuse(Fault::value("symmetry.carried_by", message, "no turntable"));
        }
        (TurntableUnit::Degrees, _) => {
            let name = dialect.name();
            let because = format!("dialect = \"{name}\" holds the turntable's angle in degrees");
            check.ignored("symmetry", &["pulses_per_deg"], &because);
        }
    }
}

fn refuse_option(dialect: &dyn Dialect, fault: OptionFault, check: &mut Check) {
    match fault {
        OptionFault::Missing { key } => {
            let who = format!("dialect = \"{}\"", dialect.name());
            check.needed::<()>("program", key, None, &who);
        }
        OptionFault::Value { key, value, rule } => {
            let label = format!("no {key}");
            let key = format!("program.{key}");
            let message = format!("`{key}` is {value}, but must be {rule}");
            check.refuse(Fault::value(&key, message, label));
        }
        OptionFault::Unknown { key, known } => {
            let message = format!("`{key}` is none of its options, which are {known}");
            check.refuse(Fault::value(
                &format!("program.{key}"),
                message,
                "no such option",
            ));
        }
        OptionFault::Table(message) => {
            check.refuse(Fault::value("program", message, "here"));
        }
    }
}
