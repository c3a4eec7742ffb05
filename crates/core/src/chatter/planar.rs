//! Mode coupling of two directions with equal mass: closed form of the undamped limit.

use nalgebra::Matrix2;

/// Undamped limit of a planar structure under an averaged process, m: the smallest a > 0 at which
/// the eigenvalues of K − a B coalesce (D = |s|), with B in N/m per m
/// ([`super::DirectionalMatrix::average_pa`], planar block). `None` if they never do.
pub fn coalescence_limit_m(
    stiffness_n_per_m: &Matrix2<f64>,
    process_pa: &Matrix2<f64>,
) -> Option<f64> {
    let (k, b) = (stiffness_n_per_m, process_pa);
    // D² - s² of K - aB is the quadratic c0 + c1 a + c2 a²: half difference squared + product of
    // the off-diagonals.
    let (dk, db) = (0.5 * (k.m11 - k.m22), 0.5 * (b.m11 - b.m22));
    let c0 = dk * dk + k.m12 * k.m21;
    let c1 = -2.0 * dk * db - k.m12 * b.m21 - k.m21 * b.m12;
    let c2 = db * db + b.m12 * b.m21;
    if c2 == 0.0 {
        return Some(-c0 / c1).filter(|a| a.is_finite() && *a > 0.0);
    }
    let discriminant = c1 * c1 - 4.0 * c0 * c2;
    if discriminant < 0.0 {
        return None;
    }
    let q = -0.5 * (c1 + c1.signum() * discriminant.sqrt());
    let roots = [q / c2, c0 / q];
    let positive = roots
        .into_iter()
        .filter(|a| a.is_finite() && *a > 1e-12 * (c0 / c2).abs().sqrt());
    positive.min_by(f64::total_cmp)
}

#[cfg(test)]
pub(crate) mod tests;
