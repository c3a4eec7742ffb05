//! One figure per channel: signals, residual, its spectrum, strongest dependence.

use truecut_discrepancy::compare::{
    ChannelComparison, Comparison, Dependence, Explanatory, Kind, along,
};
use truecut_recording::{Measured, Recording, Unit, UserUnit, short_number, significant};

use crate::figure::{
    BLACK, BLUE, Figure, GREEN, Layer, Legend, ORANGE, Panel, Scale, Style, largest, thinned,
};
use crate::text::reading_unit;

/// Most points of a curve in a figure that is a file of its own.
pub const POINTS: usize = 2400;

/// One channel as drawn, all columns of equal length; NaN where there is no measurement.
struct FigureColumns {
    time_s: Vec<f64>,
    measured: Vec<f64>,
    simulated: Vec<f64>,
    /// Most points of a curve.
    points: usize,
}

impl FigureColumns {
    fn residual(&self) -> impl Iterator<Item = f64> {
        let pairs = self.measured.iter().zip(&self.simulated);
        pairs.map(|(m, s)| m - s)
    }
}

pub fn channel(
    comparison: &Comparison,
    channel: &ChannelComparison,
    simulated: &Recording,
    measured: &Measured,
    points: usize,
) -> Figure {
    let columns = FigureColumns {
        points,
        ..columns(channel, comparison, simulated, measured)
    };
    Figure {
        title: format!(
            "{}: measured and simulated, NRMSE {} %",
            channel.channel,
            significant(100.0 * channel.level.nrmse, 3)
        ),
        panels: vec![
            signals(channel.unit, &columns),
            residual(channel.unit, &columns),
            spectrum(channel, comparison.rate_hz, points),
            explanation(comparison, channel, &columns),
        ],
        columns: 2,
        legend: Legend::Above,
    }
}

fn columns(
    channel: &ChannelComparison,
    comparison: &Comparison,
    simulated: &Recording,
    measured: &Measured,
) -> FigureColumns {
    let rows = measured
        .time_s
        .iter()
        .take_while(|t| **t <= comparison.duration_s + 1e-9)
        .count();
    let time_s = measured.time_s[..rows].to_vec();
    // Both exist: the comparison used them.
    let found = measured.channel(&channel.channel).ok();
    let values = found.map_or_else(Vec::new, |one| {
        let samples = one.values.iter().zip(&one.valid).take(rows);
        samples
            .map(|(value, valid)| if *valid { *value } else { f64::NAN })
            .collect()
    });
    let column = simulated.channel(&channel.channel).unwrap_or_default();
    FigureColumns {
        simulated: along(simulated, measured, column, rows),
        measured: values,
        time_s,
        points: POINTS,
    }
}

/// `force [N]`; nothing in brackets without a unit.
fn labelled(what: &str, unit: &UserUnit) -> String {
    if unit.symbol == "1" {
        what.to_owned()
    } else {
        format!("{what} [{}]", unit.symbol)
    }
}

/// A curve over time in the given unit.
fn over_time(
    label: &str,
    columns: &FigureColumns,
    values: impl Iterator<Item = f64>,
    unit: &UserUnit,
    colour: usize,
) -> Layer {
    let points = columns.time_s.iter().zip(values);
    let points = points.map(|(t, value)| (*t, unit.from_si(value)));
    Layer::line(label, thinned(points, columns.points), colour)
}

fn signals(unit: Unit, columns: &FigureColumns) -> Panel {
    let unit = reading_unit(
        unit,
        largest(columns.measured.iter().chain(&columns.simulated).copied()),
    );
    let layer = |label: &str, values: &[f64], colour| {
        over_time(label, columns, values.iter().copied(), &unit, colour)
    };
    Panel::new(
        "Signals",
        "time [s]",
        labelled("value", &unit),
        vec![
            layer("measured", &columns.measured, BLUE),
            layer("simulated", &columns.simulated, ORANGE),
        ],
    )
}

fn residual(unit: Unit, columns: &FigureColumns) -> Panel {
    let unit = reading_unit(unit, largest(columns.residual()));
    Panel::new(
        "Residual: measured − simulated",
        "time [s]",
        labelled("residual", &unit),
        vec![over_time("", columns, columns.residual(), &unit, GREEN)],
    )
}

