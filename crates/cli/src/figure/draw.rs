//! Drawing by plotters.

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Axis;
use super::{Figure, Layer, Legend, Panel, Style};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Coordinates = Cartesian2d<Axis, Axis>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Coordinates>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Size of a panel, px.
const PANEL: (u32, u32) = (640, 380);
/// Width of a legend to the right of a panel, px.
const LEGEND_WIDTH: u32 = 330;
const TITLE: u32 = 44;
/// Colours that colour-blind readers can distinguish (Okabe and Ito).
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (value - self.low) / (self.high - self.low);
        from + (share * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, tick: &f64) -> String {
        self.label(*tick)
    }
}

fn colour(number: usize) -> RGBColor {
    COLOURS[number % COLOURS.len()]
}

pub fn draw(figure: &Figure, svg: &mut String) -> Drawn {
    let columns = figure.columns.max(1);
    let rows = figure.panels.len().div_ceil(columns).max(1);
    let legend = if figure.legend == Legend::Right {
        LEGEND_WIDTH
    } else {
        0
    };
    let (wide, high) = (PANEL.0 + legend, PANEL.1);
    let size = (wide * columns as u32, TITLE + high * rows as u32);
    let root = SVGBackend::with_string(svg, size).into_drawing_area();
    root.fill(&WHITE)?;
    let (head, body) = root.split_vertically(TITLE);
    let style = ("sans-serif", 19).into_font().color(&BLACK);
    head.draw(&Text::new(figure.title.as_str(), (16, 14), style))?;
    for (panel, area) in figure.panels.iter().zip(body.split_evenly((rows, columns))) {
        let (plot, legend) = area.split_horizontally(PANEL.0);
        draw_panel(panel, &plot, figure.legend)?;
        if figure.legend == Legend::Right {
            legend_right(panel, &legend)?;
        }
    }
    root.present()?;
    Ok(())
}

fn draw_panel(panel: &Panel, area: &Area<'_>, legend: Legend) -> Drawn {
    let points = || panel.layers.iter().flat_map(|layer| &layer.points);
    let bars = panel.layers.iter().flat_map(bar_ends);
    let x = Axis::around(points().map(|p| p.0), panel.x_scale, 7);
    let y = Axis::around(points().map(|p| p.1).chain(bars), panel.y_scale, 6);
    let mut chart = ChartBuilder::on(area)
        .margin_top(34)
        .margin_right(20)
        .margin_left(10)
        .margin_bottom(6)
        .x_label_area_size(46)
        .y_label_area_size(72)
        .build_cartesian_2d(x.clone(), y.clone())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 225))
        .axis_style(RGBColor(90, 90, 90))
        .label_style(("sans-serif", 13))
        .axis_desc_style(("sans-serif", 14))
        .x_labels(x.ticks.len().max(2))
        .y_labels(y.ticks.len().max(2))
        .x_desc(panel.x_label.as_str())
        .y_desc(panel.y_label.as_str())
        .draw()?;
    for layer in &panel.layers {
        draw_layer(layer, &mut chart, &x, &y)?;
    }
    let style = ("sans-serif", 15).into_font().color(&BLACK);
    area.draw(&Text::new(panel.title.as_str(), (82, 12), style))?;
    if legend == Legend::Above {
        legend_above(panel, area)
    } else {
        Ok(())
    }
}

/// The ends of error bars and the lower edge of a band, which must fit into the panel too.
fn bar_ends(layer: &Layer) -> Vec<f64> {
    match &layer.style {
        Style::Bars(halves) => {
            let ends = layer.points.iter().zip(halves);
            ends.flat_map(|((_, y), half)| [y - half, y + half])
                .collect()
        }
        Style::Band(lower) => lower.clone(),
        _ => Vec::new(),
    }
}

