//! Sweeps as tables.

use std::collections::HashMap;
use std::sync::Arc;

use arrow::array::{ArrayRef, Float64Array, RecordBatch};
use arrow::datatypes::{DataType, Field, Schema};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList};
use truecut::{Sweep, scenario, sim};

use crate::attended::attended;
use crate::errors::{of_run, plain};
use crate::recording::stream;
use crate::values::array;

/// The rows of a sweep: axes first, in their keys' own units, then results. An Arrow table without
/// a copy, as a recording is.
#[pyclass(frozen, module = "truecut")]
pub struct SweepTable {
    table: sim::sweep::SweepTable,
}

/// Runs the sweep of a scenario.
pub fn swept(
    py: Python<'_>,
    scenario: &scenario::Scenario,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<SweepTable> {
    if scenario.sweep.is_none() {
        let fault = scenario.problem("process", "there is no [sweep] table");
        return Err(crate::errors::of_scenario(py, scenario.path(), &fault));
    }
    let table = attended(py, progress, |attended| {
        let sweep = Sweep {
            progress: &|part| attended.tell(part),
            stop: Some(attended.stop()),
            ..Sweep::of(scenario)
        };
        sweep.execute()
    })?;
    let table = table.map_err(|error| of_run(py, scenario.path(), &error))?;
    Ok(SweepTable { table })
}

impl SweepTable {
    fn column(&self, index: usize) -> Vec<f64> {
        self.table.rows.iter().map(|row| row[index]).collect()
    }
}

#[pymethods]
impl SweepTable {
    /// The table as a stream of the Arrow C interface.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        drop(requested_schema);
        let field = |column: &sim::sweep::Column| {
            let unit = HashMap::from([("unit".to_owned(), column.unit.symbol.clone())]);
            Field::new(&column.name, DataType::Float64, false).with_metadata(unit)
        };
        let fields: Vec<Field> = self.table.columns.iter().map(field).collect();
        let columns = (0..fields.len())
            .map(|index| Arc::new(Float64Array::from(self.column(index))) as ArrayRef);
        let batch = RecordBatch::try_new(Arc::new(Schema::new(fields)), columns.collect());
        stream(py, batch.map_err(|error| plain(py, &error.to_string()))?)
    }

    /// A column as a NumPy array.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let place = self.table.columns.iter().position(|one| one.name == name);
        let place = place.ok_or_else(|| PyKeyError::new_err(format!("no column \"{name}\"")))?;
        array(py, &self.column(place))
    }

    /// Number of rows.
    fn __len__(&self) -> usize {
        self.table.rows.len()
    }

    /// Names of the columns, with the unit of each.
    #[getter]
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        for one in &self.table.columns {
            columns.set_item(&one.name, &one.unit.symbol)?;
        }
        Ok(columns)
    }

    /// For each row what is wrong with its run, or None.
    #[getter]
    fn faults<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let faults = self.table.faults.iter();
        let texts: Vec<Option<&str>> = faults
            .map(|fault| fault.as_ref().map(|fault| fault.why.as_str()))
            .collect();
        PyList::new(py, texts)
    }
}
