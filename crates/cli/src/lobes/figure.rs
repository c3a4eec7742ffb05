//! The diagram as a figure.

use truecut_core::chatter::averaged::Crossing;

use super::{Diagram, rpm};
use crate::figure::{Figure, Layer, Legend, Panel, Style};

const BLUE: usize = 0;
const ORANGE: usize = 1;
const GREEN: usize = 2;
const PINK: usize = 3;
const BLACK: usize = 6;

/// Limit depth and chatter frequency over spindle speed.
pub fn figure(diagram: &Diagram<'_>) -> Figure {
    Figure {
        title: format!("{}: stability", diagram.scenario.name),
        panels: vec![depths(diagram), frequencies(diagram)],
        columns: 1,
        legend: Legend::Right,
    }
}

fn depths(diagram: &Diagram<'_>) -> Panel {
    let lobes = &diagram.lobes;
    let deepest_mm = lobes.depth_m.last().copied().unwrap_or(0.0) * 1e3;
    let curve = |limits: &[Option<Crossing>]| -> Vec<(f64, f64)> {
        let points = lobes.spindle_rad_s.iter().zip(limits);
        let depth = |limit: &Option<Crossing>| limit.map_or(f64::NAN, |limit| limit.depth_m * 1e3);
        // Limits beyond the deepest cut are not drawn.
        let shown = |mm: f64| if mm <= deepest_mm { mm } else { f64::NAN };
        points
            .map(|(speed, limit)| (rpm(*speed), shown(depth(limit))))
            .collect()
    };
    let ends = [0, lobes.spindle_rad_s.len() - 1].map(|i| rpm(lobes.spindle_rad_s[i]));
    let mut layers = vec![shading(diagram)];
    layers.push(Layer {
        label: "semi-discretisation".to_owned(),
        points: curve(&lobes.limit),
        style: Style::Line,
        colour: BLACK,
    });
    layers.push(Layer {
        label: "zero order".to_owned(),
        points: curve(&lobes.zero_order),
        style: Style::Dashed,
        colour: GREEN,
    });
    if let Some(coupling) = lobes.mode_coupling {
        let mm = coupling.depth_m * 1e3;
        if mm <= deepest_mm {
            layers.push(Layer {
                label: "mode coupling, without regeneration".to_owned(),
                points: ends.map(|x| (x, mm)).to_vec(),
                style: Style::Dashed,
                colour: PINK,
            });
        }
    }
    layers.extend(dots(diagram));
    let cut = &diagram.study.cut;
    layers.push(Layer {
        label: "the scenario".to_owned(),
        points: vec![(rpm(cut.spindle_rad_s), cut.nominal.axial_depth_m * 1e3)],
        style: Style::Marks(vec!["scenario".to_owned()]),
        colour: PINK,
    });
    Panel {
        title: "Limit depth (shaded: unstable)".to_owned(),
        x_label: "spindle speed [rpm]".to_owned(),
        y_label: "axial depth [mm]".to_owned(),
        layers,
        ..Panel::default()
    }
}

/// The unstable region.
fn shading(diagram: &Diagram<'_>) -> Layer {
    let lobes = &diagram.lobes;
    let step = |values: &[f64]| values[values.len() - 1] / values.len() as f64;
    let wide = rpm(lobes.spindle_rad_s[1] - lobes.spindle_rad_s[0]);
    let high = step(&lobes.depth_m) * 1e3;
    let mut points = Vec::new();
    let mut shades = Vec::new();
    for (speed, column) in lobes.spindle_rad_s.iter().zip(&lobes.multiplier) {
        for (depth, magnitude) in lobes.depth_m.iter().zip(column) {
            points.push((rpm(*speed), depth * 1e3));
            // Growth over ten tooth periods, clamped.
            let growth = magnitude.ln() * 10.0;
            shades.push(if growth > 0.0 {
                -(0.25 + growth).min(1.0)
            } else {
                f64::NAN
            });
        }
    }
    Layer {
        label: String::new(),
        points,
        style: Style::Cells {
            size: (wide, high),
            shades,
        },
        colour: ORANGE,
    }
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
        Layer {
            label: label.to_owned(),
            style: Style::Marks(vec![String::new(); points.len()]),
            points,
            colour,
        }
    });
    layers.filter(|layer| !layer.points.is_empty()).collect()
}

fn frequencies(diagram: &Diagram<'_>) -> Panel {
    let lobes = &diagram.lobes;
    let curve = |limits: &[Option<Crossing>]| -> Vec<(f64, f64)> {
        let points = lobes.spindle_rad_s.iter().zip(limits);
        let hz = |limit: &Option<Crossing>| limit.map_or(f64::NAN, |limit| limit.frequency_hz);
        points
            .map(|(speed, limit)| (rpm(*speed), hz(limit)))
            .collect()
    };
    let chattering = diagram.runs.iter().filter(|run| run.chatters == Some(true));
    let measured: Vec<(f64, f64)> = chattering
        .map(|run| (rpm(run.spindle_rad_s), run.chatter_hz))
        .collect();
    let mut layers = vec![
        Layer {
            label: "semi-discretisation".to_owned(),
            points: curve(&lobes.limit),
            style: Style::Line,
            colour: BLACK,
        },
        Layer {
            label: "zero order".to_owned(),
            points: curve(&lobes.zero_order),
            style: Style::Dashed,
            colour: GREEN,
        },
    ];
    if !measured.is_empty() {
        layers.push(Layer {
            label: "highest line of runs that chatter".to_owned(),
            style: Style::Marks(vec![String::new(); measured.len()]),
            points: measured,
            colour: ORANGE,
        });
    }
    Panel {
        title: "Chatter frequency at the limit".to_owned(),
        x_label: "spindle speed [rpm]".to_owned(),
        y_label: "frequency [Hz]".to_owned(),
        layers,
        ..Panel::default()
    }
}
