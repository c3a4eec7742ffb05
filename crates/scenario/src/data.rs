//! The `[data]` table: measured data, and which of its columns is which channel.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_recording::measured::ChannelMapping;
use truecut_recording::{Mapping, Role, UserUnit};

use crate::check::Check;
use crate::column::{check_scale, read_unit, terms, time_base};

/// Measured data.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSpec {
    /// The file, `.csv`, `.parquet`, `.arrow` or `.mcap`; relative paths are resolved
    /// against the folder of the scenario file. `None` if it is named only when the scenario is
    /// used.
    pub file: Option<PathBuf>,
    /// Whether the first row of a CSV file names the columns. Without, they are called "1", "2", ….
    pub header: bool,
    /// Which column is what.
    pub mapping: Mapping,
}

/// Measured data that drives a replay or is compared with the run.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct DataTable {
    /// CSV, Parquet, Arrow or MCAP file, relative to the scenario file. May be left out and named
    /// by --data.
    file: Option<String>,
    /// Whether the first row of a CSV file names the columns. Default: true.
    header: Option<bool>,
    /// Column of the times; of an MCAP file "header_stamp" or "log_time". Either this or rate_hz is
    /// needed.
    time: Option<String>,
    /// Unit of the times. Default: that which the file or the column's name gives, else "s".
    time_unit: Option<String>,
    /// Rate of the rows, if there is no column of times.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "time runs forward"))]
    rate_hz: Option<f64>,
    /// Seconds of the machine's clock in one of the file's, which are counted from the start of the
    /// process. Default: 1.
    #[schemars(extend("minimum" = 0.9, "maximum" = 1.1, "x-rule" = "two clocks agree better; other times have another time_unit or rate_hz"))]
    clock_rate: Option<f64>,
    /// First time of the file that is used. Default: all.
    from_s: Option<f64>,
    /// Last time of the file that is used. Default: all.
    to_s: Option<f64>,
    /// Rate at which the data is used. Default: the median rate of the file.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "time runs forward"))]
    resample_hz: Option<f64>,
    /// Longest gap that is bridged, in inputs by a cubic, in outputs by a line. Default: 0.05.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a gap has a length"))]
    max_gap_s: Option<f64>,
    /// Times of the file at which the process begins anew, each time as the scenario says: one for
    /// each hole, say. Whole passes are then set aside for the last test. Default: once, with the
    /// first sample used.
    #[schemars(length(min = 1))]
    starts_s: Option<Vec<f64>>,
    /// The columns that are used.
    #[schemars(length(min = 1))]
    channel: Vec<ChannelTable>,
}

/// One column that is used, or several that make one channel.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ChannelTable {
    /// Name of the column, its number from "1" on in a file without header, or topic and field of
    /// a log, such as "/joint_states/position/joint_1". Either this or sum is needed.
    column: Option<String>,
    /// Columns with their factors, added up: `{ current_3 = 11.2, current_4 = -0.5 }`. A sample
    /// that one of them lacks is missing.
    sum: Option<BTreeMap<String, f64>>,
    /// Channel that it is compared with, or that it drives.
    channel: String,
    /// Unit of the column, or of the sum, after `scale`.
    unit: String,
    /// Factor on the column or the sum, e.g. newtons per volt. Default: 1.
    scale: Option<f64>,
    /// Added to it after `scale`, in `unit`. Default: 0.
    offset: Option<f64>,
    /// "output": compared; "input": drives the replay. Default: "output".
    role: Option<RoleName>,
    /// Known standard deviation of the noise, in `unit`.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "noise has a size; leave it out if it is not known"))]
    noise: Option<f64>,
    /// Readings of the column, or of any of the sum (before all factors), at or beyond which
    /// samples are left out.
    saturation: Option<[f64; 2]>,
}

/// Roles by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum RoleName {
    /// Drives the replay.
    Input,
    /// Compared with the run.
    Output,
}

/// Longest gap that is bridged where a scenario does not say, s.
const DEFAULT_MAX_GAP_S: f64 = 0.05;

impl DataTable {
    /// `None` after recording a fault. Where the tool `touches` something a peak may be the
    /// process's, and stays.
    pub(crate) fn resolve(
        self,
        folder: &Path,
        touches: bool,
        check: &mut Check,
    ) -> Option<DataSpec> {
        let (time, unit) = (self.time.as_deref(), self.time_unit.as_deref());
        let time = time_base(time, unit, self.rate_hz, "data", check);
        let window_s = [
            self.from_s.unwrap_or(f64::NEG_INFINITY),
            self.to_s.unwrap_or(f64::INFINITY),
        ];
        if window_s[0] >= window_s[1] {
            let [from, to] = window_s;
            let message = format!("is {to}, but must be greater than from_s = {from}");
            check.wrong("data", "to_s", message, "nothing lies between");
        }
        self.check_starts(check);
        let mut channels = Vec::new();
        for (index, channel) in self.channel.into_iter().enumerate() {
            let table = format!("data.channel.{index}");
            let first = |one: &ChannelMapping| one.channel == channel.channel;
            if let Some(earlier) = channels.iter().position(first) {
                let message = format!(
                    "is \"{}\", which `data.channel.{earlier}` is already",
                    channel.channel
                );
                check.wrong(&table, "channel", message, "mapped twice");
            }
            channels.extend(channel.resolve(&table, check));
        }
        Some(DataSpec {
            file: self.file.map(|file| folder.join(file)),
            header: self.header.unwrap_or(true),
            mapping: Mapping {
                time: time?,
                is_time_unit_said: self.time_unit.is_some(),
                clock_rate: self.clock_rate.unwrap_or(1.0),
                window_s,
                resample_hz: self.resample_hz,
                max_gap_s: self.max_gap_s.unwrap_or(DEFAULT_MAX_GAP_S),
                starts_s: self.starts_s.unwrap_or_default(),
                bridge_spikes: !touches,
                channels,
            },
        })
    }

    fn check_starts(&self, check: &mut Check) {
        let starts = self.starts_s.as_deref().unwrap_or_default();
        for (index, pair) in starts.windows(2).enumerate() {
            if pair[0] >= pair[1] {
                let message = format!(
                    "is {}, but must be greater than the start before it, {}",
                    pair[1], pair[0]
                );
                let key = (index + 1).to_string();
                check.wrong("data.starts_s", &key, message, "starts must rise");
            }
        }
    }
}

impl ChannelTable {
    /// `None` after recording a fault.
    fn resolve(self, table: &str, check: &mut Check) -> Option<ChannelMapping> {
        let scale = self.scale.unwrap_or(1.0);
        check_scale(table, "scale", scale, check);
        if let Some([low, high]) = self.saturation.filter(|[low, high]| low >= high) {
            let message =
                format!("is [{low}, {high}], but the first reading must be below the second");
            check.wrong(table, "saturation", message, "nothing lies between");
        }
        let terms = terms(self.column, self.sum, table, check);
        let unit: UserUnit = read_unit(&self.unit, table, "unit", check)?;
        Some(ChannelMapping {
            terms: terms?,
            channel: self.channel,
            scale,
            offset: self.offset.unwrap_or(0.0),
            role: match self.role {
                Some(RoleName::Input) => Role::Input,
                Some(RoleName::Output) | None => Role::Output,
            },
            noise: self.noise.map(|noise| noise * unit.si_factor),
            saturation: self.saturation,
            unit,
        })
    }
}
