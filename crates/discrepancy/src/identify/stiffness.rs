//! Joint stiffnesses from loads and displacements.
//!
//! The unknowns are the compliances c = 1/K, in which the displacement d = J C Jᵀ w is linear but
//! for gravity and the posture's change under load. Both are exact here: each Gauss-Newton step
//! uses the arm's equilibrium with and without the load, and its derivatives.
//!
//! Identifiability of each joint follows from the singular values of the design (columns of unit
//! length) and from the interval of its compliance: where that contains zero, only a lower bound of
//! the stiffness is known.

use nalgebra::{DMatrix, DVector, Dyn, SVD};
use serde::Serialize;
use truecut_scenario::identification::{StiffnessSpec, Zero};
use truecut_sim::elastic::{ElasticArm, ElasticJoint};

use super::readings::Readings;
use super::{CONFIDENCE, IdentifyError};
use crate::stats::distributions::{chi_squared_tail, t_quantile};

mod design;
mod doubts;
mod notes;

pub use design::Component;
use design::Design;

/// Result of an identification from a load-deflection table.
#[derive(Debug, Clone, Serialize)]
pub struct StiffnessReport {
    /// The file.
    pub source: String,
    /// Number of rows.
    pub loadings: usize,
    /// Number of postures.
    pub postures: usize,
    /// Measured displacements and rotations.
    pub readings: usize,
    /// Degrees of freedom: readings less unknowns.
    pub degrees_of_freedom: usize,
    /// The joints, in chain order.
    pub joints: Vec<JointStiffness>,
    /// Singular values of the design with columns of unit length, largest first.
    pub singular_values: Vec<f64>,
    /// Residuals by measured component.
    pub components: Vec<Component>,
    /// Residual over stated noise (root of the reduced chi-squared), if noise was stated.
    pub residual_over_noise: Option<f64>,
    /// Outlying rows, the worst first.
    pub outliers: Vec<Outlier>,
    /// Steps until convergence.
    pub steps: usize,
    /// Notes, one sentence each.
    pub notes: Vec<String>,
}

/// A joint, identified or not.
#[derive(Debug, Clone, Default, Serialize)]
pub struct JointStiffness {
    /// Name in the URDF.
    pub name: String,
    /// "N m/rad" or "N/m".
    pub unit: &'static str,
    /// Result for the joint.
    pub status: Status,
    /// Stiffness.
    pub value: Option<f64>,
    /// Lower end of its 95 % interval.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// Compliance and its standard error.
    pub compliance: Option<[f64; 2]>,
    /// Value in robot.toml.
    pub nominal: Option<f64>,
    /// Whether that value lies in the interval; none where the stiffnesses explain too little of
    /// what was measured to agree with anything.
    pub agrees: Option<bool>,
    /// Joints whose effect cannot be separated from its own, in these postures and loads.
    pub confused_with: Vec<String>,
}

/// Identifiability of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// A stiffness with an interval.
    Identified,
    /// Stiffer than `low`; noise hides an upper bound.
    LowerBound,
    /// No load acts on it.
    #[default]
    NotLoaded,
    /// Its effect is a combination of those of others.
    NotSeparable,
    /// A significantly negative compliance: loads or displacements are wrong.
    Contradictory,
}

/// An outlying row.
#[derive(Debug, Clone, Serialize)]
pub struct Outlier {
    /// Its line in the file.
    pub place: String,
    /// Residual over its standard deviation.
    pub sigmas: f64,
}

/// Singular values below this fraction of the largest count as zero: not determined by the
/// geometry.
const RANK: f64 = 1e-7;
/// Directions below this fraction of the largest singular value do not move the point of
/// linearisation.
const VAGUE: f64 = 0.05;
/// Largest fraction of a joint's effect in undetermined directions for it to count as determined.
const SHARE: f64 = 1e-6;
/// Compliances up to this count as zero, rad/(N m) or m/N.
const RIGID: f64 = 1e-11;
const MAX_STEPS: usize = 40;
/// Convergence: relative change of compliances.
const STILL: f64 = 1e-9;

impl StiffnessReport {
    /// Stiffnesses of all joints: identified where they are, else those of the file. `None` if
    /// nothing was identified or a joint has neither.
    pub fn updated(&self) -> Option<Vec<f64>> {
        let any = self.joints.iter().any(|joint| joint.value.is_some());
        let all = self
            .joints
            .iter()
            .map(|joint| joint.value.or(joint.nominal));
        any.then(|| all.collect()).flatten()
    }
}

/// Compliances of the robot's file, if it has all.
fn nominal(joints: &[ElasticJoint]) -> Option<Vec<f64>> {
    let stiffnesses = joints.iter().map(|joint| joint.stiffness);
    stiffnesses.map(|own| own.map(|own| 1.0 / own)).collect()
}

