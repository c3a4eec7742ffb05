//! A field on a surface in the viewer's terms: a grid of triangles with colours at its corners.

use super::store::{Logged, Store};
use nalgebra::Vector3;
use re_chunk::TimeColumn;
use re_sdk_types::archetypes::{Mesh3D, Points3D, Transform3D};
use re_sdk_types::components::{Color, Radius};
use truecut_recording::{Field, short_number, significant};

use super::camera::NARROW;
use super::shapes::{quaternion, translation};
use crate::display::shown_unit;

/// Below a field: its bar of colours, and how it is left.
pub(super) const SCALE: &str = "scale";
pub(super) const END: &str = "end";
/// Where the bar of colours begins and ends beside a field, in the field's longer side.
const BAR_GAP: f64 = 0.03;
const BAR: f64 = 0.07;
/// How wide half a number beside the bar is, in parts of the height of its view. The viewer hangs a
/// label below its point, its middle there.
const HALF_NUMBER: f64 = 0.085;
/// Where the texts above and below a field are, in its longer side.
const ABOVE: f64 = 1.1;
/// As [`ABOVE`].
const BELOW: f64 = -0.06;
/// How tall a view is that shows them, too, in the field's longer side.
pub(super) const WITH_TEXTS: f64 = 1.3;
/// A value larger than the full scale by more than rounding.
const BEYOND: f64 = 1.001;
/// Depths below this are shown in µm, m.
const SMALL_M: f64 = 1e-4;

/// From nothing to full scale: a map of even lightness steps, legible without colour vision
/// (viridis of matplotlib, five of its colours).
const COLOURS: [[f32; 3]; 5] = [
    [68.0, 1.0, 84.0],
    [59.0, 82.0, 139.0],
    [33.0, 145.0, 140.0],
    [94.0, 201.0, 98.0],
    [253.0, 231.0, 37.0],
];

/// Middle of a cell along one side, the outermost ones on the edge, so that the grid covers the
/// field.
fn place(cell: usize, cells: usize, size_m: f64) -> f32 {
    let at = match cell {
        0 => 0.0,
        last if last + 1 == cells => 1.0,
        inner => (inner as f64 + 0.5) / cells as f64,
    };
    (at * size_m) as f32
}

/// Corners of the grid: the field's own, or even ones over its rectangle.
fn positions(field: &Field) -> Vec<[f32; 3]> {
    let [columns, rows] = field.cells;
    if !field.vertices_m.is_empty() {
        let single = |vertex: &[f64; 3]| vertex.map(|value| value as f32);
        return field.vertices_m.iter().map(single).collect();
    }
    let row = |row: usize| {
        let y = place(row, rows, field.size_m[1]);
        (0..columns).map(move |column| [place(column, columns, field.size_m[0]), y, 0.0])
    };
    (0..rows).flat_map(row).collect()
}

/// Normals at the corners, square to the lines between their neighbours.
fn normals(positions: &[[f32; 3]], [columns, rows]: [usize; 2]) -> Vec<[f32; 3]> {
    let between =
        |from: usize, to: usize| Vector3::from(positions[to]) - Vector3::from(positions[from]);
    let normal = |corner: usize| {
        let (column, row) = (corner % columns, corner / columns);
        let at = |column: usize, row: usize| row * columns + column;
        let x = between(
            at(column.saturating_sub(1), row),
            at((column + 1).min(columns - 1), row),
        );
        let y = between(
            at(column, row.saturating_sub(1)),
            at(column, (row + 1).min(rows - 1)),
        );
        let normal = x.cross(&y).try_normalize(0.0);
        normal.unwrap_or(Vector3::z()).into()
    };
    (0..positions.len()).map(normal).collect()
}

/// Logs the grid and its bar of colours, once.
pub(super) fn begin(stream: &Store, entity: &str, field: &Field) -> Logged<()> {
    stream.log_static(entity, &grid(field))?;
    let pose = Transform3D::from_translation_rotation(
        translation(&field.world_from_field),
        quaternion(&field.world_from_field),
    );
    stream.log_static(entity, &pose)?;
    scale(stream, &format!("{entity}/{SCALE}"), field)?;
    numbers(stream, &format!("{entity}/{SCALE}"), field, None)
}

