//! How smooth a curve is: its bending has a price, as high as the data make likely.
//!
//! A curve's values are many, and without a price each follows the noise at its own place. With the
//! price `λ ∫ f''²` a curve is the posterior mean of an integrated Wiener process (`wahba1978`),
//! the weight `λ` is the one under which the data are likeliest (`mackay1992`), and that
//! likelihood, in which all values are integrated out, is what a curve is held against a model
//! without it by.

use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::data::Rows;
use super::fit::Fit;
use super::noise::dot;
use super::problem::{Point, Problem, Variable};

/// Weight before the data are seen: that of a few slow waves of a typical size.
pub(super) const AT_FIRST: f64 = 1e-4;
/// Weights that are tried: decades of them, and how many in each. From curves that follow every
/// value to straight lines.
const DECADES: (i32, i32) = (-12, 3);
const IN_A_DECADE: i32 = 2;
/// Part of the square of what a curve changes in the channel where it changes most, from which on a
/// channel shows it.
const LEAST_SHOWN: f64 = 0.01;

/// The curve among the variables of a point, with the price of its bending.
pub(super) struct Smooth {
    /// The first of its variables.
    first: usize,
    /// `∫ f''²` over unit length as a form in the values, in typical sizes.
    bending: DMatrix<f64>,
    pub weight: f64,
}

impl Smooth {
    /// Of a point with a curve.
    pub fn of(problem: &Problem, point: &Point) -> Option<Smooth> {
        let (first, curve) = problem.curve(point)?;
        let size = problem.candidates[curve.candidate].scale[0];
        Some(Smooth {
            first,
            bending: bending(curve.values.len()) / size.powi(2),
            weight: curve.smoothing,
        })
    }

    fn own(&self) -> Range<usize> {
        self.first..self.first + self.bending.nrows()
    }

    /// The places of the channels that the curve changes in what was whitened, channel by channel:
    /// those in which its values show by more than a hundredth of the square that they do most.
    pub fn channels(&self, rows: &Rows, columns: &[Vec<f64>]) -> Vec<Range<usize>> {
        let ends = rows.per_channel.iter().scan(0, |end, rows| {
            let start = *end;
            *end += rows.len();
            Some(start..*end)
        });
        let shows = |range: &Range<usize>| -> f64 {
            let own = columns[self.own()].iter().map(|x| &x[range.clone()]);
            own.map(|x| dot(x, x)).sum()
        };
        let all: Vec<(Range<usize>, f64)> =
            ends.map(|range| (range.clone(), shows(&range))).collect();
        let most = all.iter().map(|(_, shows)| *shows).fold(0.0, f64::max);
        let bent = all
            .into_iter()
            .filter(|(_, shows)| *shows >= LEAST_SHOWN * most);
        bent.map(|(range, _)| range).collect()
    }

    /// Whether a variable is one of the curve's.
    pub fn holds(&self, variable: usize) -> bool {
        self.own().contains(&variable)
    }

    /// What the price adds to the normal equations of two variables.
    pub fn stiffness(&self, i: usize, j: usize) -> f64 {
        match self.holds(i) && self.holds(j) {
            true => self.weight * self.bending[(i - self.first, j - self.first)],
            false => 0.0,
        }
    }

    /// Half the slope of the price, by each variable.
    pub fn pulls(&self, variables: &[Variable]) -> DVector<f64> {
        let values = self.values(variables);
        let own = self.weight * &self.bending * values;
        let mut all = DVector::zeros(variables.len());
        all.rows_mut(self.first, own.len()).copy_from(&own);
        all
    }

    fn values(&self, variables: &[Variable]) -> DVector<f64> {
        let own = self.own().map(|i| variables[i].value);
        DVector::from_iterator(self.bending.nrows(), own)
    }

    /// The price.
    pub fn penalty(&self, variables: &[Variable]) -> f64 {
        let values = self.values(variables);
        self.weight * values.dot(&(&self.bending * &values))
    }

