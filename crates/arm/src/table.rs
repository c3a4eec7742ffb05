//! Tables of postures, with forward kinematics, and of poses.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use truecut_files::{CellRow, Cells};

use crate::error::{ArmError, ArmErrorKind};
use crate::model::{FrameId, JointKind, Robot};

/// Flange poses for postures given as CSV ([`Cells`]): one row per posture, joint coordinates in
/// chain order, rad or m; a column whose heading ends in `_deg` or `_mm` is in that unit. Where the
/// heading names the joints (`j1_deg`, or their own names) among other columns, these alone are
/// read, and without a unit they are in degrees and mm: so `path.csv`, taught points and what
/// [`ik_csv`](crate::report::ik_csv) writes serve, too. Empty rows and rows that start with `#` are
/// skipped.
///
/// The answer is CSV with a heading: position x, y, z (m) and the rotation matrix row by row, world
/// from flange, each number in the shortest form that reads back exactly.
///
/// # Errors
/// Names the row, the value's place in it (both from 1) and the joint of the value that is not a
/// finite number, or the wrong count; a table without any posture.
pub fn fk_table(robot: &Robot, postures_csv: &str) -> Result<String, ArmError> {
    let mut out = csv::Writer::from_writer(Vec::new());
    out.write_record(HEAD).expect(IN_MEMORY);
    for (_, q) in postures(robot, postures_csv)? {
        let pose = robot.world_from_frame(&q, FrameId::Flange);
        let matrix = pose.rotation.to_rotation_matrix();
        let position = pose.translation.vector;
        let rows = matrix.matrix().transpose();
        let numbers = position.iter().chain(rows.iter()).map(|v| format!("{v:?}"));
        out.write_record(numbers).expect(IN_MEMORY);
    }
    let bytes = out.into_inner().expect(IN_MEMORY);
    Ok(String::from_utf8(bytes).expect("numbers are text"))
}

/// What must be told of a table as [`fk_table`] reads it: the first value outside a joint's limits,
/// and how many rows have such values. Degrees read as radians lie outside, nearly always.
///
/// # Errors
/// As [`fk_table`].
pub fn outside_limits_note(robot: &Robot, postures_csv: &str) -> Result<Option<String>, ArmError> {
    let all = postures(robot, postures_csv)?;
    let outside = all.iter().filter_map(|(row, q)| {
        let error = robot.check_posture(q).err()?;
        Some((*row, error))
    });
    let outside: Vec<(usize, ArmError)> = outside.collect();
    Ok(outside.first().map(|(row, error)| {
        // A joint that follows others has no value of its own.
        let place = match error.kind() {
            ArmErrorKind::OutsideLimits { joint, .. } => {
                let joints = &robot.chain.joints;
                joints.iter().position(|one| one.name == *joint)
            }
            _ => None,
        };
        let place = place.map_or_else(String::new, |index| format!(", value {}", index + 1));
        format!(
            "row {row}{place}: {}; {} of {} rows are outside limits. Postures are read in rad and m; \
             a heading such as j1_deg or j1_mm gives the unit of its column",
            error.message(),
            outside.len(),
            all.len()
        )
    }))
}

/// Characters of a row without numbers that are told: it may be a file of anything.
const MOST_TOLD: usize = 100;

/// Postures of a table with their rows, rad and m.
fn postures(robot: &Robot, csv: &str) -> Result<Vec<(usize, Vec<f64>)>, ArmError> {
    let joints = robot.dof();
    let table = Table::of(csv)?;
    let names: Vec<&str> = (robot.chain.joints.iter())
        .map(|joint| joint.name.as_str())
        .collect();
    let rows = match table.of_joints(robot) {
        Some(columns) => table.numbers(&columns, &names)?,
        None => table
            .all_numbers(&names)
            .map_err(|error| table.unnamed(&names, robot, error))?,
    };
    if rows.is_empty() {
        let only = match table.heading() {
            [] => String::new(),
            heading => {
                let told: String = heading.join(", ").chars().take(MOST_TOLD).collect();
                format!(": its only row, \"{told}\", has no number")
            }
        };
        return Err(ArmErrorKind::NoPostures { joints, only }.into());
    }
    if let Some((row, other)) = rows.iter().find(|(_, q)| q.len() != joints) {
        let count = other.len();
        let which = match names.get(count) {
            Some(joint) => format!("none for joint \"{joint}\""),
            None => format!("value {} is of none", joints + 1),
        };
        let message = format!("{count} values, but the chain has {joints} joints: {which}");
        return Err(table.unnamed(&names, robot, fault(*row, message)));
    }
    Ok(rows)
}

