//! What a run came to, in words: claims, the load of the robot, notes.

use truecut_recording::{ClaimResult, Header, Outcome, Recording, significant};

/// Where the claims are logged.
pub(super) const CLAIMS: &str = "/claims";
/// The scalar that says how far the most loaded drive is used.
const TORQUE_USE: &str = "plant.torque_use_max";
/// The scalar that says how long a servo was at its torque limit.
const SATURATED: &str = "plant.torque_saturated";

/// Claims, the load of the robot, notes.
pub(super) fn claims_table(recording: &Recording, claims: &[ClaimResult]) -> String {
    let failed = claims.iter().filter(|claim| !claim.holds).count();
    let mut text = format!("## {}\n\n", recording.header.scenario_name);
    if recording.outcome != Outcome::Completed {
        text += &format!("✖ **The run {}.**\n\n", recording.outcome);
    } else if let Some(end_s) = recording.time_s.last() {
        // While a large file loads, its curves end earlier.
        text += &format!("Ran to its end, {} s.\n\n", significant(*end_s, 4));
    }
    text += &match (claims.len(), failed) {
        // None made, or none judged: a run that was stopped, a file that was converted.
        (0, _) => "No claim was judged.\n".to_owned(),
        (1, 0) => "**The claim holds.**\n\n".to_owned(),
        (1, 1) => "**The claim fails.**\n\n".to_owned(),
        (count, 0) => format!("**All {count} claims hold.**\n\n"),
        (count, failed) => format!("**{failed} of {count} claims fail.**\n\n"),
    };
    text += &claim_rows(claims);
    text += "\n### Robot, and what was assumed\n\n";
    text += &robot_load(recording);
    text += &notes(&recording.header);
    text
}

/// What stands in place of the claims until the run is at its end. A viewer that opens a large file
/// shows it while it loads.
pub(super) fn under_way(header: &Header) -> String {
    format!(
        "## {}\n\n*Still loading; or, if this stays, the run was stopped before its end. Claims are judged at the \
         end.*\n\n### What was assumed\n\n{}",
        header.scenario_name,
        notes(header)
    )
}

fn notes(header: &Header) -> String {
    let notes = header.notes.iter();
    notes
        .map(|note| format!("\n- {}", one_cell(note)))
        .collect()
}

/// Largest torque asked of a drive.
fn robot_load(recording: &Recording) -> String {
    let mut text = String::new();
    let scalars = recording.scalars.iter();
    if let Some(load) = scalars.rev().find(|scalar| scalar.name == TORQUE_USE) {
        let (percent, over) = (100.0 * load.value, load.value > 1.0);
        let what = if over {
            "✖ **OVERLOADED:** a drive is asked for"
        } else {
            "Most loaded drive: asked for"
        };
        let joint = load.description.split_once(": ");
        let joint = joint.map_or(String::new(), |(_, joint)| {
            format!(" ({})", one_cell(joint))
        });
        text += &format!(
            "{what} {} % of its limit{joint}.\n",
            significant(percent, 3)
        );
    }
    let mut scalars = recording.scalars.iter().rev();
    if let Some(saturated) = scalars.find(|scalar| scalar.name == SATURATED) {
        let joint = saturated.description.split_once(": ");
        text += &format!(
            "**Servo saturated** for {} s ({}): it gives all that it can, and the arm does not follow.\n",
            significant(saturated.value, 3),
            one_cell(joint.map_or("", |(_, joint)| joint))
        );
    }
    text
}

/// The claims as a table with their reasons, failures first.
fn claim_rows(claims: &[ClaimResult]) -> String {
    let mut text = String::new();
    if claims.is_empty() {
        return text;
    }
    let (held, not_held): (Vec<_>, Vec<_>) = claims.iter().partition(|claim| claim.holds);
    let in_order = || not_held.iter().chain(&held);
    text += "| | claim | value and bounds |\n|---|---|---|\n";
    for claim in in_order() {
        let verdict = if claim.holds {
            "✔ holds"
        } else {
            "✖ **FAILS**"
        };
        text += &format!(
            "| {verdict} | {} | {} |\n",
            one_cell(&claim.name),
            one_cell(&claim.shown)
        );
    }
    // Reasons are sentences, and a table does not wrap.
    text += "\n";
    for claim in in_order() {
        let note = claim
            .note
            .as_ref()
            .map_or(String::new(), |note| format!(" Note: {note}."));
        text += &format!(
            "- *{}*: {}.{note}\n",
            claim.name,
            one_cell(&claim.reason).trim_end_matches('.')
        );
    }
    text
}

/// Text that cannot break a table.
pub(super) fn one_cell(text: &str) -> String {
    text.replace('|', "\\|")
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use truecut_recording::{Scalar, Unit};

    #[test]
    fn a_run_that_was_stopped_does_not_say_that_its_scenario_claims_nothing() {
        let stopped = Recording {
            outcome: Outcome::Interrupted,
            ..Recording::default()
        };
        let text = claims_table(&stopped, &[]);
        assert!(
            text.contains("✖ **The run was interrupted.**")
                && text.contains("No claim was judged.")
        );
    }

    #[test]
    fn notes_are_told_before_the_end_and_the_load_after_it() {
        let header = Header {
            scenario_name: "Rim".to_owned(),
            notes: vec!["masses are | estimated".to_owned()],
            ..Header::default()
        };
        let before = under_way(&header);
        assert!(before.contains("## Rim") && before.contains("\n- masses are \\| estimated"));
        assert!(before.contains("stopped before its end"), "{before}");
        let text =
            "Largest torque asked of a drive, as a share of its limit: joint `j`, limit 5 N m";
        for (share, told) in [
            (
                0.25,
                "Most loaded drive: asked for 25.0 % of its limit (joint `j`, limit 5 N m).",
            ),
            (
                1.5,
                "**OVERLOADED:** a drive is asked for 150 % of its limit (joint `j`",
            ),
        ] {
            let ended = Recording {
                header: header.clone(),
                scalars: vec![Scalar::new(TORQUE_USE, Unit::One, share, text)],
                ..Recording::default()
            };
            let after = claims_table(&ended, &[]);
            assert!(
                after.contains(told) && after.contains("estimated"),
                "{after}"
            );
        }
    }
}
