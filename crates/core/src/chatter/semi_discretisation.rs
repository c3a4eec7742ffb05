//! First-order semi-discretisation (`insperger2011`): Floquet
//! multipliers of n modes under a periodic regenerative cut.
//!
//! A tooth period T is cut into k steps. Within a step the directional matrix is its average over
//! the step, the delayed displacement runs straight from one stored value to the next, and the
//! modes follow their exact solution.
//!
//! # How it is computed
//!
//! The period map is never formed. Its state is the 2n modal coordinates and velocities and, since
//! forces depend on where the tool point was and on nothing else, the k last positions of that
//! point: one number each for a single mode, two otherwise. One application costs k small products,
//! and power iteration followed by Arnoldi's method finds the dominant multiplier in some twenty of
//! them. Directional matrices depend on the angle only and are shared by all speeds and depths;
//! steps in which no tooth cuts are free motion, known in closed form.

use super::{DirectionalMatrix, TipMode};
use crate::cutting::milling::nominal::NominalCut;
use nalgebra::{Complex, DMatrix};
use std::f64::consts::TAU;

mod period_map;

/// Most modes that are taken.
pub const MOST_MODES: usize = 12;

/// How a solution behaves from one tooth period to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bifurcation {
    /// A complex pair: vibration at a frequency of its own.
    Hopf,
    /// A negative real multiplier: every other tooth alike, period doubling.
    Flip,
    /// A positive real multiplier.
    Fold,
}

/// The dominant Floquet multiplier over a tooth period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Multiplier {
    pub value: Complex<f64>,
}

impl Multiplier {
    /// |μ|; stable below 1.
    pub fn magnitude(&self) -> f64 {
        self.value.norm()
    }

    pub fn is_stable(&self) -> bool {
        self.magnitude() < 1.0
    }

    /// Kind of instability that this multiplier brings when it leaves the unit circle.
    pub fn bifurcation(&self) -> Bifurcation {
        if self.value.im.abs() > 1e-6 * self.magnitude() {
            Bifurcation::Hopf
        } else if self.value.re < 0.0 {
            Bifurcation::Flip
        } else {
            Bifurcation::Fold
        }
    }

    /// Growth rate of the vibration, 1/s: ln|μ| / T.
    pub fn growth_per_s(&self, tooth_period_s: f64) -> f64 {
        self.magnitude().ln() / tooth_period_s
    }

    /// arg μ / T in [0, π/T], rad/s: the lowest frequency that such a vibration can have.
    pub fn base_frequency_rad_s(&self, tooth_period_s: f64) -> f64 {
        self.value.arg().abs() / tooth_period_s
    }

    /// All frequencies of such a vibration up to `highest_rad_s`, rising: the base frequency, and
    /// it and its mirror image about every multiple of the tooth-passing frequency. The one near a
    /// natural frequency dominates.
    pub fn frequencies_rad_s(&self, tooth_period_s: f64, highest_rad_s: f64) -> Vec<f64> {
        let base = self.base_frequency_rad_s(tooth_period_s);
        let passing = TAU / tooth_period_s;
        let pairs = (0..).map(|k| passing * f64::from(k));
        let all = pairs
            .take_while(|center| center - base <= highest_rad_s)
            .flat_map(|center| [center - base, center + base]);
        let mut found: Vec<f64> = all.filter(|f| (0.0..=highest_rad_s).contains(f)).collect();
        found.sort_by(f64::total_cmp);
        found.dedup();
        found
    }
}

/// Enough steps a tooth period to follow the fastest of the modes: twenty-four to its cycle, and
/// forty at least.
pub fn recommended_steps(modes: &[TipMode], tooth_period_s: f64) -> usize {
    let fastest = modes
        .iter()
        .map(|m| m.natural_frequency_rad_s)
        .fold(0.0, f64::max);
    ((24.0 * fastest * tooth_period_s / TAU).ceil() as usize).max(40)
}

/// Modes and a cut, prepared for any speed and depth.
#[derive(Debug, Clone, PartialEq)]
pub struct SemiDiscretisation {
    modes: Vec<TipMode>,
    /// C, outputs × modes, row by row: what is remembered of the modal coordinates.
    outputs: Vec<f64>,
    output_count: usize,
    /// For each step, n × outputs row by row: modal force per depth and remembered displacement,
    /// Pa/kg in the scaling of C; empty where no tooth cuts.
    forces: Vec<Vec<f64>>,
    floor: Option<Floor>,
}

