//! A run as a page: claims, results, assumptions, and its channels as curves.

use maud::{Markup, html};
use truecut::Shown;
use truecut_recording::{ChannelSpec, Outcome, Profile, Unit, UserUnit};
use truecut_scenario::Scenario;
use truecut_sim::run::Finished;
use truecut_telemetry::{FileError, StoredRows};

use super::maps;
use crate::figure::{Figure, Layer, Legend, Panel, largest, thinned};
use crate::page::{self, MOST_POINTS, Page};
use crate::text;

/// The page; the channels are read one by one from what is on the disk.
pub fn html(
    scenario: &Scenario,
    finished: &Finished,
    rows: &StoredRows,
    shown: &Shown,
) -> Result<String, FileError> {
    let Finished {
        recording, claims, ..
    } = finished;
    let mut page = Page::new("run", &scenario.name);
    let held = claims.iter().filter(|claim| claim.holds).count();
    let good = recording.outcome == Outcome::Completed && held == claims.len();
    let simulated_s = recording.time_s.last().copied().unwrap_or(0.0);
    let detail = format!(
        "{}; {} simulated, step {}, {} rows",
        match claims.len() {
            0 => "no claims".to_owned(),
            count => format!("{held} of {count} claims hold"),
        },
        text::seconds(simulated_s),
        text::show(Unit::Second, finished.time_step_s),
        recording.time_s.len()
    );
    page.verdict(good, &text::outcome(&recording.outcome), &detail);
    page.text(page::claims("Claims", claims));
    page.text(page::notes(&recording.header.notes));
    page.text(page::scalars(&recording.scalars));
    maps::add(&mut page, shown, finished.part.as_ref());
    let looks = (0..rows.header().channels.len()).map(|channel| Look::at(rows, channel));
    let looks = looks.collect::<Result<Vec<_>, _>>()?;
    page.figures("Channels", channels(&recording.time_s, rows, &looks)?);
    page.text(still(&rows.header().channels, &looks));
    page.figures("Profiles", profiles(&recording.profiles));
    page.text(page::reproduce("truecut run", scenario));
    Ok(page.html())
}

/// What is asked of a channel before it is drawn.
struct Look {
    first: Option<f64>,
    /// Whether it has more than one value.
    moves: bool,
    largest: f64,
}

impl Look {
    fn at(rows: &StoredRows, channel: usize) -> Result<Look, FileError> {
        let column = rows.column(channel)?;
        Ok(Look {
            first: column.first().copied(),
            moves: column.windows(2).any(|pair| pair[0] != pair[1]),
            largest: largest(column.into_iter()),
        })
    }
}

/// What channels of one kind have in common: their names without the numbers of joints and the
/// letters of axes.
fn kind(name: &str) -> String {
    let axis = |name: &str| ["_x", "_y", "_z"].iter().any(|end| name.ends_with(end));
    let end = if axis(name) {
        name.len() - 2
    } else {
        name.len()
    };
    name[..end]
        .chars()
        .filter(|letter| !letter.is_ascii_digit())
        .collect()
}

/// Panels of channels that belong together, a figure for each part of the cell.
fn channels(time_s: &[f64], rows: &StoredRows, looks: &[Look]) -> Result<Vec<Figure>, FileError> {
    let mut kinds: Vec<(String, Unit, Vec<usize>)> = Vec::new();
    for (index, spec) in rows.header().channels.iter().enumerate() {
        if !looks[index].moves {
            continue;
        }
        let kind = kind(&spec.name);
        let known = kinds
            .iter_mut()
            .find(|one| one.0 == kind && one.1 == spec.unit);
        match known {
            Some((_, _, members)) => members.push(index),
            None => kinds.push((kind, spec.unit, vec![index])),
        }
    }
    let mut figures: Vec<Figure> = Vec::new();
    for (kind, unit, members) in &kinds {
        let part = kind.split('.').next().unwrap_or(kind);
        let sizes = members.iter().map(|index| looks[*index].largest);
        let unit = text::reading_unit(*unit, sizes.fold(0.0, f64::max));
        let panel = panel(time_s, rows, &unit, members)?;
        match figures.iter_mut().find(|figure| figure.title == part) {
            Some(figure) => figure.panels.push(panel),
            None => figures.push(Figure {
                title: part.to_owned(),
                panels: vec![panel],
                columns: 1,
                legend: Legend::Above,
            }),
        }
    }
    Ok(figures)
}

fn panel(
    time_s: &[f64],
    rows: &StoredRows,
    unit: &UserUnit,
    members: &[usize],
) -> Result<Panel, FileError> {
    let all = &rows.header().channels;
    let specs: Vec<&ChannelSpec> = members.iter().map(|index| &all[*index]).collect();
    let title = match &specs[..] {
        [only] => only.description.clone(),
        [first, ..] => format!("{} (and the like)", first.description),
        [] => String::new(),
    };
    let layer = |(colour, index): (usize, &usize)| {
        let column = rows.column(*index)?;
        let values = column.iter().map(|value| unit.from_si(*value));
        let points = time_s.iter().copied().zip(values);
        let name = &all[*index].name;
        Ok(Layer::line(name, thinned(points, MOST_POINTS), colour))
    };
    let layers = members.iter().enumerate().map(layer);
    let layers = layers.collect::<Result<Vec<_>, FileError>>()?;
    Ok(Panel::new(title, "time [s]", in_brackets(unit), layers))
}

/// `[mm]`; nothing without a unit.
fn in_brackets(unit: &UserUnit) -> String {
    match &unit.symbol[..] {
        "1" => String::new(),
        symbol => format!("[{symbol}]"),
    }
}

/// Channels that have one value all along.
fn still(channels: &[ChannelSpec], looks: &[Look]) -> Markup {
    let channels = channels.iter().zip(looks);
    let rows = channels
        .filter(|(_, look)| !look.moves)
        .filter_map(|(spec, look)| {
            let value = text::show(spec.unit, look.first?);
            Some(html! { td { (spec.name) } td.n { (value) } td { (spec.description) } })
        });
    page::table(
        "Channels that never change",
        &["channel", "value", "what it is"],
        rows,
    )
}

fn profiles(profiles: &[Profile]) -> Vec<Figure> {
    let figure = |profile: &Profile| {
        let sizes = |values: &[f64]| largest(values.iter().copied());
        let x_unit = text::reading_unit(profile.axis_unit, sizes(&profile.axis));
        let unit = text::reading_unit(profile.unit, sizes(&profile.values));
        let points = profile.axis.iter().zip(&profile.values);
        let points = points.map(|(x, value)| (x_unit.from_si(*x), unit.from_si(*value)));
        let x_label = format!("{} {}", profile.axis_name, in_brackets(&x_unit));
        let layers = vec![Layer::line(&profile.name, points, 0)];
        Figure {
            title: profile.name.clone(),
            panels: vec![Panel::new(
                &profile.description,
                x_label,
                in_brackets(&unit),
                layers,
            )],
            columns: 1,
            legend: Legend::Above,
        }
    };
    profiles
        .iter()
        .filter(|one| !one.axis.is_empty())
        .map(figure)
        .collect()
}
