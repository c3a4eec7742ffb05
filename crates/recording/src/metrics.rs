//! Metrics: a number with a unit, taken from a recording by a rule that can be written in a
//! scenario.

use std::fmt;

use crate::recording::{ChannelSpec, Header, Recording, UnknownName};
use crate::reduce;
use crate::reducer::Reducer;
use crate::spectrum::{Line, amplitude_spectrum};
use crate::unit::{Unit, significant};
use crate::window::Window;

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
    /// The channels that it is taken from; none of a scalar.
    pub fn channels(&self) -> &[String] {
        match self {
            MetricSpec::Scalar { .. } => &[],
            MetricSpec::Reduced { channels, .. } => channels,
        }
    }

    /// Whether the metric can be taken from a recording with these channels, and the unit it will
    /// have. A scalar exists only after the run, so its unit is `None` here.
    ///
    /// # Errors
    /// An unknown channel, no channel, more than one for a reducer of one, or components of
    /// different units.
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

    /// Takes the metric. A value that does not exist (no rows in the window, NaN in them, no
    /// spectral line) is no error but NaN with a note.
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
    let not_finite = |row: usize| {
        let mut values = columns.iter().map(|column| column[row]);
        Some((row, values.find(|value: &f64| !value.is_finite())?))
    };
    if let Some((row, value)) = (0..time_s.len()).find_map(not_finite) {
        let note = format!(
            "the channel is {value} from {} s",
            significant(time_s[row], 6)
        );
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
    /// Says everything that the value depends on: `first_time_above(tool.displacement_y, 2e-6 held
    /// 0.05 s) from 1 s`.
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
mod tests;
