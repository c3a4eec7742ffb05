//! Which way the wheel's axis points: at one place, and along a line.
//!
//! The swath is widest with the axis nearly across the feed, turned to either side by as much, so
//! that the rule for one place cannot tell one side from the other. Along a line the axes are
//! found together: the cheapest way through the candidates of all places (Bellman's recursion),
//!
//! ```text
//! Σ (1 − s/s_max − e)⁺ Δl/W + Σ Δθ² W/Δl
//! ```
//!
//! s the swath, s_max the widest at its place, e what is given away freely, Δθ the turn of the axis
//! about the normal from place to place, Δl the way between them, W the wheel's width. Candidates
//! are counted by α from across the feed, and Δθ = Δα + Δφ with φ the turn of the feed: an axis
//! that keeps its angle to a feed that turns does turn. The second sum grows without bound where
//! the axis jumps within a shorter and shorter way: it is turned on the way wherever that is
//! possible.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Unit, Vector3};

use super::error::SurfacePathError;
use super::wheel::ContactWheel;
use crate::surface::{Forms, Jet, Surface};

/// Directions that are tried, evenly over half a turn.
const TRIED: usize = 180;

/// Axes with a swath within this share of the widest count as equally wide.
const AS_WIDE: f64 = 0.02;

/// What an axis costs by its angle from across the feed, per rad²: of axes as wide, the one nearest
/// to that is taken. Small against the width that it may cost, 0.25 % of it at most.
const OFF_ACROSS: f64 = 1e-3;

/// A place on the face with the feed there.
pub(super) struct Place {
    pub uv: [f64; 2],
    pub jet: Jet,
    pub forms: Forms,
    pub feed: Unit<Vector3<f64>>,
}

/// One axis tried.
pub(super) struct AxisTrial {
    pub axis: Unit<Vector3<f64>>,
    pub psi_rad: f64,
    pub swath_m: f64,
    pub edge_gap_m: f64,
    pub across_per_m: f64,
    pub half_width_m: f64,
}

/// What each candidate costs, infinite where it may not be taken.
type Costs = [f64; TRIED];

impl Place {
    /// # Errors
    /// If the surface has no normal there.
    pub fn at(
        surface: &dyn Surface,
        [u, v]: [f64; 2],
        [du, dv]: [f64; 2],
    ) -> Result<Self, SurfacePathError> {
        let jet = surface.jet(u, v);
        let forms = Forms::at(&jet, u, v)?;
        let feed = Unit::new_normalize(jet.first_m[0] * du + jet.first_m[1] * dv);
        Ok(Self {
            uv: [u, v],
            jet,
            forms,
            feed,
        })
    }

    pub fn across(&self) -> Unit<Vector3<f64>> {
        Unit::new_normalize(self.forms.normal.cross(&self.feed))
    }

    /// What an axis gives.
    ///
    /// # Errors
    /// The curvature across it where the wheel would gouge.
    pub fn trial(&self, wheel: &ContactWheel, axis: Unit<Vector3<f64>>) -> Result<AxisTrial, f64> {
        let forms = &self.forms;
        let across_per_m = forms.curvature_along_per_m(&forms.normal.cross(&axis));
        let Some(half_width_m) = wheel.half_width_m(across_per_m) else {
            return Err(across_per_m);
        };
        let cos = self.feed.dot(&axis).abs().min(1.0);
        let psi_rad = self.feed.cross(&axis).norm().atan2(cos);
        let along = forms.curvature_along_per_m(&axis);
        Ok(AxisTrial {
            axis,
            psi_rad,
            swath_m: wheel.width_m * psi_rad.sin() + 2.0 * half_width_m * cos,
            edge_gap_m: along.abs() * wheel.width_m * wheel.width_m / 8.0,
            across_per_m,
            half_width_m,
        })
    }

    pub fn gouge(&self, wheel: &ContactWheel, across_per_m: f64) -> SurfacePathError {
        SurfacePathError::Gouge {
            u: self.uv[0],
            v: self.uv[1],
            point_m: self.jet.point_m,
            radius_mm: wheel.radius_m * 1e3,
            concave_mm: -1e3 / across_per_m,
        }
    }

    /// By how much the feed turns about the normal up to another place, rad.
    fn feed_turn_rad(&self, next: &Self) -> f64 {
        let (from, to, normal) = (self.across(), next.across(), next.forms.normal);
        // The part along the normal has no share in either.
        normal.dot(&from.cross(&to)).atan2(from.dot(&to))
    }

    /// A candidate.
    fn candidate(&self, k: usize) -> Unit<Vector3<f64>> {
        let (sin, cos) = angle_rad(k).sin_cos();
        Unit::new_normalize(self.across().into_inner() * cos - self.feed.into_inner() * sin)
    }

    /// What candidates cost whose edge gap keeps the limit.
    ///
    /// # Errors
    /// If there is none.
    fn costs(&self, wheel: &ContactWheel, limit_m: f64) -> Result<Costs, SurfacePathError> {
        let (mut swaths_m, mut least_m, mut deepest) = ([0.0; TRIED], f64::INFINITY, 0.0_f64);
        for (k, swath_m) in swaths_m.iter_mut().enumerate() {
            match self.trial(wheel, self.candidate(k)) {
                Ok(found) => {
                    least_m = least_m.min(found.edge_gap_m);
                    if found.edge_gap_m <= limit_m {
                        *swath_m = found.swath_m;
                    }
                }
                Err(across) => deepest = deepest.min(across),
            }
        }
        let widest_m = swaths_m.iter().copied().fold(0.0, f64::max);
        if widest_m <= 0.0 {
            return Err(match least_m.is_finite() {
                true => SurfacePathError::NoAxis {
                    u: self.uv[0],
                    v: self.uv[1],
                    point_m: self.jet.point_m,
                    limit_mm: limit_m * 1e3,
                    least_mm: least_m * 1e3,
                },
                false => self.gouge(wheel, deepest),
            });
        }
        let mut costs = [f64::INFINITY; TRIED];
        for (k, (cost, swath_m)) in costs.iter_mut().zip(swaths_m).enumerate() {
            if swath_m > 0.0 {
                let lost = 1.0 - swath_m / widest_m - AS_WIDE;
                *cost = lost.max(0.0) + OFF_ACROSS * angle_rad(k).powi(2);
            }
        }
        Ok(costs)
    }
}

