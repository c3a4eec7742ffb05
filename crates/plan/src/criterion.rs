//! By what a posture counts as stable.

use strum::{Display, VariantArray};
use truecut_core::chatter::{AttachedModes, AveragedCut, DirectionalMatrix};
use truecut_core::cutting::milling::nominal::NominalCut;

/// Least anisotropy of the published rule.
pub const LEAST_ANISOTROPY: f64 = 0.1;

/// What is cut, and how fast.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    pub nominal: NominalCut,
    pub spindle_rad_s: f64,
    /// What bends beside the arm.
    pub attached: AttachedModes,
}

impl Cut {
    /// Time between two teeth, s.
    pub fn tooth_period_s(&self) -> f64 {
        self.nominal.cutter.tooth_period_s(self.spindle_rad_s)
    }

    /// Speed of the tool along its path, m/s.
    pub fn feed_m_per_s(&self) -> f64 {
        self.nominal.feed_per_tooth_m / self.tooth_period_s()
    }

    /// The cut averaged over a revolution at its own spindle speed.
    pub fn averaged(&self) -> AveragedCut {
        self.directional().averaged(self.tooth_period_s())
    }

    /// The directional matrix in the milling frame.
    pub fn directional(&self) -> DirectionalMatrix {
        DirectionalMatrix::from(&self.nominal)
    }
}

/// By what a posture counts as stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Display, VariantArray)]
pub enum Criterion {
    /// r = (k_max − k_min)/k_max in the cutting plane is at least 0.1. Knows neither depth nor
    /// teeth nor material.
    #[strum(to_string = "stiffness anisotropy")]
    Anisotropy,
    /// Undamped planar mode coupling of two directions with equal masses.
    #[strum(to_string = "planar flutter")]
    Flutter,
    /// Mode coupling of all damped modes under the averaged cut, teeth meeting the nominal surface.
    #[strum(to_string = "6-DoF mode coupling")]
    ModeCoupling,
    /// Regeneration with all damped modes and the floor, by spectral elements. It asks for the
    /// depth, and for vibration that dies away fast enough at that depth.
    #[strum(to_string = "regeneration")]
    Regenerative,
}

impl Criterion {
    pub const ALL: &[Self] = Self::VARIANTS;

    /// What the assessed value must reach: an anisotropy, or the depth in m.
    pub fn needed(self, cut: &Cut) -> f64 {
        match self {
            Self::Anisotropy => LEAST_ANISOTROPY,
            _ => cut.nominal.axial_depth_m,
        }
    }
}
