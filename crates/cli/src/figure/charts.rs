//! A figure's panels as charts of the viewer.

use truecut_telemetry::{Chart, ChartPage, Curve, CurveStyle};

use super::{Figure, Layer, Panel, Scale, Style};

/// Colours of the layers, for a dark background.
const COLOURS: [[u8; 3]; 7] = [
    [60, 150, 255],
    [242, 142, 43],
    [40, 190, 140],
    [225, 140, 190],
    [245, 225, 90],
    [170, 120, 255],
    [235, 235, 235],
];

/// The panels as charts; cells are drawn in the figure only.
pub fn charts_of(figure: &Figure) -> ChartPage {
    ChartPage {
        title: figure.title.clone(),
        charts: figure.panels.iter().map(chart).collect(),
    }
}

fn chart(panel: &Panel) -> Chart {
    let shown = |layer: &&Layer| !matches!(layer.style, Style::Cells { .. });
    // The viewer's charts are linear: a logarithmic axis holds logarithms.
    let logarithmic = panel.y_scale == Scale::Logarithmic;
    let curve = |layer: &Layer| Curve {
        name: layer.label.clone(),
        color: COLOURS[layer.colour % COLOURS.len()],
        points: (layer.points.iter())
            .map(|(x, y)| (*x, if logarithmic { y.log10() } else { *y }))
            .collect(),
        marks: Vec::new(),
        style: match layer.style {
            Style::Marks(_) => CurveStyle::Dots,
            Style::Dashed => CurveStyle::Dashed,
            _ => CurveStyle::Line,
        },
    };
    let curves = |layer: &Layer| match &layer.style {
        // The viewer draws no areas: both edges.
        Style::Band(lower) => {
            let points = layer.points.iter().zip(lower);
            let points = points.map(|((x, _), low)| (*x, *low)).collect();
            let lower = Layer {
                points,
                ..layer.clone()
            };
            vec![curve(&lower), curve(layer)]
        }
        _ => vec![curve(layer)],
    };
    Chart {
        title: panel.title.clone(),
        x_label: panel.x_label.clone(),
        y_label: panel.y_label.clone(),
        least_y: f64::NAN,
        logarithmic,
        curves: panel.layers.iter().filter(shown).flat_map(curves).collect(),
    }
}
