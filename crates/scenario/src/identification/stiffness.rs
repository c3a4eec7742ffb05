//! The table `[stiffness]`: postures, loads and displacements.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_arm::FrameId;
use truecut_recording::measured::Term;
use truecut_recording::{Unit, UserUnit};

use crate::check::Check;
use crate::column::{check_scale, read_unit, read_unit_of, terms};
use crate::fault::Fault;

/// A table of load against deflection.
#[derive(Debug, Clone, PartialEq)]
pub struct StiffnessSpec {
    /// CSV or Parquet file.
    pub file: PathBuf,
    /// Whether the first row of a CSV file names the columns.
    pub header: bool,
    /// Frame at whose origin the load acts.
    pub loaded: FrameId,
    /// Frame whose displacement was measured.
    pub observed: FrameId,
    /// Axes of loads and displacements.
    pub axes: Axes,
    /// What displacements count from.
    pub zero: Zero,
    /// The columns that are used.
    pub columns: Vec<StiffnessColumn>,
}

/// One column that is used.
#[derive(Debug, Clone, PartialEq)]
pub struct StiffnessColumn {
    /// The columns that make it, at least one: their sum by factors, times `scale`, plus `offset`.
    pub terms: Vec<Term>,
    /// What it holds.
    pub quantity: StiffnessQuantity,
    /// Unit of `scale` times the columns' values, and of `offset`.
    pub unit: UserUnit,
    /// Factor on the column's values, or on their sum.
    pub scale: f64,
    /// What is added to them after that, in `unit`.
    pub offset: f64,
    /// Known standard deviation of its noise, SI.
    pub noise: Option<f64>,
}

/// What a column of a load-deflection table holds; axes are 0 to 2 for x to z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StiffnessQuantity {
    /// Coordinate that the controller shows, of a joint counted from 0.
    Joint(usize),
    /// Force on the arm.
    Force(usize),
    /// Moment on the arm.
    Moment(usize),
    /// Displacement of the frame's origin.
    Displacement(usize),
    /// Small rotation of the frame.
    Rotation(usize),
}

/// Axes that components are given in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Axes {
    /// The root of the URDF, z up.
    #[default]
    World,
    /// The tool frame in the posture of the measurement.
    Tool,
    /// X along the tool axis, Y horizontal.
    Process,
}

/// What displacements count from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Zero {
    /// From the arm in the same posture without the load.
    #[default]
    Unloaded,
    /// From a reading that is not known, one in each posture: positions of a tracker will do.
    Unknown,
}

/// Load against deflection.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct StiffnessTable {
    /// CSV or Parquet file, relative to this file; one row for each loading.
    file: String,
    /// Whether the first row of a CSV file names the columns. Default: true.
    header: Option<bool>,
    /// Frame at whose origin the load acts. Default: "tool".
    loaded: Option<FrameId>,
    /// Frame whose displacement was measured. Default: "tool".
    observed: Option<FrameId>,
    /// Axes of loads and displacements. Default: "world".
    axes: Option<Axes>,
    /// "unloaded": displacements count from the unloaded arm; "unknown": from a zero that is
    /// estimated for each posture. Default: "unloaded".
    zero: Option<Zero>,
    /// The columns that are used.
    #[schemars(length(min = 1))]
    column: Vec<ColumnTable>,
}

/// One column that is used.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ColumnTable {
    /// Name of the column, or its number from "1" on in a file without header. Either this or sum
    /// is needed.
    column: Option<String>,
    /// Columns with their factors, added up: `{ cell_1 = 49.2, cell_2 = -0.7 }`.
    sum: Option<BTreeMap<String, f64>>,
    /// What it holds: joint1.command, …, force_x, moment_x, displacement_x, rotation_x, and so for
    /// y and z.
    channel: String,
    /// Unit of the column, or of the sum, after `scale`.
    unit: String,
    /// Factor on the column or the sum. Default: 1.
    scale: Option<f64>,
    /// Added to it after `scale`, in `unit`. Default: 0.
    offset: Option<f64>,
    /// Known standard deviation of the noise of a displacement or rotation, in `unit`.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "noise has a size; leave it out if it is not known"))]
    noise: Option<f64>,
}

impl StiffnessTable {
    /// `None` after recording a fault.
    pub(super) fn resolve(self, folder: &Path, check: &mut Check) -> Option<StiffnessSpec> {
        let mut columns: Vec<StiffnessColumn> = Vec::new();
        for (index, table) in self.column.into_iter().enumerate() {
            let key = format!("stiffness.column.{index}");
            let channel = table.channel.clone();
            let Some(column) = table.resolve(&key, check) else {
                continue;
            };
            if columns.iter().any(|one| one.quantity == column.quantity) {
                let message = format!("is \"{channel}\", which another column is already");
                check.wrong(&key, "channel", message, "mapped twice");
            }
            columns.push(column);
        }
        check_complete(&columns, check);
        Some(StiffnessSpec {
            file: folder.join(self.file),
            header: self.header.unwrap_or(true),
            loaded: self.loaded.unwrap_or(FrameId::Tool),
            observed: self.observed.unwrap_or(FrameId::Tool),
            axes: self.axes.unwrap_or_default(),
            zero: self.zero.unwrap_or_default(),
            columns,
        })
    }
}

