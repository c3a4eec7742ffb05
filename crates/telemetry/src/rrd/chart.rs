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
const ACROSS: [f64; 2] = [-64.0, 780.0];
/// What it must show down: the drawing, with room for the labels above and below.
pub(super) const DOWN: [f64; 2] = [-36.0, 244.0];
/// A legend of names no longer than this stands beside the drawing, where it hides no curve.
const SHORT_NAME: usize = 20;
/// How much wider the view is for it.
const LEGEND: f64 = 170.0;
/// Height of a row of a legend.
const ROW: f32 = 27.0;
/// The viewer hangs a label below its point, by so much of the view's width where that is as wide
/// as in our layouts: the point is put higher by it, so that the label's middle is at its place.
const HANGS: f32 = 0.0175;
/// A dash and the gap behind it, in the drawing's units.
const DASH: [f32; 2] = [9.0, 6.0];

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
    /// How points are joined.
    pub style: CurveStyle,
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CurveStyle {
    /// A line.
    #[default]
    Line,
    /// A broken line.
    Dashed,
    /// Its points, not joined.
    Dots,
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
    /// The curves are logarithms (base 10): the vertical axis is numbered with what they are of.
    pub logarithmic: bool,
    /// Drawn in this order.
    pub curves: Vec<Curve>,
}

/// The chart in lines and texts: two entities, however much there is to see.
struct Drawing {
    x: Axis,
    y: Axis,
    lines: Vec<(Vec<[f32; 2]>, [u8; 3], Radius)>,
    texts: Vec<([f32; 2], String, [u8; 3], Radius)>,
    /// How far below its point a label hangs.
    hangs: f32,
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

