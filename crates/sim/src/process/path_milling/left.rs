//! What is left on floors and walls beyond the path as written, and the part that shows it.

use nalgebra::{Vector2, Vector3};
use std::borrow::Cow;
use std::f64::consts::TAU;
use truecut_core::cutting::milling::layered::cut::LayeredCut;
use truecut_core::cutting::milling::layered::outline::Facing;
use truecut_core::cutting::milling::layered::stock::LayeredStock;
use truecut_core::cutting::milling::layered::way::{COARSEST, Leg, Meant};
use truecut_recording::PartMesh;

/// Floors under a round corner are no steeper than 60 degrees: cosine and tangent.
const LEAST_COS: f64 = 0.5;
const STEEPEST: f64 = 1.732;
/// Directions about a place in which a step of the floor is looked for.
const DIRECTIONS: usize = 8;
/// A floor that sinks is written in pieces, which part it by less than this, m.
const UNEVEN_M: f64 = 50e-6;
/// Ways that lead to the side by no more are straight down or up, m.
const UPRIGHT_M: f64 = 1e-6;
/// A corner so near to the block's face lies on it, m.
const ON_FACE_M: f64 = 1e-12;

/// Material left on floors by node; not a number where there is none, or no tooth has been, and
/// beside walls and steps: how deep it is there is the wall's error.
pub(super) fn floor_left_m(
    cut: &LayeredCut,
    legs: &[Leg],
    meant: &Meant,
    radius_m: f64,
) -> Vec<f64> {
    let floor_m = cut.floor_m();
    match &meant.floor_cos {
        Some(cos) => Floors::round(meant, radius_m).round_left_m(cos, floor_m),
        None => Floors::flat(meant, legs, radius_m).flat_left_m(floor_m),
    }
}

/// Floors as written.
struct Floors<'a> {
    meant: &'a Meant,
    /// Their heights by node, infinite where there is none.
    written_m: Cow<'a, [f64]>,
    /// Nearer to a wall or a step than this they are not looked at: a part of the radius, whatever
    /// the grid.
    within_m: f64,
    /// What is no step: rise over run, and beyond that a height, m.
    slope: f64,
    uneven_m: f64,
}

impl<'a> Floors<'a> {
    fn flat(meant: &'a Meant, legs: &[Leg], radius_m: f64) -> Self {
        let within_m = COARSEST * radius_m;
        match &meant.floor_m {
            Some(floor_m) => Self {
                meant,
                written_m: Cow::Borrowed(floor_m.as_slice()),
                within_m,
                slope: slope(legs, meant.target.block.most_m.z),
                uneven_m: UNEVEN_M,
            },
            None => Self {
                meant,
                written_m: Cow::Owned(levels_m(meant)),
                within_m,
                slope: 0.0,
                uneven_m: 0.0,
            },
        }
    }

    fn round(meant: &'a Meant, radius_m: f64) -> Self {
        Self {
            meant,
            written_m: Cow::Borrowed(meant.floor_m.as_deref().unwrap_or_default()),
            within_m: COARSEST * radius_m,
            slope: STEEPEST,
            uneven_m: 0.0,
        }
    }

    /// Under a flat end, along z.
    fn flat_left_m(&self, floor_m: &[f64]) -> Vec<f64> {
        let Meant { stock, target, .. } = self.meant;
        let each = floor_m.iter().zip(self.written_m.iter()).enumerate();
        let left = each.map(|(node, (floor_m, written_m))| {
            let place = target.place(node);
            let is_well_within = || {
                (0..target.layers().len()).any(|layer| {
                    target.beyond_m(layer, &place) < -self.within_m
                        && stock.beyond_m(layer, &place) > 0.0
                })
            };
            let is_floor = floor_m.is_finite()
                && written_m.is_finite()
                && *written_m > target.block.least_m.z
                && is_well_within()
                && self.steps(node) == [false; 2];
            match is_floor {
                true => floor_m - written_m,
                false => f64::NAN,
            }
        });
        left.collect()
    }

    /// Under a round corner, along the normal of what the path as written leaves.
    fn round_left_m(&self, cos: &[f64], floor_m: &[f64]) -> Vec<f64> {
        let block = self.meant.target.block;
        let written = self.written_m.iter().zip(cos);
        let each = floor_m.iter().zip(written).enumerate();
        let left = each.map(|(node, (floor_m, (written_m, cos)))| {
            // Its own flank may lead up as steeply as it likes.
            let is_floor = *cos >= LEAST_COS
                && floor_m.is_finite()
                && (block.least_m.z..block.most_m.z).contains(written_m)
                && !self.steps(node)[0];
            match is_floor {
                true => (floor_m - written_m) * cos,
                false => f64::NAN,
            }
        });
        left.collect()
    }

