//! The `[process.polish]` table: a soft wheel in precession polishes a rectangular face along a raster.

mod face;
mod path;
mod precession;
mod wheel;

pub use face::FaceSpec;
pub use path::RasterSpec;
pub use precession::{EdgeRuleSpec, PrecessionSpec};
pub use wheel::PneumaticSpec;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::control::{ControlSpec, ControlTable, Pressed};
use crate::document::Fault;
use crate::roughness::{RoughnessSpec, RoughnessTable};
use crate::units::{from_deg, from_rpm, from_um};
use face::FaceTable;
use path::RasterTable;
use precession::PrecessionTable;
use wheel::PneumaticTable;

/// Polishing of a rectangular face. The robot's tool frame stands in the wheel's centre, its z axis is the spin axis and
/// points towards the face.
#[derive(Debug, Clone, PartialEq)]
pub struct PolishSpec {
    /// The wheel.
    pub wheel: PneumaticSpec,
    /// Spin about the axis that points away from the face; negative: about its opposite.
    pub spin_rad_s: f64,
    /// Angle between spin axis and normal of the face.
    pub tilt_rad: f64,
    /// Coefficient of friction between wheel and face.
    pub mu: f64,
    /// Distance of the wheel's middle from the spin axis.
    pub eccentricity_m: f64,
    /// Angle about the spin axis, from the tool's x axis towards its y axis, at which the middle stands at the start.
    pub eccentricity_angle_rad: f64,
    /// Preston coefficient: removed depth per pressure and sliding distance.
    pub preston_per_pa: f64,
    /// The face.
    pub face: FaceSpec,
    /// The path of the patch's middle.
    pub path: RasterSpec,
    /// How the spin axis turns about the normal.
    pub precession: PrecessionSpec,
    /// What holds the normal force.
    pub control: ControlSpec,
    /// How the surface smooths.
    pub roughness: RoughnessSpec,
}

/// Polishing of a rectangular face with a soft wheel in precession.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PolishTable {
    /// Speed of the wheel about the axis that points away from the face; negative: about its opposite.
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
    /// Angle at which the wheel's middle stands at the start, from the tool's x axis towards its y axis (with
    /// eccentricity_um). Default: 0.
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
}

const TABLE: &str = "process.polish";

impl PolishTable {
    /// `None` after recording a fault.
    pub(crate) fn resolve(self, check: &mut Check) -> Option<PolishSpec> {
        if self.spin_rpm == 0.0 {
            let path = format!("{TABLE}.spin_rpm");
            let message = format!(
                "`{path}` is 0, but must not be: a wheel that stands still only rubs by its feed"
            );
            check.refuse(Fault::value(&path, message, "does not spin"));
        }
        if self.eccentricity_um.unwrap_or(0.0) == 0.0 {
            let because = "the wheel runs true, eccentricity_um is 0 or not given";
            check.ignored(TABLE, &["eccentricity_angle_deg"], because);
        }
        let wheel = self.wheel.resolve(check);
        let face = self.face.resolve(check);
        let path = face
            .as_ref()
            .and_then(|face| self.path.resolve(face, check));
        let precession = self.precession.resolve(check);
        let pressed = Pressed::ByTable {
            radius_m: wheel.radius_m,
        };
        let control = (self.control).resolve(&format!("{TABLE}.control"), &pressed, check);
        let roughness = self.roughness.resolve(TABLE, check);
        Some(PolishSpec {
            wheel,
            spin_rad_s: from_rpm(self.spin_rpm),
            tilt_rad: from_deg(self.tilt_deg),
            mu: self.mu,
            eccentricity_m: from_um(self.eccentricity_um.unwrap_or(0.0)),
            eccentricity_angle_rad: from_deg(self.eccentricity_angle_deg.unwrap_or(0.0)),
            preston_per_pa: self.preston_per_pa,
            face: face?,
            path: path?,
            precession: precession?,
            control: control?,
            roughness,
        })
    }
}
