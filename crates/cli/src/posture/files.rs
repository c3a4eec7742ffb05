//! Files that `truecut posture` writes.

use std::path::{Path, PathBuf};

use nalgebra::{Rotation3, UnitQuaternion};
use truecut::outputs::write_file;
use truecut_plan::section::tool_stiffness;
use truecut_plan::{Assessment, Criterion};
use truecut_telemetry::{Column, PlanShown, PlanStation, write_columns, write_plan};

use super::{PostureAnswer, figure, text};
use crate::failure::Failure;
use crate::figure::{Figure, charts_of};
use crate::page::{self, Page};
use crate::spread::{self, COLUMNS};

/// Writes the figure first, then the scenario with the plan, then the other files.
pub fn write(answer: &PostureAnswer<'_>, out: &Path) -> Result<Vec<PathBuf>, Failure> {
    let scenario = answer.scenario;
    let folder = out.join(scenario.stem());
    let at = |name: &str| folder.join(name);
    let svg = at("posture.svg");
    let planned = at(&format!("{}_planned.toml", scenario.stem()));
    let (stations, map, rrd) = (
        at("posture.parquet"),
        at("posture_map.parquet"),
        at("posture.rrd"),
    );
    let drawn = figure::figure(answer);
    write_file(&svg, drawn.to_svg().as_bytes())?;
    let html = at("posture.html");
    write_file(&html, page(answer).html().as_bytes())?;
    let text = scenario.planned_text(&folder, &answer.study.planned(&answer.plan));
    write_file(&planned, text.as_bytes())?;
    write_columns(&stations, &station_columns(answer), &text)?;
    write_columns(&map, &map_columns(answer), &text)?;
    show(answer, &rrd, &text, &drawn)?;
    let mut written = vec![svg, planned, html, stations, map, rrd];
    if let Some(uncertain) = &answer.uncertain {
        let report = at("posture_uncertain.json");
        write_file(&report, uncertain.json(answer)?.as_bytes())?;
        written.push(report);
    }
    Ok(written)
}

/// The plan as a page.
fn page(answer: &PostureAnswer<'_>) -> Page {
    let mut page = Page::new("posture", format!("{}: postures", answer.scenario.name));
    page.told(&text::summary(answer));
    page.figures("Along the path", [figure::figure(answer)]);
    page.text(page::reproduce("truecut posture", answer.scenario));
    page
}

fn show(answer: &PostureAnswer<'_>, rrd: &Path, text: &str, drawn: &Figure) -> Result<(), Failure> {
    let (scene, frames) = answer.study.view(&answer.plan);
    let title = format!("{}: postures", answer.scenario.name);
    let shown = PlanShown {
        title: &title,
        text: &text::summary(answer),
        scenario: text,
        scene: &scene,
        frames: &frames,
        stations: &stations(answer)?,
        lines: &[],
        text_title: "Plan",
        pages: &[charts_of(&beside_the_arm(answer, drawn))],
    };
    write_plan(rrd, &shown).map_err(|error| Failure::message(error.to_string()))
}

/// Charts of the viewer: the angle, limits over it, values along the path. Maps are in the figure
/// only.
fn beside_the_arm(answer: &PostureAnswer<'_>, drawn: &Figure) -> Figure {
    let maps = answer.maps.len();
    let angle = &drawn.panels[answer.chosen()];
    let panels = std::iter::once(angle).chain(&drawn.panels[maps..]);
    Figure {
        title: drawn.title.clone(),
        panels: panels.cloned().collect(),
        columns: drawn.columns,
        legend: drawn.legend,
    }
}

fn stations(answer: &PostureAnswer<'_>) -> Result<Vec<PlanStation>, Failure> {
    let study = answer.study;
    let frame = study.path.world_from_milling(0);
    let feed_m_per_s = study.cut.feed_m_per_s();
    let station = |point: &truecut_plan::PlanPoint| {
        let found = tool_stiffness(&study.robot, &point.posture, &frame);
        let found = found.map_err(|error| {
            Failure::sim(answer.scenario, truecut_sim::stability::in_scenario(error))
        })?;
        let axes = Rotation3::from_matrix_unchecked(found.ellipsoid.directions);
        let q = UnitQuaternion::from_rotation_matrix(&axes);
        Ok(PlanStation {
            time_s: point.along_m / feed_m_per_s,
            point_m: point.point_m.into(),
            reserve: point.assessment.reserve(),
            stiffness_n_per_m: found.ellipsoid.semi_axes_n_per_m.into(),
            world_from_axes_xyzw: [q.i, q.j, q.k, q.w],
        })
    };
    answer.plan.points.iter().map(station).collect()
}

