//! Fundamental forms and curvatures (do Carmo, Differential Geometry of Curves and Surfaces,
//! chapter 3).

use nalgebra::{Unit, Vector3};

use super::Jet;
use super::error::SurfaceFault;

/// Parameter lines closer to parallel than this (sine of their angle) give no normal.
const LEAST_SINE: f64 = 1e-9;

/// Principal curvatures that differ by less than this share of the larger one have no directions of
/// their own.
const UMBILIC_SHARE: f64 = 1e-6;

/// Nor have those that differ by less than this, 1/m: across a wheel 100 mm wide the surface
/// departs by 1 nm.
const UMBILIC_PER_M: f64 = 1e-6;

/// First and second fundamental form at a point, E, F, G and L, M, N, with the outward normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forms {
    /// E, F, G: r_u·r_u, r_u·r_v, r_v·r_v, m².
    pub first_m2: [f64; 3],
    /// L, M, N: r_uu·n, r_uv·n, r_vv·n, m. Negative where the surface is convex.
    pub second_m: [f64; 3],
    /// r_u × r_v, normalised.
    pub normal: Unit<Vector3<f64>>,
    /// Along r_u, and n × that: a square frame of the tangent plane.
    frame: [Vector3<f64>; 2],
    /// The shape operator in `frame`, convex positive, 1/m: entries 11, 12 and 22.
    shape_per_m: [f64; 3],
}

/// Curvatures at a point, 1/m, positive where the surface is convex seen from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvatures {
    /// Least principal curvature, by algebraic value.
    pub min_per_m: f64,
    pub max_per_m: f64,
    /// Directions of least and greatest curvature, of length 1, at right angles. They are lines,
    /// not arrows: the sign is arbitrary ([`continue_line`]). `None` at umbilics, where every
    /// direction is one.
    pub directions: Option<[Unit<Vector3<f64>>; 2]>,
}

impl Curvatures {
    /// The principal direction whose curvature is least in magnitude: along it a cylindrical wheel
    /// lies best, on concave surfaces as on convex ones. `None` at umbilics.
    #[must_use]
    pub fn flattest(&self) -> Option<Unit<Vector3<f64>>> {
        let [least, greatest] = self.directions?;
        Some(if self.min_per_m.abs() <= self.max_per_m.abs() {
            least
        } else {
            greatest
        })
    }
}

impl Forms {
    /// The forms from point and derivatives; `None` if the parameter lines do not span a plane.
    #[must_use]
    pub fn of(jet: &Jet) -> Option<Self> {
        let [ru, rv] = jet.first_m;
        let across = ru.cross(&rv);
        let area = across.norm();
        let sides = ru.norm() * rv.norm();
        if area.is_nan() || area <= LEAST_SINE * sides || sides == 0.0 {
            return None;
        }
        let normal = Unit::new_unchecked(across / area);
        let along = ru / ru.norm();
        let square = normal.cross(&along);
        let second_m = jet.second_m.map(|r| r.dot(&normal));
        // r_u = a e1, r_v = b e1 + c e2; the shape operator is J^-T II J^-1 with J = [a b; 0 c],
        // its sign turned.
        let (a, b, c) = (ru.norm(), rv.dot(&along), rv.dot(&square));
        let [l, m, n] = second_m;
        let s11 = l / (a * a);
        let s12 = (m - b / a * l) / (a * c);
        let s22 = (n - 2.0 * b / a * m + b * b / (a * a) * l) / (c * c);
        Some(Self {
            first_m2: [ru.dot(&ru), ru.dot(&rv), rv.dot(&rv)],
            second_m,
            normal,
            frame: [along, square],
            shape_per_m: [-s11, -s12, -s22],
        })
    }

    /// The forms at a pair of parameters, which an error names.
    pub(crate) fn at(jet: &Jet, u: f64, v: f64) -> Result<Self, SurfaceFault> {
        Self::of(jet).ok_or(SurfaceFault::NoNormal { u, v })
    }

    /// Normal curvature in a tangent direction of any length, 1/m, convex positive.
    #[must_use]
    pub fn curvature_along_per_m(&self, direction: &Vector3<f64>) -> f64 {
        let [x, y] = self.frame.map(|axis| axis.dot(direction));
        let [s11, s12, s22] = self.shape_per_m;
        (s11 * x * x + 2.0 * s12 * x * y + s22 * y * y) / (x * x + y * y)
    }

