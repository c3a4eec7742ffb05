//! The diagnosis as text, short enough to read in ten seconds.

mod errors;

use std::path::Path;

use truecut_discrepancy::diagnose::{
    Alternative, Cause, Diagnosis, NoiseSource, Nominal, Parameter, SmallestSeen, Verdict,
};
use truecut_discrepancy::trial::Trial;
use truecut_recording::significant;
use truecut_scenario::effect::EffectKind;
use truecut_scenario::key_unit;

use self::errors::unbounded;
pub use self::errors::{held_out, rows_of_errors};
pub use self::headline::headline;
use super::Confirmed;
use super::Written;
use crate::text::{self, Align};

mod headline;

/// Most rows of the list of detectable sizes.
const SEEN_ROWS: usize = 8;
/// Most of what is said to be followed by what is left.
const MOST_SIGNALS: usize = 3;

/// Its effects, all of them.
pub fn names_of(alternative: &Alternative) -> String {
    let names: Vec<String> = alternative.causes.iter().map(name).collect();
    names.join(" and ")
}

/// What a cause is, in one sentence.
pub fn description(cause: &Cause) -> &'static str {
    EffectKind::from_name(&cause.kind).map_or("", EffectKind::description)
}

/// A cause: `joint_backlash on joint 2`.
pub fn name(cause: &Cause) -> String {
    match &cause.target {
        Some(target) => format!("{} on {target}", cause.kind),
        None => cause.kind.clone(),
    }
}

/// What a curve gives.
pub fn curve_of(kind: &str) -> &'static str {
    match kind {
        "joint_position_curve" => "on the link",
        _ => "friction",
    }
}

/// Odds from their decimal logarithm; beyond a million they say more of the noise's model than of
/// the cause.
pub fn odds(log10: f64) -> String {
    match log10 {
        6.0.. => "more than 1e6 : 1".to_owned(),
        0.0.. => format!("{} : 1", significant(10_f64.powf(log10), 2)),
        _ => format!("1 : {}", significant(10_f64.powf(-log10), 2)),
    }
}

/// What Schwarz's criterion says of the causes named against another explanation: by that it was
/// put behind them, whichever predicts the validation blocks better.
pub fn odds_against(other: &Alternative) -> String {
    let log10 = 0.5 * other.criterion_difference / std::f64::consts::LN_10;
    format!("odds {} against it", odds(log10))
}

/// A number with its unit, if it has one.
pub fn with_unit(number: &str, unit: &str) -> String {
    match unit {
        "1" => number.to_owned(),
        unit => format!("{number} {unit}"),
    }
}

/// A number with at least four digits, and as many as show two of a difference of this size.
pub fn to_within(value: f64, difference: f64) -> String {
    let place = |x: f64| x.abs().log10().floor();
    let digits = 2.0 + place(value) - place(difference);
    // No digit beyond what a double holds; nothing to go by where a size is 0 or infinite.
    let digits = if digits.is_finite() { digits } else { 4.0 };
    significant(value, digits.clamp(4.0, 12.0) as usize)
}

/// What must be seen in a factor: half its interval, and how far it is from 1, unless that is next
/// to nothing beside the interval.
fn to_be_seen(parameter: &Parameter) -> f64 {
    let half = match (parameter.low, parameter.high) {
        (Some(low), Some(high)) => 0.5 * (high - low),
        _ => 0.0,
    };
    let from_one = (parameter.value - 1.0).abs();
    match parameter.unit == "1" && from_one > 0.1 * half && (from_one < half || half == 0.0) {
        true => from_one,
        false => half,
    }
}

/// A value with its interval and unit.
pub fn estimate(parameter: &Parameter) -> String {
    let difference = to_be_seen(parameter);
    let number = |value: f64| to_within(value, difference);
    let value = number(parameter.value);
    match (parameter.low, parameter.high) {
        (Some(low), Some(high)) => with_unit(
            &format!("{value} ({} to {})", number(low), number(high)),
            &parameter.unit,
        ),
        _ => format!(
            "{} (not bounded by the data)",
            with_unit(&value, &parameter.unit)
        ),
    }
}

