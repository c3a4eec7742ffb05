//! A block of stock in layers on a plane grid.

use super::arc::ToothArc;
use super::block::{Block, Hole};
use super::round;
use super::way::SAME_DEPTH_M;
use crate::cutting::milling::profile::Profile;
use nalgebra::{Vector2, Vector3};
use std::ops::Range;

/// Grids beyond what has been cut say no more than that it is so far, in spacings.
pub(in crate::cutting::milling) const FAR: f64 = 4.0;
/// Nodes within so many spacings of a cut know their distance.
const KNOWN: f64 = 2.5;
/// A tool that sinks by less than this part of a layer, or this, m, still cuts at that layer.
const SUNK: f64 = 0.5;
pub(super) const MOST_SUNK_M: f64 = 0.1e-3;

/// A layer of the block.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    pub bottom_m: f64,
    pub top_m: f64,
    /// By node, x first: distance beyond what is cut, m.
    beyond_m: Vec<f64>,
}

impl Layer {
    pub fn height_m(&self) -> f64 {
        self.top_m - self.bottom_m
    }

    pub fn middle_m(&self) -> f64 {
        0.5 * (self.bottom_m + self.top_m)
    }

    /// How far below its bottom a tool still belongs to it.
    pub fn sunk_m(&self) -> f64 {
        MOST_SUNK_M.min(SUNK * self.height_m())
    }

    pub(super) fn values(&self) -> &[f64] {
        &self.beyond_m
    }

    pub(super) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.beyond_m
    }
}

/// A block in layers, from the lowest up.
#[derive(Debug, Clone, PartialEq)]
pub struct LayeredStock {
    pub block: Block,
    spacing_m: Vector2<f64>,
    nodes: [usize; 2],
    layers: Vec<Layer>,
}

impl LayeredStock {
    /// A whole block but for holes, on a grid of at most `grid_m`, in layers between its faces and
    /// these depths.
    pub fn new(block: Block, holes: &[Hole], grid_m: f64, depths_m: &[f64]) -> Self {
        let size = (block.most_m - block.least_m).xy();
        let cells = size.map(|length| (length / grid_m - 1e-9).ceil().max(1.0));
        let nodes = [cells.x as usize + 1, cells.y as usize + 1];
        let mut bounds = vec![block.least_m.z, block.most_m.z];
        let within =
            |z: &f64| *z > block.least_m.z + SAME_DEPTH_M && *z < block.most_m.z - SAME_DEPTH_M;
        bounds.extend(depths_m.iter().copied().filter(within));
        bounds.sort_by(f64::total_cmp);
        bounds.dedup();
        let mut stock = Self {
            block,
            spacing_m: size.component_div(&cells),
            nodes,
            layers: Vec::new(),
        };
        let far_m = FAR * stock.grid_m();
        let beyond = |node: usize| {
            let place = stock.place(node);
            let holes = holes.iter();
            let each = holes.map(|hole| (place - hole.centre_m).norm() - hole.radius_m);
            each.fold(far_m, f64::min)
        };
        let beyond_m: Vec<f64> = (0..nodes[0] * nodes[1]).map(beyond).collect();
        let layer = |pair: &[f64]| Layer {
            bottom_m: pair[0],
            top_m: pair[1],
            beyond_m: beyond_m.clone(),
        };
        stock.layers = bounds.windows(2).map(layer).collect();
        stock
    }

    /// The larger of both spacings.
    pub fn grid_m(&self) -> f64 {
        self.spacing_m.max()
    }

    /// How far beside what is cut the distance to it is known, m.
    pub fn known_m(&self) -> f64 {
        KNOWN * self.grid_m()
    }

    pub fn nodes(&self) -> [usize; 2] {
        self.nodes
    }

    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    pub(super) fn layers_mut(&mut self) -> &mut [Layer] {
        &mut self.layers
    }

    /// The node nearest to a place.
    pub fn nearest(&self, place_m: &Vector2<f64>) -> usize {
        let at = (place_m - self.block.least_m.xy()).component_div(&self.spacing_m);
        let index = |axis: usize| (at[axis].round().max(0.0) as usize).min(self.nodes[axis] - 1);
        index(0) + self.nodes[0] * index(1)
    }

    pub fn place(&self, node: usize) -> Vector2<f64> {
        let (column, row) = (node % self.nodes[0], node / self.nodes[0]);
        let step = Vector2::new(column as f64, row as f64);
        self.block.least_m.xy() + self.spacing_m.component_mul(&step)
    }

