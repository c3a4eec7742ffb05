//! Forward kinematics of a table of postures, inverse kinematics of a table of poses.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use serde::Serialize;
use truecut_files::{CellRow, Cells};

use crate::error::{ArmError, ArmErrorKind};
use crate::ik_branches::BranchOptions;
use crate::model::{FrameId, JointKind, Robot};
use crate::opw::ArmBranch;
use crate::turns::turned;

/// Flange poses for postures given as CSV ([`Cells`]): one row per posture, joint coordinates in
/// chain order, rad or m; a column whose heading ends in `_deg` or `_mm` is in that unit. Where the
/// heading names the joints (`j1_deg`, or their own names) among other columns, these alone are
/// read, and without a unit they are in degrees and mm: so `path.csv`, taught points and what
/// [`ik_csv`] writes serve, too. Empty rows and rows that start with `#` are skipped.
///
/// The answer is CSV with a heading: position x, y, z (m) and the rotation matrix row by row, world
/// from flange, each number in the shortest form that reads back exactly.
///
/// # Errors
/// Names the row (1-based) and the value that is not a finite number, or the wrong count; a table
/// without any posture.
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
        Some((*row, error.message()))
    });
    let outside: Vec<(usize, String)> = outside.collect();
    Ok(outside.first().map(|(row, message)| {
        format!(
            "row {row}: {message}; {} of {} rows are outside limits. Postures are read in rad and m; \
             a heading such as j1_deg or j1_mm gives the unit of its column",
            outside.len(),
            all.len()
        )
    }))
}

