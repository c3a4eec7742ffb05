//! A wheel brush's way along edges of a part, without teaching.
//!
//! At every place of an edge the brush's axis, the tool's y, lies along the edge, and its centre,
//! the tool's origin, stands off it by the radius less the indentation, midway between the two
//! faces or tilted about the edge. The tool's z points at the edge.
//!
//! An open edge is run over from end to end and the lead beyond both, the brush brought down and
//! lifted there. Along a closed edge it is brought down on the way, over the lead, and lifted over
//! the same stretch after one turn, so that the two indentations add up to the one of elsewhere.

use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, UnitVector3, Vector3};
use thiserror::Error;

use crate::cam::{Attitude, CamPath, CamPoint};
use crate::program::MOST_POINTS;
use crate::surface::EdgeChain;

/// The brush's centre is fed at this share of the feed along the edge at least: about a corner that
/// it turns around it would stand still.
const LEAST_FEED: f64 = 0.02;
/// Points that lie and look as a line between their neighbours has them there, to these, are left
/// out.
const STRAIGHT_M: f64 = 1e-9;
const STRAIGHT_RAD: f64 = 1e-7;
/// The sine between the way off the edge and where the tilt shall lead: below it there is no sense
/// of turning.
const LEAST_SENSE: f64 = 1e-3;

/// How a brush goes along edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeLaying {
    /// To the tips of the bristles.
    pub radius_m: f64,
    /// How far the unbent brush reaches beyond the edge.
    pub indentation_m: f64,
    /// How far it runs on beyond the ends of an open edge; along a closed one over what way it is
    /// brought down, and lifted.
    pub lead_m: f64,
    /// How far the brush is off the edge before and after.
    pub lift_m: f64,
    /// From midway between the faces about the edge.
    pub tilt: Option<Tilt>,
    /// Largest distance of points along the edge.
    pub step_m: f64,
    /// Along the edge, and straight down to it and off it: around a corner the brush's centre is
    /// slower or faster.
    pub feed_m_per_s: f64,
}

/// A turn of the brush's centre about the edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tilt {
    pub angle_rad: f64,
    /// The side to which it turns, in the part's frame.
    pub towards: UnitVector3<f64>,
}

/// Why no way is laid.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EdgePathError {
    #[error(
        "at ({}) mm the tilt has no side: it shall lead towards what lies along the edge, or midway between its faces, where the brush stands already",
        mm(at_m)
    )]
    NoSide { at_m: Vector3<f64> },
    #[error(
        "the closed edge is {length_mm:.3} mm long, but must be as long as the lead over which the brush is brought down, {lead_mm:.3} mm, at least"
    )]
    ShorterThanLead { length_mm: f64, lead_mm: f64 },
    #[error("{count:.0} points along the edge are too many; at most {MOST_POINTS} are planned")]
    TooMany { count: f64 },
}

fn mm(at_m: &Vector3<f64>) -> String {
    let at: Vec<String> = at_m.iter().map(|m| format!("{:.3}", m * 1e3)).collect();
    at.join(", ")
}

/// A place of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    point_m: Vector3<f64>,
    /// Along the edge, the way it is fed.
    along: Vector3<f64>,
    /// From the edge to the brush's centre, square to `along`.
    off: Vector3<f64>,
}

impl EdgeLaying {
    /// The way along edges, one after the other, in the part's frame. The line of each point is the
    /// number of its edge, from 1.
    ///
    /// # Errors
    /// With the index of the edge, why it cannot be brushed this way.
    pub fn path(&self, edges: &[EdgeChain]) -> Result<CamPath, (usize, EdgePathError)> {
        let mut path = CamPath::default();
        for (index, edge) in edges.iter().enumerate() {
            let laid = self.laid(edge, index + 1);
            path.points.extend(laid.map_err(|error| (index, error))?);
        }
        Ok(path)
    }

