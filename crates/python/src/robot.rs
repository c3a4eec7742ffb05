//! Robots: kinematics, stiffness, modes.

use std::path::PathBuf;

use nalgebra::{DMatrix, Isometry3, Matrix4, Rotation3, Translation3, UnitQuaternion};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use truecut::arm::{self, ArmErrorKind, BranchOptions, FrameId, Load, Masses, Packages, Reading};

use crate::attended::attended;
use crate::errors::of_arm;
use crate::values::{array, matrix};

/// How far a rotation may be from one, entry by entry.
const ROUNDED: f64 = 1e-6;

/// A robot: a URDF or xacro, with its stiffness, drives and tool in a `robot.toml` beside it.
///
/// Postures are lists of rad (m for slides), one value a joint from the base on. Poses are 4x4
/// NumPy arrays from the world (root of the URDF, z up) to the frame, in m. `frame` is "flange",
/// "tool" or "foot".
#[pyclass(frozen, module = "truecut")]
pub struct Robot {
    inner: arm::Robot,
}

fn frame_of(name: &str) -> PyResult<FrameId> {
    match name {
        "flange" => Ok(FrameId::Flange),
        "tool" => Ok(FrameId::Tool),
        "foot" => Ok(FrameId::Foot),
        other => Err(PyValueError::new_err(format!(
            "frame is \"{other}\", but must be \"flange\", \"tool\" or \"foot\""
        ))),
    }
}

fn pose_of(rows: &[[f64; 4]; 4]) -> PyResult<Isometry3<f64>> {
    let matrix = Matrix4::from_fn(|row, column| rows[row][column]);
    let turned = matrix.fixed_view::<3, 3>(0, 0).into_owned();
    let off = (turned * turned.transpose() - nalgebra::Matrix3::identity())
        .abs()
        .max();
    let last = [
        matrix[(3, 0)],
        matrix[(3, 1)],
        matrix[(3, 2)],
        matrix[(3, 3)] - 1.0,
    ];
    if !(off <= ROUNDED
        && turned.determinant() > 0.0
        && last.iter().all(|one| one.abs() <= ROUNDED))
    {
        return Err(PyValueError::new_err(
            "pose is no 4x4 matrix of a rotation and a place: its first three rows and columns must be a \
             right-handed orthonormal matrix, its last row 0 0 0 1",
        ));
    }
    let turned = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turned));
    let place = Translation3::new(matrix[(0, 3)], matrix[(1, 3)], matrix[(2, 3)]);
    Ok(Isometry3::from_parts(place, turned))
}

impl Robot {
    fn posture(&self, py: Python<'_>, posture: Option<Vec<f64>>) -> PyResult<Vec<f64>> {
        let Some(posture) = posture else {
            return Ok(self.inner.default_posture());
        };
        if posture.len() != self.inner.dof() {
            return Err(PyValueError::new_err(format!(
                "posture has {} values, but the robot has {} joints",
                posture.len(),
                self.inner.dof()
            )));
        }
        if let Some(odd) = posture.iter().find(|value| !value.is_finite()) {
            return Err(PyValueError::new_err(format!(
                "posture holds {odd}, which is no number"
            )));
        }
        let checked = self.inner.check_posture(&posture);
        checked.map_err(|error| of_arm(py, &error))?;
        Ok(posture)
    }
}

