//! The `[process.polish]` table: a soft wheel in precession polishes a rectangular face along a
//! raster.

mod face;
mod grains;
mod path;
mod precession;
mod texture;
mod wheel;

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::wheel::abrasive::Abrasive;
use truecut_core::wheel::force_control::ForceControl;
use truecut_core::wheel::pneumatic::PneumaticWheel;
use truecut_plan::motion::polish::{Precession, RectangularFace};
use truecut_plan::motion::raster::Raster;

use crate::check::Check;
use crate::control::{ControlTable, Pressed};
use crate::process::{Facts, Knob, ModesIn, Parts, PostureFrom, Room, WheelPart, hold};
use crate::roughness::RoughnessTable;
use crate::units::{from_deg, from_rpm, from_um};
use face::FaceTable;
use grains::GrainTable;
use path::RasterTable;
use precession::PrecessionTable;
use texture::TextureTable;
pub(super) use wheel::PneumaticTable;

pub use grains::GrainSpec;
pub use texture::TextureSpec;

/// Polishing of a rectangular face. The robot's tool frame stands in the wheel's centre, its z axis
/// is the spin axis and points towards the face.
#[derive(Debug, Clone, PartialEq)]
pub struct PolishSpec {
    /// The wheel.
    pub wheel: PneumaticWheel,
    /// Spin about the axis that points away from the face; negative: about its opposite.
    pub spin_rad_s: f64,
    /// Angle between spin axis and normal of the face.
    pub tilt_rad: f64,
    /// What the wheel does to the face.
    pub abrasive: Abrasive,
    /// Distance of the wheel's middle from the spin axis.
    pub eccentricity_m: f64,
    /// Angle about the spin axis, from the tool's x axis towards its y axis, at which the middle
    /// stands at the start.
    pub eccentricity_angle_rad: f64,
    /// The face.
    pub face: RectangularFace,
    /// Size of the cells on which removal is kept, as asked for.
    pub cell_m: f64,
    /// The path of the patch's middle.
    pub path: Raster,
    /// How the spin axis turns about the normal.
    pub precession: Precession,
    /// What holds the normal force.
    pub control: ForceControl,
    /// How far the undeformed wheel reaches into the face along the path; `None`: as far as the
    /// force takes.
    pub indentation_m: Option<f64>,
    /// Unevenness of the wheel's surface.
    pub texture: Option<TextureSpec>,
    /// Grains that run over edges.
    pub grains: Option<GrainSpec>,
}

impl PolishSpec {
    /// Columns (along the length) and rows of cells: as few as are no larger than asked for.
    pub fn cells(&self) -> [usize; 2] {
        [self.face.length_m, self.face.width_m]
            .map(|side| (side / self.cell_m - 1e-9).ceil().max(1.0) as usize)
    }

    /// Circumference of the circle on the wheel that touches the face, m.
    pub fn touching_circumference_m(&self) -> f64 {
        circumference_m(&self.wheel, self.tilt_rad)
    }
}

/// Radius of the patch that is asked for, m.
fn reach_m(wheel: &PneumaticWheel, control: &ForceControl, indentation_m: Option<f64>) -> f64 {
    let force_n = control.force_n().unwrap_or(0.0);
    let pressed_m = indentation_m.unwrap_or_else(|| wheel.indentation_m(force_n));
    wheel.patch(&wheel.shell(), pressed_m).contact_m()
}

fn circumference_m(wheel: &PneumaticWheel, tilt_rad: f64) -> f64 {
    std::f64::consts::TAU * wheel.radius_m * tilt_rad.sin()
}

/// Polishing of a rectangular face with a soft wheel in precession.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PolishTable {
    /// Speed of the wheel about the axis that points away from the face; negative: about its
    /// opposite.
    spin_rpm: f64,
    /// Angle between spin axis and normal of the face.
    #[schemars(extend(
        "exclusiveMinimum" = 0.0,
        "maximum" = 60.0,
        "x-rule" = "an upright wheel does not slide in the middle of its patch, one that lies touches with its carrier"
    ))]
    tilt_deg: f64,
    /// Coefficient of friction between wheel and face.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "friction opposes sliding"))]
    mu: f64,
    /// Distance of the wheel's middle from the spin axis. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "an eccentricity is a distance"))]
    eccentricity_um: Option<f64>,
    /// Angle at which the wheel's middle stands at the start, from the tool's x axis towards its y
    /// axis (with eccentricity_um). Default: 0.
    eccentricity_angle_deg: Option<f64>,
    /// Preston coefficient.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "polishing removes material"))]
    preston_per_pa: f64,
    /// The wheel: an inflated rubber shell.
    wheel: PneumaticTable,
    /// The face that is polished.
    face: FaceTable,
    /// The raster.
    path: RasterTable,
    /// How the spin axis turns about the normal.
    precession: PrecessionTable,
    /// What holds the normal force.
    control: ControlTable,
    /// How the surface smooths.
    roughness: RoughnessTable,
    /// Unevenness of the wheel's surface. Default: it is even.
    texture: Option<TextureTable>,
    /// Grains that run over the edges of the face. Default: none do anything there.
    grains: Option<GrainTable>,
}

