//! Figures of a plan: criteria over path and redundancy angle, margins, decay.

use truecut_plan::{Assessment, Criterion, Decay, MarginMap, Stability};

use super::PostureAnswer;
use crate::figure::{BLACK, BLUE, Figure, GREEN, Layer, Legend, ORANGE, PINK, Panel, Style};

/// Colour of each criterion.
const COLOURS: [usize; 4] = [PINK, GREEN, ORANGE, BLUE];
/// Margin of the darkest blue, as a ratio to the requirement.
const FULL: f64 = 3.0;

/// A map for each criterion, then limits over the angle, margins and decay along the path.
pub fn figure(answer: &PostureAnswer<'_>) -> Figure {
    let mut panels: Vec<Panel> = answer.maps.iter().map(|map| margins(answer, map)).collect();
    panels.push(over_angle(answer));
    panels.push(along_path(answer));
    panels.push(decay_over_angle(answer));
    panels.push(decay(answer));
    if let Some(uncertain) = &answer.uncertain {
        panels.extend(uncertain.panels(answer));
    }
    Figure {
        title: format!(
            "{}: stable redundancy angles by four criteria",
            answer.scenario.name
        ),
        panels,
        columns: 2,
        legend: Legend::Above,
    }
}

/// Stable (blue), marginal (white) and unstable (orange) over path and angle.
fn margins(answer: &PostureAnswer<'_>, map: &MarginMap) -> Panel {
    let columns = map.along_m.iter().zip(&map.assessments);
    let shaded = columns.flat_map(|(along, column)| {
        let cells = map.angles_rad.iter().zip(column);
        cells.filter_map(move |(angle, found)| {
            let place = (along * 1e3, angle.to_degrees());
            Some((place, shade(found.as_ref()?)))
        })
    });
    let step = |values: &[f64]| {
        let count = values.len().max(2) - 1;
        (values[values.len() - 1] - values[0]) / count as f64
    };
    let size = (step(&map.along_m) * 1e3, step(&map.angles_rad).to_degrees());
    let mut layers = vec![
        Layer::cells(size, shaded),
        Layer::line("plan", angles(&answer.plan), BLACK),
    ];
    if let Some(own) = &answer.own {
        layers.push(Layer::dashed("scenario", angles(&own.plan), PINK));
    }
    let of_plan = map.criterion == answer.plan.criterion;
    let mark = if of_plan { "Plan by " } else { "" };
    Panel::new(
        format!("{mark}{}", name(map.criterion)),
        "along the path [mm]",
        "redundancy angle [deg]",
        layers,
    )
}

/// −1 … 1 by the logarithm of value over requirement; white where marginal.
fn shade(found: &Assessment) -> f64 {
    let ratio = (1.0 + found.margin).max(1e-6).ln() / FULL.ln();
    let least = match found.stability() {
        Stability::Stable => 0.15,
        Stability::Marginal => return 0.0,
        Stability::Unstable => -0.15,
    };
    (ratio.clamp(-1.0, 1.0) * 0.85) + least
}

/// Angles modulo one turn; the curve breaks where they wrap around.
fn angles(plan: &truecut_plan::Plan) -> Vec<(f64, f64)> {
    let mut curve: Vec<(f64, f64)> = Vec::new();
    for point in &plan.points {
        let angle = point.angle_rad.to_degrees().rem_euclid(360.0);
        if curve
            .last()
            .is_some_and(|(_, before)| (before - angle).abs() > 180.0)
        {
            curve.push((f64::NAN, f64::NAN));
        }
        curve.push((point.along_m * 1e3, angle));
    }
    curve
}

/// Limit depth by each theory over the angle, at the middle of the path.
fn over_angle(answer: &PostureAnswer<'_>) -> Panel {
    let cut = &answer.study.cut;
    let depth_mm = cut.nominal.axial_depth_m * 1e3;
    let theories = answer.maps.iter().zip(COLOURS);
    let theories = theories.filter(|(map, _)| map.criterion != Criterion::Anisotropy);
    let mut layers: Vec<Layer> = theories
        .map(|(map, colour)| {
            let column = &map.assessments[map.along_m.len() / 2];
            let value = |found: &Option<Assessment>| found.map_or(f64::NAN, |a| a.value * 1e3);
            let points = map
                .angles_rad
                .iter()
                .zip(column)
                .filter(|(_, found)| found.is_some());
            Layer::line(
                name(map.criterion),
                points.map(|(angle, found)| (angle.to_degrees(), value(found))),
                colour,
            )
        })
        .collect();
    let reached = layers.iter().flat_map(|layer| &layer.points);
    let reached = reached.filter(|p| p.1.is_finite()).map(|p| p.0);
    let ends = reached.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    });
    layers.push(Layer::dashed("cut", ends.map(|x| (x, depth_mm)), BLACK));
    Panel::new(
        "Limit at mid-path",
        "redundancy angle [deg]",
        "limit depth [mm]",
        layers,
    )
    .logarithmic()
}

