//! An edge of a body, picked by a point: pieces of sharp edges followed from one to the next.

use std::collections::{HashMap, VecDeque};

use nalgebra::{Unit, Vector3};
use thiserror::Error;

use super::error::place_mm;
use super::mesh::Mesh;
use super::mesh_edges::SharpEdge;

/// A point picks an edge that is as near, as a share of the diagonal of the box about the body: as
/// it picks a face.
const PICKED_SHARE: f64 = 1e-3;
/// A point that picks a closed edge so near to a vertex, as a share of the piece, begins it there.
const AT_VERTEX: f64 = 1e-6;
/// Angles are compared after they went through an arc cosine, rad.
const ROUNDING_RAD: f64 = 1e-9;

/// Why a point picks no edge.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EdgeFault {
    #[error(
        "no edge stands out by {crease_deg:.1} deg or more: the faces of this mesh turn less from one to the next, or into corners"
    )]
    None { crease_deg: f64 },
    #[error(
        "the point lies {away_mm:.4} mm off the nearest edge that stands out by {crease_deg:.1} deg or more, at {nearest} mm; it picks one up to {limit_mm:.4} mm off, a thousandth of the part's diagonal"
    )]
    OffTheEdge {
        away_mm: f64,
        crease_deg: f64,
        nearest: String,
        limit_mm: f64,
    },
}

/// An edge along which two faces of a body meet and stand out.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeChain {
    /// Once along it; of a closed edge the first point stands again at the end.
    pub points_m: Vec<Vector3<f64>>,
    /// Outward normals of the two faces, of each straight piece from one point to the next.
    pub normals: Vec<[Unit<Vector3<f64>>; 2]>,
    /// Whether it ends where it begins.
    pub closed: bool,
}

impl EdgeChain {
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.pieces_m().map(|way| way.norm()).sum()
    }

    /// The straight pieces, each from its begin to its end.
    pub fn pieces_m(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        self.points_m.windows(2).map(|pair| pair[1] - pair[0])
    }

    /// The same the other way round.
    #[must_use]
    pub fn reversed(mut self) -> Self {
        self.points_m.reverse();
        self.normals.reverse();
        self
    }

    /// Twice the area that a closed edge goes round, right-handed, weighed with the mean direction
    /// that its faces look to: above zero where it runs counter-clockwise seen from there.
    fn turns_about_its_faces(&self) -> f64 {
        let from = self.points_m[0];
        let area = |pair: &[Vector3<f64>]| (pair[0] - from).cross(&(pair[1] - from));
        let area_m2: Vector3<f64> = self.points_m.windows(2).map(area).sum();
        let outward = |(way, normals): (Vector3<f64>, &[Unit<Vector3<f64>>; 2])| {
            way.norm() * (normals[0].into_inner() + normals[1].into_inner())
        };
        let outward: Vector3<f64> = self.pieces_m().zip(&self.normals).map(outward).sum();
        area_m2.dot(&outward)
    }
}

/// Sharp edges of a mesh, and which of them meet at a vertex.
struct Net {
    edges: Vec<SharpEdge>,
    at: HashMap<[u64; 3], Vec<usize>>,
    crease_rad: f64,
}

/// Vertices of a mesh are each there once: their numbers tell them apart.
fn key(vertex: &Vector3<f64>) -> [u64; 3] {
    [vertex.x, vertex.y, vertex.z].map(|x| (x + 0.0).to_bits())
}

impl Net {
    /// The piece beyond the end of another, with its own end: none where more than two meet, or
    /// where the way turns by the crease angle.
    fn onwards(&self, piece: usize, end: &Vector3<f64>) -> Option<(usize, Vector3<f64>)> {
        let [one, two] = self.at[&key(end)][..] else {
            return None;
        };
        let next = if one == piece { two } else { one };
        let other_end = |piece: usize| {
            let [from, to] = self.edges[piece].ends_m;
            if from == *end { to } else { from }
        };
        let (came, goes) = (end - other_end(piece), other_end(next) - end);
        let straight_on = came.angle(&goes) < self.crease_rad - ROUNDING_RAD;
        (next != piece && straight_on).then(|| (next, other_end(next)))
    }

    /// All pieces that hang together with one, in their order, and whether they close.
    fn through(&self, piece: usize) -> EdgeChain {
        let [from, to] = self.edges[piece].ends_m;
        let mut points = VecDeque::from([from, to]);
        let mut pieces = VecDeque::from([piece]);
        let (mut at, mut end) = (piece, to);
        let mut closed = false;
        while let Some((next, ahead)) = self.onwards(at, &end) {
            if next == piece {
                closed = true;
                break;
            }
            pieces.push_back(next);
            points.push_back(ahead);
            (at, end) = (next, ahead);
        }
        let (mut at, mut end) = (piece, from);
        while let Some((next, ahead)) = self.onwards(at, &end).filter(|_| !closed) {
            pieces.push_front(next);
            points.push_front(ahead);
            (at, end) = (next, ahead);
        }
        EdgeChain {
            points_m: points.into(),
            normals: pieces.iter().map(|i| self.edges[*i].normals).collect(),
            closed,
        }
    }
}

