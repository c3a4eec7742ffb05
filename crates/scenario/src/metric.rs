//! The keys that say how a number is taken from a recording; shared by claims and sweeps.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_recording::{MetricSpec, Reducer, UserUnit, Window};

use crate::check::Check;
use crate::column::read_unit;
use crate::fault::Fault;

/// Reducers by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum ReducerName {
    /// Largest magnitude.
    Peak,
    /// Largest value.
    Max,
    /// Smallest value.
    Min,
    /// Mean over time.
    Mean,
    /// Root mean square over time.
    Rms,
    /// Last value.
    Final,
    /// Largest minus smallest value.
    Range,
    /// Half of the range.
    Amplitude,
    /// Largest length of the vector whose components are the channels.
    PeakNorm,
    /// First time from which the magnitude stays above the threshold.
    FirstTimeAbove,
    /// How long the magnitude is above the threshold, in all.
    DurationAbove,
    /// Frequency of the highest spectral line in the band.
    SpectralLine,
    /// Amplitude of the highest spectral line in the band.
    SpectralAmplitude,
}

/// A number taken from a recording: either `scalar`, or `metric` of `channel`.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct MetricTable {
    /// Name of a number that the run computes itself; excludes all other keys of a metric.
    scalar: Option<String>,
    /// How the channel becomes one number.
    metric: Option<ReducerName>,
    /// The channel.
    channel: Option<String>,
    /// The components of a vector (metric "peak_norm").
    #[schemars(extend("minItems" = 1))]
    channels: Option<Vec<String>>,
    /// Threshold of the metrics "first_time_above" and "duration_above", in `threshold_unit`.
    threshold: Option<f64>,
    /// Unit of the threshold; must fit the channel. Default: "1".
    threshold_unit: Option<String>,
    /// How long the magnitude must stay above the threshold (metric "first_time_above"). Default:
    /// 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "time runs forward"))]
    hold_s: Option<f64>,
    /// Band in which the line is looked for (metrics "spectral_line" and "spectral_amplitude").
    band_hz: Option<[f64; 2]>,
    /// Start of the evaluated stretch. Default: the start of the run.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a run starts at 0"))]
    from_s: Option<f64>,
    /// End of the evaluated stretch. Default: the end of the run.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a run starts at 0"))]
    to_s: Option<f64>,
    /// Start of the evaluated stretch as a fraction of the run.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1.0, "x-rule" = "0 is the start, 1 the end"))]
    from_fraction: Option<f64>,
    /// End of the evaluated stretch as a fraction of the run.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1.0, "x-rule" = "0 is the start, 1 the end"))]
    to_fraction: Option<f64>,
}

const WITH_THRESHOLD: &str =
    "only the metrics \"first_time_above\" and \"duration_above\" have a threshold";

impl MetricTable {
    /// The metric, and the unit that is given for its value.
    pub(crate) fn with_unit(
        self,
        unit: &str,
        table: &str,
        check: &mut Check,
    ) -> Option<(MetricSpec, UserUnit)> {
        let unit = read_unit(unit, table, "unit", check);
        let metric = self.resolve(table, check);
        Some((metric?, unit?))
    }

    /// `table` is the dotted path of the table that holds the keys. `None` after recording a fault.
    fn resolve(self, table: &str, check: &mut Check) -> Option<MetricSpec> {
        if let Some(name) = self.scalar {
            let others = [
                "metric",
                "channel",
                "channels",
                "threshold",
                "threshold_unit",
                "hold_s",
                "band_hz",
                "from_s",
                "to_s",
                "from_fraction",
                "to_fraction",
            ];
            check.ignored(table, &others, "the run computes the scalar by itself");
            return Some(MetricSpec::Scalar { name });
        }
        let Some(name) = self.metric else {
            let message =
                format!("[{table}] bounds nothing: it needs `metric` and `channel`, or `scalar`");
            check.refuse(Fault::key(&format!("{table}.metric"), message, "no metric"));
            return None;
        };
        let window = self.window(table, check);
        let unit = self.threshold_unit(name, table, check);
        let si_factor = unit.as_ref().map_or(1.0, |unit| unit.si_factor);
        let channels = self.take_channels(name, table, check);
        let reducer = self.reducer(name, si_factor, table, check);
        (check.thresholds).extend(unit.map(|unit| (table.to_owned(), unit)));
        Some(MetricSpec::Reduced {
            reducer: reducer?,
            channels: channels?,
            window,
        })
    }

