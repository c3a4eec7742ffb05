//! Where the arm's modes are, and how an effect moves them.

use rayon::prelude::*;

use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind};

use super::{FASTEST_MODE, Kind, Trial, reduced};
use crate::model::{Candidate, Model};

/// From the typical size so many steps down and up, so many to a power of ten.
const STEPS: std::ops::RangeInclusive<i32> = -6..=36;
const TO_A_POWER: f64 = 6.0;
/// Of modes so many times as fast as the nominal arm's slowest little is seen: motions are smooth.
const FAST: f64 = 2.0;
/// A mode that no size on the list moves by more than this part is no reason to look for one.
const MOVED: f64 = 0.02;
/// No more sizes are given, the largest: their simulations take longer than an answer is waited
/// for, and the least are found from usual starts as well.
const MOST_SIZES: usize = 150;

impl Trial {
    /// Sizes of a base that gives, from each of which to the next no mode that the samples show
    /// moves by more than `step_hz`.
    pub(super) fn sizes_by_mode(&self, candidate: &Candidate, step_hz: f64) -> Vec<f64> {
        let rings = candidate.kind == EffectKind::BaseCompliance;
        if !rings || !matches!(self.engine, Kind::Forward) {
            return Vec::new();
        }
        let [info] = candidate.kind.parameters() else {
            return Vec::new();
        };
        let steps: Vec<i32> = STEPS.collect();
        let ladder: Vec<(f64, Vec<f64>)> = (steps.par_iter())
            .map(|step| candidate.scale[0] * 10f64.powf(f64::from(*step) / TO_A_POWER))
            .filter(|size| (info.min..=info.max).contains(size))
            .filter_map(|size| Some((size, self.modes_with(candidate, size)?)))
            .collect();
        let Some(slowest) = self.slowest_mode_hz() else {
            return Vec::new();
        };
        let shown = (FAST * slowest).min(FASTEST_MODE / self.measured.interval_s());
        let mut sizes = Vec::new();
        for pair in ladder.windows(2) {
            let [(low, before), (high, after)] = pair else {
                continue;
            };
            let moves = before.iter().zip(after).filter(|(a, b)| a.min(**b) < shown);
            let (mut most, mut part) = (0.0_f64, 0.0_f64);
            for (a, b) in moves {
                most = most.max((b - a).abs());
                part = part.max((b / a - 1.0).abs());
            }
            // Where the slowest mode no longer swings within a step, all is as if it were free.
            if part < MOVED || before[0] < step_hz {
                continue;
            }
            let count = (most / step_hz).ceil().max(1.0);
            let own = (0..count as usize).map(|k| low * (high / low).powf(k as f64 / count));
            sizes.extend(own);
        }
        sizes.split_off(sizes.len().saturating_sub(MOST_SIZES))
    }

    fn modes_with(&self, candidate: &Candidate, size: f64) -> Option<Vec<f64>> {
        let effect = Effect {
            kind: candidate.kind,
            target: candidate.target.clone(),
            values: vec![size],
        };
        self.modes_hz(&self.scenario.with_effects(&[effect]).ok()?)
    }

    /// Slowest first; none of an arm without springs.
    pub(super) fn modes_hz(&self, scenario: &Scenario) -> Option<Vec<f64>> {
        let run = reduced(scenario, &self.measured, &self.robots);
        run.modes_hz().ok()
    }
}
