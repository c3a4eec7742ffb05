//! How far two recordings are apart.

use crate::recording::{Recording, UnknownName};
use crate::reduce::{max, range};
use crate::spectrum::resample;
use crate::window::Window;

/// The distance of one quantity (a channel, or several as components of a vector) between two
/// recordings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Root of the mean square distance, in the channels' unit.
    pub rmse: f64,
    /// `rmse` over the range (largest minus smallest) of the reference; of a vector, over the
    /// diagonal of the box that its components' ranges span. This is the NRMSE of the cross-checks.
    pub nrmse: f64,
    /// `rmse` over the RMS of the reference; for a sine 2√2 times `nrmse`.
    pub relative_rms_error: f64,
    /// RMS of the other over RMS of the reference.
    pub rms_ratio: f64,
    /// The largest distance at any time, in the channels' unit.
    pub max_error: f64,
    /// Rows of the reference that were compared.
    pub rows: usize,
}

/// Compares quantities at the reference's times, as far as both recordings reach and the window
/// allows; the other is interpolated linearly. NaN in either gives NaN everywhere.
///
/// # Errors
/// A channel that one of them lacks; components of different units; no time in common.
pub fn compare(
    reference: &Recording,
    other: &Recording,
    channels: &[&str],
    window: Window,
) -> Result<Deviation, CompareError> {
    let rows = common_rows(reference, other, window)?;
    let time_s = &reference.time_s[rows.clone()];
    let mut errors = vec![0.0; rows.len()];
    let mut own = Squares::default();
    let mut others = Squares::default();
    let mut diagonal = Squares::default();
    for name in channels {
        let unit = [reference, other]
            .map(|recording| recording.header.channel(name).map(|channel| channel.unit));
        let [unit, other_unit] = unit;
        if unit? != other_unit? {
            return Err(CompareError::Units((*name).to_owned()));
        }
        let expected = &reference.channel(name)?[rows.clone()];
        let found = resample(&other.time_s, other.channel(name)?, time_s);
        diagonal.add(range(expected));
        for (row, (expected, found)) in expected.iter().zip(&found).enumerate() {
            errors[row] += (found - expected).powi(2);
            own.add(*expected);
            others.add(*found);
        }
    }
    let rmse = (errors.iter().sum::<f64>() / rows.len() as f64).sqrt();
    Ok(Deviation {
        rmse,
        nrmse: quotient(rmse, diagonal.0.sqrt()),
        relative_rms_error: quotient(rmse, own.rms(rows.len())),
        rms_ratio: quotient(others.rms(rows.len()), own.rms(rows.len())),
        max_error: max(&errors).sqrt(),
        rows: rows.len(),
    })
}

#[derive(Default)]
struct Squares(f64);

impl Squares {
    fn add(&mut self, value: f64) {
        self.0 += value * value;
    }

    fn rms(&self, rows: usize) -> f64 {
        (self.0 / rows as f64).sqrt()
    }
}

/// Nothing apart is 0 even of nothing; something apart from nothing is infinite.
fn quotient(numerator: f64, denominator: f64) -> f64 {
    if numerator == 0.0 && denominator == 0.0 {
        0.0
    } else {
        numerator / denominator
    }
}

fn common_rows(
    reference: &Recording,
    other: &Recording,
    window: Window,
) -> Result<std::ops::Range<usize>, CompareError> {
    let (Some(&first_s), Some(&last_s)) = (other.time_s.first(), other.time_s.last()) else {
        return Err(CompareError::NoCommonTime);
    };
    let overlap = Window {
        from_s: Some(first_s),
        to_s: Some(last_s),
        ..Window::ALL
    }
    .rows(&reference.time_s);
    let wanted = window.rows(&reference.time_s);
    let rows = overlap.start.max(wanted.start)..overlap.end.min(wanted.end);
    if rows.is_empty() {
        Err(CompareError::NoCommonTime)
    } else {
        Ok(rows)
    }
}

