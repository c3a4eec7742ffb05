//! A model before and after it was extended, beside what was measured, for the viewer.

use std::path::Path;

use super::store::{Logged, Store};
use re_sdk_types::AsComponents;
use re_sdk_types::archetypes::{Scalars, SeriesLines};
use re_sdk_types::blueprint::archetypes::PlotLegend;
use re_sdk_types::blueprint::components as kinds;
use re_sdk_types::blueprint::components::PlayState;
use re_sdk_types::components::Color;
use truecut_recording::{SinkError, UserUnit};

use super::blueprint::{Layout, Part};
use super::outline::{Outline, Plot, time_axis, value_axis};
use super::results::SCENARIO;
use super::{application, log_text, time_column, write_store};
use crate::decimate::{ROWS_PER_SECOND, rows_to_draw};
use crate::error::failed;

/// Where the verdict is logged.
const VERDICT: &str = "/verdict";
/// Channels that stand one above the other; more would be too low to read.
const ROWS: usize = 3;
/// Part of the record that the signals open on: over all of it they cover each other.
const CLOSE: f64 = 0.12;
/// Noise is drawn as a band of so many rms, which holds 95 % of it.
const BAND: f64 = 2.0;

const MEASURED: [u8; 3] = [200, 200, 200];
const BEFORE: [u8; 3] = [242, 142, 43];
const AFTER: [u8; 3] = [60, 150, 255];
const NOISE: [u8; 3] = [120, 120, 120];

/// Measured channels beside a model before and after it was extended.
pub struct BeforeAfter<'a> {
    /// What it is about.
    pub title: &'a str,
    /// What came of it, Markdown.
    pub verdict: &'a str,
    /// The scenario of the extended model.
    pub scenario: &'a str,
    /// Ascending times.
    pub time_s: &'a [f64],
    /// In the order in which they are seen.
    pub channels: Vec<ChannelBeforeAfter<'a>>,
}

/// One channel of [`BeforeAfter`]. SI, a value for each time.
pub struct ChannelBeforeAfter<'a> {
    /// Its name.
    pub name: &'a str,
    /// In which it is shown.
    pub unit: UserUnit,
    /// In which what is left of it is shown.
    pub residual_unit: UserUnit,
    /// Measured; NaN where nothing was.
    pub measured: Vec<f64>,
    /// The nominal model.
    pub before: &'a [f64],
    /// The extended model, if it is another.
    pub after: Option<&'a [f64]>,
    /// Root mean square of the noise.
    pub noise: f64,
}

/// Writes the file: at the left the verdict, at the right a row for each channel with the signals
/// where the nominal model is worst and the residuals over the whole record.
///
/// # Errors
/// Where the file cannot be written.
pub fn write_before_after(path: &Path, shown: &BeforeAfter<'_>) -> Result<(), SinkError> {
    write_store(path, shown.title, |store| log(store, shown))
        .map_err(failed(path, "write the curves"))
}

fn log(stream: &Store, shown: &BeforeAfter<'_>) -> Logged<()> {
    log_text(stream, VERDICT, shown.verdict.to_owned())?;
    log_text(stream, SCENARIO, super::results::scenario(shown.scenario))?;
    for (index, channel) in shown.channels.iter().enumerate() {
        channel.log(stream, index, shown.time_s)?;
    }
    layout(stream, shown)
}

