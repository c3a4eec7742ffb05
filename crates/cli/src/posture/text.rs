//! The plan as text.

use std::path::PathBuf;

use truecut_plan::{Assessment, Criterion, Decay, MarginMap, PlanPoint, Stability};
use truecut_recording::{Unit, significant};

use super::{PostureAnswer, figure};
use crate::text::{self, Align};

/// The printed text.
pub fn printed(answer: &PostureAnswer<'_>, written: &[PathBuf]) -> String {
    let mut text = summary(answer);
    let [first, planned, rest @ ..] = written else {
        return text;
    };
    text.push_str(&format!(
        "\n{}  run it: truecut run {}\n\n",
        text::written(first, rest),
        planned.display()
    ));
    text
}

/// Segments, criteria, and the scenario's own postures.
pub fn summary(answer: &PostureAnswer<'_>) -> String {
    let plan = &answer.plan;
    let weakest = plan.weakest();
    let mut text = format!(
        "{}\n  planned by {}: stable all along; the least reserve, {}, is {} from the start\n",
        answer.scenario.name,
        plan.criterion,
        percent(weakest.assessment.reserve()),
        text::show(Unit::Metre, weakest.along_m),
    );
    text.push_str(&called_unstable(answer));
    if let Some(slowest) = slowest(&plan.points) {
        text.push_str(&format!(
            "  vibration dies away at {} 1/s or faster, {} 1/s are asked there\n",
            significant(-slowest.growth_per_s, 3),
            significant(slowest.least_per_s, 3),
        ));
    }
    text.push('\n');
    text.push_str(&segments(answer));
    text.push_str("\n  stable redundancy angles, deg\n");
    text.push_str(&intervals(answer));
    text.push_str("\n  least value along the path over what is needed\n");
    text.push_str(&comparison(answer));
    if let Some(own) = &answer.own {
        text.push_str(&own_postures(answer.regenerative(&own.assessed)));
    }
    if let Some(uncertain) = &answer.uncertain {
        text.push_str(&uncertain.told(answer));
    }
    text.push_str(&text::notes(&answer.missing));
    text.push_str(&text::notes(answer.study.estimates()));
    if !answer.scenario.effects.is_empty() {
        text.push_str("  note: the plan is for the nominal arm; effects act in runs only\n");
    }
    text
}

/// Criteria by which the plan is not stable all along, though it is by the one that made it.
fn called_unstable(answer: &PostureAnswer<'_>) -> String {
    let others = Criterion::ALL.iter().zip(&answer.plan_assessed);
    let failing = others.filter_map(|(criterion, found)| {
        let worst = least_ratio(found);
        (worst < 1.0).then(|| format!("{criterion} ({} of what it asks)", significant(worst, 3)))
    });
    let failing: Vec<String> = failing.collect();
    match failing.is_empty() {
        true => String::new(),
        false => format!("  not by each criterion, though: {}\n", failing.join(", ")),
    }
}

/// The least value over what is needed.
fn least_ratio(found: &[Assessment]) -> f64 {
    let ratios = found.iter().map(|one| 1.0 + one.margin);
    ratios.fold(f64::INFINITY, f64::min)
}

/// Slowest decay along a plan, for criteria that have one.
fn slowest<'a>(points: impl IntoIterator<Item = &'a PlanPoint>) -> Option<Decay> {
    let all = points.into_iter().filter_map(|p| p.assessment.decay);
    all.max_by(|a, b| a.growth_per_s.total_cmp(&b.growth_per_s))
}

fn percent(margin: f64) -> String {
    if margin.is_infinite() {
        return "more than looked for".to_owned();
    }
    format!("{} %", significant(100.0 * margin, 3))
}

fn segments(answer: &PostureAnswer<'_>) -> String {
    let mut head = vec!["segment", "taken from", "to", "angle", "least reserve"];
    let plan = &answer.plan;
    if slowest(&plan.points).is_some() {
        head.push("slowest decay");
    }
    let rows = plan.segments.iter().map(|segment| {
        let inside = plan
            .points
            .iter()
            .filter(|p| p.along_m >= segment.from_m - 1e-9 && p.along_m <= segment.to_m + 1e-9);
        let least = inside
            .clone()
            .map(|p| p.assessment.reserve())
            .fold(f64::INFINITY, f64::min);
        let degrees = |rad: f64| format!("{:.1} deg", rad.to_degrees());
        let mut row = vec![
            format!(
                "{:.1} to {:.1} mm",
                segment.from_m * 1e3,
                segment.to_m * 1e3
            ),
            degrees(segment.interval.from_rad),
            degrees(segment.interval.to_rad),
            degrees(segment.interval.middle_rad()),
            percent(least),
        ];
        let slowest = slowest(inside);
        row.extend(slowest.map(|decay| format!("{} 1/s", significant(-decay.growth_per_s, 3))));
        row
    });
    text::table(&vec![Align::Right; head.len()], &text::headed(&head, rows))
}

