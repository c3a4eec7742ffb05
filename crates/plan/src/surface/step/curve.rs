//! Curves of edges, and points along them.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::entities::{Frame, Model, get, is_true, number, reference};
use super::part21::{Entity, Fault, Value};
use super::spline::{Spline, spline_parts};

/// Times that a stretch of a curve is halved at most.
const HALVED: u32 = 12;
/// Places in every span at which a curve is looked at, to begin with.
const PLACES: usize = 8;

/// Stretches of a span that are looked at each by itself.
const PARTS: usize = 4;

/// How finely curves and faces are cut.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fineness {
    /// Farthest that a chord may lie off, mm.
    pub(super) chord: f64,
    /// Angle from one chord to the next, rad.
    pub(super) turn: f64,
}

/// A curve, mm.
#[derive(Debug, Clone)]
pub(super) enum Curve {
    Line {
        from: Vector3<f64>,
        way: Vector3<f64>,
    },
    /// A circle where both radii are the same.
    Ellipse {
        frame: Frame,
        radii: [f64; 2],
    },
    Spline(Spline),
}

impl Curve {
    pub(super) fn read(model: &Model<'_>, number_of: u64) -> Result<Self, Fault> {
        let mut entity = model.file.entity(number_of)?;
        // Curves on surfaces and trimmed ones are those that they name: edges say where they end.
        for _ in 0..4 {
            let inner = [
                "SURFACE_CURVE",
                "SEAM_CURVE",
                "INTERSECTION_CURVE",
                "TRIMMED_CURVE",
            ];
            let Some(values) = inner.iter().find_map(|name| entity.part(name)) else {
                break;
            };
            entity = model.follow(&entity, get(&entity, values, 1)?)?;
        }
        if let Some(values) = entity.part("LINE") {
            let from = model.point(reference(&entity, get(&entity, values, 1)?)?)?;
            let vector = model.follow(&entity, get(&entity, values, 2)?)?;
            let inner = model.simple(&vector, "VECTOR")?;
            let way = model.direction(reference(&vector, get(&vector, inner, 1)?)?)?;
            return Ok(Self::Line { from, way });
        }
        for name in ["CIRCLE", "ELLIPSE"] {
            let Some(values) = entity.part(name) else {
                continue;
            };
            let frame = model.frame(reference(&entity, get(&entity, values, 1)?)?)?;
            let one = number(&entity, get(&entity, values, 2)?)? * model.unit_mm;
            let other = match name {
                "CIRCLE" => one,
                _ => number(&entity, get(&entity, values, 3)?)? * model.unit_mm,
            };
            if !(one > 0.0 && other > 0.0) {
                return Err(entity.fault("its radius must be above 0"));
            }
            let radii = [one, other];
            return Ok(Self::Ellipse { frame, radii });
        }
        if let Some((basic, knots, rational)) = spline_parts(&entity, "B_SPLINE_CURVE", 5) {
            return Spline::read(model, &entity, basic, knots, rational).map(Self::Spline);
        }
        Err(entity.fault(
            "curves of this kind are not read; LINE, CIRCLE, ELLIPSE and B_SPLINE_CURVE_WITH_KNOTS are",
        ))
    }

    pub(super) fn at(&self, t: f64) -> Vector3<f64> {
        match self {
            Self::Line { from, way } => from + way * t,
            Self::Ellipse { frame, radii } => frame.at(radii[0] * t.cos(), radii[1] * t.sin(), 0.0),
            Self::Spline(spline) => spline.at(t),
        }
    }

    /// Parameters between which the whole of it lies; `None` of a line.
    pub(super) fn range(&self) -> Option<[f64; 2]> {
        match self {
            Self::Line { .. } => None,
            Self::Ellipse { .. } => Some([0.0, TAU]),
            Self::Spline(spline) => Some(spline.range()),
        }
    }

    /// After how much it comes back to where it was.
    pub(super) fn period(&self) -> Option<f64> {
        match self {
            Self::Line { .. } => None,
            Self::Ellipse { .. } => Some(TAU),
            Self::Spline(spline) => spline.period(),
        }
    }

    /// Parameters between which it is bent evenly.
    fn breaks(&self) -> Vec<f64> {
        match self {
            Self::Line { .. } => vec![0.0, 1.0],
            Self::Ellipse { .. } => vec![0.0, 0.25 * TAU, 0.5 * TAU, 0.75 * TAU, TAU],
            Self::Spline(spline) => spline.breaks.clone(),
        }
    }

