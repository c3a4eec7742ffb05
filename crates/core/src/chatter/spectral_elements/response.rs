//! How modes answer within an element to forces that are polynomials through its nodes.

use crate::chatter::TipMode;
use crate::legendre::legendre;
use nalgebra::{DMatrix, Matrix2};

/// Nodes more than those of an element by which the answer is integrated: the product of the
/// polynomials with a cycle of a mode is met to rounding.
const MORE_NODES: usize = 4;

/// Gauss–Legendre nodes of an element, as parts of its length.
pub(super) struct Nodes {
    pub at: Vec<f64>,
    /// Of the quadrature at these.
    pub weights: Vec<f64>,
    /// Nodes and weights of the integration over the element.
    rule: Vec<(f64, f64)>,
    /// Values of the Lagrange polynomials at the rule's nodes between the element's start and a
    /// place, node by node; the last place is the element's end.
    polynomials: Vec<DMatrix<f64>>,
}

impl Nodes {
    pub fn new(count: usize) -> Self {
        let unit = |(x, weight): (f64, f64)| (0.5 * (1.0 - x), 0.5 * weight);
        let (at, weights): (Vec<f64>, Vec<f64>) = legendre(count).into_iter().map(unit).unzip();
        let rule: Vec<(f64, f64)> = (legendre(count + MORE_NODES).into_iter())
            .map(unit)
            .collect();
        let places = at.iter().copied().chain([1.0]);
        let polynomials = places.map(|place| {
            DMatrix::from_fn(rule.len(), count, |p, m| {
                lagrange(&at, m, place * rule[p].0)
            })
        });
        Self {
            polynomials: polynomials.collect(),
            at,
            weights,
            rule,
        }
    }

    /// Integrals from the element's start to the `place`-th node (after the last: to its end) of
    /// the Lagrange polynomials times `kernel`, a function of the time that is left.
    fn integrals(&self, place: usize, length_s: f64, kernel: impl Fn(f64) -> f64) -> Vec<f64> {
        let until = self.at.get(place).copied().unwrap_or(1.0) * length_s;
        let polynomials = &self.polynomials[place];
        let mut sums = vec![0.0; self.at.len()];
        for (p, (x, weight)) in self.rule.iter().enumerate() {
            let value = weight * until * kernel(until * (1.0 - x));
            for (sum, polynomial) in sums.iter_mut().zip(polynomials.row(p).iter()) {
                *sum += value * polynomial;
            }
        }
        sums
    }
}

/// The `m`-th Lagrange polynomial of the nodes at `x`.
fn lagrange(nodes: &[f64], m: usize, x: f64) -> f64 {
    let others = nodes.iter().enumerate().filter(|(k, _)| *k != m);
    others
        .map(|(_, node)| (x - node) / (nodes[m] - node))
        .product()
}

/// What modal forces at the nodes, and the state at the element's start, do in an element of a
/// length. Velocities are counted in ω times the coordinate.
pub(super) struct ModalResponse {
    pub modes: Vec<ModeResponse>,
}

pub(super) struct ModeResponse {
    /// Coordinate at each node, and its velocity, from coordinate and velocity at the start.
    pub free: [Vec<[f64; 2]>; 2],
    /// State at the end from the state at the start.
    pub free_end: Matrix2<f64>,
    /// Coordinate at a node (row), and, if asked for, its velocity, from the force at a node
    /// (column), s².
    pub forced: [DMatrix<f64>; 2],
    /// State at the end from the force at each node, s².
    pub forced_end: [Vec<f64>; 2],
}

impl ModalResponse {
    pub fn new(modes: &[TipMode], nodes: &Nodes, length_s: f64, with_rates: bool) -> Self {
        let modes = modes.iter().map(|mode| {
            let (count, own) = (nodes.at.len(), mode.natural_frequency_rad_s);
            // Coordinate (0) or velocity (1) at a place.
            let forced = |part: usize, place: usize| {
                nodes.integrals(place, length_s, |t| free_motion(mode, t)[(part, 1)] / own)
            };
            ModeResponse {
                free: [0, 1].map(|part| {
                    let at_nodes = nodes.at.iter().map(|at| {
                        let motion = free_motion(mode, at * length_s);
                        [motion[(part, 0)], motion[(part, 1)]]
                    });
                    at_nodes.collect()
                }),
                free_end: free_motion(mode, length_s),
                forced: [0, 1].map(|part| {
                    let wanted = if part == 1 && !with_rates { 0 } else { count };
                    let rows: Vec<Vec<f64>> = (0..wanted).map(|i| forced(part, i)).collect();
                    DMatrix::from_fn(wanted, count, |i, m| rows[i][m])
                }),
                forced_end: [0, 1].map(|part| forced(part, count)),
            }
        });
        Self {
            modes: modes.collect(),
        }
    }
}

/// Free motion of a mode over a time: (q, q̇/ω) then by (q, q̇/ω) now.
pub(super) fn free_motion(mode: &TipMode, time_s: f64) -> Matrix2<f64> {
    let (damping, turn) = (mode.damping_ratio, mode.natural_frequency_rad_s * time_s);
    let inside = 1.0 - damping * damping;
    let root = inside.abs().sqrt() * turn;
    let decay = (-damping * turn).exp();
    let (c, s) = if root < 1e-9 {
        (decay, decay * turn)
    } else if inside > 0.0 {
        (decay * root.cos(), decay * root.sin() * turn / root)
    } else {
        // e^{−ζωt} cosh and sinh, apart, would overflow.
        let (slow, fast) = (
            (root - damping * turn).exp(),
            (-root - damping * turn).exp(),
        );
        (0.5 * (slow + fast), 0.5 * (slow - fast) * turn / root)
    };
    Matrix2::new(c + damping * s, s, -s, c - damping * s)
}