fn station_columns(answer: &PostureAnswer<'_>) -> Vec<Column<'static>> {
    let points = &answer.plan.points;
    let of = |value: &dyn Fn(&truecut_plan::PlanPoint) -> f64| points.iter().map(value).collect();
    let mut columns = vec![
        Column::numbers("along", "mm", of(&|p| p.along_m * 1e3)),
        Column::numbers("x", "mm", of(&|p| p.point_m.x * 1e3)),
        Column::numbers("y", "mm", of(&|p| p.point_m.y * 1e3)),
        Column::numbers("z", "mm", of(&|p| p.point_m.z * 1e3)),
        Column::numbers("redundancy_angle", "deg", of(&|p| p.angle_rad.to_degrees())),
    ];
    let joints = ["joint1", "joint2", "joint3", "joint4", "joint5", "joint6"];
    for (j, name) in joints.into_iter().enumerate() {
        columns.push(Column::numbers(
            name,
            "deg",
            of(&|p| p.posture[j].to_degrees()),
        ));
    }
    for (criterion, found) in Criterion::ALL.iter().copied().zip(&answer.plan_assessed) {
        let (name, unit, scale) = value_column(criterion);
        let values = found.iter().map(|a| a.value * scale);
        columns.push(Column::numbers(name, unit, values.collect()));
    }
    let found = answer.regenerative(&answer.plan_assessed);
    let of = |value: fn(&Assessment) -> Option<f64>| {
        let values = found.iter().map(value);
        values.map(|value| value.unwrap_or(f64::NAN)).collect()
    };
    let error = |a: &Assessment| Some(a.error_m? * 1e3);
    let least = |a: &Assessment| Some(a.decay?.least_per_s);
    columns.extend([
        Column::numbers("regenerative_decay", "1/s", of(Assessment::decay_per_s)),
        Column::numbers("regenerative_limit_error", "mm", of(error)),
        Column::numbers("least_decay", "1/s", of(least)),
    ]);
    if let Some(uncertain) = &answer.uncertain {
        let places: Vec<f64> = points.iter().map(|p| p.along_m).collect();
        let (_, unit, scale) = value_column(answer.plan.criterion);
        let units = [unit, unit, unit, "1"];
        columns.extend(COLUMNS.into_iter().enumerate().map(|(k, name)| {
            let values = spread::column(k, &places, &uncertain.plan, scale);
            Column::numbers(name, units[k], values)
        }));
    }
    columns
}

fn map_columns(answer: &PostureAnswer<'_>) -> Vec<Column<'static>> {
    let first = &answer.maps[0];
    let angles = first.angles_rad.len();
    let along = first.along_m.iter();
    let along = along.flat_map(|at| std::iter::repeat_n(at * 1e3, angles));
    let each = first.along_m.iter().flat_map(|_| first.angles_rad.iter());
    let mut columns = vec![
        Column::numbers("along", "mm", along.collect()),
        Column::numbers(
            "redundancy_angle",
            "deg",
            each.map(|a| a.to_degrees()).collect(),
        ),
    ];
    for map in &answer.maps {
        let (name, unit, scale) = value_column(map.criterion);
        let value = |found: &Option<Assessment>| found.map_or(f64::NAN, |a| a.value * scale);
        let values = map.assessments.iter().flatten().map(value);
        columns.push(Column::numbers(name, unit, values.collect()));
        if map.criterion == Criterion::Regenerative {
            let decay = |found: &Option<Assessment>| found.and_then(|a| a.decay_per_s());
            let values = map.assessments.iter().flatten();
            let values = values.map(|found| decay(found).unwrap_or(f64::NAN));
            columns.push(Column::numbers(
                "regenerative_decay",
                "1/s",
                values.collect(),
            ));
        }
    }
    columns
}

/// Column of a criterion's value: name, unit, factor from SI.
fn value_column(criterion: Criterion) -> (&'static str, &'static str, f64) {
    match criterion {
        Criterion::Anisotropy => ("anisotropy", "1", 1.0),
        Criterion::Flutter => ("flutter_limit", "mm", 1e3),
        Criterion::ModeCoupling => ("mode_coupling_limit", "mm", 1e3),
        Criterion::Regenerative => ("regenerative_limit", "mm", 1e3),
    }
}
