//! The coloured background of a spectrum, above which lines are detected.

use nalgebra::{DMatrix, DVector};
use statrs::function::gamma::digamma;

use super::distributions::f_tail;
use super::ratio;
use super::spectrum::{Periodogram, SHARE_VALID, welch};

/// Power density as a smooth function of frequency.
///
/// At each bin a straight line of ln(density) over ln(frequency) is fitted to the bins around it;
/// below the lowest fit it is extrapolated. White noise, 1/f noise and any smooth spectrum are
/// followed without a parametric model. Bins far above the fit are excluded and the fit is
/// repeated, so that lines do not raise their own background.
#[derive(Clone, Debug, PartialEq)]
pub struct Background {
    bin_width: f64,
    stretch: f64,
    fits: Vec<LocalLine>,
    /// Through the lowest bins, [`WIDER`] times as many as a line has.
    wide: LocalLine,
    /// Variance of the logarithm of one bin, including correlation of neighbours by the window.
    scatter: f64,
}

/// The straight line at one bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct LocalLine {
    middle: f64,
    level: f64,
    slope: f64,
    count: f64,
    spread: f64,
}

impl LocalLine {
    fn log_density(&self, x: f64) -> f64 {
        self.level + self.slope * (x - self.middle)
    }

    /// Variance of the line at x over that of one bin.
    fn leverage(&self, x: f64) -> f64 {
        let arm = x - self.middle;
        1.0 / self.count.max(1.0) + ratio(arm * arm, self.spread)
    }
}

/// Cumulative sums over the included bins, of 1, x, x², y, xy.
struct Sums(Vec<[f64; 5]>);

impl Sums {
    fn over(logs: &[f64], kept: &[bool], bin_width: f64) -> Sums {
        let mut sums = vec![[0.0; 5]; logs.len() + 1];
        for bin in 1..logs.len() {
            let (x, y) = ((bin as f64 * bin_width).ln(), logs[bin]);
            let weight = f64::from(u8::from(kept[bin]));
            let terms = [1.0, x, x * x, y, x * y];
            sums[bin + 1] = std::array::from_fn(|i| sums[bin][i] + weight * terms[i]);
        }
        Sums(sums)
    }

    fn between(&self, first: usize, end: usize) -> [f64; 5] {
        std::array::from_fn(|i| self.0[end][i] - self.0[first][i])
    }

    /// The line through `width` bins around one, without those closer than `apart`. At the ends of
    /// the spectrum the interval is shifted, not truncated; it is widened over excluded bins.
    fn fit(&self, bin: usize, width: usize, apart: usize) -> LocalLine {
        let end_of_all = self.0.len() - 1;
        let mut wide = width;
        loop {
            let highest_first = end_of_all.saturating_sub(wide).max(1);
            let first = bin.saturating_sub(wide / 2).clamp(1, highest_first);
            let end = (first + wide).min(end_of_all);
            let mut sum = self.between(first, end);
            if apart > 0 {
                let near = (bin + 1).saturating_sub(apart).max(first)..(bin + apart).min(end);
                let near = self.between(near.start, near.end.max(near.start));
                sum = std::array::from_fn(|i| sum[i] - near[i]);
            }
            if sum[0] >= 0.6 * width as f64 || wide >= end_of_all {
                return straight_line(sum);
            }
            wide = (2 * wide).min(end_of_all);
        }
    }
}

/// Factor by which correlation of neighbours under a Hann window raises the variance of a mean of
/// many logarithms. Powers correlate by ρ = (2/3)² and (1/6)² with the next and the next but one;
/// logarithms of powers with two degrees of freedom by Li₂(ρ)/(π²/6), with many by ρ: 1 + 2 (0.308
/// + 0.017), and 1 + 2 (0.444 + 0.028).
fn shared(degrees: f64) -> f64 {
    if degrees < 3.0 { 1.65 } else { 1.944 }
}

