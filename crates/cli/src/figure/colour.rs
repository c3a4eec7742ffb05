//! What the colours of a map mean.

use serde::Serialize;
use truecut_recording::{Unit, UserUnit};

use crate::text::reading_unit;

/// Colours from one value to another. What lies beyond an end has its colour.
#[derive(Clone, Debug, Serialize)]
pub struct ColourScale {
    /// Quantity and unit, for people.
    pub label: String,
    /// At the ends, in that unit.
    pub low: f64,
    pub high: f64,
    /// Two colours that meet at zero in the middle; else one run of colours.
    pub diverging: bool,
    #[serde(skip)]
    unit: UserUnit,
}

impl ColourScale {
    /// From nothing to a largest value, SI.
    pub fn from_zero(name: &str, unit: Unit, most: f64) -> ColourScale {
        Self::of(name, unit, [0.0, most], false)
    }

    /// As far to either side of nothing, SI.
    pub fn about_zero(name: &str, unit: Unit, most: f64) -> ColourScale {
        Self::of(name, unit, [-most, most], true)
    }

    fn of(name: &str, unit: Unit, ends: [f64; 2], diverging: bool) -> ColourScale {
        let unit = reading_unit(unit, ends[1]);
        // A map of nothing but zeros has colours, too.
        let ends = if ends[1] > 0.0 { ends } else { [ends[0], 1.0] };
        let label = match &unit.symbol[..] {
            "" | "1" => name.to_owned(),
            symbol => format!("{name} [{symbol}]"),
        };
        let [low, high] = ends.map(|end| unit.from_si(end));
        ColourScale {
            label,
            low,
            high,
            diverging,
            unit,
        }
    }

    /// Where a value, SI, lies between the ends, 0 to 1; none for what is no number.
    pub fn share(&self, value: f64) -> Option<f64> {
        let share = (self.unit.from_si(value) - self.low) / (self.high - self.low);
        (!share.is_nan()).then(|| share.clamp(0.0, 1.0))
    }

    /// The same as a shade of [`super::Style::Cells`]: from −1 where the colours meet at zero,
    /// else from 0; not a number for none.
    pub fn shade(&self, value: f64) -> f64 {
        match (self.share(value), self.diverging) {
            (Some(share), true) => 2.0 * share - 1.0,
            (Some(share), false) => share,
            (None, _) => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_lie_between_the_ends_in_the_unit_that_is_read() {
        let depth = ColourScale::from_zero("depth", Unit::Metre, 20e-6);
        assert_eq!((depth.label.as_str(), depth.low), ("depth [µm]", 0.0));
        assert!((depth.high - 20.0).abs() < 1e-9);
        for (value, share) in [
            (0.0, 0.0),
            (5e-6, 0.25),
            (20e-6, 1.0),
            (1.0, 1.0),
            (-1.0, 0.0),
        ] {
            assert!((depth.share(value).unwrap() - share).abs() < 1e-12);
            assert!((depth.shade(value) - share).abs() < 1e-12);
        }
        assert!(depth.share(f64::NAN).is_none() && depth.shade(f64::NAN).is_nan());
        let left = ColourScale::about_zero("left", Unit::Metre, 20e-6);
        assert!((left.low + 20.0).abs() < 1e-9 && left.shade(0.0).abs() < 1e-12);
        assert!((left.shade(-10e-6) + 0.5).abs() < 1e-12);
        let nothing = ColourScale::from_zero("nothing", Unit::One, 0.0);
        assert_eq!(nothing.share(0.0), Some(0.0));
    }
}
