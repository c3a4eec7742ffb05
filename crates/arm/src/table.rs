//! Forward kinematics of a table of postures, inverse kinematics of a table of poses.

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion};
use serde::Serialize;
use truecut_files::{CellRow, Cells};

use crate::error::{ArmError, ArmErrorKind};
use crate::ik_branches::BranchOptions;
use crate::model::{FrameId, Robot};
use crate::opw::ArmBranch;

/// Flange poses for postures given as CSV ([`Cells`]): one row per posture, joint coordinates in
/// chain order, rad or m; a column whose heading ends in `_deg` or `_mm` is in that unit. Empty
/// rows, rows that start with `#` and a first row without any number (a heading) are skipped.
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
    let rows = numbers(csv)?;
    if rows.is_empty() {
        return Err(ArmErrorKind::NoPostures { joints }.into());
    }
    if let Some((row, other)) = rows.iter().find(|(_, q)| q.len() != joints) {
        let message = format!("{} values; the chain has {joints} joints", other.len());
        return Err(ArmErrorKind::PostureTable { row: *row, message }.into());
    }
    Ok(rows)
}

/// Rows of numbers in rad and m, with their lines. A first row without any number is a heading,
/// which may give units: `_deg`, `_mm`.
fn numbers(text: &str) -> Result<Vec<(usize, Vec<f64>)>, ArmError> {
    let fault = |row, message| ArmError::from(ArmErrorKind::PostureTable { row, message });
    let cells = Cells::of(text).map_err(|error| fault(error.line, error.message))?;
    let is_none = |cell: &String| cells.number(cell).is_none();
    let heading = (cells.rows.first()).filter(|first| first.cells.iter().all(is_none));
    let units: Vec<f64> = heading.map_or_else(Vec::new, |heading| {
        heading.cells.iter().map(|name| unit(name)).collect()
    });
    let rows = cells.rows.iter().skip(usize::from(heading.is_some()));
    let one = |row: &CellRow| {
        let number = |(index, cell): (usize, &String)| {
            let found = cells.number(cell).filter(|it| it.is_finite());
            let found = found
                .ok_or_else(|| fault(row.line, format!("\"{cell}\" is not a finite number")))?;
            Ok(found * units.get(index).copied().unwrap_or(1.0))
        };
        let numbers = row.cells.iter().enumerate().map(number);
        Ok((row.line, numbers.collect::<Result<_, ArmError>>()?))
    };
    rows.map(one).collect()
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
    for (row, numbers) in numbers(csv)? {
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

/// All postures for each pose of `frame`, revolute joints in (−π, π]; see [`IkSolver::branches`].
///
/// [`IkSolver::branches`]: crate::IkSolver::branches
pub fn ik_rows(robot: &Robot, poses: &[Isometry3<f64>], frame: FrameId) -> Vec<IkRow> {
    let solver = robot.ik_solver(&BranchOptions::default());
    let mut rows = Vec::new();
    for (index, pose) in poses.iter().enumerate() {
        for posture in solver.branches(pose, frame) {
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