/// A curve: name, colour, width.
type Style = (&'static str, [u8; 3], f32);

impl ChannelBeforeAfter<'_> {
    fn log(&self, stream: &Store, index: usize, time_s: &[f64]) -> Logged<()> {
        let mut signals: Vec<(Style, &[f64])> = vec![
            (("measured", MEASURED, 4.0), &self.measured),
            (("nominal", BEFORE, 1.5), self.before),
        ];
        let (left, right) = (
            self.less(self.before),
            self.after.map(|after| self.less(after)),
        );
        let mut residuals: Vec<(Style, &[f64])> = vec![(("nominal", BEFORE, 1.0), &left)];
        if let (Some(after), Some(right)) = (self.after, &right) {
            signals.push((("extended", AFTER, 1.5), after));
            residuals.push((("extended", AFTER, 1.0), right));
        }
        curves(
            stream,
            &format!("{}/curves", signals_at(index)),
            &self.unit,
            time_s,
            &signals,
        )?;
        curves(
            stream,
            &format!("{}/curves", residuals_at(index)),
            &self.residual_unit,
            time_s,
            &residuals,
        )?;
        let end = BAND * self.noise;
        let ends: [(Style, &[f64]); 2] = [
            (("noise, +2 rms", NOISE, 1.5), &[end, end]),
            (("noise, −2 rms", NOISE, 1.5), &[-end, -end]),
        ];
        let times = [time_s.first(), time_s.last()].map(|time| time.copied().unwrap_or_default());
        curves(
            stream,
            &format!("{}/noise", residuals_at(index)),
            &self.residual_unit,
            &times,
            &ends,
        )
    }

    /// What a model leaves.
    fn less(&self, model: &[f64]) -> Vec<f64> {
        let pairs = self.measured.iter().zip(model);
        pairs.map(|(measured, model)| measured - model).collect()
    }

    /// Signals and residuals side by side.
    fn row(&self, layout: &Layout, index: usize, time_s: &[f64]) -> Logged<Part> {
        let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else {
            return layout.side_by_side(Vec::new());
        };
        let (worst, whole) = (self.worst(time_s), [*first, *last]);
        let signals: Vec<(&str, &[f64])> = [
            ("measured", Some(self.measured.as_slice())),
            ("nominal", Some(self.before)),
            ("extended", self.after),
        ]
        .into_iter()
        .filter_map(|(name, values)| Some((name, values?)))
        .collect();
        let title = format!("{} [{}], where it is worst", self.name, self.unit.symbol);
        let entity = signals_at(index);
        let signals = plot(
            layout,
            &title,
            &entity,
            time_s,
            (&self.unit, &signals),
            worst,
        )?;
        let title = format!(
            "{}: measured − simulated [{}]",
            self.name, self.residual_unit.symbol
        );
        let left = self.less(self.before);
        let right = self.after.map(|after| self.less(after));
        let noise = vec![BAND * self.noise; time_s.len()];
        let residuals: Vec<(&str, &[f64])> = [
            ("nominal", Some(&left)),
            ("extended", right.as_ref()),
            ("noise, +2 rms", Some(&noise)),
            ("noise, −2 rms", None),
        ]
        .into_iter()
        .map(|(name, values)| (name, values.map_or(&[][..], Vec::as_slice)))
        .collect();
        let residuals = plot(
            layout,
            &title,
            &residuals_at(index),
            time_s,
            (&self.residual_unit, &residuals),
            whole,
        )?;
        layout.side_by_side(vec![(1.0, signals), (1.0, residuals)])
    }

    /// The stretch in which the nominal model errs most.
    fn worst(&self, time_s: &[f64]) -> [f64; 2] {
        let rows = time_s.len();
        let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else {
            return [0.0, 0.0];
        };
        let width = ((CLOSE * rows as f64) as usize).clamp(1, rows);
        let square = |row: usize| {
            let error = self.measured[row] - self.before[row];
            if error.is_finite() {
                error * error
            } else {
                0.0
            }
        };
        let mut sum: f64 = (0..width).map(square).sum();
        let mut worst = (sum, width);
        for end in width..rows {
            sum += square(end) - square(end - width);
            if sum > worst.0 {
                worst = (sum, end + 1);
            }
        }
        let end = worst.1;
        [time_s[end - width].max(*first), time_s[end - 1].min(*last)]
    }
}

