//! What a sensor makes of a channel: delay, low pass, gain, offset, drift, in this order.
//!
//! The model is pure: [`Sensor`] is fed one sample after the other, [`ChannelModel::apply`] takes a
//! whole column. It never acts on the physics.

use std::collections::VecDeque;

/// Measurement of one channel, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelModel {
    /// How late the channel arrives, s. Negative if it arrives early, which only a whole column
    /// can.
    pub delay_s: f64,
    /// Time constant of a filter of first order, s; 0 for none.
    pub low_pass_s: f64,
    /// Times the true value.
    pub gain: f64,
    /// Beyond it, in the channel's unit.
    pub offset: f64,
    /// `amplitude (1 - exp(-t / time))`: amplitude in the channel's unit and time in s.
    pub drift: Option<(f64, f64)>,
}

impl Default for ChannelModel {
    fn default() -> Self {
        Self {
            delay_s: 0.0,
            low_pass_s: 0.0,
            gain: 1.0,
            offset: 0.0,
            drift: None,
        }
    }
}

impl ChannelModel {
    /// Measures a whole column in place; `time_s` rises. Before the first sample and after the last
    /// one the channel holds its value.
    pub fn apply(&self, time_s: &[f64], values: &mut [f64]) {
        if self.delay_s != 0.0 {
            let late: Vec<f64> = (time_s.iter())
                .map(|t| interpolate(time_s, values, t - self.delay_s))
                .collect();
            values.copy_from_slice(&late);
        }
        let rest = ChannelModel {
            delay_s: 0.0,
            ..*self
        };
        let mut sensor = Sensor::new(rest);
        for (t, value) in time_s.iter().zip(values) {
            *value = sensor.measure(*t, *value);
        }
    }
}

/// Linear interpolation, held beyond the ends.
fn interpolate(time_s: &[f64], values: &[f64], t: f64) -> f64 {
    let after = time_s.partition_point(|sample| *sample < t);
    if after == 0 || after == time_s.len() {
        return values[after.min(time_s.len() - 1)];
    }
    between(
        (time_s[after - 1], values[after - 1]),
        (time_s[after], values[after]),
        t,
    )
}

fn between(before: (f64, f64), after: (f64, f64), t: f64) -> f64 {
    let part = (t - before.0) / (after.0 - before.0);
    before.1 + (after.1 - before.1) * part
}

/// A sensor that is fed one sample after the other.
#[derive(Debug, Clone)]
pub struct Sensor {
    model: ChannelModel,
    /// Samples that the delay still needs, oldest first.
    history: VecDeque<(f64, f64)>,
    /// Time, input and output of the low pass at the last sample.
    filtered: Option<(f64, f64, f64)>,
}

impl Sensor {
    /// A sensor before its first sample.
    pub fn new(model: ChannelModel) -> Self {
        Self {
            model,
            history: VecDeque::new(),
            filtered: None,
        }
    }

    /// What is recorded at `time_s` (rising from call to call) for the true value then.
    pub fn measure(&mut self, time_s: f64, value: f64) -> f64 {
        let late = self.delayed(time_s, value);
        let smooth = self.low_pass(time_s, late);
        let m = &self.model;
        let drift = m.drift.map_or(0.0, |(amplitude, time)| {
            -amplitude * (-time_s / time).exp_m1()
        });
        m.gain * smooth + (m.offset + drift)
    }

    fn delayed(&mut self, time_s: f64, value: f64) -> f64 {
        if self.model.delay_s <= 0.0 {
            return value;
        }
        self.history.push_back((time_s, value));
        let wanted = time_s - self.model.delay_s;
        // Two samples stay: those around the wanted time.
        while self.history.len() > 2 && self.history[1].0 <= wanted {
            self.history.pop_front();
        }
        match (self.history.front(), self.history.get(1)) {
            (Some(before), Some(after)) if before.0 <= wanted => between(*before, *after, wanted),
            (Some(first), _) => first.1,
            (None, _) => value,
        }
    }

    /// `τ y' + y = x`, exact for an input that is linear between samples.
    fn low_pass(&mut self, time_s: f64, value: f64) -> f64 {
        let tau = self.model.low_pass_s;
        if tau <= 0.0 {
            return value;
        }
        let output = self.filtered.map_or(value, |(t, x, y)| {
            let step = time_s - t;
            let lag = tau * (value - x) / step;
            value - lag + (y - x + lag) * (-step / tau).exp()
        });
        self.filtered = Some((time_s, value, output));
        output
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(dt: f64, n: usize, f: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..n).map(|i| i as f64 * dt).collect();
        let values = time.iter().map(|t| f(*t)).collect();
        (time, values)
    }

    #[test]
    fn verify_a_ramp_arrives_late_by_the_delay_or_early() {
        for delay in [0.0004, 0.001, 0.0137, -0.0052] {
            let (time, mut values) = column(1e-3, 200, |t| 3.0 * t);
            let model = ChannelModel {
                delay_s: delay,
                ..ChannelModel::default()
            };
            model.apply(&time, &mut values);
            for (t, got) in time.iter().zip(&values) {
                let expected = 3.0 * (t - delay).clamp(0.0, time[199]);
                assert!((got - expected).abs() < 1e-12, "{delay} {t}: {got}");
            }
        }
    }

    /// A ramp behind a low pass is late by the time constant: `y = t - τ (1 - exp(-t / τ))`.
    #[test]
    fn verify_low_pass_of_a_ramp_at_any_sample_interval() {
        for dt in [1e-4, 3e-3, 0.05] {
            let (time, mut values) = column(dt, 50, |t| t);
            let model = ChannelModel {
                low_pass_s: 0.01,
                ..ChannelModel::default()
            };
            model.apply(&time, &mut values);
            for (t, got) in time.iter().zip(&values) {
                let expected = t + 0.01 * (-t / 0.01).exp_m1();
                assert!((got - expected).abs() < 1e-12, "{dt} {t}");
            }
        }
    }

    #[test]
    fn verify_gain_offset_and_drift() {
        let (time, mut values) = column(0.1, 100, |t| t.sin());
        let model = ChannelModel {
            gain: 1.1,
            offset: -0.2,
            drift: Some((0.5, 3.0)),
            ..ChannelModel::default()
        };
        model.apply(&time, &mut values);
        for (t, got) in time.iter().zip(&values) {
            let expected = 1.1 * t.sin() - 0.2 + 0.5 * (1.0 - (-t / 3.0).exp());
            assert!((got - expected).abs() < 1e-14, "{t}");
        }
    }

    /// A run and a column are measured alike.
    #[test]
    fn samples_and_columns_agree() {
        let model = ChannelModel {
            delay_s: 0.0123,
            low_pass_s: 0.004,
            gain: -2.0,
            offset: 0.1,
            drift: Some((1.0, 0.3)),
        };
        let (time, values) = column(2e-3, 300, |t| (40.0 * t).sin());
        let mut whole = values.clone();
        model.apply(&time, &mut whole);
        let mut sensor = Sensor::new(model);
        for (i, (t, value)) in time.iter().zip(values).enumerate() {
            assert!((sensor.measure(*t, value) - whole[i]).abs() < 1e-13, "{t}");
        }
    }
}