    /// Principal curvatures and their directions.
    #[must_use]
    pub fn curvatures(&self) -> Curvatures {
        let [s11, s12, s22] = self.shape_per_m;
        let mean = 0.5 * (s11 + s22);
        let half_difference = (0.5 * (s11 - s22)).hypot(s12);
        let (min_per_m, max_per_m) = (mean - half_difference, mean + half_difference);
        let largest = min_per_m.abs().max(max_per_m.abs());
        let umbilic = 2.0 * half_difference <= UMBILIC_PER_M.max(UMBILIC_SHARE * largest);
        let directions = (!umbilic).then(|| {
            let angle = 0.5 * (2.0 * s12).atan2(s11 - s22);
            let greatest = self.frame[0] * angle.cos() + self.frame[1] * angle.sin();
            let greatest = Unit::new_normalize(greatest);
            [Unit::new_normalize(greatest.cross(&self.normal)), greatest]
        });
        Curvatures {
            min_per_m,
            max_per_m,
            directions,
        }
    }

    /// The tangent direction nearest to a vector; `None` if that is normal to the surface.
    #[must_use]
    pub fn tangent(&self, vector: &Vector3<f64>) -> Option<Unit<Vector3<f64>>> {
        let flat = vector - self.normal.into_inner() * self.normal.dot(vector);
        Unit::try_new(flat, 1e-9 * vector.norm())
    }
}

