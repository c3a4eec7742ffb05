//! Spectral elements in time (`khasawneh2011`): Floquet multipliers of n modes under a periodic
//! regenerative cut, worn flanks included.
//!
//! A tooth period T is split where teeth enter and leave. Without a tooth in the cut the modes move
//! freely, which is known in closed form. With teeth in the cut the period is split further into
//! elements, about one to a cycle of the fastest mode. In an element the cutting force is a
//! polynomial through its values at Gauss–Legendre nodes, the modes answer to it exactly
//! (variation of constants), and the force at the nodes follows from the motion there and a tooth
//! period before, at the same nodes: nothing is interpolated in what is remembered.
//!
//! # Error
//!
//! Within an element everything is smooth, so that the error falls faster than any power of the
//! step: with eight nodes to a cycle limits are within some 1e-5, where the first-order
//! semi-discretisation of `insperger2011` errs by some per cent with forty steps a tooth period and
//! by 0.9 % with 240 (`docs/physics/stability.md`). What is left is estimated from a finer
//! resolution ([`super::limit::first_limit`]).
//!
//! # How it is computed
//!
//! The period map is never formed. Its state is the 2n modal coordinates and velocities and, since
//! forces depend on where the tool point was and on nothing else, that point's positions at all
//! nodes: one number each for a single mode, two otherwise. One application is a small product for
//! each element; power iteration followed by Arnoldi's method finds the dominant multiplier in
//! some twenty of them.

use super::krylov::dominant_eigenvalue;
use super::multiplier::Multiplier;
use super::{DirectionalMatrix, TipMode};
use crate::cutting::milling::cutter::spindle_rad_s;
use crate::cutting::milling::nominal::NominalCut;
use nalgebra::{DMatrix, DVector, DVectorView, Matrix3, Vector3};
use std::f64::consts::TAU;

mod element;
mod response;
mod spectrum;

use element::Element;
use response::{ModalResponse, Nodes};
use spectrum::Moment;

/// Most modes that are taken.
pub const MOST_MODES: usize = 24;

/// Nodes of an element, and elements to a cycle of the fastest mode (and to a half turn of the
/// tool, over which the directional matrix has a cycle).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    pub nodes: usize,
    pub elements_per_cycle: f64,
}

impl Resolution {
    /// Limits within some 1e-5.
    pub const STANDARD: Self = Self {
        nodes: 8,
        elements_per_cycle: 1.0,
    };

    /// By which the error of the standard is estimated.
    pub const FINER: Self = Self {
        nodes: 10,
        elements_per_cycle: 1.5,
    };
}

/// Modes and a cut, prepared for any speed and depth.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralElements {
    modes: Vec<TipMode>,
    process: DirectionalMatrix,
    outputs: Outputs,
    /// Displacement of the tool point in the cutting plane by columns of remembered output.
    scale: f64,
    floor: Option<Floor>,
}

/// What forces follow from, outputs × modes.
#[derive(Debug, Clone, PartialEq)]
struct Outputs {
    /// What is remembered of the modal coordinates; with a floor, and last, the displacement along
    /// the tool's axis, which is not remembered.
    positions: DMatrix<f64>,
    /// With worn flanks the velocities of what is remembered, by columns of velocities over ω; not
    /// remembered.
    rates: DMatrix<f64>,
}

/// What the floor adds: the edge is engaged deeper at once where the tool sinks.
#[derive(Debug, Clone, PartialEq)]
struct Floor {
    cut: NominalCut,
    /// Where a resting tool stands under the mean force, upwards, per depth in which it then cuts.
    lift: f64,
}

