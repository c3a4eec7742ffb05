//! A drawn chart: the viewer's own plots go over time, these go over anything.

use super::store::{Logged, Store};
use re_sdk_types::archetypes::{LineStrips2D, Points2D};
use re_sdk_types::components::{Color, Radius};

use crate::axis::Axis;

/// Size of the drawing, in its own units.
const WIDTH: f32 = 760.0;
/// As [`WIDTH`].
const HEIGHT: f32 = 180.0;
/// What the view must show across: the drawing, with room for the numbers on its left.
const ACROSS: [f64; 2] = [-50.0, 780.0];
/// What it must show down: the drawing, with room for the labels above and below.
pub(super) const DOWN: [f64; 2] = [-36.0, 244.0];
/// A legend of names no longer than this stands beside the drawing, where it hides no curve.
const SHORT_NAME: usize = 20;
/// How much wider the view is for it.
const LEGEND: f64 = 170.0;
/// Height of a row of a legend.
const ROW: f32 = 27.0;

const GREY: [u8; 3] = [170, 170, 170];
const DARK: [u8; 3] = [70, 70, 70];
const WHITE: [u8; 3] = [235, 235, 235];

/// A curve, or dots.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// In the legend; none if empty.
    pub name: String,
    /// Red, green, blue.
    pub color: [u8; 3],
    /// NaN breaks the curve.
    pub points: Vec<(f64, f64)>,
    /// Places that are labelled, e.g. the peaks.
    pub marks: Vec<(f64, f64, String)>,
    /// Points are not joined.
    pub dots: bool,
}

/// A chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Above it.
    pub title: String,
    /// Below it, with a unit.
    pub x_label: String,
    /// With a unit.
    pub y_label: String,
    /// The vertical axis goes at least so far; NaN for as far as the curves do.
    pub least_y: f64,
    /// Drawn in this order.
    pub curves: Vec<Curve>,
}

/// The chart in lines and texts: two entities, however much there is to see.
struct Drawing {
    x: Axis,
    y: Axis,
    lines: Vec<(Vec<[f32; 2]>, [u8; 3], Radius)>,
    texts: Vec<([f32; 2], String, [u8; 3], Radius)>,
}

impl Chart {
    /// What the view must show across.
    pub(super) fn across(&self) -> [f64; 2] {
        let beside = if self.has_legend_beside() {
            LEGEND
        } else {
            0.0
        };
        [ACROSS[0], ACROSS[1] + beside]
    }

    fn has_legend_beside(&self) -> bool {
        let mut lengths = self.curves.iter().map(|curve| curve.name.chars().count());
        let is_empty = self.curves.iter().all(|curve| curve.name.is_empty());
        !is_empty && lengths.all(|length| length <= SHORT_NAME)
    }

    /// Draws the chart under an entity; it does not depend on time.
    pub(super) fn log(&self, stream: &Store, entity: &str) -> Logged<()> {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let x = Axis::around(points().map(|point| point.0), 10);
        let y = points().map(|point| point.1).chain([self.least_y]);
        let y = Axis::around(y, 5);
        let mut drawing = Drawing {
            x,
            y,
            lines: Vec::new(),
            texts: Vec::new(),
        };
        drawing.axes(&self.x_label, &self.y_label);
        let left = match self.has_legend_beside() {
            true => WIDTH + 0.55 * LEGEND as f32,
            false => 0.68 * WIDTH,
        };
        for curve in &self.curves {
            drawing.curve(curve);
        }
        let named = self.curves.iter().filter(|curve| !curve.name.is_empty());
        for (row, curve) in named.enumerate() {
            let at = [left, 16.0 + ROW * row as f32];
            drawing.text(at, curve.name.clone(), curve.color);
        }
        drawing.log(stream, entity)
    }
}

impl Drawing {
    /// A point of the chart in the drawing, whose y goes down.
    fn place(&self, x: f64, y: f64) -> Option<[f32; 2]> {
        let (across, up) = (self.x.place(x)?, self.y.place(y)?);
        Some([across as f32 * WIDTH, (1.0 - up as f32) * HEIGHT])
    }

    fn text(&mut self, at: [f32; 2], text: String, color: [u8; 3]) {
        self.texts
            .push((at, text, color, Radius::new_ui_points(0.0)));
    }

    fn axes(&mut self, x_label: &str, y_label: &str) {
        let thin = Radius::new_ui_points(0.5);
        let (x_low, y_low) = (self.x.ends().0, self.y.ends().0);
        for tick in self.x.ticks.clone() {
            let Some([across, _]) = self.place(tick, y_low) else {
                continue;
            };
            self.lines
                .push((vec![[across, 0.0], [across, HEIGHT]], DARK, thin));
            self.text([across, HEIGHT + 12.0], self.x.label(tick), GREY);
        }
        for tick in self.y.ticks.clone() {
            let Some([_, down]) = self.place(x_low, tick) else {
                continue;
            };
            self.lines
                .push((vec![[0.0, down], [WIDTH, down]], DARK, thin));
            self.text([-20.0, down], self.y.label(tick), GREY);
        }
        self.text([0.5 * WIDTH, HEIGHT + 32.0], x_label.to_owned(), WHITE);
        self.text([0.25 * WIDTH, -16.0], y_label.to_owned(), WHITE);
    }

    /// The curve and its marks.
    fn curve(&mut self, curve: &Curve) {
        let color = curve.color;
        let mut lines = Vec::new();
        // A point that cannot be drawn breaks the line.
        for strip in curve.points.split(|(x, y)| self.place(*x, *y).is_none()) {
            let line: Vec<[f32; 2]> = strip
                .iter()
                .filter_map(|(x, y)| self.place(*x, *y))
                .collect();
            if line.len() > 1 && !curve.dots {
                lines.push((line, color, Radius::new_ui_points(1.0)));
            }
        }
        self.lines.extend(lines);
        let dots = curve.points.iter().filter(|_| curve.dots);
        let dots = dots.map(|(x, y)| (*x, *y, ""));
        let marks = curve
            .marks
            .iter()
            .map(|(x, y, text)| (*x, *y, text.as_str()));
        for (x, y, text) in dots.chain(marks) {
            if let Some(at) = self.place(x, y) {
                self.texts
                    .push((at, text.to_owned(), color, Radius::new_ui_points(4.0)));
            }
        }
    }

    fn log(self, stream: &Store, entity: &str) -> Logged<()> {
        let lines = LineStrips2D::new(self.lines.iter().map(|(line, ..)| line.clone()))
            .with_colors(self.lines.iter().map(|(_, color, _)| rgb(*color)))
            .with_radii(self.lines.iter().map(|(.., radius)| *radius));
        stream.log_static(format!("{entity}/lines"), &lines)?;
        let texts = Points2D::new(self.texts.iter().map(|(at, ..)| *at))
            .with_labels(self.texts.iter().map(|(_, text, ..)| text.as_str()))
            .with_colors(self.texts.iter().map(|(_, _, color, _)| rgb(*color)))
            .with_radii(self.texts.iter().map(|(.., radius)| *radius))
            .with_show_labels(true);
        stream.log_static(format!("{entity}/texts"), &texts)
    }
}

fn rgb([r, g, b]: [u8; 3]) -> Color {
    Color::from_rgb(r, g, b)
}
