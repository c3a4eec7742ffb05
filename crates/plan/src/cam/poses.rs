//! Poses in a table: one row a point, the units in the names of the columns.

use std::f64::consts::PI;
use std::path::Path;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use truecut_files::{CellRow, Cells};

use super::{Attitude, CamPath, CamPoint, checked_feed, direction};
use crate::program::number::finite;
use crate::program::{MOST_POINTS, ProgramError, ProgramErrorKind};

/// Columns of one quantity under the names that they may have, each with its unit in SI.
type Names<const N: usize> = &'static [([&'static str; N], f64)];

const PLACE: Names<3> = &[
    (["x_mm", "y_mm", "z_mm"], 1e-3),
    (["x_m", "y_m", "z_m"], 1.0),
];
const QUATERNION: Names<4> = &[(["qw", "qx", "qy", "qz"], 1.0)];
const TURNS: Names<3> = &[
    (["roll_deg", "pitch_deg", "yaw_deg"], PI / 180.0),
    (["roll_rad", "pitch_rad", "yaw_rad"], 1.0),
];
const AXIS: Names<3> = &[(["i", "j", "k"], 1.0)];
const FEED: Names<1> = &[
    (["feed_mm_per_s"], 1e-3),
    (["feed_mm_per_min"], 1e-3 / 60.0),
    (["feed_m_per_s"], 1.0),
];

/// Where the numbers of a quantity stand, and their unit in SI.
struct Columns<const N: usize> {
    at: [usize; N],
    unit: f64,
}

/// A row, with the names of its columns.
struct Row<'a> {
    table: &'a Cells,
    heads: &'a CellRow,
    row: &'a CellRow,
}

impl Row<'_> {
    fn numbers<const N: usize>(&self, of: &Columns<N>) -> Result<[f64; N], ProgramErrorKind> {
        let mut found = [0.0; N];
        for (number, &column) in found.iter_mut().zip(&of.at) {
            let cell = self.table.plain(&self.row.cells[column]);
            *number = of.unit * finite(&cell, &self.heads.cells[column])?;
        }
        Ok(found)
    }
}

fn columns<const N: usize>(heads: &CellRow, names: Names<N>) -> Option<Columns<N>> {
    let column = |name: &&str| heads.cells.iter().position(|head| head == name);
    names.iter().find_map(|(names, unit)| {
        let at: Vec<usize> = names.iter().map(&column).collect::<Option<_>>()?;
        Some(Columns {
            at: at.try_into().ok()?,
            unit: *unit,
        })
    })
}

/// Refuses a quantity that is given twice, under one name or in two units.
fn check_heads(heads: &CellRow) -> Result<(), ProgramErrorKind> {
    let groups = PLACE.iter().flat_map(|(names, _)| names).chain(
        (QUATERNION.iter().flat_map(|(names, _)| names))
            .chain(TURNS.iter().flat_map(|(names, _)| names))
            .chain(AXIS.iter().flat_map(|(names, _)| names))
            .chain(FEED.iter().flat_map(|(names, _)| names)),
    );
    let count = |name: &str| heads.cells.iter().filter(|head| *head == name).count();
    for name in groups {
        let rule = "given once";
        ProgramErrorKind::unless(count(name) <= 1, "the column", name, rule)?;
    }
    let once = |what: &str, given: usize| {
        let what = format!("the number of units of the {what}");
        ProgramErrorKind::unless(given <= 1, what, given, "1: one of them counts")
    };
    once("place", given(heads, PLACE))?;
    once("turns", given(heads, TURNS))?;
    once("feed", given(heads, FEED))?;
    let attitudes = [
        given(heads, QUATERNION),
        given(heads, TURNS),
        given(heads, AXIS),
    ];
    let attitudes: usize = attitudes.into_iter().sum();
    let rule = "1: qw to qz, or roll, pitch, yaw, or i, j, k";
    ProgramErrorKind::unless(
        attitudes <= 1,
        "the number of attitudes a row",
        attitudes,
        rule,
    )
}