fn draw_layer(layer: &Layer, chart: &mut Chart<'_, '_>, x: &Axis, y: &Axis) -> Drawn {
    let colour = colour(layer.colour);
    let place = |point: &(f64, f64)| Some((x.place(point.0)?, y.place(point.1)?));
    let strips: Vec<Vec<(f64, f64)>> = layer
        .points
        .split(|point| place(point).is_none())
        .map(|strip| strip.iter().filter_map(place).collect())
        .filter(|strip: &Vec<_>| !strip.is_empty())
        .collect();
    let places = || strips.iter().flatten().copied();
    let dots = |size: i32, style: ShapeStyle| places().map(move |at| Circle::new(at, size, style));
    match &layer.style {
        Style::Line | Style::Dotted(_) => {
            let stroke = line_stroke(layer);
            for strip in &strips {
                chart.draw_series(LineSeries::new(strip.iter().copied(), stroke))?;
            }
            if let Style::Dotted(wide) = layer.style {
                chart.draw_series(dots(2 + wide as i32 / 2, colour.filled()))?;
            }
        }
        Style::Dashed => {
            for strip in &strips {
                let line =
                    DashedLineSeries::new(strip.iter().copied(), 6, 4, colour.stroke_width(2));
                chart.draw_series(line)?;
            }
        }
        Style::Cloud => {
            chart.draw_series(dots(1, colour.mix(0.35).filled()))?;
        }
        Style::Bars(halves) => {
            // Means of bins are not joined if there are only two.
            if layer.points.len() > 2 {
                chart.draw_series(LineSeries::new(places(), colour.stroke_width(1)))?;
            }
            let bars = layer.points.iter().zip(halves).filter_map(|(point, half)| {
                let ends = [point.1 - half, point.1 + half].map(|end| place(&(point.0, end)));
                Some(PathElement::new(
                    [ends[0]?, ends[1]?],
                    colour.stroke_width(2),
                ))
            });
            chart.draw_series(bars)?;
            chart.draw_series(dots(4, colour.filled()))?;
        }
        Style::Band(lower) => {
            let edges = layer.points.iter().zip(lower);
            let edges: Vec<_> = edges
                .map(|(point, low)| Some([place(point)?, place(&(point.0, *low))?]))
                .collect();
            for strip in edges.split(Option::is_none).filter(|strip| strip.len() > 1) {
                let side = |k: usize| strip.iter().flatten().map(move |pair| pair[k]);
                let outline = side(0).chain(side(1).rev()).collect::<Vec<_>>();
                let fill = colour.mix(0.25).filled();
                chart.draw_series([Polygon::new(outline, fill)])?;
            }
        }
        Style::Marks(texts) => {
            chart.draw_series(dots(5, colour.stroke_width(2)))?;
            write_labels(layer, texts, chart, &place)?;
        }
        Style::Cells { size, shades } => draw_cells(layer, *size, shades, chart)?,
    }
    Ok(())
}

/// How an unbroken line is drawn.
fn line_stroke(layer: &Layer) -> ShapeStyle {
    let wide = match layer.style {
        Style::Dotted(wide) => wide,
        _ => 2,
    };
    colour(layer.colour).stroke_width(wide)
}

/// Number of distinct shades.
const SHADES: f64 = 12.0;

/// Rectangles; vertically adjacent ones of one shade are drawn as one.
fn draw_cells(layer: &Layer, size: (f64, f64), shades: &[f64], chart: &mut Chart<'_, '_>) -> Drawn {
    let level = |shade: f64| (shade.clamp(-1.0, 1.0) * SHADES).round();
    let mut cells: Vec<((f64, f64), f64, f64)> = Vec::new();
    for ((x, y), shade) in layer.points.iter().zip(shades) {
        if shade.is_nan() {
            continue;
        }
        let level = level(*shade);
        let low = y - 0.5 * size.1;
        match cells.last_mut() {
            Some(((left, _), top, known))
                if *known == level
                    && (*left - x).abs() < 1e-9
                    && (*top - low).abs() < 0.01 * size.1 =>
            {
                *top = y + 0.5 * size.1;
            }
            _ => cells.push(((*x, low), y + 0.5 * size.1, level)),
        }
    }
    let mixed = |level: f64| {
        let RGBColor(r, g, b) = if level < 0.0 { COLOURS[1] } else { COLOURS[0] };
        let share = 0.75 * (level / SHADES).abs();
        let part = |c: u8| (255.0 - share * (255.0 - f64::from(c))).round() as u8;
        RGBColor(part(r), part(g), part(b))
    };
    // Neighbours overlap slightly, so that no seams show.
    let half = 0.505 * size.0;
    chart.draw_series(cells.into_iter().map(|((x, low), top, level)| {
        Rectangle::new([(x - half, low), (x + half, top)], mixed(level).filled())
    }))?;
    Ok(())
}