/// Logs how it is left, with its largest value: that may lie beyond the colours, whose scale was
/// laid down beforehand.
pub(super) fn end(stream: &Store, entity: &str, field: &Field, values: &[f32]) -> Logged<()> {
    let colours = values.iter();
    let colours = colours.map(|value| colour(f64::from(*value) / field.full_scale));
    let mesh = grid(field).with_vertex_colors(colours);
    stream.log_static(format!("{entity}/{END}"), &mesh)?;
    let finite = values.iter().filter(|value| value.is_finite());
    let largest = finite.map(|value| f64::from(*value)).reduce(f64::max);
    numbers(stream, &format!("{entity}/{SCALE}"), field, largest)
}

fn grid(field: &Field) -> Mesh3D {
    let [columns, rows] = field.cells;
    let positions = positions(field);
    let normals = normals(&positions, field.cells);
    let triangles = (0..rows.saturating_sub(1)).flat_map(|row| {
        (0..columns.saturating_sub(1)).flat_map(move |column| {
            let corner = (row * columns + column) as u32;
            let above = corner + columns as u32;
            [[corner, corner + 1, above + 1], [corner, above + 1, above]]
        })
    });
    Mesh3D::new(positions)
        .with_triangle_indices(triangles)
        .with_vertex_normals(normals)
}

/// Half the width of a number beside the bar, m.
fn half_number_m(field: &Field) -> f64 {
    let [length, width] = field.size_m;
    let (long, short) = (length.max(width), length.min(width));
    HALF_NUMBER * long.max((short + BAR * long) / NARROW)
}

/// How much room the bar and its numbers need beside a field, m.
pub(super) fn beside_m(field: &Field) -> f64 {
    BAR * field.size_m[0].max(field.size_m[1]) + 2.1 * half_number_m(field)
}

/// A place in a field's frame: along its longer side, in parts of it, and across.
fn along_longer(field: &Field, share: f64, side_m: f64) -> [f32; 3] {
    let [length, width] = field.size_m;
    let (along, across) = ((share * length.max(width)) as f32, side_m as f32);
    match length >= width {
        true => [along, across, 0.0],
        false => [across, along, 0.0],
    }
}

/// A bar of colours beside the longer side.
fn scale(stream: &Store, entity: &str, field: &Field) -> Logged<()> {
    let [length, width] = field.size_m;
    let (long, short) = (length.max(width), length.min(width));
    let (near, far) = (short + BAR_GAP * long, short + BAR * long);
    let place = |share: f64, side: f64| along_longer(field, share, side);
    let shares = (0..COLOURS.len()).map(|i| i as f64 / (COLOURS.len() - 1) as f64);
    let corners = shares
        .clone()
        .flat_map(|share| [place(share, near), place(share, far)]);
    let colours = shares.clone().flat_map(|share| [colour(share); 2]);
    let steps = 0..COLOURS.len() as u32 - 1;
    // Both ways round: it is seen from either side.
    let triangles = steps.flat_map(|step| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|corner| 2 * step + corner);
        [[a, b, c], [b, d, c], [a, c, b], [b, c, d]]
    });
    let bar = Mesh3D::new(corners)
        .with_triangle_indices(triangles)
        .with_vertex_colors(colours);
    stream.log_static(format!("{entity}/bar"), &bar)
}

