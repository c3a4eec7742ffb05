//! What changed, as text.

use std::path::Path;

use truecut_discrepancy::between::{
    Answer, Between, Changed, ChangedParameter, Changes, Recording, Verdict,
};
use truecut_recording::significant;

use super::files::Written;
use crate::diagnose::text::{
    held_out, name, odds, rows_of_errors, smallest, titled, to_within, with_unit,
};
use crate::text::{self, Align};

/// The verdict with what it is about: to be read first.
pub fn headline(found: &Changes) -> String {
    let verdict = verdict(found);
    let Some(first) = found.events.first() else {
        return verdict;
    };
    let is_one = (found.events.iter()).all(|one| one.recording == first.recording);
    let place = match first.recording {
        Recording::First if is_one => "THE FIRST RECORDING",
        Recording::Second if is_one => "THE SECOND RECORDING",
        Recording::OneOfBoth if is_one => "ONE OF THE RECORDINGS",
        _ => "THE RECORDINGS",
    };
    match found.verdict == Verdict::UnknownChange && found.changes.is_empty() {
        true => format!("SOMETHING HAPPENED WITHIN {place}"),
        false => format!("SOMETHING HAPPENED WITHIN {place}; {verdict}"),
    }
}

/// What is told of the change from one recording to the other.
fn verdict(found: &Changes) -> String {
    let names: Vec<String> = found.changes.iter().map(name_of).collect();
    let names = names.join(" and ");
    match found.verdict {
        Verdict::NothingChanged => "NOTHING CHANGED BEYOND NOISE".to_owned(),
        Verdict::Changed => format!("CHANGED: {names}"),
        Verdict::Ambiguous if names.is_empty() => "WHETHER IT CHANGED CANNOT BE TOLD".to_owned(),
        Verdict::Ambiguous => {
            let rivals = found.alternatives.iter().map(|one| names_of(&one.changes));
            let all: Vec<String> = std::iter::once(names).chain(rivals).collect();
            format!("THESE CHANGES CANNOT BE TOLD APART: {}", all.join(" or "))
        }
        Verdict::UnknownChange if names.is_empty() => {
            "SOMETHING CHANGED THAT NO CAUSE KNOWN EXPLAINS".to_owned()
        }
        Verdict::UnknownChange => format!("CHANGED, AND NOT THIS ALONE: {names}"),
        Verdict::NotIdentifiable => "NOT IDENTIFIABLE FROM THESE RECORDINGS".to_owned(),
        Verdict::FitFailed => "THE FIT FAILED".to_owned(),
    }
}

/// An effect that changed: `joint_coulomb on joint2`.
pub fn name_of(changed: &Changed) -> String {
    match &changed.target {
        Some(target) => format!("{} on {target}", changed.kind),
        None => changed.kind.clone(),
    }
}

pub fn names_of(changes: &[Changed]) -> String {
    let names: Vec<String> = changes.iter().map(name_of).collect();
    names.join(" and ")
}

/// How the recordings were compared.
pub fn compared(found: &Changes) -> String {
    match (found.compared.later_s, found.compared.unlike) {
        (Some(later_s), Some(unlike)) => {
            let shift = match later_s.abs() < 1e-9 {
                true => String::new(),
                false => format!(", {} s later in its file", significant(later_s, 4)),
            };
            format!(
                "the second repeats the motion of the first{shift} (inputs differ by {} %): their difference is explained",
                significant(100.0 * unlike, 2)
            )
        }
        _ => "the motions differ: what both share is fitted to both".to_owned(),
    }
}

/// Before, after, change with its interval. A change is not rounded away.
pub fn estimates(parameter: &ChangedParameter) -> [String; 3] {
    let number = |value: f64| to_within(value, parameter.change);
    let change = match (parameter.low, parameter.high) {
        (Some(low), Some(high)) => with_unit(
            &format!(
                "{} ({} to {})",
                signed(parameter.change),
                signed(low),
                signed(high)
            ),
            &parameter.unit,
        ),
        _ => format!(
            "{} (not bounded by the data)",
            with_unit(&signed(parameter.change), &parameter.unit)
        ),
    };
    [number(parameter.before), number(parameter.after), change]
}

fn signed(value: f64) -> String {
    match value >= 0.0 {
        true => format!("+{}", significant(value, 4)),
        false => significant(value, 4),
    }
}

/// A parameter a row: what, key, before and after, change, odds.
fn change_rows(found: &Changes) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for changed in &found.changes {
        let mut first = Some(name_of(changed));
        let mut told = Some(odds(changed.evidence.log10_odds));
        for (key, parameter) in &changed.parameters {
            let [before, after, change] = estimates(parameter);
            rows.push(vec![
                first.take().unwrap_or_default(),
                key.clone(),
                format!("{before} → {after}"),
                change,
                told.take().unwrap_or_default(),
            ]);
        }
    }
    rows
}

