//! Legs of a path on which the tool sinks into stock or rises in it: plunges, ramps, helices.

use super::block::Block;
use super::stock::{LayeredStock, MOST_SUNK_M, off_line};
use super::way::{Leg, PIECES, SAME_DEPTH_M};
use crate::cutting::milling::profile::Profile;
use nalgebra::{Vector2, Vector3};

/// Most layers of a ramp.
const MOST_LAYERS: f64 = 40.0;
/// Most nodes of all layers of ramps.
const MOST_NODES: f64 = 64e6;
/// Pieces of a ramp sink by no more than this part of a layer.
const PIECE: f64 = 0.125;
/// The same of round corners, as a part of the thickest layer: all of a slope lies under them.
const ROUND_PIECE: f64 = 0.04;

impl Leg {
    /// Whether it leads straight down or up.
    pub(super) fn is_plunge(&self) -> bool {
        (self.to_m - self.from_m).xy().norm() <= SAME_DEPTH_M
    }

    /// In level pieces that stand apart by no more than a height: at the mean of their ends, a
    /// plunge at its lower end.
    pub(super) fn pieces(&self, height_m: f64) -> impl Iterator<Item = [Vector3<f64>; 2]> + use<> {
        let Self { from_m, to_m, .. } = *self;
        let is_plunge = self.is_plunge();
        let count = match is_plunge {
            true => 1.0,
            false => ((to_m.z - from_m.z).abs() / height_m).ceil().max(1.0),
        };
        let at = move |k: usize| from_m.lerp(&to_m, k as f64 / count);
        (0..count as usize).map(move |k| {
            let mut ends = [at(k), at(k + 1)];
            let [from, to] = ends.map(|end| end.z);
            let tip_m = match is_plunge {
                true => from.min(to),
                false => 0.5 * (from + to),
            };
            ends.iter_mut().for_each(|end| end.z = tip_m);
            ends
        })
    }
}

/// Which of the legs change their depth in what a whole stock holds.
pub(super) fn sinking(legs: &[Leg], stock: &mut LayeredStock, profile: &Profile) -> Vec<bool> {
    let each = legs.iter().map(|leg| {
        let height_m = (leg.to_m.z - leg.from_m.z).abs() / PIECES as f64;
        let mut touches = |piece| stock.cut_leg(piece, profile, true);
        !leg.rapid && !leg.is_level() && leg.pieces(height_m).any(&mut touches)
    });
    each.collect()
}

/// Depths between which stock has its own layers for legs that sink: their ends, and on slanted
/// ones steps of the grid, at most so large that a tool belongs to the next layer from half on;
/// larger ones where those would be too many. A round corner has them, too.
pub(super) fn depths_m(
    legs: &[Leg],
    sinks: &[bool],
    block: &Block,
    stock: &LayeredStock,
    profile: &Profile,
) -> Vec<f64> {
    let mut depths = Vec::new();
    let (mut least_m, mut most_m) = (f64::INFINITY, f64::NEG_INFINITY);
    for (leg, _) in legs.iter().zip(sinks).filter(|(_, sinks)| **sinks) {
        let ends = [leg.from_m.z, leg.to_m.z].map(|z| z.clamp(block.least_m.z, block.most_m.z));
        depths.extend(ends);
        if !leg.is_plunge() {
            least_m = ends.iter().fold(least_m, |a, b| a.min(*b));
            let upright = |z: f64| (z + profile.corner_radius_m).min(block.most_m.z);
            most_m = ends.iter().fold(most_m, |a, b| a.max(upright(*b)));
        }
    }
    let range_m = most_m - least_m;
    if range_m > 0.0 {
        let nodes = stock.nodes();
        let most = MOST_LAYERS
            .min(MOST_NODES / (nodes[0] * nodes[1]) as f64)
            .max(1.0);
        let height_m = stock.grid_m().min(2.0 * MOST_SUNK_M);
        let count = (range_m / height_m).ceil().clamp(1.0, most.floor());
        depths.extend((1..count as usize).map(|k| least_m + range_m * k as f64 / count));
    }
    depths
}

/// Height of the pieces in which slanted legs cut stock, m.
pub(super) fn piece_m(stock: &LayeredStock, profile: &Profile) -> f64 {
    if !profile.is_flat() {
        // Not by the layers: those about a corner's end are thin.
        return ROUND_PIECE * stock.grid_m().min(2.0 * MOST_SUNK_M);
    }
    let heights = stock.layers().iter().map(|one| one.height_m());
    PIECE * heights.fold(stock.grid_m(), f64::min).max(SAME_DEPTH_M)
}

/// Lowest place of the tip over each node on the path as written, m; infinite where it is not led.
pub(super) fn floor_m(
    legs: &[Leg],
    sinks: &[bool],
    stock: &LayeredStock,
    radius_m: f64,
) -> Vec<f64> {
    let nodes = stock.nodes();
    let mut floor_m = vec![f64::INFINITY; nodes[0] * nodes[1]];
    let piece_m = piece_m(stock, &Profile::flat(radius_m));
    for (leg, sinks) in legs.iter().zip(sinks) {
        if leg.rapid || !(leg.is_level() || *sinks) {
            continue;
        }
        for [from_m, to_m] in leg.pieces(piece_m) {
            let (from, to) = (from_m.xy(), to_m.xy());
            let reach = Vector2::repeat(radius_m);
            let range = stock.between([from.inf(&to) - reach, from.sup(&to) + reach]);
            for node in stock.each(range) {
                if off_line(&stock.place(node), &from, &to) <= radius_m {
                    floor_m[node] = floor_m[node].min(from_m.z);
                }
            }
        }
    }
    floor_m
}
