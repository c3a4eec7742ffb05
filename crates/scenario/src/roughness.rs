//! The `[….roughness]` table of processes that smooth: Ra over the dose.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::roughness::Polishing;

use crate::check::Check;
use crate::units::from_um;

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
    pub(crate) fn resolve(self, process: &str, check: &mut Check) -> Polishing {
        let start_um = self.start_um;
        let end_um = self.end_um;
        if end_um > start_um {
            let message = format!(
                "is {end_um}, but must be at most start_um = {start_um}: polishing smooths"
            );
            check.wrong(
                process,
                "roughness.end_um",
                message,
                "rougher than at the start",
            );
        }
        Polishing {
            initial_m: from_um(start_um),
            final_m: from_um(end_um),
            dose_j_per_m2: self.dose_j_per_mm2 * 1e6,
        }
    }
}
