//! Tables of loads and displacements, as rows in SI and world axes.

use nalgebra::{Matrix3, Vector3, Vector6};
use truecut_recording::Unit;
use truecut_recording::measured::{LARGEST, Table, Term, formula};
use truecut_scenario::identification::{StiffnessQuantity, StiffnessSpec};
use truecut_sim::elastic::ElasticArm;

use super::{IdentifyError, at_row, place};

/// One loading.
#[derive(Debug, Clone)]
pub struct Loading {
    /// Its line in the file.
    pub place: String,
    /// Index of its posture, in the order of the file.
    pub posture: usize,
    /// Commanded joint coordinates, rad and m.
    pub command: Vec<f64>,
    /// Force and moment on the arm, world axes.
    pub wrench: Vector6<f64>,
    /// Rotation from the axes of `answers` to the world.
    pub world_from_axes: Matrix3<f64>,
    /// Index (displacements 0 to 2, rotations 3 to 5) and value of each measured component.
    pub answers: Vec<(usize, f64)>,
}

/// Loadings, and the noise of the measurements.
#[derive(Debug, Clone)]
pub struct Readings {
    /// The file.
    pub source: String,
    /// The rows.
    pub loadings: Vec<Loading>,
    /// Number of postures.
    pub postures: usize,
    /// Known standard deviations by component.
    pub noise: [Option<f64>; 6],
}

/// Postures that differ by less than this, rad or m, are the same: encoders resolve more.
const SAME_POSTURE: f64 = 1e-6;

/// The key that names the columns.
fn key_of(table: &str, terms: &[Term]) -> String {
    match terms {
        [one] if one.factor == 1.0 => format!("{table}.column"),
        _ => format!("{table}.sum"),
    }
}

/// Reads the rows of a table.
///
/// # Errors
/// A missing column, a load or posture that is no number, a posture outside the limits.
pub fn readings(
    table: &Table,
    spec: &StiffnessSpec,
    arm: &ElasticArm,
) -> Result<Readings, IdentifyError> {
    let joints = arm.joints();
    let mut columns = Vec::new();
    let mut noise = [None; 6];
    for (index, column) in spec.columns.iter().enumerate() {
        let key = format!("stiffness.column.{index}");
        let values = (table.combined(&column.terms))
            .map_err(|error| IdentifyError::new(key_of(&key, &column.terms), error))?;
        match column.quantity {
            StiffnessQuantity::Joint(joint) => {
                check_joint(&joints, joint, column.unit.unit, &key)?;
            }
            StiffnessQuantity::Displacement(axis) => noise[axis] = column.noise,
            StiffnessQuantity::Rotation(axis) => noise[3 + axis] = column.noise,
            _ => {}
        }
        columns.push((column, values, key));
    }
    let mut found = Readings {
        source: table.source.clone(),
        loadings: Vec::new(),
        postures: 0,
        noise,
    };
    for row in 0..table.rows() {
        let mut command = arm.posture().to_vec();
        let (mut load, mut answers) = ([0.0; 6], Vec::new());
        for (column, values, key) in &columns {
            let value = (values[row] * column.scale + column.offset) * column.unit.si_factor;
            if !value.is_finite() && !column.quantity.is_answer() {
                let message = format!(
                    "column \"{}\" holds no number, but postures and loads must be known",
                    formula(&column.terms)
                );
                return Err(at_row(table, row, key_of(key, &column.terms), message));
            }
            if value.abs() > LARGEST {
                let message = format!(
                    "column \"{}\" holds {:e}, which is no measurement: at most {LARGEST:e} in SI \
                     units",
                    formula(&column.terms),
                    values[row]
                );
                return Err(at_row(table, row, key_of(key, &column.terms), message));
            }
            match column.quantity {
                StiffnessQuantity::Joint(joint) => command[joint] = value,
                StiffnessQuantity::Force(axis) => load[axis] = value,
                StiffnessQuantity::Moment(axis) => load[3 + axis] = value,
                _ if !value.is_finite() => {}
                StiffnessQuantity::Displacement(axis) => answers.push((axis, value)),
                StiffnessQuantity::Rotation(axis) => answers.push((3 + axis, value)),
            }
        }
        found.push(table, row, spec, arm, (command, load, answers))?;
    }
    found.check_motion()?;
    Ok(found)
}

impl Readings {
    /// Refuses a table without any displacement.
    fn check_motion(&self) -> Result<(), IdentifyError> {
        let mut answers = self.loadings.iter().flat_map(|loading| &loading.answers);
        if answers.clone().count() == 0 || answers.any(|(_, value)| *value != 0.0) {
            return Ok(());
        }
        let message = format!(
            "{}: every displacement and rotation is 0, so that nothing was measured",
            self.source
        );
        Err(IdentifyError::new("stiffness.file", message))
    }

    fn push(
        &mut self,
        table: &Table,
        row: usize,
        spec: &StiffnessSpec,
        arm: &ElasticArm,
        (command, load, answers): (Vec<f64>, [f64; 6], Vec<(usize, f64)>),
    ) -> Result<(), IdentifyError> {
        (arm.check_posture(&command))
            .map_err(|error| at_row(table, row, "stiffness.file", error))?;
        let near = |other: &&Loading| {
            let pairs = other.command.iter().zip(&command);
            pairs.fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) < SAME_POSTURE
        };
        let posture = match self.loadings.iter().find(near) {
            Some(known) => known.posture,
            None => {
                self.postures += 1;
                self.postures - 1
            }
        };
        let world_from_axes = arm.world_from_axes(&command, spec.axes);
        let turn = |from: usize| {
            world_from_axes * Vector3::new(load[from], load[from + 1], load[from + 2])
        };
        let (force, moment) = (turn(0), turn(3));
        self.loadings.push(Loading {
            place: place(table, row),
            posture,
            command,
            wrench: Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z),
            world_from_axes,
            answers,
        });
        Ok(())
    }
}

fn check_joint(
    joints: &[truecut_sim::elastic::ElasticJoint],
    joint: usize,
    unit: Unit,
    key: &str,
) -> Result<(), IdentifyError> {
    let Some(known) = joints.get(joint) else {
        let message = format!(
            "`{key}.channel` is joint {}, but the chain has {} joints",
            joint + 1,
            joints.len()
        );
        return Err(IdentifyError::new(format!("{key}.channel"), message));
    };
    let (wanted, kind) = if known.rotary {
        (Unit::Radian, "rotary")
    } else {
        (Unit::Metre, "prismatic")
    };
    if unit == wanted {
        return Ok(());
    }
    let accepted: Vec<&str> = wanted.accepted_symbols().collect();
    let message = format!(
        "`{key}.unit` is not a unit of joint `{}`, which is {kind}; accepted: {}",
        known.name,
        accepted.join(", ")
    );
    Err(IdentifyError::new(format!("{key}.unit"), message))
}