/// Rows of a table. A first row without any number is a heading, which may give units: `_deg`,
/// `_mm`.
struct Table {
    cells: Cells,
    has_heading: bool,
}

/// A column that is read, and what its numbers are times to be in rad and m.
type Column = (usize, f64);

impl Table {
    fn of(text: &str) -> Result<Table, ArmError> {
        let cells = Cells::of(text).map_err(|error| fault(error.line, error.message))?;
        let is_none = |cell: &String| cells.number(cell).is_none();
        let first = cells.rows.first();
        let has_heading = first.is_some_and(|first| first.cells.iter().all(is_none));
        Ok(Table { cells, has_heading })
    }

    fn heading(&self) -> &[String] {
        match self.cells.rows.first() {
            Some(first) if self.has_heading => &first.cells,
            _ => &[],
        }
    }

    /// Columns of the joints by their names, or `j1`, `j2`, …, each with a unit or without, among
    /// others that are left aside; `None` where the heading does not name each of them once.
    fn of_joints(&self, robot: &Robot) -> Option<Vec<Column>> {
        let heading = self.heading();
        let joints = robot.chain.joints.iter().enumerate();
        let columns: Option<Vec<Column>> = joints
            .map(|(index, joint)| {
                let short = format!("j{}", index + 1);
                let own = heading.iter().enumerate().filter_map(|(column, cell)| {
                    let factor = [joint.name.as_str(), &short].iter().find_map(|name| {
                        match cell.strip_prefix(name)? {
                            // as taught points have them
                            "" if heading.len() > robot.dof() => Some(of_taught(joint.kind)),
                            "" | "_rad" | "_m" => Some(1.0),
                            "_deg" | "_mm" => Some(unit(cell)),
                            _ => None,
                        }
                    })?;
                    Some((column, factor))
                });
                let own: Vec<Column> = own.collect();
                match *own {
                    [one] => Some(one),
                    _ => None,
                }
            })
            .collect();
        columns
    }

    /// Numbers of the joints, which have these names, in their columns.
    fn numbers(
        &self,
        columns: &[Column],
        joints: &[&str],
    ) -> Result<Vec<(usize, Vec<f64>)>, ArmError> {
        self.each(|row| {
            let number = |(&(column, factor), joint): (&Column, &&str)| {
                Ok(self.number(row, column, Some(*joint))? * factor)
            };
            columns.iter().zip(joints).map(number).collect()
        })
    }

    /// Numbers of all columns. A row with one for each of the joints that are named has them in
    /// their order.
    fn all_numbers(&self, joints: &[&str]) -> Result<Vec<(usize, Vec<f64>)>, ArmError> {
        let units: Vec<f64> = self.heading().iter().map(|name| unit(name)).collect();
        self.each(|row| {
            let is_posture = row.cells.len() == joints.len();
            let number = |column: usize| {
                let unit = units.get(column).copied().unwrap_or(1.0);
                let joint = is_posture.then(|| joints[column]);
                Ok(self.number(row, column, joint)? * unit)
            };
            (0..row.cells.len()).map(number).collect()
        })
    }

    fn each(
        &self,
        read: impl Fn(&CellRow) -> Result<Vec<f64>, ArmError>,
    ) -> Result<Vec<(usize, Vec<f64>)>, ArmError> {
        let rows = self.cells.rows.iter().skip(usize::from(self.has_heading));
        rows.map(|row| Ok((row.line, read(row)?))).collect()
    }

    fn number(&self, row: &CellRow, column: usize, joint: Option<&str>) -> Result<f64, ArmError> {
        let cell = row.cells.get(column).map_or("", String::as_str);
        let found = self.cells.number(cell).filter(|it| it.is_finite());
        found.ok_or_else(|| {
            let of = joint.map_or_else(String::new, |joint| format!(" of joint \"{joint}\""));
            let place = column + 1;
            fault(
                row.line,
                format!("value {place}{of}, \"{cell}\", is not a finite number"),
            )
        })
    }

    /// The error of a table whose heading does not name the joints, told with what it has.
    fn unnamed(&self, joints: &[&str], robot: &Robot, error: ArmError) -> ArmError {
        let ArmErrorKind::PostureTable { row, message } = error.kind() else {
            return error;
        };
        let heading = self.heading();
        if heading.is_empty() {
            return error;
        }
        let slides = match robot.slides().count() {
            0 => "",
            _ => "; --slide-mm says where slides stand that the table has no columns for",
        };
        let message = format!(
            "{message}. The heading ({}) does not name each joint once: {}, or j1 to j{}{slides}",
            heading.join(", "),
            joints.join(", "),
            joints.len()
        );
        fault(*row, message)
    }
}

