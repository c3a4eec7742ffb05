//! Numbered axes: round numbers.

/// An axis with its range and its numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    low: f64,
    high: f64,
    /// Places of the numbers.
    pub(crate) ticks: Vec<f64>,
}

impl Axis {
    /// An axis that holds all these values, with about so many numbers. NaN and infinities do not
    /// count.
    pub(crate) fn around(values: impl Iterator<Item = f64>, count: usize) -> Axis {
        let usable = values.filter(|value| value.is_finite());
        let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        // A flat curve gets an axis around it, wide enough for its numbers to differ.
        let flat = high - low <= 1e-12 * low.abs().max(high.abs());
        let margin = if flat {
            (0.1 * low.abs()).max(f64::MIN_POSITIVE.sqrt())
        } else {
            0.0
        };
        let (low, high) = (low - margin, high + margin);
        let step = round_step((high - low) / count as f64);
        let (first, last) = ((low / step + 1e-9).floor(), (high / step - 1e-9).ceil());
        let ticks = (0..=(last - first) as usize)
            .map(|i| (first + i as f64) * step)
            .collect();
        Axis {
            low: first * step,
            high: last * step,
            ticks,
        }
    }

    /// The place of a value, 0 at the low end and 1 at the high one; `None` if it cannot be drawn.
    pub(crate) fn place(&self, value: f64) -> Option<f64> {
        let place = (value - self.low) / (self.high - self.low);
        place.is_finite().then_some(place)
    }

    /// The low and the high end.
    pub(crate) fn ends(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// Where the axis holds logarithms (base 10): places of 1, 2 and 5 times powers of ten within
    /// it, and these numbers; its own ticks with the numbers that they are of, if that were one.
    pub(crate) fn numbers_of_logarithms(&self) -> Vec<(f64, String)> {
        let within = |place: &f64| (self.low - NEAR..=self.high + NEAR).contains(place);
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        let round = |steps: &[f64]| -> Vec<f64> {
            let places = decades.clone().flat_map(|decade| {
                let places = steps.iter().map(move |s| s.log10() + f64::from(decade));
                places.collect::<Vec<_>>()
            });
            places.filter(within).collect()
        };
        // Over many decades the powers of ten are enough.
        let places = match round(&[1.0, 2.0, 5.0]) {
            many if many.len() > 7 => round(&[1.0]),
            few if few.len() < 2 => self.ticks.clone(),
            some => some,
        };
        let number = |place: f64| {
            let value = 10f64.powf(place);
            let written = truecut_recording::significant(value, 2);
            // `0.20` for a fifth says no more than `0.2`.
            match written.contains('.') && !written.contains('e') {
                true => written
                    .trim_end_matches('0')
                    .trim_end_matches('.')
                    .to_owned(),
                false => written,
            }
        };
        places
            .iter()
            .map(|place| (*place, number(*place)))
            .collect()
    }

    /// A tick as written, with no more digits than its neighbours need to differ.
    pub(crate) fn label(&self, tick: f64) -> String {
        let step = match self.ticks.as_slice() {
            [first, second, ..] => second - first,
            _ => tick,
        };
        let largest = self.low.abs().max(self.high.abs());
        if tick != 0.0 && !(1e-4..1e6).contains(&largest) {
            return format!("{tick:.1e}");
        }
        let decimals = (-step.abs().log10().floor()).clamp(0.0, 9.0) as usize;
        let decimals = if step.abs() * 10f64.powi(decimals as i32) < 0.999 {
            decimals + 1
        } else {
            decimals
        };
        format!("{:.decimals$}", if tick == 0.0 { 0.0 } else { tick })
    }
}

/// Rounding at an end.
const NEAR: f64 = 1e-9;

/// The next 1, 2 or 5 times a power of ten.
fn round_step(step: f64) -> f64 {
    let decade = 10f64.powf(step.log10().floor());
    let share = step / decade;
    decade
        * [1.0, 2.0, 5.0, 10.0]
            .into_iter()
            .find(|nice| share <= nice * (1.0 + 1e-9))
            .unwrap_or(10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks.iter().map(|tick| axis.label(*tick)).collect()
    }

    #[test]
    fn numbers_are_round() {
        let axis = Axis::around([0.3, 9.2].into_iter(), 5);
        assert_eq!(labels(&axis), ["0", "2", "4", "6", "8", "10"]);
        let axis = Axis::around([-0.013, 0.021].into_iter(), 5);
        assert_eq!(
            labels(&axis),
            ["-0.02", "-0.01", "0.00", "0.01", "0.02", "0.03"]
        );
    }

    #[test]
    fn verify_ends_and_middle() {
        let axis = Axis::around([0.0, 10.0].into_iter(), 5);
        assert_eq!(
            (axis.place(0.0), axis.place(5.0), axis.place(10.0)),
            (Some(0.0), Some(0.5), Some(1.0))
        );
        assert_eq!(axis.place(f64::NAN), None);
    }

    #[test]
    fn logarithms_are_numbered_with_what_they_are_of() {
        let numbers = |low: f64, high: f64| -> Vec<String> {
            let axis = Axis::around([low, high].into_iter(), 5);
            let numbers = axis.numbers_of_logarithms();
            for (place, number) in &numbers {
                let value: f64 = number.parse().expect("a number");
                assert!((value.log10() - place).abs() < 0.03, "{number} at {place}");
            }
            numbers.into_iter().map(|(_, number)| number).collect()
        };
        assert_eq!(numbers(-1.0, 0.0), ["0.1", "0.2", "0.5", "1"]);
        assert_eq!(numbers(1.0, 2.0), ["10", "20", "50", "100"]);
        // The axis ends at round numbers of its own: from -4 to 4.
        assert_eq!(numbers(-4.0, 3.0).len(), 9);
        assert!(numbers(0.32, 0.6).len() >= 2);
    }

    #[test]
    fn nothing_and_flat_curves_still_have_an_axis() {
        for values in [vec![], vec![f64::NAN], vec![3.0, 3.0], vec![0.0]] {
            let axis = Axis::around(values.iter().copied(), 5);
            let (low, high) = axis.ends();
            assert!(low < high && axis.ticks.len() >= 2, "{values:?}: {axis:?}");
        }
    }
}