    /// Layers that a tool with its tip at a height cuts fully, as a range.
    pub fn cut_by(&self, tip_m: f64) -> Range<usize> {
        let uncut = self
            .layers
            .partition_point(|one| one.bottom_m + one.sunk_m() < tip_m);
        uncut..self.layers.len()
    }

    /// Layers that an edge reaches, from the lowest, with the heights between which it does.
    pub fn engaged(&self, tip_m: f64) -> impl Iterator<Item = (usize, [f64; 2])> + '_ {
        let layers = &self.layers;
        let belongs = layers.partition_point(|one| one.top_m <= tip_m);
        // A tool sunk by little is deeper in the layer above.
        let next = layers.get(belongs + 1);
        let above = next.is_some_and(|one| tip_m > one.bottom_m - one.sunk_m());
        let first = belongs + usize::from(above);
        (first..layers.len()).map(move |layer| {
            let low_m = match layer == first {
                true => tip_m.max(layers[0].bottom_m),
                false => layers[layer].bottom_m,
            };
            (layer, [low_m, layers[layer].top_m])
        })
    }

    /// How far a place lies beyond what is cut of a layer, m, in the block.
    pub fn beyond_m(&self, layer: usize, place_m: &Vector2<f64>) -> f64 {
        let values = &self.layers[layer].beyond_m;
        self.between_nodes(place_m, |node| values[node])
    }

    /// What is known at nodes, bilinear between them, at a place in the block.
    pub(super) fn between_nodes(
        &self,
        place_m: &Vector2<f64>,
        value: impl Fn(usize) -> f64,
    ) -> f64 {
        let at = (place_m - self.block.least_m.xy()).component_div(&self.spacing_m);
        let index = |axis: usize| {
            let last = self.nodes[axis] as f64 - 2.0;
            at[axis].floor().clamp(0.0, last)
        };
        let (i, j) = (index(0), index(1));
        let (u, v) = ((at.x - i).clamp(0.0, 1.0), (at.y - j).clamp(0.0, 1.0));
        let first = i as usize + j as usize * self.nodes[0];
        let low = value(first) * (1.0 - u) + value(first + 1) * u;
        let above = first + self.nodes[0];
        let high = value(above) * (1.0 - u) + value(above + 1) * u;
        low * (1.0 - v) + high * v
    }

    /// Whether there is material in a layer at a place.
    pub fn is_left(&self, layer: usize, place_m: &Vector2<f64>) -> bool {
        self.block.contains(place_m) && self.beyond_m(layer, place_m) > 0.0
    }

    /// Length of the way between two places that lies in the block where a value is positive, m.
    pub(super) fn length_in_m(
        &self,
        from_m: &Vector2<f64>,
        to_m: &Vector2<f64>,
        value: impl Fn(&Vector2<f64>) -> f64,
    ) -> f64 {
        let along_m = to_m - from_m;
        let (low, high) = self.block.clip(from_m, &along_m);
        let length_m = along_m.norm() * (high - low);
        if length_m <= 0.0 {
            return 0.0;
        }
        positive_m(length_m, self.grid_m(), [low, high], |share| {
            value(&(from_m + along_m * share))
        })
    }

    /// Columns and rows of the nodes between two places.
    pub(super) fn between(&self, [least, most]: [Vector2<f64>; 2]) -> [Range<usize>; 2] {
        let range = |axis: usize| {
            let origin = self.block.least_m[axis];
            let at = |x: f64| (x - origin) / self.spacing_m[axis];
            let low = at(least[axis]).ceil().max(0.0) as usize;
            let high = (at(most[axis]).floor() + 1.0).max(0.0) as usize;
            low..high.min(self.nodes[axis]).max(low)
        };
        [range(0), range(1)]
    }

    /// Nodes of a rectangle.
    pub(super) fn each(
        &self,
        [columns, rows]: [Range<usize>; 2],
    ) -> impl Iterator<Item = usize> + use<> {
        let width = self.nodes[0];
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }

    /// A tooth has run on an arc in a layer; between its passes the axis moves by `travel_m` at
    /// most.
    pub(super) fn cut_arc(&mut self, layer: usize, arc: &ToothArc, travel_m: f64) {
        let known_m = self.known_m();
        let band_m = [
            arc.radius_m - known_m - 2.0 * travel_m,
            arc.radius_m + known_m,
        ];
        let bounds = arc.bounds([band_m[0].max(0.0), band_m[1]]);
        let range = self.between(bounds);
        let deepest_m = band_m[0] - arc.radius_m;
        for node in self.each(range) {
            if self.layers[layer].beyond_m[node] <= deepest_m {
                continue;
            }
            let place = self.place(node);
            let Some((_, axis_m)) = arc.at(&place) else {
                continue;
            };
            let distance_m = (place - axis_m).norm();
            if (band_m[0]..=band_m[1]).contains(&distance_m) {
                let value = &mut self.layers[layer].beyond_m[node];
                *value = value.min(distance_m - arc.radius_m);
            }
        }
    }

    /// A cutter has sunk into layers at a place: of each all is gone that lies within its rim;
    /// where that is, arcs of teeth tell.
    pub(super) fn cut_disc(&mut self, layers: Range<usize>, axis_m: &Vector2<f64>, radius_m: f64) {
        let within_m = radius_m - self.grid_m();
        let reach = Vector2::repeat(within_m.max(0.0));
        let range = self.between([axis_m - reach, axis_m + reach]);
        for node in self.each(range) {
            let distance_m = (self.place(node) - axis_m).norm();
            if distance_m <= within_m {
                for layer in &mut self.layers[layers.clone()] {
                    let value = &mut layer.beyond_m[node];
                    *value = value.min(distance_m - radius_m);
                }
            }
        }
    }

    /// A cutter that does not vibrate has gone straight between two places at a depth. Tells
    /// whether it took material, of nodes that lie well within.
    pub fn cut_leg(&mut self, leg: [Vector3<f64>; 2], profile: &Profile, keeps: bool) -> bool {
        let tip_m = leg[0].z.min(leg[1].z);
        let layers = match keeps {
            true => self.layers.partition_point(|one| one.top_m <= tip_m + 1e-9)..self.layers.len(),
            false => self.taken_by(tip_m, profile),
        };
        let radius_m = |layer: usize| {
            let one = &self.layers[layer];
            // Material to its top is met there, but what a corner leaves of thin layers is not.
            let height_m = match keeps {
                true => one.middle_m().max(one.top_m - MOST_SUNK_M),
                false => one.middle_m(),
            };
            profile.radius_at_m(height_m - tip_m)
        };
        let radii_m: Vec<f64> = layers.clone().map(radius_m).collect();
        let (from, to) = (leg[0].xy(), leg[1].xy());
        let known_m = self.known_m();
        let reach = Vector2::repeat(profile.radius_m + known_m);
        let range = self.between([from.inf(&to) - reach, from.sup(&to) + reach]);
        let well_m = self
            .grid_m()
            .max(round::PIECE_RAD * profile.corner_radius_m);
        let mut took = false;
        for node in self.each(range) {
            let off_m = off_line(&self.place(node), &from, &to);
            for (layer, radius_m) in self.layers[layers.clone()].iter_mut().zip(&radii_m).rev() {
                let beyond_m = off_m - radius_m;
                // A layer below is cut no wider.
                if beyond_m > known_m {
                    break;
                }
                let value = &mut layer.beyond_m[node];
                took |= beyond_m < -well_m && *value > 0.0;
                if !keeps {
                    *value = value.min(beyond_m);
                }
            }
        }
        took
    }
}

/// Length of a way on which a value is positive, m: it is asked for at shares between two, no
/// further from each other than a spacing, and changes evenly between them.
pub(in crate::cutting::milling) fn positive_m(
    length_m: f64,
    spacing_m: f64,
    [low, high]: [f64; 2],
    value: impl Fn(f64) -> f64,
) -> f64 {
    let parts = (length_m / spacing_m).ceil().max(1.0);
    let mut sum = 0.0;
    let at = |part: f64| value(low + (high - low) * part / parts);
    let mut before = at(0.0);
    for part in 1..=parts as usize {
        let after = at(part as f64);
        sum += match (before > 0.0, after > 0.0) {
            (true, true) => 1.0,
            (false, false) => 0.0,
            (true, false) => before / (before - after),
            (false, true) => after / (after - before),
        };
        before = after;
    }
    length_m * sum / parts
}

/// Distance of a place from a straight piece, m.
pub(super) fn off_line(place: &Vector2<f64>, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
    let along = to - from;
    let length2 = along.norm_squared();
    let t = match length2 > 0.0 {
        true => ((place - from).dot(&along) / length2).clamp(0.0, 1.0),
        false => 0.0,
    };
    (place - from - along * t).norm()
}
