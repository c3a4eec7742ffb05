//! The `[[robot.link]]` and `[[robot.joint]]` tables: values that differ from the robot's files.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::units::from_mm;

/// How a link differs from the URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkSpec {
    /// Name of a moving link of the chain.
    pub name: String,
    /// Factor on mass and inertia.
    pub mass_factor: f64,
    /// Added to the centre of mass, in the link's frame.
    pub center_m: [f64; 3],
}

/// How a joint differs from robot.toml.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSpec {
    /// Name of a joint of the chain.
    pub name: String,
    /// Factor on the rotor inertia.
    pub rotor_inertia_factor: f64,
    /// Factor on the stiffness of its transmission.
    pub stiffness_factor: f64,
    /// Factor on the damping of its transmission.
    pub damping_factor: f64,
}

/// Inertial values of a link that differ from the URDF. Links are rarely weighed.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LinkTable {
    /// Link of the URDF that a joint moves.
    name: String,
    /// Factor on its mass and inertia. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "masses are positive"))]
    mass_factor: Option<f64>,
    /// Added to its centre of mass, along x of the link's frame. Default: 0.
    center_x_mm: Option<f64>,
    /// Added to its centre of mass, along y of the link's frame. Default: 0.
    center_y_mm: Option<f64>,
    /// Added to its centre of mass, along z of the link's frame. Default: 0.
    center_z_mm: Option<f64>,
}

/// Values of a drive that differ from robot.toml.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointTable {
    /// Joint of the URDF.
    name: String,
    /// Factor on the inertia of its rotor. Default: 1.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "inertias are not negative"))]
    rotor_inertia_factor: Option<f64>,
    /// Factor on the stiffness of its transmission. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "stiffnesses are positive"))]
    stiffness_factor: Option<f64>,
    /// Factor on the damping of its transmission. Default: 1.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "negative damping would create energy"))]
    damping_factor: Option<f64>,
}

pub(crate) fn links(tables: Option<Vec<LinkTable>>, check: &mut Check) -> Vec<LinkSpec> {
    let tables = tables.unwrap_or_default();
    check.names_differ("robot.link", tables.iter().map(|one| &one.name));
    let resolve = |table: LinkTable| LinkSpec {
        name: table.name,
        mass_factor: table.mass_factor.unwrap_or(1.0),
        center_m: [table.center_x_mm, table.center_y_mm, table.center_z_mm]
            .map(|offset| from_mm(offset.unwrap_or(0.0))),
    };
    tables.into_iter().map(resolve).collect()
}

/// `ignored` are factors that have no effect in this robot, and why.
pub(crate) fn joints(
    tables: Option<Vec<JointTable>>,
    (ignored, because): (&[&str], &str),
    check: &mut Check,
) -> Vec<JointSpec> {
    let tables = tables.unwrap_or_default();
    for index in 0..tables.len() {
        check.ignored(&format!("robot.joint.{index}"), ignored, because);
    }
    check.names_differ("robot.joint", tables.iter().map(|one| &one.name));
    let resolve = |table: JointTable| JointSpec {
        name: table.name,
        rotor_inertia_factor: table.rotor_inertia_factor.unwrap_or(1.0),
        stiffness_factor: table.stiffness_factor.unwrap_or(1.0),
        damping_factor: table.damping_factor.unwrap_or(1.0),
    };
    tables.into_iter().map(resolve).collect()
}
