//! Residues for given poles, and derivatives of the residual by the poles.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector};

use super::Pole;
use crate::identify::frf::Frf;

type C = Complex<f64>;

/// Frequencies, values and weights of all FRFs.
pub(super) struct PoleProblem {
    curves: Vec<Curve>,
}

struct Curve {
    omega: Vec<f64>,
    /// (iω)^p.
    factor: Vec<C>,
    value: Vec<C>,
    /// Inverse standard deviation of each value.
    weight: Vec<f64>,
    /// Reference frequency of the scaling, rad/s.
    scale: f64,
}

/// The best residues for some poles.
pub(super) struct Fitted {
    /// Of each FRF, the residue of each pole.
    pub residues: Vec<Vec<C>>,
    /// Weighted residual, all real parts of an FRF and then all imaginary ones.
    pub residual: Vec<f64>,
    /// Of each FRF: an orthonormal basis of its design's column space, and the coefficients.
    bases: Vec<DMatrix<f64>>,
    coefficients: Vec<DVector<f64>>,
}

impl Fitted {
    pub fn cost(&self) -> f64 {
        self.residual.iter().map(|r| r * r).sum()
    }
}

impl PoleProblem {
    pub fn new(frfs: &[Frf]) -> PoleProblem {
        let curves = frfs.iter().map(|frf| {
            let omega: Vec<f64> = frf.frequency_hz.iter().map(|f| TAU * f).collect();
            let square: f64 = frf.value.iter().map(|h| h.norm_sqr()).sum();
            let rms = (square / frf.value.len() as f64).sqrt();
            let weight = match &frf.noise {
                Some(noise) => noise.iter().map(|n| 1.0 / n).collect(),
                None => vec![1.0 / rms; omega.len()],
            };
            let middle = omega.iter().sum::<f64>() / omega.len() as f64;
            Curve {
                factor: (frf.frequency_hz.iter())
                    .map(|f| Frf::from_compliance(frf.kind, *f))
                    .collect(),
                value: frf.value.clone(),
                weight,
                scale: middle,
                omega,
            }
        });
        PoleProblem {
            curves: curves.collect(),
        }
    }

    /// Number of real measured values.
    pub fn size(&self) -> f64 {
        self.curves.iter().map(|c| 2.0 * c.omega.len() as f64).sum()
    }

    /// Number of unknowns for a number of poles.
    pub fn unknowns(&self, poles: usize) -> f64 {
        (2 * poles + self.curves.len() * (2 * poles + 2)) as f64
    }

    pub fn degrees(&self, poles: usize) -> f64 {
        (self.size() - self.unknowns(poles)).max(1.0)
    }

    /// Cost without modes.
    pub fn total(&self) -> f64 {
        let of = |c: &Curve| -> f64 {
            (c.value.iter().zip(&c.weight))
                .map(|(h, w)| h.norm_sqr() * w * w)
                .sum()
        };
        self.curves.iter().map(of).sum()
    }

    /// The best residues for these poles.
    pub fn solve(&self, poles: &[Pole]) -> Fitted {
        let mut fitted = Fitted {
            residues: Vec::new(),
            residual: Vec::new(),
            bases: Vec::new(),
            coefficients: Vec::new(),
        };
        for curve in &self.curves {
            let (mut design, norms) = unit_columns(curve.design(poles));
            let target = curve.weighted(&curve.value);
            // Gram-Schmidt, twice; nearly dependent columns are dropped, with coefficient 0.
            let rank = orthonormal(&mut design);
            let basis = design;
            let within = basis.tr_mul(&target);
            let residual = &target - &basis * &within;
            let (plain, _) = unit_columns(curve.design(poles));
            let triangle = basis.tr_mul(&plain);
            let scaled = back_substitute(&triangle, &within, &rank);
            let coefficients =
                DVector::from_iterator(scaled.len(), scaled.iter().zip(&norms).map(|(c, n)| c / n));
            fitted.residues.push(
                (0..poles.len())
                    .map(|k| C::new(coefficients[2 * k], coefficients[2 * k + 1]))
                    .collect(),
            );
            fitted.residual.extend(residual.iter());
            fitted.bases.push(basis);
            fitted.coefficients.push(coefficients);
        }
        fitted
    }