/// Recordings that cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    /// A channel that one of them lacks.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// The same name, another unit.
    #[error("channel \"{0}\" has different units in the two recordings")]
    Units(String),
    /// They do not overlap within the window.
    #[error("the recordings have no time in common within the window")]
    NoCommonTime,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{ChannelSpec, Header};
    use crate::unit::Unit;

    fn recording(step_s: f64, rows: usize, channels: &[(&str, &dyn Fn(f64) -> f64)]) -> Recording {
        let time_s: Vec<f64> = (0..rows).map(|row| row as f64 * step_s).collect();
        let specs = channels
            .iter()
            .map(|(name, _)| ChannelSpec::new(*name, Unit::Metre, ""))
            .collect();
        let columns = channels
            .iter()
            .map(|(_, f)| time_s.iter().map(|&t| f(t)).collect())
            .collect();
        Recording {
            header: Header {
                channels: specs,
                ..Header::default()
            },
            time_s,
            columns,
            ..Recording::default()
        }
    }

    #[test]
    fn verify_a_sine_that_is_one_percent_larger() {
        let omega = std::f64::consts::TAU * 5.0;
        let reference = recording(1e-3, 2001, &[("y", &|t| (omega * t).sin())]);
        let other = recording(1e-3, 2001, &[("y", &|t| 1.01 * (omega * t).sin())]);
        let deviation = compare(&reference, &other, &["y"], Window::ALL).unwrap();
        // rmse = 0.01/√2, over the range of 2; 2001 rows hold one zero more than ten periods, hence
        // 1e-3.
        assert!(
            (deviation.nrmse / (0.01 / 8.0_f64.sqrt()) - 1.0).abs() < 1e-3,
            "{deviation:?}"
        );
        assert!((deviation.relative_rms_error - 0.01).abs() < 1e-12);
        assert!((deviation.rms_ratio - 1.01).abs() < 1e-12);
        assert!((deviation.max_error - 0.01).abs() < 1e-12);
    }

    #[test]
    fn verify_other_time_bases_and_lengths() {
        let line: &dyn Fn(f64) -> f64 = &|t| 2.0 * t;
        let reference = recording(1e-3, 1000, &[("y", line)]);
        let other = recording(7e-4, 1000, &[("y", line)]); // ends earlier
        let deviation = compare(&reference, &other, &["y"], Window::ALL).unwrap();
        assert_eq!(deviation.rows, 700, "up to 0.6993 s");
        assert!(deviation.rmse < 1e-14);
    }

    /// A component that hardly moves is judged by the vector's size, not by its own.
    #[test]
    fn verify_components_are_compared_as_a_vector() {
        let circle: [(&str, &dyn Fn(f64) -> f64); 2] =
            [("y", &|t| t.sin()), ("z", &|t| 1e-9 * t.cos())];
        let moved: [(&str, &dyn Fn(f64) -> f64); 2] =
            [("y", &|t| t.sin()), ("z", &|t| 2e-9 * t.cos())];
        let (a, b) = (
            recording(0.01, 1000, &circle),
            recording(0.01, 1000, &moved),
        );
        assert!(compare(&a, &b, &["z"], Window::ALL).unwrap().nrmse > 0.3);
        assert!(compare(&a, &b, &["y", "z"], Window::ALL).unwrap().nrmse < 1e-9);
    }

    #[test]
    fn faults_are_told() {
        let a = recording(0.1, 10, &[("tool.displacement_y", &|_| 0.0)]);
        let empty = recording(0.1, 0, &[("tool.displacement_y", &|_| 0.0)]);
        assert_eq!(
            compare(&a, &empty, &["tool.displacement_y"], Window::ALL),
            Err(CompareError::NoCommonTime)
        );
        assert!(matches!(
            compare(&a, &a, &["tool.displacement_x"], Window::ALL),
            Err(CompareError::Unknown(_))
        ));
        let mut newton = a.clone();
        newton.header.channels[0].unit = Unit::Newton;
        assert!(matches!(
            compare(&a, &newton, &["tool.displacement_y"], Window::ALL),
            Err(CompareError::Units(_))
        ));
        let mut bad = a.clone();
        bad.columns[0][4] = f64::NAN;
        assert!(
            compare(&a, &bad, &["tool.displacement_y"], Window::ALL)
                .unwrap()
                .nrmse
                .is_nan()
        );
    }
}
