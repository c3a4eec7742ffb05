//! What changed, as a page.

use maud::{Markup, html};
use truecut_discrepancy::between::{Answer, Between, Changes};
use truecut_discrepancy::model::Model;
use truecut_recording::{UserUnit, significant};
use truecut_scenario::Scenario;
use truecut_scenario::effect::EffectKind;

use super::text;
use crate::diagnose::report::{smallest, unnamed};
use crate::diagnose::text::{estimate, name, odds};
use crate::figure::{BLUE, Figure, GREEN, Layer, Legend, ORANGE, Panel, largest, thinned};
use crate::page::{self, MOST_POINTS, Page, cells, table};
use crate::text::reading_unit;

/// The page.
pub fn html(scenario: &Scenario, pair: &Between, answer: &Answer) -> String {
    let found = &answer.changes;
    let title = format!("{}: what changed", found.scenario);
    let mut page = Page::new("diagnose", title);
    page.text(html! {
        p { "First recording: " (found.first) br; "Second: " (found.second) br; (text::compared(found)) }
        p.verdict { b { (text::headline(found)) } br; (found.reason) }
        (changes(found))
        (unnamed(found.curve.as_ref()))
        (others(found))
        (shared(found))
        (errors(found))
    });
    let heading = match pair.repeats() {
        true => "The recordings and their difference",
        false => "The recordings and what is left",
    };
    let channels = 0..pair.second.channels().len();
    page.figures(heading, channels.map(|index| figure(pair, answer, index)));
    page.text(smallest(
        "The smallest changes that these recordings would have shown",
        &found.smallest_seen,
    ));
    page.text(notes(pair, found));
    let call = format!(
        "truecut diagnose --between {} {}",
        found.first, found.second
    );
    page.text(page::reproduce(&call, scenario));
    page.html()
}

fn changes(found: &Changes) -> Markup {
    let rows = found.changes.iter().map(|changed| {
        let what = EffectKind::from_name(&changed.kind).map_or("", EffectKind::description);
        let column = |which: usize| {
            html! {
                @for (index, (key, parameter)) in changed.parameters.iter().enumerate() {
                    @if index > 0 { br; }
                    @if which == 0 { (key) " = " }
                    (text::estimates(parameter)[which])
                }
            }
        };
        html! {
            td { (text::name_of(changed)) br; small { (what) } }
            td { (column(0)) } td { (column(1)) } td { (column(2)) }
            td { (odds(changed.evidence.log10_odds)) }
        }
    });
    let head = [
        "what",
        "before",
        "after",
        "change (95 % interval)",
        "odds that there is one",
    ];
    table("Changes", &head, rows)
}

fn others(found: &Changes) -> Markup {
    let next = (found.runner_up.iter()).filter(|_| found.alternatives.is_empty());
    let rows = found.alternatives.iter().chain(next).map(|one| {
        let log10 = 0.5 * one.criterion_difference / std::f64::consts::LN_10;
        let against = format!("odds {} against it", odds(log10));
        let angle = format!("{:.0}°", one.angle_deg);
        cells(&[text::names_of(&one.changes), angle, against])
    });
    let head = ["explanation", "angle between signatures", "odds"];
    table("Other explanations", &head, rows)
}

fn shared(found: &Changes) -> Markup {
    let rows = found.shared.iter().map(|cause| {
        let sizes: Vec<String> = (cause.parameters.iter())
            .map(|(key, parameter)| format!("{key} = {}", estimate(parameter)))
            .collect();
        cells(&[name(cause), sizes.join("; ")])
    });
    let title = "What the first recording shows that the scenario lacks: no change";
    table(title, &["effect", "size (95 % interval)"], rows)
}

