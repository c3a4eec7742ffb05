//! Where the tool point would be without deflection: the commanded path in the work frame.

use nalgebra::{Isometry3, Rotation3, Unit, Vector3};
use truecut_arm::{FrameId, Robot};
use truecut_core::cutting::milling::layered::way::Meant;
use truecut_core::cutting::milling::profile::Profile;
use truecut_core::cutting::milling::swivel::way::turned_to;
use truecut_plan::motion::interpolation::{hermite, slope};

/// Pieces of the path that are taken for straight leave it by no more than this part of the grid.
const STRAIGHT: f64 = 0.01;
/// Most intervals in one of them, and heights that differ by no more are one depth, m.
const MOST_MERGED: usize = 50;
const SAME_DEPTH_M: f64 = 1e-9;

/// Places at even times, with cubics between them as between the commanded postures.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NominalPath {
    interval_s: f64,
    places_m: Vec<Vector3<f64>>,
    /// Way up to each place, m.
    along_m: Vec<f64>,
    /// Axes of the tool at each place, turned from one to the next but not about its own; of a tool
    /// that stands upright none.
    axes: Vec<Rotation3<f64>>,
}

/// A place of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OnPath {
    pub place_m: Vector3<f64>,
    pub velocity_m_per_s: Vector3<f64>,
    pub along_m: f64,
    /// From the tool's axes, z against it, to those of the work frame.
    pub axes: Rotation3<f64>,
}

impl NominalPath {
    /// Of an arm that is led through postures at even times, its tool upright or not.
    pub fn new(
        robot: &Robot,
        knots: &[Vec<f64>],
        interval_s: f64,
        work_from_world: &Isometry3<f64>,
        leans: bool,
    ) -> Self {
        let mut axes = Vec::new();
        let mut before = Rotation3::identity();
        let mut places_m: Vec<Vector3<f64>> = Vec::with_capacity(knots.len());
        for q in knots {
            let tool = work_from_world * robot.world_from_frame(q, FrameId::Tool);
            places_m.push(tool.translation.vector);
            if leans {
                before = turned_to(&before, &Unit::new_normalize(tool.rotation * -Vector3::z()));
                axes.push(before);
            }
        }
        let mut along_m = vec![0.0];
        for pair in places_m.windows(2) {
            along_m.push(along_m[along_m.len() - 1] + (pair[1] - pair[0]).norm());
        }
        Self {
            interval_s,
            places_m,
            along_m,
            axes,
        }
    }

    /// The place that is nearest to a way along the path, its number.
    pub fn knot_at(&self, along_m: f64) -> usize {
        let after = self.along_m.partition_point(|here_m| *here_m < along_m);
        let last = self.along_m.len() - 1;
        let off = |k: usize| (self.along_m[k] - along_m).abs();
        let (before, after) = (after.saturating_sub(1), after.min(last));
        if off(before) <= off(after) {
            before
        } else {
            after
        }
    }

    /// Where a cutter that is led along changes its depth in stock, if it does.
    pub fn sinks_into(&self, meant: &Meant, profile: &Profile) -> Option<Vector3<f64>> {
        let mut left = meant.stock.clone();
        let radius_m = profile.radius_m;
        for pair in self.chords(STRAIGHT * left.grid_m()) {
            let tip_m = pair[0].z.min(pair[1].z);
            if tip_m >= left.block.most_m.z || left.block.outside_m(&pair[1].xy()) > radius_m {
                continue;
            }
            // Above what it is about to cut, by more than it may vibrate.
            let next = left
                .layers()
                .partition_point(|one| one.top_m <= tip_m + 1e-9);
            // At the stock's top face, but for rounding.
            let Some(layer) = left.layers().get(next) else {
                continue;
            };
            let is_at_depth = match profile.is_flat() {
                true => tip_m <= layer.bottom_m + layer.sunk_m(),
                false => meant.is_at_level(tip_m),
            };
            if is_at_depth {
                left.cut_leg(pair, profile, false);
            } else if left.cut_leg(pair, profile, true) {
                return Some(pair[1]);
            }
        }
        None
    }

    /// The path as straight pieces that leave it by `off_m` at most.
    fn chords(&self, off_m: f64) -> Vec<[Vector3<f64>; 2]> {
        let mut chords = Vec::new();
        let mut first = 0;
        for last in 1..self.places_m.len() {
            let from_to = |to: usize| [self.places_m[first], self.places_m[to]];
            let ends = last + 1 == self.places_m.len();
            if ends || last - first == MOST_MERGED || !self.is_straight(first, last + 1, off_m) {
                chords.push(from_to(last));
                first = last;
            }
        }
        chords
    }

    /// Whether all places between two lie so near to the chord, in order.
    fn is_straight(&self, first: usize, last: usize, off_m: f64) -> bool {
        let (from, to) = (self.places_m[first], self.places_m[last]);
        let along = to - from;
        let length_m = along.norm();
        let mut before_m = 0.0;
        // At its lower end a cutter that sinks would be taken to be everywhere.
        let is_level = |off: &Vector3<f64>| off.z.abs() <= SAME_DEPTH_M;
        (first + 1..last).all(|between| {
            let off = self.places_m[between] - from;
            let way_m = off.dot(&along) / length_m;
            let forwards = way_m >= before_m && way_m <= length_m;
            before_m = way_m;
            is_level(&off)
                && is_level(&along)
                && forwards
                && (off - along * (way_m / length_m)).norm() <= off_m
        })
    }

    pub fn length_m(&self) -> f64 {
        self.along_m[self.along_m.len() - 1]
    }

    /// At a time; at rest behind the end.
    pub fn at(&self, time_s: f64) -> OnPath {
        let last = self.places_m.len() - 1;
        let x = (time_s / self.interval_s).clamp(0.0, last as f64);
        let k = (x.floor() as usize).min(last.saturating_sub(1));
        let next = (k + 1).min(last);
        let u = x - k as f64;
        let (mut place_m, mut velocity_m_per_s) = (Vector3::zeros(), Vector3::zeros());
        for axis in 0..3 {
            let knot = |i: usize| self.places_m[i][axis];
            let slopes = [k, k + 1].map(|i| slope(knot, last, i));
            let [value, rate] = hermite([knot(k), knot(next)], slopes, u);
            place_m[axis] = value;
            velocity_m_per_s[axis] = rate / self.interval_s;
        }
        OnPath {
            place_m,
            velocity_m_per_s,
            along_m: self.along_m[k] + u * (self.along_m[next] - self.along_m[k]),
            axes: self.axes_between([k, next], u),
        }
    }

    fn axes_between(&self, [k, next]: [usize; 2], u: f64) -> Rotation3<f64> {
        let last = self.places_m.len() - 1;
        let Some(from) = self.axes.get(k) else {
            return Rotation3::identity();
        };
        let direction = Vector3::from_fn(|part, _| {
            let knot = |i: usize| self.axes[i].matrix()[(part, 2)];
            let slopes = [k, k + 1].map(|i| slope(knot, last, i));
            hermite([knot(k), knot(next)], slopes, u)[0]
        });
        turned_to(from, &Unit::new_normalize(direction))
    }
}
