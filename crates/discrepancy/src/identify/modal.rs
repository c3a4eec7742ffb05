//! Poles and residues common to FRFs.
//!
//! H(ω) = (iω)^p [ Σ_k ( R_k/(iω − s_k) + R_k*/(iω − s_k*) ) + U − L/ω² ], with the poles
//! s_k = −ζω + iω√(1 − ζ²) common to all FRFs and the residues specific to each; U and L represent
//! modes above and below the band. For given poles residues follow by linear least squares, so
//! that only the poles are optimised (variable projection, `golub1973`, by Levenberg and
//! Marquardt).
//!
//! Modes are added one by one where they reduce the residual most, as long as BIC improves and they
//! matter at their own frequency.

use nalgebra::{Complex, DMatrix, DVector};

use super::frf::Frf;

mod projection;
mod search;

use crate::stats::distributions::t_quantile;
use projection::{Fitted, PoleProblem};

/// A pole by natural frequency and damping ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pole {
    /// |s|, rad/s.
    pub omega: f64,
    /// −Re(s)/|s|.
    pub zeta: f64,
}

/// A mode found in FRFs.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredMode {
    /// Natural frequency, Hz: value, and ends of its 95 % interval.
    pub frequency_hz: [f64; 3],
    /// Damping ratio: value, and ends of its 95 % interval.
    pub damping_ratio: [f64; 3],
    /// Of each FRF: residue times 2iω√(1 − ζ²), 1/kg; real for a mode of proportional damping.
    pub participation: Vec<Complex<f64>>,
}

/// Modes of FRFs.
#[derive(Debug, Clone)]
pub struct ModalFit {
    /// The modes, slowest first.
    pub modes: Vec<MeasuredMode>,
    /// The fit at each frequency of each FRF, in the FRF's quantity.
    pub fitted: Vec<Vec<Complex<f64>>>,
    /// Of each FRF, RMS of the residual over RMS of the values.
    pub residual: Vec<f64>,
    /// Factor by which the intervals were widened because residuals of neighbouring frequencies are
    /// correlated.
    pub widened: f64,
}

/// Fits modes. `count` fixes their number; `damping_shift` (1/s, one for all FRFs) is the decay
/// rate that an exponential window has added. `None` if the data show no mode.
pub fn fit(
    frfs: &[Frf],
    band_hz: [f64; 2],
    count: Option<usize>,
    damping_shift: f64,
) -> Option<ModalFit> {
    let mut problem = PoleProblem::new(frfs);
    let mut poles = search::poles(&problem, band_hz, count);
    if poles.is_empty() {
        return None;
    }
    // Each FRF is weighted by its residual.
    for _ in 0..2 {
        problem.reweigh(&poles);
        poles = search::refine(&problem, &poles);
    }
    poles.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    let best = problem.solve(&poles);
    let widened = problem.correlation(&best).sqrt();
    let covariance = covariance(&problem, &poles, &best)?;
    let half = t_quantile(1.0 - super::CONFIDENCE, problem.degrees(poles.len())) * widened;
    let modes = (poles.iter().enumerate())
        .map(|(k, pole)| {
            let deviation = |i: usize| half * covariance[(i, i)].max(0.0).sqrt();
            measured(
                pole,
                (deviation(2 * k), deviation(2 * k + 1)),
                damping_shift,
                &best,
                k,
            )
        })
        .collect();
    Some(ModalFit {
        modes,
        fitted: problem.curves(&poles, &best),
        residual: problem.relative_residuals(&best),
        widened,
    })
}

/// A mode from a pole with half-intervals of the logarithms of ω and ζ.
fn measured(
    pole: &Pole,
    (of_omega, of_zeta): (f64, f64),
    shift: f64,
    best: &Fitted,
    k: usize,
) -> MeasuredMode {
    let hz = |omega: f64| omega / std::f64::consts::TAU;
    // Decay rate and damped frequency of the fit, less the window's decay rate.
    let decay = pole.zeta * pole.omega - shift;
    let damped = pole.omega * (1.0 - pole.zeta * pole.zeta).max(0.0).sqrt();
    let omega = decay.hypot(damped);
    let spread = pole.zeta * pole.omega * (of_zeta.exp() - 1.0);
    let low = if shift == 0.0 {
        pole.zeta * (-of_zeta).exp()
    } else {
        (decay - spread) / omega
    };
    MeasuredMode {
        frequency_hz: [
            hz(omega),
            hz(omega) * (-of_omega).exp(),
            hz(omega) * of_omega.exp(),
        ],
        damping_ratio: [decay / omega, low, (decay + spread) / omega],
        participation: (best.residues.iter())
            .map(|of_frf| of_frf[k] * Complex::new(0.0, 2.0 * damped))
            .collect(),
    }
}

/// Of the logarithms of ω and ζ, in the order of the poles.
fn covariance(problem: &PoleProblem, poles: &[Pole], best: &Fitted) -> Option<DMatrix<f64>> {
    let jacobian = problem.jacobian(poles, best);
    let inverse = (jacobian.transpose() * &jacobian).try_inverse()?;
    let residual = DVector::from_column_slice(&best.residual);
    Some(inverse * (residual.norm_squared() / problem.degrees(poles.len())))
}
