//! Stiffness ellipsoids and what different authors mean by "the stiffness in a plane".
//!
//! A tool point with compliance C (6×6) has the translational compliance C_tt if it may turn while
//! it is pushed, and K = C_tt⁻¹ is its translational stiffness. Taking (C⁻¹)_tt instead clamps the
//! rotation; it is stiffer in every direction and blind to the length of the tool. Everything here
//! takes a 3×3 stiffness and does not ask which of the two it is; a free tool feels the first.

use nalgebra::{Matrix2, Matrix3, SymmetricEigen, Vector3};

/// Principal stiffnesses of a tool point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffnessEllipsoid {
    /// Eigenvalues of K, rising, N/m: the semi-axes of the ellipsoid of forces that a unit
    /// displacement asks for.
    pub semi_axes_n_per_m: Vector3<f64>,
    /// Columns are the directions of the semi-axes in the axes of K, right-handed.
    pub directions: Matrix3<f64>,
}

impl StiffnessEllipsoid {
    /// Of a 3×3 stiffness, N/m; the symmetric part is taken.
    pub fn of(stiffness_n_per_m: &Matrix3<f64>) -> Self {
        let symmetric = (stiffness_n_per_m + stiffness_n_per_m.transpose()) * 0.5;
        let eigen = SymmetricEigen::new(symmetric);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let column = |i: usize| eigen.eigenvectors.column(order[i]).into_owned();
        let (first, second) = (column(0), column(1));
        Self {
            semi_axes_n_per_m: Vector3::from_fn(|i, _| eigen.eigenvalues[order[i]]),
            directions: Matrix3::from_columns(&[first, second, first.cross(&second)]),
        }
    }
}

/// What is meant by the stiffness in a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlanarDefinition {
    /// Motion across the plane is free: inverse of the 2×2 block of K⁻¹. With K⁻¹ = C_tt this is
    /// what a tool that is pushed within the plane feels: the **physical** one, for statics and for
    /// chatter.
    Free,
    /// Motion across the plane is held: the 2×2 block of K itself.
    Held,
    /// The section of the ellipsoid qᵀ K⁻² q = 1, whose semi-axes are the eigenvalues of K:
    /// 1/√eig[(K⁻²)₂ₓ₂]. It lies between the two above and belongs to neither load.
    EllipsoidSection,
    /// The section of qᵀ K⁻¹ q = 1, whose semi-axes are the *roots* of the eigenvalues:
    /// 1/√eig[(K⁻¹)₂ₓ₂], the square roots of the free stiffnesses. Not a stiffness; it makes a
    /// plane look rounder than it is.
    RootSection,
}

/// Extremes over the directions of a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarExtremes {
    /// N/m; (N/m)^½ for [`PlanarDefinition::RootSection`], and therefore without a unit in the
    /// name.
    pub min: f64,
    /// As `min`.
    pub max: f64,
    /// Angle of the stiffest direction from the plane's first axis towards its second, rad, in
    /// (−π/2, π/2].
    pub max_angle_rad: f64,
}

/// Extremes of stiffness in the plane of the first two columns of `outer_from_plane` (orthonormal,
/// in the axes of K). `None` if K is singular where the definition needs its inverse.
pub fn planar_extremes(
    stiffness_n_per_m: &Matrix3<f64>,
    outer_from_plane: &Matrix3<f64>,
    definition: PlanarDefinition,
) -> Option<PlanarExtremes> {
    let k = outer_from_plane.transpose() * stiffness_n_per_m * outer_from_plane;
    let block = |m: &Matrix3<f64>| m.fixed_view::<2, 2>(0, 0).into_owned();
    let (eigen, value): (_, fn(f64) -> f64) = match definition {
        PlanarDefinition::Held => (principal(&block(&k)), |x| x),
        PlanarDefinition::Free => (principal(&block(&k.try_inverse()?)), |x| 1.0 / x),
        PlanarDefinition::EllipsoidSection => {
            let c = k.try_inverse()?;
            (principal(&block(&(c * c))), |x| 1.0 / x.sqrt())
        }
        PlanarDefinition::RootSection => (principal(&block(&k.try_inverse()?)), |x| 1.0 / x.sqrt()),
    };
    let (a, b) = ((value(eigen.0), eigen.2), (value(eigen.1), across(eigen.2)));
    let (min, max) = if a.0 > b.0 { (b, a) } else { (a, b) };
    Some(PlanarExtremes {
        min: min.0,
        max: max.0,
        max_angle_rad: max.1,
    })
}

