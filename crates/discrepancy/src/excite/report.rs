//! What a planned motion is expected to tell. Serialised as `excitation.json`.

use serde::Serialize;

/// A planned motion and what it shows.
#[derive(Debug, Clone, Serialize)]
pub struct ExciteReport {
    /// Name of the scenario.
    pub scenario: String,
    /// What makes one motion better than another: "d" or "e".
    pub criterion: &'static str,
    /// Time of the motion, s.
    pub duration_s: f64,
    /// So many times the series runs through in it.
    pub periods: usize,
    /// Harmonics of the series.
    pub harmonics: usize,
    /// Motions that were tried.
    pub evaluations: usize,
    /// Random motions that the planned one is held against.
    pub random_motions: usize,
    /// Parameters asked for.
    pub parameters: Vec<ExpectedError>,
    /// Geometric mean of the standard errors over those in random motions.
    pub mean_ratio: f64,
    /// Condition numbers.
    pub condition: Condition,
    /// What the motion takes of each joint's limits.
    pub joints: Vec<JointUse>,
    /// Noise that standard errors are for.
    pub noise: Vec<AssumedNoise>,
    /// How far two explanations of a diagnosis would be told apart.
    pub separation: Option<Separation>,
}

/// Standard errors of a parameter.
#[derive(Debug, Clone, Serialize)]
pub struct ExpectedError {
    /// Its name.
    pub name: String,
    /// Symbol of its unit.
    pub unit: String,
    /// The value about which it is looked at.
    pub value: f64,
    /// In the planned motion.
    pub planned: f64,
    /// In random motions of the same duration within the same limits: their median.
    pub random: f64,
    /// In the motion of the scenario's data; null where there is none.
    pub present: Option<f64>,
}

/// Ratio of the largest singular value of the weighted rows to the smallest, parameters in units of
/// their standard errors in random motions.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Condition {
    /// Of the planned motion.
    pub planned: f64,
    /// Of random motions: their median.
    pub random: f64,
    /// Of the motion of the scenario's data.
    pub present: Option<f64>,
}

/// What a motion takes of a joint's limits.
#[derive(Debug, Clone, Serialize)]
pub struct JointUse {
    /// Name of the joint.
    pub joint: String,
    /// Unit of its coordinate.
    pub unit: &'static str,
    /// Where it goes to, least and largest.
    pub range: [f64; 2],
    /// Largest speed.
    pub speed: f64,
    /// Over what may be used; 1 is all of that.
    pub speed_share: f64,
    /// Largest acceleration.
    pub acceleration: f64,
    /// Over what may be used; 0 where it is not limited.
    pub acceleration_share: f64,
    /// Largest drive torque or force.
    pub effort: f64,
    /// Over what may be used; 0 where it is not limited.
    pub effort_share: f64,
}

/// Noise of an output.
#[derive(Debug, Clone, Serialize)]
pub struct AssumedNoise {
    /// The channel.
    pub channel: String,
    /// Deviation of a sample.
    pub noise: f64,
    /// Symbol of its unit.
    pub unit: String,
    /// Whether the scenario says it; else it is a share of the channel's rms in random motions.
    pub is_stated: bool,
}

/// How far the causes of a diagnosis and its first alternative would be told apart.
#[derive(Debug, Clone, Serialize)]
pub struct Separation {
    /// The causes.
    pub causes: Vec<String>,
    /// The first alternative.
    pub alternative: Vec<String>,
    /// Whitened distance of their predictions, the alternative and all that is uncertain refitted.
    pub planned: f64,
    /// Decimal logarithm of the odds that are to be expected for whichever is there.
    pub log10_odds: f64,
    /// Both in the data at hand.
    pub present: Option<[f64; 2]>,
}
