//! The table `[modes]`: hammer FRFs, ready made or as the signals of hammer and sensor.

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_arm::FrameId;
use truecut_recording::Unit;

use super::hammer::{FrfSpec, FrfValues, HammerPoint, ImpactSpec, ModesSpec, MotionKind, Signal};
use super::stiffness::Axes;
use crate::check::Check;
use crate::column::{check_scale, read_unit_of, time_base};
use crate::fault::Fault;
use crate::units::{from_mm, from_ms};

/// Hammer FRFs of one posture.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ModesTable {
    /// Axes of the directions. Default: "world".
    axes: Option<Axes>,
    /// Frequencies that are used, Hz.
    band_hz: [f64; 2],
    /// Number of modes in the band. Default: as many as the data show.
    #[schemars(range(min = 1, max = 40))]
    count: Option<usize>,
    /// Whether modes above the arm's are written as [[process.milling.cutter.mode]]; all FRFs are
    /// then at the tool point. Default: false.
    tool_modes: Option<bool>,
    /// FRFs in files.
    frf: Option<Vec<FrfTable>>,
    /// Signals of hammer and sensor.
    impact: Option<Vec<ImpactTable>>,
}

/// Where and in which direction.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PointTable {
    /// Frame of the arm. Default: "tool".
    point: Option<FrameId>,
    /// From the frame's origin, in the frame's axes. Default: [0, 0, 0].
    offset_mm: Option<[f64; 3]>,
    /// Direction in `axes`, of any length but zero.
    direction: [f64; 3],
}

/// An FRF in a file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FrfTable {
    /// CSV or Parquet file, relative to this file.
    file: String,
    /// Whether the first row of a CSV file names the columns. Default: true.
    header: Option<bool>,
    /// Column of frequencies.
    frequency: String,
    /// Unit of the frequencies. Default: "Hz".
    frequency_unit: Option<String>,
    /// Column of real parts, with `imaginary`.
    real: Option<String>,
    /// Column of imaginary parts.
    imaginary: Option<String>,
    /// Column of magnitudes (not in dB), with `phase`.
    magnitude: Option<String>,
    /// Column of phases.
    phase: Option<String>,
    /// Unit of the phases. Default: "deg".
    phase_unit: Option<String>,
    /// Column of the coherence, which weighs the frequencies.
    coherence: Option<String>,
    /// Number of averages behind the coherence. Default: 1.
    #[schemars(range(min = 1))]
    averages: Option<usize>,
    /// Unit of the response: a length (compliance), velocity (mobility) or acceleration
    /// (accelerance).
    response_unit: String,
    /// Unit of the force. Default: "N".
    force_unit: Option<String>,
    /// Factor on the values, e.g. 9.80665 from g to m/s^2. Default: 1.
    scale: Option<f64>,
    /// Where the hammer struck.
    excitation: PointTable,
    /// Where the response was measured.
    response: PointTable,
}

/// Signals of hammer and sensor, with one blow or more.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ImpactTable {
    /// CSV or Parquet file, relative to this file.
    file: String,
    /// Whether the first row of a CSV file names the columns. Default: true.
    header: Option<bool>,
    /// Column of the times. Either this or rate_hz is needed.
    time: Option<String>,
    /// Unit of the times. Default: that which the file or the column's name gives, else "s".
    time_unit: Option<String>,
    /// Rate of the rows, if there is no column of times.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "time runs forward"))]
    rate_hz: Option<f64>,
    /// Column of the hammer's force.
    force: String,
    /// Unit of the force. Default: "N".
    force_unit: Option<String>,
    /// Factor on the force, e.g. newtons per volt. Default: 1.
    force_scale: Option<f64>,
    /// Column of the response.
    motion: String,
    /// Unit of the response: a length, velocity or acceleration.
    motion_unit: String,
    /// Factor on the response, e.g. 9.80665 from g to m/s^2. Default: 1.
    motion_scale: Option<f64>,
    /// Force at which a blow begins. Default: a tenth of the largest.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a blow is a force"))]
    trigger_n: Option<f64>,
    /// Time before a blow that belongs to its window. Default: 10.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "it lies before the blow"))]
    before_ms: Option<f64>,
    /// Time from a blow to the end of its window. Default: to shortly before the next, or to the
    /// end.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the window holds the response"))]
    window_s: Option<f64>,
    /// Time constant of an exponential window for responses that outlast `window_s`. Default: none.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the window decays"))]
    exponential_s: Option<f64>,
    /// Where the hammer struck.
    excitation: PointTable,
    /// Where the response was measured.
    response: PointTable,
}

impl ModesTable {
    /// `None` after recording a fault.
    pub(super) fn resolve(self, folder: &Path, check: &mut Check) -> Option<ModesSpec> {
        let [low, high] = self.band_hz;
        if !(low >= 0.0 && low < high) {
            let message =
                format!("is [{low}, {high}], but must rise from a frequency of at least 0");
            check.wrong("modes", "band_hz", message, "nothing lies between");
        }
        let frfs = self.frf.unwrap_or_default();
        let impacts = self.impact.unwrap_or_default();
        if frfs.is_empty() && impacts.is_empty() {
            let message = "neither [[modes.frf]] nor [[modes.impact]]: there is no FRF".to_owned();
            check.refuse(Fault::key("modes", message, "no FRF"));
        }
        let mut resolved = ModesSpec {
            axes: self.axes.unwrap_or_default(),
            band_hz: self.band_hz,
            count: self.count,
            tool_modes: self.tool_modes.unwrap_or(false),
            frfs: Vec::new(),
            impacts: Vec::new(),
        };
        for (index, frf) in frfs.into_iter().enumerate() {
            let table = format!("modes.frf.{index}");
            resolved.frfs.extend(frf.resolve(&table, folder, check));
        }
        for (index, impact) in impacts.into_iter().enumerate() {
            let table = format!("modes.impact.{index}");
            resolved
                .impacts
                .extend(impact.resolve(&table, folder, check));
        }
        Some(resolved)
    }
}

