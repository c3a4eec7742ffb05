//! The diagnosis as a page.

use maud::{Markup, PreEscaped, html};
use truecut_discrepancy::diagnose::{Diagnosis, SmallestSeen, UnknownCurve};
use truecut_discrepancy::model::Model;
use truecut_discrepancy::trial::Trial;
use truecut_recording::{UserUnit, significant};
use truecut_scenario::Scenario;

use super::Confirmed;
use super::text;
use crate::figure::{BLUE, Figure, GREEN, Layer, Legend, ORANGE, Panel, Style, largest, thinned};
use crate::page::{self, MOST_POINTS, Page, cells, table};
use crate::text::reading_unit;

/// The page.
pub fn html(scenario: &Scenario, trial: &Trial, confirmed: &Confirmed) -> String {
    let diagnosis = &confirmed.answer.diagnosis;
    let mut page = Page::new("diagnose", &diagnosis.scenario);
    page.text(html! {
        p { "Data: " (diagnosis.data) }
        p.verdict { b { (text::headline(diagnosis)) } br; (diagnosis.reason) }
        (causes(diagnosis))
        (unnamed(diagnosis.curve.as_ref()))
        (others(diagnosis))
        (gain(diagnosis))
    });
    let channels = worst_first(trial, diagnosis).into_iter();
    page.figures(
        "Measured, nominal, extended",
        channels.map(|index| figure(trial, confirmed, index)),
    );
    page.text(seen(diagnosis));
    page.text(notes(trial, confirmed));
    page.text(page::reproduce("truecut diagnose", scenario));
    page.html()
}

fn causes(diagnosis: &Diagnosis) -> Markup {
    let rows = diagnosis.causes.iter().map(|cause| {
        let name = html! {
            (text::name(cause)) br; small { (text::description(cause)) }
        };
        let sizes = html! {
            @for (index, (key, parameter)) in cause.parameters.iter().enumerate() {
                @if index > 0 { br; }
                (key) " = " (text::estimate(parameter))
            }
        };
        let evidence = format!(
            "odds {}; {} standard errors on validation data; {:.1} % less error",
            text::odds(cause.evidence.log10_odds),
            significant(cause.evidence.validation_t, 3),
            100.0 * cause.evidence.practical_gain
        );
        html! { td { (name) } td { (sizes) } td { (evidence) } }
    });
    let nominal = (diagnosis.nominal.iter()).map(|one| {
        let (before, after) = text::in_unit_of_key(one);
        let before = significant(before, 5);
        cells(&[&one.key, &before, &text::estimate(&after)])
    });
    let head = ["cause", "size (95 % interval)", "evidence"];
    html! {
        (table("Causes", &head, rows))
        (table("Nominal values refitted", &["key", "before", "after"], nominal))
    }
}

/// What has no name, drawn with its band.
pub(super) fn unnamed(curve: Option<&UnknownCurve>) -> Markup {
    let Some(found) = curve else {
        return html! {};
    };
    let along = match found.kind.as_str() {
        "joint_friction_by_speed" => "speed",
        _ => "position",
    };
    let places = || found.x.iter().copied();
    let bounds = || places().zip(found.low.iter().zip(&found.high));
    let bounded = || bounds().filter_map(|(x, (low, high))| Some((x, (*low)?, (*high)?)));
    let band = Style::Band(bounded().map(|(_, low, _)| low).collect());
    let upper = bounded().map(|(x, _, high)| (x, high));
    let layers = vec![
        Layer::new("95 % band", upper, band, ORANGE),
        Layer::line(&found.kind, places().zip(found.value.iter().copied()), BLUE),
    ];
    let figure = Figure {
        title: format!("{} of {}", found.kind, found.target),
        panels: vec![Panel::new(
            "",
            format!("{along} of {} [{}]", found.target, found.x_unit),
            format!("{} [{}]", text::curve_of(&found.kind), found.unit),
            layers,
        )],
        columns: 1,
        legend: Legend::Above,
    };
    html! {
        h2 { "Unknown, shown as a curve" }
        p { "Odds against the model without it: " (text::odds(found.log10_odds))
            ". The scenario that is written carries it as an [[effect]]." }
        (PreEscaped(figure.to_svg()))
    }
}

fn others(diagnosis: &Diagnosis) -> Markup {
    // The first alternative is the next best explanation, too.
    let next = (diagnosis.runner_up.iter()).filter(|_| diagnosis.alternatives.is_empty());
    let candidates = diagnosis.alternatives.iter().chain(next);
    let explanations = candidates.map(|one| {
        let angle = format!("{:.0}°", one.angle_deg);
        cells(&[&text::names_of(one), &angle, &text::odds_against(one)])
    });
    let experiments = (diagnosis.experiments.iter()).map(|one| {
        let [separation, now] = [one.separation, one.separation_now].map(|t| significant(t, 3));
        cells(&[&one.description, &separation, &now])
    });
    let head = ["explanation", "angle between signatures", "odds"];
    let planned = ["experiment", "separation", "separation now"];
    let nearest = (text::nearest_rows(diagnosis).into_iter()).map(|row| cells(&row));
    html! {
        (table("What comes nearest, and is not named", &["effect", "its size would be"], nearest))
        (table("Other explanations", &head, explanations))
        (table("What would tell them apart", &planned, experiments))
    }
}

