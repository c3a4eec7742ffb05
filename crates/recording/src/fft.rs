//! Fourier transforms of real series: plans are made once for a length and kept.

use std::cell::RefCell;

use realfft::RealFftPlanner;
pub use realfft::num_complex::Complex64;

thread_local! {
    /// Keeps what it has computed for a length: the channels of a recording all have the same.
    static PLANNER: RefCell<RealFftPlanner<f64>> = RefCell::new(RealFftPlanner::new());
}

/// Transform of a series, cut or padded with zeros to `length`: bins 0 to length/2, unscaled.
pub fn forward(mut series: Vec<f64>, length: usize) -> Vec<Complex64> {
    series.resize(length, 0.0);
    let plan = PLANNER.with_borrow_mut(|planner| planner.plan_fft_forward(length));
    let mut bins = plan.make_output_vec();
    plan.process(&mut series, &mut bins).expect(LENGTHS);
    bins
}

/// Inverse of [`forward`]: `length` real values.
pub fn inverse(mut bins: Vec<Complex64>, length: usize) -> Vec<f64> {
    bins[0].im = 0.0;
    if length.is_multiple_of(2) {
        bins[length / 2].im = 0.0;
    }
    let plan = PLANNER.with_borrow_mut(|planner| planner.plan_fft_inverse(length));
    let mut series = plan.make_output_vec();
    plan.process(&mut bins, &mut series).expect(LENGTHS);
    series.iter_mut().for_each(|value| *value /= length as f64);
    series
}

const LENGTHS: &str = "buffers have the plan's own lengths";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transform_and_back() {
        let values = vec![1.0, -2.0, 0.5, 4.0, 3.0, 0.0];
        for length in [6, 7, 16] {
            let back = inverse(forward(values.clone(), length), length);
            let expected = values.iter().chain(std::iter::repeat(&0.0));
            assert!(
                back.iter()
                    .zip(expected)
                    .all(|(a, b)| (a - b).abs() < 1e-12),
                "{back:?}"
            );
        }
    }
}