fn fault(row: usize, message: String) -> ArmError {
    ArmErrorKind::PostureTable { row, message }.into()
}

/// Of a coordinate in degrees or mm.
fn of_taught(kind: JointKind) -> f64 {
    match kind {
        JointKind::Revolute => 1_f64.to_radians(),
        JointKind::Prismatic => 1e-3,
    }
}

/// Of a column in rad and m, by the end of its name.
fn unit(name: &str) -> f64 {
    match name.rsplit_once('_') {
        Some((_, "deg")) => 1_f64.to_radians(),
        Some((_, "mm")) => 1e-3,
        _ => 1.0,
    }
}

/// Poses given as CSV ([`Cells`]): rows of six numbers, position (m) and roll, pitch, yaw (rad,
/// fixed axes x, y, z as in URDF), or of twelve, as [`fk_table`] gives them; a column whose heading
/// ends in `_deg` or `_mm` is in that unit.
///
/// # Errors
/// Names the row (1-based): a count that is neither, a number that is none, a matrix that is no
/// rotation; a table without any pose.
pub fn poses(csv: &str) -> Result<Vec<Isometry3<f64>>, ArmError> {
    let mut found = Vec::new();
    for (row, numbers) in Table::of(csv)?.all_numbers(&[])? {
        let fault = |message: &str| {
            let message = message.to_owned();
            ArmError::from(ArmErrorKind::PostureTable { row, message })
        };
        let rotation = match numbers.len() {
            6 => UnitQuaternion::from_euler_angles(numbers[3], numbers[4], numbers[5]),
            12 => {
                let matrix = Matrix3::from_row_slice(&numbers[3..]);
                let off = (matrix.transpose() * matrix - Matrix3::identity()).norm();
                if off > ROTATION_TOLERANCE || matrix.determinant() < 0.0 {
                    return Err(fault("the nine last numbers are no rotation matrix"));
                }
                UnitQuaternion::from_matrix(&matrix)
            }
            _ => return Err(fault("a pose has 6 or 12 numbers")),
        };
        let position = Translation3::new(numbers[0], numbers[1], numbers[2]);
        found.push(Isometry3::from_parts(position, rotation));
    }
    if found.is_empty() {
        return Err(ArmErrorKind::NoPoses.into());
    }
    Ok(found)
}

/// What must be told of a table as [`poses`] reads it: the first pose that lies beyond the arm's
/// reach or has an angle of more than a whole turn. Millimetres and degrees read as metres and
/// radians are told so.
///
/// # Errors
/// As [`poses`].
pub fn other_units_note(robot: &Robot, csv: &str) -> Result<Option<String>, ArmError> {
    // Whatever the frame: from the first joint over all others to the tool and back.
    let chain = &robot.chain;
    let reach_m = 2.0 * (chain.reach_m() + robot.frames.flange_from_tool.translation.vector.norm());
    let turns = chain
        .joints
        .iter()
        .all(|joint| joint.kind == JointKind::Revolute);
    let first = chain.joints.first();
    let foot_m = first.map_or_else(Vector3::zeros, |it| it.parent_from_joint.translation.vector);
    let units = "poses are read in m and rad; a heading such as x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg \
                 gives other units";
    for (row, numbers) in Table::of(csv)?.all_numbers(&[])? {
        let off_m = match numbers.as_slice() {
            [x, y, z, ..] => (Vector3::new(*x, *y, *z) - foot_m).norm(),
            _ => 0.0,
        };
        if turns && off_m > reach_m {
            return Ok(Some(format!(
                "row {row} lies {off_m:.3} m from the first joint, beyond any reach of this arm; {units}"
            )));
        }
        let angles = if numbers.len() == 6 {
            &numbers[3..]
        } else {
            &[]
        };
        if let Some(angle) = angles.iter().find(|angle| angle.abs() > TAU) {
            return Ok(Some(format!(
                "row {row} has an angle of {angle} rad, more than a whole turn; {units}"
            )));
        }
    }
    Ok(None)
}

/// How far a matrix may be from a rotation: that of numbers rounded to six digits.
const ROTATION_TOLERANCE: f64 = 1e-5;

const HEAD: [&str; 12] = [
    "x_m", "y_m", "z_m", "r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33",
];
pub(crate) const IN_MEMORY: &str = "memory can be written to";
