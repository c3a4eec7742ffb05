//! The `[excite]` table: a motion that makes parameters identifiable (`truecut excite`).

use schemars::JsonSchema;
use serde::Deserialize;
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, Value};
use truecut_recording::Role;

use crate::check::Check;
use crate::relocate::find_mut;
use crate::units::{from_deg, from_mm};

/// A motion that is asked for, and what it is to show.
#[derive(Debug, Clone, PartialEq)]
pub struct ExciteSpec {
    /// What it is to show; `None` for all that the scenario leaves open.
    pub asked: Option<Vec<String>>,
    /// Time of the motion.
    pub duration_s: f64,
    /// Rate of its samples.
    pub rate_hz: f64,
    /// Harmonics of the series.
    pub harmonics: usize,
    /// So many times the series runs through.
    pub periods: usize,
    /// What makes one motion better than another.
    pub criterion: Criterion,
    /// Share of every limit that the motion may use.
    pub limit_share: f64,
    /// Noise of outputs of which the data do not say it, as a share of their deviation.
    pub noise_share: f64,
    /// Of everything that is drawn.
    pub seed: u64,
    /// Motions that the search tries; `None` for a number that suits the model.
    pub evaluations: Option<usize>,
    /// Limits beyond those of the robot's files.
    pub joints: Vec<JointLimits>,
}

/// What makes one motion better than another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// The volume of the confidence ellipsoid of what is asked is least.
    #[default]
    D,
    /// The longest axis of that ellipsoid is least, each parameter in units of its standard error
    /// in random motions.
    E,
}

/// Limits of a joint that the scenario gives, rad or m, SI; `None` where the robot's files count.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointLimits {
    /// The joint, counted from 0.
    pub joint: usize,
    /// Whether they were given with the keys of a rotary joint; `None` if there are no limits.
    pub rotary: Option<bool>,
    /// Least coordinate.
    pub lower: Option<f64>,
    /// Largest coordinate.
    pub upper: Option<f64>,
    /// Largest speed.
    pub speed: Option<f64>,
    /// Largest acceleration.
    pub acceleration: Option<f64>,
    /// Largest drive torque or force.
    pub effort: Option<f64>,
}

/// A motion that makes parameters identifiable.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ExciteTable {
    /// What the motion is to show: a kind of unknown of [fit] or one of its parameters, an effect
    /// ("joint_coulomb.2", "payload"), the key of an [[uncertain]]. Default: all that [fit] has as
    /// unknowns; without [fit], all effects and uncertain values.
    #[serde(rename = "for")]
    #[schemars(extend("minItems" = 1))]
    asked: Option<Vec<String>>,
    /// Time of the motion. Default: 20.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 600.0, "x-rule" = "a motion takes time, and a search tries thousands"))]
    duration_s: Option<f64>,
    /// Rate of the samples of the motion. Default: 100.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 2000.0, "x-rule" = "samples follow each other, and a search tries thousands of motions"))]
    rate_hz: Option<f64>,
    /// Harmonics of the Fourier series of each joint. Default: 5.
    #[schemars(extend("minimum" = 2, "maximum" = 20, "x-rule" = "a single harmonic is never at rest, and a search has two numbers for each and each joint"))]
    harmonics: Option<u16>,
    /// So many times the series runs through in that time, at rest after each. Default: one for
    /// each 10 s begun.
    #[schemars(extend("minimum" = 1, "maximum" = 100, "x-rule" = "a series runs through"))]
    periods: Option<u16>,
    /// "d": the confidence ellipsoid of what is asked has the least volume; "e": its longest axis
    /// is shortest. Default: "d".
    criterion: Option<Criterion>,
    /// Share of every limit that the motion may use. Default: 0.9.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0, "x-rule" = "limits are kept"))]
    limit_share: Option<f64>,
    /// Standard deviation of the noise of outputs whose [[data.channel]] does not give it, as a
    /// share of the output's rms in random motions. Default: 0.01.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10.0, "x-rule" = "noise has a size"))]
    noise_share: Option<f64>,
    /// Seed of everything that is drawn. Default: 1.
    seed: Option<u32>,
    /// Motions that the search tries. Default: 8000 for inverse dynamics, 200 where each is a run.
    #[schemars(extend("minimum" = 1, "maximum" = 1000000, "x-rule" = "a search ends"))]
    evaluations: Option<u32>,
    /// Limits beyond those of the robot's files, one table a joint.
    joint: Option<Vec<JointLimitsTable>>,
}

