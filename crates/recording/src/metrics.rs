//! Metrics: a number with a unit, taken from a recording by a rule that can be written in a scenario.

use std::fmt;

use crate::recording::{ChannelSpec, Header, Recording, UnknownName};
use crate::reduce;
use crate::spectrum::{Line, amplitude_spectrum};
use crate::unit::{Unit, significant};

/// Which rows count. Both ends included; what is not given does not bound. Fractions are of the recorded duration.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Window {
    /// Not before this time.
    pub from_s: Option<f64>,
    /// Not after this time.
    pub to_s: Option<f64>,
    /// Not before this share of the run.
    pub from_fraction: Option<f64>,
    /// Not after this share of the run.
    pub to_fraction: Option<f64>,
}

impl Window {
    /// The whole run.
    pub const ALL: Window = Window {
        from_s: None,
        to_s: None,
        from_fraction: None,
        to_fraction: None,
    };

    /// The rows that count, of ascending times.
    pub fn rows(&self, time_s: &[f64]) -> std::ops::Range<usize> {
        let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else {
            return 0..0;
        };
        let at = |fraction: f64| first + fraction * (last - first);
        let from_s = self
            .from_s
            .unwrap_or(f64::NEG_INFINITY)
            .max(self.from_fraction.map_or(f64::NEG_INFINITY, at));
        let to_s = self
            .to_s
            .unwrap_or(f64::INFINITY)
            .min(self.to_fraction.map_or(f64::INFINITY, at));
        // Times are sums of steps: a row a hair outside is meant to be inside.
        let hair_s = 1e-9 * (last - first);
        let start = time_s.partition_point(|&time| time < from_s - hair_s);
        let end = time_s.partition_point(|&time| time <= to_s + hair_s);
        start..end.max(start)
    }
}

impl fmt::Display for Window {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = [("from", self.from_s), ("to", self.to_s)];
        let shares = [("from", self.from_fraction), ("to", self.to_fraction)];
        let seconds = seconds
            .into_iter()
            .filter_map(|(word, value)| Some(format!(" {word} {} s", value?)));
        let shares = shares
            .into_iter()
            .filter_map(|(word, value)| Some(format!(" {word} {} %", 100.0 * value?)));
        seconds
            .chain(shares)
            .try_for_each(|part| formatter.write_str(&part))
    }
}

/// How a stretch of a channel becomes one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reducer {
    /// Largest |x|.
    Peak,
    /// Largest x.
    Max,
    /// Smallest x.
    Min,
    /// Mean over time.
    Mean,
    /// Root mean square over time.
    Rms,
    /// The last value.
    Final,
    /// Largest minus smallest.
    Range,
    /// Half of the range.
    Amplitude,
    /// Largest length of the vector whose components are the channels.
    PeakNorm,
    /// First time from which |x| stays above a threshold.
    FirstTimeAbove {
        /// In the channel's unit, SI.
        threshold: f64,
        /// For so long.
        hold_s: f64,
    },
    /// How long |x| is above a threshold, in all.
    DurationAbove {
        /// In the channel's unit, SI.
        threshold: f64,
    },
    /// Frequency of the highest spectral line in a band.
    SpectralLine {
        /// Lower and upper end.
        band_hz: [f64; 2],
    },
    /// Amplitude of the highest spectral line in a band.
    SpectralAmplitude {
        /// Lower and upper end.
        band_hz: [f64; 2],
    },
}

impl Reducer {
    /// What a scenario writes for each reducer.
    pub const NAMES: [&str; 13] = [
        "peak",
        "max",
        "min",
        "mean",
        "rms",
        "final",
        "range",
        "amplitude",
        "peak_norm",
        "first_time_above",
        "duration_above",
        "spectral_line",
        "spectral_amplitude",
    ];

    /// What a scenario writes for this one.
    pub fn name(&self) -> &'static str {
        match self {
            Reducer::Peak => "peak",
            Reducer::Max => "max",
            Reducer::Min => "min",
            Reducer::Mean => "mean",
            Reducer::Rms => "rms",
            Reducer::Final => "final",
            Reducer::Range => "range",
            Reducer::Amplitude => "amplitude",
            Reducer::PeakNorm => "peak_norm",
            Reducer::FirstTimeAbove { .. } => "first_time_above",
            Reducer::DurationAbove { .. } => "duration_above",
            Reducer::SpectralLine { .. } => "spectral_line",
            Reducer::SpectralAmplitude { .. } => "spectral_amplitude",
        }
    }

    /// The unit of the result, given that of the channel.
    pub fn unit(&self, channel: Unit) -> Unit {
        match self {
            Reducer::FirstTimeAbove { .. } | Reducer::DurationAbove { .. } => Unit::Second,
            Reducer::SpectralLine { .. } => Unit::Hertz,
            _ => channel,
        }
    }
}