impl PointTable {
    fn resolve(self, table: &str, check: &mut Check) -> Option<HammerPoint> {
        let direction = check.direction(&format!("{table}.direction"), self.direction)?;
        Some(HammerPoint {
            frame: self.point.unwrap_or(FrameId::Tool),
            offset_m: self.offset_mm.unwrap_or_default().map(from_mm),
            direction,
        })
    }
}

impl FrfTable {
    fn resolve(self, table: &str, folder: &Path, check: &mut Check) -> Option<FrfSpec> {
        let values = self.values(table, check);
        if self.coherence.is_none() {
            check.ignored(table, &["averages"], "there is no column of coherence");
        }
        let frequency = {
            let unit = self.frequency_unit.as_deref().unwrap_or("Hz");
            read_unit_of(&[Unit::Hertz], unit, table, "frequency_unit", check)
        };
        let (factor, kind) = response(
            (&self.response_unit, "response_unit"),
            self.force_unit.as_deref(),
            table,
            check,
        )?;
        let scale = self.scale.unwrap_or(1.0);
        check_scale(table, "scale", scale, check);
        let excitation = self
            .excitation
            .resolve(&format!("{table}.excitation"), check);
        let response = self.response.resolve(&format!("{table}.response"), check);
        Some(FrfSpec {
            file: folder.join(self.file),
            header: self.header.unwrap_or(true),
            frequency: (self.frequency, frequency?),
            values: values?,
            coherence: self.coherence,
            averages: self.averages,
            factor: factor * scale,
            kind,
            excitation: excitation?,
            response: response?,
        })
    }

    fn values(&self, table: &str, check: &mut Check) -> Option<FrfValues> {
        let pairs = [&self.real, &self.imaginary, &self.magnitude, &self.phase];
        let polar = match pairs.map(|one| one.is_some()) {
            [true, true, false, false] => false,
            [false, false, true, true] => true,
            _ => {
                let message = format!(
                    "[{table}] must name either the columns `real` and `imaginary`, or `magnitude` and `phase`"
                );
                check.refuse(Fault::key(table, message, "not two columns of one kind"));
                return None;
            }
        };
        let name = |one: &Option<String>| one.clone().unwrap_or_default();
        if !polar {
            check.ignored(table, &["phase_unit"], "there is no column of phases");
            return Some(FrfValues::Cartesian(
                name(&self.real),
                name(&self.imaginary),
            ));
        }
        let unit = {
            let unit = self.phase_unit.as_deref().unwrap_or("deg");
            read_unit_of(&[Unit::Radian], unit, table, "phase_unit", check)
        }?;
        Some(FrfValues::Polar(
            name(&self.magnitude),
            name(&self.phase),
            unit.si_factor,
        ))
    }
}

impl ImpactTable {
    fn resolve(self, table: &str, folder: &Path, check: &mut Check) -> Option<ImpactSpec> {
        let (time, unit) = (self.time.as_deref(), self.time_unit.as_deref());
        let times = if time.is_some() == self.rate_hz.is_some() {
            let message =
                format!("[{table}] must give either `time`, the column of the times, or `rate_hz`");
            check.refuse(Fault::key(table, message, "not one time base"));
            None
        } else {
            time_base(time, unit, self.rate_hz, table, check)
        };
        let (motion, kind) = response((&self.motion_unit, "motion_unit"), None, table, check)?;
        let force = {
            let unit = self.force_unit.as_deref().unwrap_or("N");
            read_unit_of(&[Unit::Newton], unit, table, "force_unit", check)
        };
        let [force_scale, motion_scale] =
            [self.force_scale, self.motion_scale].map(|scale| scale.unwrap_or(1.0));
        check_scale(table, "force_scale", force_scale, check);
        check_scale(table, "motion_scale", motion_scale, check);
        let struck = self
            .excitation
            .resolve(&format!("{table}.excitation"), check);
        let observed = self.response.resolve(&format!("{table}.response"), check);
        Some(ImpactSpec {
            file: folder.join(self.file),
            header: self.header.unwrap_or(true),
            times: times?,
            is_time_unit_said: self.time_unit.is_some(),
            force: Signal {
                column: self.force,
                factor: force?.si_factor * force_scale,
            },
            response: Signal {
                column: self.motion,
                factor: motion * motion_scale,
            },
            kind,
            trigger_n: self.trigger_n,
            before_s: self.before_ms.map_or(0.01, from_ms),
            window_s: self.window_s,
            exponential_s: self.exponential_s,
            struck: struck?,
            observed: observed?,
        })
    }
}

/// Factor to SI and kind of a response per force.
fn response(
    (written, key): (&str, &str),
    force: Option<&str>,
    table: &str,
    check: &mut Check,
) -> Option<(f64, MotionKind)> {
    let wanted = [
        Unit::Metre,
        Unit::MetrePerSecond,
        Unit::MetrePerSecondSquared,
    ];
    let motion = read_unit_of(&wanted, written, table, key, check);
    let force = force.unwrap_or("N");
    let force = read_unit_of(&[Unit::Newton], force, table, "force_unit", check);
    let motion = motion?;
    let kind = match motion.unit {
        Unit::Metre => MotionKind::Displacement,
        Unit::MetrePerSecond => MotionKind::Velocity,
        _ => MotionKind::Acceleration,
    };
    Some((motion.si_factor / force?.si_factor, kind))
}