impl SpectralElements {
    /// Shapes are in the milling frame.
    ///
    /// # Panics
    /// If there are no modes, or more than [`MOST_MODES`].
    pub fn new(modes: &[TipMode], process: &DirectionalMatrix) -> Self {
        assert!(
            (1..=MOST_MODES).contains(&modes.len()),
            "1 to {MOST_MODES} modes are needed"
        );
        let planar = DMatrix::from_fn(2, modes.len(), |r, c| modes[c].shape_per_sqrt_kg[r]);
        let scale = planar.norm().max(f64::MIN_POSITIVE);
        let positions = match modes {
            [_] => DMatrix::identity(1, 1),
            _ => planar / scale,
        };
        let worn = if process.flank.is_sharp() {
            0
        } else {
            positions.nrows()
        };
        let rates = DMatrix::from_fn(worn, modes.len(), |r, c| {
            positions[(r, c)] * modes[c].natural_frequency_rad_s
        });
        Self {
            modes: modes.to_vec(),
            process: *process,
            outputs: Outputs { positions, rates },
            scale,
            floor: None,
        }
    }

    /// With the feedback of the floor: a tool that sinks by z is engaged over b − z at once, so
    /// that the nominal force changes by −z/b of itself, whatever the depth. It grows with the
    /// feed, and regeneration has no part in it. Under the mean force the tool has sunk (or risen)
    /// to begin with, and cuts deeper (or less deep) than was set: depths are those that were set.
    #[must_use]
    pub fn with_floor(mut self, cut: &NominalCut) -> Self {
        let mean = cut.average_force_n() / cut.axial_depth_m;
        let lifts = self.modes.iter().map(|mode| {
            let shape = mode.shape_per_sqrt_kg;
            shape.z * shape.dot(&mean) / mode.natural_frequency_rad_s.powi(2)
        });
        self.floor = Some(Floor {
            cut: *cut,
            lift: lifts.sum(),
        });
        let positions = self.outputs.positions;
        let height = positions.nrows();
        self.outputs.positions = positions.insert_row(height, 0.0);
        for (j, mode) in self.modes.iter().enumerate() {
            self.outputs.positions[(height, j)] = mode.shape_per_sqrt_kg.z;
        }
        self
    }