/// A number to be taken from a recording.
#[derive(Clone, Debug, PartialEq)]
pub enum MetricSpec {
    /// One that the run itself computed.
    Scalar {
        /// Its name.
        name: String,
    },
    /// One from channels.
    Reduced {
        /// How.
        reducer: Reducer,
        /// From which: one, or several of one unit for [`Reducer::PeakNorm`].
        channels: Vec<String>,
        /// From which rows.
        window: Window,
    },
}

/// A metric's value.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    /// SI; NaN if there is none, then `note` says why.
    pub value: f64,
    /// Unit of `value`.
    pub unit: Unit,
    /// Why there is no value.
    pub note: Option<String>,
}

impl Metric {
    fn new(value: f64, unit: Unit, if_nan: &str) -> Metric {
        Metric {
            value,
            unit,
            note: value.is_nan().then(|| if_nan.to_owned()),
        }
    }
}

impl MetricSpec {
    /// Whether the metric can be taken from a recording with these channels, and the unit it will have. A scalar exists
    /// only after the run, so its unit is `None` here.
    ///
    /// # Errors
    /// An unknown channel, no channel, more than one for a reducer of one, or components of different units.
    pub fn check(&self, header: &Header) -> Result<Option<Unit>, MetricError> {
        match self {
            MetricSpec::Scalar { .. } => Ok(None),
            MetricSpec::Reduced {
                reducer, channels, ..
            } => {
                let found: Vec<&ChannelSpec> = channels
                    .iter()
                    .map(|name| header.channel(name))
                    .collect::<Result<_, _>>()?;
                let one_only = !matches!(reducer, Reducer::PeakNorm);
                let (Some(first), true) = (found.first(), found.len() == 1 || !one_only) else {
                    return Err(MetricError::ChannelCount {
                        reducer: reducer.name(),
                        count: found.len(),
                    });
                };
                match found.iter().find(|other| other.unit != first.unit) {
                    Some(other) => Err(MetricError::MixedUnits {
                        first: first.name.clone(),
                        first_unit: first.unit,
                        other: other.name.clone(),
                        other_unit: other.unit,
                    }),
                    None => Ok(Some(reducer.unit(first.unit))),
                }
            }
        }
    }

    /// Takes the metric. A value that does not exist (no rows in the window, NaN in them, no spectral line) is no
    /// error but NaN with a note.
    ///
    /// # Errors
    /// As [`MetricSpec::check`], and an unknown scalar.
    pub fn evaluate(&self, recording: &Recording) -> Result<Metric, MetricError> {
        match self {
            MetricSpec::Scalar { name } => {
                let scalar = recording.scalar(name)?;
                Ok(Metric::new(
                    scalar.value,
                    scalar.unit,
                    "the run gave no value",
                ))
            }
            MetricSpec::Reduced {
                reducer,
                channels,
                window,
            } => {
                let unit = self.check(&recording.header)?.unwrap_or(Unit::One);
                let rows = window.rows(&recording.time_s);
                let columns: Vec<&[f64]> = channels
                    .iter()
                    .map(|name| recording.channel(name).map(|column| &column[rows.clone()]))
                    .collect::<Result<_, _>>()?;
                Ok(reduce_rows(
                    reducer,
                    &recording.time_s[rows],
                    &columns,
                    unit,
                ))
            }
        }
    }
}

fn reduce_rows(reducer: &Reducer, time_s: &[f64], columns: &[&[f64]], unit: Unit) -> Metric {
    if time_s.is_empty() {
        return Metric::new(f64::NAN, unit, "the recording has no rows in the window");
    }
    if let Some(row) =
        (0..time_s.len()).find(|&row| columns.iter().any(|column| column[row].is_nan()))
    {
        let note = format!("the channel is NaN from {} s", significant(time_s[row], 6));
        return Metric {
            value: f64::NAN,
            unit,
            note: Some(note),
        };
    }
    let values = columns[0];
    let value = match *reducer {
        Reducer::Peak => reduce::peak(values),
        Reducer::Max => reduce::max(values),
        Reducer::Min => reduce::min(values),
        Reducer::Mean => reduce::mean(time_s, values),
        Reducer::Rms => reduce::rms(time_s, values),
        Reducer::Final => values[values.len() - 1],
        Reducer::Range => reduce::range(values),
        Reducer::Amplitude => 0.5 * reduce::range(values),
        Reducer::PeakNorm => reduce::peak_norm(columns),
        Reducer::DurationAbove { threshold } => reduce::duration_above(time_s, values, threshold),
        Reducer::FirstTimeAbove { threshold, hold_s } => {
            reduce::first_time_above(time_s, values, threshold, hold_s).unwrap_or(f64::NAN)
        }
        Reducer::SpectralLine { band_hz } => {
            highest_line(time_s, values, band_hz).map_or(f64::NAN, |l| l.frequency_hz)
        }
        Reducer::SpectralAmplitude { band_hz } => {
            highest_line(time_s, values, band_hz).map_or(f64::NAN, |line| line.amplitude)
        }
    };
    Metric::new(
        value,
        unit,
        match reducer {
            Reducer::FirstTimeAbove { .. } => "it never stays above the threshold",
            _ => "there is no spectral line in the band",
        },
    )
}