    fn laid(&self, edge: &EdgeChain, line: usize) -> Result<Vec<CamPoint>, EdgePathError> {
        let length_m = edge.length_m();
        let count = ((length_m + 2.0 * self.lead_m) / self.step_m).ceil();
        if count > MOST_POINTS as f64 {
            return Err(EdgePathError::TooMany { count });
        }
        let along = Along::of(edge, self.step_m);
        let lifted_m = self.indentation_m + self.lift_m;
        // Way along the edge and height over the full indentation, of the points in their order.
        let stops: Vec<[f64; 2]> = if edge.closed {
            if length_m < self.lead_m {
                return Err(EdgePathError::ShorterThanLead {
                    length_mm: length_m * 1e3,
                    lead_mm: self.lead_m * 1e3,
                });
            }
            // Where the brush comes down to the edge.
            let meets_m = self.lead_m * self.lift_m / lifted_m;
            let rises_m = length_m + meets_m;
            vec![
                [0.0, lifted_m],
                [self.lead_m, 0.0],
                [rises_m, 0.0],
                [rises_m + self.lead_m, lifted_m],
            ]
        } else {
            let beyond_m = length_m + self.lead_m;
            vec![
                [-self.lead_m, lifted_m],
                [-self.lead_m, 0.0],
                [beyond_m, 0.0],
                [beyond_m, lifted_m],
            ]
        };
        let mut points = Vec::new();
        for (leg, ends) in stops.windows(2).enumerate() {
            let [from, to] = [ends[0], ends[1]];
            let parts = ((to[0] - from[0]) / self.step_m - 1e-9).ceil().max(1.0) as usize;
            for k in usize::from(leg > 0)..=parts {
                let share = k as f64 / parts as f64;
                let [s_m, height_m] = [0, 1].map(|i| from[i] + (to[i] - from[i]) * share);
                points.push((self.placed(&along.at(s_m))?, [s_m, height_m]));
            }
        }
        let poses = points.iter().map(|(place, [_, height_m])| {
            let stands_off_m = self.radius_m - self.indentation_m + height_m;
            (place.point_m + place.off * stands_off_m, attitude(place))
        });
        let poses: Vec<(Vector3<f64>, UnitQuaternion<f64>)> = poses.collect();
        let last = poses.len() - 1;
        // An open edge is plunged to and left straight: the brush stops there.
        let plunges = |k: usize| !edge.closed && (k == 1 || k + 1 == last);
        let is_needed =
            |k: usize| k == 0 || k == last || plunges(k) || bends(&poses[k - 1..=k + 1]);
        let needed: Vec<usize> = (0..=last).filter(|k| is_needed(*k)).collect();
        let point = |(at, &k): (usize, &usize)| CamPoint {
            line,
            place_m: poses[k].0,
            attitude: Attitude::Whole(poses[k].1),
            feed_m_per_s: at.checked_sub(1).map(|before| {
                let from = needed[before];
                let centre_m = (poses[k].0 - poses[from].0).norm();
                let by_m = [0, 1].map(|i| (points[k].1[i] - points[from].1[i]).abs());
                self.feed_m_per_s * (centre_m / by_m[0].max(by_m[1])).max(LEAST_FEED)
            }),
            stops: k == 0 || k == last || plunges(k),
        };
        Ok(needed.iter().enumerate().map(point).collect())
    }

    /// A place with the brush tilted about the edge.
    fn placed(&self, place: &Place) -> Result<Place, EdgePathError> {
        let Some(tilt) = &self.tilt else {
            return Ok(*place);
        };
        let sense = place.along.dot(&place.off.cross(&tilt.towards));
        if sense.abs() < LEAST_SENSE {
            let at_m = place.point_m;
            return Err(EdgePathError::NoSide { at_m });
        }
        let about = UnitVector3::new_normalize(place.along * sense.signum());
        let turn = Rotation3::from_axis_angle(&about, tilt.angle_rad);
        Ok(Place {
            off: turn * place.off,
            ..*place
        })
    }
}

