//! Cutters with a round corner: bull-nose and ball.
//!
//! Their edge is cut into pieces of equal angle κ. A piece runs on its own radius; across the axis
//! its chip is measured as that of an upright edge is, on the ray from the axis, against the radii
//! on which earlier teeth came by at that height, lower or higher by what the axis has sunk or
//! risen since. Area is then that of the chip, whatever κ; forces act along the normal.
//!
//! What stood there before the stored motion begins is told where the edge is nearer to upright by
//! the outlines of layers, where it is nearer to level by the heights that teeth have left at the
//! nodes: outlines of level faces are known badly, heights of upright ones likewise.

use super::block::Block;
use super::cut::{LayeredCut, Passes, ToolPlace};
use super::stock::{FAR, LayeredStock, off_line};
use super::way::Leg;
use crate::cutting::milling::profile::{Lean, Profile};
use nalgebra::{Vector2, Vector3};
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

/// A corner's edge is cut into pieces of no more than this angle, rad, nearer to the tip of no more
/// than a part of κ: there the radius grows fast over the height.
pub(super) const PIECE_RAD: f64 = 0.05;
const FINEST_RAD: f64 = 0.0125;
const PIECE_OF_KAPPA: f64 = 0.25;
/// Most layers for the corners of all levels, and most nodes of theirs.
const MOST_LAYERS: f64 = 400.0;
const MOST_NODES: f64 = 64e6;
/// Halvings by thirds that find where a slanted way comes nearest to a place from above.
const NARROWED: usize = 40;

/// A piece of an edge.
#[derive(Debug, Clone, Copy)]
pub(in crate::cutting::milling) struct Piece {
    /// Above the tip, m.
    pub height_m: f64,
    pub thick_m: f64,
    pub lean: Lean,
}

/// Pieces of a corner between two heights above the tip, at equal angles that the edge's lag, per
/// height, does not exceed either.
pub(in crate::cutting::milling) fn pieces(
    profile: Profile,
    [low_m, high_m]: [f64; 2],
    lag_rad_per_m: f64,
    most_lag_rad: f64,
) -> impl Iterator<Item = Piece> {
    let corner_m = profile.corner_radius_m;
    let [from, to] = [low_m, high_m.min(corner_m)].map(|height| profile.axial_angle_rad(height));
    let lags = lag_rad_per_m.abs() * (high_m.min(corner_m) - low_m) / most_lag_rad;
    let count = match low_m < corner_m {
        true => {
            let most = (PIECE_OF_KAPPA * from).clamp(FINEST_RAD, PIECE_RAD);
            ((to - from) / most).max(lags).ceil().max(1.0)
        }
        false => 0.0,
    };
    let at = move |k: f64| from + (to - from) * k / count;
    (0..count as usize).map(move |k| {
        let [below, middle, above] = [0.0, 0.5, 1.0].map(|part| at(k as f64 + part));
        let (sin, cos) = middle.sin_cos();
        Piece {
            height_m: corner_m * (1.0 - cos),
            thick_m: corner_m * (below.cos() - above.cos()),
            lean: Lean { sin, cos },
        }
    })
}

impl LayeredCut {
    /// The layer by which a whole edge is looked at, and its height above the tip: the lowest that
    /// is reached, of an edge with a round corner the highest, where it is widest.
    pub(super) fn looked_at(&self, at: &ToolPlace) -> Option<(usize, f64)> {
        if self.cutter.is_flat() {
            return self
                .engaged(at.place_m.z)
                .next()
                .map(|(layer, _)| (layer, 0.0));
        }
        let (layer, [low_m, high_m]) = self.engaged(at.place_m.z).last()?;
        Some((layer, 0.5 * (low_m + high_m) - at.place_m.z))
    }

    /// Length of the way between two places at a height in a layer that lies in stock where teeth
    /// have not been, by the heights that they left.
    pub(super) fn under_m(
        &self,
        layer: usize,
        height_m: f64,
        from_m: &Vector2<f64>,
        to_m: &Vector2<f64>,
    ) -> f64 {
        let stock = self.stock();
        let far_m = FAR * stock.grid_m();
        let [least_m, most_m] = [stock.block.least_m.z - far_m, stock.block.most_m.z + far_m];
        let bounded = |z: f64| z.clamp(least_m, most_m);
        stock.length_in_m(from_m, to_m, |place| {
            let floor_m = stock.between_nodes(place, |node| bounded(self.floor_m[node]));
            let whole = self.whole.as_ref().unwrap_or(stock);
            (floor_m - height_m).min(whole.beyond_m(layer, place))
        })
    }

    /// How much further out than a piece an edge stands at the middle of its layer, m, by the
    /// height of which the layer's outline is told: as much further out that is of this edge and of
    /// earlier ones.
    pub(super) fn to_middle_m(&self, layer: usize, piece: &Piece, tip_m: f64) -> f64 {
        let profile = self.cutter.profile();
        let middle_m = self.stock().layers()[layer].middle_m() - tip_m;
        match profile.is_flat() || middle_m <= 0.0 {
            true => 0.0,
            false => profile.radius_at_m(middle_m) - profile.radius_at_m(piece.height_m),
        }
    }

    /// How much thicker than by its way in the plane a chip can be at a piece of an edge, m: by
    /// what the axis has sunk.
    pub(super) fn sunk_chip_m(&self, piece: &Piece, at: &ToolPlace, passes: &Passes) -> f64 {
        match self.cutter.is_flat() {
            true => 0.0,
            false => (passes.earlier[0].1.z - at.place_m.z).abs() * piece.lean.cos / piece.lean.sin,
        }
    }
}

