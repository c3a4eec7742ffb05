//! Plots as SVG, for results that are not a run: what a sweep comes to.
//!
//! Written by hand rather than by a plotting library: it takes two hundred lines, adds nothing to
//! the build, and equal curves give equal bytes.

use std::fmt::Write;
use std::path::Path;

use crate::axis::Axis;
pub use crate::axis::Scale;
use crate::error::FileError;

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Style {
    /// A line.
    #[default]
    Line,
    /// A dashed line, for a theory beside a result.
    Dashed,
    /// Dots, for single results.
    Dots,
    /// Dots joined by a line.
    LineAndDots,
}

/// A named curve. Points with a NaN, or that a logarithmic axis cannot hold, break the line.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Curve {
    /// In the legend.
    pub name: String,
    /// In the units of the axes.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub style: Style,
}

/// A plot with a title, axes and a legend.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Plot {
    /// Above it.
    pub title: String,
    /// Along the horizontal axis, with its unit: `friction coefficient [1]`.
    pub x_label: String,
    /// Along the vertical axis, with its unit: `pressure [MPa]`.
    pub y_label: String,
    /// Of the horizontal axis.
    pub x_scale: Scale,
    /// Of the vertical axis.
    pub y_scale: Scale,
    /// What is plotted.
    pub curves: Vec<Curve>,
}

/// Size of the picture, px.
const SIZE: (f64, f64) = (900.0, 560.0);
/// Left, top, right and bottom edge of the drawing, px.
const FRAME: [f64; 4] = [86.0, 52.0, 876.0, 488.0];
/// Told apart also by those who see no difference between red and green.
const COLORS: [&str; 8] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f",
];

/// Writes a plot with linear axes.
///
/// # Errors
/// A file that cannot be written.
pub fn plot_curves(
    path: &Path,
    title: &str,
    x_label: &str,
    y_label: &str,
    curves: &[Curve],
) -> Result<(), FileError> {
    let plot = Plot {
        title: title.to_owned(),
        x_label: x_label.to_owned(),
        y_label: y_label.to_owned(),
        curves: curves.to_vec(),
        ..Plot::default()
    };
    plot.write_svg(path)
}

impl Plot {
    /// Writes the plot.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_svg(&self, path: &Path) -> Result<(), FileError> {
        std::fs::write(path, self.to_svg()).map_err(|error| FileError::new(path, error))
    }

    /// The plot as SVG.
    pub fn to_svg(&self) -> String {
        let all = |pick: fn(&(f64, f64)) -> f64| {
            self.curves
                .iter()
                .flat_map(move |curve| curve.points.iter().map(pick))
        };
        let x = Axis::around(all(|point| point.0), self.x_scale, 8);
        let y = Axis::around(all(|point| point.1), self.y_scale, 7);
        let (width, height) = SIZE;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" font-family=\"sans-serif\" font-size=\"14\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        self.axes(&mut svg, &x, &y);
        for (index, curve) in self.curves.iter().enumerate() {
            draw(&mut svg, curve, COLORS[index % COLORS.len()], &x, &y);
        }
        self.legend(&mut svg, &x, &y);
        svg += "</svg>\n";
        svg
    }

    fn axes(&self, svg: &mut String, x: &Axis, y: &Axis) {
        let [left, top, right, bottom] = FRAME;
        for tick in &x.ticks {
            let Some((across, _)) = pixel(x, y, (*tick, y.ends().0)) else {
                continue;
            };
            line(svg, [across, top, across, bottom], "#dddddd");
            text(svg, (across, bottom + 20.0), "middle", &x.label(*tick));
        }
        for tick in &y.ticks {
            let Some((_, down)) = pixel(x, y, (x.ends().0, *tick)) else {
                continue;
            };
            line(svg, [left, down, right, down], "#dddddd");
            text(svg, (left - 8.0, down + 5.0), "end", &y.label(*tick));
        }
        let (wide, high) = (right - left, bottom - top);
        push(
            svg,
            format_args!(
                "<rect x=\"{left}\" y=\"{top}\" width=\"{wide}\" height=\"{high}\" fill=\"none\" stroke=\"#444444\"/>"
            ),
        );
        let middle = (0.5 * (left + right), 0.5 * (top + bottom));
        text(svg, (middle.0, bottom + 48.0), "middle", &self.x_label);
        push(
            svg,
            format_args!(
                "<text transform=\"translate(22 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
                middle.1,
                escaped(&self.y_label)
            ),
        );
        push(
            svg,
            format_args!(
                "<text x=\"{:.1}\" y=\"30\" text-anchor=\"middle\" font-size=\"17\" font-weight=\"bold\">{}</text>",
                middle.0,
                escaped(&self.title)
            ),
        );
    }

    /// In the corner of the drawing that holds the fewest points.
    fn legend(&self, svg: &mut String, x: &Axis, y: &Axis) {
        let [left, top, right, bottom] = FRAME;
        let longest = self
            .curves
            .iter()
            .map(|curve| curve.name.chars().count())
            .max()
            .unwrap_or(0);
        let (wide, high) = (
            58.0 + 7.6 * longest as f64,
            14.0 + 22.0 * self.curves.len() as f64,
        );
        let corners = [
            (left + 10.0, top + 10.0),
            (right - wide - 10.0, top + 10.0),
            (right - wide - 10.0, bottom - high - 10.0),
            (left + 10.0, bottom - high - 10.0),
        ];
        let points = || {
            self.curves
                .iter()
                .flat_map(|curve| &curve.points)
                .filter_map(|p| pixel(x, y, *p))
        };
        let hidden = |corner: &(f64, f64)| {
            points()
                .filter(|p| in_range(p.0, corner.0, wide) && in_range(p.1, corner.1, high))
                .count()
        };
        let Some((at_x, at_y)) = corners.into_iter().min_by_key(hidden) else {
            return;
        };
        push(
            svg,
            format_args!(
                "<rect x=\"{at_x:.1}\" y=\"{at_y:.1}\" width=\"{wide:.1}\" height=\"{high:.1}\" fill=\"white\" \
             fill-opacity=\"0.85\" stroke=\"#bbbbbb\"/>"
            ),
        );
        for (row, curve) in self.curves.iter().enumerate() {
            let down = at_y + 18.0 + 22.0 * row as f64;
            let sample = [(at_x + 10.0, down), (at_x + 38.0, down)];
            draw_points(svg, curve.style, COLORS[row % COLORS.len()], &sample);
            text(svg, (at_x + 46.0, down + 5.0), "start", &curve.name);
        }
    }
}