/// Limits of a joint; those not given are of the robot's files.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointLimitsTable {
    /// The joint, counted from 1.
    #[schemars(extend("minimum" = 1, "x-rule" = "joints are counted from 1"))]
    joint: u16,
    /// Least angle.
    lower_deg: Option<f64>,
    /// Least position.
    lower_mm: Option<f64>,
    /// Largest angle.
    upper_deg: Option<f64>,
    /// Largest position.
    upper_mm: Option<f64>,
    /// Largest speed of a rotary joint.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "what stands shows nothing"))]
    speed_deg_per_s: Option<f64>,
    /// Largest speed of a prismatic joint.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "what stands shows nothing"))]
    speed_mm_per_s: Option<f64>,
    /// Largest acceleration of a rotary joint.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "what stands shows nothing"))]
    acceleration_deg_per_s2: Option<f64>,
    /// Largest acceleration of a prismatic joint.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "what stands shows nothing"))]
    acceleration_m_per_s2: Option<f64>,
    /// Largest drive torque of a rotary joint.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a drive drives"))]
    torque_n_m: Option<f64>,
    /// Largest drive force of a prismatic joint.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a drive drives"))]
    force_n: Option<f64>,
}

const DURATION_S: f64 = 20.0;
const RATE_HZ: f64 = 100.0;
const HARMONICS: u16 = 5;
/// A series that repeats after this time has harmonics of some tenths of a hertz.
const LONGEST_PERIOD_S: f64 = 10.0;
const LIMIT_SHARE: f64 = 0.9;
const NOISE_SHARE: f64 = 0.01;
const SEED: u32 = 1;

impl Default for ExciteSpec {
    /// As the table without keys.
    fn default() -> Self {
        ExciteTable::default().resolved(Vec::new())
    }
}

impl ExciteTable {
    pub(crate) fn resolve(mut self, check: &mut Check) -> ExciteSpec {
        let mut joints: Vec<JointLimits> = Vec::new();
        for (index, one) in self
            .joint
            .take()
            .unwrap_or_default()
            .into_iter()
            .enumerate()
        {
            let table = format!("excite.joint.{index}");
            let one = one.resolve(&table, check);
            if joints.iter().any(|other| other.joint == one.joint) {
                let is = format!("is {}, which another table has already", one.joint + 1);
                check.wrong(&table, "joint", is, "a second time");
            }
            joints.push(one);
        }
        self.resolved(joints)
    }

    fn resolved(self, joints: Vec<JointLimits>) -> ExciteSpec {
        let duration_s = self.duration_s.unwrap_or(DURATION_S);
        let periods = (self.periods.map(usize::from))
            .unwrap_or_else(|| (duration_s / LONGEST_PERIOD_S).ceil() as usize);
        ExciteSpec {
            asked: self.asked,
            duration_s,
            rate_hz: self.rate_hz.unwrap_or(RATE_HZ),
            harmonics: usize::from(self.harmonics.unwrap_or(HARMONICS)),
            periods,
            criterion: self.criterion.unwrap_or_default(),
            limit_share: self.limit_share.unwrap_or(LIMIT_SHARE),
            noise_share: self.noise_share.unwrap_or(NOISE_SHARE),
            seed: u64::from(self.seed.unwrap_or(SEED)),
            evaluations: self.evaluations.map(|number| number as usize),
            joints,
        }
    }
}

