//! Pairing of measured modes with those of the model.
//!
//! A mode is characterised by its frequency and its participation in each FRF. Pairs are assigned
//! together so that the sum of their distances is least; modes beyond a distance are not paired.

use nalgebra::Complex;
use serde::Serialize;
use truecut_scenario::identification::{FrameId, MotionKind};
use truecut_sim::SimError;
use truecut_sim::elastic::ElasticArm;

use super::frf::Frf;
use super::modal::{MeasuredMode, ModalFit};
use super::tool::ToolMode;
use truecut_scenario::identification::Axes;

/// Frequency ratio with the same distance as orthogonal shapes.
const OCTAVES: f64 = 0.5;
/// Modes beyond this distance are not paired.
const FAR: f64 = 1.6;
/// A mode of the model that contributes less than this to every FRF at its own frequency is not
/// visible.
const LEAST_VISIBLE: f64 = 0.02;

/// Result of a modal identification.
#[derive(Debug, Clone, Serialize)]
pub struct ModesReport {
    /// Frequency band used, Hz.
    pub band_hz: [f64; 2],
    /// The FRFs.
    pub frfs: Vec<FrfReport>,
    /// Measured modes, slowest first, each with its partner.
    pub measured: Vec<Measured>,
    /// All modes of the model.
    pub model: Vec<Modelled>,
    /// Modes of the tool, where they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tool: Vec<ToolMode>,
    /// Factor by which intervals were widened because residuals of neighbouring frequencies are
    /// correlated.
    pub widened: f64,
    /// Notes, one sentence each.
    pub notes: Vec<String>,
}

/// One FRF, with its curves.
#[derive(Debug, Clone, Serialize)]
pub struct FrfReport {
    /// The file.
    pub source: String,
    /// "m/N", "m/s/N" or "m/s^2/N".
    pub unit: &'static str,
    /// RMS of the residual over RMS of the values.
    pub residual: f64,
    /// Mean coherence in the band.
    pub coherence: Option<f64>,
    /// RMS of measured minus model over RMS of measured.
    pub model_error: f64,
    /// Frequency, measured, fitted, model.
    #[serde(skip)]
    pub curves: Vec<(f64, [Complex<f64>; 3])>,
}

/// A measured mode.
#[derive(Debug, Clone, Serialize)]
pub struct Measured {
    /// Natural frequency, Hz.
    pub frequency_hz: Interval,
    /// Damping ratio.
    pub damping_ratio: Interval,
    /// Number of its partner among the model's modes, counted from 0.
    pub partner: Option<usize>,
    /// Modal assurance criterion with it, over the FRFs; none with a single FRF.
    pub mac: Option<f64>,
    /// Frequency of its partner in the model with the identified stiffnesses, Hz.
    pub identified_stiffness_hz: Option<f64>,
}

/// A value and the ends of its 95 % interval.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Interval {
    /// The value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A mode of the model.
#[derive(Debug, Clone, Serialize)]
pub struct Modelled {
    /// Natural frequency, Hz.
    pub frequency_hz: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Whether it is visible in these FRFs and lies in their band.
    pub visible: bool,
    #[serde(skip)]
    participation: Vec<f64>,
}

impl Interval {
    fn new([value, low, high]: [f64; 3]) -> Interval {
        Interval { value, low, high }
    }
}

