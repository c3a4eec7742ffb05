//! Whether metrics look where a run has something to show: within its duration.

use truecut_recording::{ClaimSpec, MetricSpec, short_number};

use crate::check::Check;
use crate::run::RunSpec;
use crate::sweep_spec::SweepSpec;

/// Part by which the end of a stretch may lie beyond the run's: rounding of decimal numbers.
const TOLERANCE: f64 = 1e-9;

/// The metrics of a scenario with the tables they are written in.
pub(crate) fn metrics<'a>(
    claims: &'a [ClaimSpec],
    sweep: Option<&'a SweepSpec>,
) -> impl Iterator<Item = (String, &'a MetricSpec)> {
    let claims = claims.iter().enumerate();
    let claims = claims.map(|(index, claim)| (format!("claim.{index}"), &claim.metric));
    let columns = sweep.into_iter().flat_map(SweepSpec::metrics_at);
    claims.chain(columns.map(|(table, metric, _)| (table, metric)))
}

/// Refuses stretches that end after the run does.
pub(crate) fn check_windows(
    claims: &[ClaimSpec],
    sweep: Option<&SweepSpec>,
    run: Option<&RunSpec>,
    check: &mut Check,
) {
    let Some(end_s) = run.map(|run| run.duration_s) else {
        return;
    };
    for (table, metric) in metrics(claims, sweep) {
        let MetricSpec::Reduced { window, .. } = metric else {
            continue;
        };
        let latest_s = end_s * (1.0 + TOLERANCE);
        let ends = [("from_s", window.from_s), ("to_s", window.to_s)];
        for (key, time_s) in ends {
            if let Some(time_s) = time_s.filter(|time_s| *time_s > latest_s) {
                let message = format!(
                    "is {time_s} s, but the run ends at {} s: there is nothing to evaluate",
                    short_number(end_s)
                );
                check.wrong(&table, key, message, "after the end of the run");
            }
        }
    }
}
