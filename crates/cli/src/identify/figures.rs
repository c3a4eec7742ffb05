//! Figures: displacements and stiffnesses; FRFs with modes.

use std::f64::consts::PI;

use truecut_discrepancy::identify::modes::{FrfReport, ModesReport};
use truecut_discrepancy::identify::stiffness::StiffnessReport;
use truecut_recording::{Unit, significant};

use crate::figure::{Figure, Layer, Legend, Panel, Scale, Style, thinned};
use crate::text::reading_unit;

const BLUE: usize = 0;
const ORANGE: usize = 1;
const GREEN: usize = 2;
const BLACK: usize = 6;
/// Most points of a curve, and most FRFs that are drawn.
const POINTS: usize = 1200;
const FRFS: usize = 6;

/// Measured against predicted displacement, and the stiffnesses.
pub fn stiffness(report: &StiffnessReport) -> Figure {
    let mut panels: Vec<Panel> = (report.components.iter())
        .map(|one| {
            let size = one.points.iter().fold(0.0_f64, |a, p| a.max(p[0].abs()));
            let kind = if one.unit == "m" {
                Unit::Metre
            } else {
                Unit::Radian
            };
            let unit = reading_unit(kind, size);
            let cloud = |which: usize, label: &str, colour| Layer {
                label: label.to_owned(),
                points: (one.points.iter())
                    .map(|p| (unit.from_si(p[0]), unit.from_si(p[which])))
                    .collect(),
                style: Style::Marks(vec![String::new(); one.points.len()]),
                colour,
            };
            let ends = [-unit.from_si(size), unit.from_si(size)];
            Panel {
                title: one.channel.clone(),
                x_label: format!("measured [{}]", unit.symbol),
                y_label: format!("predicted [{}]", unit.symbol),
                layers: vec![
                    Layer {
                        label: "equal".to_owned(),
                        points: ends.map(|end| (end, end)).to_vec(),
                        style: Style::Dashed,
                        colour: BLACK,
                    },
                    cloud(1, "robot's file", ORANGE),
                    cloud(2, "identified", BLUE),
                ],
                ..Panel::default()
            }
        })
        .collect();
    panels.push(ratios(report));
    Figure {
        title: format!("Joint stiffness from {} loadings", report.loadings),
        panels,
        columns: 2,
        legend: Legend::Above,
    }
}

/// Identified stiffness over that of robot.toml, with intervals.
fn ratios(report: &StiffnessReport) -> Panel {
    let mut points = Vec::new();
    let mut halves = Vec::new();
    for (k, joint) in report.joints.iter().enumerate() {
        let (Some(value), Some(low), Some(high)) = (joint.value, joint.low, joint.high) else {
            continue;
        };
        let scale = joint.nominal.unwrap_or(value);
        points.push(((k + 1) as f64, value / scale));
        halves.push(0.5 * (high - low) / scale);
    }
    let joints = report.joints.len() as f64;
    Panel {
        title: "stiffness over that of the robot's file, 95 % intervals".to_owned(),
        x_label: "joint".to_owned(),
        y_label: "ratio".to_owned(),
        layers: vec![
            Layer {
                label: "equal".to_owned(),
                points: vec![(0.5, 1.0), (joints + 0.5, 1.0)],
                style: Style::Dashed,
                colour: BLACK,
            },
            Layer {
                label: "identified".to_owned(),
                points,
                style: Style::Bars(halves),
                colour: BLUE,
            },
        ],
        ..Panel::default()
    }
}

/// Magnitude and phase of every FRF, with the measured modes.
pub fn modes(report: &ModesReport) -> Figure {
    let panels = (report.frfs.iter().take(FRFS))
        .flat_map(|frf| [magnitude(report, frf), phase(frf)])
        .collect();
    Figure {
        title: format!("{} measured modes", report.measured.len()),
        panels,
        columns: 2,
        legend: Legend::Above,
    }
}

fn curve(frf: &FrfReport, which: usize, value: fn(f64, f64) -> f64) -> Vec<(f64, f64)> {
    let points = frf
        .curves
        .iter()
        .map(|(f, all)| (*f, value(all[which].re, all[which].im)));
    thinned(points, POINTS)
}

fn layers(frf: &FrfReport, value: fn(f64, f64) -> f64) -> Vec<Layer> {
    let layer = |which, label: &str, style, colour| Layer {
        label: label.to_owned(),
        points: curve(frf, which, value),
        style,
        colour,
    };
    vec![
        layer(0, "measured", Style::Dotted(3), ORANGE),
        layer(1, "fit", Style::Line, BLUE),
        layer(2, "model", Style::Dashed, GREEN),
    ]
}

fn magnitude(report: &ModesReport, frf: &FrfReport) -> Panel {
    let mut layers = layers(frf, f64::hypot);
    let near = |f: f64| {
        let nearest = frf
            .curves
            .iter()
            .min_by(|a, b| (a.0 - f).abs().total_cmp(&(b.0 - f).abs()));
        nearest.map_or(f64::NAN, |(_, all)| all[1].re.hypot(all[1].im))
    };
    let modes = report.measured.iter().map(|mode| mode.frequency_hz.value);
    layers.push(Layer {
        label: "modes".to_owned(),
        points: modes.clone().map(|f| (f, near(f))).collect(),
        style: Style::Marks(modes.map(|f| format!("{} Hz", significant(f, 3))).collect()),
        colour: BLACK,
    });
    Panel {
        title: file_name(frf),
        x_label: "frequency [Hz]".to_owned(),
        y_label: format!("magnitude [{}]", frf.unit),
        y_scale: Scale::Logarithmic,
        layers,
        ..Panel::default()
    }
}

fn phase(frf: &FrfReport) -> Panel {
    Panel {
        title: "phase".to_owned(),
        x_label: "frequency [Hz]".to_owned(),
        y_label: "phase [deg]".to_owned(),
        layers: layers(frf, |re, im| im.atan2(re) * 180.0 / PI),
        ..Panel::default()
    }
}

fn file_name(frf: &FrfReport) -> String {
    let name = std::path::Path::new(&frf.source).file_name();
    name.map_or_else(
        || frf.source.clone(),
        |name| name.to_string_lossy().into_owned(),
    )
}
