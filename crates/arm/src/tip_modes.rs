//! The arm's modes as a cutting process feels them.

use nalgebra::Vector3;
use truecut_core::chatter::TipMode;

use crate::error::ArmError;
use crate::model::{FrameId, Robot};
use crate::tangent::Load;

impl Robot {
    /// Modes at posture `q` with their mass-normalised shapes J_vφ at the origin of `frame`, world
    /// axes, slowest first; `gravity_m_s2` adds ∂g/∂q to the transmission stiffness. Damping ratios
    /// are φᵀDφ/(2ω), those of the modes taken singly.
    ///
    /// # Errors
    /// As [`Robot::modes`].
    pub fn tip_modes(
        &self,
        q: &[f64],
        frame: FrameId,
        gravity_m_s2: Option<&Vector3<f64>>,
    ) -> Result<Vec<TipMode>, ArmError> {
        let load = Load {
            gravity_m_s2: gravity_m_s2.copied(),
            wrench: None,
        };
        let linear = self.linearised(q, frame, &load)?;
        let modes = linear.modes()?;
        let tip = &linear.tip_jacobian * &modes.shapes;
        let frequencies = modes.frequency_hz.iter().zip(&modes.damping_ratio);
        let tip_modes = frequencies.enumerate().map(|(j, (hz, zeta))| TipMode {
            natural_frequency_rad_s: std::f64::consts::TAU * hz,
            damping_ratio: *zeta,
            shape_per_sqrt_kg: Vector3::new(tip[(0, j)], tip[(1, j)], tip[(2, j)]),
        });
        Ok(tip_modes.collect())
    }
}
