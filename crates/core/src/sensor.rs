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
    /// one the channel holds its value. What arrives late follows from what was there by then.
    pub fn apply(&self, time_s: &[f64], values: &mut [f64]) {
        if self.delay_s != 0.0 {
            let rows = time_s.len();
            let known = |row: usize| if self.delay_s > 0.0 { row + 1 } else { rows };
            let wanted = time_s.iter().map(|t| t - self.delay_s).enumerate();
            let late: Vec<f64> = wanted
                .map(|(row, t)| {
                    let after = time_s[..known(row)].partition_point(|sample| *sample <= t);
                    interpolate(|i| (time_s[i], values[i]), known(row), after, t)
                })
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

/// Hermite's cubic between the samples `after - 1` and `after` of `count`, third order for slopes
/// by three samples each; held beyond the ends.
fn interpolate(
    sample: impl Fn(usize) -> (f64, f64),
    count: usize,
    after: usize,
    time_s: f64,
) -> f64 {
    if after == 0 || after == count {
        return sample(after.min(count - 1)).1;
    }
    let ((t0, y0), (t1, y1)) = (sample(after - 1), sample(after));
    let secant = |i: usize| {
        let ((t0, y0), (t1, y1)) = (sample(i), sample(i + 1));
        (t1 - t0, (y1 - y0) / (t1 - t0))
    };
    let (step, slope) = secant(after - 1);
    let before = (after >= 2).then(|| secant(after - 2));
    let beyond = (after + 1 < count).then(|| secant(after));
    // by a parabola through the sample and two neighbours: those beside it, or the next two
    let beside = |(h, d): (f64, f64)| (step * d + h * slope) / (step + h);
    let beyond_slope = |(h, d): (f64, f64)| slope + step * (slope - d) / (step + h);
    let first = before.map(beside).or(beyond.map(beyond_slope));
    let second = beyond.map(beside).or(before.map(beyond_slope));
    let (u, v) = (first.unwrap_or(slope), second.unwrap_or(slope));
    let part = (time_s - t0) / (t1 - t0);
    let rest = 1.0 - part;
    let bend = part * rest * step * ((u - slope) * rest - (v - slope) * part);
    y0 + (y1 - y0) * part + bend
}

#[derive(Debug, Clone, Copy)]
struct Filtered {
    time_s: f64,
    input: f64,
    output: f64,
    /// Interval before the sample and the input's slope over it; `None` at the first.
    before: Option<(f64, f64)>,
}

/// A sensor that is fed one sample after the other.
#[derive(Debug, Clone)]
pub struct Sensor {
    model: ChannelModel,
    /// Samples that the delay still needs, oldest first.
    history: VecDeque<(f64, f64)>,
    /// What the low pass was at the last sample.
    filtered: Option<Filtered>,
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
        // those around the wanted time stay, and one before them
        while self.history.len() > 3 && self.history[2].0 <= wanted {
            self.history.pop_front();
        }
        let after = self.history.partition_point(|(t, _)| *t <= wanted);
        interpolate(|i| self.history[i], self.history.len(), after, wanted)
    }

    /// `τ y' + y = x`, exact for an input on the parabola through the last three samples, at rest
    /// before the first.
    fn low_pass(&mut self, time_s: f64, value: f64) -> f64 {
        let tau = self.model.low_pass_s;
        if tau <= 0.0 {
            return value;
        }
        let Some(last) = self.filtered else {
            self.filtered = Some(Filtered {
                time_s,
                input: value,
                output: value,
                before: None,
            });
            return value;
        };
        let step = time_s - last.time_s;
        let slope = (value - last.input) / step;
        // half the second derivative
        let bend = (last.before).map_or(0.0, |(h, d)| (slope - d) / (step + h));
        // x - τ x' + τ² x'' solves the equation; the rest dies away
        let settled = |input: f64, slope: f64| input - tau * slope + 2.0 * tau * tau * bend;
        let (from, to) = (
            settled(last.input, slope - bend * step),
            settled(value, slope + bend * step),
        );
        let output = to + (last.output - from) * (-step / tau).exp();
        self.filtered = Some(Filtered {
            time_s,
            input: value,
            output,
            before: Some((step, slope)),
        });
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

    /// Third order: a parabola arrives exactly, and an error is an eighth with half the interval.
    #[test]
    fn verify_what_is_smooth_arrives_late_to_third_order() {
        let error = |dt: f64, delay_s: f64, f: fn(f64) -> f64| {
            let model = ChannelModel {
                delay_s,
                ..ChannelModel::default()
            };
            let (time, mut values) = column(dt, (0.5 / dt).round() as usize, f);
            model.apply(&time, &mut values);
            let inner = time
                .iter()
                .zip(values)
                .filter(|(t, _)| **t > 0.1 && **t < 0.4);
            inner.fold(0.0_f64, |worst, (t, got)| {
                worst.max((got - f(t - delay_s)).abs())
            })
        };
        for delay in [0.0003, 0.0027, 0.0131, -0.0052] {
            assert!(error(1e-3, delay, |t| 3.0 * t * t - t) < 1e-13, "{delay}");
            let swing = |t: f64| (250.0 * t).sin();
            // the interval's part that a delay leaves stays the same
            let (coarse, fine) = (error(1e-3, delay, swing), error(5e-4, 0.5 * delay, swing));
            assert!(coarse < 3e-3, "{delay}: {coarse}");
            let order = (coarse / fine).log2();
            assert!((2.8..4.3).contains(&order), "{delay}: {order}");
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

    /// The steady answer to a swing: its amplitude and phase to third order in the interval.
    #[test]
    fn verify_low_pass_of_a_swing_to_third_order() {
        let (omega, tau) = (250.0_f64, 0.004);
        let error = |dt: f64| {
            let (time, mut values) = column(dt, (0.5 / dt).round() as usize, |t| (omega * t).sin());
            let model = ChannelModel {
                low_pass_s: tau,
                ..ChannelModel::default()
            };
            model.apply(&time, &mut values);
            let steady =
                |t: f64| (omega * t - (omega * tau).atan()).sin() / (omega * tau).hypot(1.0);
            let late = time.iter().zip(values).filter(|(t, _)| **t > 0.3);
            late.fold(0.0_f64, |worst, (t, got)| {
                worst.max((got - steady(*t)).abs())
            })
        };
        let (coarse, fine) = (error(1e-3), error(5e-4));
        assert!(coarse < 2e-3, "{coarse}");
        let order = (coarse / fine).log2();
        assert!((2.8..3.3).contains(&order), "{order}");
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
