//! Closed boundaries of a face, as polylines.

use nalgebra::{Unit, Vector2, Vector3};

use super::error::{SurfaceFault, place};

/// First and last point of a closed boundary are the same to this, m.
const CLOSED_M: f64 = 1e-6;
/// Segments are parallel that make an angle whose sine is as small.
const PARALLEL: f64 = 1e-10;

/// A closed polyline around a face, and others around its holes.
#[derive(Debug, Clone, PartialEq)]
pub struct Boundary {
    /// Corners, the first not repeated at the end.
    corners_m: Vec<Vector3<f64>>,
    /// Sides, each from its corner to the next, that follow the border of the patch, where it is
    /// the border that bounds a contact. Short of the end: none.
    on_border: Vec<bool>,
    holes_m: Vec<Vec<Vector3<f64>>>,
}

impl Boundary {
    /// A boundary from points of which the last repeats the first.
    ///
    /// # Errors
    /// If a point is not finite, the line is open, has less than three corners, or crosses itself
    /// (seen along its mean normal).
    pub fn new(points_m: &[Vector3<f64>]) -> Result<Self, SurfaceFault> {
        if let Some(index) = points_m
            .iter()
            .position(|p| !p.iter().all(|x| x.is_finite()))
        {
            return Err(SurfaceFault::NotFinite {
                what: "boundary point",
                index: index + 1,
                value: place(&points_m[index]),
            });
        }
        let (Some(first), Some(last)) = (points_m.first(), points_m.last()) else {
            return Err(SurfaceFault::FewCorners { count: 0 });
        };
        let gap_m = (last - first).norm();
        if gap_m > CLOSED_M {
            return Err(SurfaceFault::OpenBoundary {
                gap_m,
                limit_m: CLOSED_M,
            });
        }
        let corners_m = points_m[..points_m.len() - 1].to_vec();
        if corners_m.len() < 3 {
            return Err(SurfaceFault::FewCorners {
                count: corners_m.len(),
            });
        }
        let boundary = Self {
            corners_m,
            on_border: Vec::new(),
            holes_m: Vec::new(),
        };
        boundary.check_simple()?;
        Ok(boundary)
    }

    /// Adds the line around a hole, of which the last point repeats the first.
    ///
    /// # Errors
    /// As [`Boundary::new`].
    pub(crate) fn add_hole(&mut self, points_m: &[Vector3<f64>]) -> Result<(), SurfaceFault> {
        self.holes_m.push(Self::new(points_m)?.corners_m);
        Ok(())
    }

    /// Says which sides, given by their ends, follow the border of the patch: contacts keep clear
    /// of that by its own rule, along the face, and must not be cut by a boundary in the same place
    /// that is seen along the normal.
    pub(super) fn follows_border(
        &mut self,
        follows: impl Fn(&Vector3<f64>, &Vector3<f64>) -> bool,
    ) {
        let next = self.corners_m.iter().cycle().skip(1);
        self.on_border = (self.corners_m.iter().zip(next))
            .map(|(a, b)| follows(a, b))
            .collect();
    }

    /// Corners of the lines around holes.
    #[must_use]
    pub fn holes_m(&self) -> &[Vec<Vector3<f64>>] {
        &self.holes_m
    }

    /// The corners, the first not repeated.
    #[must_use]
    pub fn corners_m(&self) -> &[Vector3<f64>] {
        &self.corners_m
    }

    /// Whether a rectangle of a tangent plane lies within, boundary and rectangle seen along the
    /// plane's normal: half-lengths along two square directions of length 1 from a centre.
    #[must_use]
    pub fn holds_rectangle(
        &self,
        centre_m: &Vector3<f64>,
        axes: [Vector3<f64>; 2],
        half_m: [f64; 2],
    ) -> bool {
        let mut crossings = 0;
        let lines = std::iter::once(&self.corners_m).chain(&self.holes_m);
        for (line, corners_m) in lines.enumerate() {
            let corners: Vec<_> = (corners_m.iter())
                .map(|corner_m| seen(corner_m, centre_m, &axes))
                .collect();
            for (side, (a, b)) in sides(&corners).enumerate() {
                let crosses =
                    (a.y > 0.0) != (b.y > 0.0) && a.x - a.y * (b.x - a.x) / (b.y - a.y) > 0.0;
                crossings += usize::from(crosses);
                let is_free = line == 0 && self.on_border.get(side).is_some_and(|free| *free);
                if !is_free && reaches(&a, &b, half_m) {
                    return false;
                }
            }
        }
        crossings % 2 == 1
    }

    /// Newell's normal: the sum of cross products around the line, which does not depend on where
    /// it starts.
    fn normal(&self) -> Option<Unit<Vector3<f64>>> {
        let origin = self.corners_m[0];
        let around = self.corners_m.windows(2);
        let sum = around.fold(Vector3::zeros(), |sum, w| {
            sum + (w[0] - origin).cross(&(w[1] - origin))
        });
        Unit::try_new(sum, 0.0)
    }

