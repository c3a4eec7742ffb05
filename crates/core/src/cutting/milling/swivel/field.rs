//! Stock as distances on a grid in space.

use nalgebra::{Isometry3, Point3, Vector3};
use std::ops::Range;

use super::way::SwivelLeg;
use crate::cutting::milling::layered::block::{Block, Hole};
use crate::cutting::milling::layered::solid::Solid;
use crate::cutting::milling::layered::stock::{FAR, LayeredStock, positive_m};
use crate::cutting::milling::profile::Profile;

/// Halvings by thirds that find where a body comes nearest to a place: to a thousandth of a piece.
const NARROWED: usize = 17;
/// A node that is cut lies within by this much of a spacing at least.
const LEAST: f64 = 1e-3;
/// Distances are known beside what has been cut within so many spacings.
const KNOWN: f64 = 2.5;

/// A block of stock, or what stands in it.
#[derive(Debug, Clone, PartialEq)]
pub struct DistanceField {
    pub block: Block,
    spacing_m: Vector3<f64>,
    nodes: [usize; 3],
    /// By node, x first, then y: distance beyond what is cut, m.
    beyond_m: Vec<f32>,
}

/// Least and greatest height over a place along an axis of a box between two corners, m.
pub(super) fn heights_m(
    [least_m, most_m]: &[Vector3<f64>; 2],
    tip_m: &Vector3<f64>,
    axis: &Vector3<f64>,
) -> [f64; 2] {
    let middle_m = 0.5 * (least_m + most_m);
    let half_m = (0.5 * (most_m - least_m)).dot(&axis.abs());
    let height_m = (middle_m - tip_m).dot(axis);
    [height_m - half_m, height_m + half_m]
}

/// What a body has met.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Taken {
    /// Whether nodes in material lie within it, and whether some lie well within.
    pub some: bool,
    pub well: bool,
    /// How deep nodes lay in material, m, that are now above its flat end, away from the rim.
    pub under_end_m: f64,
}

/// Nodes of a grid at most so far apart over a block, along each axis.
pub fn nodes(block: &Block, grid_m: f64) -> [usize; 3] {
    let cells = (block.most_m - block.least_m).map(|length| (length / grid_m - 1e-9).ceil());
    [cells.x, cells.y, cells.z].map(|cells| cells.max(1.0) as usize + 1)
}

impl DistanceField {
    /// A block but for holes, or what of it lies in a solid.
    pub fn of(block: Block, holes: &[Hole], solid: Option<&Solid>, grid_m: f64) -> Self {
        let depths_m = solid.map_or_else(Vec::new, |solid| solid.depths_m(grid_m));
        let mut stock = LayeredStock::new(block, holes, grid_m, &depths_m);
        if let Some(solid) = solid {
            stock.keep_within(solid);
        }
        Self::new(&stock, grid_m)
    }

    /// What layers hold, on a grid of at most `grid_m`.
    pub fn new(stock: &LayeredStock, grid_m: f64) -> Self {
        let block = stock.block;
        let nodes = nodes(&block, grid_m);
        let cells = Vector3::from(nodes.map(|count| (count - 1) as f64));
        let mut field = Self {
            block,
            spacing_m: (block.most_m - block.least_m).component_div(&cells),
            nodes,
            beyond_m: Vec::new(),
        };
        field.beyond_m = (0..nodes.iter().product())
            .map(|node| field.within_layers_m(stock, node) as f32)
            .collect();
        field
    }

    /// How deep a node lies in what layers hold: of the solids from the block's underside up to
    /// each layer's top, the one in which it lies deepest.
    fn within_layers_m(&self, stock: &LayeredStock, node: usize) -> f64 {
        let place = self.place(node);
        let far_m = FAR * self.grid_m();
        let mut deepest_m = -far_m;
        for (layer, one) in stock.layers().iter().enumerate() {
            let beyond_m = stock.beyond_m(layer, &place.xy());
            // The block's own face ends it.
            let under_m = match layer + 1 == stock.layers().len() {
                true => far_m,
                false => one.top_m - place.z,
            };
            deepest_m = deepest_m.max(beyond_m.min(under_m));
        }
        deepest_m.min(far_m)
    }

    /// The largest of the spacings.
    pub fn grid_m(&self) -> f64 {
        self.spacing_m.max()
    }

    pub fn spacing_m(&self) -> Vector3<f64> {
        self.spacing_m
    }

    pub fn nodes(&self) -> [usize; 3] {
        self.nodes
    }

    /// How far beside what is cut the distance to it is known, m.
    pub fn known_m(&self) -> f64 {
        KNOWN * self.grid_m()
    }

    pub fn values(&self) -> &[f32] {
        &self.beyond_m
    }

    pub(super) fn value_mut(&mut self, node: usize) -> &mut f32 {
        &mut self.beyond_m[node]
    }

