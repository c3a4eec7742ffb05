//! Sweeps: run with progress, printed as a table, drawn as curves.

use std::path::Path;

use truecut::outputs::{SWEEP_OUTCOME, write_file, write_sweep};
use truecut_recording::{ClaimResult, Outcome, short_number, significant};
use truecut_scenario::Scenario;
use truecut_sim::sweep::{Column, SweepTable, sweep};

use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::figure::{Figure, Layer, Legend, Panel, Style};
use crate::progress::Progress;
use crate::text::{self, Align};

/// Runs a sweep with progress, prints its table and writes `sweep.parquet` and `sweep.svg`.
pub fn run_and_write(scenario: &Scenario, out: &Path) -> Result<ExitStatus, Failure> {
    let table = Progress::of_one("sweeping", |progress| sweep(scenario, progress))?;
    let claims = table.claims(scenario);
    let svg = write_sweep(out, scenario, &table)?.with_extension("svg");
    let figure = Figure {
        title: scenario.name.clone(),
        panels: panels(&table),
        columns: 1,
        legend: Legend::Right,
    };
    write_file(&svg, figure.to_svg().as_bytes())?;
    crate::print(&printed(scenario, &table, &claims, &svg))?;
    Ok(ExitStatus::of_sweep(&table, &claims))
}

fn printed(scenario: &Scenario, table: &SweepTable, claims: &[ClaimResult], svg: &Path) -> String {
    let headings = table.columns.iter().map(heading);
    let head = headings.chain([SWEEP_OUTCOME.to_owned()]).collect();
    let rows = table.rows.iter().enumerate().map(|(index, row)| {
        let cells = table.columns.iter().zip(row);
        let cells = cells.map(|(column, value)| cell(column, *value));
        let unfinished = table.unfinished[index].as_ref().map(|run| &run.outcome);
        let outcome = match (unfinished, &table.overloaded[index]) {
            (Some(Outcome::Chatter { .. }), _) => "✗ chatter",
            (Some(_), _) => "✗ diverged",
            (None, Some(_)) => "✗ overloaded",
            (None, None) => "completed",
        };
        cells.chain([outcome.to_owned()]).collect()
    });
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    let mut aligns = vec![Align::Right; table.columns.len()];
    aligns.push(Align::Left);
    let mut text = format!(
        "{}\n  {}\n{}\n{}",
        scenario.name,
        text::count_rows(table),
        text::notes(scenario.notes()),
        text::table(&aligns, &rows)
    );
    for row in 0..table.rows.len() {
        if let Some(why) = table.fault(row) {
            text.push_str(&format!("\n  ✗ {}: {why}\n", table.row_name(row)));
        }
    }
    if !claims.is_empty() {
        text.push_str(&format!("\n{}", text::claims(claims)));
    }
    text.push_str(&format!(
        "\n  {}   (beside it: sweep.parquet)\n\n",
        svg.display()
    ));
    text
}

fn cell(column: &Column, value: f64) -> String {
    if value.is_nan() {
        "none".to_owned()
    } else if column.is_axis {
        short_number(value)
    } else {
        significant(value, 4)
    }
}

fn heading(column: &Column) -> String {
    let last = column.short_name();
    match column.unit.symbol.as_str() {
        "1" => last.to_owned(),
        symbol => format!("{last} [{symbol}]"),
    }
}

/// One panel per unit of the results, over the last axis; one curve per value of the first.
fn panels(table: &SweepTable) -> Vec<Panel> {
    let columns = || 0..table.columns.len();
    let axes: Vec<usize> = columns().filter(|i| table.columns[*i].is_axis).collect();
    let Some((&over, outer)) = axes.split_last() else {
        return Vec::new();
    };
    let outer = outer.first().copied();
    let mut panels: Vec<Panel> = Vec::new();
    for index in columns().filter(|i| !table.columns[*i].is_axis) {
        let y_label = match table.columns[index].unit.symbol.as_str() {
            "1" => String::new(),
            symbol => format!("[{symbol}]"),
        };
        let known = panels.iter().position(|panel| panel.y_label == y_label);
        let position = known.unwrap_or_else(|| {
            let x_label = heading(&table.columns[over]);
            panels.push(Panel::new("", x_label, y_label, Vec::new()));
            panels.len() - 1
        });
        panels[position]
            .layers
            .extend(curves_of(table, index, over, outer));
    }
    for panel in &mut panels {
        let count = panel.layers.len();
        for (index, layer) in panel.layers.iter_mut().enumerate() {
            layer.colour = index;
            // Earlier curves are wider, so that they show behind later ones.
            layer.style = Style::Dotted(2 + (count - 1 - index).min(4) as u32);
        }
    }
    panels
}

fn curves_of(table: &SweepTable, index: usize, over: usize, outer: Option<usize>) -> Vec<Layer> {
    let mut curves: Vec<(Option<f64>, Layer)> = Vec::new();
    for row in &table.rows {
        let group = outer.map(|outer| row[outer]);
        let point = (row[over], row[index]);
        if let Some((_, curve)) = curves.iter_mut().find(|(known, _)| *known == group) {
            curve.points.push(point);
            continue;
        }
        let name = &table.columns[index].name;
        let label = match outer.zip(group) {
            Some((outer, value)) => {
                let axis = table.columns[outer].short_name();
                format!("{name}, {axis} = {}", short_number(value))
            }
            None => name.clone(),
        };
        curves.push((group, Layer::line(label, [point], 0)));
    }
    curves.into_iter().map(|(_, curve)| curve).collect()
}
