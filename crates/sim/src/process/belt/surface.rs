//! What the belt takes off the face: a grid of doses and depths over the parameters, one a copy.

use super::BeltSetup;
use super::contact::{STRIPS, Strip};
use crate::process::pending_removal::PendingRemoval;
use nalgebra::{Matrix2, Point3, Vector2, Vector3};
use truecut_core::wheel::patch::EdgePoint;
use truecut_core::wheel::removal::{Placement, SurfaceGrid};
use truecut_plan::surface::PatchFile;

/// Directions along each parameter in which the face is measured.
const MEASURED: usize = 17;

/// Cells over the parameters of a patch.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    /// Columns along u, rows along v.
    pub count: [usize; 2],
    /// Size of a cell in u and v.
    pub size: [f64; 2],
    /// First u and v.
    pub from: [f64; 2],
}

impl Cells {
    /// As few as are nowhere longer than `largest_m` along their parameter.
    pub fn of(patch: &PatchFile, largest_m: f64) -> Self {
        let surface = patch.surface.as_ref();
        let domain = surface.domain();
        let at = |range: [f64; 2], k: usize| {
            range[0] + (range[1] - range[0]) * k as f64 / (MEASURED - 1) as f64
        };
        let mut fastest = [0.0_f64; 2];
        for i in 0..MEASURED * MEASURED {
            let jet = surface.jet(at(domain.u, i / MEASURED), at(domain.v, i % MEASURED));
            for (fastest, along) in fastest.iter_mut().zip(&jet.first_m) {
                *fastest = fastest.max(along.norm());
            }
        }
        let ranges = [domain.u, domain.v];
        let spans = ranges.map(|range| range[1] - range[0]);
        let count = [0, 1].map(|i| {
            let cells = spans[i] * fastest[i] / largest_m;
            (cells - 1e-9).ceil().max(1.0) as usize
        });
        Self {
            count,
            size: [0, 1].map(|i| spans[i] / count[i] as f64),
            from: ranges.map(|range| range[0]),
        }
    }

    /// Parameters of the middle of a cell.
    pub fn middle(&self, cell: usize) -> [f64; 2] {
        let place = [cell % self.count[0], cell / self.count[0]];
        [0, 1].map(|i| self.from[i] + (place[i] as f64 + 0.5) * self.size[i])
    }

    /// Parameters in cells from the outer corner of the first.
    pub(in crate::process) fn place(&self, uv: [f64; 2]) -> Vector2<f64> {
        Vector2::from([0, 1].map(|i| (uv[i] - self.from[i]) / self.size[i]))
    }

    /// True areas, row by row, m²: |r_u × r_v| at two by two points of Gauss's rule.
    pub fn areas_m2(&self, patch: &PatchFile) -> Vec<f64> {
        let off = 0.5 / 3.0_f64.sqrt();
        let area = |cell: usize| {
            let [u, v] = self.middle(cell);
            let points = [(-off, -off), (off, -off), (-off, off), (off, off)];
            let each = points.map(|(a, b)| {
                let jet = (patch.surface).jet(u + a * self.size[0], v + b * self.size[1]);
                jet.first_m[0].cross(&jet.first_m[1]).norm()
            });
            0.25 * each.iter().sum::<f64>() * self.size[0] * self.size[1]
        };
        (0..self.count[0] * self.count[1]).map(area).collect()
    }
}

/// The grid of a copy, and the dose that is not on it yet.
#[derive(Debug, Clone)]
pub(super) struct Worn {
    pub grid: SurfaceGrid,
    pending: [PendingRemoval<Strip>; STRIPS],
    scratch: Vec<(usize, f64)>,
}

impl Worn {
    pub fn new(setup: &BeltSetup) -> Self {
        Self {
            grid: SurfaceGrid::new(setup.cells.count[0], setup.area_m2.to_vec()),
            pending: std::array::from_fn(|_| PendingRemoval::default()),
            scratch: Vec::new(),
        }
    }