    /// Takes the weight under which the data are likeliest, the noise's level integrated out, where
    /// the model is linear about the variables: `normal` and `slope` are of the data and the
    /// priors, `squares` what they have to explain at so many `rows`, both of the channels that the
    /// curve changes. Only the free variables move.
    pub fn choose(
        &mut self,
        variables: &[Variable],
        (normal, slope): (&DMatrix<f64>, &DVector<f64>),
        free: &[usize],
        squares: f64,
        rows: usize,
    ) {
        let tried = (DECADES.0 * IN_A_DECADE)..=(DECADES.1 * IN_A_DECADE);
        let mut best = (f64::INFINITY, self.weight);
        for exponent in tried {
            self.weight = 10_f64.powf(f64::from(exponent) / f64::from(IN_A_DECADE));
            let pulls = self.pulls(variables);
            let whole = self.form(normal, free);
            let right = DVector::from_fn(free.len(), |a, _| slope[free[a]] - pulls[free[a]]);
            let Some(factor) = whole.cholesky() else {
                continue;
            };
            let left = squares + self.penalty(variables) - right.dot(&factor.solve(&right));
            let Some(prior) = self.prior(variables, free) else {
                continue;
            };
            let evidence =
                rows as f64 * left.max(f64::MIN_POSITIVE).ln() + log_det(&factor) - log_det(&prior);
            if evidence < best.0 {
                best = (evidence, self.weight);
            }
        }
        self.weight = best.1;
    }

    /// Normal equations of some variables with the price.
    fn form(&self, normal: &DMatrix<f64>, free: &[usize]) -> DMatrix<f64> {
        let k = free.len();
        DMatrix::from_fn(k, k, |a, b| {
            let (i, j) = (free[a], free[b]);
            let jitter = if a == b { 1e-9 * normal[(i, i)] } else { 0.0 };
            normal[(i, j)] + self.stiffness(i, j) + jitter
        })
    }

    /// What is known of the curve's free values beforehand.
    fn prior(&self, variables: &[Variable], free: &[usize]) -> Option<Cholesky<f64, Dyn>> {
        let own: Vec<usize> = free.iter().copied().filter(|&i| self.holds(i)).collect();
        let form = DMatrix::from_fn(own.len(), own.len(), |a, b| {
            let ridge = variables[own[a]].prior.precision.powi(2);
            self.stiffness(own[a], own[b]) + if a == b { ridge } else { 0.0 }
        });
        form.cholesky()
    }
}

/// What a curve costs a fit, in minus twice the logarithm of the likelihood: its prior at the
/// values fitted, and by how much the data narrow them down (Laplace's approximation), and one
/// number for its weight. Nothing for a fit without a curve.
pub(super) fn price(problem: &Problem, fit: &Fit, rows: &Rows) -> f64 {
    let Some(smooth) = Smooth::of(problem, &fit.point) else {
        return 0.0;
    };
    let variables = problem.variables(&fit.point);
    let columns: Vec<Vec<f64>> = (fit.jacobian.iter())
        .map(|x| fit.noise.whiten(x, rows))
        .collect();
    let k = variables.len();
    let mut normal = DMatrix::zeros(k, k);
    for i in 0..k {
        for j in i..k {
            normal[(i, j)] = dot(&columns[i], &columns[j]);
            normal[(j, i)] = normal[(i, j)];
        }
        normal[(i, i)] += variables[i].prior.precision.powi(2);
    }
    let felt: Vec<usize> = (0..k).filter(|&i| normal[(i, i)] > 0.0).collect();
    let others: Vec<usize> = felt.iter().copied().filter(|&i| !smooth.holds(i)).collect();
    let volume = |of: &[usize]| Some(log_det(&smooth.form(&normal, of).cholesky()?));
    let narrowed = volume(&felt).zip(volume(&others));
    let prior = smooth.prior(&variables, &felt);
    let Some(((whole, others), prior)) = narrowed.zip(prior) else {
        return f64::INFINITY;
    };
    let own = variables[smooth.own()].iter();
    let ridge: f64 = own
        .map(|v| (v.prior.precision * v.prior.offset).powi(2))
        .sum();
    smooth.penalty(&variables) + ridge + whole - others - log_det(&prior) + (rows.len() as f64).ln()
}

