//! Forward kinematics of a table of postures.

use crate::error::{ArmError, ArmErrorKind};
use crate::model::{FrameId, Robot};

/// Flange poses for postures given as CSV: one row per posture, joint coordinates in chain order
/// (rad or m) separated by commas. Empty rows, rows that start with `#` and a first row without any
/// number (a heading) are skipped.
///
/// The answer is CSV with a heading: position x, y, z (m) and the rotation matrix row by row, world
/// from flange, each number in the shortest form that reads back exactly.
///
/// # Errors
/// Names the row (1-based) and the value that is not a finite number, or the wrong count; a table
/// without any posture.
pub fn fk_table(robot: &Robot, postures_csv: &str) -> Result<String, ArmError> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let mut postures = 0;
    out.write_record(HEAD).expect(IN_MEMORY);
    for (i, row) in postures_csv.lines().enumerate() {
        let row = row.trim();
        let cells: Vec<_> = row.split(',').map(str::trim).collect();
        let heading = i == 0 && cells.iter().all(|cell| cell.parse::<f64>().is_err());
        if row.is_empty() || row.starts_with('#') || heading {
            continue;
        }
        let q = parse_row(&cells, i + 1, robot.dof())?;
        postures += 1;
        let pose = robot.world_from_frame(&q, FrameId::Flange);
        let matrix = pose.rotation.to_rotation_matrix();
        let position = pose.translation.vector;
        let rows = matrix.matrix().transpose();
        let numbers = position.iter().chain(rows.iter()).map(|v| format!("{v:?}"));
        out.write_record(numbers).expect(IN_MEMORY);
    }
    if postures == 0 {
        let joints = robot.dof();
        return Err(ArmErrorKind::NoPostures { joints }.into());
    }
    let bytes = out.into_inner().expect(IN_MEMORY);
    Ok(String::from_utf8(bytes).expect("numbers are text"))
}

const HEAD: [&str; 12] = [
    "x_m", "y_m", "z_m", "r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33",
];
const IN_MEMORY: &str = "memory can be written to";

fn parse_row(cells: &[&str], row: usize, joints: usize) -> Result<Vec<f64>, ArmError> {
    let fault = |message| ArmError::from(ArmErrorKind::PostureTable { row, message });
    if cells.len() != joints {
        let found = cells.len();
        return Err(fault(format!(
            "{found} values; the chain has {joints} joints"
        )));
    }
    let number = |cell: &&str| match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(fault(format!("\"{cell}\" is not a finite number"))),
    };
    cells.iter().map(number).collect()
}
