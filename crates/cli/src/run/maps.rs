//! What a run leaves on faces, for its page: maps from above, and the cell and the part in space.

use truecut::Shown;
use truecut_recording::{Field, PartMesh, Unit};

use crate::figure::{ColourScale, Figure, Layer, Legend, Panel};
use crate::page::{Page, Space};

/// Most cells of a drawn map along a side: more would not be told apart on a screen.
const CELLS: usize = 140;
/// Share of what is left on a part that its colours hold: single corners would pale all others.
const SHARE: f64 = 0.99;

/// Adds what was seen of the run.
pub fn add(page: &mut Page, shown: &Shown, part: Option<&PartMesh>) {
    let fields = || {
        let fields = shown.scene.fields.iter().zip(&shown.fields);
        fields.filter(|(field, values)| values.len() == field.cells[0] * field.cells[1])
    };
    let left = part.map(left_scale);
    let maps = fields().map(|(field, values)| figure(field, values));
    let floor = part.zip(left.as_ref());
    let floor = floor.and_then(|(part, scale)| floor_figure(part, scale));
    page.figures("Maps", maps.chain(floor));
    if let Some((part, scale)) = part.zip(left) {
        page.space(
            "The part as it is left",
            Space::of_part(
                "Walls and floors by the material left beyond what was meant",
                part,
                scale,
            ),
        );
    }
    let mut space = Space::of_scene("The cell", &shown.scene, &shown.frames);
    for (field, values) in fields() {
        space.field(field, values, scale_of(field, values));
    }
    page.space("In space", space);
}

/// Up to the largest value; where there is none above nothing, as far as was thought beforehand.
fn scale_of(field: &Field, values: &[f32]) -> ColourScale {
    let values = values.iter().filter(|value| value.is_finite());
    let most = values.fold(0.0, |most: f64, value| most.max(f64::from(*value)));
    let most = if most > 0.0 { most } else { field.full_scale };
    ColourScale::from_zero(&spoken(field), field.unit, most)
}

/// `removed depth`.
fn spoken(field: &Field) -> String {
    field.name().replace('_', " ")
}

/// A field seen against its face, laid flat.
fn figure(field: &Field, values: &[f32]) -> Figure {
    let scale = scale_of(field, values);
    let values = values.iter().map(|value| f64::from(*value));
    let map = Grid {
        cells: field.cells,
        values: values.collect(),
    };
    let title = match field.vertices_m.is_empty() {
        true => String::new(),
        false => "laid flat: even distances from cell to cell".to_owned(),
    };
    let [length, width] = field.size_m;
    map.figure(&spoken(field), title, [0.0, 0.0, length, width], scale)
}

/// As much to either side as nearly all that is left on a part.
fn left_scale(part: &PartMesh) -> ColourScale {
    let left = part
        .left_m
        .as_flattened()
        .iter()
        .map(|x| f64::from(x.abs()));
    let mut left: Vec<f64> = left.filter(|x| x.is_finite()).collect();
    left.sort_by(f64::total_cmp);
    let most = match left.len() {
        0 => 0.0,
        count => left[((count - 1) as f64 * SHARE) as usize],
    };
    ColourScale::about_zero("material left", Unit::Metre, most)
}

/// What is left on the floors of a part, from above; none where it has no floors.
fn floor_figure(part: &PartMesh, scale: &ColourScale) -> Option<Figure> {
    let floors = || {
        let triangles = part.triangles_m.iter().zip(&part.left_m);
        triangles.filter(|(corners, left)| is_level(corners) && left.iter().all(|x| x.is_finite()))
    };
    let all = || part.triangles_m.iter().flatten();
    let bound = |axis: usize, pick: fn(f64, f64) -> f64, from: f64| {
        all().map(|corner| f64::from(corner[axis])).fold(from, pick)
    };
    let low = [0, 1].map(|axis| bound(axis, f64::min, f64::INFINITY));
    let high = [0, 1].map(|axis| bound(axis, f64::max, f64::NEG_INFINITY));
    floors().next()?;
    let size = [high[0] - low[0], high[1] - low[1]];
    let side_m = (size[0].max(size[1]) / CELLS as f64).max(f64::MIN_POSITIVE);
    let cells = size.map(|m| (m / side_m).ceil().max(1.0) as usize);
    let mut sums = vec![(0.0, 0.0); cells[0] * cells[1]];
    for (corners, left) in floors() {
        for (corner, left) in corners.iter().zip(left) {
            let at = [0, 1].map(|axis| {
                let share = (f64::from(corner[axis]) - low[axis]) / size[axis];
                ((share * cells[axis] as f64) as usize).min(cells[axis] - 1)
            });
            let sum = &mut sums[at[1] * cells[0] + at[0]];
            *sum = (sum.0 + f64::from(*left), sum.1 + 1.0);
        }
    }
    let map = Grid {
        cells,
        values: sums.iter().map(|(sum, count)| sum / count).collect(),
    };
    let at = [low[0], low[1], size[0], size[1]];
    let title = "floors from above".to_owned();
    Some(map.figure(
        "material left beyond what was meant",
        title,
        at,
        scale.clone(),
    ))
}