    fn check_simple(&self) -> Result<(), SurfaceFault> {
        let count = self.corners_m.len();
        // A line without area (a figure of eight that cancels) is seen along any direction across
        // its longest extent.
        let normal = self.normal().unwrap_or_else(Vector3::z_axis);
        let x = if normal.x.abs() < 0.9 {
            Vector3::x()
        } else {
            Vector3::y()
        };
        let x = (x - normal.into_inner() * normal.dot(&x)).normalize();
        let axes = [x, normal.cross(&x)];
        let corners: Vec<_> = (self.corners_m.iter())
            .map(|corner_m| seen(corner_m, &self.corners_m[0], &axes))
            .collect();
        let sides: Vec<_> = sides(&corners).collect();
        for first in 0..count {
            for second in first + 1..count {
                let neighbours = second == first + 1 || (first == 0 && second == count - 1);
                if neighbours {
                    continue;
                }
                if let Some(share) = crossing(sides[first], sides[second]) {
                    let (a, b) = (self.corners_m[first], self.corners_m[(first + 1) % count]);
                    return Err(SurfaceFault::SelfIntersecting {
                        first: first + 1,
                        second: second + 1,
                        at: place(&(a + (b - a) * share)),
                    });
                }
            }
        }
        Ok(())
    }
}

/// A point in the plane of two square directions of length 1.
pub(super) fn seen(
    point_m: &Vector3<f64>,
    centre_m: &Vector3<f64>,
    axes: &[Vector3<f64>; 2],
) -> Vector2<f64> {
    let from = point_m - centre_m;
    Vector2::new(from.dot(&axes[0]), from.dot(&axes[1]))
}

fn sides(corners: &[Vector2<f64>]) -> impl Iterator<Item = (Vector2<f64>, Vector2<f64>)> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| (*a, *b))
}

/// Whether a segment has a point inside a rectangle about the origin (Liang and Barsky's clipping).
fn reaches(a: &Vector2<f64>, b: &Vector2<f64>, half: [f64; 2]) -> bool {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (start, step) = (a[axis], b[axis] - a[axis]);
        if step == 0.0 {
            if start.abs() >= half[axis] {
                return false;
            }
            continue;
        }
        let [t, s] = [-half[axis], half[axis]].map(|side| (side - start) / step);
        enter = enter.max(t.min(s));
        leave = leave.min(t.max(s));
    }
    enter < leave
}

/// Where on the first of two segments they meet, as a share of it.
fn crossing(
    (a, b): (Vector2<f64>, Vector2<f64>),
    (c, d): (Vector2<f64>, Vector2<f64>),
) -> Option<f64> {
    let (first, second, between) = (b - a, d - c, c - a);
    let turn = first.perp(&second);
    // Pieces of one straight side run along each other to rounding, wherever the face stands.
    if turn.abs() <= PARALLEL * first.norm() * second.norm() {
        return None;
    }
    let [on_first, on_second] = [between.perp(&second) / turn, between.perp(&first) / turn];
    let inside = |t: f64| (0.0..=1.0).contains(&t);
    (inside(on_first) && inside(on_second)).then_some(on_first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[[f64; 2]]) -> Vec<Vector3<f64>> {
        points
            .iter()
            .map(|p| Vector3::new(p[0], p[1], 0.02))
            .collect()
    }

    #[test]
    fn verify_a_rectangle_within_or_without() {
        let corners = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.06], [0.0, 0.06], [0.0, 0.0]];
        let boundary = Boundary::new(&line(&corners)).expect("closed");
        let axes = [Vector3::x(), Vector3::y()];
        let holds = |x, y, half| boundary.holds_rectangle(&Vector3::new(x, y, 0.02), axes, half);
        assert!(holds(0.05, 0.03, [0.049, 0.029]));
        assert!(!holds(0.05, 0.03, [0.051, 0.029]));
        assert!(holds(0.012, 0.03, [0.0119, 0.01]));
        assert!(!holds(0.012, 0.03, [0.0121, 0.01]));
        assert!(!holds(0.2, 0.03, [0.01, 0.01]));
        // Turned by 45 degrees, the corner of a square reaches √2 further.
        let slanted =
            [Vector3::new(1.0, 1.0, 0.0), Vector3::new(-1.0, 1.0, 0.0)].map(|v| v.normalize());
        let centre = Vector3::new(0.05, 0.03, 0.0);
        assert!(boundary.holds_rectangle(&centre, slanted, [0.0212; 2]));
        assert!(!boundary.holds_rectangle(&centre, slanted, [0.0213; 2]));
    }

    #[test]
    fn boundaries_that_are_none_are_refused() {
        let refuse = |points: &[[f64; 2]]| {
            let refused = Boundary::new(&line(points));
            refused.expect_err("no boundary").to_string()
        };
        assert!(refuse(&[]).contains("0 corners"));
        assert!(refuse(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]).contains("is open"));
        assert!(refuse(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]).contains("2 corners"));
        let eight = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
        let told = refuse(&eight);
        assert!(
            told.contains("sides 1 and 3") && told.contains("(0.500000, 0.500000"),
            "{told}"
        );
        assert!(refuse(&[[0.0, 0.0], [f64::NAN, 1.0], [0.0, 0.0]]).contains("boundary point 2"));
    }
}
