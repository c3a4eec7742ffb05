//! Edges of a flat face: closed polylines with the material on their left.

use nalgebra::Vector2;
use thiserror::Error;

/// Why a polyline is no boundary of a face, or a wheel none that precesses. Points count from 1.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PrecessionError {
    #[error(
        "the boundary has {count} points; a closed one has four at least, the last of them the first again"
    )]
    FewPoints { count: usize },
    #[error("point {index} of the boundary is not finite")]
    NotFinite { index: usize },
    #[error(
        "the boundary is open: it ends {gap_mm:.4} mm from where it begins; the last point must be the first again"
    )]
    Open { gap_mm: f64 },
    #[error("points {index} and {} of the boundary are the same", index + 1)]
    Repeated { index: usize },
    #[error("the boundary crosses or touches itself: segments {first} and {second} meet")]
    SelfIntersecting { first: usize, second: usize },
    #[error(
        "the outer boundary runs clockwise, so that its outward normals point into the face; the face must lie on its left, outer boundaries run anticlockwise"
    )]
    Clockwise,
    #[error("{quantity} is {value}; it must be {rule}")]
    Wheel {
        quantity: &'static str,
        value: f64,
        rule: &'static str,
    },
    #[error(
        "no precession angle moves the wheel outward over all {edges} edges in its patch at ({x_mm:.3}, {y_mm:.3}) mm: {reason}"
    )]
    NoAngle {
        x_mm: f64,
        y_mm: f64,
        edges: usize,
        reason: String,
    },
}

/// One straight edge, the face on its left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    pub from_m: Vector2<f64>,
    pub to_m: Vector2<f64>,
}

/// The part of an edge that lies in a patch around a point of the face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chord {
    /// Place of the edge in the boundary, from 0.
    pub edge: usize,
    /// Distance of the point from the edge's line, positive inside, m.
    pub distance_m: f64,
    /// Outward normal of the edge.
    pub outward: Vector2<f64>,
    /// Ends of the chord along the direction in which the outward velocity grows with a positive
    /// spin (the outward normal turned by −90°), from the foot of the perpendicular, m.
    pub from_m: f64,
    pub to_m: f64,
    /// Half the chord of the edge's whole line, √(r² − δ²), m.
    pub half_m: f64,
}

impl Chord {
    /// Precession angle at which the wheel's centre velocity points straight outward over the edge,
    /// for a positive spin.
    pub fn outward_angle_rad(&self) -> f64 {
        (-self.outward.x).atan2(self.outward.y)
    }

    /// Length in the patch, m.
    pub fn length_m(&self) -> f64 {
        self.to_m - self.from_m
    }
}

/// Boundary of a flat face in its plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Boundary {
    edges: Vec<Edge>,
}

impl Boundary {
    /// The outer boundary through `points_m`, anticlockwise seen along −N, its last point the first
    /// again.
    ///
    /// # Errors
    /// If it is open, meets itself, runs clockwise, or has too few, repeated or non-finite points.
    pub fn new(points_m: &[Vector2<f64>]) -> Result<Self, PrecessionError> {
        let edges = closed_loop(points_m)?;
        if area_m2(&edges) < 0.0 {
            return Err(PrecessionError::Clockwise);
        }
        Ok(Self { edges })
    }

    /// A rectangle from the origin.
    ///
    /// # Errors
    /// If a length is not positive.
    pub fn rectangle(length_m: f64, width_m: f64) -> Result<Self, PrecessionError> {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];
        Self::new(&corners.map(|(x, y)| Vector2::new(x * length_m, y * width_m)))
    }

    /// All edges.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Edges that reach into the disc of `radius_m` around `point_m`.
    pub fn chords(
        &self,
        point_m: &Vector2<f64>,
        radius_m: f64,
    ) -> impl Iterator<Item = Chord> + '_ {
        let point = *point_m;
        let edges = self.edges.iter().enumerate();
        edges.filter_map(move |(index, edge)| chord(index, edge, &point, radius_m))
    }
}

