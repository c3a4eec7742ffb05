//! A sweep's results: a table for the terminal, Parquet, and curves as SVG.

use std::path::Path;

use truecut_recording::{ClaimResult, significant};
use truecut_scenario::Scenario;

use crate::failure::Failure;
use crate::outputs::write_file;
use crate::svg::{Chart, Curve, charts, short_number};
use crate::sweep::{Column, SweepTable};
use crate::sweep_parquet::{self, OUTCOME};
use crate::text::{self, Align};

/// Writes `sweep.parquet` and `sweep.svg`, and gives the text to print.
pub fn write(
    scenario: &Scenario,
    table: &SweepTable,
    claims: &[ClaimResult],
    out: &Path,
) -> Result<String, Failure> {
    let folder = out.join(scenario.stem());
    std::fs::create_dir_all(&folder)
        .map_err(|error| Failure::message(format!("{}: {error}", folder.display())))?;
    let parquet = folder.join("sweep.parquet");
    sweep_parquet::write(&parquet, table, &scenario.effective_text())
        .map_err(|error| Failure::message(format!("{}: {error}", parquet.display())))?;
    let svg = folder.join("sweep.svg");
    write_file(&svg, charts(&scenario.name, &curves(table)).as_bytes())?;
    Ok(tell(scenario, table, claims, &svg))
}

fn tell(scenario: &Scenario, table: &SweepTable, claims: &[ClaimResult], svg: &Path) -> String {
    let headings = table.columns.iter().map(heading);
    let head = headings.chain([OUTCOME.to_owned()]).collect();
    let rows = table
        .rows
        .iter()
        .zip(&table.diverged)
        .map(|(row, diverged)| {
            let cells = table.columns.iter().zip(row);
            let cells = cells.map(|(column, value)| cell(column, *value));
            let outcome = if diverged.is_some() {
                "✗ diverged"
            } else {
                "completed"
            };
            cells.chain([outcome.to_owned()]).collect()
        });
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    let mut aligns = vec![Align::Right; table.columns.len()];
    aligns.push(Align::Left);
    let mut text = format!(
        "{}\n  {}\n\n{}",
        scenario.name,
        table.count(),
        text::table(&aligns, &rows)
    );
    for (row, why) in table.diverged.iter().enumerate() {
        if let Some(why) = why {
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

/// One chart for each unit among the results, over the last axis; a curve for each value of the first.
fn curves(table: &SweepTable) -> Vec<Chart> {
    let axes: Vec<usize> = (0..table.columns.len())
        .filter(|i| table.columns[*i].is_axis)
        .collect();
    let Some((&over, outer)) = axes.split_last() else {
        return Vec::new();
    };
    let outer = outer.first().copied();
    let mut charts: Vec<Chart> = Vec::new();
    for (index, column) in table
        .columns
        .iter()
        .enumerate()
        .filter(|(_, column)| !column.is_axis)
    {
        let y_label = column.unit.symbol.clone();
        let position = charts.iter().position(|chart| chart.y_label == y_label);
        let position = position.unwrap_or_else(|| {
            let x_label = heading(&table.columns[over]);
            charts.push(Chart {
                x_label,
                y_label,
                curves: Vec::new(),
            });
            charts.len() - 1
        });
        charts[position]
            .curves
            .extend(curves_of(table, index, over, outer));
    }
    charts
}

fn curves_of(table: &SweepTable, index: usize, over: usize, outer: Option<usize>) -> Vec<Curve> {
    let mut curves: Vec<(Option<f64>, Curve)> = Vec::new();
    for row in &table.rows {
        let group = outer.map(|outer| row[outer]);
        let point = (row[over], row[index]);
        match curves.iter_mut().find(|(known, _)| *known == group) {
            Some((_, curve)) => curve.points.push(point),
            None => {
                let name = &table.columns[index].name;
                let label = match outer.zip(group) {
                    Some((outer, value)) => {
                        format!(
                            "{name}, {} = {}",
                            table.columns[outer].short_name(),
                            short_number(value)
                        )
                    }
                    None => name.clone(),
                };
                curves.push((
                    group,
                    Curve {
                        label,
                        points: vec![point],
                    },
                ));
            }
        }
    }
    curves.into_iter().map(|(_, curve)| curve).collect()
}
