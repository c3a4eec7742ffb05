//! `truecut lobes` of milling along a path: margins by place, and speeds that are better.

use std::path::{Path, PathBuf};

use serde_json::json;
use truecut::outputs::write_file;
use truecut_recording::{Unit, significant};
use truecut_scenario::Scenario;
use truecut_sim::stability::{PathPlace, PathRun, PathStability, path_runs, path_stability};

use super::rpm;
use crate::args::LobesArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::figure::{BLACK, BLUE, Figure, Layer, Legend, Panel};
use crate::page::{self, Page};
use crate::progress::Progress;
use crate::text::{self, Align};

/// Margin at which a place is as blue as can be.
const BLUEST: f64 = 3.0;
/// Least shade of a place, so that it shows.
const PALEST: f64 = 0.15;

/// Computes, runs, prints and writes.
pub fn lobes(arguments: &LobesArguments, scenario: &Scenario) -> Result<ExitStatus, Failure> {
    let given = [
        ("--at", arguments.at.is_some()),
        ("--deepest", arguments.deepest.is_some()),
    ];
    if let Some((name, _)) = given.iter().find(|(_, given)| *given) {
        let text = format!(
            "{name} is for [process.milling]: milling along a path is looked at all along it, at its own depths"
        );
        return Err(Failure::at(&arguments.scenario, text));
    }
    let range = (arguments.rpm).map(|range| range.map(|rpm| rpm * std::f64::consts::TAU / 60.0));
    let found = Progress::of_one("limits along the path", |progress| {
        path_stability(scenario, range, arguments.size.into(), progress)
    });
    let found = found.map_err(|error| Failure::sim(scenario, error))?;
    let runs = Progress::of_one("runs", |progress| {
        path_runs(scenario, &found, arguments.runs.into(), progress)
    })?;
    let written = write(scenario, &found, &runs, &arguments.out)?;
    let mut text = printed(scenario, &found, &runs);
    if let [first, rest @ ..] = &written[..] {
        text.push_str(&format!("\n{}", text::written(first, rest)));
    }
    crate::print(&format!("{text}\n"))
}

fn printed(scenario: &Scenario, found: &PathStability, runs: &[PathRun]) -> String {
    let mut text = format!("{}\n", scenario.name);
    let worst = (found.places.iter()).min_by(|a, b| a.margin().total_cmp(&b.margin()));
    text.push_str(&match worst {
        Some(worst) => format!(
            "  least margin {}: limit depth {} where the edge stands in {}, {} along the path{}\n",
            margin(worst),
            limit(worst),
            text::show(Unit::Metre, worst.depth_m),
            text::show(Unit::Metre, worst.along_m),
            worst
                .line
                .map_or(String::new(), |line| format!(", line {line}")),
        ),
        None => "  the cutter is nowhere in stock on a level way\n".to_owned(),
    });
    text.push_str(&text::notes(&found.notes));
    text.push_str(&format!("\n{}", segments(found)));
    if !runs.is_empty() {
        text.push_str(&format!("\n{}", told(runs)));
    }
    text
}

/// A margin as it is written; one where no limit was found is above what was looked at.
pub fn margin(place: &PathPlace) -> String {
    match place.limit_m {
        Some(_) => significant(place.margin(), 3),
        None => format!("above {}", significant(place.margin(), 3)),
    }
}

fn limit(place: &PathPlace) -> String {
    place.limit_m.map_or_else(
        || "none".to_owned(),
        |limit_m| text::show(Unit::Metre, limit_m),
    )
}

fn segments(found: &PathStability) -> String {
    let head = [
        "line",
        "from",
        "to",
        "depth",
        "engaged",
        "limit",
        "margin",
        "better",
        "margin there",
    ];
    let rows = found.segments.iter().map(|segment| {
        let worst = &found.places[segment.worst];
        let arc = &worst.engagement;
        let [better, its] = match segment.proposed {
            Some((rad_s, margin)) => [
                format!("{} rpm", significant(rpm(rad_s), 5)),
                significant(margin, 3),
            ],
            None => [String::new(), String::new()],
        };
        vec![
            segment.line.map_or(String::new(), |line| line.to_string()),
            text::show(Unit::Metre, segment.from_m),
            text::show(Unit::Metre, segment.to_m),
            text::show(Unit::Metre, worst.depth_m),
            format!(
                "{:.0} to {:.0} deg",
                arc.entry_rad.to_degrees(),
                arc.exit_rad.to_degrees()
            ),
            limit(worst),
            margin(worst),
            better,
            its,
        ]
    });
    text::table(&[Align::Right; 9], &text::headed(&head, rows))
}

