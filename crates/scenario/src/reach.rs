//! Whether spectral metrics look below half the rate at which rows are recorded.

use truecut_recording::{MetricSpec, Reducer, short_number};

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
                    "`{key}` reaches to {} Hz, but must end at or below {} Hz, half the recording rate of {} rows \
                     a second (one every {} ms): they show nothing above it",
                    band_hz[1],
                    short_number(highest_hz),
                    short_number(1.0 / row_interval_s),
                    short_number(row_interval_s * 1e3)
                );
                return Err(self.problem(&key, message));
            }
        }
        Ok(())
    }
}