/// A plot of curves over a stretch of time, its legend where it hides least of them.
fn plot(
    layout: &Layout,
    title: &str,
    entity: &str,
    time_s: &[f64],
    (unit, curves): (&UserUnit, &[(&str, &[f64])]),
    [from_s, to_s]: [f64; 2],
) -> Logged<Part> {
    let rows = time_s.partition_point(|t| *t < from_s)..time_s.partition_point(|t| *t <= to_s);
    let outlines = curves.iter().map(|(_, values)| {
        let values = values.get(rows.clone()).unwrap_or_default();
        Outline::of(&time_s[rows.clone()], values)
    });
    let outlines: Vec<Outline> = outlines.collect();
    let factor = unit.from_si(1.0);
    let plot = Plot(outlines.iter().map(|outline| (outline, factor)).collect());
    let names: Vec<&str> = curves.iter().map(|(name, _)| *name).collect();
    let range = plot.range(0.0);
    let corner = range.map_or(kinds::Corner2D::LeftTop, |range| {
        plot.corner(&names, [from_s, to_s], range)
    });
    let legend = PlotLegend::new().with_corner(corner);
    let times = time_axis([from_s, to_s]);
    let values = range.map(value_axis);
    let query = ["$origin/**".to_owned()];
    let mut properties: Vec<(&str, &dyn AsComponents)> = vec![("PlotLegend", &legend)];
    properties.extend(times.iter().map(|axis| ("TimeAxis", axis as _)));
    properties.extend(values.iter().map(|axis| ("ScalarAxis", axis as _)));
    layout.view("TimeSeries", title, entity, &query, &properties)
}

fn signals_at(index: usize) -> String {
    format!("/channels/{index}/signals")
}

fn residuals_at(index: usize) -> String {
    format!("/channels/{index}/residuals")
}

fn curves(
    stream: &Store,
    entity: &str,
    unit: &UserUnit,
    time_s: &[f64],
    all: &[(Style, &[f64])],
) -> Logged<()> {
    let styles = || all.iter().map(|(style, _)| style);
    let lines = SeriesLines::new()
        .with_names(styles().map(|style| style.0))
        .with_colors(styles().map(|(_, [r, g, b], _)| Color::from_rgb(*r, *g, *b)))
        .with_widths(styles().map(|style| style.2));
    stream.log_static(entity, &lines)?;
    let columns: Vec<&[f64]> = all.iter().map(|(_, values)| *values).collect();
    let mut rows = Vec::new();
    rows_to_draw(time_s, &columns, ROWS_PER_SECOND, &mut rows);
    let values = rows.iter().flat_map(|&row| {
        let values = columns.iter().map(move |values| values[row]);
        values.map(|value| unit.from_si(value))
    });
    let scalars = Scalars::new(values).columns(std::iter::repeat_n(columns.len(), rows.len()))?;
    let times = time_column(rows.iter().map(|&row| time_s[row]));
    stream.send_columns(entity, [times], scalars)
}

fn layout(stream: &Store, shown: &BeforeAfter<'_>) -> Logged<()> {
    let layout = Layout::new(application(shown.title))?;
    let texts = layout.tabs(&[
        layout.document("Verdict", VERDICT)?,
        layout.document("Extended scenario", SCENARIO)?,
    ])?;
    let mut pages = Vec::new();
    for (page, channels) in shown.channels.chunks(ROWS).enumerate() {
        let rows = channels.iter().enumerate().map(|(row, channel)| {
            let part = channel.row(&layout, page * ROWS + row, shown.time_s)?;
            Ok((1.0, part))
        });
        let rows: Logged<Vec<_>> = rows.collect();
        let first = page * ROWS + 1;
        let title = format!("Channels {first} to {}", first + channels.len() - 1);
        pages.push(layout.titled_stack(&title, rows?)?);
    }
    let right = layout.pages(pages)?;
    let root = layout.side_by_side(vec![(0.85, texts), (1.3, right)])?;
    layout.send(&root, PlayState::Paused, stream)
}

#[cfg(test)]
mod tests {
    use truecut_recording::Unit;

    use super::*;

    #[test]
    fn signals_open_where_the_nominal_model_is_worst() {
        let time_s: Vec<f64> = (0..100).map(|row| 0.1 * f64::from(row)).collect();
        let mut measured = vec![0.0; 100];
        measured[60..72].fill(-1.0);
        measured[5] = f64::NAN;
        let before = vec![0.0; 100];
        let channel = ChannelBeforeAfter {
            name: "joint1.angle",
            unit: UserUnit::from(Unit::Radian),
            residual_unit: UserUnit::from(Unit::Radian),
            measured,
            before: &before,
            after: None,
            noise: 0.1,
        };
        assert_eq!(channel.worst(&time_s), [time_s[60], time_s[71]]);
    }
}
