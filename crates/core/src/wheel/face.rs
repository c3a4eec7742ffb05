//! A plane face with its edges, as a wheel meets it: rows and edge pieces within a window about the
//! patch.

use nalgebra::{Isometry2, Point2, Vector2};
use thiserror::Error;

/// What is wrong with a face's boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum FaceError {
    #[error("loop {0} has fewer than three corners")]
    TooFewCorners(usize),
    #[error("loop {0} has a corner that is not finite")]
    NotFinite(usize),
    #[error("loop {0} encloses no area")]
    NoArea(usize),
}

/// A plane face bounded by closed polygons, convex or not; loops within loops are holes. Without
/// loops it has no edge.
///
/// Polygons may run either way round but must not cross themselves or each other, which is not
/// checked here.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Face {
    /// Sides with the face on their left.
    sides: Vec<[Point2<f64>; 2]>,
}

/// A straight piece of edge in the patch's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Side {
    pub from_m: Point2<f64>,
    pub to_m: Point2<f64>,
    /// Unit normal that points off the face.
    pub outward: Vector2<f64>,
}

impl Face {
    /// A face without edges.
    pub fn unbounded() -> Self {
        Self::default()
    }

    pub(super) fn is_unbounded(&self) -> bool {
        self.sides.is_empty()
    }

    /// A rectangle from the origin to `(length, width)`, m.
    pub fn rectangle(length_m: f64, width_m: f64) -> Result<Self, FaceError> {
        Self::new(&[vec![
            Point2::origin(),
            Point2::new(length_m, 0.0),
            Point2::new(length_m, width_m),
            Point2::new(0.0, width_m),
        ]])
    }

    /// A face from its boundary loops, m.
    pub fn new(loops: &[Vec<Point2<f64>>]) -> Result<Self, FaceError> {
        let mut sides = Vec::new();
        for (i, corners) in loops.iter().enumerate() {
            if corners.len() < 3 {
                return Err(FaceError::TooFewCorners(i));
            }
            if corners
                .iter()
                .flat_map(|p| p.iter())
                .any(|x| !x.is_finite())
            {
                return Err(FaceError::NotFinite(i));
            }
            let area = signed_area_m2(corners);
            let perimeter: f64 = pairs(corners).map(|[a, b]| (b - a).norm()).sum();
            if area.abs() <= 1e-12 * perimeter * perimeter {
                return Err(FaceError::NoArea(i));
            }
            let around = loops
                .iter()
                .enumerate()
                .filter(|(j, other)| *j != i && contains(other, &corners[0]))
                .count();
            let turned = (area < 0.0) != (around % 2 == 1);
            sides.extend(pairs(corners).map(|[a, b]| if turned { [b, a] } else { [a, b] }));
        }
        Ok(Self { sides })
    }

    /// Sides that a window `±half` about the patch's origin meets or that lie left of it, which
    /// rows must count.
    pub(super) fn within(
        &self,
        patch_from_face: &Isometry2<f64>,
        half_m: Vector2<f64>,
    ) -> Vec<Side> {
        self.sides
            .iter()
            .filter_map(|[a, b]| {
                let (from_m, to_m) = (patch_from_face * a, patch_from_face * b);
                let apart = from_m.y.max(to_m.y) < -half_m.y
                    || from_m.y.min(to_m.y) > half_m.y
                    || from_m.x.min(to_m.x) > half_m.x;
                let along = to_m - from_m;
                let length = along.norm();
                (!apart && length > 0.0).then(|| Side {
                    from_m,
                    to_m,
                    outward: Vector2::new(along.y, -along.x) / length,
                })
            })
            .collect()
    }