/// Causes and refitted values, a parameter a row: what, its key or its value before, its estimate.
pub fn cause_rows(diagnosis: &Diagnosis) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for cause in &diagnosis.causes {
        let mut first = Some(name(cause));
        let mut odds = Some(odds(cause.evidence.log10_odds));
        for (key, parameter) in &cause.parameters {
            rows.push(vec![
                first.take().unwrap_or_default(),
                key.clone(),
                estimate(parameter),
                odds.take().unwrap_or_default(),
            ]);
        }
    }
    for nominal in &diagnosis.nominal {
        let (before, after) = in_unit_of_key(nominal);
        rows.push(vec![
            nominal.key.clone(),
            format!("{} →", significant(before, 4)),
            estimate(&after),
            String::new(),
        ]);
    }
    rows
}

/// A nominal value before and after, in the unit in which its key is written.
pub fn in_unit_of_key(nominal: &Nominal) -> (f64, Parameter) {
    let unit = key_unit(&nominal.key);
    let shown = |value: f64| unit.from_si(value);
    let after = Parameter {
        value: shown(nominal.after.value),
        low: nominal.after.low.map(shown),
        high: nominal.after.high.map(shown),
        unit: unit.symbol.clone(),
    };
    (shown(nominal.before), after)
}

/// A header, and for each channel its errors on held-out data and the noise, in the unit in which
/// one reads them.
pub fn error_rows(diagnosis: &Diagnosis) -> Vec<Vec<String>> {
    let refitted = !diagnosis.nominal.is_empty();
    rows_of_errors(&diagnosis.channels, ["nominal", "extended"], refitted)
}

/// What comes nearest and is not named: effect, sizes.
pub fn nearest_rows(diagnosis: &Diagnosis) -> Vec<[String; 2]> {
    let rows = diagnosis.nearest.iter().map(|cause| {
        let sizes = cause.parameters.iter();
        let sizes = sizes.map(|(key, found)| format!("{key} = {}", estimate(found)));
        [name(cause), sizes.collect::<Vec<_>>().join(", ")]
    });
    rows.collect()
}

