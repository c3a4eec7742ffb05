//! Dominant eigenvalue of a linear map that is only known by what it does to a vector.

use nalgebra::{Complex, DMatrix, DVector, Schur};

/// Relative residual at which an eigenvalue counts as found.
const TOLERANCE: f64 = 1e-8;
/// Largest subspace. The period maps of delayed systems are compact, their eigenvalues fall off
/// fast.
const MAX_VECTORS: usize = 90;
const FIRST_CHECK: usize = 4;
/// Applications before the subspace is begun: they cost little beside orthogonalising and leave of
/// the start vector what matters, so that few vectors do.
const PRELUDE: usize = 16;
/// QR sweeps for each row of a small matrix after which another origin is tried, and those origins,
/// as parts of the matrix's norm.
const SWEEPS: usize = 60;
const ORIGINS: [f64; 4] = [0.0, 0.37, -0.61, 1.3];

/// Eigenvalue of largest magnitude of the map `apply(x, y): y = M x` on vectors of length `length`
/// (power iteration to begin with, then Arnoldi's method without restart).
pub(crate) fn dominant_eigenvalue(
    length: usize,
    apply: impl FnMut(&[f64], &mut [f64]),
) -> Complex<f64> {
    arnoldi(length, apply).map_or(Complex::new(0.0, 0.0), |found| found.eigenvalue)
}

/// [`dominant_eigenvalue`] and its eigenvector.
pub(crate) fn dominant_eigenpair(
    length: usize,
    apply: impl FnMut(&[f64], &mut [f64]),
) -> (Complex<f64>, Vec<Complex<f64>>) {
    let mut vector = vec![Complex::new(0.0, 0.0); length];
    let Some(found) = arnoldi(length, apply) else {
        return (Complex::new(0.0, 0.0), vector);
    };
    let parts = inverse_iteration(&found.square, found.eigenvalue);
    for (part, own) in parts
        .iter()
        .flat_map(|parts| parts.iter())
        .zip(&found.basis)
    {
        for (sum, x) in vector.iter_mut().zip(own) {
            *sum += part * *x;
        }
    }
    (found.eigenvalue, vector)
}

/// A subspace that holds the dominant eigenvector.
struct Subspace {
    eigenvalue: Complex<f64>,
    /// The map on the subspace.
    square: DMatrix<f64>,
    basis: Vec<Vec<f64>>,
}

/// `None` where the map leads to nothing.
fn arnoldi(length: usize, mut apply: impl FnMut(&[f64], &mut [f64])) -> Option<Subspace> {
    let vectors = MAX_VECTORS.min(length);
    let mut hessenberg = DMatrix::<f64>::zeros(vectors + 1, vectors);
    let mut image = vec![0.0; length];
    let mut first = start(length);
    for _ in 0..PRELUDE {
        apply(&first, &mut image);
        let size = norm(&image);
        if size == 0.0 {
            return None;
        }
        for (to, from) in first.iter_mut().zip(&image) {
            *to = from / size;
        }
    }
    let mut basis = vec![first];
    let mut next_check = FIRST_CHECK.min(vectors);
    for m in 1..=vectors {
        apply(&basis[m - 1], &mut image);
        let before = norm(&image);
        // Twice is enough (Kahan and Parlett) for a basis orthogonal to rounding.
        for _ in 0..2 {
            for (i, vector) in basis.iter().enumerate() {
                let along = dot(vector, &image);
                hessenberg[(i, m - 1)] += along;
                subtract(&mut image, along, vector);
            }
        }
        let left = norm(&image);
        hessenberg[(m, m - 1)] = left;
        let exhausted = m == vectors || left <= 1e-14 * before || before == 0.0;
        if exhausted || m == next_check {
            let square = hessenberg.view((0, 0), (m, m)).into_owned();
            let eigenvalue = largest(&square);
            if exhausted || residual(&square, eigenvalue, left) <= TOLERANCE * eigenvalue.norm() {
                return Some(Subspace {
                    eigenvalue,
                    square,
                    basis,
                });
            }
            next_check = (m + 2 + m / 4).min(vectors);
        }
        basis.push(image.iter().map(|x| x / left).collect());
    }
    None
}