/// Errors on held-out data without and with the changes.
pub fn error_rows(found: &Changes) -> Vec<Vec<String>> {
    rows_of_errors(&found.channels, ["without change", "with it"], false)
}

fn rival_rows(found: &Changes) -> Vec<Vec<String>> {
    let row = |what: &str, one: &truecut_discrepancy::between::Rival| {
        let log10 = 0.5 * one.criterion_difference / std::f64::consts::LN_10;
        vec![
            format!("{what} {}", names_of(&one.changes)),
            format!(
                "odds {} against it, {:.0}° apart",
                odds(log10),
                one.angle_deg
            ),
        ]
    };
    let mut rows: Vec<Vec<String>> = found
        .alternatives
        .iter()
        .map(|one| row("or", one))
        .collect();
    if rows.is_empty() {
        rows.extend(found.runner_up.iter().map(|one| row("next best:", one)));
    }
    rows
}

/// What the model lacks in both.
pub fn shared(found: &Changes) -> Option<String> {
    let names: Vec<String> = found.shared.iter().map(name).collect();
    (!names.is_empty()).then(|| {
        format!(
            "both recordings show what the scenario lacks, which is no change: {}",
            names.join(", ")
        )
    })
}

pub fn printed(pair: &Between, answer: &Answer, written: &Written) -> String {
    let found = &answer.changes;
    let mut printed = format!(
        "{}\n  first    {}\n  second   {}\n  motion   {}\n  verdict  {}\n           {}\n",
        found.scenario,
        found.first,
        found.second,
        compared(found),
        headline(found),
        found.reason
    );
    for note in notes(pair) {
        printed.push_str(&format!("  note     {note}\n"));
    }
    printed.extend(shared(found).map(|text| format!("  note     {text}\n")));
    printed.push_str(&titled(
        "Changes (before → after; change with its 95 % interval; odds that there is one)",
        &[Align::Left; 5],
        &change_rows(found),
    ));
    printed.push_str(&titled(
        "Other explanations",
        &[Align::Left; 2],
        &rival_rows(found),
    ));
    printed.push_str(&held_out(
        "Error on held-out data (root mean square)",
        &error_rows(found),
    ));
    if found.verdict == Verdict::NothingChanged {
        let title = "These changes would have been seen (the others are in the report)";
        printed.push_str(&smallest(title, &found.smallest_seen));
    }
    for doubt in &found.doubts {
        printed.push_str(&format!("  doubtful: {doubt}\n"));
    }
    for missing in &found.missing {
        printed.push_str(&format!("  missing: {missing}\n"));
    }
    printed.push_str(&format!(
        "\n  {} simulations in {}\n",
        found.work.predictions,
        text::seconds(found.work.seconds)
    ));
    let row = |what: &str, path: &Path| vec![what.to_owned(), path.display().to_string()];
    let mut files = vec![row("report", &written.report)];
    if let Some([before, after]) = &written.scenarios {
        files.push(row("scenario before", before));
        files.push(row("scenario after", after));
    }
    printed.push_str(&text::table(&[Align::Left; 2], &files));
    printed.push('\n');
    printed
}

/// Notes on both recordings; those that are the same once.
pub fn notes(pair: &Between) -> Vec<String> {
    let [first, second] = [&pair.first, &pair.second].map(|trial| trial.measured().notes.clone());
    let mut notes: Vec<String> = Vec::new();
    for (which, own, others) in [("first", &first, &second), ("second", &second, &first)] {
        for note in own {
            match (others.contains(note), which) {
                (true, "first") => notes.push(note.clone()),
                (true, _) => {}
                (false, which) => notes.push(format!("{which} recording: {note}")),
            }
        }
    }
    notes
}

#[cfg(test)]
mod tests {
    use truecut_discrepancy::between::Event;
    use truecut_discrepancy::diagnose::Change;

    use super::*;

    /// What happens within a recording is told before what is named beside it.
    #[test]
    fn what_happens_within_a_recording_stands_in_the_headline() {
        let event = |recording| Event {
            recording,
            change: Change {
                channel: "joint1.drive_torque".into(),
                from_s: Some(4.0),
                until_s: Some(6.0),
                what: "joint_coulomb of joint1".into(),
            },
        };
        let mut found = Changes {
            verdict: Verdict::UnknownChange,
            events: vec![event(Recording::Second)],
            ..Changes::default()
        };
        let told = "SOMETHING HAPPENED WITHIN THE SECOND RECORDING";
        assert_eq!(headline(&found), told);
        found.verdict = Verdict::FitFailed;
        assert_eq!(headline(&found), format!("{told}; THE FIT FAILED"));
        found.verdict = Verdict::UnknownChange;
        found.events.push(event(Recording::First));
        assert_eq!(headline(&found), "SOMETHING HAPPENED WITHIN THE RECORDINGS");
        found.events.clear();
        let told = "SOMETHING CHANGED THAT NO CAUSE KNOWN EXPLAINS";
        assert_eq!(headline(&found), told);
    }
}
