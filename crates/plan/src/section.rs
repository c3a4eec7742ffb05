//! The stiffness ellipsoid at the tool and its section with the cutting plane.

use nalgebra::{Matrix3, Vector3};
use truecut_arm::{FrameId, Load, Robot, planar_principal, translational};
use truecut_core::stiffness::{
    PlanarDefinition, PlanarExtremes, StiffnessEllipsoid, planar_extremes,
};

use crate::error::PlanError;

/// All that is meant by the stiffness in a plane.
pub const DEFINITIONS: [PlanarDefinition; 4] = [
    PlanarDefinition::Free,
    PlanarDefinition::Held,
    PlanarDefinition::EllipsoidSection,
    PlanarDefinition::RootSection,
];

/// Stiffness at the tool point of one posture.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolStiffness {
    /// The ellipsoid of K = C_tt⁻¹ in world axes: rotation of the tool free, as it is.
    pub ellipsoid: StiffnessEllipsoid,
    /// Its section with the cutting plane by each definition. [`PlanarDefinition::Free`] is the
    /// **physical** one: a force within the plane meets it, since nothing holds the tool across the
    /// plane nor against turning. The others hold the tool across the plane (`Held`), or belong to
    /// no load at all.
    pub sections: [(PlanarDefinition, PlanarExtremes); 4],
}

/// Stiffness at the tool point, with the cutting plane that of the first two columns of
/// `world_from_milling`.
///
/// # Errors
/// If the arm is not compliant in every direction there.
pub fn tool_stiffness(
    robot: &Robot,
    posture: &[f64],
    world_from_milling: &Matrix3<f64>,
) -> Result<ToolStiffness, PlanError> {
    let compliance = robot.cartesian_compliance(posture, FrameId::Tool, &Load::none())?;
    let singular = || PlanError::Arm(truecut_arm::ArmErrorKind::SingularCompliance.into());
    let stiffness = translational(&compliance)
        .try_inverse()
        .ok_or_else(singular)?;
    let section = |definition| {
        let extremes = planar_extremes(&stiffness, world_from_milling, definition);
        extremes
            .map(|extremes| (definition, extremes))
            .ok_or_else(singular)
    };
    let [free, held, ellipsoid, root] = DEFINITIONS;
    Ok(ToolStiffness {
        ellipsoid: StiffnessEllipsoid::of(&stiffness),
        sections: [
            section(free)?,
            section(held)?,
            section(ellipsoid)?,
            section(root)?,
        ],
    })
}

/// r = (k_max − k_min)/k_max in the cutting plane by the physical definition.
pub(crate) fn free_anisotropy(
    compliance_m_per_n: &Matrix3<f64>,
    world_from_milling: &Matrix3<f64>,
) -> f64 {
    let turned = world_from_milling.transpose() * compliance_m_per_n * world_from_milling;
    let plane = planar_principal(&turned, &Vector3::x_axis(), &Vector3::y_axis());
    1.0 - plane.k_min_n_per_m / plane.k_max_n_per_m
}