/// Margins of the plan, and of the scenario's own postures dashed.
fn along_path(answer: &PostureAnswer<'_>) -> Panel {
    let curve = |plan: &truecut_plan::Plan, found: &[Assessment]| -> Vec<(f64, f64)> {
        let points = plan.points.iter().zip(found);
        points
            .map(|(p, a)| (p.along_m * 1e3, 1.0 + a.margin))
            .collect()
    };
    let mut layers = Vec::new();
    for (k, colour) in COLOURS.into_iter().enumerate() {
        layers.push(Layer::line(
            name(Criterion::ALL[k]),
            curve(&answer.plan, &answer.plan_assessed[k]),
            colour,
        ));
        if let Some(own) = &answer.own {
            layers.push(Layer::dashed(
                "",
                curve(&own.plan, &own.assessed[k]),
                colour,
            ));
        }
    }
    let length_mm = answer.study.path.length_m() * 1e3;
    layers.push(Layer::line("", [(0.0, 1.0), (length_mm, 1.0)], BLACK));
    Panel::new(
        "Reserve (dashed: scenario)",
        "along the path [mm]",
        "value over what is needed",
        layers,
    )
    .logarithmic()
}

/// Decay rate of vibration, and the required one; negative where it grows.
fn decays(
    points: impl Iterator<Item = (f64, Assessment)> + Clone,
    style: Style,
    label: &str,
) -> [Layer; 2] {
    let layer = |label: &str, colour, of: &dyn Fn(&Decay) -> f64| {
        Layer::new(
            label,
            (points.clone()).filter_map(|(at, found)| Some((at, of(&found.decay?)))),
            style.clone(),
            colour,
        )
    };
    let (colour, least) = match label {
        "scenario" => (PINK, ""),
        _ => (BLUE, "least"),
    };
    [
        layer(label, colour, &|decay| -decay.growth_per_s),
        layer(least, BLACK, &|decay| decay.least_per_s),
    ]
}

/// Decay over the angle, at the middle of the path.
fn decay_over_angle(answer: &PostureAnswer<'_>) -> Panel {
    let maps = answer.maps.iter();
    let maps = maps.filter(|map| map.criterion == Criterion::Regenerative);
    let layers = maps.flat_map(|map| {
        let column = &map.assessments[map.along_m.len() / 2];
        let cells = map.angles_rad.iter().zip(column);
        let cells = cells.filter_map(|(angle, found)| Some((angle.to_degrees(), (*found)?)));
        decays(cells, Style::Line, "regeneration")
    });
    Panel::new(
        "Decay at mid-path",
        "redundancy angle [deg]",
        "decay of vibration [1/s]",
        layers.collect(),
    )
}

/// Decay of the plan, and at the scenario's own postures dashed.
fn decay(answer: &PostureAnswer<'_>) -> Panel {
    let along = |plan: &truecut_plan::Plan, found: &[Assessment], style, label| {
        let points = plan.points.iter().zip(found);
        decays(points.map(|(p, a)| (p.along_m * 1e3, *a)), style, label)
    };
    let planned = answer.regenerative(&answer.plan_assessed);
    let mut layers = along(&answer.plan, planned, Style::Line, "plan").to_vec();
    if let Some(own) = &answer.own {
        let found = answer.regenerative(&own.assessed);
        layers.extend(along(&own.plan, found, Style::Dashed, "scenario"));
    }
    Panel::new(
        "Decay by regeneration",
        "along the path [mm]",
        "decay of vibration [1/s]",
        layers,
    )
}

/// Short names for legends.
pub fn name(criterion: Criterion) -> &'static str {
    match criterion {
        Criterion::Anisotropy => "r ≥ 0.1",
        Criterion::Flutter => "flutter",
        Criterion::ModeCoupling => "mode coupling",
        Criterion::Regenerative => "regeneration",
    }
}
