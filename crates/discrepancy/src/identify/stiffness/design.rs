//! The least-squares problem at given compliances.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use serde::Serialize;
use truecut_scenario::identification::{StiffnessSpec, Zero};
use truecut_sim::elastic::ElasticArm;

use super::Outlier;
use crate::identify::IdentifyError;
use crate::identify::readings::Readings;

/// Residuals of one measured component, and its values for a figure.
#[derive(Debug, Clone, Serialize)]
pub struct Component {
    /// displacement_x, …
    pub channel: String,
    /// "m" or "rad".
    pub unit: &'static str,
    /// Readings.
    pub readings: usize,
    /// RMS of the measured values, relative to the zero.
    pub measured_rms: f64,
    /// RMS of the residual with the stiffnesses of robot.toml.
    pub nominal_residual_rms: Option<f64>,
    /// RMS of the residual with the identified ones.
    pub residual_rms: f64,
    /// Stated noise.
    pub noise: Option<f64>,
    /// Measured, of the nominal model, identified; a row for each reading.
    #[serde(skip)]
    pub points: Vec<[f64; 3]>,
}

/// Weighted readings as a function of compliances: `matrix · c = target` up to noise.
pub(super) struct Design {
    pub matrix: DMatrix<f64>,
    pub target: DVector<f64>,
    /// Number of readings.
    pub readings: usize,
    pub zeros: usize,
    /// Of each row: loading, component, weight, measured and predicted at the compliances.
    rows: Vec<Row>,
}

#[derive(Clone, Copy)]
struct Row {
    loading: usize,
    component: usize,
    noise: f64,
    measured: f64,
    predicted: f64,
}

impl Design {
    /// How many times what is predicted the measured values are, by least squares.
    pub fn times_predicted(&self) -> Option<f64> {
        let sum = |of: &dyn Fn(&Row) -> f64| self.rows.iter().map(of).sum::<f64>();
        let predicted = sum(&|row| (row.predicted / row.noise).powi(2));
        let both = sum(&|row| row.measured * row.predicted / row.noise.powi(2));
        (predicted > 0.0).then_some(both / predicted)
    }

    pub fn new(
        readings: &Readings,
        spec: &StiffnessSpec,
        arm: &ElasticArm,
        compliance: &[f64],
    ) -> Result<Design, IdentifyError> {
        let stiffness: Vec<f64> = compliance.iter().map(|c| 1.0 / c).collect();
        let arm = arm.with_stiffness(&stiffness);
        let joints = compliance.len();
        let (mut rows, mut lines) = (Vec::new(), Vec::new());
        for (index, loading) in readings.loadings.iter().enumerate() {
            let found = arm
                .deflection(&loading.command, spec.loaded, spec.observed, loading.wrench)
                .map_err(|error| {
                    let message = format!(
                        "{}: {}: the arm finds no rest under this load ({error}); are force and \
                         displacement in \
                         the units given?",
                        readings.source, loading.place
                    );
                    IdentifyError::new("stiffness", message)
                })?;
            let into = |component: usize, pick: &dyn Fn(usize) -> f64| {
                in_axes(&loading.world_from_axes, component, pick)
            };
            for &(component, measured) in &loading.answers {
                rows.push(Row {
                    loading: index,
                    component,
                    noise: readings.noise[component].unwrap_or(1.0),
                    measured,
                    predicted: into(component, &|axis| found.motion[axis]),
                });
                lines.extend(
                    (0..joints).map(|k| into(component, &|axis| found.by_compliance[(axis, k)])),
                );
            }
        }
        let mut matrix = DMatrix::from_row_slice(rows.len(), joints, &lines);
        let zeros = match spec.zero {
            Zero::Unloaded => 0,
            Zero::Unknown => remove_zeros(readings, &mut rows, &mut matrix),
        };
        let current = DVector::from_column_slice(compliance);
        let linear = &matrix * current;
        let target = DVector::from_iterator(
            rows.len(),
            (rows.iter().zip(&linear))
                .map(|(row, linear)| (row.measured - row.predicted + linear) / row.noise),
        );
        for (row, mut line) in rows.iter().zip(matrix.row_iter_mut()) {
            line /= row.noise;
        }
        Ok(Design {
            matrix,
            target,
            readings: rows.len(),
            zeros,
            rows,
        })
    }