    /// Whether beside a node another floor lies lower, and higher, than a slope leads to.
    fn steps(&self, node: usize) -> [bool; 2] {
        let target = &self.meant.target;
        let place = target.place(node);
        let mut found = [false; 2];
        for k in 0..DIRECTIONS {
            let (sin, cos) = (TAU * k as f64 / DIRECTIONS as f64).sin_cos();
            let other = target.nearest(&(place + Vector2::new(cos, sin) * self.within_m));
            let rise_m = self.written_m[other] - self.written_m[node];
            if rise_m.is_finite() {
                let way_m = (target.place(other) - place).norm();
                let most_m = self.slope * way_m + self.uneven_m;
                found[0] |= rise_m < -most_m;
                found[1] |= rise_m > most_m;
            }
        }
        found
    }
}

/// By node the bottom of the lowest layer of the stock that the path as written takes.
fn levels_m(meant: &Meant) -> Vec<f64> {
    let Meant { stock, target, .. } = meant;
    let [columns, rows] = target.nodes();
    let level_m = |node: usize| {
        let place = target.place(node);
        let is_taken = |layer: &usize| {
            target.beyond_m(*layer, &place) < 0.0 && stock.beyond_m(*layer, &place) > 0.0
        };
        let lowest = (0..target.layers().len()).find(is_taken);
        lowest.map_or(f64::INFINITY, |layer| target.layers()[layer].bottom_m)
    };
    (0..columns * rows).map(level_m).collect()
}

/// Rise over run of the steepest feed that leads below a height; of none that is upright.
fn slope(legs: &[Leg], top_m: f64) -> f64 {
    let below = legs
        .iter()
        .filter(|leg| !leg.rapid && leg.from_m.z.min(leg.to_m.z) < top_m);
    let slopes = below.filter_map(|leg| {
        let way_m = leg.to_m - leg.from_m;
        let run_m = way_m.xy().norm();
        (run_m > UPRIGHT_M).then(|| way_m.z.abs() / run_m)
    });
    slopes.fold(0.0, f64::max)
}

/// The part with what is left beyond the target, of which the floors' is known.
pub(super) fn part(cut: &LayeredCut, meant: &Meant, floors: &[f64]) -> PartMesh {
    let (stock, target) = (cut.stock(), &meant.target);
    let floor_m = |corner: &Vector3<f64>| floors[stock.nearest(&corner.xy())];
    let mut part = PartMesh::default();
    for triangle in stock.surface() {
        let left = triangle.corners_m.map(|corner| match triangle.facing {
            // The block's underside has no target.
            Facing::Under => f64::NAN,
            Facing::Floor => floor_m(&corner),
            Facing::Wall { layer } => {
                wall_left_m(target, layer, &corner).unwrap_or_else(|| floor_m(&corner))
            }
        });
        let corners = triangle.corners_m;
        part.triangles_m
            .push(corners.map(|corner| [corner.x, corner.y, corner.z].map(|x| x as f32)));
        part.left_m.push(left.map(|left| left as f32));
    }
    part
}

