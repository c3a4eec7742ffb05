//! Rows along a brush's axis in which the workpiece's section is looked at.
//!
//! Between corners of the workpiece its section changes smoothly along the axis. Where the same
//! sides are met at both ends of such a stretch and in its middle, or where it is short, a few rows
//! by Gauss's rule stand for it, two if they hardly change; elsewhere rows stand as close as slices
//! of the brush.

use super::layers::Layers;
use super::section::{Side, nearest_sides};
use nalgebra::{Vector2, Vector3};
use std::collections::HashMap;
use truecut_core::wheel::quadrature::Quadrature;

/// Slices of a brush.
pub(super) const SLICES: usize = 128;
/// How far within a stretch its ends are looked at, slices: the corners themselves are on the
/// border. Corners nearer to each other are one.
const WITHIN: f64 = 1e-3;
/// Stretches whose sides change by less are even enough for two rows: their sums are right to the
/// third power of that.
pub(super) const EVEN: f64 = 0.01;
/// A mesh with more corners under the brush has them everywhere, which stretches between them would
/// take too many of.
const MOST_CORNERS: usize = SLICES / 8;

/// Corners of a triangle in the tool's frame, m.
pub(super) type Corners = [Vector3<f64>; 3];

/// A row of bristles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BristleRow {
    pub y_m: f64,
    /// Part of the brush's width that it stands for.
    pub share: f64,
}

/// How sections change along a stretch of the axis.
enum Stretch {
    /// Hardly.
    Even,
    /// The nearest sides are the same all along.
    Smooth,
    /// Others are, or none.
    Broken,
}

/// The workpiece in planes across the axis.
pub(super) struct Sections<'a> {
    triangles: &'a [Corners],
    layers: Layers,
    pub(super) width_m: f64,
    pub(super) reach_m: f64,
    sides: Vec<Side>,
    /// Sections of rows that were looked at to choose them, by the bits of their place.
    pub(super) known: HashMap<u64, Vec<Side>>,
}

impl<'a> Sections<'a> {
    pub fn new(triangles: &'a [Corners], width_m: f64, reach_m: f64) -> Self {
        Self {
            triangles,
            layers: Layers::new(triangles, width_m),
            width_m,
            reach_m,
            sides: Vec::new(),
            known: HashMap::new(),
        }
    }

    /// The sides that bristles at `y_m` meet first.
    pub fn nearest(&mut self, y_m: f64, nearest: &mut Vec<Side>) {
        if let Some(known) = self.known.get(&y_m.to_bits()) {
            nearest.clone_from(known);
            return;
        }
        self.sides.clear();
        for index in self.layers.over(y_m) {
            let corners = &self.triangles[*index];
            self.sides
                .extend(section(*index, corners, y_m, self.reach_m));
        }
        nearest_sides(&self.sides, nearest);
    }

    /// Whether the workpiece holds a bristle to this point back by more than `nearer_m`.
    pub fn hide(&self, point_m: &Vector3<f64>, nearer_m: f64) -> bool {
        let foot_m = Vector3::y() * point_m.y;
        let way_m = point_m - foot_m;
        let free = 1.0 - nearer_m / way_m.norm();
        let over = self.layers.over(point_m.y).iter();
        let mut parts = over.filter_map(|index| part_to(&self.triangles[*index], &foot_m, &way_m));
        parts.any(|part| part < free)
    }

    /// Rows over the whole width, from one end to the other.
    pub fn rows(&mut self, rule: &Quadrature) -> Vec<BristleRow> {
        let width_m = self.width_m;
        let (end_m, slice_m) = (0.5 * width_m, width_m / SLICES as f64);
        let mut borders = self.corners(end_m, WITHIN * slice_m);
        if borders.len() > MOST_CORNERS {
            return self.fine_rows();
        }
        borders.insert(0, -end_m);
        borders.push(end_m);
        let mut rows = Vec::new();
        for pair in borders.windows(2) {
            let (middle_m, half_m) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            let slices = (2.0 * half_m / slice_m - 1e-9).ceil().max(1.0);
            let row = |(node, weight): (f64, f64)| BristleRow {
                y_m: middle_m + half_m * node,
                share: half_m * weight / width_m,
            };
            match self.stretch(middle_m, half_m - WITHIN * slice_m) {
                Stretch::Even => rows.extend(rule.pair().iter().copied().map(row)),
                Stretch::Broken if slices > rule.largest() as f64 => {
                    let place = |k: usize| (2 * k + 1) as f64 / slices - 1.0;
                    rows.extend((0..slices as usize).map(|k| row((place(k), 2.0 / slices))));
                }
                Stretch::Smooth | Stretch::Broken => {
                    rows.extend(rule.nodes().iter().copied().map(row));
                }
            }
        }
        rows
    }

    /// Where corners are between the brush's ends, in order; those nearer to each other or to an
    /// end than `apart_m` are one.
    fn corners(&self, end_m: f64, apart_m: f64) -> Vec<f64> {
        let all = self.triangles.iter().flatten().map(|corner| corner.y);
        let mut corners: Vec<f64> = all.filter(|y| y.abs() < end_m - apart_m).collect();
        corners.sort_unstable_by(f64::total_cmp);
        corners.dedup_by(|later, kept| *later - *kept < apart_m);
        corners
    }

