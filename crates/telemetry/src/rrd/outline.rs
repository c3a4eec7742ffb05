//! Where curves go, roughly: for a view's axes, and for a place of the legend that hides none.

use re_sdk_types::blueprint::archetypes::{ScalarAxis, TimeAxis};
use re_sdk_types::blueprint::components as kinds;
use re_sdk_types::datatypes::{Range1D, TimeInt, TimeRange, TimeRangeBoundary};

use super::nanoseconds;

/// A stretch of an outline is divided when it has so many pieces, and pieces are joined in pairs.
const MOST_PIECES: usize = 256;
/// Room above and below the curves, in parts of their height.
const ROOM: f64 = 0.06;
/// So many numbers of one power of ten stand in a plot of ours; more would be too close.
const MOST_NUMBERS: f64 = 11.5;
/// Room behind the last time, in parts of the whole.
const END_ROOM: f64 = 0.025;
/// How wide a legend is: in parts of a plot, without its names and for each letter of the longest.
const LEGEND: f64 = 0.05;
/// As [`LEGEND`].
const LETTER: f64 = 0.009;
/// How high a legend is, in parts of a plot: its frame, and each of its rows.
const FRAME: f64 = 0.05;
/// As [`FRAME`].
const LEGEND_ROW: f64 = 0.085;

/// The lowest and the highest value of one stretch of time after another. What is no number does
/// not count.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Outline {
    pieces: Vec<Piece>,
    /// How many rows a piece holds, as a power of two.
    rows: u32,
    /// Of the last piece.
    filled: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    from_s: f64,
    to_s: f64,
    low: f64,
    high: f64,
}

impl Piece {
    fn with(self, other: Piece) -> Piece {
        Piece {
            from_s: self.from_s.min(other.from_s),
            to_s: self.to_s.max(other.to_s),
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
}

impl Outline {
    /// Of a whole curve.
    pub(super) fn of(time_s: &[f64], values: &[f64]) -> Outline {
        let mut outline = Outline::default();
        outline.extend(time_s, values);
        outline
    }

    /// Adds rows.
    pub(super) fn extend(&mut self, time_s: &[f64], values: &[f64]) {
        for (time_s, value) in time_s.iter().zip(values) {
            let (low, high) = match value.is_finite() {
                true => (*value, *value),
                false => (f64::INFINITY, f64::NEG_INFINITY),
            };
            let row = Piece {
                from_s: *time_s,
                to_s: *time_s,
                low,
                high,
            };
            match self.pieces.last_mut() {
                Some(last) if self.filled < 1 << self.rows => {
                    *last = last.with(row);
                    self.filled += 1;
                }
                _ => {
                    self.pieces.push(row);
                    self.filled = 1;
                }
            }
            if self.pieces.len() > MOST_PIECES {
                let pairs = self.pieces.chunks(2);
                self.pieces = pairs
                    .map(|pair| pair.iter().copied().reduce(Piece::with).unwrap_or(pair[0]))
                    .collect();
                self.rows += 1;
            }
        }
    }

    fn range(&self) -> [f64; 2] {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        self.pieces.iter().fold(ends, |[low, high], piece| {
            [low.min(piece.low), high.max(piece.high)]
        })
    }
}

/// The curves of one plot, each with the number of shown units in one of SI.
pub(super) struct Plot<'a>(pub(super) Vec<(&'a Outline, f64)>);

impl Plot<'_> {
    /// The vertical axis, in the unit shown: all curves, at least as far as `least` either way, and
    /// with two numbers at least. A view that is opened while its recording loads keeps the range
    /// that it had then unless it is told one. `None` if there is nothing to show.
    pub(super) fn range(&self, least: f64) -> Option<[f64; 2]> {
        let ends = self.0.iter().map(|(outline, factor)| {
            let [low, high] = outline.range();
            [low * factor, high * factor]
        });
        let [low, high] = ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
        if !(low.is_finite() && high.is_finite()) {
            return None;
        }
        if high.max(-low) < least {
            // Numbers at the very ends would be cut off.
            return Some([-(1.0 + ROOM) * least, (1.0 + ROOM) * least]);
        }
        let size = match high - low {
            flat if flat <= 1e-9 * high.abs().max(low.abs()) => low.abs().max(1e-9),
            size => size,
        };
        Some(numbered([low - ROOM * size, high + ROOM * size]))
    }

    /// The corner in which a legend hides least of the curves.
    pub(super) fn corner(
        &self,
        names: &[&str],
        time_s: [f64; 2],
        [low, high]: [f64; 2],
    ) -> kinds::Corner2D {
        use kinds::Corner2D::{LeftBottom, LeftTop, RightBottom, RightTop};
        let longest = names.iter().map(|name| name.chars().count()).max();
        let wide = LEGEND + LETTER * longest.unwrap_or_default() as f64;
        let tall = FRAME + LEGEND_ROW * names.len() as f64;
        let hidden = |left: bool, top: bool| -> f64 {
            let share = |t: f64| (t - time_s[0]) / (time_s[1] - time_s[0]).max(f64::MIN_POSITIVE);
            let up = |value: f64| (value - low) / (high - low);
            let curves = self.0.iter().map(|(outline, factor)| {
                let pieces = outline.pieces.iter().filter(|piece| match left {
                    true => share(piece.from_s) < wide,
                    false => share(piece.to_s) > 1.0 - wide,
                });
                let seen = pieces.filter(|piece| match top {
                    true => up(piece.high * factor) > 1.0 - tall,
                    false => up(piece.low * factor) < tall,
                });
                let stretch = seen.map(|piece| {
                    let [from, to] = [piece.from_s, piece.to_s].map(share);
                    (to.min(1.0) - from.max(0.0)).max(1e-3)
                });
                stretch.sum::<f64>()
            });
            curves.sum()
        };
        let corners = [
            (LeftTop, hidden(true, true)),
            (RightTop, hidden(false, true)),
            (LeftBottom, hidden(true, false)),
            (RightBottom, hidden(false, false)),
        ];
        let least = corners.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
        least.map_or(LeftTop, |(corner, _)| corner)
    }
}