fn spectrum(channel: &ChannelComparison, rate_hz: f64, most: usize) -> Panel {
    let mut panel = Panel {
        title: "Spectrum of the residual".to_owned(),
        x_label: "frequency [Hz]".to_owned(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        ..Panel::default()
    };
    let Some(spectra) = &channel.spectra else {
        return panel;
    };
    let amplitude = |density: f64| (2.0 * density / rate_hz).sqrt();
    let unit = reading_unit(
        channel.unit,
        amplitude(spectra.residual.iter().copied().fold(0.0, f64::max)),
    );
    let density = |density: &f64| unit.from_si(amplitude(*density));
    let layer = |label: &str, densities: &[f64], style, colour| {
        let all = spectra.frequency_hz.iter().zip(densities);
        let points = thinned(all.map(|(f, d)| (*f, density(d))), most);
        Layer::new(label, points, style, colour)
    };
    let at = |hertz: f64| {
        let bin = spectra
            .frequency_hz
            .partition_point(|f| *f < hertz)
            .min(spectra.residual.len() - 1);
        // The line may lie in the previous bin.
        spectra.residual[bin].max(spectra.residual[bin.saturating_sub(1)])
    };
    // The strongest lines are labelled, unless the label would cover that of a stronger one.
    let ends = [spectra.frequency_hz.first(), spectra.frequency_hz.last()]
        .map(|end| end.copied().unwrap_or(1.0));
    let apart = 0.055 * (ends[1] / ends[0]).ln();
    let mut marks: Vec<(f64, f64)> = Vec::new();
    let mut texts = Vec::new();
    for line in &channel.lines {
        let near = |other: &(f64, f64)| (other.0 / line.frequency_hz).ln().abs() < apart;
        let text = match line.per_revolution {
            Some(multiple) => format!("{multiple}/rev"),
            None => format!("{} Hz", significant(line.frequency_hz, 3)),
        };
        texts.push(if marks.iter().any(near) {
            String::new()
        } else {
            text
        });
        marks.push((line.frequency_hz, density(&at(line.frequency_hz))));
    }
    panel.y_label = format!("{}/√Hz", labelled("density", &unit).trim_end_matches(']')) + "]";
    panel.layers = vec![
        layer("residual", &spectra.residual, Style::Line, GREEN),
        layer("its background", &spectra.background, Style::Dashed, BLACK),
    ];
    if !marks.is_empty() {
        panel
            .layers
            .push(Layer::new("lines", marks, Style::Marks(texts), ORANGE));
    }
    panel
}

/// The residual against the signal that explains most.
fn explanation(
    comparison: &Comparison,
    channel: &ChannelComparison,
    columns: &FigureColumns,
) -> Panel {
    let Some(found) = channel.dependence.first() else {
        return Panel {
            title: "No signal moves".to_owned(),
            ..Panel::default()
        };
    };
    let signal = comparison
        .explanatory
        .iter()
        .find(|one| one.spec.name == found.signal);
    let values = signal.map_or_else(Vec::new, within_a_turn);
    let of_signal = signal.map_or(Unit::One, |signal| signal.spec.unit);
    let x_unit = reading_unit(of_signal, largest(values.iter().copied()));
    let unit = reading_unit(channel.unit, largest(columns.residual()));
    let step = values.len().div_ceil(columns.points).max(1);
    let cloud = values.iter().zip(columns.residual()).step_by(step);
    let p = if found.p_value < 1e-6 {
        "< 1e-6".to_owned()
    } else {
        format!("= {}", short_number(found.p_value))
    };
    let cloud = cloud.map(|(x, r)| (x_unit.from_si(*x), unit.from_si(r)));
    Panel::new(
        format!("Residual over {} (p {p})", found.signal),
        labelled(&found.signal, &x_unit),
        labelled("residual", &unit),
        vec![
            Layer::new("", cloud, Style::Cloud, GREEN),
            means(found, &x_unit, &unit),
        ],
    )
}

/// The values of a signal; an angle of the spindle within one turn.
fn within_a_turn(signal: &Explanatory) -> Vec<f64> {
    let turn = |angle: &f64| angle.rem_euclid(std::f64::consts::TAU);
    match signal.kind {
        Kind::SpindlePhase => signal.values.iter().map(turn).collect(),
        _ => signal.values.clone(),
    }
}

fn means(found: &Dependence, x_unit: &UserUnit, unit: &UserUnit) -> Layer {
    let bins = found.bins.iter().map(|bin| {
        let place = (x_unit.from_si(bin.signal), unit.from_si(bin.mean));
        (place, unit.from_si(2.0 * bin.standard_error))
    });
    let (points, halves): (Vec<_>, _) = bins.unzip();
    Layer::new(
        "mean ± 2 standard errors",
        points,
        Style::Bars(halves),
        ORANGE,
    )
}