    /// Residuals by component; `residual` is in units of the noise.
    pub fn components(
        &self,
        residual: &DVector<f64>,
        nominal: Option<&Design>,
        noise: &[Option<f64>; 6],
    ) -> Vec<Component> {
        const NAMES: [&str; 6] = [
            "displacement_x",
            "displacement_y",
            "displacement_z",
            "rotation_x",
            "rotation_y",
            "rotation_z",
        ];
        let mut found = Vec::new();
        for component in 0..6 {
            let points: Vec<[f64; 3]> = (self.rows.iter().enumerate())
                .filter(|(_, row)| row.component == component)
                .map(|(i, row)| {
                    let of_nominal = nominal.map_or(f64::NAN, |one| one.rows[i].predicted);
                    let fitted = row.measured - residual[i] * row.noise;
                    [row.measured, of_nominal, fitted]
                })
                .collect();
            if points.is_empty() {
                continue;
            }
            let rms = |pick: &dyn Fn(&[f64; 3]) -> f64| {
                let sum: f64 = points.iter().map(|one| pick(one).powi(2)).sum();
                (sum / points.len() as f64).sqrt()
            };
            found.push(Component {
                channel: NAMES[component].to_owned(),
                unit: if component < 3 { "m" } else { "rad" },
                readings: points.len(),
                measured_rms: rms(&|one| one[0]),
                nominal_residual_rms: nominal.map(|_| rms(&|one| one[0] - one[1])),
                residual_rms: rms(&|one| one[0] - one[2]),
                noise: noise[component],
                points,
            });
        }
        found
    }

    /// Rows with a residual that normal noise gives in one table of a thousand.
    pub fn outliers(
        &self,
        residual: &DVector<f64>,
        variance: f64,
        readings: &Readings,
    ) -> Vec<Outlier> {
        let tail = 5e-4 / self.readings as f64;
        let limit = crate::stats::distributions::normal_quantile(tail);
        // Robust scale from the median: a bad row must not mask itself.
        let mut sizes: Vec<f64> = residual.iter().map(|r| r.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let typical = sizes
            .get(sizes.len() / 2)
            .map_or(0.0, |median| median / 0.6745);
        if typical <= 1e-6 * variance.sqrt() {
            return Vec::new();
        }
        let mut found: Vec<Outlier> = (self.rows.iter().zip(residual))
            .filter(|(_, r)| r.abs() > limit * typical)
            .map(|(row, r)| Outlier {
                place: readings.loadings[row.loading].place.clone(),
                sigmas: r.abs() / typical,
            })
            .collect();
        found.sort_by(|a, b| b.sigmas.total_cmp(&a.sigmas));
        found.dedup_by(|a, b| a.place == b.place);
        found
    }
}

/// Component of a world motion in other axes.
fn in_axes(world_from_axes: &Matrix3<f64>, component: usize, pick: &dyn Fn(usize) -> f64) -> f64 {
    let from = 3 * (component / 3);
    let vector = Vector3::new(pick(from), pick(from + 1), pick(from + 2));
    world_from_axes.column(component % 3).dot(&vector)
}

/// Subtracts the mean of each posture and component from readings and predictors, which is
/// equivalent to estimating a zero for each. Returns their number.
fn remove_zeros(readings: &Readings, rows: &mut [Row], matrix: &mut DMatrix<f64>) -> usize {
    let mut zeros = 0;
    for posture in 0..readings.postures {
        for component in 0..6 {
            let own: Vec<usize> = (0..rows.len())
                .filter(|&i| {
                    let row = &rows[i];
                    row.component == component && readings.loadings[row.loading].posture == posture
                })
                .collect();
            if own.is_empty() {
                continue;
            }
            zeros += 1;
            let count = own.len() as f64;
            let mean =
                |pick: &dyn Fn(usize) -> f64| own.iter().map(|&i| pick(i)).sum::<f64>() / count;
            let measured = mean(&|i| rows[i].measured);
            let predicted = mean(&|i| rows[i].predicted);
            for k in 0..matrix.ncols() {
                let column = mean(&|i| matrix[(i, k)]);
                own.iter().for_each(|&i| matrix[(i, k)] -= column);
            }
            for &i in &own {
                rows[i].measured -= measured;
                rows[i].predicted -= predicted;
            }
        }
    }
    zeros
}