/// Angle of a candidate from across the feed, rad.
fn angle_rad(k: usize) -> f64 {
    PI * k as f64 / TRIED as f64 - FRAC_PI_2
}

/// Axes along a line that keep the edge gap's limit, by the least cost of the whole line.
///
/// # Errors
/// If at some place no axis keeps the limit, or the wheel gouges whatever its axis.
pub(super) fn widest_along(
    places: &[Place],
    wheel: &ContactWheel,
    limit_m: f64,
) -> Result<Vec<AxisTrial>, SurfacePathError> {
    let way = |k: usize| match (places.get(k), places.get(k + 1)) {
        (Some(a), Some(b)) => (b.jet.point_m - a.jet.point_m).norm() / wheel.width_m,
        _ => 0.0,
    };
    let pairs = places.windows(2);
    let turns: Vec<Turns> = pairs
        .map(|pair| turns(pair[0].feed_turn_rad(&pair[1])))
        .collect();
    // Least cost of the line up to each place, by the candidate there.
    let mut rows: Vec<Costs> = Vec::with_capacity(places.len());
    for (k, place) in places.iter().enumerate() {
        let own = place.costs(wheel, limit_m)?;
        let before = k.checked_sub(1).map_or(0.0, way);
        let share = 0.5 * (before + way(k));
        let reached = match (rows.last(), k.checked_sub(1)) {
            (Some(row), Some(from)) => reached(row, &turns[from], before),
            _ => [0.0; TRIED],
        };
        // A line of one place has no length.
        let share = if places.len() == 1 { 1.0 } else { share };
        let mut row = [0.0; TRIED];
        for ((cost, reached), own) in row.iter_mut().zip(reached).zip(own) {
            *cost = if own.is_finite() {
                reached + own * share
            } else {
                own
            };
        }
        rows.push(row);
    }
    let mut chosen = vec![0; places.len()];
    let mut next: Option<usize> = None;
    for (k, row) in rows.iter().enumerate().rev() {
        let cost = |i: usize| match next {
            Some(j) => row[i] + turns[k].squared[TRIED + j - i] / way(k).max(SHORT),
            None => row[i],
        };
        let best = (0..TRIED).min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
        chosen[k] = best.unwrap_or_default();
        next = best;
    }
    let each = places.iter().zip(chosen);
    each.map(|(place, k)| {
        let found = place.trial(wheel, place.candidate(k));
        found.map_err(|across| place.gouge(wheel, across))
    })
    .collect()
}

/// Way between two places, over the wheel's width, below which it counts as this.
const SHORT: f64 = 1e-9;

/// Turns from the candidates of a place to those of the place after.
struct Turns {
    /// How far the feed turns, in steps of the candidates, the shorter way round.
    feed: f64,
    /// Squared turns, rad², the shorter way round: of i to j at `TRIED + j − i`.
    squared: [f64; 2 * TRIED],
}

/// Those where the feed turns by an angle, rad.
fn turns(feed_turn_rad: f64) -> Turns {
    // An axis has no sense.
    let shorter = |turn: f64| turn - PI * (turn / PI).round();
    let squared = std::array::from_fn(|k| {
        let turn = PI * (k as f64 - TRIED as f64) / TRIED as f64 + feed_turn_rad;
        shorter(turn) * shorter(turn)
    });
    Turns {
        feed: shorter(feed_turn_rad) * TRIED as f64 / PI,
        squared,
    }
}

/// Least cost to come to each candidate from any of the place before.
///
/// To any of them the axis may come from the candidate that turns least, half a step at most; one
/// that costs less by d is no better beyond the turn that costs d more.
fn reached(row: &Costs, turns: &Turns, way: f64) -> Costs {
    let per_way = 1.0 / way.max(SHORT);
    let per_step = (PI / TRIED as f64).powi(2) * per_way;
    let highest = row.iter().copied().fold(0.0, f64::max);
    let mut least = [f64::INFINITY; TRIED];
    for (i, from) in row.iter().enumerate().filter(|(_, from)| from.is_finite()) {
        // Infinite where some candidate may not be taken: what it stands for is then not bounded.
        let reach = ((highest - from) / per_step + 0.25).sqrt() + 1.0;
        let mut meet = |places: std::ops::Range<usize>| {
            let squared = &turns.squared[TRIED + places.start - i..];
            for (least, turn) in least[places].iter_mut().zip(squared) {
                *least = least.min(from + turn * per_way);
            }
        };
        let (first, last) = (i as f64 - turns.feed - reach, i as f64 - turns.feed + reach);
        if last - first >= TRIED as f64 {
            meet(0..TRIED);
            continue;
        }
        // Once round to either side: the feed turns by half of that at most.
        for round in [-1.0, 0.0, 1.0] {
            let of = |end: f64| (end + round * TRIED as f64).clamp(0.0, TRIED as f64) as usize;
            meet(of(first.ceil())..of(last.floor() + 1.0));
        }
    }
    least
}

#[cfg(test)]
mod tests;