/// Under how many of its names a quantity is given, one of its numbers at least.
fn given<const N: usize>(heads: &CellRow, names: Names<N>) -> usize {
    let is_head = |name: &&str| heads.cells.iter().any(|head| head == name);
    let any = |(names, _): &&([&'static str; N], f64)| names.iter().any(is_head);
    names.iter().filter(any).count()
}

/// How the tool stands, as a file gives it.
enum Stands {
    Quaternion(Columns<4>),
    Turns(Columns<3>),
    Axis(Columns<3>),
}

impl Stands {
    fn of(heads: &CellRow) -> Option<Stands> {
        (columns(heads, QUATERNION).map(Stands::Quaternion))
            .or_else(|| columns(heads, TURNS).map(Stands::Turns))
            .or_else(|| columns(heads, AXIS).map(Stands::Axis))
    }

    fn attitude(&self, row: &Row<'_>) -> Result<Attitude, ProgramErrorKind> {
        match self {
            Stands::Quaternion(columns) => {
                let [w, i, j, k] = row.numbers(columns)?;
                let q = Quaternion::new(w, i, j, k);
                let (square, what) = (q.norm_squared(), "the sum of squares of qw to qz");
                let is_one = (square - 1.0).abs() <= 1e-3;
                ProgramErrorKind::unless(is_one, what, square, "1, to 1e-3")?;
                Ok(Attitude::Whole(UnitQuaternion::from_quaternion(q)))
            }
            Stands::Turns(columns) => {
                let [roll, pitch, yaw] = row.numbers(columns)?;
                let turned = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
                Ok(Attitude::Whole(turned))
            }
            Stands::Axis(columns) => {
                let axis = Vector3::from(row.numbers(columns)?);
                direction(axis).map(Attitude::Axis)
            }
        }
    }
}

/// Reads poses.
///
/// # Errors
/// If a column is missing or the attitude is not given, and at values that are none.
pub(super) fn read(text: &str, file: &Path) -> Result<CamPath, ProgramError> {
    let at = |line: usize, kind| ProgramError::in_file(file, line, kind);
    let rule = "rows of as many cells as there are columns";
    refuse_too_many(text).map_err(|(line, kind)| at(line, kind))?;
    let table = Cells::of(text).map_err(|error| {
        at(
            error.line,
            ProgramErrorKind::value("the table", error.message, rule),
        )
    })?;
    let missing = |what: &str| at(1, ProgramErrorKind::unexpected("the head", what));
    let place_names = "one with the columns x_mm, y_mm, z_mm, or x_m, y_m, z_m";
    let heads = table.rows.first().ok_or_else(|| missing(place_names))?;
    check_heads(heads).map_err(|kind| at(heads.line, kind))?;
    let place = columns(heads, PLACE).ok_or_else(|| missing(place_names))?;
    let feed = columns(heads, FEED).ok_or_else(|| {
        missing("one with the column feed_mm_per_s, feed_mm_per_min or feed_m_per_s")
    })?;
    let stands = Stands::of(heads).ok_or_else(|| {
        missing(
            "one that gives the attitude: qw, qx, qy, qz, or roll_deg, pitch_deg, yaw_deg (or _rad), or the \
             axis i, j, k,",
        )
    })?;
    let mut path = CamPath::default();
    for row in &table.rows[1..] {
        let line = row.line;
        if row.cells.len() != heads.cells.len() {
            let found = format!("a row of {} cells", row.cells.len());
            return Err(at(line, ProgramErrorKind::value("the table", found, rule)));
        }
        let row = Row {
            table: &table,
            heads,
            row,
        };
        let point = point(&row, &place, &stands, &feed).map_err(|kind| at(line, kind))?;
        path.points.push(point);
    }
    Ok(path)
}

/// Refuses more rows than points are planned for, before they are taken apart.
fn refuse_too_many(text: &str) -> Result<(), (usize, ProgramErrorKind)> {
    let is_row = |(_, line): &(usize, &str)| !line.trim().is_empty() && !line.starts_with('#');
    let mut rows = text
        .lines()
        .enumerate()
        .filter(is_row)
        .skip(1 + MOST_POINTS);
    let Some((index, _)) = rows.next() else {
        return Ok(());
    };
    let count = MOST_POINTS + 1 + rows.count();
    ProgramErrorKind::unless_too_many(count).map_err(|kind| (index + 1, kind))
}

fn point(
    row: &Row<'_>,
    place: &Columns<3>,
    stands: &Stands,
    feed: &Columns<1>,
) -> Result<CamPoint, ProgramErrorKind> {
    // An empty cell is a move in rapid traverse.
    let [column] = feed.at;
    let feed_m_per_s = if row.row.cells[column].is_empty() {
        None
    } else {
        let [m_per_s] = row.numbers(feed)?;
        let given = &row.row.cells[column];
        let name = &row.heads.cells[column];
        Some(checked_feed(name, given, m_per_s)?)
    };
    Ok(CamPoint {
        line: row.row.line,
        place_m: Vector3::from(row.numbers(place)?),
        attitude: stands.attitude(row)?,
        feed_m_per_s,
        stops: false,
    })
}
