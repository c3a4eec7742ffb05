//! The diagnosis for the viewer: the verdict, and a row for each channel.

use std::path::Path;

use truecut_discrepancy::diagnose::{Diagnosis, Verdict};
use truecut_discrepancy::model::Model;
use truecut_discrepancy::trial::Trial;
use truecut_telemetry::{BeforeAfter, ChannelBeforeAfter, write_before_after};

use super::{Confirmed, text};
use crate::failure::Failure;
use crate::figure::largest;
use crate::text::reading_unit;

const LEGEND: &str = "**Reading the curves.** Grey and wide: measured. Orange: the nominal model. Blue: the extended model. \
Signals open where the nominal model is worst (zoom out to see all of it); residuals are of the whole record, \
between the grey lines lies 95 % of the noise.\n";

/// Writes the file. `scenario` is the extended scenario.
pub fn write(
    trial: &Trial,
    confirmed: &Confirmed,
    scenario: &str,
    path: &Path,
) -> Result<(), Failure> {
    let diagnosis = &confirmed.answer.diagnosis;
    let mut channels: Vec<(f64, ChannelBeforeAfter)> = (0..trial.channels().len())
        .map(|index| channel(trial, confirmed, index))
        .collect();
    // Where the nominal model is furthest beyond noise, first.
    channels.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    let title = format!("Diagnosis: {}", diagnosis.scenario);
    let shown = BeforeAfter {
        title: &title,
        verdict: &verdict(diagnosis),
        scenario,
        time_s: &trial.observation.time_s,
        channels: channels.into_iter().map(|(_, channel)| channel).collect(),
    };
    write_before_after(path, &shown).map_err(|error| Failure::message(error.to_string()))
}

/// A channel, and how far its nominal model is beyond noise.
fn channel<'a>(
    trial: &'a Trial,
    confirmed: &'a Confirmed,
    index: usize,
) -> (f64, ChannelBeforeAfter<'a>) {
    let spec = &trial.channels()[index];
    let output = &trial.observation.outputs[index];
    let (nominal, extended) = (&confirmed.nominal[index], &confirmed.extended[index]);
    let measured: Vec<f64> = (output.values.iter().zip(&output.valid))
        .map(|(value, valid)| if *valid { *value } else { f64::NAN })
        .collect();
    let size = largest(measured.iter().copied());
    let error = largest(measured.iter().zip(nominal).map(|(a, b)| a - b));
    let errors = confirmed.answer.diagnosis.channels.get(&spec.name);
    let noise = errors.map_or(0.0, |errors| errors.noise_floor);
    let beyond = errors.map_or(0.0, |errors| errors.before / noise.max(f64::MIN_POSITIVE));
    let channel = ChannelBeforeAfter {
        name: &spec.name,
        unit: reading_unit(spec.unit, size),
        residual_unit: reading_unit(spec.unit, error),
        measured,
        before: nominal,
        after: (nominal != extended).then_some(extended),
        noise,
    };
    (beyond, channel)
}

/// The verdict with causes, errors and other explanations, Markdown.
fn verdict(diagnosis: &Diagnosis) -> String {
    let mut text = format!(
        "## {}\n\n**{}**\n\n{}\n\nData: `{}`\n",
        diagnosis.scenario,
        text::headline(diagnosis),
        diagnosis.reason,
        diagnosis.data
    );
    for cause in &diagnosis.causes {
        let (name, what) = (text::name(cause), text::description(cause));
        text.push_str(&format!("- *{name}*: {what}\n"));
    }
    let causes = text::cause_rows(diagnosis);
    let head = match diagnosis.verdict {
        Verdict::UnknownCause => ["explains a part", "", "95 % interval"],
        _ => ["cause or refitted value", "", "95 % interval"],
    };
    text.push_str(&table(&head.map(str::to_owned), &causes));
    if let [head, rows @ ..] = &text::error_rows(diagnosis)[..] {
        text.push_str(&errors(head, rows));
    }
    let others = text::alternative_rows(diagnosis);
    // Sentences, which a table would not wrap.
    if !others.is_empty() {
        text.push_str("\nOther explanations:\n\n");
    }
    for other in &others {
        text.push_str(&format!("- {}\n", other.join(": ")));
    }
    text.push_str(&format!(
        "\nUnexplained: {}.\n\n",
        text::unexplained(diagnosis)
    ));
    for found in text::correlated_signals(diagnosis) {
        text.push_str(&format!("- {found}\n"));
    }
    text.push('\n');
    text.push_str(LEGEND);
    text
}

/// The table of errors, narrow: a wide one, and every line with it, would be cut off. Units stand
/// with the channels, and how noise is known stands below.
fn errors(head: &[String], rows: &[Vec<String>]) -> String {
    let narrow = |row: &[String]| row[..row.len().saturating_sub(2)].to_vec();
    let mut first = narrow(head);
    if let Some(corner) = first.first_mut() {
        "rms on held-out data".clone_into(corner);
    }
    let channels = rows.iter().map(|row| {
        let mut shown = narrow(row);
        if let (Some(name), [.., unit, _]) = (shown.first_mut(), row.as_slice()) {
            *name = format!("{name} [{}]", unit.trim());
        }
        shown
    });
    let mut text = table(&first, &channels.collect::<Vec<_>>());
    let mut known: Vec<(&str, Vec<&str>)> = Vec::new();
    for row in rows {
        let ([name, ..], Some(from)) = (row.as_slice(), row.last()) else {
            continue;
        };
        match known.iter_mut().find(|(one, _)| *one == from.trim()) {
            Some((_, names)) => names.push(name.trim()),
            None => known.push((from.trim(), vec![name.trim()])),
        }
    }
    text.push('\n');
    for (from, names) in known {
        let of = match names.len() == rows.len() {
            true => String::new(),
            false => format!(" of {}", names.join(", ")),
        };
        text.push_str(&format!("- noise{of} known from: {from}\n"));
    }
    text
}

/// Nothing if there are no rows.
fn table(head: &[String], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let rule = format!("|{}\n", "---|".repeat(head.len()));
    let rows: String = rows.iter().map(|row| line(row)).collect();
    format!("\n{}{rule}{rows}", line(head))
}
