//! One element: what no depth changes of it, and its map at a depth.

use super::response::{ModalResponse, free_motion};
use super::{NodeForces, Outputs, TipMode};
use nalgebra::DMatrix;

/// A part of the tooth period.
#[derive(Debug, Clone)]
pub(super) enum Element {
    /// No tooth is in the cut: the state's own motion.
    Free(DMatrix<f64>),
    /// An instant at which velocities (over ω) change by depth times K of what a position differs
    /// from the remembered one: K, and positions by modes.
    Kick(DMatrix<f64>, DMatrix<f64>),
    Cutting(Box<CuttingElement>),
}

/// With remembered positions w at the nodes (outputs of a node beside one another), outputs Z
/// there, the state x at the start: Z = P x + (b D + G + b V) Z − b D w, and x at the end is E x +
/// (b D' + G' + b V') Z − b D' w.
#[derive(Debug, Clone)]
pub(super) struct CuttingElement {
    /// P.
    start: DMatrix<f64>,
    /// E.
    free_end: DMatrix<f64>,
    /// D and D', by columns of remembered positions.
    delayed: DMatrix<f64>,
    delayed_end: DMatrix<f64>,
    /// G and G', by columns of the displacement along the tool's axis at each node.
    floor: Option<[DMatrix<f64>; 2]>,
    /// V and V', by columns of the velocities of what is remembered.
    flank: Option<[DMatrix<f64>; 2]>,
    /// Outputs of a node, and how many of them are remembered.
    outputs: usize,
    remembered: usize,
}

impl Element {
    pub fn free(modes: &[TipMode], length_s: f64) -> Self {
        let mut motion = DMatrix::zeros(2 * modes.len(), 2 * modes.len());
        for (j, mode) in modes.iter().enumerate() {
            set_mode(&mut motion, j, &free_motion(mode, length_s));
        }
        Self::Free(motion)
    }

    pub fn kick(impulse: DMatrix<f64>, positions: DMatrix<f64>) -> Self {
        Self::Kick(impulse, positions)
    }

    pub fn cutting(response: &ModalResponse, outputs: &Outputs, forces: &[NodeForces]) -> Self {
        Self::Cutting(Box::new(CuttingElement::new(response, outputs, forces)))
    }

    /// The state and what was remembered at the nodes, to the state at the end and the positions
    /// at the nodes.
    pub fn at_depth(&self, depth_m: f64) -> DMatrix<f64> {
        match self {
            Self::Free(motion) => motion.clone(),
            Self::Kick(impulse, positions) => kicked(impulse, positions, depth_m),
            Self::Cutting(element) => element.at_depth(depth_m),
        }
    }
}

/// State and remembered positions to the state behind the kick and the positions.
fn kicked(impulse: &DMatrix<f64>, positions: &DMatrix<f64>, depth_m: f64) -> DMatrix<f64> {
    let (modes, remembered) = impulse.shape();
    let states = 2 * modes;
    let mut map = DMatrix::zeros(states + remembered, states + remembered);
    map.view_mut((0, 0), (states, states)).fill_with_identity();
    let change = impulse * depth_m;
    map.view_mut((modes, 0), (modes, modes))
        .copy_from(&(&change * positions));
    map.view_mut((modes, states), (modes, remembered))
        .copy_from(&-change);
    map.view_mut((states, 0), (remembered, modes))
        .copy_from(positions);
    map
}

/// The block of mode `j`: coordinates come first, then velocities.
fn set_mode(motion: &mut DMatrix<f64>, j: usize, own: &nalgebra::Matrix2<f64>) {
    let n = motion.nrows() / 2;
    for (r, c) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        motion[(j + r * n, j + c * n)] = own[(r, c)];
    }
}

