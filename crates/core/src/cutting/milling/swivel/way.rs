//! The path of a tool that turns as it is written: what it must not do, the part that it means.

use super::field::DistanceField;
use super::surface::LEAST;
use crate::cutting::milling::layered::way::WayFault;
use crate::cutting::milling::profile::Profile;
use nalgebra::{Isometry3, Matrix3, Rotation3, Unit, Vector3};

/// A way is cut in pieces by which no part of the tool moves further than this part of its radius.
const PIECE: f64 = 0.25;
/// A tool that goes down along its axis by no more than this part of its way keeps its depth.
pub const LEVEL: f64 = 1e-3;

/// A piece of a path between two poses of the tool, z up its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SwivelLeg {
    pub from: Isometry3<f64>,
    pub to: Isometry3<f64>,
    /// Whether it is one of rapid traverse, or of joints.
    pub rapid: bool,
    /// Point of the path that it leads to.
    pub point: usize,
}

/// Slopes of the distance from a surface below this stand at an edge.
const LEAST_SLOPE: f64 = 0.7;

/// What a path means for a stock.
#[derive(Debug, Clone, PartialEq)]
pub struct SwivelMeant {
    /// The stock before the first cut.
    pub stock: DistanceField,
    /// What a cutter that does not vibrate leaves of it on the path as written.
    pub target: DistanceField,
}

impl SwivelMeant {
    /// How far material stands out of what is meant at a place of a surface, along its normal, m:
    /// negative where too much was taken, which is told up to how far distances are known. `None`
    /// on the block's faces, where the stock ended before, and at edges.
    pub fn left_m(&self, place_m: &Vector3<f64>) -> Option<f64> {
        let target = &self.target;
        let near_m = LEAST * target.grid_m();
        let (least_m, most_m) = (target.block.least_m, target.block.most_m);
        let is_inside = (0..3).all(|axis| {
            place_m[axis] > least_m[axis] + near_m && place_m[axis] < most_m[axis] - near_m
        });
        if !is_inside || self.stock.beyond_m(place_m) < near_m {
            return None;
        }
        let (beyond_m, known_m) = (target.beyond_m(place_m), target.known_m());
        if beyond_m.abs() >= known_m {
            return Some(-beyond_m.min(known_m));
        }
        let half_m = 0.5 * target.spacing_m();
        let slope = Vector3::from_fn(|axis, _| {
            let mut step = Vector3::zeros();
            step[axis] = half_m[axis];
            let ahead = target.beyond_m(&(place_m + step));
            (ahead - target.beyond_m(&(place_m - step))) / (2.0 * half_m[axis])
        });
        (slope.norm() >= LEAST_SLOPE).then_some(-beyond_m)
    }
}

/// Axes that are turned so that z comes to a direction, by no more than that.
pub fn turned_to(axes: &Rotation3<f64>, direction: &Unit<Vector3<f64>>) -> Rotation3<f64> {
    let axis = axes * Vector3::z();
    let across = axis.cross(direction).cross_matrix();
    // Rodrigues without the angle, which is lost where it is small. Opposite directions have no
    // shortest way; a tool does not turn over between two of its steps.
    let turn = Matrix3::identity() + across + across * across / (1.0 + axis.dot(direction));
    Rotation3::from_matrix_unchecked(turn) * axes
}

impl SwivelLeg {
    /// The pose at a share of the way.
    pub fn at(&self, share: f64) -> Isometry3<f64> {
        let (from, to) = (self.from.translation.vector, self.to.translation.vector);
        let axes = self.from.rotation.slerp(&self.to.rotation, share);
        Isometry3::from_parts(from.lerp(&to, share).into(), axes)
    }

    /// The way between two shares of it.
    fn between(&self, from: f64, to: f64) -> Self {
        Self {
            from: self.at(from),
            to: self.at(to),
            ..*self
        }
    }

    /// Its start.
    fn standing(&self) -> Self {
        Self {
            to: self.from,
            ..*self
        }
    }

    /// Farthest that a place of a body moves that is no farther from the tip than this, m.
    pub(super) fn moves_m(&self, reach_m: f64) -> f64 {
        let turned_rad = self.from.rotation.angle_to(&self.to.rotation);
        (self.to.translation.vector - self.from.translation.vector).norm() + turned_rad * reach_m
    }
}

/// Follows a path through stock with a cutter of this outline.
///
/// # Errors
/// The first thing that the cutter cannot do.
pub fn follow(
    legs: &[SwivelLeg],
    stock: DistanceField,
    profile: &Profile,
) -> Result<SwivelMeant, WayFault> {
    let piece_m = PIECE * profile.radius_m;
    let reach_m = (stock.block.most_m - stock.block.least_m).norm();
    let mut target = stock.clone();
    if let Some(first) = legs.first()
        && target.cut_way(&first.standing(), profile, true).well
    {
        return Err(WayFault::StartsInStock);
    }
    let mut cuts = false;
    for leg in legs {
        let pieces = (leg.moves_m(reach_m) / piece_m).ceil().max(1.0);
        let share = |piece: usize| piece as f64 / pieces;
        for piece in 0..pieces as usize {
            let way = leg.between(share(piece), share(piece + 1));
            let cut = target.cut_way(&way, profile, leg.rapid);
            let to_m = way.to.translation.vector;
            if leg.rapid && cut.well {
                let point = leg.point;
                return Err(WayFault::Rapid { point, to_m });
            }
            let way_m = to_m - way.from.translation.vector;
            let sunk_m = -way_m.dot(&(way.to.rotation * Vector3::z()));
            if cut.under_end_m > 0.0 && sunk_m > LEVEL * way_m.norm() {
                return Err(WayFault::LeadsDown {
                    point: leg.point,
                    at_m: to_m,
                    sinks: sunk_m / way_m.norm(),
                });
            }
            cuts |= cut.some;
        }
    }
    match cuts {
        true => Ok(SwivelMeant { stock, target }),
        false => Err(WayFault::Misses),
    }
}
