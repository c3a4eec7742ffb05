//! The diagram as text.

use std::path::PathBuf;

use truecut_arm::JointKind;
use truecut_core::chatter::averaged::Crossing;
use truecut_recording::{Unit, significant};

use super::{Diagram, rpm, uncertain};
use crate::text::{self, Align};

/// The printed text.
pub fn printed(diagram: &Diagram<'_>, written: &[PathBuf]) -> String {
    let mut text = format!("{}\n{}", diagram.scenario.name, summary(diagram));
    if !diagram.runs.is_empty() {
        text.push_str(&runs(diagram));
    }
    let [first, rest @ ..] = written else {
        return text;
    };
    text.push_str(&format!("\n{}\n", text::written(first, rest)));
    text
}

/// Posture, limits at the scenario's speed, and the best speed.
pub fn summary(diagram: &Diagram<'_>) -> String {
    let lobes = &diagram.lobes;
    let cut = &diagram.study.cut;
    let mut text = posture(diagram);
    let deepest = lobes.depth_m.last().copied().unwrap_or(0.0);
    let shown = |limit: Option<Crossing>| match limit {
        Some(limit) => format!(
            "{} at {} Hz",
            text::show(Unit::Metre, limit.depth_m),
            significant(limit.frequency_hz, 3)
        ),
        None => format!("none down to {}", text::show(Unit::Metre, deepest)),
    };
    let at = significant(rpm(cut.spindle_rad_s), 4);
    let is_known = (diagram.known.as_ref()).is_none_or(|(to, _)| cut.spindle_rad_s <= *to);
    text.push_str(&if is_known {
        format!(
            "  limits at {at} rpm: spectral elements {}, zero order {}\n",
            shown(diagram.own.limit[0]),
            shown(diagram.own.zero_order[0]),
        )
    } else {
        format!("  limits at {at} rpm: not known\n")
    });
    if let Some(other) = diagram.other.as_ref().filter(|_| is_known) {
        let (name, limit) = (&other.name, shown(other.own.limit[0]));
        text.push_str(&format!("  with {name}: spectral elements {limit}\n"));
    }
    if let Some(uncertain) = &diagram.uncertain {
        text.push_str(&uncertain::told(uncertain, diagram));
    }
    text.push_str(&text::notes(&diagram.notes));
    let missing = diagram.known.iter().map(|(_, missing)| missing);
    text.push_str(&text::notes(missing));
    if lobes.limit.iter().any(Option::is_some) {
        text.push_str(&format!(
            "  error of the limits by discretisation in time: at most {} % (estimated)\n",
            significant(lobes.largest_error() * 1e2, 2)
        ));
    }
    text.push_str(&match lobes.mode_coupling {
        Some(limit) => format!(
            "  mode coupling, were there no regeneration: {}\n",
            shown(Some(limit))
        ),
        None => "  no mode coupling at any depth\n".to_owned(),
    });
    if !diagram.scenario.effects.is_empty() {
        text.push_str(
            "  note: limits are those of the nominal arm; effects act in the runs only\n",
        );
    }
    text
}

/// Where the joints stand, in chain order, slides apart and in mm as in a scenario.
fn posture(diagram: &Diagram<'_>) -> String {
    let of = |kind: JointKind, scale: f64, unit: &str| {
        let values = diagram.joints(kind);
        let shown = values.iter().map(|value| format!("{:.2}", value * scale));
        let shown = shown.collect::<Vec<_>>().join(", ");
        (!values.is_empty()).then(|| format!("{shown} {unit}"))
    };
    let rotary = of(JointKind::Revolute, 1_f64.to_degrees(), "deg");
    let slides = of(JointKind::Prismatic, 1e3, "mm");
    let parts: Vec<String> = rotary.into_iter().chain(slides).collect();
    format!("  posture {}\n", parts.join("; slides "))
}

fn runs(diagram: &Diagram<'_>) -> String {
    let agree = diagram
        .runs
        .iter()
        .filter(|r| r.chatters == Some(r.predicted))
        .count();
    let head = ["spindle", "depth", "theory", "run", "growth", "line"];
    let rows = diagram.runs.iter().map(|run| {
        let word = |chatters: Option<bool>| match chatters {
            Some(true) => "chatters",
            Some(false) => "stable",
            None => "undecided",
        };
        vec![
            format!("{} rpm", significant(rpm(run.spindle_rad_s), 4)),
            text::show(Unit::Metre, run.depth_m),
            word(Some(run.predicted)).to_owned(),
            word(run.chatters).to_owned(),
            format!("{:+.2} 1/s", run.growth_per_s),
            format!("{:.2} Hz", run.chatter_hz),
        ]
    });
    use Align::{Left, Right};
    let aligns = [Right, Right, Left, Left, Right, Right];
    format!(
        "\n  {agree} of {} runs do what the theory says\n{}",
        diagram.runs.len(),
        text::table(&aligns, &text::headed(&head, rows))
    )
}
