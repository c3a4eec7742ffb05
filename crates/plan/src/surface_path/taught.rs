//! Taught points: postures recorded on the arm, in a CSV file.
//!
//! A heading with the columns `j1`, `j2`, … `jn`, then a row for each point, degrees (mm for
//! prismatic joints). Columns of other names are left aside, so that the `path.csv` of `truecut
//! path` serves, too.

use std::path::Path;

use truecut_arm::{Joint, JointKind, Robot};

use super::error::SurfacePathError;

/// Postures to be run through in turn.
#[derive(Debug, Clone, PartialEq)]
pub struct TaughtPoints {
    /// Joint coordinates, rad or m.
    pub postures: Vec<Vec<f64>>,
}

impl TaughtPoints {
    /// Reads a file for an arm.
    ///
    /// # Errors
    /// If the file cannot be read, its heading has not one column a joint, a row has not as many
    /// cells as the heading, a cell of a joint is not a finite number, a posture breaks the arm's
    /// limits, or there is no row.
    pub fn load(path: &Path, robot: &Robot) -> Result<Self, SurfacePathError> {
        let text = truecut_files::read_text(path).map_err(|e| SurfacePathError::Taught {
            file: path.display().to_string(),
            line: 0,
            message: format!("cannot read the file: {e}"),
        })?;
        Self::from_text(&text, path, robot)
    }

    /// As [`TaughtPoints::load`], from a text already read; errors name `path`.
    ///
    /// # Errors
    /// As [`TaughtPoints::load`].
    pub fn from_text(text: &str, path: &Path, robot: &Robot) -> Result<Self, SurfacePathError> {
        let fault = |line: u64, message: String| SurfacePathError::Taught {
            file: path.display().to_string(),
            line: line as usize,
            message,
        };
        let joints = robot.dof();
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .has_headers(false)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let mut postures = Vec::new();
        let mut heading: Option<(Vec<usize>, usize)> = None;
        for (index, record) in reader.records().enumerate() {
            let record = record.map_err(|e| fault(index as u64 + 1, e.to_string()))?;
            let line = record
                .position()
                .map_or(index as u64 + 1, csv::Position::line);
            let Some((columns, width)) = &heading else {
                let columns =
                    columns_of(&record, joints).map_err(|message| fault(line, message))?;
                heading = Some((columns, record.len()));
                continue;
            };
            if record.len() != *width {
                let found = record.len();
                return Err(fault(
                    line,
                    format!("{found} values; the heading has {width} columns"),
                ));
            }
            let mut posture = Vec::with_capacity(joints);
            for (joint, column) in robot.chain.joints.iter().zip(columns) {
                let cell = &record[*column];
                let value: Option<f64> = cell.parse().ok().filter(|v: &f64| v.is_finite());
                let Some(value) = value else {
                    let name = &joint.name;
                    return Err(fault(
                        line,
                        format!("\"{cell}\" for joint \"{name}\" is not a finite number"),
                    ));
                };
                posture.push(coordinate(joint.kind, value));
            }
            robot
                .check_posture(&posture)
                .map_err(|e| fault(line, e.message()))?;
            postures.push(posture);
        }
        if postures.is_empty() {
            return Err(fault(
                1,
                "no taught point; at least one row is needed".to_owned(),
            ));
        }
        Ok(Self { postures })
    }
}

/// Digits after the point of a coordinate that is written, degrees or mm.
const DIGITS: usize = 6;

/// A posture as cells of such a file, to a millionth of a degree (mm); a joint at its limit stays
/// within it.
pub fn joint_cells(robot: &Robot, posture: &[f64]) -> Vec<String> {
    let joints = robot.chain.joints.iter().zip(posture);
    let cell = |(joint, value): (&Joint, &f64)| {
        let written = |value: f64| match joint.kind {
            JointKind::Revolute => format!("{:.DIGITS$}", value.to_degrees()),
            JointKind::Prismatic => format!("{:.DIGITS$}", value * 1e3),
        };
        let is_inside = |text: &str| {
            let read = text.parse().map(|value| coordinate(joint.kind, value));
            (joint.limits.zip(read.ok()))
                .is_none_or(|(limits, read)| (limits.lower..=limits.upper).contains(&read))
        };
        let last_digit = coordinate(joint.kind, 0.1_f64.powi(DIGITS as i32));
        let around = [*value, value - last_digit, value + last_digit];
        let mut inside = around.into_iter().map(written).filter(|it| is_inside(it));
        inside.next().unwrap_or_else(|| written(*value))
    };
    joints.map(cell).collect()
}

/// A coordinate as the chain has it, of degrees or mm.
fn coordinate(kind: JointKind, value: f64) -> f64 {
    match kind {
        JointKind::Revolute => value.to_radians(),
        JointKind::Prismatic => value * 1e-3,
    }
}

/// Where the columns of the joints stand in a heading.
fn columns_of(heading: &csv::StringRecord, joints: usize) -> Result<Vec<usize>, String> {
    let names: Vec<String> = (1..=joints).map(|j| format!("j{j}")).collect();
    let at = |name: &String| {
        let mut found = (0..heading.len()).filter(|column| heading[*column] == **name);
        // A name that stands twice would leave open which column is meant.
        found.next().filter(|_| found.next().is_none())
    };
    let more = heading
        .iter()
        .any(|name| *name == format!("j{}", joints + 1));
    let columns: Option<Vec<usize>> = names.iter().map(at).collect();
    columns.filter(|_| !more).ok_or_else(|| {
        format!(
            "the heading is \"{}\"; the arm has {joints} joints, so it must have the columns \"{}\" \
             once each, and none of a further joint",
            heading.iter().collect::<Vec<_>>().join(","),
            names.join(",")
        )
    })
}
