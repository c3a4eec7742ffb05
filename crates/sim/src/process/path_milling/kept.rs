//! What is kept of a pass by place.

use super::MillingStep;
use super::cut::Cut;
use super::peak::Peak;
use nalgebra::Vector3;
use std::collections::VecDeque;
use truecut_core::cutting::milling::cut::MillingLoads;

/// Stretches of a path by which things are told.
const STRETCHES: usize = 200;
/// Shortest stretch, m.
const SHORTEST_M: f64 = 0.5e-3;

/// Sums over a stretch of the path.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Stretch {
    count: u64,
    force_n2: f64,
    deflection_m2: f64,
    /// Of the change of the deflection from one tooth to the next.
    changes: u64,
    change_m2: f64,
}

impl Stretch {
    fn rms(square: f64, count: u64) -> f64 {
        match count {
            0 => f64::NAN,
            count => (square / count as f64).sqrt(),
        }
    }

    pub fn force_n(&self) -> f64 {
        Self::rms(self.force_n2, self.count)
    }

    pub fn deflection_m(&self) -> f64 {
        Self::rms(self.deflection_m2, self.count)
    }

    pub fn vibration_m(&self) -> f64 {
        Self::rms(self.change_m2, self.changes)
    }
}

/// What is kept for the report.
#[derive(Debug, Clone)]
pub(super) struct Kept {
    pub stretch_m: f64,
    pub stretches: Vec<Stretch>,
    pub force_n: Peak,
    /// At each speed of the spindle.
    torque_n_m: Vec<Peak>,
    pub largest_deflection_m: f64,
    /// Steps since teeth cut last.
    idle: usize,
    /// Steps between two teeth that cut alike, at each speed of the spindle.
    periods: Vec<usize>,
    /// Which of the speeds holds.
    speed: usize,
    /// Deflections of the last period in the tool's axes, the latest last.
    before_m: VecDeque<Vector3<f64>>,
}

impl Kept {
    /// `periods` are the steps between two teeth that cut alike, at each speed of the spindle.
    pub fn new(length_m: f64, periods: impl IntoIterator<Item = f64>) -> Self {
        let stretch_m = (length_m / STRETCHES as f64).max(SHORTEST_M);
        let count = (length_m / stretch_m).ceil() as usize + 1;
        let each = periods.into_iter();
        let periods: Vec<usize> = each.map(|steps| (steps.round() as usize).max(1)).collect();
        Self {
            stretch_m,
            stretches: vec![Stretch::default(); count],
            force_n: Peak::default(),
            torque_n_m: vec![Peak::default(); periods.len()],
            largest_deflection_m: 0.0,
            idle: usize::MAX,
            periods,
            speed: 0,
            before_m: VecDeque::new(),
        }
    }

    /// The spindle runs at this one of its speeds.
    pub fn at_speed(&mut self, speed: usize) {
        if speed != self.speed {
            self.speed = speed;
            self.pause();
        }
    }

    /// What comes is not to be compared with what was.
    fn pause(&mut self) {
        self.before_m.clear();
        self.force_n.pause();
        self.torque_n_m.iter_mut().for_each(Peak::pause);
    }

    /// Largest torque at each speed of the spindle, N m.
    pub fn torques_n_m(&self) -> impl Iterator<Item = f64> {
        self.torque_n_m.iter().map(|peak| peak.largest)
    }

    /// A step, by which the cut has come; of an arm that swings in air nothing is kept.
    pub fn add(&mut self, step: &MillingStep, cut: &Cut) {
        self.idle = match step.loads.removal_m3_per_rad > 0.0 {
            true => 0,
            false => self.idle.saturating_add(1),
        };
        let period = self.periods[self.speed];
        if self.idle > period {
            self.pause();
            return;
        }
        let index = ((step.along_m / self.stretch_m) as usize).min(self.stretches.len() - 1);
        let stretch = &mut self.stretches[index];
        let force_n = step.force_on_tool_n.norm();
        let across_m = step.across_m();
        let in_plane = across_m.xy();
        stretch.count += 1;
        stretch.force_n2 += force_n * force_n;
        stretch.deflection_m2 += in_plane.norm_squared();
        if self.before_m.len() == period {
            let before = self.before_m.pop_front().unwrap_or_default();
            stretch.changes += 1;
            stretch.change_m2 += (in_plane - before.xy()).norm_squared();
        }
        self.before_m.push_back(across_m);
        self.peaks(step, cut);
        self.largest_deflection_m = self.largest_deflection_m.max(in_plane.norm());
    }

    fn peaks(&mut self, step: &MillingStep, cut: &Cut) {
        let Some(at) = step.at else {
            return;
        };
        let loads = |rotation_rad: f64| cut.evaluate(&cut.place_at(rotation_rad, &at));
        let force_n = |loads: &MillingLoads| loads.force_on_tool_n.norm();
        let torque_n_m = |loads: &MillingLoads| loads.moment_on_tool_n_m.dot(&at.axis()).abs();
        let (rotation_rad, now) = (at.rotation_rad, &step.loads);
        (self.force_n).add(rotation_rad, force_n(now), |at| force_n(&loads(at)));
        self.torque_n_m[self.speed].add(rotation_rad, torque_n_m(now), |at| torque_n_m(&loads(at)));
    }

    /// Half of the way between the extremes of the last period's deflections, m.
    pub fn amplitude_m(&self) -> f64 {
        let along = |axis: usize| {
            let values = self.before_m.iter().map(|place| place[axis]);
            let most = values.clone().fold(f64::NEG_INFINITY, f64::max);
            let least = values.fold(f64::INFINITY, f64::min);
            (0.5 * (most - least)).max(0.0)
        };
        along(0).hypot(along(1))
    }

    /// The stretch of the strongest vibration: its middle and its level, m.
    pub fn strongest(&self) -> Option<(f64, f64)> {
        let each = self.stretches.iter().enumerate();
        let levels = each.map(|(k, one)| ((k as f64 + 0.5) * self.stretch_m, one.vibration_m()));
        let known = levels.filter(|(_, level)| level.is_finite());
        known.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}
