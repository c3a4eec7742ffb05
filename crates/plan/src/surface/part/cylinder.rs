//! Cylinders through points.

use nalgebra::{Matrix3, SymmetricEigen, Unit, Vector3};

/// Normals at least this far from each other count as different ones.
const DIFFERENT_RAD: f64 = 1e-4;
/// The normals of a cylinder have no share along its axis, but for rounding.
const MOST_ALONG: f64 = 1e-3;

/// Normals of triangles, weighed by their areas.
#[derive(Debug, Default)]
pub(super) struct Samples {
    moments: Matrix3<f64>,
    weight: f64,
    /// A few that differ from each other.
    different: Vec<Vector3<f64>>,
}

impl Samples {
    pub(super) fn add(&mut self, normal: Vector3<f64>, area_m2: f64) {
        self.moments += normal * normal.transpose() * area_m2;
        self.weight += area_m2;
        let is_known = |known: &Vector3<f64>| (known - normal).norm() < DIFFERENT_RAD;
        if self.different.len() < 3
            && normal != Vector3::zeros()
            && !self.different.iter().any(is_known)
        {
            self.different.push(normal);
        }
    }

    /// The direction to which all normals are square; none with fewer than three of them, since a
    /// circle goes through any three lines.
    pub(super) fn axis(&self) -> Option<Vector3<f64>> {
        if self.different.len() < 3 || self.weight <= 0.0 {
            return None;
        }
        let eigen = SymmetricEigen::new(self.moments / self.weight);
        let least = eigen.eigenvalues.imin();
        let along = eigen.eigenvalues[least].max(0.0).sqrt();
        (along < MOST_ALONG).then(|| eigen.eigenvectors.column(least).into_owned())
    }
}

/// A cylinder, and how far the points lie off it at most.
#[derive(Debug)]
pub(super) struct Cylinder {
    pub(super) radius_m: f64,
    pub(super) axis: Vector3<f64>,
    pub(super) axis_at_m: Vector3<f64>,
    pub(super) deviation_m: f64,
}

/// The circle of least squares through the points seen along the axis: x² + y² = 2 a x + 2 b y + c
/// is linear in its centre (a, b) and c = r² − a² − b² (`kasa1976`).
pub(super) fn fit(
    points: &[Vector3<f64>],
    axis: &Unit<Vector3<f64>>,
    near: &Vector3<f64>,
) -> Option<Cylinder> {
    let across = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
    let other = axis.cross(&across);
    let flat = |p: &Vector3<f64>| [(p - near).dot(&across), (p - near).dot(&other)];
    let scale = points.iter().map(|p| (p - near).norm()).fold(0.0, f64::max);
    let (mut left, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for [x, y] in points.iter().map(flat) {
        let row = Vector3::new(2.0 * x, 2.0 * y, scale);
        left += row * row.transpose();
        right += row * (x * x + y * y);
    }
    let solved = left.cholesky()?.solve(&right);
    let [a, b] = [solved.x, solved.y];
    let square = solved.z * scale + a * a + b * b;
    let radius_m = (square > 0.0).then(|| square.sqrt())?;
    let off = |[x, y]: [f64; 2]| ((x - a).hypot(y - b) - radius_m).abs();
    // A nearly flat face lies on a vast cylinder, too.
    (radius_m < 1e3 * scale).then(|| Cylinder {
        radius_m,
        axis: axis.into_inner(),
        axis_at_m: near + across * a + other * b,
        deviation_m: points.iter().map(flat).map(off).fold(0.0, f64::max),
    })
}