/// Identifies the stiffness of every joint.
///
/// # Errors
/// Too few readings, no load at all, or an arm without equilibrium under the loads.
pub fn identify(
    readings: &Readings,
    spec: &StiffnessSpec,
    arm: &ElasticArm,
) -> Result<StiffnessReport, IdentifyError> {
    let joints = arm.joints();
    let mut compliance = vec![RIGID; joints.len()];
    let mut steps = 0;
    let (design, solution) = loop {
        let design = Design::new(readings, spec, arm, &compliance).map_err(|error| {
            let held = nominal(&joints).and_then(|own| Design::new(readings, spec, arm, &own).ok());
            doubts::of_no_rest(error, held.and_then(|design| design.times_predicted()))
        })?;
        let solution = Solution::new(&design)?;
        steps += 1;
        let before = compliance.clone();
        compliance = solution.point.iter().map(|c| c.max(RIGID)).collect();
        let scale = compliance.iter().copied().fold(0.0, f64::max);
        let pairs = || compliance.iter().zip(&before);
        if pairs().all(|(now, then)| (now - then).abs() <= STILL * (now + 1e-3 * scale)) {
            break (design, solution);
        }
        if steps == MAX_STEPS {
            let message = format!(
                "fit failed: the compliances do not stand still after {MAX_STEPS} steps; are the \
                 units right?"
            );
            return Err(IdentifyError::new("stiffness", message));
        }
    };
    report(readings, spec, arm, &joints, (&design, &solution, steps))
}

/// Least squares on a design, with undetermined directions.
struct Solution {
    compliance: Vec<f64>,
    /// Compliances of the next linearisation: without poorly determined directions, which noise
    /// would dominate.
    point: Vec<f64>,
    standard_error: Vec<f64>,
    /// Correlations of the estimates.
    correlation: DMatrix<f64>,
    singular_values: Vec<f64>,
    /// Of each joint: whether a load acts on it, and the undetermined fraction of its effect.
    loaded: Vec<bool>,
    open: DMatrix<f64>,
    residual: DVector<f64>,
    degrees: usize,
    /// Reduced chi-squared, with the stated or a common noise.
    variance: f64,
}

/// A design with columns of unit length, and its singular values.
struct UnitDesign {
    matrix: DMatrix<f64>,
    /// Lengths of the columns; infinite for a joint that no load acts on.
    norms: Vec<f64>,
    svd: SVD<f64, Dyn, Dyn>,
}

impl UnitDesign {
    fn new(design: &Design) -> Result<UnitDesign, IdentifyError> {
        let norms = design.matrix.column_iter().map(|c| c.norm());
        let largest = norms.clone().fold(0.0, f64::max);
        if largest == 0.0 {
            let message = "no load of the table turns any joint: every force and moment is zero, \
                           or the same in all rows of a posture";
            return Err(IdentifyError::new("stiffness", message));
        }
        let is_loaded = |norm: f64| norm > 1e-9 * largest;
        let norms: Vec<f64> = norms
            .map(|norm| if is_loaded(norm) { norm } else { f64::INFINITY })
            .collect();
        let (rows, joints) = design.matrix.shape();
        let matrix = DMatrix::from_fn(rows, joints, |r, c| design.matrix[(r, c)] / norms[c]);
        let svd = matrix.clone().svd(true, true);
        Ok(UnitDesign { matrix, norms, svd })
    }

    /// Determined directions: singular value and both singular vectors.
    fn directions(&self) -> impl Iterator<Item = (f64, DVector<f64>, DVector<f64>)> {
        let values = self.svd.singular_values.iter().copied().enumerate();
        let limit = RANK * self.svd.singular_values.max();
        let vectors = self.svd.u.as_ref().zip(self.svd.v_t.as_ref());
        vectors.into_iter().flat_map(move |(u, v_t)| {
            let determined = values.clone().filter(move |(_, s)| *s > limit);
            determined.map(|(k, s)| (s, u.column(k).into_owned(), v_t.row(k).transpose()))
        })
    }
}

impl Solution {
    fn new(design: &Design) -> Result<Solution, IdentifyError> {
        let unit = UnitDesign::new(design)?;
        let (norms, joints) = (&unit.norms, unit.norms.len());
        let mut scaled = DVector::zeros(joints);
        let mut firm = DVector::zeros(joints);
        let mut covariance = DMatrix::zeros(joints, joints);
        let mut known = DMatrix::zeros(joints, joints);
        let mut rank = 0;
        for (s, u, v) in unit.directions() {
            let share = &v * (u.dot(&design.target) / s);
            if s > VAGUE * unit.svd.singular_values.max() {
                firm += &share;
            }
            scaled += share;
            covariance += &v * v.transpose() / (s * s);
            known += &v * v.transpose();
            rank += 1;
        }
        let residual = &design.target - &unit.matrix * &scaled;
        let degrees = degrees_of_freedom(design, rank)?;
        let variance = residual.norm_squared() / degrees as f64;
        let deviation = |k: usize| covariance[(k, k)].sqrt();
        let mut singular_values: Vec<f64> = unit.svd.singular_values.iter().copied().collect();
        singular_values.sort_by(|a, b| b.total_cmp(a));
        Ok(Solution {
            compliance: (0..joints).map(|k| scaled[k] / norms[k]).collect(),
            point: (0..joints).map(|k| firm[k] / norms[k]).collect(),
            standard_error: (0..joints)
                .map(|k| variance.sqrt() * deviation(k) / norms[k])
                .collect(),
            correlation: DMatrix::from_fn(joints, joints, |i, j| {
                covariance[(i, j)] / (deviation(i) * deviation(j)).max(f64::MIN_POSITIVE)
            }),
            singular_values,
            open: DMatrix::identity(joints, joints) - known,
            loaded: norms.iter().map(|norm| norm.is_finite()).collect(),
            residual,
            degrees,
            variance,
        })
    }

