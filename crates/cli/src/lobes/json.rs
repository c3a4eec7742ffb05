//! `lobes.json`: the diagram's limits for other programs.

use serde::Serialize;
use truecut_core::chatter::averaged::Crossing;

use super::Diagram;

/// What the file holds. All numbers are SI; one that does not exist is `null`.
#[derive(Serialize)]
struct Report<'a> {
    scenario: &'a str,
    /// Posture of the arm.
    posture_rad: &'a [f64],
    /// Depth down to which limits were looked for.
    deepest_m: f64,
    /// Speed above which nothing is said, since modes of the tool are missing.
    not_known_above_rad_s: Option<f64>,
    /// The damping of the arm that the scenario did not choose.
    other_damping: Option<&'a str>,
    speeds: Vec<AtSpeed>,
    /// The same at all speeds.
    mode_coupling: Option<Limit>,
    runs: Vec<Run>,
}

#[derive(Serialize)]
struct AtSpeed {
    spindle_rad_s: f64,
    /// By spectral elements.
    limit: Option<Limit>,
    /// By how much the discretisation in time puts it wrong, estimated.
    limit_error_m: Option<f64>,
    zero_order: Option<Limit>,
    /// By spectral elements with that other damping.
    other_damping_limit: Option<Limit>,
}

#[derive(Serialize)]
struct Limit {
    depth_m: f64,
    chatter_hz: f64,
}

#[derive(Serialize)]
struct Run {
    spindle_rad_s: f64,
    depth_m: f64,
    chatters: Option<bool>,
    growth_per_s: f64,
    chatter_hz: f64,
}

impl From<Crossing> for Limit {
    fn from(crossing: Crossing) -> Self {
        Self {
            depth_m: crossing.depth_m,
            chatter_hz: crossing.frequency_hz,
        }
    }
}

pub fn json(diagram: &Diagram<'_>) -> serde_json::Result<String> {
    let lobes = &diagram.lobes;
    let limit = |found: Option<Crossing>| found.map(Limit::from);
    let other = diagram.other.as_ref();
    let speeds = lobes.spindle_rad_s.iter().enumerate();
    let report = Report {
        scenario: &diagram.scenario.name,
        posture_rad: &diagram.posture,
        deepest_m: lobes.depth_m.last().copied().unwrap_or(0.0),
        not_known_above_rad_s: diagram.known.as_ref().map(|(above, _)| *above),
        other_damping: other.map(|(name, _)| name.as_str()),
        speeds: speeds
            .map(|(i, spindle_rad_s)| AtSpeed {
                spindle_rad_s: *spindle_rad_s,
                limit: limit(lobes.limit[i]),
                limit_error_m: lobes.limit_error_m[i],
                zero_order: limit(lobes.zero_order[i]),
                other_damping_limit: other.and_then(|(_, other)| limit(other.limit[i])),
            })
            .collect(),
        mode_coupling: limit(lobes.mode_coupling),
        runs: (diagram.runs.iter())
            .map(|run| Run {
                spindle_rad_s: run.spindle_rad_s,
                depth_m: run.depth_m,
                chatters: run.chatters,
                growth_per_s: run.growth_per_s,
                chatter_hz: run.chatter_hz,
            })
            .collect(),
    };
    serde_json::to_string_pretty(&report)
}