    /// All that no depth changes, at a tooth period of `tooth_period_s`.
    pub fn at(&self, tooth_period_s: f64) -> AtSpeed<'_> {
        self.resolved(tooth_period_s, Resolution::STANDARD)
    }

    /// [`Self::at`], as finely as asked.
    pub fn resolved(&self, tooth_period_s: f64, resolution: Resolution) -> AtSpeed<'_> {
        let nodes = Nodes::new(resolution.nodes);
        let pitch = TAU / self.process.teeth as f64;
        let worn = self.outputs.rates.nrows() > 0;
        let mut elements = Vec::new();
        let mut moments = Vec::new();
        for [from, to] in self.segments() {
            let time_s = |angle: f64| tooth_period_s * angle / pitch;
            if let Some((kick, force)) = self.kick(from, tooth_period_s) {
                elements.push(kick);
                moments.push(Moment {
                    time_s: time_s(from),
                    weight: 1.0,
                    force,
                });
            }
            let length_s = tooth_period_s * (to - from) / pitch;
            let teeth = self.cutting_teeth(0.5 * (from + to));
            if teeth.is_empty() {
                elements.push(Element::free(&self.modes, length_s));
                continue;
            }
            let cycles = self.fastest_hz() * length_s + 2.0 * (to - from) / TAU;
            let count = (resolution.elements_per_cycle * cycles).ceil().max(1.0);
            let response = ModalResponse::new(&self.modes, &nodes, length_s / count, worn);
            let step = (to - from) / count;
            for i in 0..count as usize {
                let angle = |part: f64| from + step * (i as f64 + part);
                let forces: Vec<NodeForces> = (nodes.at.iter())
                    .map(|part| self.forces_at(angle(*part), &teeth, tooth_period_s))
                    .collect();
                elements.push(Element::cutting(&response, &self.outputs, &forces));
                let parts = nodes.at.iter().zip(&nodes.weights).zip(forces);
                moments.extend(parts.map(|((part, weight), forces)| Moment {
                    time_s: time_s(angle(*part)),
                    weight: weight * length_s / count,
                    force: forces.remembered,
                }));
            }
        }
        AtSpeed {
            of: self,
            tooth_period_s,
            elements,
            moments,
        }
    }

    /// Rate of the fastest mode as a frequency; a heavily damped one decays faster than it swings.
    fn fastest_hz(&self) -> f64 {
        let rates = (self.modes.iter())
            .map(|m| m.natural_frequency_rad_s * (2.0 * m.damping_ratio).max(1.0));
        rates.fold(0.0, f64::max) / TAU
    }

    /// Parts of a tooth period, in angles of tooth 0, between which no tooth enters or leaves.
    fn segments(&self) -> Vec<[f64; 2]> {
        let pitch = TAU / self.process.teeth as f64;
        let engagement = &self.process.engagement;
        let ends = [engagement.entry_rad, engagement.exit_rad].map(|end| end.rem_euclid(pitch));
        let mut bounds = vec![0.0, pitch];
        bounds.extend(ends);
        bounds.sort_by(f64::total_cmp);
        let pairs = bounds.windows(2).map(|pair| [pair[0], pair[1]]);
        pairs
            .filter(|[from, to]| to - from > 1e-12 * pitch)
            .collect()
    }

    /// By how much the teeth in the cut are behind tooth 0 when that stands at an angle, rad.
    fn cutting_teeth(&self, angle_rad: f64) -> Vec<f64> {
        let behind = |tooth| TAU * tooth as f64 / self.process.teeth as f64;
        let all = (0..self.process.teeth).map(behind);
        all.filter(|behind| self.process.engagement.contains(angle_rad - behind))
            .collect()
    }

    /// What edge forces do at once where a tooth enters or leaves with a chip that rises from
    /// nothing, while tooth 0 stands at an angle (up to whole pitches); and its modal impulse.
    fn kick(&self, angle_rad: f64, tooth_period_s: f64) -> Option<(Element, DMatrix<f64>)> {
        let pitch = TAU / self.process.teeth as f64;
        let engagement = &self.process.engagement;
        let here = |end: &f64| {
            let apart = (end - angle_rad) / pitch;
            (apart - apart.round()).abs() < 1e-9
        };
        let ends = [engagement.entry_rad, engagement.exit_rad];
        let kicks = ends.iter().filter(|end| here(end));
        let pa: Matrix3<f64> = kicks.map(|end| self.process.edge_kick_pa(*end)).sum();
        if pa == Matrix3::zeros() {
            return None;
        }
        let modal = self.modal(&(pa / spindle_rad_s(self.process.teeth, tooth_period_s)));
        let mut impulse = modal.clone();
        for (j, mut row) in impulse.row_iter_mut().enumerate() {
            row /= self.modes[j].natural_frequency_rad_s;
        }
        let remembered = self.outputs.positions.rows(0, impulse.ncols());
        Some((Element::kick(impulse, remembered.into_owned()), modal))
    }

    /// By modes and remembered outputs.
    fn modal(&self, matrix: &Matrix3<f64>) -> DMatrix<f64> {
        let shape = |j: usize| self.modes[j].shape_per_sqrt_kg;
        match self.modes.len() {
            1 => DMatrix::from_element(1, 1, shape(0).dot(&(matrix * shape(0)))),
            n => DMatrix::from_fn(n, 2, |j, d| shape(j).dot(&matrix.column(d)) * self.scale),
        }
    }

    /// Modal forces of the teeth in the cut.
    fn forces_at(&self, angle_rad: f64, teeth: &[f64], tooth_period_s: f64) -> NodeForces {
        let n = self.modes.len();
        let matrix = self.process.at_pa(angle_rad, teeth);
        let shape = |j: usize| self.modes[j].shape_per_sqrt_kg;
        let flank = (self.process).flank_at_pa_s(angle_rad, teeth, tooth_period_s);
        let floor = self.floor.as_ref().map(|floor| {
            let per_depth: Vector3<f64> = floor.cut.force_per_depth_at(angle_rad, teeth);
            DVector::from_fn(n, |j, _| -shape(j).dot(&per_depth))
        });
        NodeForces {
            remembered: self.modal(&matrix),
            floor,
            flank: flank.as_ref().map(|matrix| self.modal(matrix)),
        }
    }
}

