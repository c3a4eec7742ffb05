//! What the wheel takes off the face: a grid of doses and depths.

use super::{Contact, PolishSetup};
use nalgebra::{Matrix2, Point2, Vector2};
use truecut_core::wheel::patch::{EdgePoint, Patch, Sliding};
use truecut_core::wheel::removal::{Placement, SurfaceGrid};

/// Way of the patch between two times that its dose is spread, in cells: the total is kept, the place blurred by that much.
const SPREAD_EVERY_CELLS: f64 = 0.1;
/// Most steps whose dose is kept back.
const MOST_STEPS: usize = 40;

/// The grid, and the dose that is not on it yet.
#[derive(Debug, Clone)]
pub(super) struct Surface {
    pub grid: SurfaceGrid,
    /// Size of a cell, m.
    cell_m: Vector2<f64>,
    /// `∫ p |v| dA dt` of the whole run, J.
    pub preston_j: f64,
    /// Reactions along edges in this step.
    pub edges: Vec<EdgePoint>,
    scratch: Vec<(usize, f64)>,
    pending: Pending,
}

#[derive(Debug, Clone, Default)]
struct Pending {
    energy_j: f64,
    steps: usize,
    from_m: Point2<f64>,
    /// Patch, its middle and its sliding at the last step.
    last: Option<(Patch, Point2<f64>, Sliding)>,
}

impl Surface {
    pub fn new(setup: &PolishSetup) -> Self {
        let [columns, rows] = setup.cells;
        Self {
            grid: SurfaceGrid::plane(columns, rows, setup.length_m, setup.width_m),
            cell_m: Vector2::new(setup.length_m / columns as f64, setup.width_m / rows as f64),
            preston_j: 0.0,
            edges: Vec::new(),
            scratch: Vec::new(),
            pending: Pending::default(),
        }
    }

    fn placement(&self, at_m: Point2<f64>) -> Placement {
        Placement {
            at_cells: at_m.coords.component_div(&self.cell_m),
            patch_from_cells_m: Matrix2::from_diagonal(&self.cell_m),
        }
    }

    /// Gives a step's dose: along edges at once, that of the patch when it has moved far enough.
    pub fn polish(&mut self, setup: &PolishSetup, contact: &Contact, dt_s: f64) {
        let loads = &contact.loads;
        let placement = self.placement(contact.at_m);
        for edge in &self.edges {
            let energy_j = edge.sliding_w * dt_s;
            (self.grid).give_at(&placement, edge.at_m, energy_j, setup.preston_per_pa);
        }
        if self.pending.steps == 0 {
            self.pending.from_m = contact.at_m;
        }
        self.pending.energy_j += (loads.sliding_w - loads.edge_sliding_w) * dt_s;
        self.pending.steps += 1;
        self.pending.last = Some((contact.patch, contact.at_m, contact.sliding));
        let moved = (contact.at_m - self.pending.from_m).component_div(&self.cell_m);
        if moved.norm() >= SPREAD_EVERY_CELLS || self.pending.steps >= MOST_STEPS {
            self.settle(setup);
        }
    }

    /// Spreads what is kept back.
    pub fn settle(&mut self, setup: &PolishSetup) {
        let pending = std::mem::take(&mut self.pending);
        let Some((patch, at_m, sliding)) = pending.last else {
            return;
        };
        let middle = pending.from_m + 0.5 * (at_m - pending.from_m);
        let placement = self.placement(middle);
        self.grid.spread(
            &placement,
            patch.window_m(),
            pending.energy_j,
            setup.preston_per_pa,
            &mut self.scratch,
            |x, y| patch.moving_pressure_pa(x, y, &sliding) * sliding.at_m_per_s(x, y).norm(),
        );
    }

    /// Volume that Preston's law takes off by what was given so far, kept back or not, m³.
    pub fn preston_m3(&self, setup: &PolishSetup) -> f64 {
        setup.preston_per_pa * self.preston_j
    }

    /// Middle of a cell, m.
    pub fn middle_m(&self, cell: usize) -> Point2<f64> {
        let (column, row) = (cell % self.grid.columns(), cell / self.grid.columns());
        let place = Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
        Point2::from(place.component_mul(&self.cell_m))
    }
}