/// Compares measured modes with those of the arm.
///
/// # Errors
/// An arm without modes: a joint without stiffness, an unstable posture.
pub fn against_model(
    frfs: &[Frf],
    fit: &ModalFit,
    arm: &ElasticArm,
    axes: Axes,
    band_hz: [f64; 2],
) -> Result<ModesReport, SimError> {
    let mut model = modelled(frfs, arm, axes)?;
    let curves: Vec<Vec<Complex<f64>>> = (frfs.iter().enumerate())
        .map(|(m, frf)| {
            let at = |f: &f64| model_value(&model, m, *f, frf.kind);
            frf.frequency_hz.iter().map(at).collect()
        })
        .collect();
    for mode in 0..model.len() {
        model[mode].visible = shows(&model, mode, frfs, band_hz);
    }
    let partners = pair(&fit.modes, &model);
    let measured = (fit.modes.iter().zip(&partners))
        .map(|(mode, partner)| Measured {
            frequency_hz: Interval::new(mode.frequency_hz),
            damping_ratio: Interval::new(mode.damping_ratio),
            partner: *partner,
            mac: partner
                .filter(|_| frfs.len() > 1)
                .map(|k| mac(&mode.participation, &model[k].participation)),
            identified_stiffness_hz: None,
        })
        .collect();
    let mut notes: Vec<String> = frfs.iter().flat_map(|frf| frf.notes.clone()).collect();
    // FRFs of one record share its notes.
    let mut seen = std::collections::BTreeSet::new();
    notes.retain(|note| seen.insert(note.clone()));
    if frfs.len() == 1 && fit.modes.len() > 1 {
        notes.push("with a single FRF modes are paired by frequency and sign alone".to_owned());
    }
    notes.extend(missing(frfs));
    Ok(ModesReport {
        band_hz,
        frfs: (frfs.iter().enumerate())
            .map(|(m, frf)| frf_report(frf, fit, &curves[m], m))
            .collect(),
        measured,
        model,
        tool: Vec::new(),
        widened: fit.widened,
        notes,
    })
}

impl ModesReport {
    /// Adds the frequencies of the model with identified stiffnesses, paired with the same FRFs.
    pub fn add_identified(&mut self, other: &ModesReport) {
        for (mode, counterpart) in self.measured.iter_mut().zip(&other.measured) {
            mode.identified_stiffness_hz = counterpart.partner.map(|k| other.model[k].frequency_hz);
        }
    }
}

fn modelled(frfs: &[Frf], arm: &ElasticArm, axes: Axes) -> Result<Vec<Modelled>, SimError> {
    let rows: Vec<[Vec<f64>; 2]> = (frfs.iter())
        .map(|frf| {
            [
                arm.along(&frf.excitation, axes),
                arm.along(&frf.response, axes),
            ]
        })
        .collect();
    let along =
        |row: &[f64], shape: &[f64]| -> f64 { row.iter().zip(shape).map(|(a, b)| a * b).sum() };
    let modes = arm.modes()?.into_iter().map(|mode| Modelled {
        frequency_hz: mode.frequency_hz,
        damping_ratio: mode.damping_ratio,
        visible: true,
        participation: (rows.iter())
            .map(|[struck, seen]| along(struck, &mode.shape) * along(seen, &mode.shape))
            .collect(),
    });
    Ok(modes.collect())
}

/// Contribution of a mode to an FRF, in the FRF's quantity.
fn contribution(mode: &Modelled, frf: usize, hz: f64, kind: MotionKind) -> Complex<f64> {
    let (own, omega) = (mode.frequency_hz, hz);
    let square = std::f64::consts::TAU.powi(2);
    let denominator = Complex::new(
        square * (own * own - omega * omega),
        square * 2.0 * mode.damping_ratio * own * omega,
    );
    Frf::from_compliance(kind, hz) * mode.participation[frf] / denominator
}

fn model_value(model: &[Modelled], frf: usize, hz: f64, kind: MotionKind) -> Complex<f64> {
    model
        .iter()
        .map(|mode| contribution(mode, frf, hz, kind))
        .sum()
}

fn shows(model: &[Modelled], mode: usize, frfs: &[Frf], band_hz: [f64; 2]) -> bool {
    let hz = model[mode].frequency_hz;
    let share = |m: usize| {
        let own = contribution(&model[mode], m, hz, frfs[m].kind).norm();
        own / model_value(model, m, hz, frfs[m].kind)
            .norm()
            .max(f64::MIN_POSITIVE)
    };
    (band_hz[0]..=band_hz[1]).contains(&hz) && (0..frfs.len()).any(|m| share(m) > LEAST_VISIBLE)
}

