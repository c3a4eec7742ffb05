//! Sweeps whose rows are drawn: how results spread, and where they lie over each axis.

use statrs::statistics::{Data, OrderStatistics, Statistics};
use truecut_recording::significant;
use truecut_sim::sweep::{Column, SweepTable};

use super::heading;
use crate::figure::{Figure, Layer, Legend, Panel};
use crate::text::{self, Align};

/// Most panels of a figure, and most side by side.
const MOST_PANELS: usize = 24;
const MOST_ABREAST: usize = 3;
/// Most points of all panels.
const MOST_POINTS: usize = 40_000;

/// Heads of the columns of [`spread`].
pub const HEAD: [&str; 8] = [
    "result",
    "rows with a value",
    "mean",
    "standard deviation",
    "5 %",
    "median",
    "95 %",
    "range",
];

/// For each result how it spreads over the rows that have a value.
pub fn spread(table: &SweepTable) -> Vec<[String; 8]> {
    results(table)
        .map(|(index, column)| {
            let values: Vec<f64> = (table.rows.iter().map(|row| row[index]))
                .filter(|value| !value.is_nan())
                .collect();
            let shown = |value: f64| match value.is_nan() {
                true => "none".to_owned(),
                false => significant(value, 4),
            };
            let [low, middle, high] = quantiles(&values, [0.05, 0.5, 0.95]);
            let deviation = match values.len() {
                0 | 1 => f64::NAN,
                _ => (&values).std_dev(),
            };
            [
                heading(column),
                format!("{} of {}", values.len(), table.rows.len()),
                shown((&values).mean()),
                shown(deviation),
                shown(low),
                shown(middle),
                shown(high),
                format!("{} to {}", shown((&values).min()), shown((&values).max())),
            ]
        })
        .collect()
}

/// Quantiles between the order statistics (median-unbiased, definition 8 of Hyndman and Fan 1996).
fn quantiles<const N: usize>(values: &[f64], shares: [f64; N]) -> [f64; N] {
    if values.is_empty() {
        return [f64::NAN; N];
    }
    let mut data = Data::new(values.to_vec());
    shares.map(|share| data.quantile(share))
}

/// The same as text.
pub fn printed(table: &SweepTable) -> String {
    let rows = spread(table).into_iter().map(|row| row.to_vec());
    let head = HEAD.map(str::to_owned).to_vec();
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    let mut aligns = vec![Align::Right; HEAD.len()];
    aligns[0] = Align::Left;
    text::table(&aligns, &rows)
}

/// Every result over every axis, a point for each row; of many rows some, evenly: a file of all
/// could not be opened.
pub fn figure(title: &str, table: &SweepTable) -> Figure {
    let axes = || {
        let columns = table.columns.iter().enumerate();
        columns.filter(|(_, column)| column.is_axis)
    };
    let count = (results(table).count() * axes().count()).clamp(1, MOST_PANELS);
    let every = table.rows.len().div_ceil(MOST_POINTS / count).max(1);
    let note = match every {
        1 => String::new(),
        every => format!("one of {every} rows is drawn"),
    };
    let panels = results(table).flat_map(|(index, column)| {
        let note = &note;
        axes().map(move |(over, axis)| {
            let points = table
                .rows
                .iter()
                .step_by(every)
                .map(|row| (row[over], row[index]));
            let points: Vec<(f64, f64)> = points.filter(|(_, y)| y.is_finite()).collect();
            let layer = Layer::circles("", points, over);
            Panel::new(note, heading(axis), heading(column), vec![layer])
        })
    });
    let mut panels: Vec<Panel> = panels.collect();
    panels.truncate(MOST_PANELS);
    Figure {
        title: title.to_owned(),
        panels,
        columns: axes().count().clamp(1, MOST_ABREAST),
        legend: Legend::Right,
    }
}

fn results(table: &SweepTable) -> impl Iterator<Item = (usize, &Column)> {
    let columns = table.columns.iter().enumerate();
    columns.filter(|(_, column)| !column.is_axis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use truecut_recording::UserUnit;

    /// Of 1 to 99: any definition that is unbiased gives the median 50, and 5 and 95 within a row.
    #[test]
    fn verify_spread_of_known_numbers() {
        let column = |name: &str, is_axis| Column {
            name: name.to_owned(),
            unit: UserUnit::parse("mm").unwrap(),
            is_axis,
        };
        let rows = (1..=99).map(|value| vec![0.5, f64::from(value)]);
        let mut table = SweepTable {
            columns: vec![column("run.x_mm", true), column("depth", false)],
            rows: rows.chain([vec![0.7, f64::NAN]]).collect(),
            faults: vec![None; 100],
        };
        let told = spread(&table);
        assert_eq!(told.len(), 1);
        assert_eq!(told[0][..4], ["depth [mm]", "99 of 100", "50.00", "28.72"]);
        assert_eq!(told[0][5], "50.00");
        let number = |place: usize| told[0][place].parse::<f64>().unwrap();
        assert!(
            (number(4) - 5.0).abs() < 0.5 && (number(6) - 95.0).abs() < 0.5,
            "{told:?}"
        );
        assert_eq!(told[0][7], "1.000 to 99.00");
        assert_eq!(figure("", &table).panels[0].layers[0].points.len(), 99);
        let rows = (0..100_000).map(|k| vec![f64::from(k), f64::from(k)]);
        table.rows = rows.collect();
        let panel = &figure("", &table).panels[0];
        assert_eq!(panel.title, "one of 3 rows is drawn");
        assert_eq!(panel.layers[0].points.len(), 33_334);
        table.rows = vec![vec![0.5, f64::NAN]];
        assert_eq!(
            spread(&table)[0][2..],
            ["none", "none", "none", "none", "none", "none to none"]
        );
    }
}