fn highest_line(time_s: &[f64], values: &[f64], band_hz: [f64; 2]) -> Option<Line> {
    amplitude_spectrum(time_s, values)?.highest_line(band_hz)
}

impl fmt::Display for MetricSpec {
    /// Says everything that the value depends on: `first_time_above(tool.displacement_y, 2e-6 held 0.05 s) from 1 s`.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let MetricSpec::Reduced {
            reducer,
            channels,
            window,
        } = self
        else {
            let MetricSpec::Scalar { name } = self else {
                return Ok(());
            };
            return formatter.write_str(name);
        };
        write!(formatter, "{}({}", reducer.name(), channels.join(", "))?;
        match reducer {
            Reducer::FirstTimeAbove { threshold, hold_s } => {
                write!(formatter, ", {threshold} held {hold_s} s")?
            }
            Reducer::DurationAbove { threshold } => write!(formatter, ", {threshold}")?,
            Reducer::SpectralLine { band_hz } | Reducer::SpectralAmplitude { band_hz } => {
                write!(formatter, ", {}–{} Hz", band_hz[0], band_hz[1])?;
            }
            _ => {}
        }
        write!(formatter, "){window}")
    }
}

/// A metric that cannot be taken from any recording with such channels.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MetricError {
    /// A channel or scalar that does not exist.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// Too many channels, or none.
    #[error("metric \"{reducer}\" takes {}, {count} given", if *.reducer == "peak_norm" { "one or more channels" } else { "one channel" })]
    ChannelCount {
        /// The reducer.
        reducer: &'static str,
        /// How many were given.
        count: usize,
    },
    /// Components that cannot be squared and added.
    #[error(
        "channels of one metric must share a unit: \"{first}\" is in {first_unit}, \"{other}\" in {other_unit}"
    )]
    MixedUnits {
        /// The first channel.
        first: String,
        /// Its unit.
        first_unit: Unit,
        /// One that differs.
        other: String,
        /// Its unit.
        other_unit: Unit,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Scalar;

    fn recording() -> Recording {
        let time_s: Vec<f64> = (0..=4000).map(|row| f64::from(row) * 1e-3).collect();
        let channels = vec![
            ChannelSpec::new("tool.displacement_y", Unit::Metre, ""),
            ChannelSpec::new("tool.displacement_z", Unit::Metre, ""),
            ChannelSpec::new("foot.sliding", Unit::One, ""),
        ];
        let y = time_s
            .iter()
            .map(|t| 1e-5 * t * (std::f64::consts::TAU * 5.0 * t).cos())
            .collect();
        let z = time_s
            .iter()
            .map(|t| 1e-5 * t * (std::f64::consts::TAU * 5.0 * t).sin())
            .collect();
        let sliding = time_s
            .iter()
            .map(|&t| f64::from(u8::from(t >= 2.6)))
            .collect();
        Recording {
            header: Header {
                channels,
                ..Header::default()
            },
            time_s,
            columns: vec![y, z, sliding],
            scalars: vec![Scalar::new("chamfer.width_spread", Unit::Metre, 1.9e-5, "")],
            ..Recording::default()
        }
    }

    fn reduced(reducer: Reducer, channels: &[&str], window: Window) -> MetricSpec {
        MetricSpec::Reduced {
            reducer,
            channels: channels.iter().map(|&name| name.to_owned()).collect(),
            window,
        }
    }

    #[test]
    fn verify_metrics_of_a_growing_circle() {
        let recording = recording();
        let yz = ["tool.displacement_y", "tool.displacement_z"];
        let value = |spec: &MetricSpec| spec.evaluate(&recording).unwrap();

        let norm = value(&reduced(Reducer::PeakNorm, &yz, Window::ALL));
        assert!((norm.value - 4e-5).abs() < 1e-18 && norm.unit == Unit::Metre);
        let half = Window {
            to_fraction: Some(0.5),
            ..Window::ALL
        };
        assert!((value(&reduced(Reducer::PeakNorm, &yz, half)).value - 2e-5).abs() < 1e-18);

        let started = value(&reduced(
            Reducer::FirstTimeAbove {
                threshold: 0.5,
                hold_s: 0.003,
            },
            &["foot.sliding"],
            Window::ALL,
        ));
        assert!((started.value - 2.6).abs() < 1e-12 && started.unit == Unit::Second);
        let line = value(&reduced(
            Reducer::SpectralLine {
                band_hz: [1.0, 20.0],
            },
            &yz[..1],
            Window::ALL,
        ));
        assert!(
            (line.value - 5.0).abs() < 0.01 && line.unit == Unit::Hertz,
            "{line:?}"
        );
        assert_eq!(
            value(&MetricSpec::Scalar {
                name: "chamfer.width_spread".into()
            })
            .value,
            1.9e-5
        );
    }

    #[test]
    fn a_window_keeps_its_ends_and_may_be_empty() {
        let time_s: Vec<f64> = (0..=10).map(|row| 0.1 * f64::from(row)).collect();
        assert_eq!(
            Window {
                from_s: Some(0.3),
                to_s: Some(0.7),
                ..Window::ALL
            }
            .rows(&time_s),
            3..8
        );
        assert_eq!(
            Window {
                from_s: Some(0.3),
                from_fraction: Some(0.5),
                ..Window::ALL
            }
            .rows(&time_s),
            5..11
        );
        assert_eq!(
            Window {
                from_s: Some(2.0),
                ..Window::ALL
            }
            .rows(&time_s)
            .len(),
            0
        );
        assert_eq!(Window::ALL.rows(&[]), 0..0);
    }

    #[test]
    fn an_unknown_channel_names_the_nearest() {
        let error = reduced(Reducer::Peak, &["tool.displacment_y"], Window::ALL)
            .check(&recording().header)
            .unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown channel \"tool.displacment_y\"; did you mean \"tool.displacement_y\"?"
        );
        let error = MetricSpec::Scalar {
            name: "chamfer.spread".into(),
        }
        .evaluate(&recording())
        .unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown scalar \"chamfer.spread\"; did you mean \"chamfer.width_spread\"?"
        );
    }

    #[test]
    fn channels_must_fit_the_reducer() {
        let header = recording().header;
        let two = ["tool.displacement_y", "foot.sliding"];
        assert_eq!(
            reduced(Reducer::Peak, &two, Window::ALL)
                .check(&header)
                .unwrap_err()
                .to_string(),
            "metric \"peak\" takes one channel, 2 given"
        );
        assert_eq!(
            reduced(Reducer::PeakNorm, &two, Window::ALL)
                .check(&header)
                .unwrap_err()
                .to_string(),
            "channels of one metric must share a unit: \"tool.displacement_y\" is in m, \"foot.sliding\" in 1"
        );
        assert!(
            reduced(Reducer::PeakNorm, &[], Window::ALL)
                .check(&header)
                .is_err()
        );
    }

    #[test]
    fn nan_and_empty_windows_give_a_note_instead_of_a_value() {
        let mut recording = recording();
        recording.columns[0][1500] = f64::NAN;
        let spec = |window| reduced(Reducer::Peak, &["tool.displacement_y"], window);
        let metric = spec(Window::ALL).evaluate(&recording).unwrap();
        assert!(metric.value.is_nan());
        assert_eq!(
            metric.note.as_deref(),
            Some("the channel is NaN from 1.50000 s")
        );
        let before = spec(Window {
            to_s: Some(1.0),
            ..Window::ALL
        })
        .evaluate(&recording)
        .unwrap();
        assert!(before.value.is_finite() && before.note.is_none());
        let after = spec(Window {
            from_s: Some(9.0),
            ..Window::ALL
        })
        .evaluate(&recording)
        .unwrap();
        assert_eq!(
            after.note.as_deref(),
            Some("the recording has no rows in the window")
        );
    }

    #[test]
    fn a_metric_reads_like_its_rule() {
        let window = Window {
            from_s: Some(1.0),
            to_fraction: Some(0.5),
            ..Window::ALL
        };
        let spec = reduced(
            Reducer::SpectralLine {
                band_hz: [1.0, 20.0],
            },
            &["tool.displacement_y"],
            window,
        );
        assert_eq!(
            spec.to_string(),
            "spectral_line(tool.displacement_y, 1–20 Hz) from 1 s to 50 %"
        );
    }
}