    /// Derivative of the residual by the logarithms of ω and ζ of each pole (Kaufman's form).
    pub fn jacobian(&self, poles: &[Pole], at: &Fitted) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(at.residual.len(), 2 * poles.len());
        let mut row = 0;
        for (m, curve) in self.curves.iter().enumerate() {
            let rows = 2 * curve.omega.len();
            for (k, pole) in poles.iter().enumerate() {
                let residue = at.residues[m][k];
                for (which, column) in [(0, 2 * k), (1, 2 * k + 1)] {
                    const STEP: f64 = 1e-5;
                    let at_step = |step: f64| {
                        let mut moved = *pole;
                        if which == 0 {
                            moved.omega *= step.exp();
                        } else {
                            moved.zeta *= step.exp();
                        }
                        curve.of_pole(&moved, residue)
                    };
                    let slope: Vec<C> = (at_step(STEP).iter().zip(at_step(-STEP)))
                        .map(|(up, down)| (up - down) / (2.0 * STEP))
                        .collect();
                    let slope = curve.weighted(&slope);
                    let outside = &slope - &at.bases[m] * at.bases[m].tr_mul(&slope);
                    jacobian
                        .view_mut((row, column), (rows, 1))
                        .copy_from(&(-outside));
                }
            }
            row += rows;
        }
        jacobian
    }

    /// Weights each FRF by its residual with these poles.
    pub fn reweigh(&mut self, poles: &[Pole]) {
        let fitted = self.solve(poles);
        let mut start = 0;
        for curve in &mut self.curves {
            let rows = 2 * curve.omega.len();
            let part = &fitted.residual[start..start + rows];
            let unknowns = (2 * poles.len() + 2).min(rows - 1);
            let rms = (part.iter().map(|r| r * r).sum::<f64>() / (rows - unknowns) as f64).sqrt();
            start += rows;
            // An exact fit gives no estimate of noise.
            let size: f64 = curve.weighted(&curve.value).norm() / (rows as f64).sqrt();
            let rms = rms.max(1e-9 * size);
            curve.weight.iter_mut().for_each(|w| *w /= rms);
        }
    }

    /// Sum of the correlations of neighbouring residuals, at least 1: the number of values per
    /// independent one.
    pub fn correlation(&self, fitted: &Fitted) -> f64 {
        let (mut start, mut sums) = (0, Vec::new());
        for curve in &self.curves {
            let half = curve.omega.len();
            for part in [start..start + half, start + half..start + 2 * half] {
                let r = &fitted.residual[part];
                for lag in 0..(half / 4).min(64) {
                    if sums.len() <= lag {
                        sums.push(0.0);
                    }
                    let pairs = r.iter().zip(&r[lag..]);
                    sums[lag] += pairs.map(|(a, b)| a * b).sum::<f64>();
                }
            }
            start += 2 * half;
        }
        let zero = sums.first().copied().unwrap_or(0.0);
        if zero <= 0.0 {
            return 1.0;
        }
        // Up to the first that is not positive: beyond it there is only noise.
        let positive = sums[1..].iter().map(|s| s / zero).take_while(|s| *s > 0.05);
        1.0 + 2.0 * positive.sum::<f64>()
    }

    /// The fit at every frequency of every FRF.
    pub fn curves(&self, poles: &[Pole], fitted: &Fitted) -> Vec<Vec<C>> {
        (self.curves.iter().zip(&fitted.coefficients))
            .map(|(curve, coefficients)| {
                let columns = curve.columns(poles);
                (0..curve.omega.len())
                    .map(|i| {
                        (columns.iter().zip(coefficients))
                            .map(|(c, a)| c[i] * *a)
                            .sum()
                    })
                    .collect()
            })
            .collect()
    }

    /// Of each FRF: residual over values, both weighted.
    pub fn relative_residuals(&self, fitted: &Fitted) -> Vec<f64> {
        let mut start = 0;
        let of = |curve: &Curve| {
            let rows = 2 * curve.omega.len();
            let part = DVector::from_column_slice(&fitted.residual[start..start + rows]);
            start += rows;
            part.norm() / curve.weighted(&curve.value).norm().max(f64::MIN_POSITIVE)
        };
        self.curves.iter().map(of).collect()
    }

    /// Largest fraction of an FRF that a pole contributes at its own frequency.
    pub fn share(&self, pole: &Pole, k: usize, fitted: &Fitted) -> f64 {
        let of = |(curve, residues): (&Curve, &Vec<C>)| {
            let near = |i: &usize| (curve.omega[*i] - pole.omega).abs();
            let nearest = (0..curve.omega.len()).min_by(|a, b| near(a).total_cmp(&near(b)));
            nearest.map_or(0.0, |i| {
                let own = curve.of_pole(pole, residues[k])[i].norm();
                own / curve.value[i].norm().max(f64::MIN_POSITIVE)
            })
        };
        (self.curves.iter().zip(&fitted.residues))
            .map(of)
            .fold(0.0, f64::max)
    }
}

