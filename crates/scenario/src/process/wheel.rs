//! The `[process.wheel]` table: a compliant wheel polishes a strip on a flat plate.

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::wheel::WheelContact;

use crate::check::Check;
use crate::process::{Facts, Knob, ModesIn, Parts, PostureFrom, Room, WheelHold, WheelPart};
use crate::units::{from_mm, from_n_per_mm, from_rpm, from_um};

/// A compliant wheel, pressed along process X on a flat plate and fed along process Y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelSpec {
    /// The wheel where it touches the plate.
    pub contact: WheelContact,
    /// Speed of rotation, as a magnitude.
    pub spin_rad_s: f64,
    /// +1 if the wheel's surface runs with the feed over the plate, -1 if against it.
    pub surface_sign: f64,
    /// Contact force at the start.
    pub normal_force_n: f64,
    /// Feed speed along process Y.
    pub feed_m_per_s: f64,
    /// Length of the polished strip.
    pub strip_length_m: f64,
    /// Number of cells into which the strip is divided for removal.
    pub strip_cells: usize,
    /// Preston coefficient: removed depth per pressure and sliding distance.
    pub preston_per_pa: f64,
}

/// Which way the wheel's surface moves where it touches the plate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Spin {
    /// Against the feed, as the plate passes under the advancing wheel: friction pulls the tool
    /// along.
    Climb,
    /// With the feed, against the passing plate: friction holds the tool back.
    Against,
}

impl WheelSpec {
    /// Time of one pass over the strip.
    pub fn pass_s(&self) -> f64 {
        self.strip_length_m / self.feed_m_per_s
    }
}

/// A compliant wheel on a flat plate.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WheelTable {
    /// Radius of the unloaded wheel.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a wheel has a radius"))]
    radius_mm: f64,
    /// Width of the wheel.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a wheel has a width"))]
    width_mm: f64,
    /// Speed of rotation; `spin` gives its sense.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel turns; spin gives the sense"))]
    speed_rpm: f64,
    /// Which way the surface moves where it touches the plate. Climb: against the feed, as the
    /// plate passes under the advancing wheel; it rubs at surface speed less feed, and friction
    /// pulls the tool along. Against: with the feed; it rubs at surface speed plus feed, and
    /// friction holds the tool back.
    spin: Spin,
    /// Stiffness of the contact.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is elastic"))]
    stiffness_n_per_mm: f64,
    /// Damping of the contact. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "negative damping would create energy"))]
    damping_n_s_per_mm: Option<f64>,
    /// Contact force at the start.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is pressed on"))]
    normal_force_n: f64,
    /// Coefficient of friction between wheel and plate.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "friction opposes sliding"))]
    mu: f64,
    /// Eccentricity of the wheel. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "an eccentricity is a distance"))]
    eccentricity_um: Option<f64>,
    /// Feed speed.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the wheel is fed along the strip"))]
    feed_mm_per_s: f64,
    /// Length of the polished strip.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a strip has a length"))]
    strip_length_mm: f64,
    /// Number of cells along the strip. Default: 400.
    #[schemars(range(min = 1, max = 100_000), extend("x-rule" = "1 to 100000 cells"))]
    strip_cells: Option<u32>,
    /// Preston coefficient.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "polishing removes material"))]
    preston_per_pa: f64,
}

const TABLE: &str = "process.wheel";
const DEFAULT_STRIP_CELLS: u32 = 400;

impl WheelTable {
    pub(crate) fn resolve(self, check: &mut Check) -> WheelSpec {
        check.rim(TABLE, "speed_rpm", self.speed_rpm, from_mm(self.radius_mm));
        WheelSpec {
            contact: WheelContact {
                radius_m: from_mm(self.radius_mm),
                width_m: from_mm(self.width_mm),
                stiffness_n_per_m: from_n_per_mm(self.stiffness_n_per_mm),
                damping_n_s_per_m: from_n_per_mm(self.damping_n_s_per_mm.unwrap_or(0.0)),
                mu: self.mu,
                eccentricity_m: from_um(self.eccentricity_um.unwrap_or(0.0)),
                eccentricity_at_start_m: 0.0,
            },
            spin_rad_s: from_rpm(self.speed_rpm),
            surface_sign: match self.spin {
                Spin::Climb => -1.0,
                Spin::Against => 1.0,
            },
            normal_force_n: self.normal_force_n,
            feed_m_per_s: from_mm(self.feed_mm_per_s),
            strip_length_m: from_mm(self.strip_length_mm),
            strip_cells: self.strip_cells.unwrap_or(DEFAULT_STRIP_CELLS) as usize,
            preston_per_pa: self.preston_per_pa,
        }
    }
}

/// What a person could change at the machine.
const KNOBS: &[Knob] = &[
    Knob::new("process.wheel.speed_rpm", "wheel speed", &[0.5, 1.5]),
    Knob::new("process.wheel.normal_force_n", "normal force", &[0.5, 2.0]),
    Knob::new("process.wheel.feed_mm_per_s", "feed", &[0.5, 2.0]),
];

impl Room for WheelSpec {
    type Table = WheelTable;

    fn resolve(table: WheelTable, _folder: &Path, check: &mut Check) -> Option<Self> {
        Some(table.resolve(check))
    }

    fn facts(&self) -> Facts {
        Facts {
            rate_rad_s: Some(self.spin_rad_s),
            natural_duration_s: Some(self.pass_s()),
            signals: &[
                "wheel.normal_force",
                "tool.displacement_x",
                "wheel.position",
            ],
            knobs: KNOBS,
            files: &[],
            needs_drive: Some("wheel"),
            needs_robot: true,
            modes: ModesIn::Scenario,
            replays: false,
            posture: PostureFrom::Scenario,
            parts: Parts {
                wheel: Some(WheelPart {
                    hold: WheelHold::Path,
                    shows_removal: false,
                    turns: true,
                    over_edges: false,
                    indentation_m: self.normal_force_n / self.contact.stiffness_n_per_m,
                }),
                ..Parts::NONE
            },
        }
    }
}
