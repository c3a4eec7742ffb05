//! Figures as SVG: panels of curves over numbered axes, drawn by plotters.

mod axis;
mod charts;
mod colour;
mod draw;

pub use axis::Scale;
pub use charts::charts_of;
pub use colour::ColourScale;

use std::fmt;

/// Indices of colours of layers, the same in the figure and in the viewer.
pub const BLUE: usize = 0;
pub const ORANGE: usize = 1;
pub const GREEN: usize = 2;
pub const PINK: usize = 3;
pub const BLACK: usize = 6;

/// Panels in rows below a title.
pub struct Figure {
    pub title: String,
    pub panels: Vec<Panel>,
    /// Panels in each row.
    pub columns: usize,
    pub legend: Legend,
}

/// Where the legends of the panels are placed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Legend {
    /// In a row above the panel: for few, short labels.
    Above,
    /// To the right of the panel.
    Right,
}

/// Curves over common axes.
#[derive(Clone, Default)]
pub struct Panel {
    pub title: String,
    pub x_label: String,
    pub y_label: String,
    pub x_scale: Scale,
    pub y_scale: Scale,
    /// Drawn in this order, later ones on top.
    pub layers: Vec<Layer>,
    /// What the shades of its cells mean, on a page.
    pub scale: Option<ColourScale>,
    /// Both axes are of one scale, on a page, as far as it has room.
    pub even: bool,
}

/// One set of points.
#[derive(Clone, Default)]
pub struct Layer {
    /// Label in the legend; no entry if empty.
    pub label: String,
    pub points: Vec<(f64, f64)>,
    pub style: Style,
    /// Index of the colour; related layers share one.
    pub colour: usize,
}

/// How points are drawn. Points that the axes cannot show (NaN, zero on a logarithmic axis) are
/// skipped and break a line.
#[derive(Clone, Default)]
pub enum Style {
    #[default]
    Line,
    /// A line of this width, px, with dots.
    Dotted(u32),
    Dashed,
    /// Small, pale dots.
    Cloud,
    /// Dots with bars of this half-length, joined by a thin line.
    Bars(Vec<f64>),
    /// The area between the points and these lower values.
    Band(Vec<f64>),
    /// Circles, each with a label.
    Marks(Vec<String>),
    /// Rectangles around the points, from −1 (orange) over 0 (white) to 1 (blue); NaN is not drawn.
    /// Axes must be linear.
    Cells {
        /// Width and height in the units of the axes.
        size: (f64, f64),
        /// One value for each point.
        shades: Vec<f64>,
    },
}

/// Where something is drawn, in the units of the axes.
pub trait Points: IntoIterator<Item = (f64, f64)> {}

impl<T: IntoIterator<Item = (f64, f64)>> Points for T {}

impl Panel {
    /// Layers over linear axes.
    pub fn new(
        title: impl Into<String>,
        x_label: impl Into<String>,
        y_label: impl Into<String>,
        layers: Vec<Layer>,
    ) -> Panel {
        Panel {
            title: title.into(),
            x_label: x_label.into(),
            y_label: y_label.into(),
            layers,
            ..Panel::default()
        }
    }

    /// With axes of one scale, on a page.
    pub fn evenly(self) -> Panel {
        Panel { even: true, ..self }
    }

    /// With a logarithmic vertical axis.
    pub fn logarithmic(self) -> Panel {
        Panel {
            y_scale: Scale::Logarithmic,
            ..self
        }
    }
}

impl Layer {
    /// Points drawn in a style and a colour; without an entry in the legend if the label is empty.
    pub fn new(
        label: impl Into<String>,
        points: impl Points,
        style: Style,
        colour: usize,
    ) -> Layer {
        Layer {
            label: label.into(),
            points: points.into_iter().collect(),
            style,
            colour,
        }
    }

    pub fn line(label: impl Into<String>, points: impl Points, colour: usize) -> Layer {
        Layer::new(label, points, Style::Line, colour)
    }

    pub fn dashed(label: impl Into<String>, points: impl Points, colour: usize) -> Layer {
        Layer::new(label, points, Style::Dashed, colour)
    }

    /// Circles without labels.
    pub fn circles(label: &str, points: impl Points, colour: usize) -> Layer {
        let points: Vec<(f64, f64)> = points.into_iter().collect();
        let style = Style::Marks(vec![String::new(); points.len()]);
        Layer::new(label, points, style, colour)
    }

    /// Shaded rectangles of this size around points; they carry their own colours.
    pub fn cells(size: (f64, f64), shaded: impl Iterator<Item = ((f64, f64), f64)>) -> Layer {
        let (points, shades): (Vec<_>, _) = shaded.unzip();
        Layer::new("", points, Style::Cells { size, shades }, BLUE)
    }
}