/// A start vector with a part in every direction: a fixed low-discrepancy sequence.
fn start(length: usize) -> Vec<f64> {
    let raw: Vec<f64> = (1..=length)
        .map(|i| (i as f64 * 0.618_033_988_749_894_9).fract() - 0.35)
        .collect();
    let size = norm(&raw);
    raw.iter().map(|x| x / size).collect()
}

/// Eigenvalue of largest magnitude. The QR algorithm's own shifts can go round in a circle (on a
/// cyclic matrix of order 6, say, or one near to it); they do not from another origin. Not a number
/// if none helps.
fn largest(square: &DMatrix<f64>) -> Complex<f64> {
    let (size, sweeps) = (square.norm(), SWEEPS * square.nrows());
    let found = ORIGINS.iter().find_map(|part| {
        let origin = part * size;
        let moved = square + DMatrix::from_diagonal_element(square.nrows(), square.nrows(), origin);
        let schur = Schur::try_new(moved, f64::EPSILON, sweeps)?;
        let eigenvalues = schur.complex_eigenvalues();
        let eigenvalues = eigenvalues.iter().map(|moved| moved - origin);
        eigenvalues.max_by(|a, b| a.norm_sqr().total_cmp(&b.norm_sqr()))
    });
    found.unwrap_or(Complex::new(f64::NAN, f64::NAN))
}

/// ‖M v − θ v‖ of the Ritz vector.
fn residual(square: &DMatrix<f64>, eigenvalue: Complex<f64>, coupling: f64) -> f64 {
    let last = square.nrows() - 1;
    inverse_iteration(square, eigenvalue)
        .map_or(0.0, |vector| coupling * vector[last].norm() / vector.norm())
}

/// An eigenvector of the small matrix, from one step of inverse iteration; `None` where the
/// eigenvalue is met exactly.
fn inverse_iteration(
    square: &DMatrix<f64>,
    eigenvalue: Complex<f64>,
) -> Option<DVector<Complex<f64>>> {
    let m = square.nrows();
    let shift = eigenvalue * (1.0 + 1e-10);
    let shifted = DMatrix::from_fn(m, m, |r, c| {
        let on_diagonal = if r == c { shift } else { Complex::default() };
        Complex::new(square[(r, c)], 0.0) - on_diagonal
    });
    let ones = DVector::from_element(m, Complex::new(1.0, 0.0));
    shifted.lu().solve(&ones)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

fn subtract(from: &mut [f64], factor: f64, vector: &[f64]) {
    for (x, v) in from.iter_mut().zip(vector) {
        *x -= factor * v;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against a dense solver, for matrices whose spectrum falls off and for one that does not.
    #[test]
    fn verify_dominant_eigenvalue_of_dense_matrices() {
        for (n, decay) in [(3, 1.0_f64), (40, 0.7), (120, 0.9), (30, 1.0)] {
            let x = |i: usize| ((i * i + 3 * i + 1) as f64 * 0.754_877_666).fract() - 0.5;
            let matrix = DMatrix::from_fn(n, n, |r, c| decay.powi(c as i32) * x(r * n + c));
            let found = dominant_eigenvalue(n, |from, to| {
                let image = &matrix * DVector::from_column_slice(from);
                to.copy_from_slice(image.as_slice());
            });
            let expected = largest(&matrix);
            assert!(
                (found.norm() / expected.norm() - 1.0).abs() < 1e-7,
                "{found} {expected}"
            );
            assert!((found.re - expected.re).abs() < 1e-6 * expected.norm());
        }
    }

    /// On some cyclic matrices the QR algorithm stands still; their eigenvalues are the roots of 1.
    #[test]
    fn verify_eigenvalues_of_a_cycle() {
        for n in 3..9 {
            let cycle = DMatrix::from_fn(n, n, |r, c| f64::from(u8::from(r == (c + 1) % n)));
            let unmoved = Schur::try_new(cycle.clone(), f64::EPSILON, 1000);
            assert!(
                n != 6 || unmoved.is_none(),
                "the other origins serve a purpose"
            );
            assert!((largest(&cycle).norm() - 1.0).abs() < 1e-10, "{n}");
        }
    }

    #[test]
    fn a_map_to_zero_has_only_zero() {
        let found = dominant_eigenvalue(5, |_, to| to.fill(0.0));
        assert_eq!(found.norm(), 0.0);
    }
}
