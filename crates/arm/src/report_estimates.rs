//! What the estimated stiffnesses are worth: how far the first mode and the stiffness at the tool
//! move if one of them is off.

use nalgebra::SymmetricEigen;
use serde::Serialize;

use crate::compliance::translational;
use crate::estimate::STIFFNESS_FACTOR;
use crate::model::{FrameId, Robot};
use crate::tangent::Load;

/// Results with the stiffness of one joint lower and higher by a factor.
#[derive(Debug, Clone, Serialize)]
pub struct EstimateReport {
    pub joint: String,
    /// The factor.
    pub factor: f64,
    /// First mode with the stiffness divided and multiplied by the factor.
    pub first_mode_hz: [f64; 2],
    /// Stiffness at the tool in its softest direction, likewise.
    pub softest_n_per_m: [f64; 2],
}

impl Robot {
    /// One entry for each joint whose stiffness says that it is estimated.
    pub(crate) fn estimate_reports(&self, posture: &[f64]) -> Vec<EstimateReport> {
        let joints = self.chain.joints.iter().enumerate();
        let estimated = joints.filter(|(_, joint)| {
            let transmission = &joint.transmission;
            transmission.stiffness.is_some()
                && transmission.sources.stiffness.starts_with("estimated")
        });
        let factors = [1.0 / STIFFNESS_FACTOR, STIFFNESS_FACTOR];
        estimated
            .filter_map(|(index, joint)| {
                let [low, high] = factors.map(|factor| self.with_factor(index, factor, posture));
                let (low, high) = (low?, high?);
                Some(EstimateReport {
                    joint: joint.name.clone(),
                    factor: STIFFNESS_FACTOR,
                    first_mode_hz: [low.0, high.0],
                    softest_n_per_m: [low.1, high.1],
                })
            })
            .collect()
    }

    /// First mode and softest stiffness with the stiffness of one joint changed.
    fn with_factor(&self, joint: usize, factor: f64, posture: &[f64]) -> Option<(f64, f64)> {
        let mut other = self.clone();
        let stiffness = &mut other.chain.joints[joint].transmission.stiffness;
        *stiffness = stiffness.map(|value| value * factor);
        let modes = other.modes(posture, None).ok()?;
        let compliance = other.cartesian_compliance(posture, FrameId::Tool, &Load::none());
        let compliance = translational(&compliance.ok()?);
        let largest = SymmetricEigen::new(compliance).eigenvalues.max();
        Some((modes.frequency_hz[0], 1.0 / largest))
    }
}