    /// Gives a step's dose of the strips that touch: that of borders at once, the rest when a strip
    /// has moved far enough or left the face.
    pub fn grind(
        &mut self,
        setup: &BeltSetup,
        strips: &[Strip],
        edges: &[(Strip, EdgePoint)],
        dt_s: f64,
    ) {
        for (strip, edge) in edges {
            let axes = [strip.x, strip.y];
            let at_cells = setup.cells.place(strip.uv);
            let placement = placement(&setup.cells, &strip.first_m, axes, at_cells);
            let energy_j = edge.sliding_w * dt_s;
            (self.grid).give_at(
                &placement,
                edge.at_m,
                energy_j,
                setup.abrasive.preston_per_pa,
            );
        }
        for index in 0..STRIPS {
            if strips.iter().all(|strip| strip.index != index) {
                self.settle(setup, index);
            }
        }
        for strip in strips {
            let at_cells = setup.cells.place(strip.uv);
            let energy_j = (strip.loads.sliding_w - strip.loads.edge_sliding_w) * dt_s;
            if self.pending[strip.index].add(energy_j, at_cells, *strip) {
                self.settle(setup, strip.index);
            }
        }
    }

    /// Spreads the pending removal of all strips.
    pub fn settle_all(&mut self, setup: &BeltSetup) {
        for index in 0..STRIPS {
            self.settle(setup, index);
        }
    }

    /// Spreads the pending removal of a strip. A cell that the strip covers in part along the
    /// wheel's axis takes that part: strips meet within cells, and the depth must not show where.
    fn settle(&mut self, setup: &BeltSetup, index: usize) {
        let Some(dose) = self.pending[index].take() else {
            return;
        };
        let strip = dose.contact;
        let axes = [strip.x, strip.y];
        let placement = placement(&setup.cells, &strip.first_m, axes, dose.at_cells);
        let across = placement.patch_from_cells_m.row(1);
        let cell_m = across[0].abs() + across[1].abs();
        let half_m = strip.half_width_m;
        let window_m = strip.patch.window_m() + Vector2::new(0.0, 0.5 * cell_m);
        let (patch, sliding) = (strip.patch, strip.sliding);
        self.grid.spread(
            &placement,
            window_m,
            dose.energy_j,
            setup.abrasive.preston_per_pa,
            &mut self.scratch,
            |x, y| {
                let (from, to) = (y - 0.5 * cell_m, y + 0.5 * cell_m);
                let covered_m = to.min(half_m) - from.max(-half_m);
                if covered_m <= 0.0 {
                    return 0.0;
                }
                let inside = y.clamp(-half_m, half_m);
                let speed = sliding.at_m_per_s(x, inside).norm();
                patch.moving_pressure_pa(x, inside, &sliding) * speed * covered_m
            },
        );
    }
}

/// Where a contact with two axes in the face lies on the grid, the face being flat over it.
pub(in crate::process) fn placement(
    cells: &Cells,
    first_m: &[Vector3<f64>; 2],
    axes: [Vector3<f64>; 2],
    at_cells: Vector2<f64>,
) -> Placement {
    let [column, row] = [0, 1].map(|i| {
        let way = first_m[i] * cells.size[i];
        Vector2::new(way.dot(&axes[0]), way.dot(&axes[1]))
    });
    Placement {
        at_cells,
        patch_from_cells_m: Matrix2::from_columns(&[column, row]),
    }
}

/// Whether the middle of each cell lies within the boundary of the patch, if that has one.
pub fn cells_within(cells: &Cells, patch: std::sync::Arc<PatchFile>) -> Vec<bool> {
    let count = cells.count[0] * cells.count[1];
    if patch.boundary.is_none() {
        return vec![true; count];
    }
    let is_within = |cell: usize| {
        let [u, v] = cells.middle(cell);
        let jet = patch.surface.jet(u, v);
        let x = jet.first_m[0].normalize();
        let normal = x.cross(&jet.first_m[1]).normalize();
        let axes = [x, normal.cross(&x)];
        (patch.boundary.as_ref())
            .is_none_or(|boundary| boundary.holds_rectangle(&jet.point_m, axes, [0.0; 2]))
    };
    (0..count).map(is_within).collect()
}

/// Points of the face in the middle of its cells, in the patch's frame, for drawing.
pub fn middles(cells: &Cells, patch: &PatchFile) -> Vec<Point3<f64>> {
    (0..cells.count[0] * cells.count[1])
        .map(|cell| {
            let [u, v] = cells.middle(cell);
            patch.surface.point_m(u, v).into()
        })
        .collect()
}
