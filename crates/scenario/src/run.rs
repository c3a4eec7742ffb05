//! The `[run]` table: how long, in which steps, recorded how often.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::fault::Fault;
use crate::units::from_ms;

/// Duration, step and recording interval.
#[derive(Debug, Clone, PartialEq)]
pub struct RunSpec {
    /// Simulated time; infinite for a replay that lasts as long as its data, and for polishing,
    /// belt finishing, brushing and paths from files that last as long as their paths.
    pub duration_s: f64,
    /// Time step; `None` leaves the choice to the simulator (see the README, "Numerics").
    pub time_step_s: Option<f64>,
    /// Time between recorded rows; `None` records every step.
    pub record_interval_s: Option<f64>,
    /// Factor by which deflections are exaggerated in the second, transparent arm of the 3-D view.
    pub deflection_scale: f64,
    /// What it comes to if more is asked of a drive than it gives.
    pub overload: FaultRule,
    /// What it comes to if masses and inertias of the arm seem to be placeholders.
    pub placeholders: FaultRule,
}

/// What it does to the verdict of a run that came to its end that it says little of the real arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FaultRule {
    /// The run's outcome says so, and it fails.
    #[default]
    Fail,
    /// The run's text says so, and its verdict is left to the claims.
    Warn,
}

/// Duration, step and recording interval.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunTable {
    /// Simulated time. Default: what the process takes (chamfer: feed and dwell; wheel and milling:
    /// one pass; polish: its raster; belt: its lines; brush: its taught postures or path; load: its
    /// path; replay: its data).
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "time runs forward"))]
    duration_s: Option<f64>,
    /// Time step. Default: the smallest of 0.25 ms, 1/60 of the fastest mode's period and 1/40 of
    /// the tooth period.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a time step runs forward"))]
    time_step_ms: Option<f64>,
    /// Time between recorded rows. Default: every step.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "time runs forward"))]
    record_interval_ms: Option<f64>,
    /// Exaggeration of deflections in the 3-D view. Default: 300.
    #[schemars(extend("minimum" = 1.0, "x-rule" = "1 shows the true deflection"))]
    deflection_scale: Option<f64>,
    /// What an overloaded drive does to the verdict: "fail", or "warn" where only the text of the
    /// run says so. Default: "fail".
    overload: Option<FaultRule>,
    /// What it does to the verdict that masses and inertias of the arm seem to be placeholders (two
    /// of three: all links have the same mass; all have the same inertia; no machine of that reach
    /// has that mass): "fail", or "warn" where only the notes say so. Default: "fail".
    placeholders: Option<FaultRule>,
}

/// Longest run, s: what is meant as longer is mostly a slip in a feed or a unit.
pub const LONGEST_S: f64 = 3600.0;

/// Most rows of a recording: some 6 GB in memory with 40 channels.
const MOST_ROWS: f64 = 2e7;

/// Exaggeration of deflections in the 3-D view where a scenario does not give one.
const DEFAULT_DEFLECTION_SCALE: f64 = 300.0;

impl RunTable {
    /// `process_s` is the time the process takes by itself, and what it is made of.
    pub(crate) fn resolve(self, process_s: Option<f64>, check: &mut Check) -> RunSpec {
        let duration_s = match (self.duration_s, process_s) {
            (Some(given), _) => given,
            (None, Some(natural)) => natural,
            (None, None) => check
                .needed(
                    "run",
                    "duration_s",
                    None,
                    "a process that does not end by itself",
                )
                .unwrap_or(1.0),
        };
        let run = RunSpec {
            duration_s,
            time_step_s: self.time_step_ms.map(from_ms),
            record_interval_s: self.record_interval_ms.map(from_ms),
            deflection_scale: self.deflection_scale.unwrap_or(DEFAULT_DEFLECTION_SCALE),
            overload: self.overload.unwrap_or_default(),
            placeholders: self.placeholders.unwrap_or_default(),
        };
        run.check_length(check);
        run.check_intervals(check);
        run
    }
}

impl RunSpec {
    fn check_length(&self, check: &mut Check) {
        if self.duration_s == f64::INFINITY {
            return;
        }
        if self.duration_s > LONGEST_S {
            let given = check.document().has("run.duration_s");
            let (path, what) = if given {
                ("run.duration_s", "`run.duration_s`")
            } else {
                ("process", "the time that the process takes")
            };
            let message = format!(
                "{what} is {} s, but must be at most {LONGEST_S} s: a run fits into memory",
                self.duration_s
            );
            check.refuse(Fault::value(
                path,
                message,
                format!("more than {LONGEST_S} s"),
            ));
        }
        let interval_s = self.record_interval_s.or(self.time_step_s);
        if let Some(rows) = interval_s.map(|interval_s| self.duration_s / interval_s)
            && rows > MOST_ROWS
        {
            let key = if self.record_interval_s.is_some() {
                "run.record_interval_ms"
            } else {
                "run.time_step_ms"
            };
            let message = format!(
                "`{key}` gives {rows:.3e} rows, but a recording has at most {MOST_ROWS:.0e}: it fits into memory"
            );
            let fault = Fault::value(key, message, "too many rows");
            check.refuse(fault.with_help("raise run.record_interval_ms"));
        }
    }

    fn check_intervals(&self, check: &mut Check) {
        let duration_s = self.duration_s;
        for (key, length_s) in [
            ("time_step_ms", self.time_step_s),
            ("record_interval_ms", self.record_interval_s),
        ] {
            if let Some(length_s) = length_s.filter(|length_s| *length_s > duration_s) {
                let message = format!(
                    "is {} ms, but the run takes {duration_s} s: it must fit into the run",
                    length_s * 1e3
                );
                check.wrong("run", key, message, "longer than the run");
            }
        }
        if let (Some(step_s), Some(interval_s)) = (self.time_step_s, self.record_interval_s)
            && interval_s < step_s
        {
            let message = format!(
                "is {} ms, but must be at least the time step of {} ms: \
                 there is one row per step at most",
                interval_s * 1e3,
                step_s * 1e3
            );
            let label = "shorter than the time step";
            check.wrong("run", "record_interval_ms", message, label);
        }
    }
}
