//! The `wheel` table of processes that polish: an inflated rubber shell.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::wheel::pneumatic::PneumaticWheel;

use crate::check::Check;
use crate::units::{from_mm, from_mpa};

/// An inflated rubber sphere.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::process) struct PneumaticTable {
    /// Radius of the unloaded wheel.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a wheel has a radius"))]
    radius_mm: f64,
    /// Gauge pressure of the air in it.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "gauge pressure, 0 is a wheel without air"))]
    pressure_mpa: f64,
    /// Thickness of the rubber shell.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a shell has a thickness"))]
    shell_thickness_mm: f64,
    /// Young's modulus of the rubber.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "rubber is elastic"))]
    youngs_modulus_mpa: f64,
    /// Poisson's ratio of the rubber. Default: 0.49.
    #[schemars(extend("minimum" = 0.0, "exclusiveMaximum" = 0.5, "x-rule" = "0.5 is incompressible"))]
    poisson: Option<f64>,
    /// Viscous pressure per rate at which the wheel's surface is pressed in. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "negative damping would create energy"))]
    damping_pa_s_per_m: Option<f64>,
}

/// Rubber is all but incompressible.
const DEFAULT_POISSON: f64 = 0.49;

impl PneumaticTable {
    /// `table` is the table's path.
    pub(in crate::process) fn resolve(self, table: &str, check: &mut Check) -> PneumaticWheel {
        let radius_mm = self.radius_mm;
        let shell_thickness_mm = self.shell_thickness_mm;
        if shell_thickness_mm > radius_mm {
            let message = format!(
                "is {shell_thickness_mm}, but must be at most radius_mm = {radius_mm}: the \
                 shell fits into the wheel"
            );
            let label = "thicker than the wheel";
            check.wrong(table, "shell_thickness_mm", message, label);
        }
        PneumaticWheel {
            radius_m: from_mm(radius_mm),
            pressure_pa: from_mpa(self.pressure_mpa),
            shell_thickness_m: from_mm(shell_thickness_mm),
            youngs_modulus_pa: from_mpa(self.youngs_modulus_mpa),
            poisson: self.poisson.unwrap_or(DEFAULT_POISSON),
            damping_pa_s_per_m: self.damping_pa_s_per_m.unwrap_or(0.0),
        }
    }
}