fn gain(diagnosis: &Diagnosis) -> Markup {
    let rows = text::error_rows(diagnosis);
    let [head, rows @ ..] = &rows[..] else {
        return html! {};
    };
    html! {
        (table("Error on held-out data (root mean square)", head, rows.iter().map(|row| cells(row))))
        p { "Unexplained: " (text::unexplained(diagnosis)) "." }
        @for doubt in &diagnosis.doubts { p { "Doubtful: " (doubt) "." } }
    }
}

fn seen(diagnosis: &Diagnosis) -> Markup {
    let title = "The smallest effects that these data would have shown";
    smallest(title, &diagnosis.smallest_seen)
}

/// What would have been seen, under this title.
pub(super) fn smallest(title: &str, seen: &[SmallestSeen]) -> Markup {
    let rows = (seen.iter()).map(|one| {
        let size = match one.size {
            Some(size) => text::with_unit(&significant(size, 3), &one.unit),
            None => "none within reach".to_owned(),
        };
        let target = one.target.as_deref().unwrap_or_default();
        cells(&[&format!("{} {target}", one.kind), &one.parameter, &size])
    });
    let head = ["effect", "parameter", "smallest size"];
    table(title, &head, rows)
}

fn notes(trial: &Trial, confirmed: &Confirmed) -> Markup {
    let diagnosis = &confirmed.answer.diagnosis;
    let failed = diagnosis.fits.iter().filter(|fit| !fit.converged).count();
    html! {
        h2 { "Notes" }
        ul {
            @for note in &trial.measured().notes { li { (note) } }
            @for found in &diagnosis.ceiling.correlated_signals {
                li { (format!(
                    "What is left of {} follows {}: {:.0} % of it.",
                    found.channel, found.signal, 100.0 * found.fraction
                )) }
            }
            @if let Some(failure) = &confirmed.failure {
                li { "The full model could not be run with this answer; "
                     "the errors are the reduced model's: " (failure) }
            }
            li { (diagnosis.fits.len()) " fits, " (failed) " of them did not converge." }
            li {
                (diagnosis.work.predictions) " simulations in "
                (significant(diagnosis.work.seconds, 3)) " s."
            }
        }
    }
}

/// The channels in the order of how far the nominal model is beyond their noise.
fn worst_first(trial: &Trial, diagnosis: &Diagnosis) -> Vec<usize> {
    let beyond = |index: usize| {
        let errors = diagnosis.channels.get(&trial.channels()[index].name);
        errors.map_or(0.0, |one| {
            one.before / one.noise_floor.max(f64::MIN_POSITIVE)
        })
    };
    let mut order: Vec<usize> = (0..trial.channels().len()).collect();
    order.sort_by(|a, b| beyond(*b).total_cmp(&beyond(*a)));
    order
}

fn figure(trial: &Trial, confirmed: &Confirmed, index: usize) -> Figure {
    let spec = &trial.channels()[index];
    let output = &trial.observation.outputs[index];
    let time_s = &trial.observation.time_s;
    let size = largest(output.values.iter().copied());
    let unit = reading_unit(spec.unit, size);
    let (nominal, extended) = (&confirmed.nominal[index], &confirmed.extended[index]);
    let curve = |label: &str, colour, value: &dyn Fn(usize) -> f64, unit: &UserUnit| {
        // A gap stays open.
        let shown = |row| match output.valid[row] {
            true => unit.from_si(value(row)),
            false => f64::NAN,
        };
        let points = (0..time_s.len()).map(|row| (time_s[row], shown(row)));
        Layer::line(label, thinned(points, MOST_POINTS), colour)
    };
    let measured = |row: usize| output.values[row];
    let seen = (0..time_s.len()).filter(|row| output.valid[*row]);
    let worst = largest(seen.map(|row| measured(row) - nominal[row]));
    let small = reading_unit(spec.unit, worst);
    let panel = |title: &str, label: &str, unit: &UserUnit, layers| {
        let label = format!("{label} [{}]", unit.symbol);
        Panel::new(title, "time [s]", label, layers)
    };
    let signals = vec![
        curve("measured", BLUE, &measured, &unit),
        curve("nominal", ORANGE, &|row| nominal[row], &unit),
        curve("extended", GREEN, &|row| extended[row], &unit),
    ];
    let left = |model: &[f64], row: usize| measured(row) - model[row];
    let residuals = vec![
        curve("less nominal", ORANGE, &|row| left(nominal, row), &small),
        curve("less extended", GREEN, &|row| left(extended, row), &small),
    ];
    Figure {
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
    }
}