    fn take_channels(
        &self,
        name: ReducerName,
        table: &str,
        check: &mut Check,
    ) -> Option<Vec<String>> {
        if name == ReducerName::PeakNorm {
            check.ignored(
                table,
                &["channel"],
                "metric = \"peak_norm\" takes a list, `channels`",
            );
            check.needed(
                table,
                "channels",
                self.channels.clone(),
                "metric = \"peak_norm\"",
            )
        } else {
            let because = "only metric = \"peak_norm\" takes a list; the others take one `channel`";
            check.ignored(table, &["channels"], because);
            check
                .needed(table, "channel", self.channel.clone(), "this metric")
                .map(|one| vec![one])
        }
    }

    fn threshold_unit(
        &self,
        name: ReducerName,
        table: &str,
        check: &mut Check,
    ) -> Option<UserUnit> {
        use ReducerName::{DurationAbove, FirstTimeAbove};
        if !matches!(name, FirstTimeAbove | DurationAbove) {
            check.ignored(table, &["threshold", "threshold_unit"], WITH_THRESHOLD);
            return None;
        }
        read_unit(
            self.threshold_unit.as_deref().unwrap_or("1"),
            table,
            "threshold_unit",
            check,
        )
    }

    fn reducer(
        &self,
        name: ReducerName,
        si_factor: f64,
        table: &str,
        check: &mut Check,
    ) -> Option<Reducer> {
        use ReducerName as Name;
        if name != Name::FirstTimeAbove {
            let because = "only metric = \"first_time_above\" holds";
            check.ignored(table, &["hold_s"], because);
        }
        let spectral = matches!(name, Name::SpectralLine | Name::SpectralAmplitude);
        if !spectral {
            let because =
                "only the metrics \"spectral_line\" and \"spectral_amplitude\" have a band";
            check.ignored(table, &["band_hz"], because);
        }
        Some(match name {
            Name::Peak => Reducer::Peak,
            Name::Max => Reducer::Max,
            Name::Min => Reducer::Min,
            Name::Mean => Reducer::Mean,
            Name::Rms => Reducer::Rms,
            Name::Final => Reducer::Final,
            Name::Range => Reducer::Range,
            Name::Amplitude => Reducer::Amplitude,
            Name::PeakNorm => Reducer::PeakNorm,
            Name::FirstTimeAbove => Reducer::FirstTimeAbove {
                threshold: self.threshold(table, check)? * si_factor,
                hold_s: self.hold_s.unwrap_or(0.0),
            },
            Name::DurationAbove => Reducer::DurationAbove {
                threshold: self.threshold(table, check)? * si_factor,
            },
            Name::SpectralLine => Reducer::SpectralLine {
                band_hz: self.band_hz(table, check)?,
            },
            Name::SpectralAmplitude => Reducer::SpectralAmplitude {
                band_hz: self.band_hz(table, check)?,
            },
        })
    }

    fn threshold(&self, table: &str, check: &mut Check) -> Option<f64> {
        check.needed(table, "threshold", self.threshold, "this metric")
    }

    fn band_hz(&self, table: &str, check: &mut Check) -> Option<[f64; 2]> {
        let [low, high] = check.needed(table, "band_hz", self.band_hz, "this metric")?;
        if low < 0.0 || low >= high {
            let message =
                format!("is [{low}, {high}], but must be [low, high] with 0 <= low < high");
            check.wrong(table, "band_hz", message, "not a band");
        }
        Some([low, high])
    }

    fn window(&self, table: &str, check: &mut Check) -> Window {
        if self.from_s.is_some() {
            check.ignored(table, &["from_fraction"], "from_s already gives the start");
        }
        if self.to_s.is_some() {
            check.ignored(table, &["to_fraction"], "to_s already gives the end");
        }
        let ends = [
            ("from_s", self.from_s, "to_s", self.to_s),
            (
                "from_fraction",
                self.from_fraction,
                "to_fraction",
                self.to_fraction,
            ),
        ];
        for (from_key, from, to_key, to) in ends {
            if let (Some(from), Some(to)) = (from, to)
                && from >= to
            {
                let message = format!("is {to}, but must be greater than {from_key} = {from}");
                check.wrong(table, to_key, message, "the stretch is empty");
            }
        }
        Window {
            from_s: self.from_s,
            to_s: self.to_s,
            from_fraction: self.from_fraction,
            to_fraction: self.to_fraction,
        }
    }
}
