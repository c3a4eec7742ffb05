//! The `[process.polish.precession]` table: how the spin axis turns about the normal of the face.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::units::{from_deg, from_rpm};

/// How the spin axis turns about the normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrecessionSpec {
    /// Rate of the steady turn, from the face's x axis towards its y axis; negative: the other way.
    pub turn_rad_s: f64,
    /// Angle towards which the axis leans at the start.
    pub start_rad: f64,
    /// What is asked for at edges.
    pub rule: EdgeRuleSpec,
}

/// What is asked of the precession angle at edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EdgeRuleSpec {
    /// Nothing: the angle turns steadily.
    None,
    /// Velocity in the middle of the patch and outward normal of every edge in it enclose an angle whose cosine is ε at least.
    Cosine {
        /// ε.
        epsilon: f64,
        /// Largest rate of the angle.
        rate_rad_s: f64,
        /// Largest acceleration of the angle.
        acceleration_rad_s2: f64,
    },
    /// No point of an edge in the patch moves inward.
    Exact {
        /// Largest rate of the angle.
        rate_rad_s: f64,
        /// Largest acceleration of the angle.
        acceleration_rad_s2: f64,
    },
}

/// Rules by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum RuleName {
    /// The angle turns steadily.
    None,
    /// cos β of every edge in the patch is epsilon at least.
    Cosine,
    /// No point of an edge in the patch moves inward.
    Exact,
}

/// How the spin axis turns about the normal.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PrecessionTable {
    /// Rate of the steady turn, from the face's x axis towards its y axis; negative: the other way.
    turn_rpm: f64,
    /// Angle towards which the spin axis leans at the start, from the face's x axis towards its y axis. Default: 0.
    start_deg: Option<f64>,
    /// What is asked for at edges.
    rule: RuleName,
    /// Least cosine between the velocity in the middle of the patch and an edge's outward normal (rule "cosine").
    #[schemars(extend("minimum" = 0.0, "exclusiveMaximum" = 1.0, "x-rule" = "a cosine; 0 lets the middle of the patch move along the edge"))]
    epsilon: Option<f64>,
    /// Largest rate of the angle (rules "cosine" and "exact").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the angle turns"))]
    largest_rate_deg_per_s: Option<f64>,
    /// Largest acceleration of the angle (rules "cosine" and "exact").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the angle turns"))]
    largest_acceleration_deg_per_s2: Option<f64>,
}

const TABLE: &str = "process.polish.precession";

impl PrecessionTable {
    /// `None` after recording a fault.
    pub(super) fn resolve(self, check: &mut Check) -> Option<PrecessionSpec> {
        let rule = self.rule(check);
        Some(PrecessionSpec {
            turn_rad_s: from_rpm(self.turn_rpm),
            start_rad: from_deg(self.start_deg.unwrap_or(0.0)),
            rule: rule?,
        })
    }

    fn rule(&self, check: &mut Check) -> Option<EdgeRuleSpec> {
        if self.rule != RuleName::Cosine {
            let because = "only rule = \"cosine\" has a least cosine";
            check.ignored(TABLE, &["epsilon"], because);
        }
        let limits = ["largest_rate_deg_per_s", "largest_acceleration_deg_per_s2"];
        let (who, epsilon) = match self.rule {
            RuleName::None => {
                check.ignored(
                    TABLE,
                    &limits,
                    "with rule = \"none\" the angle turns steadily",
                );
                return Some(EdgeRuleSpec::None);
            }
            RuleName::Cosine => {
                let who = "rule = \"cosine\"";
                (who, check.needed(TABLE, "epsilon", self.epsilon, who))
            }
            RuleName::Exact => ("rule = \"exact\"", None),
        };
        let rate = check.needed(TABLE, limits[0], self.largest_rate_deg_per_s, who);
        let acceleration = self.largest_acceleration_deg_per_s2;
        let acceleration = check.needed(TABLE, limits[1], acceleration, who);
        let (rate_rad_s, acceleration_rad_s2) = (from_deg(rate?), from_deg(acceleration?));
        Some(match self.rule {
            RuleName::Cosine => EdgeRuleSpec::Cosine {
                epsilon: epsilon?,
                rate_rad_s,
                acceleration_rad_s2,
            },
            _ => EdgeRuleSpec::Exact {
                rate_rad_s,
                acceleration_rad_s2,
            },
        })
    }
}