/// |aᴴb|²/(|a|²|b|²).
fn mac(measured: &[Complex<f64>], model: &[f64]) -> f64 {
    let dot: Complex<f64> = measured.iter().zip(model).map(|(a, b)| a.conj() * *b).sum();
    let sizes: [f64; 2] = [
        measured.iter().map(|a| a.norm_sqr()).sum(),
        model.iter().map(|b| b * b).sum(),
    ];
    dot.norm_sqr() / (sizes[0] * sizes[1]).max(f64::MIN_POSITIVE)
}

/// Distance of two modes in frequency and shape. With one FRF the shape is a sign.
fn distance(measured: &MeasuredMode, model: &Modelled) -> f64 {
    let octaves = (measured.frequency_hz[0] / model.frequency_hz).log2().abs() / OCTAVES;
    let alike = if measured.participation.len() > 1 {
        mac(&measured.participation, &model.participation)
    } else {
        let same = measured.participation[0].re * model.participation[0] > 0.0;
        f64::from(u8::from(same))
    };
    octaves + (1.0 - alike)
}

/// The partners with the least sum of distances; an unpaired mode costs as much as the farthest
/// pair.
fn pair(measured: &[MeasuredMode], model: &[Modelled]) -> Vec<Option<usize>> {
    let sets = 1usize << model.len();
    // Dynamic programming: least cost so far for each set of used modes of the model, with its
    // choice.
    let mut best = vec![(f64::INFINITY, Vec::new()); sets];
    best[0] = (0.0, Vec::new());
    for mode in measured {
        let mut next: Vec<(f64, Vec<Option<usize>>)> = vec![(f64::INFINITY, Vec::new()); sets];
        for (taken, (cost, choice)) in best.iter().enumerate().filter(|(_, b)| b.0.is_finite()) {
            let mut offer = |set: usize, cost: f64, partner: Option<usize>| {
                if cost < next[set].0 {
                    let mut choice = choice.clone();
                    choice.push(partner);
                    next[set] = (cost, choice);
                }
            };
            offer(taken, cost + FAR, None);
            for (k, one) in model
                .iter()
                .enumerate()
                .filter(|(k, _)| taken & (1 << k) == 0)
            {
                let apart = distance(mode, one) + if one.visible { 0.0 } else { 0.5 * FAR };
                if apart < FAR {
                    offer(taken | (1 << k), cost + apart, Some(k));
                }
            }
        }
        best = next;
    }
    let cheapest = best.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    cheapest.map(|(_, choice)| choice).unwrap_or_default()
}

fn frf_report(frf: &Frf, fit: &ModalFit, model: &[Complex<f64>], m: usize) -> FrfReport {
    let square = |values: &mut dyn Iterator<Item = Complex<f64>>| -> f64 {
        values.map(|value| value.norm_sqr()).sum()
    };
    let all = square(&mut frf.value.iter().copied());
    let off = square(&mut frf.value.iter().zip(model).map(|(a, b)| a - b));
    let curves = (frf.frequency_hz.iter().zip(&frf.value)).zip(fit.fitted[m].iter().zip(model));
    FrfReport {
        source: frf.source.clone(),
        unit: match frf.kind {
            MotionKind::Displacement => "m/N",
            MotionKind::Velocity => "m/s/N",
            MotionKind::Acceleration => "m/s^2/N",
        },
        residual: fit.residual[m],
        coherence: (frf.coherence.as_ref()).map(|c| c.iter().sum::<f64>() / c.len() as f64),
        model_error: (off / all).sqrt(),
        curves: curves
            .map(|((f, h), (fit, model))| (*f, [*h, *fit, *model]))
            .collect(),
    }
}

/// Notes on directions without an FRF: modes along them are not visible.
fn missing(frfs: &[Frf]) -> Option<String> {
    let at_tool = frfs.iter().all(|frf| frf.response.frame == FrameId::Tool);
    let seen = |axis: usize| {
        frfs.iter()
            .any(|frf| frf.response.direction[axis].abs() > 0.3)
    };
    let blind: Vec<&str> = (0..3)
        .filter(|&axis| !seen(axis))
        .map(|axis| ["x", "y", "z"][axis])
        .collect();
    (at_tool && !blind.is_empty() && frfs.len() > 1)
        .then(|| format!("no response was measured along {}", blind.join(" and ")))
}