impl LayeredStock {
    /// Layers that a cutter with its tip at a height takes: a flat one those that it cuts fully,
    /// one with a round corner those whose middle it reaches.
    pub fn taken_by(&self, tip_m: f64, profile: &Profile) -> Range<usize> {
        if profile.is_flat() {
            return self.cut_by(tip_m);
        }
        let uncut = self.layers().partition_point(|one| one.middle_m() <= tip_m);
        uncut..self.layers().len()
    }

    /// Layers that an edge reaches which a round corner leads down to the tip, from the lowest,
    /// with the heights between which it does.
    pub(super) fn reached(&self, tip_m: f64) -> impl Iterator<Item = (usize, [f64; 2])> + '_ {
        let first = self.layers().partition_point(|one| one.top_m <= tip_m);
        (first..self.layers().len()).map(move |layer| {
            let one = &self.layers()[layer];
            (layer, [one.bottom_m.max(tip_m), one.top_m])
        })
    }
}

/// Heights that bound layers about the corners of cutters at these levels: steps of equal angle, in
/// which the corner widens by the grid's spacing at most.
pub(super) fn depths_m(
    levels_m: &[f64],
    profile: &Profile,
    block: &Block,
    grid_m: f64,
) -> Vec<f64> {
    let corner_m = profile.corner_radius_m;
    let size = block.most_m - block.least_m;
    let nodes = size.x * size.y / (grid_m * grid_m);
    let most = MOST_LAYERS.min(MOST_NODES / nodes) / levels_m.len().max(1) as f64;
    let fine = FRAC_PI_2 / (grid_m / corner_m).max(PIECE_RAD);
    let count = fine.ceil().min(most.floor()).max(1.0);
    let heights = move |level: &f64| {
        let level = *level;
        let at = move |k: usize| FRAC_PI_2 * k as f64 / count;
        (1..=count as usize).map(move |k| level + corner_m * (1.0 - at(k).cos()))
    };
    levels_m.iter().flat_map(heights).collect()
}

/// What a cutter leaves under it on a path as written: the lowest height of its body over each
/// node, m, infinite where it does not come, and cos κ of the body there.
pub(super) fn floor(
    legs: &[Leg],
    sinks: &[bool],
    stock: &LayeredStock,
    profile: &Profile,
) -> (Vec<f64>, Vec<f64>) {
    let nodes = stock.nodes();
    let mut floor_m = vec![f64::INFINITY; nodes[0] * nodes[1]];
    let mut floor_cos = vec![1.0; nodes[0] * nodes[1]];
    for (leg, sinks) in legs.iter().zip(sinks) {
        if leg.rapid || !(leg.is_level() || *sinks) {
            continue;
        }
        // A long way in pieces, or the box about it is looked at for nothing.
        let count = ((leg.to_m - leg.from_m).norm() / (2.0 * profile.radius_m)).ceil();
        let at = |k: usize| leg.from_m.lerp(&leg.to_m, k as f64 / count);
        for k in 0..count as usize {
            let (from_m, to_m) = (at(k), at(k + 1));
            let (from, to) = (from_m.xy(), to_m.xy());
            let reach = Vector2::repeat(profile.radius_m);
            let range = stock.between([from.inf(&to) - reach, from.sup(&to) + reach]);
            for node in stock.each(range) {
                let place = stock.place(node);
                if off_line(&place, &from, &to) > profile.radius_m {
                    continue;
                }
                let (height_m, cos) = lowest_m(&place, [from_m, to_m], profile);
                if height_m < floor_m[node] {
                    (floor_m[node], floor_cos[node]) = (height_m, cos);
                }
            }
        }
    }
    (floor_m, floor_cos)
}

/// Lowest height of a body over a place on a straight way, and its cos κ there. Both its own height
/// and that of the body over the place are convex along the way.
fn lowest_m(
    place: &Vector2<f64>,
    [from_m, to_m]: [Vector3<f64>; 2],
    profile: &Profile,
) -> (f64, f64) {
    let off_m = |share: f64| (place - from_m.lerp(&to_m, share).xy()).norm();
    let along = (to_m - from_m).xy();
    let length2 = along.norm_squared();
    let nearest = match length2 > 0.0 {
        true => ((place - from_m.xy()).dot(&along) / length2).clamp(0.0, 1.0),
        false => f64::from(to_m.z < from_m.z),
    };
    let height_m = |share: f64| {
        let rise_m = profile.rise_m(off_m(share).min(profile.radius_m));
        from_m.z + (to_m.z - from_m.z) * share + rise_m.unwrap_or(profile.corner_radius_m)
    };
    let mut share = nearest;
    if to_m.z != from_m.z && length2 > 0.0 {
        // Beyond the rim the body has no height: only within it is looked.
        let beside2 = (place - from_m.xy()).perp(&along).powi(2) / length2;
        let reach = ((profile.radius_m.powi(2) - beside2).max(0.0) / length2).sqrt();
        let middle = (place - from_m.xy()).dot(&along) / length2;
        let bounded = |share: f64| share.clamp(0.0, 1.0);
        let (mut low, mut high) = (bounded(middle - reach), bounded(middle + reach));
        for _ in 0..NARROWED {
            let third = (high - low) / 3.0;
            match height_m(low + third) < height_m(high - third) {
                true => high -= third,
                false => low += third,
            }
        }
        let found = 0.5 * (low + high);
        if height_m(found) < height_m(share) {
            share = found;
        }
    }
    (height_m(share), profile.cos_at(off_m(share)))
}
