//! Rational B-spline patches with exact first and second derivatives (The NURBS Book, algorithms
//! A3.6 and A4.4).
//!
//! Evaluation keeps everything on the stack: a path asks for a point some hundred times while its
//! spacing is sought.

use nalgebra::{Vector3, Vector4};

use super::error::{SurfaceFault, place};
use super::knots::Knots;
use super::{Domain, Jet, Surface};

use crate::bounds::OutOfBounds;

/// A NURBS patch.
///
/// At a knot of multiplicity above degree − 2 second derivatives jump; those of the span that
/// begins there are given.
#[derive(Debug, Clone, PartialEq)]
pub struct NurbsPatch {
    u: Knots,
    v: Knots,
    degree: [usize; 2],
    /// Weighted control points (w x, w y, w z, w), row by row: all v of the first u, then the next.
    weighted: Vec<Vector4<f64>>,
    columns: usize,
}

impl NurbsPatch {
    /// A patch from degrees and knots of u and v, control points `[u][v]` (m) and weights of the
    /// same shape.
    ///
    /// # Errors
    /// If rows differ in length, knots do not fit, fall or stand more often than the degree allows,
    /// a control point is not finite, or a weight not above 0.
    pub fn new(
        degree: [usize; 2],
        knots: [Vec<f64>; 2],
        points_m: &[Vec<Vector3<f64>>],
        weights: &[Vec<f64>],
    ) -> Result<Self, SurfaceFault> {
        let columns = points_m.first().map_or(0, Vec::len);
        let lengths = |what, rows: Vec<usize>| match rows.iter().position(|n| *n != columns) {
            Some(row) => Err(SurfaceFault::Ragged {
                what,
                row: row + 1,
                found: rows[row],
                expected: columns,
            }),
            None => Ok(()),
        };
        lengths("control points", points_m.iter().map(Vec::len).collect())?;
        lengths("weights", weights.iter().map(Vec::len).collect())?;
        let (rows, rule) = (weights.len(), "that of the control points");
        let what = "the number of rows of weights";
        OutOfBounds::unless(rows == points_m.len(), what, rows, rule)?;
        let mut weighted = Vec::with_capacity(points_m.len() * columns);
        for (point, weight) in points_m.iter().flatten().zip(weights.iter().flatten()) {
            let index = weighted.len() + 1;
            if !point.iter().all(|x| x.is_finite()) {
                return Err(SurfaceFault::NotFinite {
                    what: "control point",
                    index,
                    value: place(point),
                });
            }
            let (weighs, what) = (
                weight.is_finite() && *weight > 0.0,
                format!("weight {index}"),
            );
            OutOfBounds::unless(weighs, what, weight, "finite and above 0")?;
            weighted.push(Vector4::new(point.x, point.y, point.z, 1.0) * *weight);
        }
        let [knots_u, knots_v] = knots;
        Ok(Self {
            u: Knots::new("u", degree[0], knots_u, points_m.len())?,
            v: Knots::new("v", degree[1], knots_v, columns)?,
            degree,
            weighted,
            columns,
        })
    }
}

impl Surface for NurbsPatch {
    fn domain(&self) -> Domain {
        Domain {
            u: self.u.range(),
            v: self.v.range(),
        }
    }