fn chord(index: usize, edge: &Edge, point: &Vector2<f64>, radius_m: f64) -> Option<Chord> {
    let along = (edge.to_m - edge.from_m).normalize();
    let outward = Vector2::new(along.y, -along.x);
    let distance_m = (edge.from_m - point).dot(&outward);
    let square = radius_m * radius_m - distance_m * distance_m;
    if square <= 0.0 {
        return None;
    }
    let half_m = square.sqrt();
    let place = |end: &Vector2<f64>| -(end - point).dot(&along);
    let (from_m, to_m) = (
        place(&edge.to_m).max(-half_m),
        place(&edge.from_m).min(half_m),
    );
    (from_m < to_m).then_some(Chord {
        edge: index,
        distance_m,
        outward,
        from_m,
        to_m,
        half_m,
    })
}

fn closed_loop(points_m: &[Vector2<f64>]) -> Result<Vec<Edge>, PrecessionError> {
    let count = points_m.len();
    if let Some(k) = (points_m.iter()).position(|p| !p.iter().all(|c| c.is_finite())) {
        return Err(PrecessionError::NotFinite { index: k + 1 });
    }
    let (Some(first), Some(last)) = (points_m.first(), points_m.last()) else {
        return Err(PrecessionError::FewPoints { count });
    };
    if first != last {
        let gap_mm = (last - first).norm() * 1e3;
        return Err(PrecessionError::Open { gap_mm });
    }
    if count < 4 {
        return Err(PrecessionError::FewPoints { count });
    }
    if let Some(k) = points_m.windows(2).position(|pair| pair[0] == pair[1]) {
        return Err(PrecessionError::Repeated { index: k + 1 });
    }
    let edge = |pair: &[Vector2<f64>]| Edge {
        from_m: pair[0],
        to_m: pair[1],
    };
    let edges: Vec<Edge> = points_m.windows(2).map(edge).collect();
    for first in 0..edges.len() {
        for second in first + 1..edges.len() {
            let neighbours = second == first + 1 || (first == 0 && second == edges.len() - 1);
            let touch = if neighbours {
                folds_back(&edges[first], &edges[second])
            } else {
                meet(&edges[first], &edges[second])
            };
            if touch {
                return Err(PrecessionError::SelfIntersecting {
                    first: first + 1,
                    second: second + 1,
                });
            }
        }
    }
    Ok(edges)
}

fn cross(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Area on the left of a loop, negative if it runs clockwise, m².
fn area_m2(edges: &[Edge]) -> f64 {
    0.5 * edges.iter().map(|e| cross(&e.from_m, &e.to_m)).sum::<f64>()
}

/// Whether two edges that share an end lie on each other.
fn folds_back(a: &Edge, b: &Edge) -> bool {
    let (a, b) = (a.to_m - a.from_m, b.to_m - b.from_m);
    cross(&a, &b) == 0.0 && a.dot(&b) < 0.0
}

/// Whether two edges have a point in common.
fn meet(a: &Edge, b: &Edge) -> bool {
    let side = |e: &Edge, p: &Vector2<f64>| cross(&(e.to_m - e.from_m), &(p - e.from_m));
    let (a1, a2) = (side(a, &b.from_m), side(a, &b.to_m));
    let (b1, b2) = (side(b, &a.from_m), side(b, &a.to_m));
    let between = |e: &Edge, p: &Vector2<f64>| (p - e.from_m).dot(&(p - e.to_m)) <= 0.0;
    if a1 * a2 < 0.0 && b1 * b2 < 0.0 {
        return true;
    }
    (a1 == 0.0 && between(a, &b.from_m))
        || (a2 == 0.0 && between(a, &b.to_m))
        || (b1 == 0.0 && between(b, &a.from_m))
        || (b2 == 0.0 && between(b, &a.to_m))
}