fn in_range(value: f64, from: f64, width: f64) -> bool {
    (from..=from + width).contains(&value)
}

fn draw(svg: &mut String, curve: &Curve, color: &str, x: &Axis, y: &Axis) {
    for strip in curve.points.split(|point| pixel(x, y, *point).is_none()) {
        let pixels: Vec<(f64, f64)> = strip
            .iter()
            .filter_map(|point| pixel(x, y, *point))
            .collect();
        draw_points(svg, curve.style, color, &pixels);
    }
}

fn draw_points(svg: &mut String, style: Style, color: &str, pixels: &[(f64, f64)]) {
    if style != Style::Dots && pixels.len() > 1 {
        let dash = if style == Style::Dashed {
            " stroke-dasharray=\"7 5\""
        } else {
            ""
        };
        let places: Vec<String> = pixels
            .iter()
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        push(
            svg,
            format_args!(
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"{dash}/>",
                places.join(" ")
            ),
        );
    }
    if matches!(style, Style::Dots | Style::LineAndDots) {
        for (x, y) in pixels {
            push(
                svg,
                format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{color}\"/>"),
            );
        }
    }
}

fn pixel(x: &Axis, y: &Axis, point: (f64, f64)) -> Option<(f64, f64)> {
    let [left, top, right, bottom] = FRAME;
    let (across, up) = (x.place(point.0)?, y.place(point.1)?);
    Some((left + across * (right - left), bottom - up * (bottom - top)))
}

fn line(svg: &mut String, [x1, y1, x2, y2]: [f64; 4], color: &str) {
    push(
        svg,
        format_args!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{color}\"/>"
        ),
    );
}

fn text(svg: &mut String, (x, y): (f64, f64), anchor: &str, words: &str) {
    push(
        svg,
        format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>",
            escaped(words)
        ),
    );
}

fn push(svg: &mut String, element: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(svg, "{element}");
}

fn escaped(words: &str) -> String {
    words
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, f64)], style: Style) -> Curve {
        Curve {
            name: "exact < paper & co".into(),
            points: points.to_vec(),
            style,
        }
    }

    #[test]
    fn verify_points_land_where_the_axes_say() {
        let plot = Plot {
            curves: vec![curve(&[(0.0, 0.0), (10.0, 100.0)], Style::Line)],
            ..Plot::default()
        };
        let [left, top, right, bottom] = FRAME;
        let expected = format!("points=\"{left:.1},{bottom:.1} {right:.1},{top:.1}\"");
        assert!(plot.to_svg().contains(&expected), "{}", plot.to_svg());
    }

    #[test]
    fn names_are_escaped_and_in_the_legend() {
        let plot = Plot {
            title: "a & b".into(),
            curves: vec![curve(&[(0.0, 1.0), (1.0, 2.0)], Style::Dashed)],
            ..Plot::default()
        };
        let svg = plot.to_svg();
        assert!(svg.contains("exact &lt; paper &amp; co") && svg.contains("a &amp; b"));
        assert_eq!(
            svg.matches("stroke-dasharray").count(),
            2,
            "the curve and its sample in the legend"
        );
    }

    #[test]
    fn what_cannot_be_drawn_breaks_the_line() {
        let points = [
            (1.0, 1.0),
            (2.0, 2.0),
            (3.0, f64::NAN),
            (4.0, 4.0),
            (5.0, 5.0),
        ];
        let plot = Plot {
            curves: vec![curve(&points, Style::Line)],
            ..Plot::default()
        };
        assert_eq!(
            plot.to_svg().matches("<polyline").count(),
            3,
            "two strips and the legend"
        );
        let points = [(0.0, 1.0), (1.0, 10.0), (10.0, 100.0)];
        let curves = vec![curve(&points, Style::Dots)];
        let plot = Plot {
            x_scale: Scale::Logarithmic,
            curves,
            ..Plot::default()
        };
        assert_eq!(
            plot.to_svg().matches("<circle").count(),
            4,
            "zero has no logarithm; two dots in the legend"
        );
    }

    #[test]
    fn a_file_that_cannot_be_written_is_named() {
        let error = plot_curves(Path::new("/nowhere/plot.svg"), "", "", "", &[]).unwrap_err();
        assert!(
            error.to_string().starts_with("/nowhere/plot.svg: "),
            "{error}"
        );
    }
}
