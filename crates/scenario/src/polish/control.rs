//! The `[process.polish.control]` table: what holds the normal force.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::document::Fault;
use crate::units::{from_mm, from_n_per_mm};

/// What holds the normal force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ControlSpec {
    /// The wheel keeps its place on the tool; the path reaches into the face.
    Position {
        /// How far the undeformed wheel would reach into the face.
        penetration_m: f64,
    },
    /// A carrier moves the wheel along the normal, without mass, at a speed in proportion to what is missing of the force.
    ConstantForce {
        /// Force that is held.
        force_n: f64,
        /// Missing force per speed of the carrier.
        damping_n_s_per_m: f64,
        /// Largest speed of the carrier.
        fastest_m_per_s: f64,
    },
    /// A carrier on a spring, a damper and a preload.
    Compliant {
        /// Preload: the force where the carrier stands in its middle.
        force_n: f64,
        /// Mass that moves with the wheel.
        mass_kg: f64,
        /// Stiffness of the spring.
        stiffness_n_per_m: f64,
        /// Damping of the damper.
        damping_n_s_per_m: f64,
        /// Stroke to either side.
        stroke_m: f64,
    },
}

/// Laws by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum LawName {
    /// The wheel keeps its place on the tool.
    Position,
    /// A carrier holds the force.
    ConstantForce,
    /// A carrier on a spring and a damper.
    Compliant,
}

/// What holds the normal force.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ControlTable {
    /// What holds the normal force.
    law: LawName,
    /// How far the undeformed wheel would reach into the face (law "position").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is pressed on"))]
    penetration_mm: Option<f64>,
    /// Normal force that is held (law "constant_force"), or preload (law "compliant").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is pressed on"))]
    force_n: Option<f64>,
    /// Missing force per speed of the carrier (law "constant_force"), or damping of the carrier (law "compliant").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "negative damping would create energy"))]
    damping_n_s_per_mm: Option<f64>,
    /// Largest speed of the carrier (law "constant_force").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the carrier moves"))]
    fastest_mm_per_s: Option<f64>,
    /// Mass that moves with the wheel (law "compliant").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "masses are positive"))]
    mass_kg: Option<f64>,
    /// Stiffness of the carrier's spring (law "compliant").
    #[schemars(extend("minimum" = 0.0, "x-rule" = "0 is a preload alone"))]
    stiffness_n_per_mm: Option<f64>,
    /// Stroke of the carrier to either side (law "compliant").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the carrier moves"))]
    stroke_mm: Option<f64>,
}

const TABLE: &str = "process.polish.control";

impl ControlTable {
    /// `None` after recording a fault.
    pub(super) fn resolve(self, radius_m: f64, check: &mut Check) -> Option<ControlSpec> {
        match self.law {
            LawName::Position => {
                let others = ["force_n", "damping_n_s_per_mm", "fastest_mm_per_s"];
                let because = "law = \"position\" has no carrier";
                check.ignored(TABLE, &others, because);
                check.ignored(
                    TABLE,
                    &["mass_kg", "stiffness_n_per_mm", "stroke_mm"],
                    because,
                );
                let who = "law = \"position\"";
                let penetration = check.needed(TABLE, "penetration_mm", self.penetration_mm, who);
                position(penetration?, radius_m, check)
            }
            LawName::ConstantForce => {
                let others = [
                    "penetration_mm",
                    "mass_kg",
                    "stiffness_n_per_mm",
                    "stroke_mm",
                ];
                check.ignored(
                    TABLE,
                    &others,
                    "law = \"constant_force\" holds a force without mass",
                );
                let who = "law = \"constant_force\"";
                let force = check.needed(TABLE, "force_n", self.force_n, who);
                let damping =
                    check.needed(TABLE, "damping_n_s_per_mm", self.damping_n_s_per_mm, who);
                let fastest = check.needed(TABLE, "fastest_mm_per_s", self.fastest_mm_per_s, who);
                Some(ControlSpec::ConstantForce {
                    force_n: force?,
                    damping_n_s_per_m: from_n_per_mm(damping?),
                    fastest_m_per_s: from_mm(fastest?),
                })
            }
            LawName::Compliant => {
                let others = ["penetration_mm", "fastest_mm_per_s"];
                check.ignored(TABLE, &others, "law = \"compliant\" presses by its preload");
                let who = "law = \"compliant\"";
                let force = check.needed(TABLE, "force_n", self.force_n, who);
                let mass = check.needed(TABLE, "mass_kg", self.mass_kg, who);
                let stiffness =
                    check.needed(TABLE, "stiffness_n_per_mm", self.stiffness_n_per_mm, who);
                let damping =
                    check.needed(TABLE, "damping_n_s_per_mm", self.damping_n_s_per_mm, who);
                let stroke = check.needed(TABLE, "stroke_mm", self.stroke_mm, who);
                Some(ControlSpec::Compliant {
                    force_n: force?,
                    mass_kg: mass?,
                    stiffness_n_per_m: from_n_per_mm(stiffness?),
                    damping_n_s_per_m: from_n_per_mm(damping?),
                    stroke_m: from_mm(stroke?),
                })
            }
        }
    }
}

fn position(penetration_mm: f64, radius_m: f64, check: &mut Check) -> Option<ControlSpec> {
    let penetration_m = from_mm(penetration_mm);
    if penetration_m >= radius_m {
        let path = format!("{TABLE}.penetration_mm");
        let message = format!(
            "`{path}` is {penetration_mm}, but must be less than the wheel's radius of {} mm",
            radius_m * 1e3
        );
        check.refuse(Fault::value(&path, message, "deeper than the wheel"));
        return None;
    }
    Some(ControlSpec::Position { penetration_m })
}
