//! What the estimated stiffnesses are worth: how far the first mode and the stiffness at the tool
//! move if one of them is off, or all are.

use nalgebra::SymmetricEigen;
use serde::Serialize;

use crate::compliance::translational;
use crate::estimate::STIFFNESS_FACTOR;
use crate::estimated::is_estimate;
use crate::model::{FrameId, Robot};
use crate::tangent::Load;

/// Results with the stiffness of a joint, or of all that are estimated, lower and higher by a
/// factor.
#[derive(Debug, Clone, Serialize)]
pub struct EstimateReport {
    /// Its name, or `all`.
    pub joint: String,
    /// The factor.
    pub factor: f64,
    /// First mode with the stiffness divided and multiplied by the factor.
    pub first_mode_hz: [f64; 2],
    /// Stiffness at the tool in its softest direction, likewise.
    pub softest_n_per_m: [f64; 2],
}

impl Robot {
    /// One entry for each joint whose stiffness says that it is estimated, and one for all of them
    /// where there are several.
    pub(crate) fn estimate_reports(&self, posture: &[f64]) -> Vec<EstimateReport> {
        let joints = self.chain.joints.iter().enumerate();
        let estimated = joints.filter(|(_, joint)| {
            let transmission = &joint.transmission;
            transmission.stiffness.is_some() && is_estimate(&transmission.sources.stiffness)
        });
        let estimated: Vec<usize> = estimated.map(|(index, _)| index).collect();
        let name = |index: &usize| self.chain.joints[*index].name.clone();
        let single = estimated.iter().map(|index| (name(index), vec![*index]));
        let all = (estimated.len() > 1).then(|| ("all".to_owned(), estimated.clone()));
        let reported = single.chain(all).filter_map(|(joint, joints)| {
            let factors = [1.0 / STIFFNESS_FACTOR, STIFFNESS_FACTOR];
            let [low, high] = factors.map(|factor| self.with_factor(&joints, factor, posture));
            let (low, high) = (low?, high?);
            Some(EstimateReport {
                joint,
                factor: STIFFNESS_FACTOR,
                first_mode_hz: [low.0, high.0],
                softest_n_per_m: [low.1, high.1],
            })
        });
        reported.collect()
    }

    /// First mode and softest stiffness with the stiffness of some joints changed.
    fn with_factor(&self, joints: &[usize], factor: f64, posture: &[f64]) -> Option<(f64, f64)> {
        let mut other = self.clone();
        for joint in joints {
            let stiffness = &mut other.chain.joints[*joint].transmission.stiffness;
            *stiffness = stiffness.map(|value| value * factor);
        }
        let modes = other.modes(posture, None).ok()?;
        Some((modes.frequency_hz[0], other.softest_n_per_m(posture)?))
    }

    /// Stiffness at the tool in its softest direction.
    pub(crate) fn softest_n_per_m(&self, posture: &[f64]) -> Option<f64> {
        let compliance = self.cartesian_compliance(posture, FrameId::Tool, &Load::none());
        let compliance = translational(&compliance.ok()?);
        let largest = SymmetricEigen::new(compliance).eigenvalues.max();
        (largest > 0.0).then(|| 1.0 / largest)
    }
}