impl Curve {
    /// Contribution of a pole with this residue.
    fn of_pole(&self, pole: &Pole, residue: C) -> Vec<C> {
        let s = self.pole(pole);
        (self.omega.iter().zip(&self.factor))
            .map(|(omega, factor)| {
                let i_omega = C::new(0.0, *omega);
                factor * (residue / (i_omega - s) + residue.conj() / (i_omega - s.conj()))
            })
            .collect()
    }

    fn pole(&self, pole: &Pole) -> C {
        let zeta = pole.zeta.min(0.999);
        C::new(-zeta, (1.0 - zeta * zeta).sqrt()) * pole.omega
    }

    /// Contribution of each unknown per unit: two for each pole, then U and L.
    fn columns(&self, poles: &[Pole]) -> Vec<Vec<C>> {
        let mut columns = Vec::with_capacity(2 * poles.len() + 2);
        for pole in poles {
            columns.push(self.of_pole(pole, C::new(1.0, 0.0)));
            columns.push(self.of_pole(pole, C::new(0.0, 1.0)));
        }
        columns.push(self.factor.clone());
        let below = |(omega, factor): (&f64, &C)| factor * -(self.scale / omega).powi(2);
        columns.push(self.omega.iter().zip(&self.factor).map(below).collect());
        columns
    }

    fn design(&self, poles: &[Pole]) -> DMatrix<f64> {
        let columns = self.columns(poles);
        let mut design = DMatrix::zeros(2 * self.omega.len(), columns.len());
        for (k, column) in columns.iter().enumerate() {
            design.set_column(k, &self.weighted(column));
        }
        design
    }

    /// Real parts, then imaginary ones, over the standard deviation.
    fn weighted(&self, values: &[C]) -> DVector<f64> {
        let half = values.len();
        DVector::from_fn(2 * half, |i, _| {
            let (k, real) = (i % half, i < half);
            self.weight[k] * if real { values[k].re } else { values[k].im }
        })
    }
}

fn unit_columns(mut design: DMatrix<f64>) -> (DMatrix<f64>, Vec<f64>) {
    let norms: Vec<f64> = (design.column_iter())
        .map(|column| column.norm().max(f64::MIN_POSITIVE))
        .collect();
    for (mut column, norm) in design.column_iter_mut().zip(&norms) {
        column /= *norm;
    }
    (design, norms)
}

/// Makes the columns orthonormal in place; returns which were independent. The others are set to
/// zero.
fn orthonormal(design: &mut DMatrix<f64>) -> Vec<bool> {
    (0..design.ncols())
        .map(|k| {
            let mut column: DVector<f64> = design.column(k).into_owned();
            for _ in 0..2 {
                for earlier in 0..k {
                    let share = design.column(earlier).dot(&column);
                    column.axpy(-share, &design.column(earlier), 1.0);
                }
            }
            let norm = column.norm();
            let new = norm > 1e-10;
            column *= if new { 1.0 / norm } else { 0.0 };
            design.set_column(k, &column);
            new
        })
        .collect()
}

fn back_substitute(triangle: &DMatrix<f64>, right: &DVector<f64>, new: &[bool]) -> DVector<f64> {
    let mut solution = DVector::zeros(right.len());
    for k in (0..right.len()).rev().filter(|&k| new[k]) {
        let known: f64 = (k + 1..right.len())
            .map(|j| triangle[(k, j)] * solution[j])
            .sum();
        solution[k] = (right[k] - known) / triangle[(k, k)];
    }
    solution
}