/// Largest fraction of a bin's noise that a regression may remove for the bin to be used.
const MOST_REMOVED: f64 = 0.5;

/// How many times as many bins the slope at low frequencies is looked for in, too.
const WIDER: usize = 4;
/// A slope of fewer standard errors than this may be chance.
const BY_CHANCE: f64 = 2.5;

/// Bins on either side of an outlier that it may affect.
const LOBE: usize = 2;

impl Background {
    /// Of a periodogram; `None` for fewer than 16 bins, or power nowhere.
    pub fn fit(periodogram: &Periodogram) -> Option<Background> {
        Background::fit_excluding(periodogram, &[])
    }

    /// Of the periodogram of a regression's residual. `removed` is the fraction of white noise that
    /// the regression removes from each bin: the rest is scaled up, or excluded where small.
    fn fit_excluding(periodogram: &Periodogram, removed: &[f64]) -> Option<Background> {
        let last = periodogram.density.len() - 1;
        let mean = periodogram.density.iter().sum::<f64>() / (last + 1) as f64;
        if last < 16 || mean.is_nan() || mean <= 0.0 {
            return None;
        }
        let half = 0.5 * periodogram.degrees;
        let offset = digamma(half) - half.ln();
        // Exact zeros have no logarithm; no measurement is 200 dB below its mean.
        let log_of = |density: &f64| density.max(1e-20 * mean).ln() - offset;
        let mut logs: Vec<f64> = periodogram.density.iter().map(log_of).collect();
        let bin_width = 1.0 / periodogram.length as f64;
        let width = (1.5 * (last as f64).sqrt())
            .clamp(24.0, 256.0)
            .min(last as f64) as usize;
        let mut kept = vec![true; last + 1];
        kept[0] = false;
        // The bin at half the rate is real, with half the degrees of freedom.
        kept[last] = !periodogram.length.is_multiple_of(2);
        for (bin, share) in removed.iter().enumerate() {
            if *share > MOST_REMOVED {
                kept[bin] = false;
            } else {
                logs[bin] -= (1.0 - share).ln();
            }
        }
        let mut background = Background {
            bin_width,
            stretch: width as f64 * bin_width,
            fits: Vec::new(),
            wide: LocalLine::default(),
            scatter: trigamma(half) * shared(periodogram.degrees),
        };
        for _ in 0..8 {
            let sums = Sums::over(&logs, &kept, bin_width);
            let found = background.standing_out(periodogram, &sums, width);
            let before = kept.clone();
            for bin in found {
                let end = (bin + LOBE).min(last);
                kept[bin.saturating_sub(LOBE).max(1)..=end].fill(false);
            }
            if kept == before {
                break;
            }
        }
        let sums = Sums::over(&logs, &kept, bin_width);
        background.fits = (0..=last)
            .map(|bin| sums.fit(bin.max(1), width, 0))
            .collect();
        background.wide = sums.fit(1, (WIDER * width).min(last), 0);
        Some(background)
    }

    /// The same without a slope at the lowest frequencies where none is clear: a line that is
    /// extrapolated by a slope of chance is off by several times at frequency 0.
    pub fn levelled(mut self) -> Background {
        let lowest = self.fits[1];
        let limit = BY_CHANCE * BY_CHANCE * self.scatter;
        let by_chance = |fit: &LocalLine| fit.slope.powi(2) * fit.spread <= limit;
        if by_chance(&lowest) && by_chance(&self.wide) {
            let mut level = lowest;
            (level.slope, level.spread) = (0.0, f64::INFINITY);
            let same = self.fits.iter_mut().filter(|fit| **fit == lowest);
            same.for_each(|fit| *fit = level);
        }
        self
    }

    /// Of a series: from its plain periodogram.
    pub fn of(values: &[f64], valid: &[bool]) -> Option<Background> {
        Background::fit(&welch(values, valid, whole(valid))?)
    }

