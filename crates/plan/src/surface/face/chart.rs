//! A face laid over the unit square: four lines around it in the plane across its mean normal, and
//! the surface between them that Coons blends (`coons1967`).

use nalgebra::{Matrix2, Unit, Vector2, Vector3};

use super::super::boundary::seen;
use super::outline::{Loop, kept};

/// A line turns by this at least where it has a corner, rad.
const CORNER_RAD: f64 = std::f64::consts::FRAC_PI_4;
/// Corners are those of the outline with what lies within this share of its size left out.
const CORNER_SHARE: f64 = 5e-3;
/// Steps of Newton's method; between straight sides one is enough.
const STEPS: usize = 60;
/// How exactly a place is found, share of the size.
const EXACT: f64 = 1e-10;
/// How far a place may lie beyond the square: the polylines of the sides have corners.
const BEYOND: f64 = 1e-3;

/// Four sides in a plane.
pub(super) struct Chart {
    origin_m: Vector3<f64>,
    axes: [Vector3<f64>; 2],
    /// v = 0 and v = 1 along u, u = 0 and u = 1 along v.
    sides: [Side; 4],
    size_m: f64,
    pub(super) has_four_sides: bool,
}

/// A polyline run through by its share of the length.
struct Side {
    points_m: Vec<Vector2<f64>>,
    shares: Vec<f64>,
}

impl Side {
    fn new(points_m: Vec<Vector2<f64>>) -> Self {
        let mut shares = vec![0.0];
        for pair in points_m.windows(2) {
            shares.push(shares[shares.len() - 1] + (pair[1] - pair[0]).norm());
        }
        let whole = shares[shares.len() - 1];
        shares.iter_mut().for_each(|share| *share /= whole);
        Self { points_m, shares }
    }

    /// Point and its derivative; beyond the ends straight on.
    fn at(&self, share: f64) -> [Vector2<f64>; 2] {
        let last = self.shares.len() - 1;
        let k = self.shares.partition_point(|s| *s <= share).clamp(1, last);
        let way = self.points_m[k] - self.points_m[k - 1];
        let slope = way / (self.shares[k] - self.shares[k - 1]);
        [
            self.points_m[k - 1] + slope * (share - self.shares[k - 1]),
            slope,
        ]
    }

    fn ends(&self) -> [Vector2<f64>; 2] {
        [self.points_m[0], self.points_m[self.points_m.len() - 1]]
    }
}

impl Chart {
    /// Lays a face out by its four sides, if it has as many and shall be, else in a rectangle.
    pub(super) fn of(
        outer: &Loop,
        normal: &Unit<Vector3<f64>>,
        u_along: Option<&Vector3<f64>>,
        by_sides: bool,
    ) -> Self {
        let origin_m = outer.points_m[0];
        let least = normal.iamin();
        let x = normal.cross(&Vector3::ith(least, 1.0)).normalize();
        let axes = [x, normal.cross(&x)];
        let line: Vec<Vector2<f64>> = (outer.points_m.iter())
            .map(|point_m| seen(point_m, &origin_m, &axes))
            .collect();
        let size_m = line.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let corners = corners(&line, CORNER_SHARE * size_m);
        let has_four_sides = by_sides && corners.len() == 4;
        // Once round counter-clockwise, from corner to corner.
        let around: Vec<Vec<Vector2<f64>>> = if has_four_sides {
            (0..4)
                .map(|k| between(&line, corners[k], corners[(k + 1) % 4]))
                .collect()
        } else {
            let box_m = rectangle(&line);
            (0..4).map(|k| vec![box_m[k], box_m[(k + 1) % 4]]).collect()
        };
        let lift = |v: Vector2<f64>| axes[0] * v.x + axes[1] * v.y;
        let first = first_side(&around, u_along, lift);
        let side = |k: usize| around[(first + k) % 4].clone();
        let back = |k: usize| side(k).into_iter().rev().collect();
        Self {
            origin_m,
            axes,
            sides: [side(0), back(2), back(3), side(1)].map(Side::new),
            size_m,
            has_four_sides,
        }
    }

    /// Mean lengths along u and v, m.
    pub(super) fn lengths_m(&self) -> [f64; 2] {
        let lengths = self.sides.each_ref().map(|side| {
            let pieces = side.points_m.windows(2).map(|w| (w[1] - w[0]).norm());
            pieces.sum::<f64>()
        });
        [0, 2].map(|k| 0.5 * (lengths[k] + lengths[k + 1]))
    }

    /// Place in the plane, and its derivatives by u and v.
    fn at(&self, u: f64, v: f64) -> [Vector2<f64>; 3] {
        let [[low, low_u], [high, high_u]] = [0, 1].map(|k| self.sides[k].at(u));
        let [[left, left_v], [right, right_v]] = [2, 3].map(|k| self.sides[k].at(v));
        let [p00, p10] = self.sides[0].ends();
        let [p01, p11] = self.sides[1].ends();
        let (s, t) = (1.0 - u, 1.0 - v);
        [
            low * t + high * v + left * s + right * u
                - (p00 * (s * t) + p10 * (u * t) + p01 * (s * v) + p11 * (u * v)),
            low_u * t + high_u * v - left + right - (p10 - p00) * t - (p11 - p01) * v,
            high - low + left_v * s + right_v * u - (p01 - p00) * s - (p11 - p10) * u,
        ]
    }

