//! Identification as text: a table, and notes.

use std::path::PathBuf;

use truecut_discrepancy::identify::modes::{Interval, Measured, ModesReport};
use truecut_discrepancy::identify::stiffness::{JointStiffness, Status, StiffnessReport};
use truecut_recording::{Unit, significant};

use crate::text::{Align, headed, notes, show, table, written as written_files};

pub fn stiffness(report: &StiffnessReport, written: &[PathBuf]) -> String {
    let mut text = format!(
        "  joint stiffness: {} loadings in {} postures, {} readings of {}\n\n",
        report.loadings, report.postures, report.readings, report.source
    );
    let interval = "95 % interval";
    let head = ["joint", "stiffness", interval, "unit", "robot's file", ""];
    use Align::{Left, Right};
    text.push_str(&table(
        &[Left, Right, Left, Left, Right, Left],
        &headed(&head, report.joints.iter().map(joint)),
    ));
    text.push('\n');
    for one in &report.components {
        let unit = if one.unit == "m" {
            Unit::Metre
        } else {
            Unit::Radian
        };
        let nominal = (one.nominal_residual_rms)
            .map(|rms| format!(", robot's file leaves {}", show(unit, rms)));
        text.push_str(&format!(
            "  {}: {} RMS measured{}, identified leaves {}\n",
            one.channel,
            show(unit, one.measured_rms),
            nominal.unwrap_or_default(),
            show(unit, one.residual_rms)
        ));
    }
    text.push_str(&notes(&report.notes));
    finish(text, written)
}

fn joint(joint: &JointStiffness) -> Vec<String> {
    let four = |value: f64| significant(value, 4);
    let (value, interval) = match (joint.value, joint.low, joint.high) {
        (Some(value), Some(low), Some(high)) => {
            (four(value), format!("{} to {}", four(low), four(high)))
        }
        (_, Some(low), _) => ("–".to_owned(), format!("above {}", four(low))),
        _ => ("–".to_owned(), String::new()),
    };
    let others = || joint.confused_with.join(", ");
    let remark = match joint.status {
        Status::Identified => match (joint.agrees, joint.value, joint.nominal) {
            (Some(true), ..) => "✓ agrees".to_owned(),
            (Some(false), Some(value), Some(nominal)) => {
                format!("✗ {} times the file's", significant(value / nominal, 3))
            }
            (None, Some(_), Some(_)) => "not judged: see the notes".to_owned(),
            _ => String::new(),
        },
        Status::LowerBound if joint.confused_with.is_empty() => {
            "not identified: moves the tool too little in these postures".to_owned()
        }
        Status::LowerBound => format!("not identified: mistaken for {}", others()),
        Status::NotLoaded => "not identified: no load turns it".to_owned(),
        Status::NotSeparable => format!("not identified: cannot be told from {}", others()),
        Status::Contradictory => "✗ contradictory: the compliance is below zero".to_owned(),
    };
    vec![
        joint.name.clone(),
        value,
        interval,
        joint.unit.to_owned(),
        joint.nominal.map_or("–".to_owned(), four),
        remark,
    ]
}

pub fn modes(report: &ModesReport, written: &[PathBuf]) -> String {
    let [low, high] = report.band_hz;
    let mut text = format!(
        "  modes: {} FRFs, {low} to {high} Hz\n\n",
        report.frfs.len()
    );
    let head = [
        "mode",
        "measured",
        "±",
        "damping",
        "interval",
        "model",
        "damping",
        "MAC",
        "with identified stiffness",
    ];
    let found = report.measured.iter().enumerate();
    let mut rows = headed(&head, found.map(|(k, mode)| measured(k, mode, report)));
    let paired = |k: usize| report.measured.iter().any(|mode| mode.partner == Some(k));
    let alone = report
        .model
        .iter()
        .enumerate()
        .filter(|(k, one)| one.visible && !paired(*k));
    for (_, mode) in alone {
        let mut row = vec![String::new(); 9];
        row[1] = "not measured".to_owned();
        row[5] = hz(mode.frequency_hz);
        row[6] = percent(mode.damping_ratio);
        rows.push(row);
    }
    let mut aligns = [Align::Right; 9];
    aligns[0] = Align::Left;
    // An empty column is left out.
    if report
        .measured
        .iter()
        .all(|mode| mode.identified_stiffness_hz.is_none())
    {
        rows.iter_mut().for_each(|row| row.truncate(8));
    }
    text.push_str(&table(&aligns, &rows));
    let unseen = report.model.iter().filter(|one| !one.visible).count();
    if unseen > 0 {
        text.push_str(&format!(
            "  {unseen} of the model's modes lie outside the band or do not show in these FRFs\n"
        ));
    }
    for mode in &report.tool {
        let [x, y, z] = mode.direction;
        text.push_str(&format!(
            "  tool mode at {} Hz: with its foot held {} Hz, {}, {} N/µm along [{x:.2}, {y:.2}, {z:.2}] in the tool frame\n",
            significant(mode.measured_hz, 5),
            significant(mode.frequency_hz, 5),
            percent(mode.damping_ratio),
            significant(mode.stiffness_n_per_m * 1e-6, 4),
        ));
    }
    text.push('\n');
    for frf in &report.frfs {
        text.push_str(&format!(
            "  {}: the fit leaves {} %, the model {} % of the FRF\n",
            frf.source,
            significant(100.0 * frf.residual, 2),
            significant(100.0 * frf.model_error, 2)
        ));
    }
    text.push_str(&notes(&report.notes));
    finish(text, written)
}

fn measured(k: usize, mode: &Measured, report: &ModesReport) -> Vec<String> {
    let partner = mode.partner.map(|k| &report.model[k]);
    let half = |interval: &Interval| 0.5 * (interval.high - interval.low);
    let damping = &mode.damping_ratio;
    vec![
        (k + 1).to_string(),
        hz(mode.frequency_hz.value),
        significant(half(&mode.frequency_hz), 2),
        percent(damping.value),
        format!("{} to {}", percent(damping.low), percent(damping.high)),
        partner.map_or("none".to_owned(), |one| hz(one.frequency_hz)),
        partner.map_or(String::new(), |one| percent(one.damping_ratio)),
        mode.mac.map_or(String::new(), |mac| format!("{mac:.2}")),
        mode.identified_stiffness_hz.map_or(String::new(), hz),
    ]
}

fn hz(value: f64) -> String {
    format!("{} Hz", significant(value, 4))
}

fn percent(ratio: f64) -> String {
    format!("{} %", significant(100.0 * ratio, 3))
}

fn finish(mut text: String, written: &[PathBuf]) -> String {
    if let Some((first, rest)) = written.split_first() {
        text.push('\n');
        text.push_str(&format!("{}\n", written_files(first, rest)));
    }
    text
}