/// Larger and smaller eigenvalue of the symmetric part, and the angle of the larger one's
/// direction.
fn principal(m: &Matrix2<f64>) -> (f64, f64, f64) {
    let mean = 0.5 * (m.m11 + m.m22);
    let half = 0.5 * (m.m11 - m.m22);
    let shear = 0.5 * (m.m12 + m.m21);
    let radius = half.hypot(shear);
    (mean + radius, mean - radius, 0.5 * shear.atan2(half))
}

/// The direction at right angles, in (−π/2, π/2].
fn across(angle_rad: f64) -> f64 {
    use std::f64::consts::FRAC_PI_2;
    if angle_rad > 0.0 {
        angle_rad - FRAC_PI_2
    } else {
        angle_rad + FRAC_PI_2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Matrix3<f64> {
        Matrix3::new(1.0, 0.3, 0.5, 0.3, 1.6, 0.2, 0.5, 0.2, 2.5)
    }

    /// `docs/physics/arm.md`, Stiffness: four definitions, four answers.
    #[test]
    fn verify_four_definitions_of_planar_stiffness() {
        use PlanarDefinition::{EllipsoidSection, Free, Held, RootSection};
        for (definition, min, max, r) in [
            (Held, 0.876, 1.724, 0.492),
            (Free, 0.812, 1.672, 0.514),
            (EllipsoidSection, 0.802, 1.656, 0.516),
            (RootSection, 0.901, 1.293, 0.303),
        ] {
            let found = planar_extremes(&example(), &Matrix3::identity(), definition)
                .expect("regular stiffness");
            assert!((found.min - min).abs() < 6e-4, "{definition:?}: {found:?}");
            assert!((found.max - max).abs() < 6e-4, "{definition:?}: {found:?}");
            assert!(
                ((found.max - found.min) / found.max - r).abs() < 6e-4,
                "{definition:?}"
            );
        }
    }

    /// The free extremes are those of 1/(eᵀ K⁻¹ e) over directions e in the plane, wherever the
    /// plane lies.
    #[test]
    fn verify_free_stiffness_is_what_a_pushed_tool_feels() {
        let plane = nalgebra::Rotation3::from_euler_angles(0.4, -0.8, 1.3).into_inner();
        let found = planar_extremes(&example(), &plane, PlanarDefinition::Free).expect("regular");
        let compliance = example().try_inverse().expect("regular");
        let along = |angle: f64| {
            let e = plane.column(0) * angle.cos() + plane.column(1) * angle.sin();
            1.0 / e.dot(&(compliance * e))
        };
        let all: Vec<f64> = (0..36_000).map(|i| along(f64::from(i) * 1e-4)).collect();
        let (low, high) = all
            .iter()
            .fold((f64::MAX, 0.0_f64), |(l, h), x| (l.min(*x), h.max(*x)));
        assert!((found.min / low - 1.0).abs() < 1e-7 && (found.max / high - 1.0).abs() < 1e-7);
        assert!((along(found.max_angle_rad) / found.max - 1.0).abs() < 1e-12);
    }

    #[test]
    fn verify_ellipsoid_axes_are_eigenvectors() {
        let ellipsoid = StiffnessEllipsoid::of(&example());
        let rebuilt = ellipsoid.directions
            * Matrix3::from_diagonal(&ellipsoid.semi_axes_n_per_m)
            * ellipsoid.directions.transpose();
        assert!((rebuilt - example()).amax() < 1e-12);
        assert!((ellipsoid.directions.determinant() - 1.0).abs() < 1e-12);
        let axes = ellipsoid.semi_axes_n_per_m;
        assert!(axes.x < axes.y && axes.y < axes.z);
        assert!(
            (1.0 - ellipsoid.semi_axes_n_per_m.x / ellipsoid.semi_axes_n_per_m.z
                - (axes.z - axes.x) / axes.z)
                .abs()
                < 1e-12
        );
    }
}
