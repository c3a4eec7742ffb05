//! Measured channels at other even times, by the resampler that reads files.

use super::place::Place;
use super::resample::{Base, Gaps, JITTER, Series, resample};
use super::{Measured, MeasuredChannel, Pass, Role};
use crate::unit::significant;

/// Part of an interval within which a pass begins with a sample.
const SLACK: f64 = 1e-6;

impl Measured {
    /// The same signals at times `interval_s` apart, from `start_s` of these data on, which is
    /// their time 0. What was sampled faster is smoothed first, as in
    /// [`measured`](super::measured), so that nothing folds back, and the noise that is stated is
    /// that of what is left. A value that would lie on a line, beside a gap or at an end, or
    /// between two passes is no measurement.
    pub fn taken_anew(&self, interval_s: f64, start_s: f64) -> Measured {
        let own_s = self.interval_s();
        let base = Base::within(start_s, interval_s, self.duration_s(), own_s);
        let time_s = base.times();
        let passes = self.passes_anew(interval_s, start_s, time_s.len());
        let begins: Vec<f64> = self.passes.iter().map(|pass| pass.start_s).collect();
        let between_passes: Vec<bool> = (time_s.iter())
            .map(|time| is_between(&begins, start_s + time, own_s))
            .collect();
        let mut notes = self.notes.clone();
        let channels = (self.channels.iter())
            .map(|channel| {
                let series = series_of(&self.time_s, channel);
                let gaps = Gaps {
                    bridged_s: JITTER * own_s,
                    smoothly_s: 0.0,
                    drives: channel.role == Role::Input,
                };
                let (values, mut valid) = resample(&series, &base, gaps);
                if channel.role == Role::Output && !series.is_smoothed(&base) {
                    for (valid, place) in valid.iter_mut().zip(series.places(&base)) {
                        *valid &= !matches!(place, Place::Line { .. });
                    }
                }
                for (valid, between) in valid.iter_mut().zip(&between_passes) {
                    *valid &= !between;
                }
                MeasuredChannel {
                    spec: channel.spec.clone(),
                    role: channel.role,
                    values,
                    valid,
                    noise: (channel.noise).map(|noise| series.noise_left(noise, &base, gaps)),
                    white_kept: channel.white_kept * series.white_kept(&base),
                }
            })
            .collect();
        if (interval_s / own_s - 1.0).abs() > SLACK {
            notes.push(format!(
                "taken at {} Hz in place of {} Hz",
                significant(1.0 / interval_s, 6),
                significant(1.0 / own_s, 6)
            ));
        }
        notes.extend(base.smoothed());
        Measured {
            source: self.source.clone(),
            time_s,
            passes,
            channels,
            notes,
        }
    }

    /// Passes, their samples counted anew.
    fn passes_anew(&self, interval_s: f64, start_s: f64, count: usize) -> Vec<Pass> {
        let first =
            |start_s: f64| ((start_s / interval_s - SLACK).ceil().max(0.0) as usize).min(count);
        let starts: Vec<f64> = (self.passes.iter())
            .map(|pass| pass.start_s - start_s)
            .collect();
        let passes = starts.iter().enumerate().map(|(index, start_s)| Pass {
            samples: first(*start_s)..starts.get(index + 1).map_or(count, |next| first(*next)),
            start_s: *start_s,
        });
        passes.filter(|pass| !pass.samples.is_empty()).collect()
    }
}

/// The valid samples of a channel.
fn series_of(time_s: &[f64], channel: &MeasuredChannel) -> Series {
    let rows = time_s.iter().zip(&channel.values).zip(&channel.valid);
    let valid = rows.filter(|(_, valid)| **valid);
    let (time_s, values) = valid.map(|((time, value), _)| (*time, *value)).unzip();
    Series {
        time_s,
        values,
        ..Series::default()
    }
}

/// Whether samples of two passes lie around a time: two to either side are looked at.
fn is_between(begins_s: &[f64], time_s: f64, interval_s: f64) -> bool {
    let place = time_s / interval_s;
    let nearest = place.round();
    if (place - nearest).abs() < SLACK {
        return false;
    }
    let first = place.floor() - 1.0;
    let mut sample = begins_s
        .iter()
        .skip(1)
        .map(|begin| (begin / interval_s - SLACK).ceil());
    sample.any(|sample| sample > first && sample <= first + 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::ChannelSpec;
    use crate::unit::Unit;

    fn channel(role: Role, values: Vec<f64>) -> MeasuredChannel {
        MeasuredChannel {
            spec: ChannelSpec::new("joint1.drive_torque", Unit::NewtonMetre, "drawn"),
            role,
            valid: vec![true; values.len()],
            values,
            noise: Some(0.5),
            white_kept: 1.0,
        }
    }

    fn sampled(role: Role, count: usize, interval_s: f64, of: impl Fn(f64) -> f64) -> Measured {
        let time_s: Vec<f64> = (0..count).map(|k| k as f64 * interval_s).collect();
        let values = time_s.iter().map(|t| of(*t)).collect();
        Measured {
            source: "drawn".into(),
            time_s,
            channels: vec![channel(role, values)],
            ..Measured::default()
        }
    }

    /// A hum above half the new rate goes, and does not come as a slow wave; what is slow stays.
    #[test]
    fn verify_nothing_folds_back() {
        for step in 0..8 {
            let every = 4.0 + 0.37 * f64::from(step);
            let hum_hz = 0.93 * 500.0 / every;
            let slow = |t: f64| (4.0 * t + 0.3).sin();
            let hum = |t: f64| (std::f64::consts::TAU * hum_hz * t).sin();
            let fast = sampled(Role::Output, 6000, 0.002, |t| slow(t) + hum(t));
            let there = fast.taken_anew(0.002 * every, 0.0);
            let rows = there.time_s.iter().zip(&there.channels[0].values);
            let inside = rows.skip(20).take(there.time_s.len() - 40);
            let worst = inside
                .map(|(t, x)| (x - slow(*t)).abs())
                .fold(0.0, f64::max);
            assert!(worst < 0.01, "{every}: {worst}");
            // White noise that is stated is smoothed as well.
            let left = there.channels[0].noise.unwrap();
            assert!(left < 0.5 && left > 0.5 * (0.5 / every).sqrt(), "{left}");
        }
    }

    /// A sample that is missing leaves no value on a line through its neighbours.
    #[test]
    fn lines_are_no_measurements() {
        let mut one = sampled(Role::Output, 400, 0.01, |t| (7.0 * t).sin());
        one.channels[0].valid[200] = false;
        let there = one.taken_anew(0.01, 0.003);
        let lost: Vec<usize> = (0..there.time_s.len())
            .filter(|row| !there.channels[0].valid[*row])
            .collect();
        assert_eq!(lost, [0, 198, 199, 200, 201, there.time_s.len() - 1]);
        let rows = there.time_s.iter().zip(&there.channels[0].values);
        for ((t, x), valid) in rows.zip(&there.channels[0].valid) {
            assert!(!valid || (x - (7.0 * (t + 0.003)).sin()).abs() < 1e-5);
        }
        let drives = sampled(Role::Input, 400, 0.01, |t| (7.0 * t).sin()).taken_anew(0.01, 0.003);
        assert!(drives.channels[0].valid.iter().all(|valid| *valid));
    }
}
