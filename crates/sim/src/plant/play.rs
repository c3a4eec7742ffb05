//! Play between motor and link, met within a step.
//!
//! A recurrence that is exact for springs needs of every other torque its mean under a hat of two
//! steps (as in [`smoothed`](super::smoothed)). What play takes away from spring and damper has
//! kinks where the flanks meet; over them the value at the instant is no such mean, and the impact
//! would come up to a step too early or too late. So the mean is taken along the path of the
//! wind-up: as it came, and as it goes on without the correction.

use super::law::JointDrive;

/// Points on either side of the instant at which a torque with a kink is taken.
const POINTS: usize = 16;

/// Play of one joint with the wind-up of the instant before.
#[derive(Debug, Clone, Copy)]
pub(super) struct Play {
    pub joint: usize,
    before: Option<f64>,
}

impl Play {
    pub fn new(joint: usize) -> Self {
        Self {
            joint,
            before: None,
        }
    }

    /// What is to be added to the torque at the instant so that it is the mean about the instant.
    /// `windup`, `rate`: at the instant; `ahead`: the wind-up one step of `dt_s` later.
    pub fn correction(
        &self,
        drive: &JointDrive,
        (windup, rate): (f64, f64),
        ahead: f64,
        dt_s: f64,
    ) -> f64 {
        let before = self.before.unwrap_or(windup - dt_s * rate);
        let span = (windup - before).abs().max((ahead - windup).abs());
        if !drive.meets_flank(windup, span, span / dt_s) {
            return 0.0;
        }
        let slope = 0.5 * (ahead - before);
        let bend = 0.5 * (ahead - 2.0 * windup + before);
        let points = (0..2 * POINTS).map(|i| (i as f64 + 0.5) / POINTS as f64 - 1.0);
        let taken = points.map(|s| {
            let along = windup + s * (slope + s * bend);
            (1.0 - s.abs()) * drive.taken_by_play(along, (slope + 2.0 * s * bend) / dt_s)
        });
        drive.taken_by_play(windup, rate) - taken.sum::<f64>() / POINTS as f64
    }

    /// Takes note of the wind-up at the instant.
    pub fn pass(&mut self, windup: f64) {
        self.before = Some(windup);
    }
}
