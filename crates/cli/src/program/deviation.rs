//! Deviations of a program from the path that it was written from.

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use truecut_plan::program::Program;
use truecut_recording::measured::Table;
use truecut_telemetry::read_table;

use crate::failure::Failure;

/// A path as `truecut path` writes it.
pub struct PathRows {
    file: PathBuf,
    rows: Vec<PathRow>,
}

struct PathRow {
    point: usize,
    world_from_tool: Isometry3<f64>,
    posture_rad: Vec<f64>,
}

/// Largest deviations.
#[derive(Default)]
pub struct Deviation {
    pub position_m: Largest,
    pub attitude_rad: Largest,
    pub joint_rad: Largest,
}

/// The largest of values, and the path point that it belongs to.
#[derive(Default)]
pub struct Largest {
    pub value: f64,
    pub at: usize,
}

impl Largest {
    fn take(&mut self, value: f64, at: usize) {
        if value > self.value {
            *self = Largest { value, at };
        }
    }
}

/// Reads the columns point, x_mm … z_mm, qw … qz and j1 … of a path.
pub fn path_of(path: &Path, joints: usize) -> Result<PathRows, Failure> {
    let failed = |text: String| Failure::at(path, text);
    let table: Table =
        read_table(path, true).map_err(|error| Failure::message(error.to_string()))?;
    let names: Vec<String> = ["point", "x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz"]
        .map(str::to_owned)
        .into_iter()
        .chain((1..=joints).map(|j| format!("j{j}")))
        .collect();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for name in &names {
        columns.push(column(&table, name).map_err(&failed)?);
    }
    let count = columns[0].len();
    let rows = (0..count).map(|k| {
        let of = |column: usize| columns[column][k];
        let rotation = Quaternion::new(of(4), of(5), of(6), of(7));
        PathRow {
            point: of(0) as usize,
            world_from_tool: Isometry3::from_parts(
                Translation3::new(of(1) * 1e-3, of(2) * 1e-3, of(3) * 1e-3),
                UnitQuaternion::from_quaternion(rotation),
            ),
            posture_rad: (8..names.len()).map(|c| of(c).to_radians()).collect(),
        }
    });
    Ok(PathRows {
        file: path.to_owned(),
        rows: rows.collect(),
    })
}

fn column(table: &Table, name: &str) -> Result<Vec<f64>, String> {
    let values = table.column(name).map_err(|error| error.to_string())?;
    match values.iter().position(|value| !value.is_finite()) {
        Some(row) => Err(format!(
            "column \"{name}\", row {}: {} is not a finite number",
            row + 1,
            values[row]
        )),
        None => Ok(values.to_vec()),
    }
}

impl Deviation {
    /// Compares path points of equal number.
    pub fn of(program: &Program, path: &PathRows) -> Result<Deviation, Failure> {
        if program.moves.len() != path.rows.len() {
            let (rows, moves) = (path.rows.len(), program.moves.len());
            let text = format!(
                "{rows} path points, but the program has {moves} moves; it is the path of another \
                 program"
            );
            return Err(Failure::at(&path.file, text));
        }
        let mut worst = Deviation::default();
        for (step, row) in program.moves.iter().zip(&path.rows) {
            if step.path_point != row.point {
                let (found, wanted) = (row.point, step.path_point);
                let text = format!("path point {found} stands where the program has {wanted}");
                return Err(Failure::at(&path.file, text));
            }
            let pose = program.world_from_base * step.base_from_tool;
            let wanted = &row.world_from_tool;
            let apart_m = (pose.translation.vector - wanted.translation.vector).norm();
            let apart_rad = pose.rotation.angle_to(&wanted.rotation);
            let joints = step.posture.iter().zip(&row.posture_rad);
            let joint_rad = joints.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            worst.position_m.take(apart_m, step.path_point);
            worst.attitude_rad.take(apart_rad, step.path_point);
            worst.joint_rad.take(joint_rad, step.path_point);
        }
        Ok(worst)
    }
}