/// Postures of a table with their rows, rad and m.
fn postures(robot: &Robot, csv: &str) -> Result<Vec<(usize, Vec<f64>)>, ArmError> {
    let joints = robot.dof();
    let table = Table::of(csv)?;
    let rows = match table.of_joints(robot) {
        Some(columns) => table.numbers(&columns)?,
        None => table
            .all_numbers()
            .map_err(|error| table.unnamed(robot, error))?,
    };
    if rows.is_empty() {
        return Err(ArmErrorKind::NoPostures { joints }.into());
    }
    if let Some((row, other)) = rows.iter().find(|(_, q)| q.len() != joints) {
        let message = format!("{} values; the chain has {joints} joints", other.len());
        let error = ArmErrorKind::PostureTable { row: *row, message }.into();
        return Err(table.unnamed(robot, error));
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

    fn numbers(&self, columns: &[Column]) -> Result<Vec<(usize, Vec<f64>)>, ArmError> {
        self.each(|row| {
            let number = |&(column, factor): &Column| {
                let cell = row.cells.get(column).map_or("", String::as_str);
                Ok(self.number(row.line, cell)? * factor)
            };
            columns.iter().map(number).collect()
        })
    }

    fn all_numbers(&self) -> Result<Vec<(usize, Vec<f64>)>, ArmError> {
        let units: Vec<f64> = self.heading().iter().map(|name| unit(name)).collect();
        self.each(|row| {
            let number = |(index, cell): (usize, &String)| {
                let unit = units.get(index).copied().unwrap_or(1.0);
                Ok(self.number(row.line, cell)? * unit)
            };
            row.cells.iter().enumerate().map(number).collect()
        })
    }

    fn each(
        &self,
        read: impl Fn(&CellRow) -> Result<Vec<f64>, ArmError>,
    ) -> Result<Vec<(usize, Vec<f64>)>, ArmError> {
        let rows = self.cells.rows.iter().skip(usize::from(self.has_heading));
        rows.map(|row| Ok((row.line, read(row)?))).collect()
    }

    fn number(&self, line: usize, cell: &str) -> Result<f64, ArmError> {
        let found = self.cells.number(cell).filter(|it| it.is_finite());
        found.ok_or_else(|| fault(line, format!("\"{cell}\" is not a finite number")))
    }

    /// The error of a table whose heading does not name the joints, told with what it has.
    fn unnamed(&self, robot: &Robot, error: ArmError) -> ArmError {
        let ArmErrorKind::PostureTable { row, message } = error.kind() else {
            return error;
        };
        let heading = self.heading();
        if heading.is_empty() {
            return error;
        }
        let joints = robot.chain.joints.iter();
        let joints: Vec<&str> = joints.map(|joint| joint.name.as_str()).collect();
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
    for (row, numbers) in Table::of(csv)?.all_numbers()? {
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
    for (row, numbers) in Table::of(csv)?.all_numbers()? {
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

/// One posture for one pose.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IkRow {
    /// Number of the pose, from 1.
    pub pose: usize,
    /// Joint coordinates, rad or m.
    pub posture: Vec<f64>,
    pub within_limits: bool,
    /// Branch of an ortho-parallel arm with a spherical wrist, e.g. `front, upper, positive`;
    /// `None` for others.
    pub branch: Option<String>,
}

/// All postures for each pose of `frame`, revolute joints in (−π, π], or where that is out of
/// limits and a whole turn off it is not, there; see [`IkSolver::branches`].
///
/// [`IkSolver::branches`]: crate::IkSolver::branches
pub fn ik_rows(robot: &Robot, poses: &[Isometry3<f64>], frame: FrameId) -> Vec<IkRow> {
    let mut options = BranchOptions::default();
    if robot.dof() < 6 {
        // An arm of few joints reaches few attitudes: a pose that is written to seven digits lies
        // beside them.
        options.numeric.position_tolerance_m = 1e-8;
        options.numeric.angle_tolerance_rad = 1e-6;
    }
    let solver = robot.ik_solver(&options);
    let mut rows = Vec::new();
    for (index, pose) in poses.iter().enumerate() {
        let branches = solver.branches(pose, frame).into_iter();
        let postures = branches.map(|posture| least_turned(robot, posture));
        for posture in postures {
            let branch = solver.geometry().map(|geometry| {
                let ArmBranch {
                    shoulder,
                    elbow,
                    wrist,
                } = geometry.branch(&posture);
                format!("{shoulder:?} {elbow:?} {wrist:?}").to_lowercase()
            });
            rows.push(IkRow {
                pose: index + 1,
                within_limits: robot.check_posture(&posture).is_ok(),
                posture,
                branch,
            });
        }
    }
    rows
}

/// The posture, or the one within limits that is fewest whole turns off it, if it is beyond them
/// and there is one: a joint from −220 to 64 deg reaches by a turn what it does not beside 180 deg.
fn least_turned(robot: &Robot, posture: Vec<f64>) -> Vec<f64> {
    if robot.check_posture(&posture).is_ok() {
        return posture;
    }
    let off = |other: &Vec<f64>| -> f64 {
        let pairs = other.iter().zip(&posture);
        pairs.map(|(a, b)| (a - b).abs()).sum()
    };
    let within = turned(&robot.chain.joints, &posture).into_iter();
    let nearest = within.min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.unwrap_or(posture)
}

/// The rows as CSV with a heading.
pub fn ik_csv(robot: &Robot, rows: &[IkRow]) -> String {
    let mut out = csv::Writer::from_writer(Vec::new());
    let joints = robot.chain.joints.iter();
    let joints = joints.map(|joint| format!("{}_{}", joint.name, joint.kind.coordinate_unit()));
    let head = (["pose".to_owned()].into_iter()).chain(joints);
    let head = head.chain(["within_limits".to_owned(), "branch".to_owned()]);
    out.write_record(head).expect(IN_MEMORY);
    for row in rows {
        let values = row.posture.iter().map(|value| format!("{value:?}"));
        let last = [
            row.within_limits.to_string(),
            row.branch.clone().unwrap_or_default(),
        ];
        let cells = [row.pose.to_string()].into_iter().chain(values).chain(last);
        out.write_record(cells).expect(IN_MEMORY);
    }
    let bytes = out.into_inner().expect(IN_MEMORY);
    String::from_utf8(bytes).expect("numbers are text")
}

const HEAD: [&str; 12] = [
    "x_m", "y_m", "z_m", "r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33",
];
const IN_MEMORY: &str = "memory can be written to";