/// Modal forces at a node.
struct NodeForces {
    /// Modes × remembered outputs: force per depth and output, Pa in the scaling of modes and
    /// outputs.
    remembered: DMatrix<f64>,
    /// Force per displacement along the tool's axis, N/m in modal scaling.
    floor: Option<DVector<f64>>,
    /// Modes × remembered outputs: force per depth and velocity of the output.
    flank: Option<DMatrix<f64>>,
}

/// Modes and a cut at a speed, prepared for any depth.
#[derive(Debug, Clone)]
pub struct AtSpeed<'a> {
    of: &'a SpectralElements,
    tooth_period_s: f64,
    elements: Vec<Element>,
    /// Where forces act, in the order of what is remembered.
    moments: Vec<Moment>,
}

impl AtSpeed<'_> {
    /// The same, more finely resolved.
    pub fn finer(&self) -> Self {
        self.of.resolved(self.tooth_period_s, Resolution::FINER)
    }

    /// T, s.
    pub fn tooth_period_s(&self) -> f64 {
        self.tooth_period_s
    }

    /// Dominant multiplier at an axial depth of `depth_m`.
    pub fn multiplier(&self, depth_m: f64) -> Multiplier {
        let map = self.period_map(depth_m);
        Multiplier {
            value: dominant_eigenvalue(map.length(), |from, to| map.apply(from, to)),
        }
    }

    fn period_map(&self, depth_m: f64) -> PeriodMap {
        // z = lift (b − z) is where the tool stands.
        let lift = self.of.floor.as_ref().map_or(0.0, |floor| floor.lift);
        let depth_m = depth_m / (1.0 + lift);
        PeriodMap {
            states: 2 * self.of.modes.len(),
            steps: (self.elements.iter())
                .map(|element| element.at_depth(depth_m))
                .collect(),
        }
    }
}

/// The map over one tooth period at a speed and depth.
struct PeriodMap {
    states: usize,
    /// Each takes the state and what was remembered at its nodes to the state behind it and the
    /// positions at its nodes.
    steps: Vec<DMatrix<f64>>,
}

impl PeriodMap {
    /// Length of the vector that the map acts on: the state, then the positions at all nodes.
    fn length(&self) -> usize {
        let remembered = self.steps.iter().map(|step| step.nrows() - self.states);
        self.states + remembered.sum::<usize>()
    }

    fn apply(&self, from: &[f64], to: &mut [f64]) {
        let (start, mut past) = from.split_at(self.states);
        let (end, mut positions) = to.split_at_mut(self.states);
        let most = self.steps.iter().map(DMatrix::nrows).max().unwrap_or(0);
        let mut before = DVector::zeros(most);
        let mut after = DVector::zeros(most);
        before.as_mut_slice()[..self.states].copy_from_slice(start);
        for step in &self.steps {
            let (length, nodes) = (step.nrows(), step.nrows() - self.states);
            let (now, later) = past.split_at(nodes);
            before.as_mut_slice()[self.states..length].copy_from_slice(now);
            past = later;
            let all = DVectorView::from_slice(&before.as_slice()[..length], length);
            after.rows_mut(0, length).gemv(1.0, step, &all, 0.0);
            let (here, rest) = positions.split_at_mut(nodes);
            here.copy_from_slice(&after.as_slice()[self.states..length]);
            positions = rest;
            before.as_mut_slice()[..self.states].copy_from_slice(&after.as_slice()[..self.states]);
        }
        end.copy_from_slice(&before.as_slice()[..self.states]);
    }
}

#[cfg(test)]
mod tests;
