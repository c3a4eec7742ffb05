//! Poses in CSV: one row a point, the units in the names of the columns.

use std::path::Path;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{Attitude, CamPath, CamPoint, direction};
use crate::program::number::finite;
use crate::program::{ProgramError, ProgramErrorKind};

const PLACE: [&str; 3] = ["x_mm", "y_mm", "z_mm"];
const QUATERNION: [&str; 4] = ["qw", "qx", "qy", "qz"];
const TURNS: [&str; 3] = ["roll_deg", "pitch_deg", "yaw_deg"];
const AXIS: [&str; 3] = ["i", "j", "k"];
const FEED: &str = "feed_mm_per_s";

/// Reads poses.
///
/// # Errors
/// If a column is missing or the attitude is not given, and at values that are none.
pub(super) fn read(text: &str, file: &Path) -> Result<CamPath, ProgramError> {
    let at = |line: usize, kind| ProgramError::in_file(file, line, kind);
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let broken = |error: csv::Error| {
        let line = error.position().map_or(1, |place| place.line() as usize);
        let rule = "rows of as many cells as there are columns";
        at(line, ProgramErrorKind::value("the table", error, rule))
    };
    let heads = reader.headers().map_err(broken)?.clone();
    let column = |name: &str| heads.iter().position(|head| head == name);
    let all = |names: &[&str]| {
        names
            .iter()
            .map(|name| column(name))
            .collect::<Option<Vec<_>>>()
    };
    let missing = |what: &str| at(1, ProgramErrorKind::unexpected("the head", what));
    let place = all(&PLACE).ok_or_else(|| missing("one with the columns x_mm, y_mm, z_mm"))?;
    let feed = column(FEED).ok_or_else(|| missing("one with the column feed_mm_per_s"))?;
    let (turns, quaternion, axis) = (all(&TURNS), all(&QUATERNION), all(&AXIS));
    if turns.is_none() && quaternion.is_none() && axis.is_none() {
        return Err(missing(
            "one that gives the attitude: qw, qx, qy, qz, or roll_deg, pitch_deg, yaw_deg, or the \
             axis i, j, k;",
        ));
    }
    let mut path = CamPath::default();
    for row in reader.records() {
        let row = row.map_err(broken)?;
        let line = row.position().map_or(0, |place| place.line() as usize);
        let number = |column: usize| finite(&row[column], &heads[column]).map_err(|k| at(line, k));
        let numbers = |columns: &[usize]| {
            let each = columns.iter().map(|column| number(*column));
            each.collect::<Result<Vec<f64>, _>>()
        };
        let attitude = if let Some(columns) = &quaternion {
            let parts = numbers(columns)?;
            let q = Quaternion::new(parts[0], parts[1], parts[2], parts[3]);
            let (square, what) = (q.norm_squared(), "the sum of squares of qw to qz");
            ProgramErrorKind::unless((square - 1.0).abs() <= 1e-3, what, square, "1, to 1e-3")
                .map_err(|kind| at(line, kind))?;
            Attitude::Whole(UnitQuaternion::from_quaternion(q))
        } else if let Some(columns) = &turns {
            let parts = numbers(columns)?;
            let [roll, pitch, yaw] = [parts[0], parts[1], parts[2]].map(f64::to_radians);
            Attitude::Whole(UnitQuaternion::from_euler_angles(roll, pitch, yaw))
        } else {
            let parts = numbers(axis.as_deref().unwrap_or_default())?;
            let axis = direction(Vector3::from_column_slice(&parts));
            Attitude::Axis(axis.map_err(|kind| at(line, kind))?)
        };
        // An empty cell is a move in rapid traverse.
        let feed_m_per_s = match row[feed].is_empty() {
            true => None,
            false => {
                let mm_per_s = number(feed)?;
                ProgramErrorKind::unless(mm_per_s > 0.0, FEED, mm_per_s, "above zero")
                    .map_err(|kind| at(line, kind))?;
                Some(mm_per_s * 1e-3)
            }
        };
        ProgramErrorKind::unless_too_many(path.points.len() + 1).map_err(|kind| at(line, kind))?;
        path.points.push(CamPoint {
            line,
            place_m: Vector3::from_vec(numbers(&place)?) * 1e-3,
            attitude,
            feed_m_per_s,
            stops: false,
        });
    }
    Ok(path)
}
