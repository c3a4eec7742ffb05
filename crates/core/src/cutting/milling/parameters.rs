//! What a milling pass is made of, and where its tool is.

use super::cutter::Cutter;
use super::engagement::Stock;
use crate::cutting::chamfer::CuttingCoefficients;
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// All that a straight milling pass is made of. The tool point's nominal path starts at the origin
/// of the milling frame and runs along x; its rotation is 0 there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MillingParameters {
    pub cutter: Cutter,
    pub coefficients: CuttingCoefficients,
    pub stock: Stock,
    /// c, m.
    pub feed_per_tooth_m: f64,
    /// Teeth meet the surface that was left (true), or the one that a steadily displaced tool would
    /// have left.
    pub regeneration: bool,
    /// Displacement of the tool that left the surface before the pass began and, without
    /// regeneration, at any time: the deflection under the mean force, if the cut is to begin
    /// steadily and, without regeneration, to have its nominal chip; x and y count.
    pub steady_displacement_m: Vector3<f64>,
    /// How many earlier passes are remembered; a tooth that was out of the cut for longer finds the
    /// oldest of them.
    pub passes: usize,
    /// The edge is cut into slices over each of which it lags by no more than this, rad.
    pub slice_lag_rad: f64,
}

impl MillingParameters {
    /// Feed per revolution, m.
    pub fn feed_per_revolution_m(&self) -> f64 {
        self.feed_per_tooth_m * self.cutter.teeth as f64
    }

    /// Nominal x of the tool point, m.
    pub fn nominal_x_m(&self, rotation_rad: f64) -> f64 {
        self.feed_per_revolution_m() * rotation_rad / TAU
    }
}

/// Where the tool is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ToolState {
    /// Angle by which the spindle has turned, rad, not wrapped.
    pub rotation_rad: f64,
    /// Tool point minus its nominal position, milling frame, m.
    pub displacement_m: Vector3<f64>,
    /// Its change with rotation, m/rad; only a worn flank asks for it.
    pub displacement_m_per_rad: Vector3<f64>,
}
