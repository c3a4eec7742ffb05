//! The `[process.polish.precession]` table: how the spin axis turns about the normal of the face.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::wheel::precession::{ChordExtent, EdgeRule};
use truecut_plan::motion::polish::Precession;
use truecut_plan::precession::PrecessionLimits;

use crate::check::Check;
use crate::units::{from_deg, from_rpm};

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
    /// Angle towards which the spin axis leans at the start, from the face's x axis towards its y
    /// axis. Default: 0.
    start_deg: Option<f64>,
    /// What is asked for at edges.
    rule: RuleName,
    /// Least cosine between the velocity in the middle of the patch and an edge's outward normal
    /// (rule "cosine").
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

/// Largest acceleration along the path where a plan lowers the feed, m/s²; no key gives it.
const FEED_ACCELERATION_M_S2: f64 = 0.5;

impl PrecessionTable {
    /// `None` after recording a fault.
    pub(super) fn resolve(self, check: &mut Check) -> Option<Precession> {
        let limits = [
            self.largest_rate_deg_per_s,
            self.largest_acceleration_deg_per_s2,
        ];
        let at_edges = at_edges(self.rule, self.epsilon, limits, check);
        Some(Precession {
            turn_rad_s: from_rpm(self.turn_rpm),
            start_rad: from_deg(self.start_deg.unwrap_or(0.0)),
            at_edges: at_edges?,
        })
    }
}

/// Rule and limits; the outer `None` after recording a fault.
fn at_edges(
    rule: RuleName,
    epsilon: Option<f64>,
    [rate, acceleration]: [Option<f64>; 2],
    check: &mut Check,
) -> Option<Option<(EdgeRule, PrecessionLimits)>> {
    if rule != RuleName::Cosine {
        let because = "only rule = \"cosine\" has a least cosine";
        check.ignored(TABLE, &["epsilon"], because);
    }
    let limits = ["largest_rate_deg_per_s", "largest_acceleration_deg_per_s2"];
    let (who, rule) = match rule {
        RuleName::None => {
            let because = "with rule = \"none\" the angle turns steadily";
            check.ignored(TABLE, &limits, because);
            return Some(None);
        }
        RuleName::Cosine => {
            let who = "rule = \"cosine\"";
            let epsilon = check.needed(TABLE, "epsilon", epsilon, who);
            (who, epsilon.map(|epsilon| EdgeRule::Paper { epsilon }))
        }
        RuleName::Exact => {
            let rule = EdgeRule::Exact(ChordExtent::Clipped);
            ("rule = \"exact\"", Some(rule))
        }
    };
    let rate = check.needed(TABLE, limits[0], rate, who);
    let acceleration = check.needed(TABLE, limits[1], acceleration, who);
    let limits = PrecessionLimits {
        rate_rad_s: from_deg(rate?),
        acceleration_rad_s2: from_deg(acceleration?),
        feed_acceleration_m_s2: FEED_ACCELERATION_M_S2,
    };
    Some(Some((rule?, limits)))
}
