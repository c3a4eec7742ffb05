//! Simulated runs near the limit: do they chatter?

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use truecut_core::chatter::growth::NOISE;
use truecut_plan::lobes::Lobes;
use truecut_recording::Scalar;
use truecut_scenario::{ProcessSpec, Scenario};

use super::MillingStudy;
use crate::error::SimError;
use crate::run::{Run, RunError};

/// Depths as parts of the limit, in turns.
const SHARES: [f64; 2] = [0.8, 1.25];
/// Part of itself to which vibration beyond the linear range falls in a run if it dies away.
const FALLEN: f64 = 0.5;
/// Longest run, s.
const LONGEST_S: f64 = 6.0;

/// A run laid over a stability diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityRun {
    /// Speed of the spindle, rad/s.
    pub spindle_rad_s: f64,
    /// Axial depth, m.
    pub depth_m: f64,
    /// Whether vibration grew; `None` if that cannot be told.
    pub chatters: Option<bool>,
    /// Growth rate of the vibration, 1/s; NaN where there is none.
    pub growth_per_s: f64,
    /// The highest line apart from the teeth's, Hz; NaN where there is none.
    pub chatter_hz: f64,
    /// What the theory said.
    pub predicted: bool,
}

/// Runs a scenario at up to `count` places just below and just above the limit of its diagram,
/// spread over the speeds that have one. `progress` is told the part done, from 0 to 1.
///
/// # Errors
/// Whatever makes the scenario unfit to run at one of the places.
pub fn stability_runs(
    scenario: &Scenario,
    study: &MillingStudy,
    lobes: &Lobes,
    count: usize,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Vec<StabilityRun>, RunError> {
    let places = places(study, lobes, count);
    let done = AtomicUsize::new(0);
    let runs = places.par_iter().map(|(speed, depth_m, predicted)| {
        let run = one(scenario, study, *speed, *depth_m, *predicted);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress(done as f64 / places.len() as f64);
        run.map_err(|error| RunError::of(scenario, error))
    });
    runs.collect()
}

/// Speeds and depths, and whether the theory says that they chatter: spread over the speeds that
/// have a limit in the diagram.
fn places(study: &MillingStudy, lobes: &Lobes, count: usize) -> Vec<(f64, f64, bool)> {
    let coupling = vec![lobes.mode_coupling; lobes.limit.len()];
    let limits = if study.regeneration() {
        &lobes.limit
    } else {
        &coupling
    };
    let with_limit: Vec<(f64, f64)> = (lobes.spindle_rad_s.iter().zip(limits))
        .filter_map(|(speed, limit)| Some((*speed, limit.as_ref()?.depth_m)))
        .collect();
    if with_limit.is_empty() {
        return Vec::new();
    }
    let speeds = count.div_ceil(SHARES.len());
    let all = (0..count).map(|k| {
        let part = ((k / SHARES.len()) as f64 + 0.5) / speeds as f64;
        let (speed, limit_m) = with_limit[(part * with_limit.len() as f64) as usize];
        let share = SHARES[k % SHARES.len()];
        (speed, limit_m * share, share > 1.0)
    });
    all.collect()
}

fn one(
    scenario: &Scenario,
    study: &MillingStudy,
    spindle_rad_s: f64,
    depth_m: f64,
    predicted: bool,
) -> Result<StabilityRun, SimError> {
    let changed = at(scenario, study, spindle_rad_s, depth_m)?;
    let end = Run::of(&changed).end()?;
    let duration_s = changed.run.duration_s;
    let value = |name: &str| {
        let found = end.scalars.iter().find(|one: &&Scalar| one.name == name);
        found.map_or(f64::NAN, |one| one.value)
    };
    let growth_per_s = value("milling.growth_rate");
    // Vibration that outgrows the linear range and stays there neither grows nor dies away.
    let level = value("milling.vibration_level") / study.cut.nominal.feed_per_tooth_m;
    let fallen = (growth_per_s * duration_s).exp() < FALLEN;
    let chatters = match &end.outcome {
        end if !end.reached_end() => Some(true),
        _ if level > study.linear_share() && !fallen => Some(true),
        // Nothing vibrates.
        _ if growth_per_s.is_nan() && level < NOISE * study.linear_share() => Some(false),
        _ => growth_per_s.is_finite().then_some(growth_per_s > 0.0),
    };
    Ok(StabilityRun {
        spindle_rad_s,
        depth_m,
        chatters,
        growth_per_s,
        chatter_hz: value("milling.chatter_frequency"),
        predicted,
    })
}

/// The scenario at another speed and depth, the feed per tooth as it was.
fn at(
    scenario: &Scenario,
    study: &MillingStudy,
    spindle_rad_s: f64,
    depth_m: f64,
) -> Result<Scenario, SimError> {
    let table = "process.milling";
    let mut overrides = vec![
        (
            format!("{table}.spindle_rpm"),
            format!("{:?}", spindle_rad_s * 60.0 / TAU),
        ),
        (
            format!("{table}.axial_depth_mm"),
            format!("{:?}", depth_m * 1e3),
        ),
    ];
    let feed = format!("{table}.feed_mm_per_s");
    if scenario.gives(&feed) {
        let scaled = study.cut.feed_m_per_s() * spindle_rad_s / study.cut.spindle_rad_s;
        overrides.push((feed, format!("{:?}", scaled * 1e3)));
    }
    let changed = scenario.with_overrides(&overrides)?;
    let ProcessSpec::Milling(milling) = &changed.process else {
        return Ok(changed);
    };
    let duration_s = milling.pass_s().min(LONGEST_S);
    let duration = ("run.duration_s".to_owned(), format!("{duration_s:?}"));
    Ok(changed.with_overrides(&[duration])?)
}