    /// Parameters of a point, seen along the mean normal; `None` if it has none, as where sides
    /// fold the square.
    pub(super) fn place(&self, point_m: &Vector3<f64>) -> Option<[f64; 2]> {
        let wanted = seen(point_m, &self.origin_m, &self.axes);
        let mut uv = Vector2::new(0.5, 0.5);
        for _ in 0..STEPS {
            let [at, along_u, along_v] = self.at(uv.x, uv.y);
            let left = wanted - at;
            if left.norm() <= EXACT * self.size_m {
                let is_within = uv.iter().all(|x| (-BEYOND..=1.0 + BEYOND).contains(x));
                let found = uv.map(|x| x.clamp(0.0, 1.0));
                return is_within.then(|| found.into());
            }
            let step = Matrix2::from_columns(&[along_u, along_v]);
            let step = step.try_inverse()? * left;
            // Far steps are shortened: the sides are straight on beyond their ends.
            uv += step * (0.5 / step.norm()).min(1.0);
        }
        None
    }

    /// Whether both points lie on one side of the square.
    pub(super) fn on_one_side(&self, a: &Vector3<f64>, b: &Vector3<f64>, within_m: f64) -> bool {
        let [a, b] = [a, b].map(|p| seen(p, &self.origin_m, &self.axes));
        self.sides.iter().any(|side| {
            let [from, to] = side.ends();
            let way = (to - from).normalize();
            [a, b]
                .iter()
                .all(|p| way.perp(&(p - from)).abs() <= within_m)
        })
    }
}

/// Corners of a closed line that runs counter-clockwise.
fn corners(line: &[Vector2<f64>], within_m: f64) -> Vec<usize> {
    let flat: Vec<Vector3<f64>> = line.iter().map(|p| p.push(0.0)).collect();
    let places = kept(&flat, within_m);
    let count = places.len();
    let turn = |k: usize| {
        let [before, here, after] = [k + count - 1, k, k + 1].map(|i| line[places[i % count]]);
        let (come, go) = (here - before, after - here);
        come.perp(&go).atan2(come.dot(&go))
    };
    let turned: Vec<f64> = (0..count).map(turn).collect();
    // A corner that turns back makes a face of another kind.
    if turned.iter().any(|turn| *turn <= -CORNER_RAD) {
        return Vec::new();
    }
    (0..count)
        .filter(|k| turned[*k] >= CORNER_RAD)
        .map(|k| places[k])
        .collect()
}

fn between(line: &[Vector2<f64>], from: usize, to: usize) -> Vec<Vector2<f64>> {
    let count = line.len();
    let steps = (to + count - from) % count;
    let mut points: Vec<Vector2<f64>> = (0..=steps).map(|k| line[(from + k) % count]).collect();
    points.dedup();
    points
}

/// Which of four sides is v = 0, so that u follows a direction as nearly as it can.
fn first_side(
    around: &[Vec<Vector2<f64>>],
    u_along: Option<&Vector3<f64>>,
    lift: impl Fn(Vector2<f64>) -> Vector3<f64>,
) -> usize {
    let way = |k: usize| {
        let side = &around[k % 4];
        side[side.len() - 1] - side[0]
    };
    let ways: Vec<Vector3<f64>> = (0..4).map(|k| lift(0.5 * (way(k) - way(k + 2)))).collect();
    let longer = if ways[0].norm() >= (1.0 - 1e-6) * ways[1].norm() {
        ways[0]
    } else {
        ways[1]
    };
    let sense = if longer[longer.iamax()] < 0.0 {
        -1.0
    } else {
        1.0
    };
    let wanted = u_along.copied().unwrap_or(longer * sense);
    let best = (0..4).max_by(|a, b| {
        let along = |k: &usize| ways[*k].normalize().dot(&wanted);
        along(a).total_cmp(&along(b))
    });
    best.unwrap_or(0)
}

/// The smallest rectangle about points: one of its sides lies along one of their hull's.
fn rectangle(points: &[Vector2<f64>]) -> [Vector2<f64>; 4] {
    let hull = hull(points);
    let mut best: Option<(f64, [Vector2<f64>; 4])> = None;
    for (a, b) in hull.iter().zip(hull.iter().cycle().skip(1)) {
        let Some(x) = (b - a).try_normalize(0.0) else {
            continue;
        };
        let y = Vector2::new(-x.y, x.x);
        let (mut low, mut high) = (
            Vector2::repeat(f64::INFINITY),
            Vector2::repeat(-f64::INFINITY),
        );
        for point in &hull {
            let at = Vector2::new(point.dot(&x), point.dot(&y));
            (low, high) = (low.inf(&at), high.sup(&at));
        }
        let area = (high - low).product();
        if best.is_none_or(|(least, _)| area < least) {
            let corner = |s: f64, t: f64| x * s + y * t;
            let corners = [
                corner(low.x, low.y),
                corner(high.x, low.y),
                corner(high.x, high.y),
                corner(low.x, high.y),
            ];
            best = Some((area, corners));
        }
    }
    best.map_or([Vector2::zeros(); 4], |(_, corners)| corners)
}

/// Convex hull, counter-clockwise (Andrew's monotone chain).
fn hull(points: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut hull: Vec<Vector2<f64>> = Vec::new();
    for _ in 0..2 {
        let base = hull.len();
        for point in &sorted {
            while hull.len() >= base + 2 {
                let [a, b] = [hull[hull.len() - 2], hull[hull.len() - 1]];
                if (b - a).perp(&(point - b)) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(*point);
        }
        // The last begins the way back.
        hull.pop();
        sorted.reverse();
    }
    hull
}