/// A load and an answer are needed; answers of different kinds or noise need weights.
fn check_complete(columns: &[StiffnessColumn], check: &mut Check) {
    let loads = |one: &&StiffnessColumn| one.quantity.is_load();
    let answers: Vec<&StiffnessColumn> = (columns.iter())
        .filter(|one| one.quantity.is_answer())
        .collect();
    for (found, what) in [
        (columns.iter().any(|one| loads(&one)), "force_* or moment_*"),
        (!answers.is_empty(), "displacement_* or rotation_*"),
    ] {
        if !found {
            let message = format!("no column of [stiffness] is a {what}: its effect is to be seen");
            check.refuse(Fault::key("stiffness", message, format!("no {what}")));
        }
    }
    let kinds = |unit| answers.iter().any(|one| one.unit.unit == unit);
    let given = answers.iter().filter(|one| one.noise.is_some()).count();
    let mixed = kinds(Unit::Metre) && kinds(Unit::Radian);
    if given < answers.len() && (given > 0 || mixed) {
        let because = if mixed {
            "displacements and rotations are weighed against each other by it"
        } else {
            "another column gives it"
        };
        let message = format!(
            "missing key `noise` in a column of [stiffness]: {because}, so that every measured \
             displacement and rotation must have one"
        );
        check.refuse(Fault::key("stiffness", message, "noise is missing"));
    }
}

impl ColumnTable {
    fn resolve(self, table: &str, check: &mut Check) -> Option<StiffnessColumn> {
        let scale = self.scale.unwrap_or(1.0);
        check_scale(table, "scale", scale, check);
        let terms = terms(self.column, self.sum, table, check);
        let Some(quantity) = StiffnessQuantity::parse(&self.channel) else {
            let message = format!(
                "is \"{}\", but must be joint1.command, joint2.command, …, or one of force_, moment_, \
                 displacement_, rotation_ with x, y or z",
                self.channel
            );
            check.wrong(table, "channel", message, "unknown channel");
            read_unit(&self.unit, table, "unit", check);
            return None;
        };
        let unit = read_unit_of(quantity.units(), &self.unit, table, "unit", check)?;
        if !quantity.is_answer() {
            check.ignored(
                table,
                &["noise"],
                "loads and postures are taken as they are",
            );
        }
        Some(StiffnessColumn {
            terms: terms?,
            quantity,
            scale,
            offset: self.offset.unwrap_or(0.0),
            noise: self.noise.map(|noise| noise * unit.si_factor),
            unit,
        })
    }
}

impl StiffnessQuantity {
    fn parse(text: &str) -> Option<StiffnessQuantity> {
        if let Some(number) = text
            .strip_prefix("joint")
            .and_then(|rest| rest.strip_suffix(".command"))
        {
            return Some(StiffnessQuantity::Joint(
                number.parse::<usize>().ok()?.checked_sub(1)?,
            ));
        }
        let (name, axis) = text.rsplit_once('_')?;
        let axis = ["x", "y", "z"].iter().position(|one| *one == axis)?;
        Some(match name {
            "force" => StiffnessQuantity::Force(axis),
            "moment" => StiffnessQuantity::Moment(axis),
            "displacement" => StiffnessQuantity::Displacement(axis),
            "rotation" => StiffnessQuantity::Rotation(axis),
            _ => return None,
        })
    }

    fn units(self) -> &'static [Unit] {
        match self {
            StiffnessQuantity::Joint(_) => &[Unit::Radian, Unit::Metre],
            StiffnessQuantity::Force(_) => &[Unit::Newton],
            StiffnessQuantity::Moment(_) => &[Unit::NewtonMetre],
            StiffnessQuantity::Displacement(_) => &[Unit::Metre],
            StiffnessQuantity::Rotation(_) => &[Unit::Radian],
        }
    }

    /// Force or moment.
    pub fn is_load(self) -> bool {
        matches!(
            self,
            StiffnessQuantity::Force(_) | StiffnessQuantity::Moment(_)
        )
    }

    /// Displacement or rotation.
    pub fn is_answer(self) -> bool {
        matches!(
            self,
            StiffnessQuantity::Displacement(_) | StiffnessQuantity::Rotation(_)
        )
    }
}
