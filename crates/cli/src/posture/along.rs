//! `truecut posture` of milling along a path: the turn about the tool's axis, and the arm's posture
//! at the start, with the largest margin.

use std::path::{Path, PathBuf};

use serde_json::json;
use truecut::outputs::write_file;
use truecut_plan::LEAST_DECAY;
use truecut_recording::{Unit, significant};
use truecut_scenario::Scenario;
use truecut_sim::stability::{
    PathPlace, PathPosture, PathPostures, PathRun, path_postures, posture_runs,
};

use crate::args::{CriterionName, PostureArguments};
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::figure::{BLACK, BLUE, Figure, Layer, Legend, ORANGE, Panel};
use crate::lobes::{margin, shade};
use crate::page::{self, Page};
use crate::progress::Progress;
use crate::text::{self, Align};

/// What was found and proved.
struct Answer<'a> {
    scenario: &'a Scenario,
    found: PathPostures,
    runs: Vec<PathRun>,
}

/// Looks at all turns, runs the best one, prints and writes.
pub fn posture(arguments: &PostureArguments, scenario: &Scenario) -> Result<ExitStatus, Failure> {
    let given = [
        (
            "--criterion",
            arguments.criterion != CriterionName::Regenerative,
        ),
        ("--least-decay", arguments.least_decay != LEAST_DECAY),
        ("--maps", arguments.maps),
    ];
    if let Some((name, _)) = given.iter().find(|(_, given)| *given) {
        let text = format!(
            "{name} is for [process.milling]: along a path postures are chosen by their margin against regeneration"
        );
        return Err(Failure::at(&arguments.scenario, text));
    }
    let found = Progress::of_one("postures along the path", |progress| {
        path_postures(scenario, progress)
    });
    let found = found.map_err(|error| Failure::sim(scenario, error))?;
    let count = arguments.runs.unwrap_or(2).into();
    let runs = Progress::of_one("runs", |_| posture_runs(scenario, &found, count))?;
    let answer = Answer {
        scenario,
        found,
        runs,
    };
    let written = answer.write(&arguments.out)?;
    let mut text = answer.printed();
    if let [first, rest @ ..] = &written[..] {
        text.push_str(&format!("\n{}", text::written(first, rest)));
    }
    crate::print(&format!("{text}\n"))
}

/// The least of the margins of places.
fn least(places: &[PathPlace]) -> Option<&PathPlace> {
    places
        .iter()
        .min_by(|a, b| a.margin().total_cmp(&b.margin()))
}

