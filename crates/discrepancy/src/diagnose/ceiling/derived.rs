//! Groups of features that come from the residual itself: seen through its dynamics, and its lines.

use std::f64::consts::TAU;

use rayon::prelude::*;
use truecut_recording::{fft, significant};

use super::Target;
use super::waves::refined;
use crate::diagnose::data::LAGS;
use crate::diagnose::features::Group;
use crate::diagnose::moments::explained;
use crate::diagnose::noise::{ChannelNoise, dot};

impl Target<'_> {
    /// The groups seen through the dynamics of the residual itself, as its autoregression has them:
    /// a friction that depends on the position leaves a structure ringing, and it is the ringing
    /// that is measured.
    pub(super) fn through_dynamics(&self, groups: &[Group]) -> Vec<Group> {
        let ar = self.noise(self.residual, LAGS).ar;
        let groups = groups.par_iter().filter_map(|group| {
            let features: Vec<Vec<f64>> = group
                .features
                .iter()
                .map(|x| self.filtered(x, &ar))
                .collect();
            // An autoregression may come out unstable.
            let bounded = features.iter().flatten().all(|x| x.abs() < 1e6);
            bounded.then(|| Group {
                name: format!("{}, through the dynamics", group.name),
                by_signal: group.by_signal,
                chosen: group.chosen,
                filtered_by: LAGS,
                changes: group.changes,
                ..Group::of_signal("", features)
            })
        });
        groups.collect()
    }

    fn filtered(&self, input: &[f64], ar: &[f64]) -> Vec<f64> {
        let mut output = vec![0.0; input.len()];
        for range in &self.problem.data.trajectories {
            for t in range.clone() {
                let past = output[range.start..t].iter().rev();
                output[t] = input[t] + past.zip(ar).map(|(x, a)| x * a).sum::<f64>();
            }
        }
        output
    }
}

/// Lines that are looked for.
const LINES: usize = 4;
/// Sections of a third by which the frequency of a line is found about its peak: to a part of the
/// resolution at which a strong line leaves no more than its noise.
const SECTIONS: usize = 24;

impl Target<'_> {
    /// The strongest lines of the residual beyond its smooth spectrum, each found in what those
    /// before leave.
    pub(super) fn lines(&self) -> Vec<Group> {
        let mut lines: Vec<Group> = Vec::new();
        while lines.len() < LINES {
            let found: Vec<&Group> = lines.iter().collect();
            let left = self.without(&found, &ChannelNoise::WHITE);
            let Some(frequency) = self.strongest_line(&left) else {
                break;
            };
            let time = &self.problem.data.time_s;
            let wave = |f: fn(f64) -> f64| time.iter().map(|t| f(TAU * frequency * t)).collect();
            let name = format!("a line at {} Hz", significant(frequency, 3));
            lines.push(Group {
                chosen: 1,
                ..Group::of_time(name, vec![wave(f64::cos), wave(f64::sin)])
            });
        }
        lines
    }

    /// The frequency of the line that stands out most; of one that is most of what is left, if one
    /// is: two coefficients of an autoregression follow that as they would noise.
    fn strongest_line(&self, left: &[f64]) -> Option<f64> {
        let time = &self.problem.data.time_s;
        let at_rows: Vec<f64> = self.rows.iter().map(|&t| left[t]).collect();
        let explains = |hz: f64| {
            let wave = |f: fn(f64) -> f64| -> Vec<f64> {
                (self.rows.iter()).map(|&t| f(TAU * hz * time[t])).collect()
            };
            explained(&at_rows, &[wave(f64::cos), wave(f64::sin)])
        };
        let width = 0.5 / (time[time.len() - 1] - time[0]);
        let of_order = |order: usize| {
            let hz = self.line(left, order)?;
            Some(refined(hz, width, SECTIONS, &explains))
        };
        let plain = of_order(0).filter(|(gain, _)| *gain > 0.5 * dot(&at_rows, &at_rows));
        let (_, hz) = plain.or_else(|| of_order(self.order.min(2)))?;
        Some(hz)
    }

    fn line(&self, left: &[f64], order: usize) -> Option<f64> {
        let time = &self.problem.data.time_s;
        let (interval, duration) = (time[1] - time[0], time[time.len() - 1] - time[0]);
        // Of low order: it flattens the spectrum without swallowing a line.
        let e = self.noise(left, order).whiten(left, self.rows);
        // Samples that are no rows stay zero.
        let mut padded = vec![0.0; (8 * time.len()).next_power_of_two()];
        for (e, &t) in e.iter().zip(self.rows) {
            padded[t] = *e;
        }
        let length = padded.len();
        let spectrum = fft::forward(padded, length);
        let slowest = (2.0 * length as f64 * interval / duration).ceil() as usize;
        let powers = spectrum
            .iter()
            .map(|z| z.norm_sqr())
            .enumerate()
            .skip(slowest);
        let (peak, _) = powers.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(peak as f64 / (length as f64 * interval))
    }
}
