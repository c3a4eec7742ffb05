//! FRFs from files.

use std::f64::consts::TAU;

use nalgebra::Complex;
use truecut_recording::measured::Table;
use truecut_scenario::identification::{FrfSpec, FrfValues, HammerPoint, MotionKind};

use super::{IdentifyError, at_row};

/// A frequency response function: motion per force.
#[derive(Debug, Clone)]
pub struct Frf {
    /// The file.
    pub source: String,
    /// Frequencies, rising, Hz.
    pub frequency_hz: Vec<f64>,
    /// m/N, (m/s)/N or (m/s²)/N.
    pub value: Vec<Complex<f64>>,
    /// Standard deviation of the real and of the imaginary part, up to a common factor.
    pub noise: Option<Vec<f64>>,
    /// Coherence, if it is known.
    pub coherence: Option<Vec<f64>>,
    /// Quantity of the motion.
    pub kind: MotionKind,
    /// Point and direction of the blow.
    pub excitation: HammerPoint,
    /// Point and direction of the measured motion.
    pub response: HammerPoint,
    /// Notes on processing, one sentence each.
    pub notes: Vec<String>,
}

/// Fewest frequencies in the band: a mode takes four numbers, the rest of the arm two or three
/// more.
pub const FEWEST: usize = 12;

/// Reads an FRF from a table; the part of it that lies in the band.
///
/// # Errors
/// A missing column, a frequency that does not rise, a value that is no number, too few in the
/// band.
pub fn frf(
    table: &Table,
    spec: &FrfSpec,
    band_hz: [f64; 2],
    key: &str,
) -> Result<Frf, IdentifyError> {
    let column = |name: &str, part: &str| {
        let found = table.column(name);
        found.map_err(|error| IdentifyError::new(format!("{key}.{part}"), error))
    };
    let frequency = column(&spec.frequency.0, "frequency")?;
    let coherence = (spec.coherence.as_ref())
        .map(|name| column(name, "coherence"))
        .transpose()?;
    let (parts, names) = match &spec.values {
        FrfValues::Cartesian(real, imaginary) => (
            [column(real, "real")?, column(imaginary, "imaginary")?],
            ["real", "imaginary"],
        ),
        FrfValues::Polar(magnitude, phase, _) => (
            [column(magnitude, "magnitude")?, column(phase, "phase")?],
            ["magnitude", "phase"],
        ),
    };
    let fail = |row: usize, part: &str, message: String| {
        at_row(table, row, format!("{key}.{part}"), message)
    };
    let mut found = Frf {
        source: table.source.clone(),
        frequency_hz: Vec::new(),
        value: Vec::new(),
        noise: None,
        coherence: coherence.map(|_| Vec::new()),
        kind: spec.kind,
        excitation: spec.excitation,
        response: spec.response,
        notes: Vec::new(),
    };
    let mut before = f64::NEG_INFINITY;
    for row in 0..table.rows() {
        let f = frequency[row] * spec.frequency.1.si_factor;
        if !(f.is_finite() && f > before && f >= 0.0) {
            let message =
                format!("the frequency is {f} Hz, but must be a number, 0 or above, and rise");
            return Err(fail(row, "frequency", message));
        }
        before = f;
        if f < band_hz[0] || f > band_hz[1] || f == 0.0 {
            continue;
        }
        for (part, name) in parts.iter().zip(names) {
            if !part[row].is_finite() {
                return Err(fail(row, name, format!("the {name} part holds no number")));
            }
        }
        let value = match spec.values {
            FrfValues::Cartesian(..) => Complex::new(parts[0][row], parts[1][row]),
            FrfValues::Polar(.., to_rad) => {
                Complex::from_polar(parts[0][row], parts[1][row] * to_rad)
            }
        };
        if let (Some(from), Some(into)) = (coherence, &mut found.coherence) {
            if !(0.0..=1.0 + 1e-9).contains(&from[row]) {
                let message = format!("the coherence is {}, but must lie from 0 to 1", from[row]);
                return Err(fail(row, "coherence", message));
            }
            into.push(from[row].min(1.0));
        }
        found.frequency_hz.push(f);
        found.value.push(value * spec.factor);
    }
    found.check(band_hz, key)?;
    let averages = spec.averages.unwrap_or(1);
    found.noise = (found.coherence.as_ref()).map(|one| noise(&found.value, one, averages));
    Ok(found)
}

impl Frf {
    /// Refuses an FRF that is zero.
    pub(super) fn check(&self, band_hz: [f64; 2], key: &str) -> Result<(), IdentifyError> {
        let count = self.frequency_hz.len();
        let message = if count < FEWEST {
            format!(
                "{}: {count} frequencies lie from {} to {} Hz, but at least {FEWEST} are needed",
                self.source, band_hz[0], band_hz[1]
            )
        } else if self.value.iter().all(|one| one.norm() == 0.0) {
            format!(
                "{}: every value in the band is 0, so that nothing was measured",
                self.source
            )
        } else {
            return Ok(());
        };
        Err(IdentifyError::new(format!("{key}.file"), message))
    }

    /// (iω)^p that converts a compliance into the measured quantity.
    pub fn from_compliance(kind: MotionKind, frequency_hz: f64) -> Complex<f64> {
        let i_omega = Complex::new(0.0, TAU * frequency_hz);
        match kind {
            MotionKind::Displacement => Complex::new(1.0, 0.0),
            MotionKind::Velocity => i_omega,
            MotionKind::Acceleration => i_omega * i_omega,
        }
    }
}

/// Standard deviation from coherence: variance |H|² (1 − γ²)/(2 n γ²) of each part, smoothed since
/// a coherence from few averages scatters. At least a thousandth of |H|, since a coherence of 1 is
/// rounded.
pub(super) fn noise(value: &[Complex<f64>], coherence: &[f64], averages: usize) -> Vec<f64> {
    const HALF: usize = 4;
    let single: Vec<f64> = (value.iter().zip(coherence))
        .map(|(h, c)| h.norm_sqr() * (1.0 - c) / (2.0 * averages as f64 * c.max(1e-3)))
        .collect();
    (0..single.len())
        .map(|i| {
            let near = &single[i.saturating_sub(HALF)..(i + HALF + 1).min(single.len())];
            let mean = near.iter().sum::<f64>() / near.len() as f64;
            mean.sqrt()
                .max(1e-3 * value[i].norm())
                .max(f64::MIN_POSITIVE)
        })
        .collect()
}