/// How far a corner of a layer's wall stands out of the target; not a number on the block's faces.
/// `None` below a floor where the path as written has no wall near: it is the side of a dent, and
/// belongs to the floor.
fn wall_left_m(target: &LayeredStock, layer: usize, corner: &Vector3<f64>) -> Option<f64> {
    let (least, most) = (target.block.least_m, target.block.most_m);
    // Nodes are counted from one face: the last lies on the other but for rounding.
    let near = |x: f64, face: f64| (x - face).abs() < ON_FACE_M;
    let on_face =
        (0..2).any(|axis| near(corner[axis], least[axis]) || near(corner[axis], most[axis]));
    if on_face {
        return Some(f64::NAN);
    }
    let place = corner.xy();
    let beyond_m = target.beyond_m(layer, &place);
    let top = target.layers().len() - 1;
    let is_below_floor = target.beyond_m(top, &place) < 0.0;
    let is_dent = is_below_floor && beyond_m > target.known_m();
    (!is_dent).then_some(-beyond_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use truecut_core::cutting::milling::layered::block::Block;
    use truecut_core::cutting::milling::layered::way::follow;
    use truecut_core::cutting::milling::profile::Profile;

    const RADIUS_M: f64 = 6e-3;
    /// What every floor of the tests is too high by, m.
    const HIGH_M: f64 = 20e-6;

    fn mm(x: f64, y: f64, z: f64) -> Vector3<f64> {
        Vector3::new(x, y, z) * 1e-3
    }

    fn leg(from_m: Vector3<f64>, to_m: Vector3<f64>) -> Leg {
        Leg {
            from_m,
            to_m,
            rapid: false,
            point: 1,
        }
    }

    /// A block of 60 x 40 x 10 mm, its top at zero.
    fn meant(legs: &[Leg], ends_cut: bool) -> Meant {
        let block = Block {
            least_m: mm(0.0, 0.0, -10.0),
            most_m: mm(60.0, 40.0, 0.0),
        };
        let profile = Profile::flat(RADIUS_M);
        follow(legs, block, &[], None, &profile, 0.5e-3, ends_cut).expect("a path")
    }

    /// A floor of 2 mm, from wall to wall of the block's ends, and along it a slot of 5 mm.
    fn two_floors() -> Vec<Leg> {
        let line = |y: f64, z: f64| leg(mm(-10.0, y, z), mm(70.0, y, z));
        let mut legs: Vec<Leg> = [8.0, 14.0, 20.0, 26.0, 32.0].map(|y| line(y, -2.0)).into();
        legs.push(line(19.95, -5.0));
        legs
    }

    /// What tools of another radius leave at the nodes on lines along x.
    fn left_by(meant: &Meant, legs: &[Leg], radius_m: f64) -> Vec<f64> {
        let [columns, rows] = meant.target.nodes();
        let lowest_m = |node: usize| {
            let y_m = meant.target.place(node).y;
            let over = legs
                .iter()
                .filter(|leg| (leg.from_m.y - y_m).abs() <= radius_m);
            over.map(|leg| leg.from_m.z).fold(f64::INFINITY, f64::min) + HIGH_M
        };
        (0..columns * rows).map(lowest_m).collect()
    }

    /// Where two floors meet a wall that is cut too far, or not far enough, is no floor that is
    /// wrong by the step between them.
    #[test]
    fn floors_that_meet_have_their_own_errors() {
        let legs = two_floors();
        let meant = meant(&legs, false);
        let floors = Floors::flat(&meant, &legs, RADIUS_M);
        for off_m in [-0.1e-3, 0.0, 0.1e-3] {
            let floor_m = left_by(&meant, &legs, RADIUS_M + off_m);
            let left = floors.flat_left_m(&floor_m);
            let both = left.iter().zip(&floor_m);
            let known = both.filter(|(left, _)| left.is_finite());
            for (left_m, _) in known.clone() {
                assert!((left_m - HIGH_M).abs() < 1e-12, "{off_m}: {left_m}");
            }
            let (shallow, deep): (Vec<_>, Vec<_>) = known.partition(|(_, z)| **z > -3e-3);
            // Of 36 x 60 mm less what lies within 0.75 mm of walls and steps.
            let counts = [shallow.len(), deep.len()];
            assert!(counts[0] > 4500 && counts[1] > 2000, "{counts:?}");
        }
    }

    /// A ramp is no step: all of its middle counts.
    #[test]
    fn a_ramp_is_a_floor_all_along() {
        let legs = [
            leg(mm(10.0, 20.0, 1.0), mm(50.0, 20.0, -2.0)),
            leg(mm(50.0, 20.0, -2.0), mm(20.0, 20.0, -2.0)),
        ];
        let meant = meant(&legs[..1], true);
        let written_m = meant.floor_m.as_ref().expect("a floor that sinks");
        let floor_m: Vec<f64> = written_m.iter().map(|z| z + HIGH_M).collect();
        let floors = Floors::flat(&meant, &legs[..1], RADIUS_M);
        let left = floors.flat_left_m(&floor_m);
        for x in 30..52 {
            let place = Vector2::new(f64::from(x), 20.0) * 1e-3;
            let left_m = left[meant.target.nearest(&place)];
            assert!((left_m - HIGH_M).abs() < 1e-12, "{x} mm: {left_m}");
        }
        assert!((slope(&legs, 0.0) - 0.075).abs() < 1e-12);
    }

    /// A wall has its own error, the side of a dent in a floor that of the floor, what stands on
    /// the block's faces none.
    #[test]
    fn corners_belong_to_walls_or_floors() {
        let meant = meant(&two_floors(), false);
        let target = &meant.target;
        let layers = target.layers();
        let is_slot = |top_m: f64| (top_m + 2e-3).abs() < 1e-9;
        let slot = layers.iter().position(|one| is_slot(one.top_m));
        let slot = slot.expect("the layer between both floors");
        let left = |x: f64, y: f64| wall_left_m(target, slot, &mm(x, y, -4.0));
        let wall_m = left(30.0, 25.85).expect("a wall");
        assert!((wall_m - 0.1e-3).abs() < 1e-9, "{wall_m}");
        let cut_m = left(30.0, 26.05).expect("a wall");
        assert!((cut_m + 0.1e-3).abs() < 1e-9, "{cut_m}");
        assert_eq!(left(30.0, 33.0), None);
        assert!(left(0.0, 33.0).expect("a face").is_nan());
        // In full stock it is a wall that is far too wide, not a dent.
        assert!(left(30.0, 39.9).expect("a wall") < 0.0);
    }
}
