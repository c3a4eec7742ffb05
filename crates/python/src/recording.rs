//! Recordings, as Arrow and NumPy take them.

use std::sync::{Arc, OnceLock};

use arrow::array::{RecordBatch, RecordBatchIterator};
use arrow::ffi_stream::FFI_ArrowArrayStream;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList};
use truecut::recording::{ClaimResult, Outcome};
use truecut::{Finished, recording, telemetry};

use crate::errors::plain;
use crate::values::{array, of_serde};

/// What a run recorded: channels over time, all SI, and what was computed from it.
///
/// It is an Arrow table without a copy (`pyarrow.table(recording)`, `polars.DataFrame(recording)`,
/// `pandas.DataFrame.from_arrow(recording)`): column `time` in s, then one column a channel, each
/// with `unit` and `description` in its field's metadata. `recording["tool.position_x"]` is a NumPy
/// array.
#[pyclass(frozen, module = "truecut")]
pub struct Recording {
    recording: Arc<recording::Recording>,
    claims: Vec<ClaimResult>,
    /// Made when it is first asked for.
    batch: OnceLock<RecordBatch>,
    #[pyo3(get)]
    /// Time step of the plant, s.
    time_step_s: f64,
    #[pyo3(get)]
    /// Time that the run itself took by the clock on the wall, s.
    run_s: f64,
}

/// A number that the run computed.
#[pyclass(frozen, module = "truecut", get_all)]
pub struct Scalar {
    /// SI; NaN if the run gave none.
    value: f64,
    /// Unit of the value: "m", "N m", "1".
    unit: String,
    /// One line.
    description: String,
}

#[pymethods]
impl Scalar {
    fn __float__(&self) -> f64 {
        self.value
    }

    fn __repr__(&self) -> String {
        format!("Scalar({:?}, '{}')", self.value, self.unit)
    }
}

/// Something along a line, such as the width of a chamfer around its rim.
#[pyclass(frozen, module = "truecut")]
pub struct Profile {
    recording: Arc<recording::Recording>,
    index: usize,
}

impl Profile {
    fn own(&self) -> &recording::Profile {
        &self.recording.profiles[self.index]
    }
}

#[pymethods]
impl Profile {
    /// Places, ascending, SI.
    #[getter]
    fn axis<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, &self.own().axis)
    }

    /// One value for each place, SI.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, &self.own().values)
    }

    /// What the axis is.
    #[getter]
    fn axis_name(&self) -> &str {
        &self.own().axis_name
    }

    /// Unit of the axis.
    #[getter]
    fn axis_unit(&self) -> &'static str {
        self.own().axis_unit.symbol()
    }

    /// Unit of the values.
    #[getter]
    fn unit(&self) -> &'static str {
        self.own().unit.symbol()
    }

    /// One line.
    #[getter]
    fn description(&self) -> &str {
        &self.own().description
    }
}

impl Recording {
    pub fn of(finished: Finished) -> Recording {
        Recording {
            recording: Arc::new(finished.recording),
            claims: finished.claims,
            batch: OnceLock::new(),
            time_step_s: finished.time_step_s,
            run_s: finished.run_s,
        }
    }

    fn batch(&self, py: Python<'_>) -> PyResult<RecordBatch> {
        if let Some(batch) = self.batch.get() {
            return Ok(batch.clone());
        }
        let made = py.detach(|| telemetry::record_batch(&self.recording));
        let made = made.map_err(|error| plain(py, &error.to_string()))?;
        Ok(self.batch.get_or_init(|| made).clone())
    }
}

/// A batch as a stream of the Arrow C interface.
pub fn stream<'py>(py: Python<'py>, batch: RecordBatch) -> PyResult<Bound<'py, PyCapsule>> {
    let schema = batch.schema();
    let reader = RecordBatchIterator::new([Ok(batch)], schema);
    let stream = FFI_ArrowArrayStream::new(Box::new(reader));
    PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
}

#[pymethods]
impl Recording {
    /// The table as a stream of the Arrow C interface; `requested_schema` is not followed, as the
    /// interface allows.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        drop(requested_schema);
        stream(py, self.batch(py)?)
    }

    /// A channel as a NumPy array, SI; "time" in s.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        if name == "time" {
            return array(py, &self.recording.time_s);
        }
        let values = self.recording.channel(name);
        array(
            py,
            values.map_err(|error| PyKeyError::new_err(error.to_string()))?,
        )
    }

    /// Number of rows.
    fn __len__(&self) -> usize {
        self.recording.time_s.len()
    }

    /// Names of the channels, with the unit of each.
    #[getter]
    fn channels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let channels = PyDict::new(py);
        for one in &self.recording.header.channels {
            channels.set_item(&one.name, one.unit.symbol())?;
        }
        Ok(channels)
    }

    /// What the run computed, by name.
    #[getter]
    fn scalars<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let scalars = PyDict::new(py);
        for one in &self.recording.scalars {
            let scalar = Scalar {
                value: one.value,
                unit: one.unit.symbol().to_owned(),
                description: one.description.clone(),
            };
            scalars.set_item(&one.name, scalar.into_pyobject(py)?)?;
        }
        Ok(scalars)
    }

    /// What the run computed along lines, by name.
    #[getter]
    fn profiles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let profiles = PyDict::new(py);
        for (index, one) in self.recording.profiles.iter().enumerate() {
            let recording = Arc::clone(&self.recording);
            let profile = Profile { recording, index };
            profiles.set_item(&one.name, profile.into_pyobject(py)?)?;
        }
        Ok(profiles)
    }

    /// The claims as they were judged, in the scenario's order: dictionaries with `name`, `holds`,
    /// `value` (SI), `unit`, `min`, `max`, `reason`, `shown`.
    #[getter]
    fn claims<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_serde(py, &self.claims)
    }

    /// Whether the run came to its end and every claim holds.
    #[getter]
    fn holds(&self) -> bool {
        let is_complete = self.recording.outcome == Outcome::Completed;
        is_complete && self.claims.iter().all(|claim| claim.holds)
    }

    /// How the run ended: "completed", or what went wrong.
    #[getter]
    fn outcome(&self) -> String {
        self.recording.outcome.to_string()
    }

    /// Assumptions and what else a reader should know.
    #[getter]
    fn notes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        PyList::new(py, &self.recording.header.notes)
    }

    /// The scenario that really ran, as TOML.
    #[getter]
    fn scenario_text(&self) -> &str {
        &self.recording.header.scenario_text
    }

    /// Writes the recording as a Parquet file, which `truecut view` and any reader take.
    fn write_parquet(&self, py: Python<'_>, path: std::path::PathBuf) -> PyResult<()> {
        let written = py.detach(|| telemetry::write_parquet(&path, &self.recording));
        written.map_err(|error| plain(py, &error.to_string()))
    }

    fn __repr__(&self) -> String {
        format!(
            "<Recording of \"{}\": {} rows, {} channels, {}>",
            self.recording.header.scenario_name,
            self.recording.time_s.len(),
            self.recording.columns.len(),
            self.recording.outcome
        )
    }
}