    /// The middle of that half, as a share of the width, in which the curves are lower.
    fn lower_side(&self, drawing: &Drawing) -> f32 {
        let places = self.curves.iter().flat_map(|curve| &curve.points);
        let highest = |half: std::ops::Range<f64>| {
            let within = places.clone().filter(|(x, _)| {
                let place = drawing.x.place(*x);
                place.is_some_and(|place| half.contains(&place))
            });
            within.fold(f64::NEG_INFINITY, |highest, (_, y)| highest.max(*y))
        };
        match highest(0.46..0.9) <= highest(0.1..0.54) {
            true => 0.68,
            false => 0.32,
        }
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
            hangs: HANGS * (self.across()[1] - self.across()[0]) as f32,
        };
        drawing.axes(self);
        let left = match self.has_legend_beside() {
            true => WIDTH + 0.55 * LEGEND as f32,
            false => WIDTH * self.lower_side(&drawing),
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

    /// A text whose middle is there.
    fn text(&mut self, [across, down]: [f32; 2], text: String, color: [u8; 3]) {
        let at = [across, down - self.hangs];
        self.texts
            .push((at, text, color, Radius::new_ui_points(0.0)));
    }

    fn axes(&mut self, chart: &Chart) {
        let thin = Radius::new_ui_points(0.5);
        let (x_low, y_low) = (self.x.ends().0, self.y.ends().0);
        for tick in self.x.ticks.clone() {
            let Some([across, _]) = self.place(tick, y_low) else {
                continue;
            };
            self.lines
                .push((vec![[across, 0.0], [across, HEIGHT]], DARK, thin));
            self.text([across, HEIGHT + 15.0], self.x.label(tick), GREY);
        }
        let numbers = match chart.logarithmic {
            true => self.y.numbers_of_logarithms(),
            false => (self.y.ticks.iter())
                .map(|tick| (*tick, self.y.label(*tick)))
                .collect(),
        };
        for (tick, number) in numbers {
            let Some([_, down]) = self.place(x_low, tick) else {
                continue;
            };
            self.lines
                .push((vec![[0.0, down], [WIDTH, down]], DARK, thin));
            // Long numbers end where short ones do.
            let left = -8.0 - 4.0 * number.chars().count() as f32;
            self.text([left, down], number, GREY);
        }
        let below = [0.5 * WIDTH, HEIGHT + 40.0];
        self.text(below, chart.x_label.clone(), WHITE);
        self.text([0.25 * WIDTH, -18.0], chart.y_label.clone(), WHITE);
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
            let thin = Radius::new_ui_points(1.0);
            match curve.style {
                _ if line.len() < 2 => {}
                CurveStyle::Line => lines.push((line, color, thin)),
                CurveStyle::Dashed => {
                    lines.extend(dashes(&line).into_iter().map(|dash| (dash, color, thin)));
                }
                CurveStyle::Dots => {}
            }
        }
        self.lines.extend(lines);
        let dots = curve.points.iter();
        let dots = dots.filter(|_| curve.style == CurveStyle::Dots);
        let marked = curve.marks.iter().map(|(x, y, _)| (*x, *y));
        for (x, y) in dots.copied().chain(marked) {
            if let Some(at) = self.place(x, y) {
                let dot = Radius::new_ui_points(4.0);
                self.texts.push((at, String::new(), color, dot));
            }
        }
        for (x, y, text) in &curve.marks {
            if let Some([across, down]) = self.place(*x, *y) {
                // Beside the dot: below it the name would hide the peak.
                let beside = 14.0 + 4.2 * text.chars().count() as f32;
                let side = if across > 0.8 * WIDTH {
                    -beside
                } else {
                    beside
                };
                self.text([across + side, down], text.clone(), color);
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

/// The dashes of a line: the viewer has no pattern of its own.
fn dashes(line: &[[f32; 2]]) -> Vec<Vec<[f32; 2]>> {
    let [dash, gap] = DASH;
    let mut found = vec![vec![line[0]]];
    // How far into a dash and its gap the line is.
    let mut at = 0.0;
    for ends in line.windows(2) {
        let [from, to] = [ends[0], ends[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut done = 0.0;
        while done < length {
            let is_drawn = at < dash;
            let step = (if is_drawn { dash } else { dash + gap } - at).min(length - done);
            done += step.max(1e-3);
            at += step.max(1e-3);
            let share = (done / length).min(1.0);
            let point = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
            if is_drawn && let Some(last) = found.last_mut() {
                last.push(point);
            }
            if at >= dash + gap {
                at = 0.0;
                found.push(vec![point]);
            }
        }
    }
    found.retain(|dash| dash.len() > 1);
    found
}

fn rgb([r, g, b]: [u8; 3]) -> Color {
    Color::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nine of every fifteen units of a line are drawn, in pieces that all lie on it, however it is
    /// divided.
    #[test]
    fn a_broken_line_is_drawn_in_dashes_of_one_length() {
        for pieces in [1_u8, 7, 250] {
            let line: Vec<[f32; 2]> = (0..=pieces)
                .map(|k| [297.0 * f32::from(k) / f32::from(pieces), 5.0])
                .collect();
            let found = dashes(&line);
            assert_eq!(found.len(), 20, "{pieces}");
            let drawn: f32 = found
                .iter()
                .map(|dash| dash[dash.len() - 1][0] - dash[0][0])
                .sum();
            assert!((drawn - 20.0 * 9.0).abs() < 0.5, "{drawn}");
            assert!(found.iter().flatten().all(|point| point[1] == 5.0));
        }
    }

    /// A legend of long names stands over the half in which there is less.
    #[test]
    fn a_legend_stands_off_the_peak() {
        for (peak, expected) in [(10.0, 0.68), (75.0, 0.32), (60.0, 0.32), (99.0, 0.68)] {
            let points =
                (0..=100).map(|k| (f64::from(k), if f64::from(k) == peak { 1.0 } else { 0.1 }));
            let curve = Curve {
                name: "along [µm]: 299.99 Hz (22.8)".into(),
                color: GREY,
                points: points.collect(),
                marks: Vec::new(),
                style: CurveStyle::Line,
            };
            let chart = Chart {
                title: String::new(),
                x_label: String::new(),
                y_label: String::new(),
                least_y: f64::NAN,
                logarithmic: false,
                curves: vec![curve],
            };
            let drawing = Drawing {
                x: Axis::around([0.0, 100.0].into_iter(), 10),
                y: Axis::around([0.0, 1.0].into_iter(), 5),
                lines: Vec::new(),
                texts: Vec::new(),
                hangs: 0.0,
            };
            assert_eq!(chart.lower_side(&drawing), expected, "{peak}");
        }
    }
}