fn errors(found: &Changes) -> Markup {
    let rows = text::error_rows(found);
    let [head, rows @ ..] = &rows[..] else {
        return html! {};
    };
    let title = match found.compared.repeated {
        true => "Error of the difference on held-out data (root mean square)",
        false => "Error of both on held-out data (root mean square)",
    };
    html! {
        (table(title, head, rows.iter().map(|row| cells(row))))
        @for doubt in &found.doubts { p { "Doubtful: " (doubt) "." } }
    }
}

fn notes(pair: &Between, found: &Changes) -> Markup {
    html! {
        h2 { "Notes" }
        ul {
            @for note in text::notes(pair) { li { (note) } }
            @for signal in &found.ceiling.correlated_signals {
                li { (format!(
                    "What is left of {} follows {}: {:.0} % of it.",
                    signal.channel, signal.signal, 100.0 * signal.fraction
                )) }
            }
            li {
                (found.work.predictions) " simulations in "
                (significant(found.work.seconds, 3)) " s."
            }
        }
    }
}

/// Both recordings of a channel, and what is explained: the difference where the motion repeats,
/// else what is left of both.
fn figure(pair: &Between, answer: &Answer, index: usize) -> Figure {
    let spec = &pair.second.channels()[index];
    let both = [&pair.first, &pair.second].map(|trial| &trial.observation);
    let signals = both.map(|one| &one.outputs[index].values);
    let size = largest(signals.iter().flat_map(|values| values.iter().copied()));
    let unit = reading_unit(spec.unit, size);
    let curve =
        |label: &str, colour, time_s: &[f64], values: &[f64], valid: &[bool], unit: &UserUnit| {
            let rows = time_s.iter().zip(values.iter().zip(valid));
            // A gap stays open.
            let points = rows.map(|(t, (value, valid))| match valid {
                true => (*t, unit.from_si(*value)),
                false => (*t, f64::NAN),
            });
            Layer::line(
                label,
                thinned(points.collect::<Vec<_>>().into_iter(), MOST_POINTS),
                colour,
            )
        };
    let recorded = |label: &str, colour, which: usize| {
        let (one, output) = (both[which], &both[which].outputs[index]);
        curve(
            label,
            colour,
            &one.time_s,
            &output.values,
            &output.valid,
            &unit,
        )
    };
    let explained = &pair.observation.outputs[index];
    let (unchanged, changed) = (&answer.unchanged[index], &answer.changed[index]);
    let left = |predicted: &[f64]| -> Vec<f64> {
        explained
            .values
            .iter()
            .zip(predicted)
            .map(|(y, p)| y - p)
            .collect()
    };
    let (title, label, rows) = match pair.repeats() {
        true => (
            "Difference: second less first",
            "difference",
            [
                ("measured", BLUE, explained.values.clone()),
                ("without change", ORANGE, unchanged.clone()),
                ("with the changes", GREEN, changed.clone()),
            ]
            .to_vec(),
        ),
        false => (
            "Residuals: measured − simulated, the first recording and then the second",
            "residual",
            [
                ("without change", ORANGE, left(unchanged)),
                ("with the changes", GREEN, left(changed)),
            ]
            .to_vec(),
        ),
    };
    let largest = largest(
        rows.iter()
            .flat_map(|(_, _, values)| values.iter().copied()),
    );
    let small = reading_unit(spec.unit, largest);
    let time_s = &pair.observation.time_s;
    let layers: Vec<Layer> = (rows.iter())
        .map(|(name, colour, values)| {
            curve(name, *colour, time_s, values, &explained.valid, &small)
        })
        .collect();
    let panel = |title: &str, label: &str, unit: &UserUnit, layers| {
        Panel::new(
            title,
            "time [s]",
            format!("{label} [{}]", unit.symbol),
            layers,
        )
    };
    Figure {
        title: spec.description.clone(),
        panels: vec![
            panel(
                "Signals",
                &spec.name,
                &unit,
                vec![recorded("first", ORANGE, 0), recorded("second", BLUE, 1)],
            ),
            panel(title, label, &small, layers),
        ],
        columns: 1,
        legend: Legend::Above,
    }
}