    /// Of the residual of a least-squares regression on columns, corrected for the noise that they
    /// remove. The columns are zero where samples are not valid, and have no mean. `None` also if
    /// they are linearly dependent.
    pub fn of_regression(
        values: &[f64],
        valid: &[bool],
        columns: &[Vec<f64>],
    ) -> Option<Background> {
        let count = columns.len();
        let matrix = DMatrix::from_fn(values.len(), count, |row, i| columns[i][row]);
        let normal = matrix.transpose() * &matrix;
        let factor = normal.cholesky()?;
        // Orthonormal columns of the same span.
        let basis = factor
            .l()
            .solve_lower_triangular(&matrix.transpose())?
            .transpose();
        let series = DVector::from_fn(
            values.len(),
            |row, _| if valid[row] { values[row] } else { 0.0 },
        );
        let rest = &series - &basis * (basis.transpose() * &series);
        let length = whole(valid);
        let periodogram = welch(rest.as_slice(), valid, length)?;
        let mut removed = vec![0.0; periodogram.density.len()];
        for column in basis.column_iter() {
            // A column of unit length in N samples has the density of noise of variance 1/N.
            let scale = values.len() as f64;
            let own = welch(column.into_owned().as_slice(), valid, length)?;
            removed
                .iter_mut()
                .zip(&own.density)
                .for_each(|(sum, share)| *sum += scale * share / own.length as f64);
        }
        Background::fit_excluding(&periodogram, &removed)
    }

    /// Bins that are not noise: too far above the line through their neighbours, without those that
    /// they may affect.
    fn standing_out(&self, periodogram: &Periodogram, sums: &Sums, width: usize) -> Vec<usize> {
        let last = periodogram.density.len() - 1;
        let level = 0.05 / last as f64;
        let stands_out = |bin: &usize| {
            let fit = sums.fit(*bin, width, LOBE + 1);
            let x = (*bin as f64 * self.bin_width).ln();
            let ratio = periodogram.density[*bin] / fit.log_density(x).exp();
            f_tail(
                ratio,
                periodogram.degrees,
                2.0 / (self.scatter * fit.leverage(x)),
            ) < level
        };
        (1..last).filter(stands_out).collect()
    }

    fn fit_at(&self, frequency: f64) -> &LocalLine {
        let bin = (frequency / self.bin_width).round() as usize;
        &self.fits[bin.clamp(1, self.fits.len() - 1)]
    }

    /// Two-sided density at `frequency` cycles per sample, above 0. Below the lowest bin, where the
    /// record has no information, a rise of 1/f or steeper is limited to f^−0.9.
    pub fn density(&self, frequency: f64) -> f64 {
        if frequency < self.bin_width {
            let lowest = self.fits[1].log_density(self.bin_width.ln()).exp();
            return lowest * (frequency / self.bin_width).powf(self.slope_below());
        }
        self.fit_at(frequency).log_density(frequency.ln()).exp()
    }

    /// Mean density from 0 to a frequency that is not above the lowest bin.
    pub fn mean_density_below(&self, frequency: f64) -> f64 {
        self.density(frequency) / (1.0 + self.slope_below())
    }

    /// At −1 or less the mean from 0 would diverge.
    fn slope_below(&self) -> f64 {
        self.lowest_slope().max(-0.9)
    }

    /// Variance of the logarithm of [`Background::density`].
    pub fn log_variance(&self, frequency: f64) -> f64 {
        let frequency = frequency.max(0.25 * self.bin_width);
        self.scatter * self.fit_at(frequency).leverage(frequency.ln())
    }

    /// Width of the interval that a density is estimated from, cycles per sample.
    pub fn stretch(&self) -> f64 {
        self.stretch
    }

    /// Slope in the logarithmic plane at the lowest frequencies: 0 for white noise, −1 for 1/f.
    pub fn lowest_slope(&self) -> f64 {
        self.fits[1].slope
    }
}

