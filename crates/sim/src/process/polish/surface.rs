//! What the wheel takes off the face: a grid of doses and depths.

use super::{PolishContact, PolishSetup};
use crate::process::pending_removal::PendingRemoval;
use nalgebra::{Matrix2, Point2, Vector2};
use truecut_core::wheel::patch::{EdgePoint, Patch, Sliding};
use truecut_core::wheel::removal::{Placement, SurfaceGrid};

/// The grid, and the dose that is not on it yet.
#[derive(Debug, Clone)]
pub(super) struct Surface {
    pub grid: SurfaceGrid,
    /// Size of a cell, m.
    cell_m: Vector2<f64>,
    /// `∫ p |v| dA dt` of the whole run, J.
    pub preston_j: f64,
    scratch: Vec<(usize, f64)>,
    pending: PendingRemoval<(Patch, Sliding)>,
}

impl Surface {
    pub fn new(setup: &PolishSetup) -> Self {
        let face = &setup.spec.face;
        let [columns, rows] = setup.spec.cells();
        Self {
            grid: SurfaceGrid::plane(columns, rows, face.length_m, face.width_m),
            cell_m: Vector2::new(face.length_m / columns as f64, face.width_m / rows as f64),
            preston_j: 0.0,
            scratch: Vec::new(),
            pending: PendingRemoval::default(),
        }
    }

    fn placement(&self, at_cells: Vector2<f64>) -> Placement {
        Placement {
            at_cells,
            patch_from_cells_m: Matrix2::from_diagonal(&self.cell_m),
        }
    }

    /// Gives a step's dose: along edges at once, that of the patch when it has moved far enough.
    pub fn polish(
        &mut self,
        setup: &PolishSetup,
        contact: &PolishContact,
        edges: &[EdgePoint],
        dt_s: f64,
    ) {
        let loads = &contact.loads;
        let at_cells = contact.at_m.coords.component_div(&self.cell_m);
        let placement = self.placement(at_cells);
        for edge in edges {
            let energy_j = edge.sliding_w * dt_s;
            (self.grid).give_at(
                &placement,
                edge.at_m,
                energy_j,
                setup.spec.abrasive.preston_per_pa,
            );
        }
        let energy_j = (loads.sliding_w - loads.edge_sliding_w) * dt_s;
        let moving = (contact.patch, contact.sliding);
        if self.pending.add(energy_j, at_cells, moving) {
            self.settle(setup);
        }
    }

    /// Spreads the pending removal.
    pub fn settle(&mut self, setup: &PolishSetup) {
        let Some(dose) = self.pending.take() else {
            return;
        };
        let placement = self.placement(dose.at_cells);
        let (patch, sliding) = dose.contact;
        self.grid.spread(
            &placement,
            patch.window_m(),
            dose.energy_j,
            setup.spec.abrasive.preston_per_pa,
            &mut self.scratch,
            |x, y| patch.moving_pressure_pa(x, y, &sliding) * sliding.at_m_per_s(x, y).norm(),
        );
    }

    /// Volume that Preston's law takes off by what was given so far, pending or not, m³.
    pub fn preston_m3(&self, setup: &PolishSetup) -> f64 {
        setup.spec.abrasive.preston_per_pa * self.preston_j
    }

    /// Middle of a cell, m.
    pub fn middle_m(&self, cell: usize) -> Point2<f64> {
        let (column, row) = (cell % self.grid.columns(), cell / self.grid.columns());
        let place = Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
        Point2::from(place.component_mul(&self.cell_m))
    }
}