/// The sign of a line direction that turns it least from the one before.
#[must_use]
pub fn continue_line(before: &Unit<Vector3<f64>>, line: Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    if before.dot(&line) < 0.0 { -line } else { line }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::cylinder::CylinderPatch;
    use crate::surface::spoke::Spoke;
    use crate::surface::{PlanePatch, Surface};

    /// One row of the table in `docs/physics/surfaces.md`: parameters, point and normal, principal
    /// curvatures, axis.
    struct FormsRow {
        uv: [f64; 2],
        point_mm: [f64; 3],
        normal: [f64; 3],
        curvature_per_mm: [f64; 2],
        axis: [f64; 3],
    }

    const TABLE: [FormsRow; 3] = [
        FormsRow {
            uv: [0.25, 0.25],
            point_mm: [50.0, -20.0, 15.5777],
            normal: [-0.26751, -0.19803, 0.94299],
            curvature_per_mm: [0.003_788_8, 0.009_483_2],
            axis: [-0.96356, 0.05512, -0.26177],
        },
        FormsRow {
            uv: [0.5, 0.5],
            point_mm: [100.0, 0.0, 25.0],
            normal: [0.0, 0.0, 1.0],
            curvature_per_mm: [0.006_168_5, 0.009_000_0],
            axis: [1.0, 0.0, 0.0],
        },
        FormsRow {
            uv: [0.75, 0.8],
            point_mm: [150.0, 24.0, 15.5177],
            normal: [0.25596, 0.17125, 0.95140],
            curvature_per_mm: [0.003_662_9, 0.007_201_3],
            axis: [0.92627, 0.23817, -0.29207],
        },
    ];

    /// Points to 1e-3 mm, directions to 1e-5, curvatures to 1e-6 per mm: what the table's digits
    /// allow.
    #[test]
    fn verify_table_of_the_bumpy_spoke() {
        for row in &TABLE {
            let [u, v] = row.uv;
            let jet = Spoke.jet(u, v);
            let forms = Forms::of(&jet).expect("regular");
            let k = forms.curvatures();
            let off_mm = (jet.point_m * 1e3 - Vector3::from(row.point_mm)).norm();
            assert!(off_mm < 1e-3, "P at {u}, {v}: {off_mm} mm");
            let normal = (forms.normal.into_inner() - Vector3::from(row.normal)).amax();
            assert!(normal < 1e-5, "n at {u}, {v}: {normal}");
            let found = [k.min_per_m, k.max_per_m].map(|k| k * 1e-3);
            for (found, told) in found.iter().zip(row.curvature_per_mm) {
                assert!(
                    (found - told).abs() < 1e-6,
                    "curvature at {u}, {v}: {found}"
                );
            }
            let axis = k.flattest().expect("no umbilic");
            let told = Vector3::from(row.axis);
            let off = (axis.into_inner() * axis.dot(&told).signum() - told).amax();
            assert!(off < 1e-5, "axis at {u}, {v}: {off}");
        }
    }

    #[test]
    fn verify_fundamental_forms_of_the_bumpy_spoke() {
        let forms = Forms::of(&Spoke.jet(0.25, 0.25)).expect("regular");
        let first = [43218.98, 953.165, 6682.24];
        let second = [-164.525, -9.0527, -63.3688];
        for (found, told) in forms.first_m2.iter().zip(first) {
            assert!((found * 1e6 / told - 1.0).abs() < 2e-6, "{found} {told}");
        }
        for (found, told) in forms.second_m.iter().zip(second) {
            assert!((found * 1e3 / told - 1.0).abs() < 1e-5, "{found} {told}");
        }
    }

    /// The determinant form of the principal directions, (EM−FL) du² + (EN−GL) du dv + (FN−GM) dv²
    /// = 0, holds for both, and their curvatures agree with Gauss's and the mean one from the
    /// forms.
    #[test]
    fn verify_directions_solve_the_quadratic_form() {
        for (u, v) in [(0.1, 0.9), (0.25, 0.25), (0.6, 0.3), (0.93, 0.55)] {
            let jet = Spoke.jet(u, v);
            let forms = Forms::of(&jet).expect("regular");
            let ([e, f, g], [l, m, n]) = (forms.first_m2, forms.second_m);
            let k = forms.curvatures();
            let gauss = (l * n - m * m) / (e * g - f * f);
            let mean = -(e * n - 2.0 * f * m + g * l) / (2.0 * (e * g - f * f));
            assert!((k.min_per_m * k.max_per_m / gauss - 1.0).abs() < 1e-12);
            assert!((0.5 * (k.min_per_m + k.max_per_m) / mean - 1.0).abs() < 1e-12);
            for (direction, curvature) in k
                .directions
                .expect("no umbilic")
                .iter()
                .zip([k.min_per_m, k.max_per_m])
            {
                assert!((forms.curvature_along_per_m(direction) / curvature - 1.0).abs() < 1e-12);
                let [a, b] = [jet.first_m[0].dot(direction), jet.first_m[1].dot(direction)];
                let det = e * g - f * f;
                let (du, dv) = ((g * a - f * b) / det, (e * b - f * a) / det);
                let terms = [
                    (e * m - f * l) * du * du,
                    (e * n - g * l) * du * dv,
                    (f * n - g * m) * dv * dv,
                ];
                let size: f64 = terms.iter().map(|t| t.abs()).sum();
                assert!(terms.iter().sum::<f64>().abs() < 1e-9 * size.max(1e-12));
            }
        }
    }

    #[test]
    fn verify_cylinder_and_plane() {
        let cylinder = CylinderPatch::new(
            Vector3::zeros(),
            Unit::new_normalize(Vector3::y()),
            Unit::new_normalize(Vector3::z()),
            0.05,
            [-1.0, 1.0],
            0.2,
        );
        let k = Forms::of(&cylinder.jet(0.3, 0.7))
            .expect("regular")
            .curvatures();
        assert!((k.max_per_m - 20.0).abs() < 1e-12 && k.min_per_m.abs() < 1e-12);
        let axis = k.flattest().expect("no umbilic");
        assert!((axis.dot(&Vector3::y()).abs() - 1.0).abs() < 1e-12);

        let plane = PlanePatch::new(Vector3::zeros(), Vector3::x() * 0.1, Vector3::y() * 0.06)
            .expect("a plane");
        let flat = Forms::of(&plane.jet(0.2, 0.9))
            .expect("regular")
            .curvatures();
        assert_eq!((flat.min_per_m, flat.max_per_m), (0.0, 0.0));
        assert_eq!(
            flat.directions, None,
            "every direction of a plane is principal"
        );
        assert_eq!(flat.flattest(), None);
    }

    #[test]
    fn a_surface_without_a_normal_says_so() {
        let jet = Jet {
            point_m: Vector3::zeros(),
            first_m: [Vector3::x(), Vector3::x() * 2.0],
            second_m: [Vector3::zeros(); 3],
        };
        assert_eq!(Forms::of(&jet), None);
    }
}