    /// The parameter at which something is least, the one nearest to a parameter where it is
    /// equally little at several. Of a line it is looked for within a distance of its point.
    pub(super) fn least(
        &self,
        within: f64,
        near: Option<f64>,
        cost: &dyn Fn(&Vector3<f64>) -> f64,
    ) -> f64 {
        let breaks = match self {
            Self::Line { .. } => {
                let share = |k: i32| within * (f64::from(k) / 32.0 - 1.0);
                (0..=64).map(share).collect()
            }
            _ => self.breaks(),
        };
        let mut places: Vec<f64> = Vec::new();
        for pair in breaks.windows(2) {
            let share = |k: usize| k as f64 / PLACES as f64;
            places.extend((0..PLACES).map(|k| pair[0] + (pair[1] - pair[0]) * share(k)));
        }
        places.extend(breaks.last());
        let at = |t: f64| cost(&self.at(t));
        let costs: Vec<f64> = places.iter().map(|t| at(*t)).collect();
        let last = places.len() - 1;
        let is_low = |k: &usize| {
            costs[*k] <= costs[k.saturating_sub(1)] && costs[*k] <= costs[(k + 1).min(last)]
        };
        let mut lows: Vec<usize> = (0..=last).filter(is_low).collect();
        // Both ends of a closed curve are one place, beside which it is least on either side.
        if self.period().is_some() && (is_low(&0) || is_low(&last)) {
            lows.extend([0, last]);
        }
        lows.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
        let found: Vec<(f64, f64)> = (lows.iter().take(6))
            .map(|k| {
                let bracket = [places[k.saturating_sub(1)], places[(k + 1).min(last)]];
                narrowed(bracket, places[*k], &at)
            })
            .map(|t| (t, at(t)))
            .collect();
        let least = found
            .iter()
            .map(|(_, cost)| *cost)
            .fold(f64::INFINITY, f64::min);
        let away = |t: f64| match (near, self.period()) {
            (Some(near), Some(period)) => {
                let turns = (t - near) / period;
                (turns - turns.round()).abs()
            }
            (Some(near), None) => (t - near).abs(),
            (None, _) => 0.0,
        };
        // Squares of lengths in mm: what differs by less is the same place.
        let alike = found.iter().filter(|(_, cost)| *cost <= least + 1e-12);
        let best = alike.min_by(|a, b| away(a.0).total_cmp(&away(b.0)));
        best.map_or(places[0], |(t, _)| *t)
    }

    /// Points from one place of it to another, both included, along or against its sense; once
    /// round where both are one.
    pub(super) fn points(
        &self,
        [start, end]: [Vector3<f64>; 2],
        is_along: bool,
        fine: &Fineness,
    ) -> Vec<Vector3<f64>> {
        if let Self::Line { .. } = self {
            return vec![start, end];
        }
        let [from, to] = self.stretch([&start, &end], is_along);
        let mut stops = vec![from];
        let period = self.period();
        let mut inner: Vec<f64> = self.breaks();
        if let Some(period) = period {
            let once = inner.clone();
            for turn in [-1.0, 1.0] {
                inner.extend(once.iter().map(|t| t + turn * period));
            }
        }
        let (low, high) = (from.min(to), from.max(to));
        let small = 1e-9 * (high - low).max(1e-12);
        inner.retain(|t| *t > low + small && *t < high - small);
        inner.sort_by(f64::total_cmp);
        inner.dedup_by(|a, b| (*a - *b).abs() <= small);
        if to < from {
            inner.reverse();
        }
        stops.extend(inner);
        stops.push(to);
        // Where a curve turns about within a span, its middle may lie on the chord.
        let parted = stops.windows(2).flat_map(|pair| {
            let share = |k: usize| k as f64 / PARTS as f64;
            (0..PARTS).map(move |k| pair[0] + (pair[1] - pair[0]) * share(k))
        });
        let mut stops: Vec<f64> = parted.collect();
        stops.push(to);
        let wrapped = |t: f64| match (period, self.range()) {
            (Some(period), Some([first, _])) => self.at(first + (t - first).rem_euclid(period)),
            _ => self.at(t),
        };
        let mut points = vec![start];
        for (k, pair) in stops.windows(2).enumerate() {
            let last = k + 2 == stops.len();
            let next = if last { end } else { wrapped(pair[1]) };
            let before = points[points.len() - 1];
            halved(
                &wrapped,
                [pair[0], pair[1]],
                [before, next],
                fine,
                HALVED,
                &mut points,
            );
            points.push(next);
        }
        points
    }

    /// Parameters of both ends.
    fn stretch(&self, ends: [&Vector3<f64>; 2], is_along: bool) -> [f64; 2] {
        let place = |p: &Vector3<f64>| match self {
            Self::Ellipse { frame, radii } => {
                let local = frame.local(p);
                (local.y / radii[1]).atan2(local.x / radii[0])
            }
            _ => self.least(0.0, None, &|q| (q - p).norm_squared()),
        };
        let [from, mut to] = ends.map(place);
        if let Some(period) = self.period() {
            let way = if is_along { to - from } else { from - to };
            // What is less than a millionth of a turn is one.
            let turned = way.rem_euclid(period);
            let turned = if turned < 1e-6 * period {
                period
            } else {
                turned
            };
            to = if is_along {
                from + turned
            } else {
                from - turned
            };
        }
        [from, to]
    }
}

/// Where something is least in a bracket, by the golden section.
fn narrowed([mut low, mut high]: [f64; 2], middle: f64, at: &dyn Fn(f64) -> f64) -> f64 {
    let share = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..70 {
        let (a, b) = (high - share * (high - low), low + share * (high - low));
        if at(a) < at(b) {
            high = b;
        } else {
            low = a;
        }
    }
    // An end may be the least, which the section only comes near to.
    let all = [low, high, middle].into_iter();
    all.min_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap_or(low)
}

fn halved(
    at: &dyn Fn(f64) -> Vector3<f64>,
    [from, to]: [f64; 2],
    [a, b]: [Vector3<f64>; 2],
    fine: &Fineness,
    left: u32,
    points: &mut Vec<Vector3<f64>>,
) {
    let middle = 0.5 * (from + to);
    let p = at(middle);
    let off = (p - 0.5 * (a + b)).norm();
    let turn = (p - a).angle(&(b - p));
    if left == 0 || (off <= fine.chord && 2.0 * turn <= fine.turn) {
        return;
    }
    halved(at, [from, middle], [a, p], fine, left - 1, points);
    points.push(p);
    halved(at, [middle, to], [p, b], fine, left - 1, points);
}

/// Whether an edge runs along its curve.
pub(super) fn sense(entity: &Entity, values: &[Value], k: usize) -> Result<bool, Fault> {
    is_true(entity, get(entity, values, k)?)
}