impl Answer<'_> {
    fn best(&self) -> &PathPosture {
        &self.found.turns[self.found.best]
    }

    fn printed(&self) -> String {
        let found = &self.found;
        let mut text = format!("{}\n", self.scenario.name);
        let rows = [
            ("best posture", &found.best_places, Some(self.best())),
            ("scenario's own", &found.own_places, found.own.as_ref()),
        ];
        let rows = rows.iter().filter_map(|(name, places, posture)| {
            let (least, posture) = (least(places)?, (*posture)?);
            Some(vec![
                (*name).to_owned(),
                posture.spin_rad.map_or("as it is".to_owned(), degrees),
                margin(least),
                text::show(Unit::Metre, least.along_m),
                least.line.map_or(String::new(), |line| line.to_string()),
                text::show(Unit::Metre, posture.bend_m[0]),
                text::show(Unit::Metre, posture.bend_m[1]),
                text::seconds(posture.duration_s),
            ])
        });
        let head = [
            "",
            "turn",
            "least margin",
            "at",
            "line",
            "bends by cut",
            "by motion",
            "takes",
        ];
        use Align::{Left, Right};
        let aligns = [Left, Right, Right, Right, Right, Right, Right, Right];
        text.push_str(&text::table(&aligns, &text::headed(&head, rows)));
        text.push_str(&format!(
            "  {} of {} turns can be followed; margin: limit depth over depth, looked for up to 3; below 1 vibration grows\n",
            found.turns.len(),
            found.turns.len() + found.refused.len()
        ));
        text.push_str(&text::notes(self.notes()));
        if !found.is_own {
            text.push_str("\nTo take the best posture:\n");
            for (key, value) in &found.keys {
                text.push_str(&format!("  --set '{key}={value}'\n"));
            }
        }
        if !self.runs.is_empty() {
            text.push_str(&format!("\n{}", self.told()));
        }
        text
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = self.found.notes.clone();
        if let Some((spin_rad, fault)) = self.found.refused.first() {
            notes.push(format!(
                "turns that cannot be followed: {}; the first, at {}: {fault}",
                self.found.refused.len(),
                degrees(*spin_rad)
            ));
        }
        notes
    }

    fn told(&self) -> String {
        let head = ["run", "ended", "vibration from tooth to tooth", "at"];
        let names = ["in the best posture", "as the scenario has it"];
        let rows = self.runs.iter().zip(names).map(|(run, name)| {
            vec![
                name.to_owned(),
                text::outcome(&run.outcome),
                text::show(Unit::Metre, run.vibration_m),
                text::show(Unit::Metre, run.at_m),
            ]
        });
        use Align::{Left, Right};
        text::table(&[Left, Left, Right, Right], &text::headed(&head, rows))
    }

    fn write(&self, out: &Path) -> Result<Vec<PathBuf>, Failure> {
        let folder = out.join(self.scenario.stem());
        let at = |name: &str| folder.join(name);
        let (svg, html, report) = (at("posture.svg"), at("posture.html"), at("posture.json"));
        write_file(&svg, self.figure().to_svg().as_bytes())?;
        let mut page = Page::new("posture", self.title());
        page.told(&self.printed());
        page.figures("Postures", [self.figure()]);
        page.text(page::reproduce("truecut posture", self.scenario));
        write_file(&html, page.html().as_bytes())?;
        write_file(&report, self.json()?.as_bytes())?;
        Ok(vec![svg, html, report])
    }

    fn title(&self) -> String {
        format!("{}: postures along the path", self.scenario.name)
    }

    fn figure(&self) -> Figure {
        let found = &self.found;
        let deg = |turn: &PathPosture| turn.spin_rad.unwrap_or(0.0).to_degrees();
        let turns = || found.turns.iter();
        let of_turn = turns().map(|turn| (deg(turn), turn.least().1));
        let ends = |from: f64, to: f64| [(from, 1.0), (to, 1.0)];
        let mut over_turns = vec![
            Layer::circles("least margin", of_turn, BLUE),
            Layer::dashed("limit", ends(0.0, 360.0), BLACK),
        ];
        if let Some(own) = &found.own {
            let least = own.least().1;
            let line = [(0.0, least), (360.0, least)];
            over_turns.push(Layer::line("scenario's own", line, ORANGE));
        }
        let along: Vec<f64> = found
            .compared
            .iter()
            .map(|place| place.along_m * 1e3)
            .collect();
        let cells = turns().flat_map(|turn| {
            let each = along.iter().zip(&turn.margins);
            each.map(move |(along_mm, margin)| ((*along_mm, deg(turn)), shade(*margin)))
        });
        let wide = (along.last().unwrap_or(&1.0) - along.first().unwrap_or(&0.0))
            / (along.len().max(2) - 1) as f64;
        let tall = 360.0 / (found.turns.len() + found.refused.len()).max(1) as f64;
        let of = |place: &PathPlace| (place.along_m * 1e3, place.margin());
        let last = found
            .best_places
            .last()
            .map_or(1.0, |place| place.along_m * 1e3);
        let mut by_place = vec![
            Layer::line("best posture", found.best_places.iter().map(of), BLUE),
            Layer::dashed("limit", ends(0.0, last), BLACK),
        ];
        if !found.own_places.is_empty() {
            let own = found.own_places.iter().map(of);
            by_place.push(Layer::line("scenario's own", own, ORANGE));
        }
        let panel = |title: &str, x: &str, y: &str, layers| Panel::new(title, x, y, layers);
        Figure {
            title: self.title(),
            panels: vec![
                panel(
                    "Least margin of each turn, in the best posture for it",
                    "turn about the tool's axis [deg]",
                    "least margin",
                    over_turns,
                ),
                panel(
                    "Margin by place and turn (orange: below 1, chatters; blue: above)",
                    "way along the path [mm]",
                    "turn [deg]",
                    vec![Layer::cells((wide.max(1e-3), tall), cells)],
                ),
                panel(
                    "Margin: limit depth over depth (looked for up to 3)",
                    "way along the path [mm]",
                    "margin",
                    by_place,
                ),
            ],
            columns: 1,
            legend: Legend::Right,
        }
    }

    /// The file. All numbers are SI; one that does not exist is `null`.
    fn json(&self) -> Result<String, Failure> {
        let found = &self.found;
        let posture = |one: &PathPosture| {
            json!({
                "spin_rad": one.spin_rad,
                "start": one.start,
                "duration_s": one.duration_s,
                "margins": one.margins,
                "bend_by_cut_m": one.bend_m[0],
                "bend_by_motion_m": one.bend_m[1],
            })
        };
        let places = |places: &[PathPlace]| -> Vec<serde_json::Value> {
            let each = places.iter().map(|place| {
                json!({
                    "along_m": place.along_m,
                    "place_m": place.place_m,
                    "line": place.line,
                    "depth_m": place.depth_m,
                    "limit_m": place.limit_m,
                    // At most 3, down to where limits are looked for.
                    "margin": place.margin(),
                })
            });
            each.collect()
        };
        let runs = self.runs.iter().map(|run| {
            json!({
                "outcome": run.outcome,
                "vibration_m": run.vibration_m.is_finite().then_some(run.vibration_m),
                "at_m": run.at_m.is_finite().then_some(run.at_m),
            })
        });
        let keys = found
            .keys
            .iter()
            .map(|(key, value)| (key.clone(), json!(value)));
        text::json(&json!({
            "scenario": self.scenario.name,
            "compared_along_m": found.compared.iter().map(|place| place.along_m).collect::<Vec<_>>(),
            "own": found.own.as_ref().map(posture),
            "turns": found.turns.iter().map(posture).collect::<Vec<_>>(),
            "refused": found.refused.iter().map(|(spin_rad, why)| json!({"spin_rad": spin_rad, "why": why})).collect::<Vec<_>>(),
            "best": found.best,
            "own_is_as_good": found.is_own,
            "keys": keys.collect::<serde_json::Map<_, _>>(),
            "best_places": places(&found.best_places),
            "own_places": places(&found.own_places),
            "runs": runs.collect::<Vec<_>>(),
            "notes": self.notes(),
        }))
    }
}

fn degrees(rad: f64) -> String {
    format!("{} deg", significant(rad.to_degrees(), 4))
}
