//! The diagram as a figure.

use truecut_core::chatter::averaged::Crossing;
use truecut_plan::lobes::Lobes;
use truecut_recording::significant;

use super::{Diagram, rpm, uncertain};
use crate::figure::{BLACK, BLUE, Figure, GREEN, Layer, Legend, ORANGE, PINK, Panel, Style};

/// Limit depth and chatter frequency over spindle speed.
pub fn figure(diagram: &Diagram<'_>) -> Figure {
    let mut panels = vec![depths(diagram), frequencies(diagram)];
    if let Some(uncertain) = &diagram.uncertain {
        let depth_mm = diagram.study.cut.nominal.axial_depth_m * 1e3;
        panels.insert(1, uncertain::probability(uncertain, depth_mm));
    }
    Figure {
        title: format!("{}: stability", diagram.scenario.name),
        panels,
        columns: 1,
        legend: Legend::Right,
    }
}

fn depths(diagram: &Diagram<'_>) -> Panel {
    let lobes = &diagram.lobes;
    let deepest_mm = lobes.depth_m.last().copied().unwrap_or(0.0) * 1e3;
    let ends = [0, lobes.spindle_rad_s.len() - 1].map(|i| rpm(lobes.spindle_rad_s[i]));
    let mut layers = vec![shading(diagram)];
    if let Some(uncertain) = &diagram.uncertain {
        layers.push(uncertain::band(uncertain, deepest_mm));
    }
    layers.extend(theories(lobes, |limit| {
        let mm = limit.depth_m * 1e3;
        // Limits beyond the deepest cut are not drawn.
        if mm <= deepest_mm { mm } else { f64::NAN }
    }));
    if let Some(coupling) = lobes.mode_coupling {
        let mm = coupling.depth_m * 1e3;
        if mm <= deepest_mm {
            layers.push(Layer::dashed(
                "mode coupling, without regeneration",
                ends.map(|x| (x, mm)),
                PINK,
            ));
        }
    }
    if let Some(other) = &diagram.other {
        let (name, lobes) = (&other.name, &other.lobes);
        let points = lobes.spindle_rad_s.iter().zip(&lobes.limit);
        let points = points.map(|(speed, limit)| {
            let mm = limit.map_or(f64::NAN, |limit| limit.depth_m * 1e3);
            (rpm(*speed), if mm <= deepest_mm { mm } else { f64::NAN })
        });
        let points: Vec<(f64, f64)> = points.collect();
        layers.push(Layer::dashed(format!("with {name}"), points, BLUE));
    }
    if let Some((known_to, _)) = diagram.known {
        let x = rpm(known_to);
        layers.push(Layer::dashed(
            "above: modes of tool, holder and spindle are missing",
            [(x, 0.0), (x, deepest_mm)],
            BLACK,
        ));
    }
    layers.extend(dots(diagram));
    let cut = &diagram.study.cut;
    layers.push(Layer::new(
        "the scenario",
        [(rpm(cut.spindle_rad_s), cut.nominal.axial_depth_m * 1e3)],
        Style::Marks(vec!["scenario".to_owned()]),
        PINK,
    ));
    Panel::new(
        format!(
            "Limit depth (shaded: unstable; error of the limit at most {} %)",
            significant(lobes.largest_error() * 1e2, 2)
        ),
        "spindle speed [rpm]",
        "axial depth [mm]",
        layers,
    )
}

/// A value of the limit over spindle speed, by two theories.
fn theories(lobes: &Lobes, value: impl Fn(Crossing) -> f64) -> [Layer; 2] {
    let curve = |limits: &[Option<Crossing>]| -> Vec<(f64, f64)> {
        let points = lobes.spindle_rad_s.iter().zip(limits);
        points
            .map(|(speed, limit)| (rpm(*speed), limit.map_or(f64::NAN, &value)))
            .collect()
    };
    [
        Layer::line("spectral elements", curve(&lobes.limit), BLACK),
        Layer::dashed("zero order", curve(&lobes.zero_order), GREEN),
    ]
}

/// The unstable region.
fn shading(diagram: &Diagram<'_>) -> Layer {
    let lobes = &diagram.lobes;
    let step = |values: &[f64]| values[values.len() - 1] / values.len() as f64;
    let wide = rpm(lobes.spindle_rad_s[1] - lobes.spindle_rad_s[0]);
    let high = step(&lobes.depth_m) * 1e3;
    let columns = lobes.spindle_rad_s.iter().zip(&lobes.multiplier);
    let cells = columns.flat_map(|(speed, column)| {
        let cell = move |(depth, magnitude): (&f64, &f64)| {
            // Growth over ten tooth periods, clamped.
            let growth = magnitude.ln() * 10.0;
            let shade = if growth > 0.0 {
                -(0.25 + growth).min(1.0)
            } else {
                f64::NAN
            };
            ((rpm(*speed), depth * 1e3), shade)
        };
        lobes.depth_m.iter().zip(column).map(cell)
    });
    Layer::cells((wide, high), cells)
}

/// Simulated runs, grouped by outcome.
fn dots(diagram: &Diagram<'_>) -> Vec<Layer> {
    let kinds = [
        (Some(false), "run, stable", BLUE),
        (Some(true), "run, chatters", ORANGE),
        (None, "run, undecided", BLACK),
    ];
    let layers = kinds.into_iter().map(|(kind, label, colour)| {
        let of_kind = diagram.runs.iter().filter(|run| run.chatters == kind);
        let points: Vec<(f64, f64)> = of_kind
            .map(|run| (rpm(run.spindle_rad_s), run.depth_m * 1e3))
            .collect();
        Layer::circles(label, points, colour)
    });
    layers.filter(|layer| !layer.points.is_empty()).collect()
}

fn frequencies(diagram: &Diagram<'_>) -> Panel {
    let lobes = &diagram.lobes;
    let chattering = diagram.runs.iter().filter(|run| run.chatters == Some(true));
    let measured: Vec<(f64, f64)> = chattering
        .map(|run| (rpm(run.spindle_rad_s), run.chatter_hz))
        .collect();
    let mut layers = theories(lobes, |limit| limit.frequency_hz).to_vec();
    if !measured.is_empty() {
        layers.push(Layer::circles(
            "highest line of runs that chatter",
            measured,
            ORANGE,
        ));
    }
    Panel::new(
        "Chatter frequency at the limit",
        "spindle speed [rpm]",
        "frequency [Hz]",
        layers,
    )
}
