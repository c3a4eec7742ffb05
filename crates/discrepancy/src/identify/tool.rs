//! Modes of tool, holder and spindle from FRFs at the tool tip.
//!
//! A mode that lies above all of the arm's is one of what the arm holds. Its participation in an
//! FRF from direction e to direction r is (eᵀφ)(rᵀφ), φ being the mass-normalised shape at the tip;
//! the symmetric matrix φφᵀ follows from all FRFs by least squares, and φ as its largest
//! eigenvector. What was measured swings against the arm's mass M along φ; with its foot held (as a
//! scenario says it, `docs/physics/tool_modes.md`) the mode has, for n = φ/|φ| and 1/M = nᵀJM⁻¹Jᵀn,
//!
//! m = M/(1 + φ²M), ω = ω' √(1 − m/M), ζ = ζ' √(1 − m/M), k = ω² m.

use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector3};
use serde::Serialize;
use truecut_scenario::identification::{Axes, FrameId};
use truecut_sim::SimError;
use truecut_sim::elastic::ElasticArm;

use super::IdentifyError;
use super::frf::Frf;
use super::modal::{MeasuredMode, ModalFit};

mod units;

pub use units::doubt_of_units;

/// Directions of which one has less than this part across the others are one direction.
const SAME: f64 = 0.05;
/// Where the blow strikes, a mode answers within so much of its phase: others would drive it.
const LARGEST_PHASE_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// Part of a mode's largest participation from which its phase is looked at.
const LEAST_SHARE: f64 = 0.1;

/// A mode as `[[process.milling.cutter.mode]]` says it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ToolMode {
    /// With the foot held, Hz.
    pub frequency_hz: f64,
    /// With the foot held.
    pub damping_ratio: f64,
    /// As a force at the tip meets it, N/m.
    pub stiffness_n_per_m: f64,
    /// Of length 1, in the tool frame.
    pub direction: [f64; 3],
    /// As it was measured on the arm, Hz.
    pub measured_hz: f64,
    /// Second largest eigenvalue of the matrix of participations over the largest: 0 for a mode
    /// that moves along a line.
    pub off_its_line: f64,
}