    fn jet(&self, u: f64, v: f64) -> Jet {
        let (along_u, along_v) = (self.u.basis(u), self.v.basis(v));
        // Homogeneous point and derivatives: 00, 10, 01, 20, 11, 02.
        let mut sums = [Vector4::zeros(); 6];
        for i in 0..=self.degree[0] {
            let row = (along_u.first + i) * self.columns + along_v.first;
            let mut inner = [Vector4::zeros(); 3];
            for (j, point) in self.weighted[row..=row + self.degree[1]].iter().enumerate() {
                for (sum, values) in inner.iter_mut().zip(&along_v.derivatives) {
                    *sum += point * values[j];
                }
            }
            let [n, n1, n2] = [0, 1, 2].map(|d| along_u.derivatives[d][i]);
            sums[0] += inner[0] * n;
            sums[1] += inner[0] * n1;
            sums[2] += inner[1] * n;
            sums[3] += inner[0] * n2;
            sums[4] += inner[1] * n1;
            sums[5] += inner[2] * n;
        }
        let w = sums.map(|s| s.w);
        let a = sums.map(|s| s.xyz());
        let point_m = a[0] / w[0];
        let du = (a[1] - point_m * w[1]) / w[0];
        let dv = (a[2] - point_m * w[2]) / w[0];
        Jet {
            point_m,
            first_m: [du, dv],
            second_m: [
                (a[3] - du * (2.0 * w[1]) - point_m * w[3]) / w[0],
                (a[4] - dv * w[1] - du * w[2] - point_m * w[4]) / w[0],
                (a[5] - dv * (2.0 * w[2]) - point_m * w[5]) / w[0],
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Forms;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_1_SQRT_2;

    fn quarter_arc() -> [(f64, f64, f64); 3] {
        [(1.0, 0.0, 1.0), (1.0, 1.0, FRAC_1_SQRT_2), (0.0, 1.0, 1.0)]
    }

    fn bezier_knots() -> Vec<f64> {
        vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
    }

    /// Between knots that are one there is no patch; at a parameter that is no number there is no
    /// point.
    #[test]
    fn where_there_is_no_place_there_is_no_point() {
        let rows: Vec<Vec<_>> = (0..3)
            .map(|i| {
                (0..2)
                    .map(|j| Vector3::new(f64::from(i), f64::from(j), 0.0))
                    .collect()
            })
            .collect();
        let weights = vec![vec![1.0; 2]; 3];
        let patch = |u: Vec<f64>| {
            let knots = [u, vec![0.0, 0.0, 1.0, 1.0]];
            NurbsPatch::new([2, 1], knots, &rows, &weights)
        };
        let told = patch(vec![0.0, 1.0, 2.0, 2.0, 3.0, 4.0]).map(|_| ());
        let told = told.expect_err("no extent").to_string();
        assert!(
            told.contains("u: the patch begins and ends at knot 2"),
            "{told}"
        );
        let known = patch(bezier_knots()).expect("a patch");
        assert!(known.jet(f64::NAN, 0.5).point_m.x.is_nan());
    }

    /// Quarter of a cylinder of radius R about y: exact in rational form, so all of its shape must
    /// be.
    #[test]
    fn verify_a_cylinder_is_exact() {
        let radius = 0.04;
        let rows: Vec<Vec<_>> = quarter_arc()
            .iter()
            .map(|(x, z, _)| {
                [0.0, 0.1]
                    .map(|y| Vector3::new(radius * z, y, radius * x))
                    .to_vec()
            })
            .collect();
        let weights: Vec<Vec<f64>> = quarter_arc().iter().map(|a| vec![a.2; 2]).collect();
        let knots = [bezier_knots(), vec![0.0, 0.0, 1.0, 1.0]];
        let patch = NurbsPatch::new([2, 1], knots, &rows, &weights).expect("a patch");
        for (u, v) in [(0.0, 0.0), (0.21, 0.6), (0.5, 0.5), (0.83, 0.1), (1.0, 1.0)] {
            let jet = patch.jet(u, v);
            assert!((jet.point_m.xz().norm() - radius).abs() < 1e-15);
            let forms = Forms::of(&jet).expect("regular");
            assert!((forms.normal.xz() - jet.point_m.xz() / radius).norm() < 1e-12);
            let k = forms.curvatures();
            assert!(
                (k.max_per_m * radius - 1.0).abs() < 1e-12,
                "{}",
                k.max_per_m
            );
            assert!(k.min_per_m.abs() < 1e-10);
        }
    }

    /// An octant of a sphere: both principal curvatures 1/R everywhere, an umbilic at every point.
    /// (At the pole the patch is degenerate and has no normal.)
    #[test]
    fn verify_a_sphere_is_exact_and_all_umbilic() {
        let radius = 0.03;
        let (mut rows, mut weights) = (Vec::new(), Vec::new());
        for (x, y, w) in quarter_arc() {
            let meridian = quarter_arc();
            rows.push(
                meridian
                    .map(|(s, z, _)| Vector3::new(x * s, y * s, z) * radius)
                    .to_vec(),
            );
            weights.push(meridian.map(|m| m.2 * w).to_vec());
        }
        let patch = NurbsPatch::new([2, 2], [bezier_knots(), bezier_knots()], &rows, &weights)
            .expect("a patch");
        for (u, v) in [(0.0, 0.0), (0.3, 0.4), (0.9, 0.7), (0.5, 0.95)] {
            let jet = patch.jet(u, v);
            assert!((jet.point_m.norm() - radius).abs() < 1e-15);
            let k = Forms::of(&jet).expect("regular").curvatures();
            assert!((k.min_per_m * radius - 1.0).abs() < 1e-8, "{}", k.min_per_m);
            assert!((k.max_per_m * radius - 1.0).abs() < 1e-8, "{}", k.max_per_m);
            assert_eq!(k.directions, None);
        }
        assert_eq!(Forms::of(&patch.jet(0.5, 1.0)), None, "the pole");
    }

    fn wavy(seed: &[f64]) -> NurbsPatch {
        let number = |i: usize, j: usize, k: usize| seed[(i * 7 + j * 3 + k) % seed.len()];
        let rows: Vec<Vec<_>> = (0..6)
            .map(|i| {
                let point = |j| {
                    let z = 0.3 * number(i, j, 0);
                    Vector3::new(i as f64, j as f64 + 0.2 * number(i, j, 1), z)
                };
                (0..5).map(point).collect()
            })
            .collect();
        let weight = |i, j| 1.0 + 0.5 * number(i, j, 2);
        let weights: Vec<Vec<_>> = (0..6)
            .map(|i| (0..5).map(|j| weight(i, j)).collect())
            .collect();
        let u = vec![0.0, 0.0, 0.0, 0.0, 0.3, 0.7, 1.0, 1.0, 1.0, 1.0];
        let v = vec![-1.0, -1.0, -1.0, 0.2, 0.5, 2.0, 2.0, 2.0];
        NurbsPatch::new([3, 2], [u, v], &rows, &weights).expect("a patch")
    }

    proptest! {
        /// Derivatives against central differences away from knots: what remains is rounding over
        /// the step, and the step squared.
        #[test]
        fn derivatives_are_those_of_the_point(
            seed in prop::collection::vec(-1.0_f64..1.0, 11),
            u in 0.31_f64..0.69,
            v in 0.51_f64..1.99,
        ) {
            let patch = wavy(&seed);
            let step = 1e-5;
            let jet = patch.jet(u, v);
            let [east, west] = [patch.jet(u + step, v), patch.jet(u - step, v)];
            let [north, south] = [patch.jet(u, v + step), patch.jet(u, v - step)];
            let slope = |a: Vector3<f64>, b: Vector3<f64>| (a - b) / (2.0 * step);
            let pairs = [
                (jet.first_m[0], slope(east.point_m, west.point_m)),
                (jet.first_m[1], slope(north.point_m, south.point_m)),
                (jet.second_m[0], slope(east.first_m[0], west.first_m[0])),
                (jet.second_m[1], slope(north.first_m[0], south.first_m[0])),
                (jet.second_m[1], slope(east.first_m[1], west.first_m[1])),
                (jet.second_m[2], slope(north.first_m[1], south.first_m[1])),
            ];
            for (exact, difference) in pairs {
                prop_assert!((exact - difference).norm() < 1e-6 * (1.0 + exact.norm()), "{exact} {difference}");
            }
        }
    }

    #[test]
    fn bad_patches_are_refused() {
        let points = |x: f64| vec![vec![Vector3::new(x, 0.0, 0.0); 2]; 2];
        let refuse = |degree, u: &[f64], points: &[Vec<Vector3<f64>>], weights: &[Vec<f64>]| {
            let knots = [u.to_vec(), vec![0.0, 0.0, 1.0, 1.0]];
            let refused = NurbsPatch::new([degree, 1], knots, points, weights);
            refused.expect_err("no patch").to_string()
        };
        let (good, ones) = ([0.0, 0.0, 1.0, 1.0], vec![vec![1.0; 2]; 2]);
        assert!(refuse(1, &good, &points(f64::NAN), &ones).contains("control point 1"));
        assert!(refuse(1, &[0.0, 0.0, 1.0, 0.5], &points(0.0), &ones).contains("must not fall"));
        assert!(refuse(1, &[0.0, 0.0, 0.0, 1.0], &points(0.0), &ones).contains("stands 3 times"));
        assert!(refuse(1, &[0.0, 1.0], &points(0.0), &ones).contains("have 4"));
        assert!(refuse(3, &good, &points(0.0), &ones).contains("needs 4"));
        assert!(refuse(26, &good, &points(0.0), &ones).contains("degree in u"));
        let weights = vec![vec![1.0, 1.0], vec![0.0, 1.0]];
        assert!(refuse(1, &good, &points(0.0), &weights).contains("weight 3 is 0"));
        let ragged = vec![vec![1.0, 1.0], vec![1.0]];
        assert!(refuse(1, &good, &points(0.0), &ragged).contains("row 2 of the weights"));
    }
}