impl Mesh {
    /// The edge at a point: pieces that stand out by the crease angle or more, from one to the next
    /// as far as no third meets them and the way turns by less than that angle. An open one begins
    /// at the end that is nearer to the point, a closed one at the point, and runs
    /// counter-clockwise seen from where its faces look to.
    ///
    /// # Errors
    /// If no such edge lies within a thousandth of the body's diagonal.
    pub fn edge_at(&self, point_m: &Vector3<f64>, crease_rad: f64) -> Result<EdgeChain, EdgeFault> {
        let least_rad = crease_rad - ROUNDING_RAD;
        let stands_out = |edge: &SharpEdge| std::f64::consts::PI - edge.wedge_rad() >= least_rad;
        let edges = self.sharp_edges().into_iter().filter(stands_out);
        let edges: Vec<SharpEdge> = edges.collect();
        let crease_deg = crease_rad.to_degrees();
        let away_m = |piece: &usize| edges[*piece].distance_m(point_m);
        let nearest = (0..edges.len()).min_by(|a, b| away_m(a).total_cmp(&away_m(b)));
        let Some(piece) = nearest else {
            return Err(EdgeFault::None { crease_deg });
        };
        let limit_m = PICKED_SHARE * self.diagonal_m();
        if away_m(&piece) > limit_m {
            return Err(EdgeFault::OffTheEdge {
                away_mm: away_m(&piece) * 1e3,
                crease_deg,
                nearest: place_mm(&edges[piece].nearest_m(point_m)),
                limit_mm: limit_m * 1e3,
            });
        }
        let mut at: HashMap<[u64; 3], Vec<usize>> = HashMap::new();
        for (index, edge) in edges.iter().enumerate() {
            let ends = edge.ends_m.iter();
            ends.for_each(|end| at.entry(key(end)).or_default().push(index));
        }
        let net = Net {
            edges,
            at,
            crease_rad,
        };
        let chain = net.through(piece);
        Ok(match chain.closed {
            true => begun_at(chain, point_m),
            false => begun_nearer(chain, point_m),
        })
    }

    /// Diagonal of the box about it, m.
    fn diagonal_m(&self) -> f64 {
        let extents = self.shape().bvh().root_aabb().extents();
        extents.length()
    }
}

/// An open edge from the end that is nearer to a point.
fn begun_nearer(chain: EdgeChain, point_m: &Vector3<f64>) -> EdgeChain {
    let away = |end: Option<&Vector3<f64>>| end.map_or(0.0, |end| (end - point_m).norm());
    match away(chain.points_m.last()) < away(chain.points_m.first()) {
        true => chain.reversed(),
        false => chain,
    }
}

/// A closed edge from its point that is nearest to another on.
fn begun_at(chain: EdgeChain, point_m: &Vector3<f64>) -> EdgeChain {
    let chain = match chain.turns_about_its_faces() < 0.0 {
        true => chain.reversed(),
        false => chain,
    };
    let piece = |at: usize| SharpEdge {
        ends_m: [chain.points_m[at], chain.points_m[at + 1]],
        normals: chain.normals[at],
    };
    let count = chain.normals.len();
    let away_m = |at: &usize| piece(*at).distance_m(point_m);
    let nearest = (0..count).min_by(|a, b| away_m(a).total_cmp(&away_m(b)));
    let at = nearest.unwrap_or_default();
    let share = piece(at).share_of(point_m);
    let around = |from: usize| (0..count).map(move |k| (from + k) % count);
    let begin_at = |from: usize| EdgeChain {
        points_m: (around(from).chain([from % count]))
            .map(|k| chain.points_m[k])
            .collect(),
        normals: around(from).map(|k| chain.normals[k]).collect(),
        closed: true,
    };
    if share <= AT_VERTEX {
        return begin_at(at);
    }
    let mut begun = begin_at(at + 1);
    if share < 1.0 - AT_VERTEX {
        // The piece that holds the point is the last one: it is parted there.
        let split = piece(at).nearest_m(point_m);
        begun.points_m.pop();
        begun.points_m.insert(0, split);
        begun.normals.insert(0, chain.normals[at]);
        begun.points_m.push(split);
    }
    begun
}