/// What comes nearest and is not named, alternatives or the next best explanation, and the
/// experiment that would decide: what, how far.
pub fn alternative_rows(diagnosis: &Diagnosis) -> Vec<Vec<String>> {
    let nearest = nearest_rows(diagnosis).into_iter();
    let nearest = nearest.map(|[name, sizes]| vec![format!("nearest, not named: {name}"), sizes]);
    let alternatives = (diagnosis.alternatives.iter()).map(|one| {
        vec![
            format!("or {}", names_of(one)),
            format!("{:.0}° apart", one.angle_deg),
        ]
    });
    let mut rows: Vec<Vec<String>> = nearest.chain(alternatives).collect();
    if rows.is_empty()
        && let Some(next) = &diagnosis.runner_up
    {
        rows.push(vec![
            format!("next best: {}", names_of(next)),
            format!("{}, {:.0}° apart", odds_against(next), next.angle_deg),
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
    rows
}

/// How much of the discrepancy is unexplained, and in which channel most is left beyond the noise.
pub fn unexplained(diagnosis: &Diagnosis) -> String {
    let percent = 100.0 * diagnosis.unexplained_fraction;
    let share = match percent {
        0.0 => "nothing".to_owned(),
        ..1.0 => "less than 1 %".to_owned(),
        _ => format!("{percent:.0} %"),
    };
    let known = diagnosis.channels.iter().filter(|(_, errors)| {
        errors.noise_source != NoiseSource::Bound && errors.noise_floor > 0.0
    });
    let ratios = known.map(|(name, errors)| (errors.after / errors.noise_floor, name));
    let told = match ratios.max_by(|a, b| a.0.total_cmp(&b.0)) {
        // The channel that changes has no noise that is known, and most is left of that.
        Some((ratio, _)) if ratio < SURELY && !diagnosis.changes.is_empty() => {
            format!("{share} of the discrepancy beyond noise, in what changes over time")
        }
        Some((ratio, name)) => {
            let share = match percent {
                0.0 if ratio > SURELY => "nothing that is surely",
                _ => &format!("{share} of the discrepancy"),
            };
            let ratio = significant(ratio, 3);
            format!("{share} beyond noise; most is left of {name}, {ratio} times its noise")
        }
        None => format!("{share} of the discrepancy, if noise is all that has a memory"),
    };
    // What a curve explains has no cause that is known.
    let beside = match diagnosis.curve.is_some() {
        true => "beside causes and curve: ",
        false => "",
    };
    beside.to_owned() + &told + &unbounded(diagnosis)
}

/// More than so many times the noise is no scatter of what is left.
const SURELY: f64 = 1.2;

/// What is left of the channels follows …
pub fn correlated_signals(diagnosis: &Diagnosis) -> Vec<String> {
    let correlated_signals = diagnosis.ceiling.correlated_signals.iter().map(|found| {
        format!(
            "what is left of {} follows {} ({:.0} % of it)",
            found.channel,
            found.signal,
            100.0 * found.fraction
        )
    });
    correlated_signals.take(MOST_SIGNALS).collect()
}

pub fn printed(trial: &Trial, confirmed: &Confirmed, written: &Written) -> String {
    let diagnosis = &confirmed.answer.diagnosis;
    let mut text = format!(
        "{}\n  data     {}\n  verdict  {}\n           {}\n",
        diagnosis.scenario,
        diagnosis.data,
        headline(diagnosis),
        diagnosis.reason
    );
    for note in &trial.measured().notes {
        text.push_str(&format!("  note     {note}\n"));
    }
    text.push_str(&causes(diagnosis));
    text.push_str(&alternatives(diagnosis));
    if let Some(told) = &written.excite {
        text.push_str(&format!("  {told}\n"));
    }
    text.push_str(&gain(diagnosis));
    text.push_str(&seen(diagnosis));
    text.push_str(&rest(confirmed));
    let row = |what: &str, path: &Path| vec![what.to_owned(), path.display().to_string()];
    let mut files = vec![row("report", &written.report)];
    files.extend((written.extended.iter()).map(|path| row("extended scenario", path)));
    files.push(row("for truecut view", &written.viewer));
    text.push_str(&text::table(&[Align::Left; 2], &files));
    text.push('\n');
    text
}

fn causes(diagnosis: &Diagnosis) -> String {
    titled(
        "Causes and refitted values (95 % interval; odds that it is there rather than not)",
        &[Align::Left; 4],
        &cause_rows(diagnosis),
    )
}

fn alternatives(diagnosis: &Diagnosis) -> String {
    let rows = alternative_rows(diagnosis);
    titled("Other explanations", &[Align::Left; 2], &rows)
}

fn gain(diagnosis: &Diagnosis) -> String {
    held_out(
        "Error on held-out data (root mean square)",
        &error_rows(diagnosis),
    )
}

fn seen(diagnosis: &Diagnosis) -> String {
    if diagnosis.verdict != Verdict::NothingBeyondNoise {
        return String::new();
    }
    smallest(
        "These would have been seen (the others are in the report)",
        &diagnosis.smallest_seen,
    )
}

/// Sizes that would have been seen.
pub fn smallest(title: &str, seen: &[SmallestSeen]) -> String {
    let rows: Vec<Vec<String>> = (seen.iter())
        .filter_map(|one| {
            let size = one.size?;
            let target = one.target.as_deref().unwrap_or_default();
            Some(vec![
                format!("{} {target}", one.kind),
                one.parameter.clone(),
                with_unit(&significant(size, 3), &one.unit),
            ])
        })
        .take(SEEN_ROWS)
        .collect();
    titled(title, &[Align::Left; 3], &rows)
}

fn rest(confirmed: &Confirmed) -> String {
    let diagnosis = &confirmed.answer.diagnosis;
    let mut text = String::new();
    if !diagnosis.causes.is_empty() {
        text.push_str(&format!("  unexplained: {}\n", unexplained(diagnosis)));
    }
    for doubt in &diagnosis.doubts {
        text.push_str(&format!("  doubtful: {doubt}\n"));
    }
    for missing in &diagnosis.missing {
        text.push_str(&format!("  missing: {missing}\n"));
    }
    for found in correlated_signals(diagnosis) {
        text.push_str(&format!("  {found}\n"));
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

pub fn titled(title: &str, aligns: &[Align], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    format!("\n  {title}\n{}", text::table(aligns, rows))
}

#[cfg(test)]
mod tests;
