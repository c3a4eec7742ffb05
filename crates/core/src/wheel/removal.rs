//! Preston's law on a grid that stays with the surface, and the roughness that polishing leaves.
//!
//! `ż = k_p p v`: what a cell has been given is its dose `D = ∫ p v dt` (J/m²); depth is `k_p D`,
//! roughness follows the dose too (`roughness::Polishing`). Each step spreads the patch's Preston
//! integral `∫ p v dA dt`, which the patch's own quadrature gives, over the cells: by the law's
//! density at the cells' middles, scaled so that the total is kept. Line reactions at edges are
//! given where they act, each to the four cells around it (to those that exist; nothing is lost).

use nalgebra::{Matrix2, Point2, Vector2};

/// Cells of a surface by columns (along u) and rows (along v).
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceGrid {
    columns: usize,
    area_m2: Vec<f64>,
    dose_j_per_m2: Vec<f64>,
    removed_m: Vec<f64>,
}

/// Where the patch lies on the grid, the surface being flat over the patch's size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Middle of the patch in cells: `(0, 0)` is the outer corner of the first cell, `(0.5, 0.5)`
    /// its middle.
    pub at_cells: Vector2<f64>,
    /// Patch coordinates per cell, m: columns are the tangents of u and v in the patch's frame
    /// times the cell's size.
    pub patch_from_cells_m: Matrix2<f64>,
}

impl SurfaceGrid {
    /// A grid from the true areas of its cells, row by row, m².
    ///
    /// # Panics
    /// If the areas do not fill whole rows.
    pub fn new(columns: usize, area_m2: Vec<f64>) -> Self {
        assert!(
            columns > 0 && area_m2.len().is_multiple_of(columns),
            "areas must fill whole rows"
        );
        Self {
            columns,
            dose_j_per_m2: vec![0.0; area_m2.len()],
            removed_m: vec![0.0; area_m2.len()],
            area_m2,
        }
    }

    /// A plane rectangle in equal cells.
    pub fn plane(columns: usize, rows: usize, length_m: f64, width_m: f64) -> Self {
        let area = length_m / columns as f64 * width_m / rows as f64;
        Self::new(columns, vec![area; columns * rows])
    }

    pub fn columns(&self) -> usize {
        self.columns
    }

    pub fn rows(&self) -> usize {
        self.area_m2.len() / self.columns
    }

    /// Dose by cell, row by row, J/m².
    pub fn dose_j_per_m2(&self) -> &[f64] {
        &self.dose_j_per_m2
    }

    /// Removed depth by cell, row by row, m.
    pub fn removed_m(&self) -> &[f64] {
        &self.removed_m
    }

    /// Mean depth of each row over the middle half of its columns, m: across a pass, its ends left
    /// out.
    pub fn middle_means_m(&self) -> Vec<f64> {
        let inner = self.columns / 4..(self.columns * 3 / 4).max(self.columns / 4 + 1);
        (self.removed_m.chunks_exact(self.columns))
            .map(|row| row[inner.clone()].iter().sum::<f64>() / inner.len() as f64)
            .collect()
    }

    /// Removed volume, m³.
    pub fn volume_m3(&self) -> f64 {
        let cells = self.removed_m.iter().zip(&self.area_m2);
        cells.map(|(depth, area)| depth * area).sum()
    }

    fn give(&mut self, cell: usize, energy_j: f64, preston_per_pa: f64) {
        let dose = energy_j / self.area_m2[cell];
        self.dose_j_per_m2[cell] += dose;
        self.removed_m[cell] += preston_per_pa * dose;
    }

    /// Spreads `energy_j = ∫ p v dA dt` over the cells under a window of half lengths `window_m` in
    /// the patch's frame, in the ratio of `density(x, y)` (p v at a point of it) times their areas.
    /// `scratch` keeps its memory. The grid covers the face over which the integral was taken. If
    /// no cell's middle meets the patch, the cell (of the surface) nearest to its middle takes it
    /// all.
    #[allow(clippy::too_many_arguments)]
    pub fn spread(
        &mut self,
        placement: &Placement,
        window_m: Vector2<f64>,
        energy_j: f64,
        preston_per_pa: f64,
        scratch: &mut Vec<(usize, f64)>,
        mut density: impl FnMut(f64, f64) -> f64,
    ) {
        if energy_j <= 0.0 {
            return;
        }
        let Some(cells_from_patch) = placement.patch_from_cells_m.try_inverse() else {
            return;
        };
        scratch.clear();
        let reach = cells_from_patch.abs() * window_m;
        let span = |axis: usize, count: usize| {
            let from = (placement.at_cells[axis] - reach[axis] - 0.5)
                .ceil()
                .max(0.0);
            let to = (placement.at_cells[axis] + reach[axis] + 0.5).floor();
            from as usize..(to.max(0.0) as usize).min(count)
        };
        let mut sum = 0.0;
        for row in span(1, self.rows()) {
            for column in span(0, self.columns) {
                let middle = Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
                let at = placement.patch_from_cells_m * (middle - placement.at_cells);
                let cell = row * self.columns + column;
                let part = density(at.x, at.y) * self.area_m2[cell];
                if part > 0.0 {
                    sum += part;
                    scratch.push((cell, part));
                }
            }
        }
        if sum > 0.0 {
            for (cell, part) in scratch.iter() {
                self.give(*cell, energy_j * part / sum, preston_per_pa);
            }
        } else {
            let nearest = |x: f64, count: usize| (x.max(0.0) as usize).min(count - 1);
            let row = nearest(placement.at_cells.y, self.rows());
            let column = nearest(placement.at_cells.x, self.columns);
            self.give(row * self.columns + column, energy_j, preston_per_pa);
        }
    }

