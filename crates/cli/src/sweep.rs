//! Sweeps: run with progress, printed as a table, drawn as curves.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use truecut::SweepOutputs;
use truecut::outputs::{SWEEP_OUTCOME, write_file};
use truecut_recording::{ClaimResult, short_number, significant};
use truecut_scenario::Scenario;
use truecut_sim::run::RunError;
use truecut_sim::sweep::{Column, Fault, SweepTable};
use truecut_sim::{Robots, estimates};

use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::figure::{BLACK, Figure, Layer, Legend, PINK, Panel, Style};
use crate::page::{self, Page};
use crate::progress::Progress;
use crate::text::{self, Align};

/// Runs a sweep with progress, prints its table and writes `sweep.parquet` and `sweep.svg`; one
/// that is stopped leaves the rows that are done.
pub fn run_and_write(
    scenario: &Scenario,
    out: &Path,
    stop: &AtomicBool,
) -> Result<ExitStatus, Failure> {
    let outputs = SweepOutputs::prepare(out, scenario)?;
    let kept = outputs.kept();
    let swept = Progress::of_one("sweeping", |progress| outputs.run(progress, Some(stop)));
    let table = match swept {
        Err(RunError::Stopped) => {
            let done = outputs.done();
            return crate::print(&format!(
                "{}\n  stopped by a signal: {done} rows are kept, and the same call goes on from there\n\n",
                scenario.name
            ));
        }
        other => other?,
    };
    let claims = table.claims(scenario);
    let svg = outputs.finish(&table)?.with_extension("svg");
    let figure = Figure {
        title: scenario.name.clone(),
        panels: panels(&table),
        columns: 1,
        legend: Legend::Right,
    };
    write_file(&svg, figure.to_svg().as_bytes())?;
    let page = page(scenario, &table, &claims, figure);
    write_file(&svg.with_extension("html"), page.html().as_bytes())?;
    if kept > 0 {
        let count = table.rows.len();
        crate::print(&format!(
            "{kept} of {count} rows were kept from a sweep that was stopped\n"
        ))?;
    }
    crate::print(&printed(scenario, &table, &claims, &svg))?;
    Ok(ExitStatus::of_sweep(&table, &claims))
}

/// The sweep as a page.
fn page(scenario: &Scenario, table: &SweepTable, claims: &[ClaimResult], figure: Figure) -> Page {
    let mut page = Page::new("run", &scenario.name);
    let held = claims.iter().filter(|claim| claim.holds).count();
    let detail = match claims.len() {
        0 => "no claims".to_owned(),
        count => format!("{held} of {count} claims hold"),
    };
    let good = ExitStatus::of_sweep(table, claims) == ExitStatus::Good;
    page.verdict(good, &text::count_rows(table), &detail);
    page.text(page::claims("Claims", claims));
    let notes = scenario.notes().into_iter();
    let notes = notes.chain(estimates(scenario, &Robots::new()).ok().flatten());
    page.text(page::notes(&notes.collect::<Vec<_>>()));
    page.figures("Results", [figure]);
    let head = table.columns.iter().map(heading);
    let head: Vec<String> = head.chain([SWEEP_OUTCOME.to_owned()]).collect();
    let rows = table.rows.iter().enumerate().take(MOST_ROWS);
    let rows = rows.map(|(index, row)| {
        let values = table.columns.iter().zip(row);
        let mut texts: Vec<String> = values.map(|(column, value)| cell(column, *value)).collect();
        texts.push(table.fault(index).unwrap_or("completed").to_owned());
        page::cells(&texts)
    });
    let title = match table.rows.len() {
        count if count > MOST_ROWS => format!("The first {MOST_ROWS} of {count} rows"),
        _ => "Rows".to_owned(),
    };
    page.text(page::table(&title, &head, rows));
    page.text(page::reproduce("truecut run", scenario));
    page
}

/// Most rows of a table that a page or a terminal lists: `sweep.csv` has all.
const MOST_ROWS: usize = 1000;

