//! Axes with ticks at round numbers, linear or logarithmic.

use truecut_recording::short_number;

/// Scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Scale {
    /// Linear.
    #[default]
    Linear,
    /// Logarithmic.
    Logarithmic,
}

/// An axis in its coordinate: the value, or its decimal logarithm.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    scale: Scale,
    pub low: f64,
    pub high: f64,
    pub ticks: Vec<f64>,
}

impl Axis {
    /// An axis that spans all values that can be drawn, with about `count` ticks.
    pub fn around(values: impl Iterator<Item = f64>, scale: Scale, count: usize) -> Axis {
        let coordinates = values.filter_map(|value| place(scale, value));
        let (low, high) = coordinates
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        let (low, high) = match (low, high) {
            (low, high) if low > high => (0.0, 1.0),
            (low, high) if high - low <= 1e-12 * low.abs().max(high.abs()) => (
                low - 0.5 * low.abs().max(1e-3),
                low + 0.5 * low.abs().max(1e-3),
            ),
            // A margin, so that no curve runs along the frame.
            (low, high) => (low - 0.03 * (high - low), high + 0.03 * (high - low)),
        };
        let ticks = match scale {
            Scale::Linear => round_ticks(low, high, count),
            Scale::Logarithmic => decades(low, high, count),
        };
        Axis {
            scale,
            low,
            high,
            ticks,
        }
    }

    /// The coordinate of a value; `None` if it cannot be drawn.
    pub fn place(&self, value: f64) -> Option<f64> {
        place(self.scale, value)
    }

    /// Label of a tick.
    pub fn label(&self, tick: f64) -> String {
        match self.scale {
            // Zero up to rounding.
            Scale::Linear if tick.abs() < 1e-9 * (self.high - self.low) => "0".to_owned(),
            Scale::Linear => shorter(tick),
            Scale::Logarithmic => shorter(10_f64.powf(tick)),
        }
    }
}

/// Without leading zeros in the exponent: there is little room.
fn shorter(value: f64) -> String {
    let text = short_number(value);
    match text.split_once('e') {
        Some((digits, exponent)) => {
            format!(
                "{}e{exponent}",
                digits.trim_end_matches('0').trim_end_matches('.')
            )
        }
        None => text,
    }
}

fn place(scale: Scale, value: f64) -> Option<f64> {
    let coordinate = match scale {
        Scale::Linear => value,
        Scale::Logarithmic => value.log10(),
    };
    coordinate.is_finite().then_some(coordinate)
}

/// Multiples of 1, 2 or 5 times a power of ten.
fn round_ticks(low: f64, high: f64, count: usize) -> Vec<f64> {
    let rough = (high - low) / count as f64;
    let power = 10_f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    let step = steps
        .into_iter()
        .find(|step| *step >= rough * (1.0 - 1e-9))
        .unwrap_or(rough);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|index| index as f64 * step).collect()
}

/// Powers of ten; also 2 and 5 times them where few powers lie in the range.
fn decades(low: f64, high: f64, count: usize) -> Vec<f64> {
    let inner: &[f64] = if high - low < 2.5 {
        &[1.0, 2.0, 5.0]
    } else {
        &[1.0]
    };
    let every = ((high - low) / count as f64).ceil().max(1.0) as i32;
    let all =
        (low.floor() as i32..=high.ceil() as i32).filter(|decade| decade.rem_euclid(every) == 0);
    let ticks = all.flat_map(|decade| inner.iter().map(move |m| f64::from(decade) + m.log10()));
    ticks.filter(|tick| (low..=high).contains(tick)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(values: &[f64], scale: Scale) -> Vec<String> {
        let axis = Axis::around(values.iter().copied(), scale, 5);
        axis.ticks.iter().map(|tick| axis.label(*tick)).collect()
    }

    #[test]
    fn numbers_are_round_and_inside() {
        assert_eq!(labels(&[0.0, 1.0], Scale::Linear), ["0", "0.5", "1"]);
        assert_eq!(labels(&[0.3, 9.2], Scale::Linear), ["2", "4", "6", "8"]);
        assert_eq!(
            labels(&[-0.013, 0.021], Scale::Linear),
            ["-0.01", "0", "0.01", "0.02"]
        );
        assert_eq!(
            labels(&[0.05, 1.5], Scale::Logarithmic),
            ["0.05", "0.1", "0.2", "0.5", "1"]
        );
        assert_eq!(
            labels(&[1.0, 1e6], Scale::Logarithmic),
            ["1", "100", "10000", "1e6"]
        );
    }

    #[test]
    fn nothing_and_flat_curves_still_have_an_axis() {
        for values in [vec![], vec![f64::NAN], vec![3.0, 3.0], vec![0.0]] {
            for scale in [Scale::Linear, Scale::Logarithmic] {
                let axis = Axis::around(values.iter().copied(), scale, 5);
                assert!(axis.low < axis.high, "{values:?}: {axis:?}");
            }
        }
    }

    #[test]
    fn places_on_a_logarithmic_axis() {
        let axis = Axis::around([1.0, 100.0].into_iter(), Scale::Logarithmic, 5);
        assert_eq!(
            (axis.place(10.0), axis.place(0.0), axis.place(-1.0)),
            (Some(1.0), None, None)
        );
    }
}