/// Stable angles by each criterion at start, middle and end of the path, within reach.
fn intervals(answer: &PostureAnswer<'_>) -> String {
    let columns = answer.maps[0].along_m.len();
    let places = [0, columns / 2, columns - 1];
    let mut head = vec!["criterion".to_owned()];
    head.extend(places.map(|i| format!("at {:.0} mm", answer.maps[0].along_m[i] * 1e3)));
    let rows = answer.maps.iter().map(|map| {
        let mut row = vec![figure::name(map.criterion).to_owned()];
        row.extend(places.map(|i| ranges(map, i)));
        row
    });
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    text::table(&[Align::Left; 4], &rows)
}

/// Runs of stable angles of a column, degrees.
fn ranges(map: &MarginMap, column: usize) -> String {
    let stable = |found: &Option<Assessment>| found.is_some_and(|a| a.is_stable());
    let cells = map.angles_rad.iter().zip(&map.assessments[column]);
    runs(cells.map(|(angle, found)| (angle.to_degrees(), stable(found))))
}

/// Runs of angles, degrees, that are taken.
pub fn runs(angles: impl Iterator<Item = (f64, bool)>) -> String {
    let mut runs: Vec<(f64, f64)> = Vec::new();
    let mut open = false;
    for (degrees, taken) in angles {
        match (taken, runs.last_mut()) {
            (true, Some(run)) if open => run.1 = degrees,
            (true, _) => runs.push((degrees, degrees)),
            _ => {}
        }
        open = taken;
    }
    if runs.is_empty() {
        return "none".to_owned();
    }
    let shown: Vec<String> = runs.iter().map(|(a, b)| format!("{a:.0}–{b:.0}")).collect();
    shown.join(", ")
}

/// Slowest decay over the required one.
fn least_decay(found: &[Assessment]) -> String {
    let all = found.iter().filter_map(|a| a.decay);
    let ratio = |decay: Decay| -decay.growth_per_s / decay.least_per_s;
    let least = all.map(ratio).fold(f64::INFINITY, f64::min);
    if least == f64::INFINITY {
        return "none is needed".to_owned();
    }
    let mark = if least < 1.0 { "✗ " } else { "" };
    format!("{mark}{}", significant(least, 3))
}

/// Assessment of the scenario's own postures by regeneration.
fn own_postures(found: &[Assessment]) -> String {
    let found = found.iter().map(Assessment::stability);
    let found: Vec<Stability> = found.collect();
    let share = |of: Stability| {
        let count = found.iter().filter(|one| **one == of).count();
        format!("{:.0} %", 100.0 * count as f64 / found.len().max(1) as f64)
    };
    format!(
        "\n  by regeneration {} of the path chatter at the scenario's own postures, {} are stable; \
         on the rest vibration dies away, too slowly to rely on\n",
        share(Stability::Unstable),
        share(Stability::Stable),
    )
}

/// Worst ratios of the plan and of the scenario's own postures by each criterion.
fn comparison(answer: &PostureAnswer<'_>) -> String {
    let least = |found: &[Assessment]| {
        let worst = least_ratio(found);
        let mark = if worst < 1.0 { "✗ " } else { "" };
        if worst.is_infinite() {
            "above 3".to_owned()
        } else {
            format!("{mark}{}", significant(worst, 3))
        }
    };
    let head = ["criterion", "plan", "scenario's own postures"];
    let rows = Criterion::ALL.iter().enumerate().map(|(k, criterion)| {
        let own = answer.own.as_ref().map(|own| least(&own.assessed[k]));
        let mark = if k == answer.chosen() {
            " (planned by)"
        } else {
            ""
        };
        vec![
            format!("{criterion}{mark}"),
            least(&answer.plan_assessed[k]),
            own.unwrap_or_else(|| "cannot be followed".to_owned()),
        ]
    });
    let own = (answer.own.as_ref()).map(|own| least_decay(answer.regenerative(&own.assessed)));
    let decay = vec![
        "decay by regeneration".to_owned(),
        least_decay(answer.regenerative(&answer.plan_assessed)),
        own.unwrap_or_else(|| "cannot be followed".to_owned()),
    ];
    let rows = text::headed(&head, rows.chain([decay]));
    text::table(&[Align::Left, Align::Right, Align::Right], &rows)
}
