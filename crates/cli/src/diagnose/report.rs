//! The answer as one page of HTML with its figures inside.

use std::fmt::Write;

use truecut_discrepancy::diagnose::{Cause, Diagnosis};
use truecut_discrepancy::model::Model;
use truecut_discrepancy::trial::Trial;
use truecut_recording::{UserUnit, significant};

use super::Confirmed;
use super::telling;
use crate::figure::{Figure, Layer, Legend, Panel, thinned};
use crate::text::reading_unit;

/// Points of a curve that a page can show.
const POINTS: usize = 1200;

const STYLE: &str = "body{font-family:sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;line-height:1.4}\
table{border-collapse:collapse;margin:.5rem 0}td,th{padding:.2rem .8rem;text-align:left;border-bottom:1px solid #ddd}\
td.n{text-align:right}.verdict{font-size:1.3rem;padding:.6rem 1rem;background:#eef3f8;border-left:6px solid #0072b2}\
svg{max-width:100%;height:auto}";

/// The page.
pub fn html(trial: &Trial, confirmed: &Confirmed) -> String {
    let diagnosis = &confirmed.answer.diagnosis;
    let title = escape(&diagnosis.scenario);
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\
         <style>{STYLE}</style></head><body>\n<h1>{title}</h1>\n<p>Data: {}</p>\n\
         <p class=\"verdict\"><b>{}</b><br>{}</p>\n",
        escape(&diagnosis.data),
        escape(&telling::headline(diagnosis)),
        escape(&diagnosis.reason)
    );
    page.push_str(&causes(diagnosis));
    page.push_str(&others(diagnosis));
    page.push_str(&gain(diagnosis));
    page.push_str("<h2>Measured, nominal, extended</h2>\n");
    for index in 0..trial.channels().len() {
        page.push_str(&figure(trial, confirmed, index));
    }
    page.push_str(&seen(diagnosis));
    page.push_str(&notes(trial, confirmed));
    page.push_str("</body></html>\n");
    page
}

fn causes(diagnosis: &Diagnosis) -> String {
    let row = |cause: &Cause| {
        let parameters: Vec<String> = (cause.parameters.iter())
            .map(|(key, parameter)| {
                format!(
                    "{} = {}",
                    escape(key),
                    escape(&telling::estimate(parameter))
                )
            })
            .collect();
        vec![
            format!(
                "{}<br><small>{}</small>",
                escape(&telling::name(cause)),
                escape(telling::description(cause))
            ),
            parameters.join("<br>"),
            format!(
                "{} standard errors on validation data; {:.1} % less error",
                significant(cause.evidence.validation_t, 3),
                100.0 * cause.evidence.practical_gain
            ),
        ]
    };
    let rows: Vec<Vec<String>> = diagnosis.causes.iter().map(row).collect();
    let mut text = table(
        "Causes",
        &["cause", "size (95 % interval)", "evidence"],
        &rows,
    );
    let nominal: Vec<Vec<String>> = (diagnosis.nominal.iter())
        .map(|one| {
            vec![
                escape(&one.key),
                significant(one.before, 5),
                escape(&telling::estimate(&one.after)),
            ]
        })
        .collect();
    text.push_str(&table(
        "Nominal values refitted",
        &["key", "before", "after"],
        &nominal,
    ));
    text
}

fn others(diagnosis: &Diagnosis) -> String {
    let candidates = diagnosis.alternatives.iter().chain(&diagnosis.runner_up);
    let rows: Vec<Vec<String>> = candidates
        .map(|one| {
            vec![
                escape(&telling::names_of(one)),
                format!("{:.0}°", one.angle_deg),
                significant(one.behind_t, 3),
            ]
        })
        .collect();
    let head = [
        "explanation",
        "angle between signatures",
        "standard errors behind",
    ];
    let mut text = table("Other explanations", &head, &rows);
    let rows: Vec<Vec<String>> = (diagnosis.experiments.iter())
        .map(|one| {
            vec![
                escape(&one.description),
                significant(one.separation, 3),
                significant(one.separation_now, 3),
            ]
        })
        .collect();
    let head = ["experiment", "separation", "separation now"];
    text.push_str(&table("What would tell them apart", &head, &rows));
    text
}

fn gain(diagnosis: &Diagnosis) -> String {
    let rows = telling::error_rows(diagnosis);
    let [head, rows @ ..] = &rows[..] else {
        return String::new();
    };
    let rows: Vec<Vec<String>> = (rows.iter())
        .map(|row| row.iter().map(|cell| escape(cell)).collect())
        .collect();
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let mut text = table("Error on data kept back (root mean square)", &head, &rows);
    let _ = writeln!(
        text,
        "<p>Unexplained: {:.0} % of the discrepancy beyond noise.</p>",
        100.0 * diagnosis.unexplained_fraction
    );
    text
}