/// Whether a triangle lies level: floors do, walls do not.
fn is_level([a, b, c]: &[[f32; 3]; 3]) -> bool {
    let low = a[2].min(b[2]).min(c[2]);
    let high = a[2].max(b[2]).max(c[2]);
    let wide = |axis: usize| {
        let [a, b, c] = [a[axis], b[axis], c[axis]];
        a.max(b).max(c) - a.min(b).min(c)
    };
    high - low < 0.5 * wide(0).max(wide(1))
}

/// Values by cell, x first.
struct Grid {
    cells: [usize; 2],
    values: Vec<f64>,
}

impl Grid {
    /// A map over a rectangle: place and size, m.
    fn figure(&self, name: &str, title: String, at_m: [f64; 4], scale: ColourScale) -> Figure {
        let (grid, every) = self.thinned();
        let title = match (every, title.is_empty()) {
            (1, _) => title,
            (every, true) => format!("mean of {every} × {every} cells"),
            (every, false) => format!("{title}; mean of {every} × {every} cells"),
        };
        let [x, y, length, width] = at_m.map(|m| m * 1e3);
        let [columns, rows] = grid.cells;
        let size = (length / columns as f64, width / rows as f64);
        let shaded = grid.values.iter().enumerate().map(|(k, value)| {
            let (column, row) = ((k % columns) as f64 + 0.5, (k / columns) as f64 + 0.5);
            ((x + column * size.0, y + row * size.1), scale.shade(*value))
        });
        let mut layer = Layer::cells(size, shaded);
        name.clone_into(&mut layer.label);
        Figure {
            title: name.to_owned(),
            panels: vec![Panel {
                scale: Some(scale),
                ..Panel::new(title, "along the face [mm]", "across [mm]", vec![layer]).evenly()
            }],
            columns: 1,
            legend: Legend::Above,
        }
    }

    /// Blocks of cells at their mean, so many along a side that few enough are left.
    fn thinned(&self) -> (Grid, usize) {
        let [columns, rows] = self.cells;
        let every = columns.max(rows).div_ceil(CELLS).max(1);
        let cells = self.cells.map(|count| count.div_ceil(every));
        let block = |k: usize| {
            let (left, low) = (k % cells[0] * every, k / cells[0] * every);
            let rows = low..(low + every).min(rows);
            let values = rows.flat_map(|row| {
                let columns = left..(left + every).min(columns);
                columns.map(move |column| self.values[row * self.cells[0] + column])
            });
            let (mut sum, mut count) = (0.0, 0.0);
            for value in values.filter(|value| value.is_finite()) {
                sum += value;
                count += 1.0;
            }
            // Not a number where no cell has a value.
            sum / count
        };
        let values = (0..cells[0] * cells[1]).map(block).collect();
        (Grid { cells, values }, every)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks at the edge are smaller, cells without a value do not count.
    #[test]
    fn blocks_of_cells_have_their_mean() {
        let (columns, rows) = (2 * CELLS + 1, 3);
        let mut values: Vec<f64> = (0..columns * rows).map(|k| (k % columns) as f64).collect();
        values[0] = f64::NAN;
        let grid = Grid {
            cells: [columns, rows],
            values,
        };
        let (thin, every) = grid.thinned();
        assert_eq!((every, thin.cells), (3, [columns.div_ceil(3), 1]));
        // Columns 0, 1, 2 of three rows, but the first cell.
        assert!((thin.values[0] - 9.0 / 8.0).abs() < 1e-12);
        assert!((thin.values[1] - 4.0).abs() < 1e-12);
        let last = (3 * (columns / 3)..columns).map(|k| k as f64);
        let mean = last.clone().sum::<f64>() / last.count() as f64;
        assert!((thin.values[thin.values.len() - 1] - mean).abs() < 1e-12);
    }

    #[test]
    fn floors_are_level_and_walls_are_not() {
        let floor = [[0.0, 0.0, 0.1], [1.0, 0.0, 0.1], [0.0, 1.0, 0.12]];
        let wall = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        assert!(is_level(&floor) && !is_level(&wall));
    }
}