/// Pixel of a data point; none if outside the panel.
type Placing<'a> = dyn Fn(&(f64, f64)) -> Option<(f64, f64)> + 'a;

/// A text above each point.
fn write_labels(
    layer: &Layer,
    texts: &[String],
    chart: &mut Chart<'_, '_>,
    place: &Placing<'_>,
) -> Drawn {
    let colour = colour(layer.colour);
    let style = ("sans-serif", 12).into_font().color(&colour);
    let style = style.pos(Pos::new(HPos::Center, VPos::Bottom));
    let marked = layer.points.iter().zip(texts);
    let texts = marked.filter_map(|(point, text)| {
        Some(EmptyElement::at(place(point)?) + Text::new(text.clone(), (0, -8), style.clone()))
    });
    chart.draw_series(texts)?;
    Ok(())
}

/// Labels in a row, right-aligned, in the strip above the panel.
fn legend_above(panel: &Panel, area: &Area<'_>) -> Drawn {
    // Letters of 13 px are 6.6 px wide on average; rounded up.
    let wide = |layer: &Layer| 38 + (7.0 * layer.label.chars().count() as f64) as i32;
    let shown = || panel.layers.iter().filter(|layer| !layer.label.is_empty());
    let mut left = PANEL.0 as i32 - 14 - shown().map(wide).sum::<i32>();
    for layer in shown() {
        draw_sample(layer, area, (left, 21))?;
        left += wide(layer);
    }
    Ok(())
}

/// Labels below one another.
fn legend_right(panel: &Panel, area: &Area<'_>) -> Drawn {
    let shown = panel.layers.iter().filter(|layer| !layer.label.is_empty());
    for (row, layer) in shown.enumerate() {
        draw_sample(layer, area, (4, 44 + 20 * row as i32))?;
    }
    Ok(())
}

fn draw_sample(layer: &Layer, area: &Area<'_>, (x, y): (i32, i32)) -> Drawn {
    let colour = colour(layer.colour);
    match layer.style {
        Style::Line | Style::Dotted(_) => {
            let ends = [(x, y), (x + 22, y)];
            area.draw(&PathElement::new(ends, line_stroke(layer)))?;
        }
        Style::Dashed => {
            for from in [x, x + 8, x + 16] {
                area.draw(&PathElement::new(
                    [(from, y), (from + 5, y)],
                    colour.stroke_width(2),
                ))?;
            }
        }
        Style::Cloud => area.draw(&Circle::new((x + 11, y), 2, colour.mix(0.6).filled()))?,
        Style::Bars(_) => {
            area.draw(&PathElement::new(
                [(x + 11, y - 7), (x + 11, y + 7)],
                colour.stroke_width(2),
            ))?;
            area.draw(&Circle::new((x + 11, y), 4, colour.filled()))?;
        }
        Style::Marks(_) => area.draw(&Circle::new((x + 11, y), 5, colour.stroke_width(2)))?,
        Style::Cells { .. } | Style::Band(_) => {
            let ends = [(x + 3, y - 6), (x + 19, y + 6)];
            area.draw(&Rectangle::new(ends, colour.mix(0.6).filled()))?;
        }
    }
    let style = ("sans-serif", 13).into_font().color(&BLACK);
    area.draw(&Text::new(layer.label.as_str(), (x + 28, y - 6), style))?;
    Ok(())
}