/// What the floor adds: the edge is engaged deeper at once where the tool sinks.
#[derive(Debug, Clone, PartialEq)]
struct Floor {
    /// Displacement along the tool's axis per modal coordinate.
    heights: Vec<f64>,
    /// For each step, modal forces per displacement along the axis, N/m in modal scaling.
    forces: Vec<Vec<f64>>,
    /// Where a resting tool stands under the mean force, upwards, per depth in which it then cuts.
    lift: f64,
}

impl SemiDiscretisation {
    /// `steps` is k, the number of steps in a tooth period; shapes are in the milling frame.
    ///
    /// # Panics
    /// If there are no modes, more than [`MOST_MODES`], or no steps.
    pub fn new(modes: &[TipMode], process: &DirectionalMatrix, steps: usize) -> Self {
        assert!(
            (1..=MOST_MODES).contains(&modes.len()) && steps > 0,
            "1 to {MOST_MODES} modes and at least one step are needed"
        );
        let n = modes.len();
        let shapes = DMatrix::from_fn(3, n, |r, c| modes[c].shape_per_sqrt_kg[r]);
        let planar = shapes.rows(0, 2).into_owned();
        let scale = planar.norm().max(f64::MIN_POSITIVE);
        let (output_count, outputs) = if n == 1 {
            (1, vec![1.0])
        } else {
            let rows = (0..2).flat_map(|r| (0..n).map(move |c| (r, c)));
            (2, rows.map(|at| planar[at] / scale).collect())
        };
        let pitch = TAU / process.teeth as f64;
        let forces = (0..steps).map(|i| {
            let angle = |i: usize| pitch * i as f64 / steps as f64;
            let matrix = process.average_between_pa(angle(i), angle(i + 1));
            if matrix.amax() == 0.0 {
                return Vec::new();
            }
            let modal = shapes.transpose() * DMatrix::from_fn(3, 3, |r, c| matrix[(r, c)]);
            let force = if n == 1 {
                &modal * &shapes
            } else {
                modal.columns(0, 2).into_owned() * scale
            };
            force.transpose().as_slice().to_vec()
        });
        Self {
            modes: modes.to_vec(),
            outputs,
            output_count,
            forces: forces.collect(),
            floor: None,
        }
    }

    /// With the feedback of the floor: a tool that sinks by z is engaged over b − z at once, so
    /// that the nominal force changes by −z/b of itself, whatever the depth. It grows with the
    /// feed, and regeneration has no part in it. Under the mean force the tool has sunk (or risen)
    /// to begin with, and cuts deeper (or less deep) than was set: depths are those that were set.
    #[must_use]
    pub fn with_floor(mut self, cut: &NominalCut) -> Self {
        let pitch = cut.cutter.pitch_rad();
        let angle = |i: usize| pitch * i as f64 / self.steps() as f64;
        let forces = (0..self.steps()).map(|i| {
            let per_depth = cut.force_per_depth_between(angle(i), angle(i + 1));
            let modes = self.modes.iter();
            modes
                .map(|mode| -mode.shape_per_sqrt_kg.dot(&per_depth))
                .collect()
        });
        let heights = self.modes.iter().map(|mode| mode.shape_per_sqrt_kg.z);
        let mean = cut.average_force_n() / cut.axial_depth_m;
        let lifts = self.modes.iter().map(|mode| {
            let shape = mode.shape_per_sqrt_kg;
            shape.z * shape.dot(&mean) / mode.natural_frequency_rad_s.powi(2)
        });
        self.floor = Some(Floor {
            lift: lifts.sum(),
            forces: forces.collect(),
            heights: heights.collect(),
        });
        self
    }

    /// Steps in a tooth period.
    pub fn steps(&self) -> usize {
        self.forces.len()
    }

    /// Dominant multiplier over a tooth period of `tooth_period_s` at an axial depth of `depth_m`.
    pub fn multiplier(&self, tooth_period_s: f64, depth_m: f64) -> Multiplier {
        // z = lift (b − z) is where the tool stands.
        let lift = self.floor.as_ref().map_or(0.0, |floor| floor.lift);
        Multiplier {
            value: period_map::dominant_multiplier(self, tooth_period_s, depth_m / (1.0 + lift)),
        }
    }
}

#[cfg(test)]
mod tests;
