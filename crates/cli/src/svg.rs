//! Line charts as SVG.

use std::fmt::Write;

use truecut_recording::significant;

/// A chart with curves over a common axis.
pub struct Chart {
    pub x_label: String,
    pub y_label: String,
    pub curves: Vec<Curve>,
}

/// A labelled curve; points without a value are left out.
pub struct Curve {
    pub label: String,
    pub points: Vec<(f64, f64)>,
}

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 360.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 330.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 50.0;
const TITLE: f64 = 40.0;

/// Colours that stay apart also for colour-blind readers (Okabe and Ito).
const COLOURS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000",
];

/// Charts below one another, with a title.
pub fn charts(title: &str, charts: &[Chart]) -> String {
    let height = TITLE + HEIGHT * charts.len() as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" \
         viewBox=\"0 0 {WIDTH} {height}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{LEFT}\" y=\"26\" font-size=\"16\">{}</text>\n",
        escape(title)
    );
    for (index, chart) in charts.iter().enumerate() {
        let offset = TITLE + HEIGHT * index as f64;
        let _ = writeln!(svg, "<g transform=\"translate(0,{offset})\">");
        draw(chart, &mut svg);
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    svg
}

/// The range of the finite values, widened to something that can be drawn.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    match (low, high) {
        (low, high) if low < high => (low, high),
        (low, _) if low.is_finite() => (
            low - 0.5 * low.abs().max(1.0),
            low + 0.5 * low.abs().max(1.0),
        ),
        _ => (0.0, 1.0),
    }
}

/// Round values that cover the range with about five steps.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / 5.0;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * power)
        .into_iter()
        .find(|step| *step >= rough)
        .unwrap_or(rough);
    let first = (low / step).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|index| index as f64 * step).collect()
}

fn draw(chart: &Chart, svg: &mut String) {
    let points = || chart.curves.iter().flat_map(|curve| &curve.points);
    let (x_low, x_high) = range(points().map(|point| point.0));
    let (y_low, y_high) = range(points().map(|point| point.1).chain(std::iter::once(0.0)));
    let (plot_width, plot_height) = (WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM);
    let x = |value: f64| LEFT + (value - x_low) / (x_high - x_low) * plot_width;
    let y = |value: f64| TOP + (y_high - value) / (y_high - y_low) * plot_height;
    let (bottom, right) = (TOP + plot_height, LEFT + plot_width);
    for tick in ticks(x_low, x_high) {
        let at = x(tick);
        let _ = writeln!(
            svg,
            "<path d=\"M{at:.1} {TOP}V{bottom}\" stroke=\"#ddd\"/>\
             <text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            bottom + 18.0,
            short_number(tick)
        );
    }
    for tick in ticks(y_low, y_high) {
        let at = y(tick);
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {at:.1}H{right}\" stroke=\"#ddd\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            LEFT - 6.0,
            at + 4.0,
            short_number(tick)
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\
         <text x=\"{LEFT}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
        LEFT + 0.5 * plot_width,
        bottom + 38.0,
        escape(&chart.x_label),
        TOP - 10.0,
        escape(&chart.y_label)
    );
    let count = chart.curves.len();
    for (index, curve) in chart.curves.iter().enumerate() {
        let pen = Pen {
            colour: COLOURS[index % COLOURS.len()],
            wideness: (count - 1 - index).min(5) as f64,
            row: index as f64,
        };
        draw_curve(curve, &pen, right, &x, &y, svg);
    }
}

/// How a curve is drawn. Earlier curves are wider, so that one that a later one covers still shows.
struct Pen {
    colour: &'static str,
    wideness: f64,
    row: f64,
}

fn draw_curve(
    curve: &Curve,
    pen: &Pen,
    right: f64,
    x: &dyn Fn(f64) -> f64,
    y: &dyn Fn(f64) -> f64,
    svg: &mut String,
) {
    let colour = pen.colour;
    let (width, radius) = (1.5 + 1.5 * pen.wideness, 3.0 + pen.wideness);
    let mut path = String::new();
    let mut pen_down = false;
    for &(px, py) in &curve.points {
        if !(px.is_finite() && py.is_finite()) {
            pen_down = false;
            continue;
        }
        let (px, py) = (x(px), y(py));
        let _ = write!(path, "{}{px:.1} {py:.1}", if pen_down { 'L' } else { 'M' });
        pen_down = true;
        let _ = writeln!(
            svg,
            "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"{radius}\" fill=\"{colour}\"/>"
        );
    }
    let legend_y = TOP + 8.0 + 20.0 * pen.row;
    let _ = writeln!(
        svg,
        "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>\
         <path d=\"M{:.1} {legend_y:.1}h18\" stroke=\"{colour}\" stroke-width=\"{width}\"/>\
         <text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
        right + 12.0,
        right + 36.0,
        legend_y + 4.0,
        escape(&curve.label)
    );
}

/// Four digits without zeros at the end.
pub fn short_number(value: f64) -> String {
    let text = significant(value, 4);
    if text.contains('.') && !text.contains('e') {
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    text
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let near = |found: Vec<f64>, wanted: &[f64]| {
            assert_eq!(found.len(), wanted.len(), "{found:?}");
            assert!(
                found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12),
                "{found:?}"
            );
        };
        near(ticks(0.0, 1.0), &[0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        near(ticks(0.12, 0.31), &[0.15, 0.2, 0.25, 0.3]);
        assert_eq!(short_number(0.2), "0.2");
        assert_eq!(short_number(300.0), "300");
    }

    #[test]
    fn a_gap_breaks_the_curve_and_text_is_escaped() {
        let points = vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0), (3.0, 4.0)];
        let curve = Curve {
            label: "a < b".into(),
            points,
        };
        let chart = Chart {
            x_label: "x".into(),
            y_label: "y".into(),
            curves: vec![curve],
        };
        let svg = charts("t & u", &[chart]);
        let path = svg
            .lines()
            .find(|line| line.contains("fill=\"none\""))
            .unwrap();
        let path = path.split('"').nth(1).unwrap();
        assert_eq!(
            (path.matches('M').count(), path.matches('L').count()),
            (2, 1),
            "{path}"
        );
        assert!(svg.contains("a &lt; b") && svg.contains("t &amp; u"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}
