//! Tail probabilities of the distributions that the tests use.
//!
//! All are upper tails, `P(X > x)`, computed as such, so that small ones keep their digits. A NaN
//! gives NaN.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// Of the standard normal distribution.
pub fn normal_tail(x: f64) -> f64 {
    Normal::standard().sf(x)
}

/// The value that a standard normal variable exceeds with probability `tail`.
pub fn normal_quantile(tail: f64) -> f64 {
    -Normal::standard().inverse_cdf(tail)
}

/// Of the chi-squared distribution; 1 for no degrees of freedom.
pub fn chi_squared_tail(x: f64, degrees: f64) -> f64 {
    ChiSquared::new(degrees).map_or(1.0, |law| if x.is_nan() { x } else { law.sf(x.max(0.0)) })
}

/// The value that a chi-squared variable exceeds with probability `tail`.
pub fn chi_squared_quantile(tail: f64, degrees: f64) -> f64 {
    ChiSquared::new(degrees).map_or(f64::INFINITY, |law| law.inverse_cdf(1.0 - tail))
}

/// Of the F distribution; an infinite `below` means that the denominator is known.
pub fn f_tail(x: f64, above: f64, below: f64) -> f64 {
    if x.is_nan() || above.is_nan() || above <= 0.0 {
        return f64::NAN;
    }
    if below > 1e6 {
        return chi_squared_tail(x * above, above);
    }
    FisherSnedecor::new(above, below).map_or(f64::NAN, |law| law.sf(x.max(0.0)))
}

/// Of Student's distribution, one-sided.
pub fn t_tail(x: f64, degrees: f64) -> f64 {
    if degrees > 1e6 {
        return normal_tail(x);
    }
    StudentsT::new(0.0, 1.0, degrees).map_or(f64::NAN, |law| law.sf(x))
}

/// The value that |t| exceeds with probability `both_tails`: half the width of an interval in
/// standard errors.
pub fn t_quantile(both_tails: f64, degrees: f64) -> f64 {
    if degrees > 1e6 {
        return normal_quantile(0.5 * both_tails);
    }
    let law = StudentsT::new(0.0, 1.0, degrees);
    law.map_or(f64::NAN, |law| -law.inverse_cdf(0.5 * both_tails))
}

/// The probability that the smallest of `count` independent p-values is at most `smallest` (Šidák).
pub fn family_wise(smallest: f64, count: f64) -> f64 {
    // 1 − (1 − p)ⁿ, without the loss of small p.
    -(count * (-smallest).ln_1p()).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, expected: f64) {
        assert!(
            (found / expected - 1.0).abs() < 2e-4,
            "{found} for {expected}"
        );
    }

    /// Points of the printed tables.
    #[test]
    fn verify_tails_of_the_tables() {
        near(normal_tail(1.959_964), 0.025);
        near(normal_quantile(0.025), 1.959_964);
        near(chi_squared_tail(18.307, 10.0), 0.05);
        near(chi_squared_tail(29.588, 10.0), 0.001);
        near(f_tail(3.325_835, 5.0, 10.0), 0.05);
        near(f_tail(18.307 / 10.0, 10.0, f64::INFINITY), 0.05);
        near(t_tail(2.570_582, 5.0), 0.025);
        near(t_quantile(0.05, 5.0), 2.570_582);
        near(t_quantile(0.05, f64::INFINITY), 1.959_964);
    }

    #[test]
    fn verify_small_probabilities_keep_their_digits() {
        near(family_wise(1e-12, 100.0), 1e-10);
        near(family_wise(0.05, 2.0), 0.0975);
        near(normal_tail(10.0), 7.619_853e-24);
        assert_eq!(chi_squared_tail(1.0, 0.0), 1.0);
        assert!(f_tail(f64::NAN, 1.0, 1.0).is_nan());
    }
}
