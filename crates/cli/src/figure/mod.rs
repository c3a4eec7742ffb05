//! Figures as SVG: panels of curves over numbered axes, drawn by plotters.

mod axis;
mod charts;
mod draw;

pub use axis::Scale;
pub use charts::charts_of;

use std::fmt;

/// Panels in rows below a title.
pub struct Figure {
    pub title: String,
    pub panels: Vec<Panel>,
    /// Panels beside one another.
    pub columns: usize,
    pub legend: Legend,
}

/// Where the legends of the panels stand.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Legend {
    /// In a row above the panel: for few, short labels.
    Above,
    /// Beside the panel.
    Beside,
}

/// Curves over common axes.
#[derive(Clone, Default)]
pub struct Panel {
    pub title: String,
    pub x_label: String,
    pub y_label: String,
    pub x_scale: Scale,
    pub y_scale: Scale,
    /// Drawn in this order, so that later ones lie on top.
    pub layers: Vec<Layer>,
}

/// One set of points.
#[derive(Clone, Default)]
pub struct Layer {
    /// In the legend; none if empty.
    pub label: String,
    pub points: Vec<(f64, f64)>,
    pub style: Style,
    /// Number of the colour; layers of one colour belong together.
    pub colour: usize,
}

/// How points are drawn. Points without a place on the axes (NaN, zero on a logarithmic axis) are left
/// out, and break a line.
#[derive(Clone, Default)]
pub enum Style {
    #[default]
    Line,
    /// A line as wide as this, px, with dots.
    Dotted(u32),
    Dashed,
    /// Small, pale dots.
    Cloud,
    /// Dots with bars of this half-length, joined by a thin line.
    Bars(Vec<f64>),
    /// Circles with a text beside each.
    Marks(Vec<String>),
    /// Rectangles about the points, from −1 (orange) over 0 (white) to 1 (blue); NaN leaves one out. Axes must be linear.
    Cells {
        /// Width and height in the units of the axes.
        size: (f64, f64),
        /// One value for each point.
        shades: Vec<f64>,
    },
}

impl Figure {
    /// The figure as SVG.
    pub fn to_svg(&self) -> String {
        let mut svg = String::new();
        // Fails only if something cannot be drawn into memory; what is there then is still a figure.
        let _ = draw::draw(self, &mut svg);
        svg
    }
}

/// At most `count` points of a curve over ascending x: the smallest and largest of every stretch.
pub fn thinned(points: impl ExactSizeIterator<Item = (f64, f64)>, count: usize) -> Vec<(f64, f64)> {
    let stretch = (2 * points.len()).div_ceil(count.max(2)).max(1);
    let all: Vec<(f64, f64)> = points.collect();
    if stretch <= 2 {
        return all;
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
        // A gap in the stretch is kept.
        let gap = part.iter().find(|point| !point.1.is_finite());
        rows.into_iter()
            .map(|row| part[row])
            .chain(gap.copied())
            .collect::<Vec<_>>()
    };
    all.chunks(stretch).flat_map(ends).collect()
}

/// Four digits without zeros at the end.
pub fn short_number(value: f64) -> String {
    let text = truecut_recording::significant(value, 4);
    if text.contains('.') && !text.contains('e') {
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    text
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

    #[test]
    fn numbers_are_short() {
        let numbers = [0.2, 300.0].map(short_number);
        assert_eq!(numbers, ["0.2", "300"]);
    }
}