    /// What sides do between the middle of a stretch without corners and its ends.
    fn stretch(&mut self, middle_m: f64, half_m: f64) -> Stretch {
        let (mut first, mut nearest) = (Vec::new(), Vec::new());
        self.nearest(middle_m, &mut first);
        let (mut are_same, mut changes) = (true, 0.0);
        for off_m in [-half_m, half_m] {
            self.nearest(middle_m + off_m, &mut nearest);
            if first.is_empty() || nearest.len() != first.len() {
                return Stretch::Broken;
            }
            for (one, other) in first.iter().zip(&nearest) {
                are_same &= one.triangle == other.triangle;
                let turned = (one.from_rad - other.from_rad).abs();
                let turned = turned.max((one.to_rad - other.to_rad).abs());
                let moved = (one.distance_m - other.distance_m).abs() / self.reach_m;
                changes = f64::max(changes, turned.max(moved));
            }
        }
        match are_same {
            _ if changes < EVEN => Stretch::Even,
            true => Stretch::Smooth,
            false => Stretch::Broken,
        }
    }
}

/// Whether a triangle, seen along the axis, comes nearer to it than bristles reach.
pub(super) fn is_in_reach(corners_m: &Corners, reach_m: f64) -> bool {
    let [a, b, c] = corners_m.map(|corner| Vector2::new(corner.x, corner.z));
    let mut turns = [0.0; 3];
    for (turn, (from, to)) in turns.iter_mut().zip([(a, b), (b, c), (c, a)]) {
        let way = to - from;
        *turn = from.perp(&way);
        let part = (-from.dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
        // A side of no length, seen so, is its end.
        let part = if part.is_nan() { 0.0 } else { part };
        if (from + way * part).norm_squared() < reach_m * reach_m {
            return true;
        }
    }
    // The axis itself may go through it.
    turns.iter().all(|turn| *turn >= 0.0) || turns.iter().all(|turn| *turn <= 0.0)
}

/// What part of a way from a point leads to a triangle that faces it.
fn part_to(corners_m: &Corners, from_m: &Vector3<f64>, way_m: &Vector3<f64>) -> Option<f64> {
    let [a, b, c] = corners_m;
    let outward = (b - a).cross(&(c - a));
    let falls = outward.dot(way_m);
    let part = outward.dot(&(a - from_m)) / falls;
    if falls >= 0.0 || part <= 0.0 {
        return None;
    }
    let at = from_m + way_m * part;
    let is_inside = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|(from, to)| (*to - *from).cross(&(at - *from)).dot(&outward) >= 0.0);
    is_inside.then_some(part)
}

