//! What an abrasive does to the face that it rubs on.

use crate::roughness::Polishing;

/// Friction, removal and smoothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Abrasive {
    /// Coefficient of friction on the face.
    pub mu: f64,
    /// Preston coefficient: removed depth per pressure and sliding distance, 1/Pa.
    pub preston_per_pa: f64,
    /// How the surface smooths.
    pub polishing: Polishing,
}