    /// How far a node lies beyond what is cut, m; of one that is cut, beside one that is not, how
    /// far it lies within by what is known of that and of the next behind it.
    ///
    /// Within what a body has cut on its way the least of its distances is a bound: where its rim
    /// leaves the surface the true one is up to √2 times as large. Outside it is exact.
    pub(super) fn value_m(&self, node: usize) -> f64 {
        let own_m = f64::from(self.beyond_m[node]);
        if own_m > 0.0 {
            return own_m;
        }
        let (columns, rows) = (self.nodes[0], self.nodes[1]);
        let at = [
            node % columns,
            node / columns % rows,
            node / (columns * rows),
        ];
        let known_m = self.known_m();
        let mut nearest_m = f64::NEG_INFINITY;
        for (axis, step) in [1, columns, columns * rows].into_iter().enumerate() {
            let (below, above) = (at[axis], self.nodes[axis] - 1 - at[axis]);
            let sides = [(above, node + step, node + 2 * step)]
                .into_iter()
                .chain((below > 1).then(|| (below, node - step, node - 2 * step)));
            for (beyond, next, behind) in sides {
                if beyond < 2 {
                    continue;
                }
                let [next_m, behind_m] = [next, behind].map(|node| f64::from(self.beyond_m[node]));
                if next_m > 0.0 && behind_m > next_m && behind_m < known_m {
                    nearest_m = nearest_m.max(2.0 * next_m - behind_m);
                }
            }
        }
        match nearest_m > f64::NEG_INFINITY {
            true => nearest_m.min(-LEAST * self.grid_m()),
            false => own_m,
        }
    }

    /// Number of the node in a column, a row and a level.
    pub fn node(&self, [column, row, level]: [usize; 3]) -> usize {
        column + self.nodes[0] * (row + self.nodes[1] * level)
    }

    pub fn place(&self, node: usize) -> Vector3<f64> {
        let (columns, rows) = (self.nodes[0], self.nodes[1]);
        let at = [
            node % columns,
            node / columns % rows,
            node / (columns * rows),
        ];
        self.place_at(at)
    }

    pub fn place_at(&self, at: [usize; 3]) -> Vector3<f64> {
        let steps = Vector3::from(at.map(|index| index as f64));
        self.block.least_m + self.spacing_m.component_mul(&steps)
    }

    /// Whether a place lies in the block.
    pub fn contains(&self, place_m: &Vector3<f64>) -> bool {
        let Block { least_m, most_m } = self.block;
        (0..3).all(|axis| (least_m[axis]..=most_m[axis]).contains(&place_m[axis]))
    }

    /// How far a place lies beyond what is cut, m, in the block; outside as at its face.
    pub fn beyond_m(&self, place_m: &Vector3<f64>) -> f64 {
        let at = (place_m - self.block.least_m).component_div(&self.spacing_m);
        let mut first = [0; 3];
        let mut share = [0.0; 3];
        for axis in 0..3 {
            let last = self.nodes[axis] as f64 - 2.0;
            let index = at[axis].floor().clamp(0.0, last);
            first[axis] = index as usize;
            share[axis] = (at[axis] - index).clamp(0.0, 1.0);
        }
        let (row, level) = (self.nodes[0], self.nodes[0] * self.nodes[1]);
        let corner = self.node(first);
        let value = |offset: usize| self.value_m(corner + offset);
        let along_x =
            |offset: usize| value(offset) * (1.0 - share[0]) + value(offset + 1) * share[0];
        let along_y =
            |offset: usize| along_x(offset) * (1.0 - share[1]) + along_x(offset + row) * share[1];
        along_y(0) * (1.0 - share[2]) + along_y(level) * share[2]
    }

    /// Whether there is material at a place.
    pub fn is_left(&self, place_m: &Vector3<f64>) -> bool {
        self.contains(place_m) && self.beyond_m(place_m) > 0.0
    }

    /// Columns, rows and levels of the nodes between two places.
    fn between(&self, [least, most]: [Vector3<f64>; 2]) -> [Range<usize>; 3] {
        std::array::from_fn(|axis| {
            let origin = self.block.least_m[axis];
            let at = |x: f64| (x - origin) / self.spacing_m[axis];
            let low = at(least[axis]).ceil().max(0.0) as usize;
            let high = (at(most[axis]).floor() + 1.0).max(0.0) as usize;
            low..high.min(self.nodes[axis]).max(low)
        })
    }