const TABLE: &str = "process.polish";

impl PolishTable {
    /// `None` after recording a fault.
    pub(crate) fn resolve(self, check: &mut Check) -> Option<PolishSpec> {
        if self.spin_rpm == 0.0 {
            let message = "is 0, but must not be: a wheel that stands still only rubs by its feed";
            check.wrong(TABLE, "spin_rpm", message, "does not spin");
        }
        if self.eccentricity_um.unwrap_or(0.0) == 0.0 {
            let because = "the wheel runs true, eccentricity_um is 0 or not given";
            check.ignored(TABLE, &["eccentricity_angle_deg"], because);
        }
        let wheel = self.wheel.resolve("process.polish.wheel", check);
        check.rim(TABLE, "spin_rpm", self.spin_rpm, wheel.radius_m);
        let face = self.face.resolve(check);
        let path = (face.as_ref()).and_then(|(face, _)| self.path.resolve(face, check));
        let precession = self.precession.resolve(check);
        let pressed = Pressed::ByTable {
            radius_m: wheel.radius_m,
        };
        let control = self
            .control
            .resolve(&format!("{TABLE}.control"), &pressed, check);
        let polishing = self.roughness.resolve(TABLE, check);
        let (control, indentation_m) = control?;
        let (face, cell_m) = face?;
        let tilt_rad = from_deg(self.tilt_deg);
        let texture =
            (self.texture).map(|table| table.resolve(circumference_m(&wheel, tilt_rad), check));
        let reach_m = reach_m(&wheel, &control, indentation_m);
        let grains = (self.grains).map(|table| table.resolve(&wheel, reach_m, check));
        Some(PolishSpec {
            wheel,
            spin_rad_s: from_rpm(self.spin_rpm),
            tilt_rad,
            abrasive: Abrasive {
                mu: self.mu,
                preston_per_pa: self.preston_per_pa,
                polishing,
            },
            eccentricity_m: from_um(self.eccentricity_um.unwrap_or(0.0)),
            eccentricity_angle_rad: from_deg(self.eccentricity_angle_deg.unwrap_or(0.0)),
            face,
            cell_m,
            path: path?,
            precession: precession?,
            control,
            indentation_m,
            texture,
            grains,
        })
    }
}

/// How far a polishing wheel is typically pressed in, as a part of its radius: a patch that is
/// small beside the wheel.
const TYPICAL_INDENTATION: f64 = 0.03;

/// What a person could change at the machine.
const KNOBS: &[Knob] = &[
    Knob::new("process.polish.spin_rpm", "spin", &[0.5, 2.0]),
    Knob::new(
        "process.polish.control.indentation_mm",
        "indentation",
        &[0.6, 1.6],
    ),
    Knob::new("process.polish.control.force_n", "force", &[0.5, 2.0]),
];

impl Room for PolishSpec {
    type Table = PolishTable;

    fn resolve(table: PolishTable, _folder: &Path, check: &mut Check) -> Option<Self> {
        table.resolve(check)
    }

    fn facts(&self) -> Facts {
        let reach_m = reach_m(&self.wheel, &self.control, self.indentation_m);
        Facts {
            rate_rad_s: Some(self.spin_rad_s.abs()).filter(|rate| *rate > 0.0),
            natural_duration_s: Some(f64::INFINITY),
            signals: &[
                "polish.normal_force",
                "polish.indentation",
                "polish.position_x",
                "polish.position_y",
                "polish.precession_angle",
                "tool.displacement_x",
            ],
            knobs: KNOBS,
            files: &[],
            needs_drive: Some("polish"),
            needs_robot: true,
            modes: ModesIn::Scenario,
            replays: false,
            posture: PostureFrom::Scenario,
            parts: Parts {
                wheel: Some(WheelPart {
                    hold: hold(&self.control),
                    shows_removal: true,
                    turns: self.spin_rad_s != 0.0,
                    over_edges: self.path.inset_m < reach_m,
                    indentation_m: TYPICAL_INDENTATION * self.wheel.radius_m,
                }),
                ..Parts::NONE
            },
        }
    }
}
