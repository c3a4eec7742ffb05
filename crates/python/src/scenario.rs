//! Scenarios: read, changed, run, compared, diagnosed.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use truecut::{Engine, Finished, Run, RunError, data, scenario};

use crate::attended::attended;
use crate::errors::{of_run, of_scenario};
use crate::recording::Recording;
use crate::reports;
use crate::sweep::{self, SweepTable};
use crate::values::overrides as in_toml;

/// A scenario: a robot, what its tool does, and what must hold. `truecut.load` reads one.
#[pyclass(frozen, module = "truecut")]
pub struct Scenario {
    inner: scenario::Scenario,
}

/// Reads a scenario file. Paths in it start from its folder.
///
/// `overrides` changes keys: `{"process.chamfer.spindle_rpm": 400}`, in the key's own unit.
///
/// Raises `TruecutError` with `file`, `line`, `key` and `rule`.
#[pyfunction]
#[pyo3(signature = (path, overrides = None))]
pub fn load(
    py: Python<'_>,
    path: PathBuf,
    overrides: Option<&Bound<'_, PyDict>>,
) -> PyResult<Scenario> {
    let changed = in_toml(overrides)?;
    let read = py.detach(|| scenario::Scenario::load(&path, &changed));
    let inner = read.map_err(|error| of_scenario(py, &path, &error))?;
    Ok(Scenario { inner })
}

fn engine_of(name: Option<&str>) -> PyResult<Engine> {
    match name {
        None | Some("rapier") => Ok(Engine::Rapier),
        Some("reduced") => Ok(Engine::REDUCED),
        Some(other) => Err(PyValueError::new_err(format!(
            "engine is \"{other}\", but must be \"rapier\" (the full model) or \"reduced\" (the arm \
             linearised, many times as fast)"
        ))),
    }
}

impl Scenario {
    /// The scenario itself.
    pub fn inner(&self) -> &scenario::Scenario {
        &self.inner
    }

    fn path(&self) -> &Path {
        self.inner.path()
    }

    /// The scenario with overrides, for what takes none itself.
    fn changed(
        &self,
        py: Python<'_>,
        overrides: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<scenario::Scenario> {
        let changed = in_toml(overrides)?;
        if changed.is_empty() {
            return Ok(self.inner.clone());
        }
        let read = py.detach(|| self.inner.with_overrides(&changed));
        read.map_err(|error| of_scenario(py, self.path(), &error))
    }
}

#[pymethods]
impl Scenario {
    /// Runs the scenario and judges its claims. A run that diverges, chatters or overloads a drive
    /// is no error: its recording says so in `outcome`.
    ///
    /// `overrides`: keys that are changed for this run alone, in their own units.
    /// `engine`: "rapier" (default) or "reduced".
    /// `data`: file of measured data for a scenario that replays some, in place of its own.
    /// `progress`: called with the part done, from 0 to 1.
    #[pyo3(signature = (overrides = None, engine = None, progress = None, *, data = None))]
    fn run(
        &self,
        py: Python<'_>,
        overrides: Option<&Bound<'_, PyDict>>,
        engine: Option<&str>,
        progress: Option<&Bound<'_, PyAny>>,
        data: Option<PathBuf>,
    ) -> PyResult<Recording> {
        let engine = engine_of(engine)?;
        let scenario = self.changed(py, overrides)?;
        let finished = attended(py, progress, |attended| -> Result<Finished, RunError> {
            let measured = data::replayed_from(&scenario, data.as_deref())?;
            let run = Run {
                measured: measured.as_ref(),
                read_data: Some(data::replayed),
                engine,
                progress: &|part| attended.tell(part),
                stop: Some(attended.stop()),
                ..Run::of(&scenario)
            };
            run.execute()
        })?;
        let finished = finished.map_err(|error| of_run(py, self.path(), &error))?;
        Ok(Recording::of(finished))
    }

    /// Builds what would run and checks claims and metrics, without a run.
    #[pyo3(signature = (overrides = None))]
    fn check(&self, py: Python<'_>, overrides: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let scenario = self.changed(py, overrides)?;
        let checked = attended(py, None, |_| {
            let run = Run {
                read_data: Some(data::replayed),
                ..Run::of(&scenario)
            };
            run.check()
        })?;
        checked.map_err(|error| of_run(py, self.path(), &error))
    }

    /// Runs the scenario's sweep on all cores; one row a run, axes first.
    #[pyo3(signature = (overrides = None, progress = None))]
    fn sweep(
        &self,
        py: Python<'_>,
        overrides: Option<&Bound<'_, PyDict>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<SweepTable> {
        let scenario = self.changed(py, overrides)?;
        sweep::swept(py, &scenario, progress)
    }

    /// Runs the scenario beside measured data and says what it gets wrong, channel by channel: the
    /// content of `compare.json` as dictionaries, SI.
    ///
    /// `data`: a file in place of the one that the scenario names.
    #[pyo3(signature = (data = None, overrides = None, progress = None))]
    fn compare<'py>(
        &self,
        py: Python<'py>,
        data: Option<PathBuf>,
        overrides: Option<&Bound<'py, PyDict>>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let scenario = self.changed(py, overrides)?;
        reports::compared(py, &scenario, data.as_deref(), progress)
    }

    /// Looks for what the scenario lacks against measured data: verdict, causes with intervals,
    /// evidence; the content of the program's `diagnosis.json` that concerns the answer, SI.
    ///
    /// `data`: a file in place of the one that the scenario names. `max_runs`: most simulations.
    /// `max_causes`: most causes that are named.
    #[pyo3(signature = (data = None, overrides = None, progress = None, *, max_runs = None, max_causes = None))]
    fn diagnose<'py>(
        &self,
        py: Python<'py>,
        data: Option<PathBuf>,
        overrides: Option<&Bound<'py, PyDict>>,
        progress: Option<&Bound<'py, PyAny>>,
        max_runs: Option<NonZeroUsize>,
        max_causes: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let scenario = self.changed(py, overrides)?;
        let limits = reports::Limits {
            runs: max_runs,
            causes: max_causes,
        };
        reports::diagnosed(py, &scenario, data.as_deref(), &limits, progress)
    }

    /// The scenario with keys changed, in their own units.
    fn with_overrides(&self, py: Python<'_>, overrides: &Bound<'_, PyDict>) -> PyResult<Scenario> {
        let inner = self.changed(py, Some(overrides))?;
        Ok(Scenario { inner })
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// Its file.
    #[getter(path)]
    fn file(&self) -> PathBuf {
        self.path().to_owned()
    }

    /// The file as TOML, with the overrides.
    #[getter]
    fn text(&self) -> String {
        self.inner.effective_text().to_string()
    }

    fn __repr__(&self) -> String {
        format!(
            "<Scenario \"{}\" of {}>",
            self.inner.name,
            self.path().display()
        )
    }
}
