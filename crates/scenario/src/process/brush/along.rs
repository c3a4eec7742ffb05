//! The `[process.brush.along]` table: the way is laid along the edges that points pick.

use nalgebra::UnitVector3;
use schemars::JsonSchema;
use serde::Deserialize;
use truecut_plan::edge_path::{EdgeLaying, Tilt};

use super::TABLE as BRUSH;
use crate::check::Check;
use crate::units::{from_deg, from_mm};

/// A way along the edges, and how fast the arm goes.
#[derive(Debug, Clone, PartialEq)]
pub struct AlongEdges {
    /// How the way is laid.
    pub laying: EdgeLaying,
    /// Largest speed of a joint, on lines and from edge to edge, share of its top speed.
    pub joint_share: f64,
}

/// The way along the edges.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct AlongTable {
    /// Speed of the brush's centre along an edge, and down to it and off it.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the brush is fed along the edge"))]
    feed_mm_per_s: f64,
    /// How far the unbent brush reaches beyond the edge.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a brush that does not touch brushes nothing"))]
    indentation_mm: f64,
    /// How far the brush runs on beyond both ends of an open edge; along a closed one over what way
    /// it is brought down, and lifted. Default: the brush's width.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the brush comes to its depth on a way"))]
    lead_mm: Option<f64>,
    /// How far the brush is off the edge before and after it. Default: its radius.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the brush leaves the part between edges"))]
    lift_mm: Option<f64>,
    /// By how much the brush's centre is turned about the edge from midway between the faces.
    /// Default: 0.
    #[schemars(extend("minimum" = 0.0, "maximum" = 90.0, "x-rule" = "the brush stands outside the material; `tilt_towards` gives the side"))]
    tilt_deg: Option<f64>,
    /// The side to which it is, in the mesh's frame: [0, 0, 1] lifts the centre.
    tilt_towards: Option<[f64; 3]>,
    /// Largest distance of points along the edge. Default: 2.
    #[schemars(extend("minimum" = 0.02, "x-rule" = "programs print thousandths of a millimetre, by which nearer points would lose the line's direction"))]
    step_mm: Option<f64>,
    /// Top speed of joints, a fraction of their limits: from edge to edge, where the arm goes by
    /// joints, and on lines, which are slower than their feed where a joint would be faster.
    /// Default: 0.5.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0, "x-rule" = "a fraction of the top speed"))]
    joint_speed: Option<f64>,
}

const TABLE: &str = "process.brush.along";
const DEFAULT_STEP_MM: f64 = 2.0;
const DEFAULT_JOINT_SHARE: f64 = 0.5;

impl AlongTable {
    /// `None` after recording a fault. The brush is its radius, width and free length, mm.
    pub(super) fn resolve(
        self,
        (radius_mm, width_mm, free_length_mm): (f64, f64, f64),
        check: &mut Check,
    ) -> Option<AlongEdges> {
        let fits = self.indentation_mm < free_length_mm;
        if !fits {
            let is = format!(
                "is {}, but must be below `{BRUSH}.free_length_mm`, {free_length_mm} mm: the hub would strike the edge",
                self.indentation_mm
            );
            check.wrong(
                TABLE,
                "indentation_mm",
                is,
                "deeper than the bristles are long",
            );
        }
        let tilt = self.tilt(check);
        fits.then_some(())?;
        Some(AlongEdges {
            laying: EdgeLaying {
                radius_m: from_mm(radius_mm),
                indentation_m: from_mm(self.indentation_mm),
                lead_m: from_mm(self.lead_mm.unwrap_or(width_mm)),
                lift_m: from_mm(self.lift_mm.unwrap_or(radius_mm)),
                tilt: tilt?,
                step_m: from_mm(self.step_mm.unwrap_or(DEFAULT_STEP_MM)),
                feed_m_per_s: from_mm(self.feed_mm_per_s),
            },
            joint_share: self.joint_speed.unwrap_or(DEFAULT_JOINT_SHARE),
        })
    }

    /// `None` after recording a fault.
    fn tilt(&self, check: &mut Check) -> Option<Option<Tilt>> {
        let angle_deg = self.tilt_deg.unwrap_or(0.0);
        if angle_deg == 0.0 {
            let because = "without `tilt_deg` the brush stands midway between the faces";
            check.ignored(TABLE, &["tilt_towards"], because);
            return Some(None);
        }
        let who = "a brush that is tilted about the edge";
        let towards = check.needed(TABLE, "tilt_towards", self.tilt_towards, who)?;
        let towards = check.direction(&format!("{TABLE}.tilt_towards"), towards)?;
        Some(Some(Tilt {
            angle_rad: from_deg(angle_deg),
            towards: UnitVector3::new_normalize(towards.into()),
        }))
    }
}