fn seen(diagnosis: &Diagnosis) -> String {
    let rows: Vec<Vec<String>> = (diagnosis.smallest_seen.iter())
        .map(|one| {
            let size = match one.size {
                Some(size) => telling::with_unit(&significant(size, 3), &one.unit),
                None => "none within reach".to_owned(),
            };
            let target = one.target.as_deref().unwrap_or_default();
            vec![
                escape(&format!("{} {target}", one.kind)),
                escape(&one.parameter),
                escape(&size),
            ]
        })
        .collect();
    let head = ["effect", "parameter", "smallest size"];
    table(
        "The smallest effects that these data would have shown",
        &head,
        &rows,
    )
}

fn notes(trial: &Trial, confirmed: &Confirmed) -> String {
    let diagnosis = &confirmed.answer.diagnosis;
    let mut text = String::from("<h2>Notes</h2>\n<ul>\n");
    let failure = confirmed.failure.iter().map(|failure| {
        format!("The full model could not be run with this answer; the errors are the reduced model's: {failure}")
    });
    let locks = diagnosis.ceiling.locks.iter().map(|lock| {
        format!(
            "What is left of {} follows {}: {:.0} % of it.",
            lock.channel,
            lock.to,
            100.0 * lock.fraction
        )
    });
    let failed = diagnosis.fits.iter().filter(|fit| !fit.converged).count();
    let fits = format!(
        "{} fits, {failed} of them did not converge.",
        diagnosis.fits.len()
    );
    let work = format!(
        "{} simulations in {} s.",
        diagnosis.work.predictions,
        significant(diagnosis.work.seconds, 3)
    );
    let measured = trial.measured().notes.iter().cloned();
    for note in measured.chain(locks).chain(failure).chain([fits, work]) {
        let _ = writeln!(text, "<li>{}</li>", escape(&note));
    }
    text.push_str("</ul>\n");
    text
}

fn figure(trial: &Trial, confirmed: &Confirmed, index: usize) -> String {
    let spec = &trial.channels()[index];
    let output = &trial.observation.outputs[index];
    let time_s = &trial.observation.time_s;
    let size = output
        .values
        .iter()
        .fold(0.0_f64, |size, value| size.max(value.abs()));
    let unit = reading_unit(spec.unit, size);
    let (nominal, extended) = (&confirmed.nominal[index], &confirmed.extended[index]);
    let curve = |label: &str, colour, value: &dyn Fn(usize) -> f64, unit: &UserUnit| {
        let points: Vec<(f64, f64)> = (0..time_s.len())
            .filter(|row| output.valid[*row])
            .map(|row| (time_s[row], unit.from_si(value(row))))
            .collect();
        Layer {
            label: label.to_owned(),
            points: thinned(points.into_iter(), POINTS),
            colour,
            ..Layer::default()
        }
    };
    let measured = |row: usize| output.values[row];
    let worst = (0..time_s.len())
        .filter(|row| output.valid[*row])
        .fold(0.0_f64, |worst, row| {
            worst.max((measured(row) - nominal[row]).abs())
        });
    let small = reading_unit(spec.unit, worst);
    let panel = |title: &str, label: &str, unit: &UserUnit, layers| Panel {
        title: title.to_owned(),
        x_label: "time [s]".to_owned(),
        y_label: format!("{label} [{}]", unit.symbol),
        layers,
        ..Panel::default()
    };
    let signals = vec![
        curve("measured", 0, &measured, &unit),
        curve("nominal", 1, &|row| nominal[row], &unit),
        curve("extended", 2, &|row| extended[row], &unit),
    ];
    let left = |model: &[f64], row: usize| measured(row) - model[row];
    let residuals = vec![
        curve("less nominal", 1, &|row| left(nominal, row), &small),
        curve("less extended", 2, &|row| left(extended, row), &small),
    ];
    let figure = Figure {
        title: spec.description.clone(),
        panels: vec![
            panel("Signals", &spec.name, &unit, signals),
            panel(
                "Residuals: measured − simulated",
                "residual",
                &small,
                residuals,
            ),
        ],
        columns: 1,
        legend: Legend::Above,
    };
    figure.to_svg()
}

fn table(title: &str, head: &[&str], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut text = format!("<h2>{title}</h2>\n<table><tr>");
    for cell in head {
        let _ = write!(text, "<th>{cell}</th>");
    }
    text.push_str("</tr>\n");
    for row in rows {
        let cell = |cell: &String| match cell.parse::<f64>() {
            Ok(_) => format!("<td class=\"n\">{cell}</td>"),
            Err(_) => format!("<td>{cell}</td>"),
        };
        let cells: String = row.iter().map(cell).collect();
        let _ = writeln!(text, "<tr>{cells}</tr>");
    }
    text.push_str("</table>\n");
    text
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