/// The numbers of the bar; above the field its size, below it the largest value at the end.
fn numbers(stream: &Store, entity: &str, field: &Field, largest: Option<f64>) -> Logged<()> {
    let [length, width] = field.size_m;
    let (long, short) = (length.max(width), length.min(width));
    let beside = short + BAR * long + half_number_m(field);
    let unit = shown_unit(field.unit, field.full_scale < SMALL_M);
    let shown = |value: f64| format!("{} {}", significant(unit.from_si(value), 3), unit.symbol);
    let mut texts = vec![
        (0.0, beside, shown(0.0)),
        (0.5, beside, shown(0.5 * field.full_scale)),
    ];
    let mm = |side_m: f64| short_number(1e3 * side_m);
    let size = format!("{} × {} mm", mm(long), mm(short));
    texts.push((ABOVE, 0.5 * short, size));
    let is_beyond = largest.is_some_and(|largest| largest > BEYOND * field.full_scale);
    let end = if is_beyond { "≥ " } else { "" };
    texts.push((1.0, beside, format!("{end}{}", shown(field.full_scale))));
    if let Some(largest) = largest {
        let text = format!("at the end, up to {}", shown(largest));
        texts.push((BELOW, 0.5 * short, text));
    }
    let places = texts.iter();
    let places = places.map(|(share, side, _)| along_longer(field, *share, *side));
    let labels = Points3D::new(places)
        .with_labels(texts.iter().map(|(.., text)| text.as_str()))
        .with_colors([Color::from_rgb(235, 235, 235)])
        .with_radii([Radius::new_ui_points(0.0)])
        .with_show_labels(true);
    stream.log_static(format!("{entity}/numbers"), &labels)
}

/// Logs the colours of one time.
pub(super) fn colours(
    stream: &Store,
    entity: &str,
    field: &Field,
    time: TimeColumn,
    values: &[f32],
) -> Logged<()> {
    let colours = values
        .iter()
        .map(|value| colour(f64::from(*value) / field.full_scale));
    let columns = Mesh3D::update_fields()
        .with_vertex_colors(colours)
        .columns([values.len()])?;
    stream.send_columns(entity, [time], columns)
}

/// The colour of a share of the full scale.
fn colour(share: f64) -> Color {
    let share = if share.is_finite() {
        share.clamp(0.0, 1.0) as f32
    } else {
        0.0
    };
    let last = COLOURS.len() - 1;
    let at = share * last as f32;
    let below = (at as usize).min(last - 1);
    let part = at - below as f32;
    let mix =
        |i: usize| (COLOURS[below][i] + part * (COLOURS[below + 1][i] - COLOURS[below][i])) as u8;
    Color::from_rgb(mix(0), mix(1), mix(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_go_from_the_first_to_the_last() {
        assert_eq!(colour(0.0), Color::from_rgb(68, 1, 84));
        assert_eq!(colour(0.25), Color::from_rgb(59, 82, 139));
        assert_eq!(colour(7.0), Color::from_rgb(253, 231, 37));
        assert_eq!(colour(f64::NAN), colour(0.0));
    }

    /// A plane rectangle looks along z; a field with its own corners leans as they do.
    #[test]
    fn verify_normals_are_square_to_the_grid() {
        let mut field = Field {
            path: "depth".into(),
            world_from_field: truecut_recording::Pose::IDENTITY,
            size_m: [2.0, 1.0],
            cells: [3, 2],
            full_scale: 1.0,
            unit: truecut_recording::Unit::Metre,
            vertices_m: Vec::new(),
        };
        let flat = positions(&field);
        assert_eq!(flat.len(), 6);
        assert!(
            normals(&flat, field.cells)
                .iter()
                .all(|n| *n == [0.0, 0.0, 1.0])
        );
        field.vertices_m = (0..6)
            .map(|i| [f64::from(i % 3), f64::from(i / 3), f64::from(i % 3)])
            .collect();
        let half = 0.5_f32.sqrt();
        for normal in normals(&positions(&field), field.cells) {
            let off = [normal[0] + half, normal[1], normal[2] - half];
            assert!(off.iter().all(|value| value.abs() < 1e-6), "{normal:?}");
        }
    }

    #[test]
    fn the_grid_reaches_the_edges() {
        assert_eq!(place(0, 4, 2.0), 0.0);
        assert_eq!(place(1, 4, 2.0), 0.75);
        assert_eq!(place(3, 4, 2.0), 2.0);
    }
}