#[pymethods]
impl Robot {
    /// Reads a robot. `config`: its robot.toml, if it does not lie beside it; `tip`: the link whose
    /// frame is the flange.
    #[new]
    #[pyo3(signature = (path, config = None, tip = None))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        config: Option<PathBuf>,
        tip: Option<String>,
    ) -> PyResult<Robot> {
        let read = |masses| {
            let reading = Reading {
                config: config.as_deref(),
                tip: tip.as_deref(),
                masses,
                packages: Packages::from_environment([]),
                ..Reading::default()
            };
            arm::Robot::read(&path, &reading)
        };
        let read = attended(py, None, |_| match read(Masses::Needed) {
            Err(error) if matches!(error.kind(), ArmErrorKind::MasslessMovingLink { .. }) => {
                read(Masses::NotNeeded)
            }
            other => other,
        })?;
        let inner = read.map_err(|error| of_arm(py, &error))?;
        Ok(Robot { inner })
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// Names of the joints that move, from the base on.
    #[getter]
    fn joints(&self) -> Vec<&str> {
        self.inner
            .chain
            .joints
            .iter()
            .map(|joint| joint.name.as_str())
            .collect()
    }

    /// The posture in the middle of the joints' ranges, rad or m.
    #[getter]
    fn default_posture(&self) -> Vec<f64> {
        self.inner.default_posture()
    }

    /// Pose of a frame at a posture.
    #[pyo3(signature = (posture = None, frame = "flange"))]
    fn forward<'py>(
        &self,
        py: Python<'py>,
        posture: Option<Vec<f64>>,
        frame: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let posture = self.posture(py, posture)?;
        let pose = self.inner.world_from_frame(&posture, frame_of(frame)?);
        let pose = pose.to_homogeneous();
        matrix(
            py,
            &DMatrix::from_fn(4, 4, |row, column| pose[(row, column)]),
        )
    }

    /// All postures that put a frame at a pose, within the joints' limits, whole turns included.
    #[pyo3(signature = (pose, frame = "flange"))]
    fn inverse<'py>(
        &self,
        py: Python<'py>,
        pose: [[f64; 4]; 4],
        frame: &str,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let (pose, frame) = (pose_of(&pose)?, frame_of(frame)?);
        let found = attended(py, None, |_| {
            let solver = self.inner.ik_solver(&BranchOptions::default());
            solver.within_limits(&pose, frame)
        })?;
        found.iter().map(|posture| array(py, posture)).collect()
    }

    /// 6xN Jacobian of a frame's origin in world axes: m/s and rad/s per joint velocity.
    #[pyo3(signature = (posture = None, frame = "tool"))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        posture: Option<Vec<f64>>,
        frame: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let posture = self.posture(py, posture)?;
        let jacobian = self.inner.jacobian(&posture, frame_of(frame)?);
        let columns = jacobian.ncols();
        matrix(
            py,
            &DMatrix::from_fn(6, columns, |row, column| jacobian[(row, column)]),
        )
    }

    /// 6x6 compliance at a frame's origin in world axes, without load: m/N, m/(N m), rad/N,
    /// rad/(N m).
    #[pyo3(signature = (posture = None, frame = "tool"))]
    fn compliance<'py>(
        &self,
        py: Python<'py>,
        posture: Option<Vec<f64>>,
        frame: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let posture = self.posture(py, posture)?;
        let frame = frame_of(frame)?;
        let found = self
            .inner
            .cartesian_compliance(&posture, frame, &Load::none());
        let found = found.map_err(|error| of_arm(py, &error))?;
        matrix(
            py,
            &DMatrix::from_fn(6, 6, |row, column| found[(row, column)]),
        )
    }

    /// 6x6 stiffness at a frame's origin, the inverse of the compliance: N/m, N/rad, N m/m,
    /// N m/rad.
    /// Raises `numpy.linalg.LinAlgError` where the arm is singular.
    #[pyo3(signature = (posture = None, frame = "tool"))]
    fn stiffness<'py>(
        &self,
        py: Python<'py>,
        posture: Option<Vec<f64>>,
        frame: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let compliance = self.compliance(py, posture, frame)?;
        py.import("numpy.linalg")?
            .call_method1("inv", (compliance,))
    }

    /// NxN mass matrix, kg m² (kg for slides).
    #[pyo3(signature = (posture = None))]
    fn mass<'py>(&self, py: Python<'py>, posture: Option<Vec<f64>>) -> PyResult<Bound<'py, PyAny>> {
        let posture = self.posture(py, posture)?;
        matrix(py, &self.inner.mass_matrix(&posture))
    }

    /// Natural modes with the drives held, slowest first: `frequency_hz`, `damping_ratio`, and
    /// `shapes`, whose columns are joint motions with a modal mass of 1.
    #[pyo3(signature = (posture = None))]
    fn modes<'py>(
        &self,
        py: Python<'py>,
        posture: Option<Vec<f64>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let posture = self.posture(py, posture)?;
        let modes = self.inner.modes(&posture, None);
        let modes = modes.map_err(|error| of_arm(py, &error))?;
        let found = PyDict::new(py);
        found.set_item("frequency_hz", array(py, &modes.frequency_hz)?)?;
        found.set_item("damping_ratio", array(py, &modes.damping_ratio)?)?;
        found.set_item("shapes", matrix(py, &modes.shapes)?)?;
        Ok(found)
    }

    fn __repr__(&self) -> String {
        let dof = self.inner.dof();
        format!(
            "<Robot \"{}\": {dof} joints, {}>",
            self.inner.name,
            self.inner.urdf_path.display()
        )
    }
}
