//! Figures as data for the page's script.

use maud::{Markup, PreEscaped, html};
use serde::Serialize;

use crate::figure::{ColourScale, Figure, Layer, Panel, Scale, Style, thinned};

/// Most points of a curve.
pub const POINTS: usize = 20_000;
/// What a page may have for figures and scenes, so that it stays below 3 MB with styles, script
/// and tables.
const BYTES_OF_A_PAGE: usize = 2_700_000;
/// Of a point: two numbers of at most 13 characters each.
const BYTES_OF_A_POINT: usize = 26;
/// What a curve has in any case.
const FEWEST: usize = 200;

/// How many points each curve of these figures may have, on a page that has so many bytes beside
/// them.
pub fn most_points<'a>(figures: impl Iterator<Item = &'a Figure>, beside: usize) -> usize {
    let panels = figures.flat_map(|figure| &figure.panels);
    let mut sizes: Vec<usize> = panels
        .flat_map(|panel| panel.layers.iter().map(|layer| layer.points.len()))
        .collect();
    sizes.sort_unstable();
    // Short curves leave to the long ones what they do not need.
    let (mut left, mut curves) = (
        BYTES_OF_A_PAGE.saturating_sub(beside) / BYTES_OF_A_POINT,
        sizes.len(),
    );
    for size in sizes {
        let share = left / curves;
        if size > share {
            return share.clamp(FEWEST, POINTS);
        }
        left -= size;
        curves -= 1;
    }
    POINTS
}

/// A figure with the data of its panels, each curve of at most so many points.
pub fn markup(figure: &Figure, most: usize) -> Markup {
    html! {
        figure {
            figcaption { (figure.title) }
            @for panel in &figure.panels {
                div.panel {
                    @if !panel.title.is_empty() { h3 { (panel.title) } }
                    script type="application/json" { (PreEscaped(json(panel, most))) }
                }
            }
        }
    }
}

fn json(panel: &Panel, most: usize) -> String {
    let data = PanelData {
        x: AxisData::of(&panel.x_label, panel.x_scale),
        y: AxisData::of(&panel.y_label, panel.y_scale),
        layers: (panel.layers.iter())
            .map(|layer| LayerData::of(layer, most))
            .collect(),
        scale: panel.scale.as_ref(),
        even: panel.even,
    };
    safe_json(&data)
}

/// JSON in which nothing can end the element that it stands in.
pub(super) fn safe_json(data: &impl Serialize) -> String {
    // Numbers and texts: there is nothing that cannot be written.
    let text = serde_json::to_string(data).unwrap_or_default();
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => {
                safe.push_str(&format!("\\u{:04x}", u32::from(letter)));
            }
            other => safe.push(other),
        }
    }
    safe
}

/// Cells that have a shade, in thousandths: an eye sees fewer.
fn drawn_cells<'a>(
    layer: &'a Layer,
    shades: &'a [f64],
) -> impl Iterator<Item = ((f64, f64), f32)> + 'a {
    let cells = layer.points.iter().copied().zip(shades);
    cells
        .filter(|(_, shade)| shade.is_finite())
        .map(|(point, shade)| (point, ((1000.0 * shade).round() / 1000.0) as f32))
}

#[derive(Serialize)]
struct PanelData<'a> {
    x: AxisData<'a>,
    y: AxisData<'a>,
    layers: Vec<LayerData<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scale: Option<&'a ColourScale>,
    #[serde(skip_serializing_if = "is_uneven")]
    even: bool,
}

fn is_uneven(even: &bool) -> bool {
    !even
}

#[derive(Serialize)]
struct AxisData<'a> {
    label: &'a str,
    log: bool,
}

impl AxisData<'_> {
    fn of(label: &str, scale: Scale) -> AxisData<'_> {
        AxisData {
            label,
            log: scale == Scale::Logarithmic,
        }
    }
}

/// Coordinates have the seven digits that a screen shows; what is no number is `null`.
#[derive(Serialize, Default)]
struct LayerData<'a> {
    label: &'a str,
    colour: usize,
    style: &'static str,
    x: Vec<f32>,
    y: Vec<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    width: Option<u32>,
    /// Lower edge of a band.
    #[serde(skip_serializing_if = "Option::is_none")]
    low: Option<Vec<f32>>,
    /// Half lengths of bars.
    #[serde(skip_serializing_if = "Option::is_none")]
    half: Option<Vec<f32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    texts: Option<&'a [String]>,
    /// Width and height of cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    size: Option<(f64, f64)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shade: Option<Vec<f32>>,
}

impl LayerData<'_> {
    fn of(layer: &Layer, most: usize) -> LayerData<'_> {
        let is_rising = layer.points.is_sorted_by(|a, b| a.0 <= b.0);
        let points = match &layer.style {
            Style::Line | Style::Dotted(_) | Style::Dashed if is_rising => {
                thinned(layer.points.iter().copied(), most)
            }
            Style::Line | Style::Dotted(_) | Style::Dashed | Style::Cloud => {
                let step = layer.points.len().div_ceil(most).max(1);
                layer.points.iter().copied().step_by(step).collect()
            }
            Style::Bars(_) | Style::Band(_) | Style::Marks(_) => layer.points.clone(),
            Style::Cells { shades, .. } => drawn_cells(layer, shades).map(|one| one.0).collect(),
        };
        let data = LayerData {
            label: &layer.label,
            colour: layer.colour,
            x: points.iter().map(|point| point.0 as f32).collect(),
            y: points.iter().map(|point| point.1 as f32).collect(),
            ..LayerData::default()
        };
        let single = |values: &[f64]| Some(values.iter().map(|value| *value as f32).collect());
        match &layer.style {
            Style::Line => data.drawn("line"),
            Style::Dashed => data.drawn("dashed"),
            Style::Cloud => data.drawn("cloud"),
            Style::Dotted(width) => LayerData {
                width: Some(*width),
                ..data.drawn("dotted")
            },
            Style::Bars(half) => LayerData {
                half: single(half),
                ..data.drawn("bars")
            },
            Style::Band(low) => LayerData {
                low: single(low),
                ..data.drawn("band")
            },
            Style::Marks(texts) => LayerData {
                texts: Some(texts),
                ..data.drawn("marks")
            },
            Style::Cells { size, shades } => LayerData {
                size: Some(*size),
                shade: Some(drawn_cells(layer, shades).map(|one| one.1).collect()),
                ..data.drawn("cells")
            },
        }
    }

    fn drawn(self, style: &'static str) -> Self {
        LayerData { style, ..self }
    }
}