    /// Gives `energy_j` at a point of the patch to the cells around it, in bilinear shares.
    pub fn give_at(
        &mut self,
        placement: &Placement,
        at_m: Point2<f64>,
        energy_j: f64,
        preston_per_pa: f64,
    ) {
        let Some(inverse) = placement.patch_from_cells_m.try_inverse() else {
            return;
        };
        let at = placement.at_cells + inverse * at_m.coords - Vector2::new(0.5, 0.5);
        let hold = |x: f64, count: usize| {
            let x = x.clamp(0.0, (count - 1) as f64);
            let low = (x.floor() as usize).min(count.saturating_sub(2));
            (low, (low + 1).min(count - 1), x - low as f64)
        };
        let (left, right, u) = hold(at.x, self.columns);
        let (lower, upper, v) = hold(at.y, self.rows());
        for (row, column, share) in [
            (lower, left, (1.0 - u) * (1.0 - v)),
            (lower, right, u * (1.0 - v)),
            (upper, left, (1.0 - u) * v),
            (upper, right, u * v),
        ] {
            if share > 0.0 {
                self.give(
                    row * self.columns + column,
                    energy_j * share,
                    preston_per_pa,
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wheel::face::Face;
    use crate::wheel::patch::{Patch, Sliding};
    use crate::wheel::pneumatic::tests::{pressed, wheel as ball};
    use crate::wheel::quadrature::Quadrature;
    use nalgebra::Isometry2;

    const PRESTON: f64 = 4e-11;

    fn patch() -> Patch {
        pressed(&ball(), 0.8e-3)
    }

    /// A pass along y = `y` from `from` to `to` over a 60 mm × 20 mm face, `cell` m a cell: grid
    /// and Preston's integral, J.
    fn pass(
        cell: f64,
        y: f64,
        from: f64,
        to: f64,
        sliding: &Sliding,
        steps: usize,
    ) -> (SurfaceGrid, f64) {
        let (length, width) = (60e-3, 20e-3);
        let (columns, rows) = (
            (length / cell).round() as usize,
            (width / cell).round() as usize,
        );
        let mut grid = SurfaceGrid::plane(columns, rows, length, width);
        let face = Face::rectangle(length, width).unwrap();
        let (patch, q) = (patch(), Quadrature::default());
        let dt = (to - from) / 0.05 / steps as f64;
        let (mut total, mut scratch) = (0.0, Vec::new());
        let mut edges = Vec::new();
        for i in 0..steps {
            let x = from + (to - from) * (i as f64 + 0.5) / steps as f64;
            let placement = Placement {
                at_cells: Vector2::new(x / cell, y / cell),
                patch_from_cells_m: Matrix2::identity() * cell,
            };
            edges.clear();
            let pose = Isometry2::translation(-x, -y);
            let l = patch.loads(&face, &pose, sliding, &q, |e| edges.push(e));
            total += l.sliding_w * dt;
            let inner = (l.sliding_w - l.edge_sliding_w) * dt;
            grid.spread(
                &placement,
                patch.window_m(),
                inner,
                PRESTON,
                &mut scratch,
                |x, y| patch.pressure_pa(x, y) * sliding.at_m_per_s(x, y).norm(),
            );
            for e in &edges {
                grid.give_at(&placement, e.at_m, e.sliding_w * dt, PRESTON);
            }
        }
        (grid, total)
    }

    fn across() -> Sliding {
        Sliding {
            velocity_m_per_s: Vector2::new(0.0, 3.0),
            ..Sliding::default()
        }
    }

    /// `docs/physics/removal.md`, line pass, taken across the track: ∫ depth dy = k_p v_s F / v_f.
    #[test]
    fn verify_pass_removes_prestons_section_on_any_grid() {
        let expected = PRESTON * 3.0 * patch().free_force_n() / 0.05;
        for cell in [1e-3, 0.5e-3, 0.25e-3] {
            let (grid, total) = pass(cell, 10e-3, -10e-3, 70e-3, &across(), 1600);
            let column = grid.columns() / 2;
            let section: f64 = (0..grid.rows())
                .map(|r| grid.removed_m()[r * grid.columns() + column] * cell)
                .sum();
            assert!(
                (section / expected - 1.0).abs() < 5e-3,
                "{cell}: {section} {expected}"
            );
            assert!((grid.volume_m3() / (PRESTON * total) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn verify_track_is_the_same_on_two_grids() {
        let depth = |cell: f64| {
            let (grid, _) = pass(cell, 10e-3, 10e-3, 50e-3, &across(), 1600);
            let columns = grid.columns();
            // mean of the two rows beside the middle, within 1 mm
            let rows = (1e-3 / cell).round() as usize;
            let first = grid.rows() / 2 - rows;
            let sum: f64 = (first..first + 2 * rows)
                .map(|r| grid.removed_m()[r * columns + columns / 2])
                .sum();
            sum / (2 * rows) as f64
        };
        // a tenth and a twentieth of the patch's radius
        let (coarse, fine) = (depth(0.25e-3), depth(0.125e-3));
        assert!((coarse / fine - 1.0).abs() < 0.01, "{coarse} {fine}");
    }

    /// A spot that dwells: depth over the patch is `k_p p(ρ) v t`, deepest in the middle.
    #[test]
    fn verify_dwelling_spot_has_the_shape_of_the_pressure() {
        let (cell, time) = (0.25e-3, 2.0);
        let mut grid = SurfaceGrid::plane(80, 80, 20e-3, 20e-3);
        let (patch, sliding) = (patch(), across());
        let placement = Placement {
            at_cells: Vector2::new(40.5, 40.5),
            patch_from_cells_m: Matrix2::identity() * cell,
        };
        let l = patch.loads(
            &Face::unbounded(),
            &Isometry2::identity(),
            &sliding,
            &Quadrature::default(),
            |_| {},
        );
        grid.spread(
            &placement,
            patch.window_m(),
            l.sliding_w * time,
            PRESTON,
            &mut Vec::new(),
            |x, y| patch.pressure_pa(x, y) * 3.0,
        );
        for offset in [0, 2, 4] {
            let expected = PRESTON * patch.pressure_pa(f64::from(offset) * cell, 0.0) * 3.0 * time;
            let found = grid.removed_m()[40 * 80 + 40 + offset as usize];
            assert!(
                (found / expected - 1.0).abs() < 0.02,
                "{offset}: {found} {expected}"
            );
        }
        let whole = PRESTON * patch.free_force_n() * 3.0 * time;
        assert!((grid.volume_m3() / whole - 1.0).abs() < 5e-3);
    }

    #[test]
    fn nothing_is_lost_along_an_edge_and_edge_removal_is_the_reaction() {
        let sliding = Sliding::about(Point2::new(-7e-3, 0.0), 100.0, 0.3);
        let (grid, total) = pass(0.5e-3, 20e-3, 20e-3, 40e-3, &sliding, 400);
        assert!((grid.volume_m3() / (PRESTON * total) - 1.0).abs() < 1e-9);
        let columns = grid.columns();
        let at = |row: usize| grid.removed_m()[row * columns + columns / 2];
        // the patch's middle runs along the edge: the outermost row is worn more than any
        let last = grid.rows() - 1;
        assert!((0..last).all(|row| at(row) < at(last)));
    }

    /// Cells of unequal area receive by their area: the depth is the same.
    #[test]
    fn verify_true_areas_set_the_depth() {
        let areas = (0..900)
            .map(|i| if i % 30 < 15 { 1e-6 } else { 2e-6 })
            .collect();
        let mut grid = SurfaceGrid::new(30, areas);
        let placement = Placement {
            at_cells: Vector2::new(15.0, 15.0),
            patch_from_cells_m: Matrix2::identity() * 1e-3,
        };
        grid.spread(
            &placement,
            Vector2::new(5e-3, 5e-3),
            1.0,
            PRESTON,
            &mut Vec::new(),
            |_, _| 1.0,
        );
        assert!(
            (grid.removed_m()[15 * 30 + 12] / grid.removed_m()[15 * 30 + 17] - 1.0).abs() < 1e-12
        );
        assert!((grid.volume_m3() / PRESTON - 1.0).abs() < 1e-12);
    }
}