fn printed(scenario: &Scenario, table: &SweepTable, claims: &[ClaimResult], svg: &Path) -> String {
    let headings = table.columns.iter().map(heading);
    let head = headings.chain([SWEEP_OUTCOME.to_owned()]).collect();
    let count = table.rows.len();
    let rows = table.rows.iter().enumerate().take(MOST_ROWS);
    let rows = rows.map(|(index, row)| {
        let cells = table.columns.iter().zip(row);
        let cells = cells.map(|(column, value)| cell(column, *value));
        let outcome = match &table.faults[index] {
            Some(fault) => format!("✗ {}", text::ended(fault)),
            None => "completed".to_owned(),
        };
        cells.chain([outcome]).collect()
    });
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    let mut aligns = vec![Align::Right; table.columns.len()];
    aligns.push(Align::Left);
    let mut text = format!(
        "{}\n  {}\n{}{}\n{}",
        scenario.name,
        text::count_rows(table),
        text::notes(scenario.notes()),
        text::notes(estimates(scenario, &Robots::new()).ok().flatten()),
        text::table(&aligns, &rows)
    );
    if count > MOST_ROWS {
        text.push_str(&format!(
            "\n  the first {MOST_ROWS} of {count} rows: all are in sweep.csv\n"
        ));
    }
    let faults = (0..count).filter_map(|row| Some((row, table.fault(row)?)));
    for (row, why) in faults.clone().take(MOST_ROWS) {
        text.push_str(&format!("\n  ✗ {}: {why}\n", table.row_name(row)));
    }
    if let more @ 1.. = faults.skip(MOST_ROWS).count() {
        text.push_str(&format!("\n  ✗ and {more} rows more, in sweep.csv\n"));
    }
    if table.rows.iter().flatten().any(|value| value.is_nan()) {
        text.push_str(
            "\n  none: the run was completed and has no such value (what is asked for did not happen), or \
             it ended early\n",
        );
    }
    if !claims.is_empty() {
        text.push_str(&format!("\n{}", text::claims(claims)));
    }
    text.push_str(&format!(
        "\n  {}   (beside it: sweep.html, sweep.parquet)\n\n",
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
    let mut units: Vec<(&str, Vec<usize>)> = Vec::new();
    for index in columns().filter(|i| !table.columns[*i].is_axis) {
        let unit = table.columns[index].unit.symbol.as_str();
        match units.iter_mut().find(|(known, _)| *known == unit) {
            Some((_, members)) => members.push(index),
            None => units.push((unit, vec![index])),
        }
    }
    let panels = units.into_iter().map(|(unit, members)| {
        let x_label = heading(&table.columns[over]);
        let curves = |index: &usize| curves_of(table, *index, over, outer);
        let mut layers: Vec<Layer> = members.iter().flat_map(curves).collect();
        let count = layers.len();
        for (index, layer) in layers.iter_mut().enumerate() {
            layer.colour = index;
            // Earlier curves are wider, so that they show behind later ones.
            layer.style = Style::Dotted(2 + (count - 1 - index).min(4) as u32);
        }
        let missing = without_value(table, &members, over, &layers);
        layers.extend(missing);
        Panel::new("", x_label, title_of(table, unit, &members), layers)
    });
    panels.collect()
}

/// Title of the axis of some results of one unit.
fn title_of(table: &SweepTable, unit: &str, members: &[usize]) -> String {
    let name = match members {
        [only] => table.columns[*only].name.as_str(),
        _ => "results",
    };
    match unit {
        "1" => format!("{name}, a ratio"),
        unit => format!("{name} [{unit}]"),
    }
}

/// Rings on the lower edge where results have no value: of runs that ended early, and of runs that
/// were completed and have none.
fn without_value(
    table: &SweepTable,
    members: &[usize],
    over: usize,
    curves: &[Layer],
) -> Vec<Layer> {
    let values = curves.iter().flat_map(|curve| &curve.points);
    let lowest = values.map(|point| point.1).filter(|y| y.is_finite());
    let lowest = lowest.reduce(f64::min).unwrap_or(0.0);
    let rows = || table.rows.iter().zip(&table.faults);
    let kinds = [
        (true, "no value: the run ended early", PINK),
        (false, "no value in a completed run", BLACK),
    ];
    let layer = |(is_early, label, colour)| {
        let missing = rows().filter(|(row, fault)| {
            fault.as_ref().is_some_and(Fault::ended_early) == is_early
                && members.iter().any(|i| row[*i].is_nan())
        });
        let points: Vec<(f64, f64)> = missing.map(|(row, _)| (row[over], lowest)).collect();
        (!points.is_empty()).then(|| Layer::circles(label, points, colour))
    };
    kinds.into_iter().filter_map(layer).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use truecut_recording::{Outcome, UserUnit};

    fn column(name: &str, unit: &str, is_axis: bool) -> Column {
        Column {
            name: name.to_owned(),
            unit: UserUnit::parse(unit).expect("a unit"),
            is_axis,
        }
    }

    #[test]
    fn axes_have_titles_and_missing_values_are_marked_and_explained() {
        let nan = f64::NAN;
        let early = Fault {
            outcome: Outcome::Chatter {
                time_s: 0.1,
                amplitude_m: 1e-3,
                rule: "a rule".to_owned(),
            },
            why: "it chattered".to_owned(),
        };
        let table = SweepTable {
            columns: vec![
                column("run.speed_rpm", "rpm", true),
                column("depth", "mm", false),
                column("width", "mm", false),
                column("share", "1", false),
            ],
            rows: vec![
                vec![100.0, 1.0, 2.0, 0.5],
                vec![200.0, nan, 3.0, 0.6],
                vec![300.0, nan, nan, nan],
            ],
            faults: vec![None, None, Some(early)],
        };
        let [lengths, shares] = &panels(&table)[..] else {
            panic!("two units");
        };
        assert_eq!(lengths.y_label, "results [mm]");
        assert_eq!(shares.y_label, "share, a ratio");
        assert!(lengths.x_label.contains("rpm"), "{}", lengths.x_label);
        let marks = |panel: &Panel, label: &str| {
            let found = panel
                .layers
                .iter()
                .find(|layer| layer.label.contains(label));
            found.map(|layer| layer.points.clone())
        };
        assert_eq!(marks(lengths, "ended early"), Some(vec![(300.0, 1.0)]));
        assert_eq!(marks(lengths, "completed run"), Some(vec![(200.0, 1.0)]));
        assert_eq!(marks(shares, "ended early"), Some(vec![(300.0, 0.5)]));
        assert_eq!(marks(shares, "completed run"), None);
        let whole = SweepTable {
            rows: table.rows[..1].to_vec(),
            faults: vec![None],
            ..table
        };
        assert!(
            panels(&whole)
                .iter()
                .all(|panel| marks(panel, "no value").is_none())
        );
    }
}
