//! A stretch of a recording.

use std::fmt;

/// Which rows count. Both ends included; what is not given does not bound. Fractions are of the
/// recorded duration.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Window {
    /// Not before this time.
    pub from_s: Option<f64>,
    /// Not after this time.
    pub to_s: Option<f64>,
    /// Not before this share of the run.
    pub from_fraction: Option<f64>,
    /// Not after this share of the run.
    pub to_fraction: Option<f64>,
}

impl Window {
    /// The whole run.
    pub const ALL: Window = Window {
        from_s: None,
        to_s: None,
        from_fraction: None,
        to_fraction: None,
    };

    /// The rows that count, of ascending times.
    pub fn rows(&self, time_s: &[f64]) -> std::ops::Range<usize> {
        let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else {
            return 0..0;
        };
        let at = |fraction: f64| first + fraction * (last - first);
        let from_s = self
            .from_s
            .unwrap_or(f64::NEG_INFINITY)
            .max(self.from_fraction.map_or(f64::NEG_INFINITY, at));
        let to_s = self
            .to_s
            .unwrap_or(f64::INFINITY)
            .min(self.to_fraction.map_or(f64::INFINITY, at));
        // Times are sums of steps: a row a hair outside is meant to be inside.
        let hair_s = 1e-9 * (last - first);
        let start = time_s.partition_point(|&time| time < from_s - hair_s);
        let end = time_s.partition_point(|&time| time <= to_s + hair_s);
        start..end.max(start)
    }
}

impl fmt::Display for Window {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = [("from", self.from_s), ("to", self.to_s)];
        let shares = [("from", self.from_fraction), ("to", self.to_fraction)];
        let seconds = seconds
            .into_iter()
            .filter_map(|(word, value)| Some(format!(" {word} {} s", value?)));
        let shares = shares
            .into_iter()
            .filter_map(|(word, value)| Some(format!(" {word} {} %", 100.0 * value?)));
        seconds
            .chain(shares)
            .try_for_each(|part| formatter.write_str(&part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_keeps_its_ends_and_may_be_empty() {
        let time_s: Vec<f64> = (0..=10).map(|row| 0.1 * f64::from(row)).collect();
        assert_eq!(
            Window {
                from_s: Some(0.3),
                to_s: Some(0.7),
                ..Window::ALL
            }
            .rows(&time_s),
            3..8
        );
        assert_eq!(
            Window {
                from_s: Some(0.3),
                from_fraction: Some(0.5),
                ..Window::ALL
            }
            .rows(&time_s),
            5..11
        );
        assert_eq!(
            Window {
                from_s: Some(2.0),
                ..Window::ALL
            }
            .rows(&time_s)
            .len(),
            0
        );
        assert_eq!(Window::ALL.rows(&[]), 0..0);
    }
}
