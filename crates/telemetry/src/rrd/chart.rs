//! A drawn chart: the viewer's own plots go over time, these go over anything.

use rerun::{RecordingStream, RecordingStreamResult};

use crate::axis::{Axis, Scale};

/// Size of the drawing, in its own units.
const WIDTH: f32 = 760.0;
/// As [`WIDTH`].
const HEIGHT: f32 = 180.0;
/// What the view must show across: the drawing, with room for the numbers on its left.
pub(super) const ACROSS: [f64; 2] = [-50.0, 780.0];
/// What it must show down: the drawing, with room for the labels above and below.
pub(super) const DOWN: [f64; 2] = [-36.0, 238.0];

/// A curve with its name and its marked points.
pub(super) struct Curve {
    pub(super) name: String,
    pub(super) color: [u8; 3],
    pub(super) points: Vec<(f64, f64)>,
    /// Places that are labelled, e.g. the peaks.
    pub(super) marks: Vec<(f64, f64, String)>,
}

pub(super) struct Chart {
    pub(super) x_label: String,
    pub(super) y_label: String,
    /// The vertical axis goes at least so far; NaN for as far as the curves do.
    pub(super) least_y: f64,
    pub(super) curves: Vec<Curve>,
}

struct Text {
    at: [f32; 2],
    text: String,
    color: rerun::Color,
}

impl Chart {
    /// Draws the chart under an entity; it does not depend on time.
    pub(super) fn log(&self, stream: &RecordingStream, entity: &str) -> RecordingStreamResult<()> {
        let values = |pick: fn(&(f64, f64)) -> f64| {
            self.curves
                .iter()
                .flat_map(move |curve| curve.points.iter().map(pick))
        };
        let x = Axis::around(values(|point| point.0), Scale::Linear, 10);
        let y = values(|point| point.1).chain([self.least_y]);
        let y = Axis::around(y, Scale::Linear, 5);
        self.log_axes(stream, entity, &x, &y)?;
        for (index, curve) in self.curves.iter().enumerate() {
            log_curve(stream, &format!("{entity}/curve_{index}"), curve, &x, &y)?;
        }
        Ok(())
    }

    fn log_axes(
        &self,
        stream: &RecordingStream,
        entity: &str,
        x: &Axis,
        y: &Axis,
    ) -> RecordingStreamResult<()> {
        let grey = rerun::Color::from_rgb(170, 170, 170);
        let mut lines = Vec::new();
        let mut texts = Vec::new();
        for tick in &x.ticks {
            let Some([across, _]) = place(x, y, *tick, y.ends().0) else {
                continue;
            };
            lines.push([[across, 0.0], [across, HEIGHT]]);
            texts.push(Text {
                at: [across, HEIGHT + 12.0],
                text: x.label(*tick),
                color: grey,
            });
        }
        for tick in &y.ticks {
            let Some([_, down]) = place(x, y, x.ends().0, *tick) else {
                continue;
            };
            lines.push([[0.0, down], [WIDTH, down]]);
            texts.push(Text {
                at: [-20.0, down],
                text: y.label(*tick),
                color: grey,
            });
        }
        let white = rerun::Color::from_rgb(235, 235, 235);
        texts.push(Text {
            at: [0.5 * WIDTH, HEIGHT + 32.0],
            text: self.x_label.clone(),
            color: white,
        });
        texts.push(Text {
            at: [0.25 * WIDTH, -16.0],
            text: self.y_label.clone(),
            color: white,
        });
        for (row, curve) in self.curves.iter().enumerate() {
            let [r, g, b] = curve.color;
            let at = [0.68 * WIDTH, 16.0 + 24.0 * row as f32];
            texts.push(Text {
                at,
                text: curve.name.clone(),
                color: rerun::Color::from_rgb(r, g, b),
            });
        }
        let grid = rerun::LineStrips2D::new(lines)
            .with_colors([rerun::Color::from_rgb(70, 70, 70)])
            .with_radii([rerun::Radius::new_ui_points(0.5)])
            .with_draw_order(0.0);
        stream.log_static(format!("{entity}/grid"), &grid)?;
        log_texts(stream, &format!("{entity}/text"), &texts)
    }
}

fn log_curve(
    stream: &RecordingStream,
    entity: &str,
    curve: &Curve,
    x: &Axis,
    y: &Axis,
) -> RecordingStreamResult<()> {
    let [r, g, b] = curve.color;
    let color = rerun::Color::from_rgb(r, g, b);
    // A point that cannot be drawn breaks the line.
    let strips = curve
        .points
        .split(|point| place(x, y, point.0, point.1).is_none());
    let strips = strips.filter(|strip| strip.len() > 1).map(|strip| {
        strip
            .iter()
            .filter_map(|point| place(x, y, point.0, point.1))
            .collect::<Vec<_>>()
    });
    let line = rerun::LineStrips2D::new(strips)
        .with_colors([color])
        .with_radii([rerun::Radius::new_ui_points(1.0)])
        .with_draw_order(10.0);
    stream.log_static(entity, &line)?;
    if curve.marks.is_empty() {
        return Ok(());
    }
    let marks = curve.marks.iter().filter_map(|(at_x, at_y, text)| {
        let at = place(x, y, *at_x, *at_y)?;
        Some(Text {
            at,
            text: text.clone(),
            color,
        })
    });
    let marks: Vec<Text> = marks.collect();
    let dots = rerun::Points2D::new(marks.iter().map(|mark| mark.at))
        .with_colors([color])
        .with_radii([rerun::Radius::new_ui_points(4.0)])
        .with_labels(marks.iter().map(|mark| mark.text.as_str()))
        .with_show_labels(true)
        .with_draw_order(20.0);
    stream.log_static(format!("{entity}/marks"), &dots)
}

fn log_texts(stream: &RecordingStream, entity: &str, texts: &[Text]) -> RecordingStreamResult<()> {
    let points = rerun::Points2D::new(texts.iter().map(|text| text.at))
        .with_colors(texts.iter().map(|text| text.color))
        .with_radii([rerun::Radius::new_ui_points(0.0)])
        .with_labels(texts.iter().map(|text| text.text.as_str()))
        .with_show_labels(true);
    stream.log_static(entity, &points)
}

/// A point of the chart in the drawing, whose y goes down.
fn place(x: &Axis, y: &Axis, at_x: f64, at_y: f64) -> Option<[f32; 2]> {
    let (across, up) = (x.place(at_x)?, y.place(at_y)?);
    Some([across as f32 * WIDTH, (1.0 - up as f32) * HEIGHT])
}