/// An identification that fails for the data, or for the arm.
#[derive(Debug, thiserror::Error)]
pub enum ToolError {
    #[error("{0}")]
    /// Unusable data, at a key of the file.
    Data(#[from] IdentifyError),
    #[error("{0}")]
    /// An arm without modes.
    Arm(#[from] SimError),
}

/// The modes of a fit that lie above the arm's, slowest first; `keys` are those of the FRFs in the
/// file.
///
/// # Errors
/// FRFs that are not at the tool tip, directions without an FRF from one to the other, an FRF that
/// does not follow its force; an arm without modes.
pub fn tool_modes(
    frfs: &[Frf],
    keys: &[String],
    fit: &ModalFit,
    arm: &ElasticArm,
    axes: Axes,
) -> Result<Vec<ToolMode>, ToolError> {
    let tool_from_world = arm.world_from_axes(arm.posture(), Axes::Tool).transpose();
    let tool_from_axes = tool_from_world * arm.world_from_axes(arm.posture(), axes);
    let mut lines = Vec::new();
    for (frf, key) in frfs.iter().zip(keys) {
        for (point, name) in [(&frf.excitation, "excitation"), (&frf.response, "response")] {
            if point.frame != FrameId::Tool || point.offset_m != [0.0; 3] {
                let key = format!("{key}.{name}");
                let message = format!(
                    "`{key}` is not at the tool point, but must be: modes.tool_modes is about the tool's tip"
                );
                return Err(IdentifyError::new(key, message).into());
            }
        }
        let turned = |direction: [f64; 3]| tool_from_axes * Vector3::from(direction);
        lines.push([
            turned(frf.excitation.direction),
            turned(frf.response.direction),
        ]);
    }
    let basis = basis(&lines)?;
    let fastest_hz = (arm.modes()?.iter()).fold(0.0, |most: f64, mode| most.max(mode.frequency_hz));
    let above = fit
        .modes
        .iter()
        .filter(|mode| mode.frequency_hz[0] > fastest_hz);
    let mut found = Vec::new();
    for mode in above {
        follows_its_force(mode, &lines, frfs, keys)?;
        let (shape, off_its_line) = shape(mode, &lines, &basis)
            .ok_or_else(|| IdentifyError::new("modes", format!(
                "no shape fits the mode at {:.1} Hz: its participations contradict each other; is a sign or a direction the other way round?",
                mode.frequency_hz[0]
            )))?;
        let direction = shape.normalize();
        let arm_kg = arm.mass_at_tool_kg(&direction)?;
        let mass_kg = arm_kg / (1.0 + shape.norm_squared() * arm_kg);
        let held = (1.0 - mass_kg / arm_kg).sqrt();
        let hz = mode.frequency_hz[0] * held;
        found.push(ToolMode {
            frequency_hz: hz,
            damping_ratio: mode.damping_ratio[0] * held,
            stiffness_n_per_m: (std::f64::consts::TAU * hz).powi(2) * mass_kg,
            direction: direction.into(),
            measured_hz: mode.frequency_hz[0],
            off_its_line,
        });
    }
    Ok(found)
}

/// An orthonormal basis of the directions that were struck, as columns; each pair of them needs an
/// FRF from one to the other.
fn basis(lines: &[[Vector3<f64>; 2]]) -> Result<DMatrix<f64>, IdentifyError> {
    let mut axes: Vec<Vector3<f64>> = Vec::new();
    for direction in lines.iter().flatten() {
        let across = axes
            .iter()
            .fold(*direction, |rest, axis| rest - axis * axis.dot(direction));
        if across.norm() > SAME {
            axes.push(across.normalize());
        }
    }
    let columns: Vec<DVector<f64>> = axes
        .iter()
        .map(|axis| DVector::from_column_slice(axis.as_slice()))
        .collect();
    let basis = DMatrix::from_columns(&columns);
    let design = design(lines, &basis);
    let unknowns = design.ncols();
    let singular = design.singular_values();
    let rank = singular
        .iter()
        .filter(|value| **value > SAME * singular[0])
        .count();
    if rank < unknowns {
        return Err(IdentifyError::new(
            "modes.tool_modes",
            format!(
                "the FRFs span {} directions at the tool, but give only {rank} of the {unknowns} participations that these have: cross \
                 terms are missing, FRFs from each direction to itself and to the others are needed",
                axes.len()
            ),
        ));
    }
    Ok(basis)
}

/// By FRF, what each element of the upper triangle of a symmetric matrix in the basis contributes.
fn design(lines: &[[Vector3<f64>; 2]], basis: &DMatrix<f64>) -> DMatrix<f64> {
    let n = basis.ncols();
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|a| (a..n).map(move |b| (a, b))).collect();
    DMatrix::from_fn(lines.len(), pairs.len(), |row, column| {
        let (a, b) = pairs[column];
        let part = |line: &Vector3<f64>, axis: usize| {
            line.iter()
                .zip(basis.column(axis).iter())
                .map(|(x, y)| x * y)
                .sum::<f64>()
        };
        let [e, r] = &lines[row];
        let mut sum = part(e, a) * part(r, b);
        if a != b {
            sum += part(e, b) * part(r, a);
        }
        sum
    })
}

/// Shape at the tip, kg^-½, in the axes of the lines, and how far the participations are off a
/// line.
fn shape(
    mode: &MeasuredMode,
    lines: &[[Vector3<f64>; 2]],
    basis: &DMatrix<f64>,
) -> Option<(Vector3<f64>, f64)> {
    let design = design(lines, basis);
    let right = DVector::from_iterator(lines.len(), mode.participation.iter().map(|p| p.re));
    let upper = design.svd(true, true).solve(&right, 1e-12).ok()?;
    let n = basis.ncols();
    let mut matrix = DMatrix::zeros(n, n);
    let mut next = upper.iter();
    for a in 0..n {
        for b in a..n {
            let value = *next.next()?;
            matrix[(a, b)] = value;
            matrix[(b, a)] = value;
        }
    }
    let eigen = SymmetricEigen::new(matrix);
    let (at, largest) = eigen.eigenvalues.argmax();
    if largest <= 0.0 {
        return None;
    }
    let others = eigen
        .eigenvalues
        .iter()
        .enumerate()
        .filter(|(i, _)| *i != at);
    let second = others.map(|(_, value)| value.abs()).fold(0.0, f64::max);
    let along = basis * eigen.eigenvectors.column(at) * largest.sqrt();
    Some((Vector3::new(along[0], along[1], along[2]), second / largest))
}

/// Refuses an FRF whose point of the blow does not follow the force in a mode.
fn follows_its_force(
    mode: &MeasuredMode,
    lines: &[[Vector3<f64>; 2]],
    frfs: &[Frf],
    keys: &[String],
) -> Result<(), IdentifyError> {
    let largest = mode
        .participation
        .iter()
        .map(|p| p.norm())
        .fold(0.0, f64::max);
    for (m, [struck, seen]) in lines.iter().enumerate() {
        let along = struck.dot(seen);
        let own = mode.participation[m] * along.signum();
        let counts = along.abs() > 1.0 - SAME && own.norm() > LEAST_SHARE * largest;
        if counts && own.arg().abs() > LARGEST_PHASE_RAD {
            return Err(IdentifyError::new(
                format!("{}.file", keys[m]),
                format!(
                    "{}: at the mode of {:.1} Hz the struck point answers {:.0} degrees off its force, but must within {:.0}: the FRF is \
                     not causal, or a sign or a unit is another",
                    frfs[m].source,
                    mode.frequency_hz[0],
                    own.arg().to_degrees(),
                    LARGEST_PHASE_RAD.to_degrees()
                ),
            ));
        }
    }
    Ok(())
}

/// Entries of a milling scenario.
pub fn entries(modes: &[ToolMode]) -> String {
    let entry = |mode: &ToolMode| {
        let [x, y, z] = mode.direction;
        format!(
            "\n[[process.milling.cutter.mode]]\nfrequency_hz = {:.2}\ndamping_ratio = {:.6}\nstiffness_n_per_um = {:.5}\ndirection = \
             [{x:.5}, {y:.5}, {z:.5}]\n",
            mode.frequency_hz,
            mode.damping_ratio,
            mode.stiffness_n_per_m * 1e-6
        )
    };
    let entries: String = modes.iter().map(entry).collect();
    format!(
        "# Modes of tool, holder and spindle, their foot held; entries of a milling scenario.\n{entries}"
    )
}
