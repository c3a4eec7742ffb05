//! The answer as text: to be read in ten seconds.

use truecut_discrepancy::diagnose::{Alternative, Cause, Diagnosis, Parameter, Verdict};
use truecut_discrepancy::trial::Trial;
use truecut_recording::significant;

use super::Confirmed;
use super::files::Written;
use crate::text::{self, Align};

/// Most rows of the list of what would have been seen.
const SEEN_ROWS: usize = 8;

/// The verdict in words.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NothingBeyondNoise => "nothing beyond noise",
        Verdict::Named => "cause named",
        Verdict::Ambiguous => "these cannot be told apart",
        Verdict::UnknownCause => "none of the causes known",
        Verdict::NotIdentifiable => "not identifiable from these data",
        Verdict::FitFailed => "the fit failed",
    }
}

/// A cause: `joint_backlash on joint 2`.
pub fn name(cause: &Cause) -> String {
    match &cause.target {
        Some(target) => format!("{} on {target}", cause.kind),
        None => cause.kind.clone(),
    }
}

/// A value with its interval and unit.
pub fn estimate(parameter: &Parameter) -> String {
    let unit = match parameter.unit.as_str() {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let number = |value: f64| significant(value, 4);
    match (parameter.low, parameter.high) {
        (Some(low), Some(high)) => format!(
            "{} ({} to {}){unit}",
            number(parameter.value),
            number(low),
            number(high)
        ),
        _ => format!(
            "{}{unit} (not bounded by the data)",
            number(parameter.value)
        ),
    }
}

pub fn tell(trial: &Trial, confirmed: &Confirmed, written: &Written) -> String {
    let diagnosis = &confirmed.answer.diagnosis;
    let mut text = format!(
        "{}\n  data     {}\n  verdict  {}: {}\n",
        diagnosis.scenario,
        diagnosis.data,
        verdict(diagnosis.verdict).to_uppercase(),
        diagnosis.reason
    );
    for note in &trial.measured().notes {
        text.push_str(&format!("  note     {note}\n"));
    }
    text.push_str(&causes(diagnosis));
    text.push_str(&alternatives(diagnosis));
    text.push_str(&gain(diagnosis));
    text.push_str(&seen(diagnosis));
    text.push_str(&rest(confirmed));
    text.push_str(&format!("\n  {}", written.report.display()));
    if let Some(extended) = &written.extended {
        text.push_str(&format!(
            "   (the extended scenario: {})",
            extended.display()
        ));
    }
    text.push_str("\n\n");
    text
}

fn causes(diagnosis: &Diagnosis) -> String {
    let mut rows = Vec::new();
    for cause in &diagnosis.causes {
        let mut first = Some(name(cause));
        for (key, parameter) in &cause.parameters {
            rows.push(vec![
                first.take().unwrap_or_default(),
                key.clone(),
                estimate(parameter),
            ]);
        }
    }
    for nominal in &diagnosis.nominal {
        rows.push(vec![
            nominal.key.clone(),
            format!("{} →", significant(nominal.before, 4)),
            estimate(&nominal.after),
        ]);
    }
    titled(
        "Causes and refitted values (95 % interval)",
        &[Align::Left; 3],
        &rows,
    )
}

fn alternatives(diagnosis: &Diagnosis) -> String {
    let all = |alternative: &Alternative| {
        let names: Vec<String> = alternative.causes.iter().map(name).collect();
        names.join(" and ")
    };
    let mut rows: Vec<Vec<String>> = (diagnosis.alternatives.iter())
        .map(|one| {
            vec![
                format!("or {}", all(one)),
                format!("{:.0}° apart", one.angle_deg),
            ]
        })
        .collect();
    if rows.is_empty()
        && let Some(next) = &diagnosis.runner_up
    {
        rows.push(vec![
            format!("next best: {}", all(next)),
            format!(
                "{:.1} standard errors behind, {:.0}° apart",
                next.behind_t, next.angle_deg
            ),
        ]);
    }
    if let Some(best) = diagnosis.experiments.first() {
        rows.push(vec![
            format!("would tell them apart: {}", best.description),
            format!(
                "separation {} (now {})",
                significant(best.separation, 3),
                significant(best.separation_now, 3)
            ),
        ]);
    }
    titled("Other explanations", &[Align::Left; 2], &rows)
}

fn gain(diagnosis: &Diagnosis) -> String {
    let number = |value: f64| significant(value, 4);
    let mut rows: Vec<Vec<String>> = (diagnosis.channels.iter())
        .map(|(channel, errors)| {
            vec![
                channel.clone(),
                number(errors.before),
                number(errors.after),
                number(errors.noise_floor),
                errors.unit.clone(),
            ]
        })
        .collect();
    if !rows.is_empty() {
        let head = ["", "nominal", "extended", "noise", ""].map(str::to_owned);
        rows.insert(0, head.to_vec());
    }
    let aligns = [
        Align::Left,
        Align::Right,
        Align::Right,
        Align::Right,
        Align::Left,
    ];
    titled("Error on data kept back (root mean square)", &aligns, &rows)
}

fn seen(diagnosis: &Diagnosis) -> String {
    if diagnosis.verdict != Verdict::NothingBeyondNoise {
        return String::new();
    }
    let rows: Vec<Vec<String>> = (diagnosis.smallest_seen.iter())
        .filter_map(|one| {
            let size = one.size?;
            let target = one.target.as_deref().unwrap_or_default();
            let unit = if one.unit == "1" { "" } else { &one.unit };
            Some(vec![
                format!("{} {target}", one.kind),
                one.parameter.clone(),
                format!("{} {unit}", significant(size, 3)),
            ])
        })
        .take(SEEN_ROWS)
        .collect();
    titled(
        "These would have been seen (the others are in the report)",
        &[Align::Left; 3],
        &rows,
    )
}

fn rest(confirmed: &Confirmed) -> String {
    let diagnosis = &confirmed.answer.diagnosis;
    let mut text = String::new();
    for missing in &diagnosis.missing {
        text.push_str(&format!("  missing: {missing}\n"));
    }
    for lock in diagnosis.ceiling.locks.iter().take(3) {
        text.push_str(&format!(
            "  what is left of {} follows {} ({:.0} % of it)\n",
            lock.channel,
            lock.to,
            100.0 * lock.fraction
        ));
    }
    if let Some(failure) = &confirmed.failure {
        text.push_str(&format!(
            "  the full model could not be run with this answer, the errors are the reduced model's: {failure}\n"
        ));
    }
    text.push_str(&format!(
        "\n  {} simulations in {}\n",
        diagnosis.work.predictions,
        text::seconds(diagnosis.work.seconds)
    ));
    text
}

fn titled(title: &str, aligns: &[Align], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    format!("\n  {title}\n{}", text::table(aligns, rows))
}
