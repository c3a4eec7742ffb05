//! `lobes.json`: the diagram's limits for other programs.

use serde_json::json;
use truecut_arm::JointKind;
use truecut_core::chatter::averaged::Crossing;

use super::Diagram;
use super::uncertain::UncertainJson;
use crate::failure::Failure;

/// The file. All numbers are SI; one that does not exist is `null`. `limit` is by spectral
/// elements, `limit_error_m` by how much the discretisation in time puts it wrong, estimated;
/// `other_damping_limit` is with the damping of the arm that the scenario did not choose. Slides
/// have a list of their own, `posture_m`, which an arm without slides does not have.
pub fn json(diagram: &Diagram<'_>) -> Result<String, Failure> {
    let lobes = &diagram.lobes;
    let limit = |found: Option<Crossing>| {
        found.map(|at| json!({ "depth_m": at.depth_m, "chatter_hz": at.frequency_hz }))
    };
    let other = diagram.other.as_ref();
    let speeds = lobes.spindle_rad_s.iter().enumerate().map(|(i, speed)| {
        json!({
            "spindle_rad_s": speed,
            "limit": limit(lobes.limit[i]),
            "limit_error_m": lobes.limit_error_m[i],
            "zero_order": limit(lobes.zero_order[i]),
            "other_damping_limit": other.and_then(|other| limit(other.lobes.limit[i])),
        })
    });
    let runs = diagram.runs.iter().map(|run| {
        json!({
            "spindle_rad_s": run.spindle_rad_s,
            "depth_m": run.depth_m,
            "chatters": run.chatters,
            "growth_per_s": run.growth_per_s,
            "chatter_hz": run.chatter_hz,
        })
    });
    let mut report = json!({
        "scenario": diagram.scenario.name,
        "posture_rad": diagram.joints(JointKind::Revolute),
        // Depth down to which limits were looked for.
        "deepest_m": lobes.depth_m.last().copied().unwrap_or(0.0),
        // Speed above which nothing is said, since modes of the tool are missing.
        "not_known_above_rad_s": diagram.known.as_ref().map(|(above, _)| above),
        "other_damping": other.map(|other| &other.name),
        "speeds": speeds.collect::<Vec<_>>(),
        // The same at all speeds.
        "mode_coupling": limit(lobes.mode_coupling),
        "runs": runs.collect::<Vec<_>>(),
        // What the scenario says is uncertain, drawn; none if it says nothing of it.
        "uncertain": diagram.uncertain.as_ref().map(UncertainJson::from),
    });
    let slides = diagram.joints(JointKind::Prismatic);
    if !slides.is_empty() {
        report["posture_m"] = json!(slides);
    }
    crate::text::json(&report)
}
