//! The `[process.milling.cutter]` table, and where its teeth meet material.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::chatter::{AttachedMode, SpeedTable};
use truecut_core::cutting::milling::cutter::{Cutter, Runout};
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_core::cutting::milling::flank::Flank;

use crate::check::Check;
use crate::units::{from_deg, from_mm, from_um};

use crate::modes::{self, ModeTable};

const TABLE: &str = "process.milling";
/// Lengths that differ by this part of them are one.
const SAME: f64 = 1e-9;

/// Engagements by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum EngagementName {
    /// The whole diameter.
    Slot,
    /// Up-milling: teeth enter at the wall they make.
    Up,
    /// Down-milling: teeth leave at the wall they make.
    Down,
    /// Between the angles entry_deg and exit_deg.
    Between,
}

/// An end mill: flat, bull-nose or ball.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::process) struct CutterTable {
    /// Diameter.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a cutter has a diameter"))]
    diameter_mm: f64,
    /// Radius of the corner between end and upright part along a path in stock: 0 of a flat cutter,
    /// half the diameter of a ball. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "0 is a flat end, half the diameter a ball"))]
    corner_radius_mm: Option<f64>,
    /// Number of equally spaced teeth.
    #[schemars(range(min = 1, max = 64), extend("x-rule" = "a cutter has 1 to 64 teeth"))]
    teeth: u32,
    /// Angle between cutting edge and tool axis; positive if the edge lags behind with height.
    /// Default: 0.
    #[schemars(range(min = -75.0, max = 75.0), extend("x-rule" = "an edge runs along the cutter"))]
    helix_deg: Option<f64>,
    /// Offset of the cutter's axis from the spindle's. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "runout_angle_deg gives the direction"))]
    runout_um: Option<f64>,
    /// Angle of that offset from the first tooth, in the sense of rotation. Default: 0.
    runout_angle_deg: Option<f64>,
    /// Width of the wear land on the flanks along the cutting speed. Default: that of the cutting
    /// force coefficients.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "0 is a sharp edge"))]
    wear_land_mm: Option<f64>,
    /// Whether the teeth's ends cut from the axis to the rim, so that the cutter can plunge and
    /// ramp along a path in stock. Default: false; a ball's edges reach its axis.
    centre_cutting: Option<bool>,
    /// Modes of cutter, holder and spindle at the tip, the flange held. Default: they are rigid.
    #[schemars(extend("maxItems" = 6, "x-rule" = "a tool has at most 6 modes here"))]
    mode: Option<Vec<ModeTable>>,
}

impl CutterTable {
    /// Width of the wear land that the table gives.
    pub(in crate::process) fn wear_land_m(&self) -> Option<f64> {
        self.wear_land_mm.map(from_mm)
    }

    /// With sharp flanks, and modes; `table` is its own key.
    pub(in crate::process) fn resolve(
        self,
        table: &str,
        check: &mut Check,
    ) -> (Cutter, (Vec<AttachedMode>, Vec<SpeedTable>)) {
        let diameter_m = from_mm(self.diameter_mm);
        let runout_m = from_um(self.runout_um.unwrap_or(0.0));
        if runout_m == 0.0 {
            check.ignored(table, &["runout_angle_deg"], "the cutter has no runout");
        }
        if runout_m >= 0.25 * diameter_m {
            let message = format!(
                "is {}, but must be less than half the cutter's radius of {} mm: every \
                 tooth has a radius",
                runout_m * 1e6,
                diameter_m * 5e2
            );
            check.wrong(table, "runout_um", message, "too much for the cutter");
        }
        let corner_radius_m = self.corner_m(table, check);
        let is_ball = corner_radius_m == 0.5 * diameter_m;
        if is_ball && self.centre_cutting == Some(false) {
            let is = "is false, but must be true or left out: a ball's edges reach its axis";
            check.wrong(table, "centre_cutting", is, "of a ball");
        }
        let cutter = Cutter {
            radius_m: 0.5 * diameter_m,
            corner_radius_m,
            teeth: self.teeth as usize,
            helix_angle_rad: from_deg(self.helix_deg.unwrap_or(0.0)),
            runout: Runout {
                offset_m: runout_m,
                angle_rad: from_deg(self.runout_angle_deg.unwrap_or(0.0)),
            },
            flank: Flank::default(),
            centre_cutting: self.centre_cutting.unwrap_or(is_ball),
        };
        let list = format!("{table}.mode");
        let modes = modes::resolve(self.mode.unwrap_or_default(), &list, check);
        (cutter, modes)
    }

    /// Corner radius, m; no larger than the radius.
    fn corner_m(&self, table: &str, check: &mut Check) -> f64 {
        let corner_mm = self.corner_radius_mm.unwrap_or(0.0);
        let radius_mm = 0.5 * self.diameter_mm;
        if corner_mm > radius_mm * (1.0 + SAME) {
            let is = format!(
                "is {corner_mm}, but must be at most half the cutter's diameter, {radius_mm} mm: that is a ball"
            );
            check.wrong(table, "corner_radius_mm", is, "rounder than the cutter");
        }
        match corner_mm >= radius_mm * (1.0 - SAME) {
            true => 0.5 * from_mm(self.diameter_mm),
            false => from_mm(corner_mm),
        }
    }
}

/// Where teeth enter and leave; `None` after recording a fault.
pub(super) fn engaged(
    name: EngagementName,
    radial_depth_mm: Option<f64>,
    [entry_deg, exit_deg]: [Option<f64>; 2],
    diameter_m: f64,
    check: &mut Check,
) -> Option<Engagement> {
    if matches!(name, EngagementName::Slot | EngagementName::Between) {
        let because = "only the engagements \"up\" and \"down\" have a radial depth";
        check.ignored(TABLE, &["radial_depth_mm"], because);
    }
    if name != EngagementName::Between {
        let because = "only engagement = \"between\" is given by angles";
        check.ignored(TABLE, &["entry_deg", "exit_deg"], because);
    }
    let who = "this engagement";
    match name {
        EngagementName::Slot => Some(Engagement::SLOT),
        EngagementName::Up => Engagement::up(
            radial_depth_m(radial_depth_mm, diameter_m, check)?,
            diameter_m,
        )
        .ok(),
        EngagementName::Down => Engagement::down(
            radial_depth_m(radial_depth_mm, diameter_m, check)?,
            diameter_m,
        )
        .ok(),
        EngagementName::Between => {
            let entry = check.needed(TABLE, "entry_deg", entry_deg, who)?;
            let exit = check.needed(TABLE, "exit_deg", exit_deg, who)?;
            if entry >= exit {
                let message = format!(
                    "is {exit}, but must be greater than entry_deg = {entry}: teeth \
                     leave after they enter"
                );
                check.wrong(TABLE, "exit_deg", message, "not behind the entry");
            }
            Some(Engagement {
                entry_rad: from_deg(entry),
                exit_rad: from_deg(exit),
            })
        }
    }
}

/// `None` after recording a fault.
fn radial_depth_m(depth_mm: Option<f64>, diameter_m: f64, check: &mut Check) -> Option<f64> {
    let depth_mm = check.needed(TABLE, "radial_depth_mm", depth_mm, "this engagement")?;
    let depth_m = from_mm(depth_mm);
    if depth_m > diameter_m {
        let message = format!(
            "is {depth_mm}, but must be at most the cutter's diameter of {} mm: it cuts \
             no wider",
            diameter_m * 1e3
        );
        check.wrong(TABLE, "radial_depth_mm", message, "wider than the cutter");
    }
    // What else is wrong is told with the widest cut.
    Some(depth_m.min(diameter_m))
}
