//! Where a replay starts, as far as that is read off the data: unknowns with the spread of what
//! they were read off.

use super::forward::ForwardInputs;
use crate::error::SimError;
use crate::posture::posture;
use crate::robots::Robots;
use truecut_arm::JointKind;
use truecut_recording::Measured;
use truecut_scenario::{ProcessSpec, ReplayMode, Scenario, UncertainSpec};

/// A start that was found.
#[derive(Debug, Clone, Default)]
pub struct FoundStart {
    /// What the scenario does not say of it, as it would be written.
    pub keys: Vec<(String, String)>,
    /// What of it is not known exactly.
    pub unknowns: Vec<UncertainSpec>,
}

/// A spread that is rounding says nothing, rad or m.
const LEAST_SPREAD: f64 = 1e-9;

/// The start of joints that nothing commands and whose posture the scenario does not give.
///
/// # Errors
/// Data that do not fit the scenario.
pub fn found_start(
    scenario: &Scenario,
    measured: &Measured,
    robots: &Robots,
) -> Result<FoundStart, SimError> {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        return Ok(FoundStart::default());
    };
    if replay.mode != ReplayMode::Forward {
        return Ok(FoundStart::default());
    }
    let robot = robots.robot(&scenario.robot)?;
    let drive = scenario.robot.drive;
    let inputs = ForwardInputs::of(replay, scenario, Some(measured), &robot, drive)?;
    let begun = inputs.posture(&posture(&scenario.robot, &robot)?);
    let found = inputs.found();
    let mut start = FoundStart::default();
    let kinds = [
        (JointKind::Revolute, "robot.posture_deg", 1f64.to_degrees()),
        (JointKind::Prismatic, "robot.posture_mm", 1e3),
    ];
    for (kind, key, per_si) in kinds {
        let joints = robot.chain.joints.iter().enumerate();
        let own: Vec<usize> = joints
            .filter(|(_, joint)| joint.kind == kind)
            .map(|(index, _)| index)
            .collect();
        let spreads = own.iter().enumerate().filter_map(|(place, joint)| {
            let spread = found.iter().find(|(known, _)| known == joint)?.1;
            Some(UncertainSpec {
                key: format!("{key}.{place}"),
                value: begun[*joint],
                sigma: spread.max(LEAST_SPREAD),
            })
        });
        let unknowns: Vec<UncertainSpec> = spreads.collect();
        if unknowns.is_empty() {
            continue;
        }
        let values: Vec<String> = (own.iter())
            .map(|&joint| format!("{:?}", begun[joint] * per_si))
            .collect();
        start
            .keys
            .push((key.to_owned(), format!("[{}]", values.join(", "))));
        start.unknowns.extend(unknowns);
    }
    // What was measured is where the joints are, not where their motors stand.
    if !inputs.held().is_empty() && !start.keys.is_empty() {
        let key = "robot.hold_against_sag".to_owned();
        start.keys.push((key, "true".to_owned()));
    }
    Ok(start)
}