impl Figure {
    /// The figure as SVG.
    pub fn to_svg(&self) -> String {
        let mut svg = String::new();
        // Drawing into memory fails only in part; what was drawn is still a figure.
        let _ = draw::draw(self, &mut svg);
        svg
    }
}

/// At most `count` points of a curve over ascending x: minimum and maximum of each interval.
pub fn thinned(points: impl Points, count: usize) -> Vec<(f64, f64)> {
    let mut points = points.into_iter();
    let len = match points.size_hint() {
        (least, Some(most)) if least == most => least,
        _ => return thinned(points.collect::<Vec<_>>(), count),
    };
    let stretch = (2 * len).div_ceil(count.max(2)).max(1);
    if stretch <= 2 {
        return points.collect();
    }
    let ends = |part: &[(f64, f64)]| {
        let pick = |worse: fn(f64, f64) -> bool| {
            (0..part.len()).reduce(|best, i| {
                if worse(part[best].1, part[i].1) {
                    i
                } else {
                    best
                }
            })
        };
        let (low, high) = (pick(|a, b| b < a), pick(|a, b| b > a));
        let mut rows: Vec<usize> = low.into_iter().chain(high).collect();
        rows.sort_unstable();
        rows.dedup();
        // A gap in the interval is kept.
        let gap = part.iter().find(|point| !point.1.is_finite());
        rows.into_iter()
            .map(|row| part[row])
            .chain(gap.copied())
            .collect::<Vec<_>>()
    };
    // Interval by interval: of a long run all points would take more than its rows.
    let mut kept = Vec::new();
    let mut part = Vec::with_capacity(stretch);
    loop {
        part.clear();
        part.extend(points.by_ref().take(stretch));
        if part.is_empty() {
            return kept;
        }
        kept.extend(ends(&part));
    }
}

/// Largest size of the values that are finite, 0 without any.
pub fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values
        .filter(|value| value.is_finite())
        .fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

impl fmt::Debug for Figure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "figure \"{}\" of {} panels",
            self.title,
            self.panels.len()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(points: &[(f64, f64)], style: Style, x_scale: Scale) -> String {
        let layer = Layer {
            label: "a < b".into(),
            points: points.to_vec(),
            style,
            colour: 0,
        };
        let panel = Panel {
            title: "t & u".into(),
            layers: vec![layer],
            x_scale,
            ..Panel::default()
        };
        Figure {
            title: "all".into(),
            panels: vec![panel],
            columns: 1,
            legend: Legend::Above,
        }
        .to_svg()
    }

    #[test]
    fn a_gap_breaks_the_curve_and_text_is_escaped() {
        let points = [
            (0.0, 1.0),
            (1.0, 2.0),
            (2.0, f64::NAN),
            (3.0, 3.0),
            (4.0, 4.0),
        ];
        let svg = figure(&points, Style::Line, Scale::Linear);
        let thick = svg.matches("stroke-width=\"2\"").count();
        assert_eq!(thick, 3, "two strips and the legend\n{svg}");
        assert!(svg.contains("a &lt; b") && svg.contains("t &amp; u"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn what_a_logarithmic_axis_cannot_hold_is_left_out() {
        let points = [(0.0, 1.0), (1.0, 10.0), (10.0, 100.0)];
        let svg = figure(&points, Style::Cloud, Scale::Logarithmic);
        assert_eq!(
            svg.matches("<circle").count(),
            3,
            "two dots and one in the legend\n{svg}"
        );
    }

    #[test]
    fn cells_of_one_shade_are_drawn_as_one() {
        let points = [(0.0, 0.0), (0.0, 1.0), (0.0, 2.0), (1.0, 0.0), (1.0, 1.0)];
        let shades = vec![0.5, 0.5, -0.5, f64::NAN, 0.5];
        let size = (1.0, 1.0);
        let svg = figure(&points, Style::Cells { size, shades }, Scale::Linear);
        // Background, three cells, and the sample in the legend.
        assert_eq!(svg.matches("<rect").count(), 5, "{svg}");
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn nothing_is_a_figure_too() {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            let svg = figure(&[], Style::Line, scale);
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{svg}");
        }
    }

    #[test]
    fn thinning_keeps_peaks_and_gaps() {
        let mut values = vec![0.0; 1000];
        values[503] = 7.0;
        values[704] = -3.0;
        values[900] = f64::NAN;
        let points = thinned(values.iter().enumerate().map(|(i, y)| (i as f64, *y)), 100);
        assert!(points.len() <= 120, "{}", points.len());
        assert!(points.contains(&(503.0, 7.0)) && points.contains(&(704.0, -3.0)));
        assert!(points.iter().any(|point| point.1.is_nan()));
        assert!(points.is_sorted_by(|a, b| a.0 <= b.0 || b.1.is_nan()));
    }
}