/// The viewer numbers powers of ten, and their multiples where these are far enough apart: a range
/// that holds only one of them is widened to the next.
fn numbered([low, high]: [f64; 2]) -> [f64; 2] {
    let step = 10f64.powf(((high - low) / MOST_NUMBERS).log10().ceil());
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    if last - first >= 1.0 {
        return [low, high];
    }
    let room = ROOM * (high - low);
    let (below, above) = ((first - 1.0) * step, (last + 1.0) * step);
    match low - below < above - high {
        true => [below - room, high],
        false => [low, above + room],
    }
}

/// An axis of values.
pub(super) fn value_axis(range: [f64; 2]) -> ScalarAxis {
    ScalarAxis::new().with_range(Range1D(range))
}

/// An axis of times, a little further than they go: the number at the end is to be seen. `None`
/// without a stretch of time.
pub(super) fn time_axis([from_s, to_s]: [f64; 2]) -> Option<TimeAxis> {
    if to_s <= from_s {
        return None;
    }
    let [start, end] = [from_s, to_s + END_ROOM * (to_s - from_s)]
        .map(|time_s| TimeRangeBoundary::Absolute(TimeInt(nanoseconds(time_s))));
    Some(TimeAxis::new().with_view_range(TimeRange { start, end }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(rows: u32) -> Vec<f64> {
        (0..rows).map(|row| 1e-3 * f64::from(row)).collect()
    }

    /// However many rows, an outline is small and holds every value at its time.
    #[test]
    fn an_outline_holds_its_curve() {
        for rows in [1, 255, 256, 257, 10_000, 100_001] {
            let time_s = times(rows);
            let wave = |t: f64| (7.0 * t).sin() * t;
            let mut values: Vec<f64> = time_s.iter().map(|t| wave(*t)).collect();
            values[rows as usize / 2] = f64::NAN;
            let mut outline = Outline::default();
            for (times, values) in time_s.chunks(311).zip(values.chunks(311)) {
                outline.extend(times, values);
            }
            assert_eq!(outline, Outline::of(&time_s, &values));
            assert!(outline.pieces.len() <= MOST_PIECES);
            for (t, value) in time_s.iter().zip(&values).filter(|(_, v)| v.is_finite()) {
                let holds = |piece: &&Piece| (piece.from_s..=piece.to_s).contains(t);
                let piece = outline.pieces.iter().find(holds).expect("a piece");
                assert!((piece.low..=piece.high).contains(value), "{t}");
            }
        }
    }

    #[test]
    fn an_axis_holds_its_curves_and_two_numbers() {
        let time_s = [0.0, 1.0];
        for ends in [
            [-900.0, 412.0],
            [3.0, 3.4],
            [-0.7, 0.2],
            [0.0, 0.0],
            [5.0, 5.0],
            [1e4, 2e5],
        ] {
            let outline = Outline::of(&time_s, &ends);
            let [low, high] = Plot(vec![(&outline, 1.0)]).range(1e-6).expect("a range");
            assert!(
                low <= ends[0] && high >= ends[1],
                "{ends:?}: {low} to {high}"
            );
            if ends[0] != ends[1] {
                let step = 10f64.powf(((high - low) / 11.5).log10().ceil());
                let numbers = (high / step).floor() - (low / step).ceil() + 1.0;
                assert!(numbers >= 2.0, "{ends:?}: {low} to {high}");
                assert!(
                    high - low < 3.0 * (ends[1] - ends[0]),
                    "{ends:?}: {low} to {high}"
                );
            }
        }
        let outline = Outline::of(&time_s, &[1e-9, 2e-9]);
        let range = Plot(vec![(&outline, 1e6)]).range(10.0);
        let end = (1.0 + ROOM) * 10.0;
        assert_eq!(range, Some([-end, end]));
        assert_eq!(Plot(vec![(&Outline::default(), 1.0)]).range(1.0), None);
    }

    #[test]
    fn a_legend_goes_where_no_curve_is() {
        let time_s = times(1000);
        let names = ["along [µm]", "across [µm]"];
        let corner = |curve: fn(f64) -> f64| {
            let values: Vec<f64> = time_s.iter().map(|t| curve(*t)).collect();
            let outline = Outline::of(&time_s, &values);
            Plot(vec![(&outline, 1.0)]).corner(&names, [0.0, 1.0], [-1.0, 1.0])
        };
        assert_eq!(corner(|t| 1.8 * t - 0.9), kinds::Corner2D::LeftTop);
        assert_eq!(corner(|t| 0.9 - 1.8 * t), kinds::Corner2D::RightTop);
        assert_eq!(corner(|_| 0.9), kinds::Corner2D::LeftBottom);
        let high_and_low = |t: f64| if t < 0.5 { (99.0 * t).sin() } else { 0.9 };
        assert_eq!(corner(high_and_low), kinds::Corner2D::RightBottom);
    }
}