/// ψ′(x), by recurrence and its asymptotic series.
fn trigamma(mut x: f64) -> f64 {
    let mut sum = 0.0;
    while x < 10.0 {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    sum + 1.0 / x + 0.5 * y + y / x * (1.0 / 6.0 - y * (1.0 / 30.0 - y / 42.0))
}

/// The whole record if Welch's method can use it, else its longest run of samples without a gap.
fn whole(valid: &[bool]) -> usize {
    let counted = valid.iter().filter(|one| **one).count();
    if counted as f64 >= SHARE_VALID * valid.len() as f64 {
        return valid.len();
    }
    let blocks = super::contiguous_blocks(valid, 8);
    blocks.iter().map(ExactSizeIterator::len).max().unwrap_or(0)
}

fn straight_line([count, x, xx, y, xy]: [f64; 5]) -> LocalLine {
    let middle = x / count.max(1.0);
    let level = y / count.max(1.0);
    let spread = (xx - count * middle * middle).max(0.0);
    let slope = if spread > 1e-9 {
        (xy - count * middle * level) / spread
    } else {
        0.0
    };
    LocalLine {
        middle,
        level,
        slope,
        count,
        spread,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, noise};

    /// Mean square of the error of the logarithm, found and stated.
    fn errors(colour: Colour, frequency: f64, truth: f64) -> (f64, f64) {
        let (mut found, mut stated) = (0.0, 0.0);
        for seed in 0..200 {
            let values = noise(colour, 4096, seed);
            let background = Background::of(&values, &[true; 4096]).unwrap();
            found += (background.density(frequency) / truth).ln().powi(2) / 200.0;
            stated += background.log_variance(frequency) / 200.0;
        }
        (found, stated)
    }

    /// The error, bias included, is as stated: at the lowest frequency, by extrapolation,
    /// at the bend of the spectrum of AR(1) noise, and beyond.
    #[test]
    fn verify_known_densities_are_met_with_the_stated_error() {
        // 1/|1 - a exp(-iω)|².
        let ar1 = |frequency: f64| {
            let cos = (std::f64::consts::TAU * frequency).cos();
            1.0 / (1.0 + 0.81 - 2.0 * 0.9 * cos)
        };
        for frequency in [1.0 / 4096.0, 0.02, 0.2] {
            for (colour, truth) in [(Colour::White, 1.0), (Colour::Ar1(0.9), ar1(frequency))] {
                let (found, stated) = errors(colour, frequency, truth);
                assert!(
                    (found / stated).ln().abs() < 1.6_f64.ln(),
                    "{colour:?} at {frequency}: {found} for {stated}"
                );
            }
        }
    }

    #[test]
    fn verify_slope_of_pink_noise() {
        let slopes = (0..50).map(|seed| {
            Background::of(&noise(Colour::Pink, 8192, seed), &[true; 8192])
                .unwrap()
                .lowest_slope()
        });
        let mean = slopes.sum::<f64>() / 50.0;
        assert!((mean + 1.0).abs() < 0.1, "{mean}");
    }

    /// A line a hundred times the noise, in power per bin 10⁷ of it, does not change the
    /// background.
    #[test]
    fn verify_a_line_does_not_raise_its_background() {
        let mut values = noise(Colour::White, 4096, 5);
        for (row, value) in values.iter_mut().enumerate() {
            *value += 100.0 * (0.3 * row as f64).sin();
        }
        let background = Background::of(&values, &[true; 4096]).unwrap();
        let near = background.density(0.3 / std::f64::consts::TAU);
        assert!((near.ln()).abs() < 0.6, "{near}");
    }

    #[test]
    fn verify_trigamma() {
        assert!((trigamma(1.0) - std::f64::consts::PI.powi(2) / 6.0).abs() < 1e-9);
        assert!((trigamma(0.5) - std::f64::consts::PI.powi(2) / 2.0).abs() < 1e-9);
    }

    #[test]
    fn silence_has_no_background() {
        assert_eq!(Background::of(&[0.0; 100], &[true; 100]), None);
        assert_eq!(Background::of(&[1.0; 10], &[true; 10]), None);
    }
}
