//! The `[….roughness]` table of processes that smooth: Ra over the dose.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::document::Fault;
use crate::units::from_um;

/// How the surface smooths: Ra falls from one value to another with the dose `∫ p v dt`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughnessSpec {
    /// Ra before.
    pub initial_m: f64,
    /// Ra that the abrasive leaves in the end.
    pub final_m: f64,
    /// Dose that takes away all but 1/e of the difference.
    pub dose_j_per_m2: f64,
}

/// How the surface smooths.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RoughnessTable {
    /// Ra before.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a surface has a roughness"))]
    start_um: f64,
    /// Ra that the abrasive leaves in the end.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a roughness is not negative"))]
    end_um: f64,
    /// Dose (pressure times sliding distance) that takes away all but 1/e of the difference.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "smoothing takes a dose"))]
    dose_j_per_mm2: f64,
}

impl RoughnessTable {
    /// `process` is the path of the table that this one stands in.
    pub(crate) fn resolve(self, process: &str, check: &mut Check) -> RoughnessSpec {
        if self.end_um > self.start_um {
            let path = format!("{process}.roughness.end_um");
            let message = format!(
                "`{path}` is {}, but must be at most start_um = {}: polishing smooths",
                self.end_um, self.start_um
            );
            check.refuse(Fault::value(&path, message, "rougher than at the start"));
        }
        RoughnessSpec {
            initial_m: from_um(self.start_um),
            final_m: from_um(self.end_um),
            dose_j_per_m2: self.dose_j_per_mm2 * 1e6,
        }
    }
}