impl CuttingElement {
    fn new(response: &ModalResponse, outputs: &Outputs, forces: &[NodeForces]) -> Self {
        let (n, nodes) = (response.modes.len(), forces.len());
        let remembered = forces[0].remembered.ncols();
        let rows = [&outputs.positions, &outputs.rates];
        let d = rows[0].nrows() + rows[1].nrows();
        let first = [0, rows[0].nrows()];
        let mut start = DMatrix::zeros(nodes * d, 2 * n);
        let mut free_end = DMatrix::zeros(2 * n, 2 * n);
        for (j, mode) in response.modes.iter().enumerate() {
            set_mode(&mut free_end, j, &mode.free_end);
            for kind in [0, 1] {
                for (i, free) in mode.free[kind].iter().enumerate() {
                    for (row, part) in rows[kind].column(j).iter().enumerate() {
                        start[(i * d + first[kind] + row, j)] = part * free[0];
                        start[(i * d + first[kind] + row, j + n)] = part * free[1];
                    }
                }
            }
        }
        // By columns of what a force follows from: `force(node, mode, column of the node)`.
        let positions = |columns: usize, force: &dyn Fn(usize, usize, usize) -> f64| {
            let mut at_nodes = DMatrix::zeros(nodes * d, nodes * columns);
            let mut at_end = DMatrix::zeros(2 * n, nodes * columns);
            for (j, mode) in response.modes.iter().enumerate() {
                for m in 0..nodes {
                    for column in 0..columns {
                        let force = force(m, j, column);
                        let to = m * columns + column;
                        for kind in [0, 1] {
                            for (i, forced) in mode.forced[kind].column(m).iter().enumerate() {
                                for (row, part) in rows[kind].column(j).iter().enumerate() {
                                    let from = i * d + first[kind] + row;
                                    at_nodes[(from, to)] += part * forced * force;
                                }
                            }
                        }
                        at_end[(j, to)] = mode.forced_end[0][m] * force;
                        at_end[(j + n, to)] = mode.forced_end[1][m] * force;
                    }
                }
            }
            [at_nodes, at_end]
        };
        let [delayed, delayed_end] = positions(remembered, &|m, j, column| {
            forces[m].remembered[(j, column)]
        });
        let floor = forces[0].floor.is_some().then(|| {
            positions(1, &|m, j, _| {
                forces[m].floor.as_ref().map_or(0.0, |floor| floor[j])
            })
        });
        let flank = forces[0].flank.is_some().then(|| {
            positions(remembered, &|m, j, column| {
                (forces[m].flank.as_ref()).map_or(0.0, |flank| flank[(j, column)])
            })
        });
        Self {
            start,
            free_end,
            delayed,
            delayed_end,
            floor,
            flank,
            outputs: d,
            remembered,
        }
    }

    fn at_depth(&self, depth_m: f64) -> DMatrix<f64> {
        let (d, w, states) = (self.outputs, self.remembered, self.free_end.nrows());
        let nodes = self.start.nrows() / d;
        let mut implicit = DMatrix::identity(nodes * d, nodes * d);
        let mut end = DMatrix::zeros(states, nodes * d);
        for m in 0..nodes {
            for column in 0..w {
                let (from, to) = (m * w + column, m * d + column);
                implicit
                    .column_mut(to)
                    .axpy(-depth_m, &self.delayed.column(from), 1.0);
                end.column_mut(to)
                    .axpy(depth_m, &self.delayed_end.column(from), 1.0);
            }
            if let Some([floor, floor_end]) = &self.floor {
                implicit
                    .column_mut(m * d + w)
                    .axpy(-1.0, &floor.column(m), 1.0);
                end.column_mut(m * d + w)
                    .axpy(1.0, &floor_end.column(m), 1.0);
            }
            if let Some([flank, flank_end]) = &self.flank {
                for column in 0..w {
                    let (from, to) = (m * w + column, (m + 1) * d - w + column);
                    implicit
                        .column_mut(to)
                        .axpy(-depth_m, &flank.column(from), 1.0);
                    end.column_mut(to)
                        .axpy(depth_m, &flank_end.column(from), 1.0);
                }
            }
        }
        // Positions by columns of the state and of what is remembered.
        let mut positions = DMatrix::zeros(nodes * d, states + nodes * w);
        positions.columns_mut(0, states).copy_from(&self.start);
        positions
            .columns_mut(states, nodes * w)
            .zip_apply(&self.delayed, |to, delayed| *to = -depth_m * delayed);
        if !implicit.lu().solve_mut(&mut positions) {
            positions.fill(f64::NAN);
        }
        let mut map = DMatrix::zeros(states + nodes * w, states + nodes * w);
        {
            let mut ends = map.rows_mut(0, states);
            ends.gemm(1.0, &end, &positions, 0.0);
            let mut own = ends.columns_mut(0, states);
            own += &self.free_end;
        }
        map.view_mut((0, states), (states, nodes * w))
            .zip_apply(&self.delayed_end, |to, delayed| *to -= depth_m * delayed);
        for m in 0..nodes {
            map.rows_mut(states + m * w, w)
                .copy_from(&positions.rows(m * d, w));
        }
        map
    }
}
