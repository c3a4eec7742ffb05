//! Where a time lies among samples, and what they say there.

use crate::spline::between;

/// A time beside the samples of a series; how far apart those it lies between are, or how far off
/// the nearest is.
pub(super) enum Place {
    Sample {
        row: usize,
        apart_s: f64,
    },
    Line {
        row: usize,
        part: f64,
        apart_s: f64,
    },
    Cubic {
        first: usize,
        weights: [f64; 4],
        apart_s: f64,
        /// Share of the interval in the middle.
        part: f64,
    },
}

impl Place {
    pub fn value(&self, values: &[f64]) -> f64 {
        match self {
            Place::Sample { row, .. } => values[*row],
            Place::Line { row, part, .. } => {
                let (y0, y1) = (values[*row], values[row + 1]);
                y0 + (y1 - y0) * part
            }
            Place::Cubic { first, weights, .. } => {
                let terms = weights.iter().zip(&values[*first..]);
                terms.map(|(weight, value)| weight * value).sum()
            }
        }
    }

    /// As [`Place::value`], on the spline with these slopes between samples no further apart than
    /// `most_apart_s`, the first and the last two, too.
    pub fn splined(&self, values: &[f64], slopes: &[f64], most_apart_s: f64) -> f64 {
        let (row, part, apart_s) = match *self {
            Place::Sample { .. } => return self.value(values),
            Place::Line { row, part, apart_s } => (row, part, apart_s),
            Place::Cubic {
                first,
                part,
                apart_s,
                ..
            } => (first + 1, part, apart_s),
        };
        if apart_s > most_apart_s {
            return self.value(values);
        }
        let [ends, slopes] = [values, slopes].map(|of| [of[row], of[row + 1]]);
        between(ends, slopes, apart_s, part)
    }

    pub fn apart_s(&self) -> f64 {
        let (Place::Sample { apart_s, .. }
        | Place::Line { apart_s, .. }
        | Place::Cubic { apart_s, .. }) = self;
        *apart_s
    }

    pub fn squares(&self) -> f64 {
        match self {
            Place::Sample { .. } => 1.0,
            Place::Line { part, .. } => (1.0 - part).powi(2) + part.powi(2),
            Place::Cubic { weights, .. } => weights.iter().map(|w| w * w).sum(),
        }
    }
}