/// A triangle's side in the plane at `y`, if it faces the axis there.
fn section(triangle: usize, corners_m: &Corners, y: f64, reach_m: f64) -> Option<Side> {
    let [a, b, c] = corners_m;
    let is_above = |corner: &Vector3<f64>| corner.y > y;
    let crosses = |from: &Vector3<f64>, to: &Vector3<f64>| {
        (is_above(from) != is_above(to)).then(|| {
            let part = (y - from.y) / (to.y - from.y);
            [
                from.x + part * (to.x - from.x),
                from.z + part * (to.z - from.z),
            ]
        })
    };
    let mut ends = [crosses(a, b), crosses(b, c), crosses(c, a)]
        .into_iter()
        .flatten();
    let ends_m = [ends.next()?, ends.next()?];
    let outward = (b - a).cross(&(c - a));
    let faces_axis = outward.dot(&(Vector3::y() * y - a)) > 0.0;
    faces_axis
        .then(|| Side::new(triangle, ends_m, reach_m))
        .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Isometry3, Point3, Rotation3};

    const RADIUS_M: f64 = 60e-3;
    const WIDTH_M: f64 = 20e-3;

    /// A block of 100 x 60 x 20 mm whose long upper edge runs along y through the origin, faces
    /// down to +x and up to +z of it away.
    fn block(tool_from_block: &Isometry3<f64>) -> Vec<Corners> {
        let corner = |i: usize| {
            let part = |bit: usize| ((i >> bit) & 1) as f64;
            let at = Point3::new(60e-3 * part(0), 100e-3 * (part(1) - 0.5), 20e-3 * part(2));
            (tool_from_block * at).coords
        };
        // Wound counter-clockwise seen from outside.
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        faces
            .iter()
            .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
            .map(|triangle| triangle.map(corner))
            .collect()
    }

    /// Sum over all bristles of how much they are shortened, by rows and by 64 times as many
    /// slices.
    fn sums(triangles: &[Corners]) -> [f64; 2] {
        let rule = Quadrature::new(8);
        let mut sections = Sections::new(triangles, WIDTH_M, RADIUS_M);
        let mut nearest = Vec::new();
        let mut sum = |rows: Vec<BristleRow>, sections: &mut Sections| -> f64 {
            let over = |row: &BristleRow| {
                sections.nearest(row.y_m, &mut nearest);
                let parts = nearest.iter().map(|side| {
                    rule.integrate(side.from_rad, side.to_rad, |angle| {
                        RADIUS_M - side.along_bristle_m(angle)
                    })
                });
                row.share * parts.sum::<f64>()
            };
            rows.iter().map(over).sum()
        };
        let rows = sections.rows(&rule);
        let whole: f64 = rows.iter().map(|row| row.share).sum();
        assert!((whole - 1.0).abs() < 1e-12);
        let count = 64 * SLICES;
        let slices = (0..count).map(|k| BristleRow {
            y_m: WIDTH_M * ((k as f64 + 0.5) / count as f64 - 0.5),
            share: 1.0 / count as f64,
        });
        [
            sum(rows, &mut sections),
            sum(slices.collect(), &mut sections),
        ]
    }

    /// Over the edge, tilted and turned, and off the block's end by parts of the brush's width.
    #[test]
    fn regress_rows_are_as_good_as_many_slices() {
        let mut pressed = 0;
        for (place, shift_m) in [0.0, 30e-3, 45e-3, 52e-3, 58e-3].into_iter().enumerate() {
            for tilt in [-0.2, -0.02, 0.0, 1e-4, 0.05] {
                for turn in [-0.3, 0.0, 0.01, 0.4] {
                    let axes = Rotation3::from_euler_angles(tilt, 0.8 + 0.1 * place as f64, turn);
                    // The brush's axis above the edge, pressed in by 3 mm.
                    let off = axes * Vector3::new(0.0, 0.0, RADIUS_M - 3e-3);
                    let tool_from_block = Isometry3::from_parts(
                        (off - axes * Vector3::y() * shift_m).into(),
                        axes.into(),
                    );
                    let [rows, slices] = sums(&block(&tool_from_block));
                    pressed += usize::from(slices > 0.0);
                    assert!(
                        (rows - slices).abs() < 1e-3 * slices + 2e-9,
                        "{shift_m} {tilt} {turn}: {rows} {slices}"
                    );
                }
            }
        }
        assert!(pressed > 80, "{pressed}");
    }

    /// Nearest places of a triangle: a corner, a side's middle, its inside; and behind the axis.
    #[test]
    fn verify_triangles_in_reach() {
        let corners = |points: [[f64; 2]; 3]| points.map(|[x, z]| Vector3::new(x, 0.3 * x, z));
        let at = |points, reach_m| is_in_reach(&corners(points), reach_m);
        let corner = [[3.0, 4.0], [9.0, 4.0], [3.0, 9.0]];
        assert!(at(corner, 5.001) && !at(corner, 4.999));
        let side = [[-3.0, -4.0], [3.0, -4.0], [0.0, -9.0]];
        assert!(at(side, 4.001) && !at(side, 3.999));
        assert!(at([[-3.0, -4.0], [3.0, -4.0], [0.0, 9.0]], 0.1));
        assert!(at([[-3.0, -4.0], [0.0, 9.0], [3.0, -4.0]], 0.1));
        let edge_on = [[3.0, 4.0], [3.0, 4.0], [6.0, 8.0]];
        assert!(at(edge_on, 5.001) && !at([[3.0, 4.1], [3.0, 4.1], [6.0, 8.0]], 4.999));
    }

    /// Where nothing but one face is under the brush, two rows do, and more if the brush leans.
    #[test]
    fn an_even_stretch_takes_few_rows() {
        let level = Isometry3::translation(-20e-3, 0.0, RADIUS_M - 3e-3);
        let leaning = Isometry3::rotation(Vector3::x() * 0.05) * level;
        let count = |tool_from_block: &Isometry3<f64>| {
            let triangles = block(tool_from_block);
            let mut sections = Sections::new(&triangles, WIDTH_M, RADIUS_M);
            sections.rows(&Quadrature::new(8)).len()
        };
        assert_eq!(count(&level), 2);
        assert!(count(&leaning) >= 8);
    }

    /// A plate with a groove, meshed finely: its section is the same at the brush's ends and in its
    /// middle, not between. Only about the groove's walls it is looked at slice by slice.
    #[test]
    fn verify_rows_over_a_fine_mesh_are_as_good_as_many_slices() {
        let height = |k: i32| RADIUS_M - if (10..14).contains(&k) { 1e-3 } else { 3e-3 };
        let corner = |x: f64, k: i32| Vector3::new(x, 0.5e-3 * f64::from(k), height(k));
        let strip = |k: i32| {
            let [a, b] = [-0.1, 0.1].map(|x| corner(x, k));
            let [c, d] = [-0.1, 0.1].map(|x| corner(x, k + 1));
            [[a, c, b], [b, c, d]]
        };
        let triangles: Vec<Corners> = (-40..40).flat_map(strip).collect();
        let mut sections = Sections::new(&triangles, WIDTH_M, RADIUS_M);
        let count = sections.rows(&Quadrature::new(8)).len();
        assert!(count > 32 && count < SLICES / 2, "{count}");
        let [rows, slices] = sums(&triangles);
        assert!((rows - slices).abs() < 1e-3 * slices, "{rows} {slices}");
    }
}