impl JointLimitsTable {
    fn resolve(self, table: &str, check: &mut Check) -> JointLimits {
        let of_rotary = [
            self.lower_deg.map(from_deg),
            self.upper_deg.map(from_deg),
            self.speed_deg_per_s.map(from_deg),
            self.acceleration_deg_per_s2.map(from_deg),
            self.torque_n_m,
        ];
        let of_prismatic = [
            self.lower_mm.map(from_mm),
            self.upper_mm.map(from_mm),
            self.speed_mm_per_s.map(from_mm),
            self.acceleration_m_per_s2,
            self.force_n,
        ];
        let has = |values: &[Option<f64>]| values.iter().any(Option::is_some);
        let (rotary, prismatic) = (has(&of_rotary), has(&of_prismatic));
        if rotary && prismatic {
            let is = format!("is {}, which has keys of both kinds of joint", self.joint);
            check.wrong(table, "joint", is, "rotary or prismatic");
        }
        let values = if rotary { of_rotary } else { of_prismatic };
        if let [Some(lower), Some(upper), ..] = values
            && lower >= upper
        {
            let key = if rotary { "upper_deg" } else { "upper_mm" };
            let is = "must be greater than the lower limit of the joint";
            check.wrong(table, key, is, "nothing lies between");
        }
        let [lower, upper, speed, acceleration, effort] = values;
        JointLimits {
            joint: usize::from(self.joint).saturating_sub(1),
            rotary: (rotary || prismatic).then_some(rotary),
            lower,
            upper,
            speed,
            acceleration,
            effort,
        }
    }
}

/// A column of the file of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionColumn {
    /// Its name, and that of the channel.
    pub channel: String,
    /// Symbol of its unit, SI.
    pub unit: String,
    /// Whether it drives the replay.
    pub role: Role,
    /// Noise of the channel where it is known, SI.
    pub noise: Option<f64>,
}

/// Name of the column of times of such a file.
pub const MOTION_TIME: &str = "time_s";

/// A motion that a replay is to have in place of its data.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedMotion {
    /// Its file, beside the scenario.
    pub file: String,
    /// Its columns but the times.
    pub columns: Vec<MotionColumn>,
    /// Whether each joint of the chain is rotary.
    pub rotary: Vec<bool>,
    /// Coordinates that it begins with, SI.
    pub start: Vec<f64>,
}

impl PlannedMotion {
    /// Puts the motion in the place of the data, and its start in that of a posture.
    pub(crate) fn write(&self, document: &mut DocumentMut) {
        let mut data = Table::new();
        data.insert("file", toml_edit::value(self.file.as_str()));
        data.insert("time", toml_edit::value(MOTION_TIME));
        let mut channels = ArrayOfTables::new();
        for column in &self.columns {
            let mut channel = Table::new();
            channel.insert("column", toml_edit::value(column.channel.as_str()));
            channel.insert("channel", toml_edit::value(column.channel.as_str()));
            channel.insert("unit", toml_edit::value(column.unit.as_str()));
            if column.role == Role::Input {
                channel.insert("role", toml_edit::value("input"));
            }
            if let Some(noise) = column.noise {
                channel.insert("noise", toml_edit::value(noise));
            }
            channels.push(channel);
        }
        data.insert("channel", Item::ArrayOfTables(channels));
        document.insert("data", Item::Table(data));
        for (key, rotary, per_si) in [
            ("posture_deg", true, 1f64.to_degrees()),
            ("posture_mm", false, 1e3),
        ] {
            let own = self.start.iter().zip(&self.rotary);
            let own = own.filter(|(_, is_rotary)| **is_rotary == rotary);
            let start: Array = own.map(|(q, _)| Value::from(q * per_si)).collect();
            if let Some(posture) = find_mut(document, &["robot", key]) {
                *posture = Item::Value(Value::Array(start));
            }
        }
    }
}