    /// Columns, rows and levels of the nodes between two places, one after the other.
    pub(super) fn each(
        &self,
        bounds: [Vector3<f64>; 2],
    ) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [columns, rows, levels] = self.between(bounds);
        levels.flat_map(move |level| {
            let columns = columns.clone();
            rows.clone()
                .flat_map(move |row| columns.clone().map(move |column| [column, row, level]))
        })
    }

    /// Least and most places of the block that a body about an axis reaches, if it does: wider by
    /// a margin than its radius, from as far below its tip.
    pub(super) fn reached_by(
        &self,
        work_from_tool: &Isometry3<f64>,
        radius_m: f64,
        margin_m: f64,
    ) -> Option<[Vector3<f64>; 2]> {
        let axis = work_from_tool.rotation * Vector3::z();
        let tip_m = work_from_tool.translation.vector;
        let Block { least_m, most_m } = self.block;
        let [_, high_m] = heights_m(&[least_m, most_m], &tip_m, &axis);
        let low_m = -margin_m;
        if high_m <= low_m {
            return None;
        }
        let across = axis.map(|part| (1.0 - part * part).max(0.0).sqrt()) * (radius_m + margin_m);
        let (low, high) = (tip_m + axis * low_m, tip_m + axis * high_m);
        let least = (low.inf(&high) - across).sup(&least_m);
        let most = (low.sup(&high) + across).inf(&most_m);
        (0..3).all(|k| least[k] <= most[k]).then_some([least, most])
    }

    /// Length of the way between two places that lies in stock, m.
    pub(super) fn length_in_m(&self, from_m: &Vector3<f64>, to_m: &Vector3<f64>) -> f64 {
        let along_m = to_m - from_m;
        let (low, high) = self.block.clip(from_m, &along_m);
        let length_m = along_m.norm() * (high - low);
        if length_m <= 0.0 {
            return 0.0;
        }
        positive_m(length_m, self.grid_m(), [low, high], |share| {
            self.beyond_m(&(from_m + along_m * share))
        })
    }

    /// A body of revolution that does not vibrate goes from one pose to another by less than its
    /// radius; `keeps` leaves the material there.
    pub fn cut_way(&mut self, way: &SwivelLeg, profile: &Profile, keeps: bool) -> Taken {
        let known_m = self.known_m();
        let moved_m = way.moves_m((self.block.most_m - self.block.least_m).norm());
        let around_m = known_m + 0.5 * moved_m;
        let reached =
            [&way.from, &way.to].map(|pose| self.reached_by(pose, profile.radius_m, around_m));
        let bounds = match reached {
            [None, None] => return Taken::default(),
            [Some(one), None] | [None, Some(one)] => one,
            [Some(a), Some(b)] => [a[0].inf(&b[0]), a[1].sup(&b[1])],
        };
        let tool_from_work = [0.0, 0.5, 1.0].map(|share| way.at(share).inverse());
        let well_m = -self.grid_m();
        let end_m = profile.end_radius_m() + well_m;
        let mut taken = Taken::default();
        for at in self.each(bounds) {
            let node = self.node(at);
            let left_m = f64::from(self.beyond_m[node]);
            if left_m <= -known_m {
                continue;
            }
            let place = Point3::from(self.place_at(at));
            let seen = tool_from_work.map(|pose| off_and_height(&(pose * place)));
            let [a, b, c] = seen.map(|[off_m, height_m]| profile.outside_m(off_m, height_m));
            let mut beyond_m = a.min(b).min(c);
            // A quarter of the way lies between a place looked at and the farthest from it.
            if beyond_m - 0.25 * moved_m >= left_m.min(known_m) {
                continue;
            }
            if beyond_m > -known_m {
                beyond_m = beyond_m.min(nearest_m(way, &place, profile));
            }
            if beyond_m >= left_m.min(known_m) {
                continue;
            }
            taken.some |= beyond_m < 0.0 && left_m > 0.0;
            taken.well |= beyond_m < well_m && left_m > 0.0;
            let [off_m, height_m] = seen[2];
            if left_m > 0.0 && off_m < end_m && height_m > 0.0 {
                taken.under_end_m = taken.under_end_m.max(height_m.min(left_m));
            }
            if !keeps {
                self.beyond_m[node] = beyond_m as f32;
            }
        }
        taken
    }
}

/// Distance of a place from the axis of a tool, and its height above the tip.
fn off_and_height(place: &Point3<f64>) -> [f64; 2] {
    [place.x.hypot(place.y), place.z]
}

/// How far a place lies outside of a body, m, where on a way that is least. The distance from a
/// convex body that does not turn is convex along its way; here it turns by little.
fn nearest_m(way: &SwivelLeg, place: &Point3<f64>, profile: &Profile) -> f64 {
    let beyond_m = |share: f64| {
        let [off_m, height_m] = off_and_height(&way.at(share).inverse_transform_point(place));
        profile.outside_m(off_m, height_m)
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..NARROWED {
        let third = (high - low) / 3.0;
        match beyond_m(low + third) < beyond_m(high - third) {
            true => high -= third,
            false => low += third,
        }
    }
    beyond_m(0.5 * (low + high))
}