    fn joint(&self, k: usize, joint: &ElasticJoint, names: &[&str]) -> JointStiffness {
        let others = |related: &dyn Fn(usize) -> bool| -> Vec<String> {
            let others = (0..names.len()).filter(|&i| i != k && related(i));
            others.map(|i| names[i].to_owned()).collect()
        };
        let mut found = JointStiffness {
            name: joint.name.clone(),
            unit: if joint.rotary { "N m/rad" } else { "N/m" },
            nominal: joint.stiffness,
            ..JointStiffness::default()
        };
        if !self.loaded[k] {
            return found;
        }
        if self.open[(k, k)] > SHARE {
            found.status = Status::NotSeparable;
            found.confused_with = others(&|i| self.loaded[i] && self.open[(k, i)].abs() > SHARE);
            return found;
        }
        let (c, error) = (self.compliance[k], self.standard_error[k]);
        let half = t_quantile(1.0 - CONFIDENCE, self.degrees as f64) * error;
        found.compliance = Some([c, error]);
        if c + half <= 0.0 {
            found.status = Status::Contradictory;
            return found;
        }
        found.low = Some(1.0 / (c + half));
        found.status = Status::LowerBound;
        if c > half {
            found.status = Status::Identified;
            found.value = Some(1.0 / c);
            found.high = Some(1.0 / (c - half));
        } else {
            found.confused_with = others(&|i| self.correlation[(k, i)].abs() > 0.9);
        }
        found.agrees = (joint.stiffness)
            .map(|nominal| ((1.0 / nominal) - c).abs() <= half * (1.0 + 1e-12) + 1e-12 * c.abs());
        found
    }
}

/// Readings beyond the unknowns.
fn degrees_of_freedom(design: &Design, rank: usize) -> Result<usize, IdentifyError> {
    let (readings, zeros) = (design.readings, design.zeros);
    let degrees = readings.checked_sub(rank + zeros).filter(|d| *d > 0);
    degrees.ok_or_else(|| {
        let message = format!(
            "{readings} readings for {rank} stiffnesses and {zeros} zeros: more are needed for an \
             error estimate"
        );
        IdentifyError::new("stiffness.file", message)
    })
}

fn report(
    readings: &Readings,
    spec: &StiffnessSpec,
    arm: &ElasticArm,
    joints: &[ElasticJoint],
    (design, solution, steps): (&Design, &Solution, usize),
) -> Result<StiffnessReport, IdentifyError> {
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    let estimates: Vec<JointStiffness> = (joints.iter().enumerate())
        .map(|(k, joint)| solution.joint(k, joint, &names))
        .collect();
    // Predictions need a stiffness for every joint.
    let predicted = nominal(joints)
        .map(|nominal| Design::new(readings, spec, arm, &nominal))
        .transpose()?;
    let stated = readings.noise.iter().any(Option::is_some);
    let over = stated.then(|| solution.variance.sqrt());
    let components = design.components(&solution.residual, predicted.as_ref(), &readings.noise);
    let outliers = design.outliers(&solution.residual, solution.variance, readings);
    let mut report = StiffnessReport {
        source: readings.source.clone(),
        loadings: readings.loadings.len(),
        postures: readings.postures,
        readings: design.readings,
        degrees_of_freedom: solution.degrees,
        joints: estimates,
        singular_values: solution.singular_values.clone(),
        components,
        residual_over_noise: over,
        outliers,
        steps,
        notes: Vec::new(),
    };
    let excess = chi_squared_tail(
        solution.variance * solution.degrees as f64,
        solution.degrees as f64,
    );
    let beyond = stated && excess < 0.01;
    report.notes = notes::notes(&report, beyond, spec.zero == Zero::Unknown);
    report.notes.extend(doubts::of_angles(readings, spec));
    if let Some(told) = doubts::of_explanation(&report) {
        report.joints.iter_mut().for_each(|one| one.agrees = None);
        report.notes.insert(0, told);
    }
    Ok(report)
}
