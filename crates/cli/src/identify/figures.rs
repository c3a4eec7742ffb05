//! Figures: displacements and stiffnesses; FRFs with modes.

use std::f64::consts::PI;

use truecut_discrepancy::identify::modes::{FrfReport, ModesReport};
use truecut_discrepancy::identify::stiffness::StiffnessReport;
use truecut_recording::{Unit, significant};

use crate::figure::{BLACK, BLUE, Figure, GREEN, Layer, Legend, ORANGE, Panel, Style, thinned};
use crate::text::reading_unit;

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
            let cloud = |which: usize, label: &str, colour| {
                Layer::circles(
                    label,
                    (one.points.iter()).map(|p| (unit.from_si(p[0]), unit.from_si(p[which]))),
                    colour,
                )
            };
            let ends = [-unit.from_si(size), unit.from_si(size)];
            Panel::new(
                one.channel.clone(),
                format!("measured [{}]", unit.symbol),
                format!("predicted [{}]", unit.symbol),
                vec![
                    Layer::dashed("equal", ends.map(|end| (end, end)), BLACK),
                    cloud(1, "robot's file", ORANGE),
                    cloud(2, "identified", BLUE),
                ],
            )
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
    Panel::new(
        "stiffness over that of the robot's file, 95 % intervals",
        "joint",
        "ratio",
        vec![
            Layer::dashed("equal", [(0.5, 1.0), (joints + 0.5, 1.0)], BLACK),
            Layer::new("identified", points, Style::Bars(halves), BLUE),
        ],
    )
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
    let curves = frf.curves.iter();
    let points = curves.map(|(f, all)| (*f, value(all[which].re, all[which].im)));
    thinned(points, POINTS)
}

fn layers(frf: &FrfReport, value: fn(f64, f64) -> f64) -> Vec<Layer> {
    let layer = |which, label: &str, style, colour| {
        Layer::new(label, curve(frf, which, value), style, colour)
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
    layers.push(Layer::new(
        "modes",
        modes.clone().map(|f| (f, near(f))),
        Style::Marks(modes.map(|f| format!("{} Hz", significant(f, 3))).collect()),
        BLACK,
    ));
    Panel::new(
        file_name(frf),
        "frequency [Hz]",
        format!("magnitude [{}]", frf.unit),
        layers,
    )
    .logarithmic()
}

fn phase(frf: &FrfReport) -> Panel {
    Panel::new(
        "phase",
        "frequency [Hz]",
        "phase [deg]",
        layers(frf, |re, im| im.atan2(re) * 180.0 / PI),
    )
}

fn file_name(frf: &FrfReport) -> String {
    let name = std::path::Path::new(&frf.source).file_name();
    name.map_or_else(
        || frf.source.clone(),
        |name| name.to_string_lossy().into_owned(),
    )
}