    /// Parts of the row at `y` between `±half` that lie on the face.
    pub(super) fn row(
        &self,
        sides: &[Side],
        y: f64,
        half_m: f64,
        crossings: &mut Vec<f64>,
        mut part: impl FnMut(f64, f64),
    ) {
        if self.sides.is_empty() {
            return part(-half_m, half_m);
        }
        crossings.clear();
        for side in sides {
            let (a, b) = (side.from_m, side.to_m);
            if (a.y <= y) != (b.y <= y) {
                crossings.push(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
            }
        }
        // sides beyond the window's right end are left out: the last part then runs to infinity
        if crossings.len() % 2 == 1 {
            crossings.push(f64::INFINITY);
        }
        crossings.sort_unstable_by(f64::total_cmp);
        for ends in crossings.chunks_exact(2) {
            let (from, to) = (ends[0].max(-half_m), ends[1].min(half_m));
            if from < to {
                part(from, to);
            }
        }
    }
}

fn pairs(corners: &[Point2<f64>]) -> impl Iterator<Item = [Point2<f64>; 2]> + '_ {
    (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]])
}

fn signed_area_m2(corners: &[Point2<f64>]) -> f64 {
    let origin = corners[0];
    pairs(corners)
        .map(|[a, b]| 0.5 * (a - origin).perp(&(b - origin)))
        .sum()
}

fn contains(corners: &[Point2<f64>], p: &Point2<f64>) -> bool {
    pairs(corners)
        .filter(|[a, b]| {
            (a.y <= p.y) != (b.y <= p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        })
        .count()
        % 2
        == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(face: &Face, y: f64, half: f64) -> Vec<(f64, f64)> {
        let sides = face.within(&Isometry2::identity(), Vector2::new(half, half));
        let mut found = Vec::new();
        face.row(&sides, y, half, &mut Vec::new(), |a, b| found.push((a, b)));
        found
    }

    #[test]
    fn verify_rows_of_a_notched_face_and_of_a_hole() {
        let p = Point2::new;
        // a U, and a square with a square hole that runs the same way round
        let u = [
            (-3., -1.),
            (3., -1.),
            (3., 3.),
            (1., 3.),
            (1., 1.),
            (-1., 1.),
            (-1., 3.),
            (-3., 3.),
        ];
        let u = Face::new(&[u.map(|(x, y)| p(x, y)).to_vec()]).unwrap();
        assert_eq!(parts(&u, 2.0, 5.0), [(-3.0, -1.0), (1.0, 3.0)]);
        assert_eq!(parts(&u, 2.0, 2.0), [(-2.0, -1.0), (1.0, 2.0)]);
        assert_eq!(parts(&u, 0.0, 2.0), [(-2.0, 2.0)]);
        assert_eq!(parts(&u, 4.0, 5.0), []);
        let square = |h: f64| vec![p(-h, -h), p(h, -h), p(h, h), p(-h, h)];
        let frame = Face::new(&[square(2.0), square(1.0)]).unwrap();
        assert_eq!(parts(&frame, 0.5, 3.0), [(-2.0, -1.0), (1.0, 2.0)]);
        let sides = frame.within(&Isometry2::identity(), Vector2::new(3.0, 3.0));
        for side in sides {
            let middle = 0.5 * (side.from_m.coords + side.to_m.coords);
            let off_centre = middle.dot(&side.outward);
            assert!(off_centre == 2.0 || off_centre == -1.0, "{side:?}");
        }
        assert_eq!(parts(&Face::unbounded(), 0.0, 1.0), [(-1.0, 1.0)]);
    }

    #[test]
    fn faults_of_a_boundary_are_named() {
        let p = Point2::new;
        let line = vec![p(0.0, 0.0), p(1.0, 1.0), p(2.0, 2.0)];
        assert_eq!(Face::new(&[line]), Err(FaceError::NoArea(0)));
        assert_eq!(
            Face::new(&[vec![p(0.0, 0.0)]]),
            Err(FaceError::TooFewCorners(0))
        );
        let nan = vec![p(0.0, 0.0), p(f64::NAN, 0.0), p(0.0, 1.0)];
        assert_eq!(Face::new(&[nan]), Err(FaceError::NotFinite(0)));
    }
}
