//! Whether spectral metrics look below half the rate at which rows are recorded.

use truecut_recording::{MetricSpec, Reducer};

use crate::error::ScenarioError;
use crate::scenario::Scenario;
use crate::windows::metrics;

impl Scenario {
    /// Checks that every band of a spectral metric lies below half the rate at which rows are
    /// recorded.
    ///
    /// # Errors
    /// The first band that does not.
    pub fn check_bands(&self, row_interval_s: f64) -> Result<(), ScenarioError> {
        let highest_hz = 0.5 / row_interval_s;
        for (table, metric) in metrics(&self.claims, self.sweep.as_ref()) {
            let MetricSpec::Reduced { reducer, .. } = metric else {
                continue;
            };
            let (Reducer::SpectralLine { band_hz } | Reducer::SpectralAmplitude { band_hz }) =
                reducer
            else {
                continue;
            };
            if band_hz[1] > highest_hz {
                let key = format!("{table}.band_hz");
                let message = format!(
                    "`{key}` reaches to {} Hz, but a row every {:.4} ms shows nothing above {highest_hz:.1} Hz \
                     (half the recording rate)",
                    band_hz[1],
                    row_interval_s * 1e3
                );
                return Err(self.problem(&key, message));
            }
        }
        Ok(())
    }
}