/// Squares of second differences of values evenly over unit length, as a form.
fn bending(places: usize) -> DMatrix<f64> {
    let spacing = 1.0 / (places - 1) as f64;
    let differences = DMatrix::from_fn(places - 2, places, |i, j| match j.checked_sub(i) {
        Some(0 | 2) => 1.0,
        Some(1) => -2.0,
        _ => 0.0,
    });
    differences.transpose() * differences / spacing.powi(3)
}

fn log_det(factor: &Cholesky<f64, Dyn>) -> f64 {
    let diagonal = factor.l_dirty().diagonal();
    2.0 * diagonal.iter().map(|x| x.ln()).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::noise::Prior;
    use crate::testing::{Colour, noise};

    /// The bending of a parabola is its constant, that of a straight line none.
    #[test]
    fn verify_bending_is_the_integral_of_the_square() {
        for seed in 0..20 {
            let drawn = noise(Colour::White, 4, seed);
            let places = 40 + (drawn[3].abs() * 50.0) as usize;
            let values = DVector::from_fn(places, |i, _| {
                let x = i as f64 / (places - 1) as f64;
                drawn[0] + drawn[1] * x + 0.5 * drawn[2] * x.powi(2)
            });
            let found = values.dot(&(bending(places) * &values));
            // the two ends have no second difference
            let counted = (places - 2) as f64 / (places - 1) as f64;
            let wanted = counted * drawn[2].powi(2);
            assert!((found - wanted).abs() < 1e-6 * (1.0 + wanted), "{found}");
        }
    }

    /// Of waves in noise, each value measured once, the weight leaves less error than none and less
    /// than the largest does; in the mean over the draws it is within a quarter of the least error
    /// of any weight, which no one knows without the truth.
    #[test]
    fn verify_the_likeliest_weight_is_near_the_best() {
        let places = 90;
        let mut ratios = Vec::new();
        for seed in 0..10 {
            let drawn = noise(Colour::White, places + 2, 100 + seed);
            let waves = 2.0 + drawn[places].abs();
            let law = |i: usize| (6.3 * waves * i as f64 / places as f64 + drawn[places + 1]).sin();
            let truth = DVector::from_fn(places, |i, _| law(i));
            let spread = 0.3;
            let data = DVector::from_fn(places, |i, _| truth[i] + spread * drawn[i]);
            let variables = vec![
                Variable {
                    value: 0.0,
                    step: 1e-3,
                    min: f64::NEG_INFINITY,
                    max: f64::INFINITY,
                    prior: Prior {
                        offset: 0.0,
                        precision: 0.1
                    },
                };
                places
            ];
            let precision = spread.powi(-2);
            let normal = DMatrix::identity(places, places) * (precision + 0.01);
            let slope = &data * precision;
            let free: Vec<usize> = (0..places).collect();
            let mut smooth = Smooth {
                first: 0,
                bending: bending(places),
                weight: AT_FIRST,
            };
            let squares = precision * data.norm_squared();
            smooth.choose(&variables, (&normal, &slope), &free, squares, places);
            let error = |weight: f64| {
                let form = &normal + weight * bending(places);
                (form.cholesky().unwrap().solve(&slope) - &truth).norm()
            };
            let tried = (-24..=6).map(|i| error(10_f64.powf(0.5 * f64::from(i))));
            let best = tried.fold(f64::INFINITY, f64::min);
            let found = error(smooth.weight);
            ratios.push((found / best).ln());
            assert!(found < 0.8 * error(1e-12) && found < 0.8 * error(1e3));
        }
        assert!(crate::stats::mean(&ratios) < 1.25_f64.ln(), "{ratios:?}");
    }
}