fn told(runs: &[PathRun]) -> String {
    let head = ["run at", "ended", "vibration from tooth to tooth", "at"];
    let rows = runs.iter().map(|run| {
        vec![
            run.spindle_rad_s.map_or_else(
                || "its own speeds".to_owned(),
                |rad_s| format!("{} rpm", significant(rpm(rad_s), 5)),
            ),
            text::outcome(&run.outcome),
            text::show(Unit::Metre, run.vibration_m),
            text::show(Unit::Metre, run.at_m),
        ]
    });
    use Align::{Left, Right};
    text::table(&[Right, Left, Right, Right], &text::headed(&head, rows))
}

fn write(
    scenario: &Scenario,
    found: &PathStability,
    runs: &[PathRun],
    out: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    let folder = out.join(scenario.stem());
    let at = |name: &str| folder.join(name);
    let (svg, html, report) = (at("lobes.svg"), at("lobes.html"), at("lobes.json"));
    let title = format!("{}: stability along the path", scenario.name);
    write_file(&svg, figure(&title, found).to_svg().as_bytes())?;
    let mut page = Page::new("lobes", title.clone());
    page.told(&printed(scenario, found, runs));
    page.figures("Stability", [figure(&title, found)]);
    page.text(page::reproduce("truecut lobes", scenario));
    write_file(&html, page.html().as_bytes())?;
    write_file(&report, json(scenario, found, runs)?.as_bytes())?;
    Ok(vec![svg, html, report])
}

fn figure(title: &str, found: &PathStability) -> Figure {
    let mm = |place: &PathPlace| (place.place_m[0] * 1e3, place.place_m[1] * 1e3);
    let extent = |axis: usize| {
        let each = || found.places.iter().map(|place| place.place_m[axis] * 1e3);
        each().fold(f64::NEG_INFINITY, f64::max) - each().fold(f64::INFINITY, f64::min)
    };
    let wide = (0.02 * extent(0).max(extent(1))).max(0.1);
    // The least margin of a place is drawn last.
    let mut places: Vec<&PathPlace> = found.places.iter().collect();
    places.sort_by(|a, b| b.margin().total_cmp(&a.margin()));
    let shaded = places
        .into_iter()
        .map(|place| (mm(place), shade(place.margin())));
    let along = |place: &PathPlace| (place.along_m * 1e3, place.margin());
    let ends = [found.places.first(), found.places.last()]
        .into_iter()
        .flatten();
    let one: Vec<(f64, f64)> = ends.map(|place| (place.along_m * 1e3, 1.0)).collect();
    Figure {
        title: title.to_owned(),
        panels: vec![
            Panel::new(
                "Path by margin (orange: below 1, chatters; blue: above)",
                "x [mm]",
                "y [mm]",
                vec![Layer::cells((wide, wide), shaded)],
            ),
            Panel::new(
                "Margin: limit depth over depth (looked for up to 3)",
                "way along the path [mm]",
                "margin",
                vec![
                    Layer::line("margin", found.places.iter().map(along), BLUE),
                    Layer::dashed("limit", one, BLACK),
                ],
            ),
        ],
        columns: 1,
        legend: Legend::Right,
    }
}

/// The shade of a margin: orange below 1, blue above, never so pale that it does not show.
pub fn shade(margin: f64) -> f64 {
    let shade = (margin.ln() / BLUEST.ln()).clamp(-1.0, 1.0);
    shade.signum() * shade.abs().max(PALEST)
}

/// The file. All numbers are SI; one that does not exist is `null`.
fn json(scenario: &Scenario, found: &PathStability, runs: &[PathRun]) -> Result<String, Failure> {
    let places = found.places.iter().map(|place| {
        json!({
            "along_m": place.along_m,
            "place_m": place.place_m,
            "line": place.line,
            "entry_rad": place.engagement.entry_rad,
            "exit_rad": place.engagement.exit_rad,
            "depth_m": place.depth_m,
            "spindle_rad_s": place.spindle_rad_s,
            "limit_m": place.limit_m,
            // At most 3, down to where limits are looked for.
            "margin": place.margin(),
        })
    });
    let segments = found.segments.iter().map(|segment| {
        json!({
            "line": segment.line,
            "from_m": segment.from_m,
            "to_m": segment.to_m,
            "worst_place": segment.worst,
            "margin": found.places[segment.worst].margin(),
            "proposed_rad_s": segment.proposed.map(|(rad_s, _)| rad_s),
            "proposed_margin": segment.proposed.map(|(_, margin)| margin),
        })
    });
    let runs = runs.iter().map(|run| {
        json!({
            "spindle_rad_s": run.spindle_rad_s,
            "outcome": run.outcome,
            "vibration_m": run.vibration_m.is_finite().then_some(run.vibration_m),
            "at_m": run.at_m.is_finite().then_some(run.at_m),
        })
    });
    text::json(&json!({
        "scenario": scenario.name,
        "places": places.collect::<Vec<_>>(),
        "segments": segments.collect::<Vec<_>>(),
        "runs": runs.collect::<Vec<_>>(),
        "notes": found.notes,
    }))
}