/// The tool's z points at the edge, its y lies along it.
fn attitude(place: &Place) -> UnitQuaternion<f64> {
    let z = -place.off;
    let x = place.along.cross(&z);
    let axes = Matrix3::from_columns(&[x, place.along, z]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
}

/// Whether the middle one of three poses is not where a line from the first to the third has it.
fn bends(poses: &[(Vector3<f64>, UnitQuaternion<f64>)]) -> bool {
    let [from, at, to] = [0, 1, 2].map(|k| Isometry3::from_parts(poses[k].0.into(), poses[k].1));
    let whole_m = (to.translation.vector - from.translation.vector).norm();
    let part_m = (at.translation.vector - from.translation.vector).norm();
    let share = if whole_m > 0.0 { part_m / whole_m } else { 0.5 };
    let led = (from.translation.vector).lerp(&to.translation.vector, share.min(1.0));
    let turned = from
        .rotation
        .try_slerp(&to.rotation, share.min(1.0), STRAIGHT_M);
    let off_rad = turned.map_or(f64::INFINITY, |turned| turned.angle_to(&at.rotation));
    (led - at.translation.vector).norm() > STRAIGHT_M || off_rad > STRAIGHT_RAD
}

/// An edge by the way along it. Directions are those of each straight piece, but next to a vertex,
/// as far as a step or half the piece, where they turn to what is between the two pieces there.
struct Along<'a> {
    edge: &'a EdgeChain,
    /// Way to each of its points.
    way_m: Vec<f64>,
    /// Directions along and off the edge, at each piece and at each point.
    of_piece: Vec<[Vector3<f64>; 2]>,
    at_point: Vec<[Vector3<f64>; 2]>,
    step_m: f64,
}

impl<'a> Along<'a> {
    fn of(edge: &'a EdgeChain, step_m: f64) -> Self {
        let mut way_m = vec![0.0];
        let mut of_piece = Vec::new();
        for (way, normals) in edge.pieces_m().zip(&edge.normals) {
            way_m.push(way_m[way_m.len() - 1] + way.norm());
            let off = normals[0].into_inner() + normals[1].into_inner();
            of_piece.push([way.normalize(), off.normalize()]);
        }
        let count = of_piece.len();
        let length_m = |piece: usize| (way_m[piece + 1] - way_m[piece]).min(2.0 * step_m);
        let between = |one: usize, two: usize| {
            // Each holds in the middle of its piece: linear between the two middles.
            let share = length_m(one) / (length_m(one) + length_m(two));
            [0, 1].map(|i| of_piece[one][i].lerp(&of_piece[two][i], share).normalize())
        };
        let at_point = (0..=count).map(|point| match (point, edge.closed) {
            (0, true) => between(count - 1, 0),
            (0, false) => of_piece[0],
            (point, true) if point == count => between(count - 1, 0),
            (point, false) if point == count => of_piece[count - 1],
            (point, _) => between(point - 1, point),
        });
        Self {
            edge,
            at_point: at_point.collect(),
            way_m,
            of_piece,
            step_m,
        }
    }

    /// The place at a way along the edge: straight on beyond the ends of an open one, around a
    /// closed one again.
    fn at(&self, s_m: f64) -> Place {
        let length_m = self.way_m[self.way_m.len() - 1];
        let s_m = match self.edge.closed {
            true => s_m.rem_euclid(length_m),
            false => s_m,
        };
        let last = self.of_piece.len() - 1;
        let piece = self.way_m.partition_point(|way_m| *way_m <= s_m);
        let piece = piece.saturating_sub(1).min(last);
        let on_piece_m = s_m - self.way_m[piece];
        let whole_m = self.way_m[piece + 1] - self.way_m[piece];
        let turns_m = (0.5 * whole_m).min(self.step_m);
        let near = |point: usize, away_m: f64| {
            let share = (away_m / turns_m).clamp(0.0, 1.0);
            [0, 1].map(|i| self.at_point[point][i].lerp(&self.of_piece[piece][i], share))
        };
        let [along, off] = match on_piece_m < 0.5 * whole_m {
            true => near(piece, on_piece_m),
            false => near(piece + 1, whole_m - on_piece_m),
        };
        let along = along.normalize();
        let [from, to] = [self.edge.points_m[piece], self.edge.points_m[piece + 1]];
        Place {
            point_m: from + (to - from) * (on_piece_m / whole_m),
            along,
            off: (off - along * off.dot(&along)).normalize(),
        }
    }
}

#[cfg(test)]
mod tests;
