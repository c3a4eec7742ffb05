//! Files that `truecut lobes` writes.

use std::path::{Path, PathBuf};

use truecut::outputs::write_file;
use truecut_core::chatter::averaged::Crossing;
use truecut_sim::stability::StabilityRun;
use truecut_telemetry::{Column, write_charts, write_columns};

use super::{Diagram, figure, json, rpm, text};
use crate::failure::Failure;
use crate::figure::charts_of;
use crate::page::{self, Page};
use crate::spread::{self, COLUMNS};

/// Writes the figure first, then the other files.
pub fn write(diagram: &Diagram<'_>, out: &Path) -> Result<Vec<PathBuf>, Failure> {
    let folder = out.join(diagram.scenario.stem());
    let at = |name: &str| folder.join(name);
    let (svg, field, limits) = (
        at("lobes.svg"),
        at("lobes.parquet"),
        at("lobes_limits.parquet"),
    );
    let figure = figure::figure(diagram);
    write_file(&svg, figure.to_svg().as_bytes())?;
    let html = at("lobes.html");
    write_file(&html, page(diagram).html().as_bytes())?;
    let text = diagram.scenario.effective_text();
    write_columns(&field, &field_columns(diagram), &text)?;
    write_columns(&limits, &limit_columns(diagram), &text)?;
    let report = at("lobes.json");
    write_file(&report, json::json(diagram)?.as_bytes())?;
    let mut written = vec![svg, html, field, limits, report];
    if !diagram.runs.is_empty() {
        let runs = at("lobes_runs.parquet");
        write_columns(&runs, &run_columns(diagram), &text)?;
        written.push(runs);
    }
    let rrd = at("lobes.rrd");
    let pages = [charts_of(&figure)];
    let summary = text::summary(diagram);
    write_charts(&rrd, &figure.title, &summary, &pages)
        .map_err(|error| Failure::message(error.to_string()))?;
    written.push(rrd);
    Ok(written)
}

/// The diagram as a page.
fn page(diagram: &Diagram<'_>) -> Page {
    let mut page = Page::new("lobes", format!("{}: stability", diagram.scenario.name));
    page.told(&text::printed(diagram, &[]));
    page.figures("Stability", [figure::figure(diagram)]);
    page.text(page::reproduce("truecut lobes", diagram.scenario));
    page
}

fn field_columns(diagram: &Diagram<'_>) -> Vec<Column<'static>> {
    let lobes = &diagram.lobes;
    let depths = lobes.depth_m.len();
    let speeds = lobes.spindle_rad_s.iter();
    let repeated = speeds.flat_map(|speed| std::iter::repeat_n(rpm(*speed), depths));
    let each = lobes
        .spindle_rad_s
        .iter()
        .flat_map(|_| lobes.depth_m.iter());
    vec![
        Column::numbers("spindle_speed", "rpm", repeated.collect()),
        Column::numbers("axial_depth", "mm", each.map(|depth| depth * 1e3).collect()),
        Column::numbers("multiplier", "1", lobes.multiplier.concat()),
    ]
}

fn limit_columns(diagram: &Diagram<'_>) -> Vec<Column<'static>> {
    let lobes = &diagram.lobes;
    let of = |limits: &[Option<Crossing>], value: fn(Crossing) -> f64| -> Vec<f64> {
        let values = limits.iter().map(|limit| limit.map_or(f64::NAN, value));
        values.collect()
    };
    let depth = |limits: &[Option<Crossing>]| of(limits, |limit| limit.depth_m * 1e3);
    let hz = |limits: &[Option<Crossing>]| of(limits, |limit| limit.frequency_hz);
    let speeds = lobes.spindle_rad_s.iter().map(|speed| rpm(*speed));
    let errors = lobes.limit_error_m.iter();
    let errors = errors.map(|error_m| error_m.map_or(f64::NAN, |error_m| error_m * 1e3));
    let coupling = vec![lobes.mode_coupling; lobes.spindle_rad_s.len()];
    let other = diagram
        .other
        .as_ref()
        .map(|other| Column::numbers("other_damping_depth", "mm", depth(&other.lobes.limit)));
    let mut columns = vec![
        Column::numbers("spindle_speed", "rpm", speeds.collect()),
        Column::numbers("limit_depth", "mm", depth(&lobes.limit)),
        Column::numbers("limit_error", "mm", errors.collect()),
        Column::numbers("chatter_frequency", "Hz", hz(&lobes.limit)),
        Column::numbers("zero_order_depth", "mm", depth(&lobes.zero_order)),
        Column::numbers("zero_order_frequency", "Hz", hz(&lobes.zero_order)),
        Column::numbers("mode_coupling_depth", "mm", depth(&coupling)),
    ];
    columns.extend(other);
    if let Some(uncertain) = &diagram.uncertain {
        let units = ["mm", "mm", "mm", "1"];
        columns.extend(COLUMNS.into_iter().enumerate().map(|(k, name)| {
            let values = spread::column(k, &lobes.spindle_rad_s, &uncertain.over_speed, 1e3);
            Column::numbers(name, units[k], values)
        }));
    }
    columns
}

fn run_columns(diagram: &Diagram<'_>) -> Vec<Column<'static>> {
    let of = |value: fn(&StabilityRun) -> f64| diagram.runs.iter().map(value).collect();
    let chatters = |run: &StabilityRun| match run.chatters {
        Some(chatters) => f64::from(u8::from(chatters)),
        None => f64::NAN,
    };
    vec![
        Column::numbers("spindle_speed", "rpm", of(|run| rpm(run.spindle_rad_s))),
        Column::numbers("axial_depth", "mm", of(|run| run.depth_m * 1e3)),
        Column::numbers("chatters", "1", of(chatters)),
        Column::numbers("growth_rate", "1/s", of(|run| run.growth_per_s)),
        Column::numbers("chatter_frequency", "Hz", of(|run| run.chatter_hz)),
    ]
}
