//! Whether a run has what claims and sweeps are about.

use truecut_recording::{ClaimFault, Header, MetricSpec, UserUnit};

use super::Scenario;
use crate::error::ScenarioError;
use crate::fault::Fault;
use crate::sweep::SweepSpec;

impl Scenario {
    /// Checks every metric against the channels of the run: known channels, fitting units.
    ///
    /// # Errors
    /// All claims and sweep columns that cannot be judged, with their places.
    pub fn check_claims(&self, header: &Header) -> Result<(), ScenarioError> {
        let mut faults = Vec::new();
        for (index, claim) in self.claims.iter().enumerate() {
            let table = format!("claim.{index}");
            match claim.check(header) {
                Ok(()) => faults.extend(self.threshold_fault(&table, &claim.metric, header)),
                Err(error) => {
                    let key = match error.fault {
                        ClaimFault::Metric(_) => self.channel_key(&table),
                        _ => format!("{table}.unit"),
                    };
                    faults.push(Fault::value(&key, error.to_string(), "here"));
                }
            }
        }
        let columns = self.sweep.iter().flat_map(SweepSpec::metrics_at);
        for (table, metric, unit) in columns {
            faults.extend(self.metric_fault(&table, metric, unit, header));
        }
        self.document.refuse(faults)
    }

    fn metric_fault(
        &self,
        table: &str,
        metric: &MetricSpec,
        unit: &UserUnit,
        header: &Header,
    ) -> Option<Fault> {
        match metric.check(header) {
            Err(error) => Some(Fault::value(
                &self.channel_key(table),
                error.to_string(),
                "here",
            )),
            Ok(Some(of_metric)) if of_metric != unit.unit => {
                let accepted: Vec<&str> = of_metric.accepted_symbols().collect();
                let message = format!(
                    "unit \"{}\" does not fit {metric}; accepted: {}",
                    unit.symbol,
                    accepted.join(", ")
                );
                Some(Fault::value(
                    &format!("{table}.unit"),
                    message,
                    "wrong dimension",
                ))
            }
            Ok(_) => self.threshold_fault(table, metric, header),
        }
    }

    /// Where the channel of a metric is written.
    fn channel_key(&self, table: &str) -> String {
        let keys = ["channel", "channels"];
        let given = keys.iter().map(|key| format!("{table}.{key}"));
        given
            .into_iter()
            .find(|key| self.gives(key))
            .unwrap_or_else(|| table.to_owned())
    }

    fn threshold_fault(&self, table: &str, metric: &MetricSpec, header: &Header) -> Option<Fault> {
        let (_, unit) = self.thresholds.iter().find(|(path, _)| path == table)?;
        let MetricSpec::Reduced { channels, .. } = metric else {
            return None;
        };
        let channel = header.channel(channels.first()?).ok()?;
        if channel.unit == unit.unit {
            return None;
        }
        let key = format!("{table}.threshold_unit");
        let accepted: Vec<&str> = channel.unit.accepted_symbols().collect();
        let message = format!(
            "the threshold is in \"{}\", but channel {} is in {}; `threshold_unit` may be {}",
            unit.symbol,
            channel.name,
            channel.unit,
            accepted.join(", ")
        );
        let written = if self.gives(&key) {
            key
        } else {
            format!("{table}.threshold")
        };
        Some(Fault::value(&written, message, "wrong dimension"))
    }
}
