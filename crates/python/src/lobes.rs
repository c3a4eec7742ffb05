//! Stability diagrams of milling.

use nalgebra::DMatrix;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use truecut::RunError;
use truecut::plan::PlanError;
use truecut::plan::lobes::{LobeRequest, Lobes, lobes as diagram};
use truecut::scenario;
use truecut::sim::stability::{MillingStudy, in_scenario};

use crate::attended::{Attended, attended};
use crate::errors::of_run;
use crate::scenario::Scenario;
use crate::values::{array, matrix};

/// Fewest and most speeds and depths of a diagram.
const SIZE: [usize; 2] = [2, 1000];

/// What was asked for, in SI.
struct Asked {
    spindle_rad_s: Option<[f64; 2]>,
    deepest_m: Option<f64>,
    size: usize,
    at_m: f64,
}

/// A diagram, with what a reader of it should know.
struct Found {
    lobes: Lobes,
    known_to_rad_s: Option<f64>,
    notes: Vec<String>,
}

/// The stability diagram of a scenario with `[process.milling]`, as `truecut lobes` computes it:
/// limits by spectral elements, for the nominal arm standing at one place of the path.
///
/// `spindle_rad_s`: slowest and fastest spindle speed; by default a tenth of the scenario's, and
/// one and a quarter of it. `deepest_m`: deepest cut; by default three times the scenario's, or a
/// fifth more than its limit. `size`: how many speeds and depths, 2 to 1000. `at_m`: where on the
/// path the arm stands, from its start. `progress`: called with the part done, from 0 to 1.
///
/// Gives a dictionary, all SI, N speeds and M depths:
/// `spindle_rad_s` (N), `depth_m` (M); `multiplier` (N x M): magnitude of the dominant multiplier
/// over a tooth period, stable below 1; `limit_m` (N): first unstable depth, NaN where there is
/// none down to the deepest; `limit_error_m` (N): its error by discretisation in time, estimated;
/// `frequency_hz` (N): of the vibration there; `zero_order_m` (N): the limit to zero order,
/// whatever its depth; `mode_coupling_m`: the depth from which modes couple without regeneration,
/// or None; `known_to_rad_s`: the fastest speed at which limits are known (NaN above it), or None
/// where all are; `notes`.
#[pyfunction]
#[pyo3(signature = (scenario, spindle_rad_s = None, deepest_m = None, *, size = 100, at_m = 0.0, progress = None))]
pub fn lobes<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    spindle_rad_s: Option<[f64; 2]>,
    deepest_m: Option<f64>,
    size: usize,
    at_m: f64,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let asked = Asked {
        spindle_rad_s,
        deepest_m,
        size,
        at_m,
    };
    asked.check()?;
    let scenario = scenario.inner();
    let found = attended(py, progress, |attended| {
        computed(scenario, &asked, attended)
    })?;
    let found = found.map_err(|error| of_run(py, scenario.path(), &error))?;
    found.into_python(py)
}

impl Asked {
    fn check(&self) -> PyResult<()> {
        let [fewest, most] = SIZE;
        let wrong = match self {
            Asked { size, .. } if !(fewest..=most).contains(size) => {
                format!("size is {size}, but must be from {fewest} to {most}")
            }
            Asked {
                spindle_rad_s: Some([slow, fast]),
                ..
            } if !(*slow > 0.0 && fast > slow && fast.is_finite()) => format!(
                "spindle_rad_s is ({slow}, {fast}), but must be two speeds above 0, the slower first"
            ),
            Asked {
                deepest_m: Some(deepest),
                ..
            } if !(*deepest > 0.0 && deepest.is_finite()) => {
                format!("deepest_m is {deepest}, but must be above 0: a cut has a depth")
            }
            Asked { at_m, .. } if !(*at_m >= 0.0 && at_m.is_finite()) => {
                format!("at_m is {at_m}, but must be at least 0, from the path's start")
            }
            _ => return Ok(()),
        };
        Err(PyValueError::new_err(wrong))
    }
}

fn computed(
    scenario: &scenario::Scenario,
    asked: &Asked,
    attended: &Attended,
) -> Result<Found, RunError> {
    let failed = |error| RunError::of(scenario, error);
    let study = MillingStudy::of(scenario).map_err(failed)?;
    let length_m = study.path.length_m();
    if asked.at_m > length_m {
        let message = format!(
            "at_m is {}, but must be at most the path's length of {length_m}",
            asked.at_m
        );
        return Err(RunError::Data {
            message,
            help: None,
        });
    }
    let posture = study.postures().map_err(failed)?.posture(asked.at_m);
    let tip_modes = study.modes(&posture).map_err(failed)?;
    let known = study.known_to_rad_s(&tip_modes);
    let request = study.request(asked.spindle_rad_s, asked.deepest_m, asked.size, &tip_modes);
    let lobes = stoppable(&study, &posture, &request, attended);
    let lobes = lobes.ok_or(RunError::Stopped)?;
    let lobes = lobes.map_err(|error| failed(in_scenario(error)))?;
    let known = known.filter(|known| request.spindle_rad_s[1] > *known);
    let beyond = known.map(|known| study.beyond_modes(&tip_modes, known));
    let notes = study.notes(&tip_modes).into_iter();
    let notes = notes.chain(study.beyond_table(request.spindle_rad_s[1]));
    Ok(Found {
        lobes: lobes.known_to(known.unwrap_or(f64::INFINITY)),
        known_to_rad_s: known,
        notes: notes.chain(beyond).collect(),
    })
}

/// `None` if it was stopped: each speed asks for modes first.
fn stoppable(
    study: &MillingStudy,
    posture: &[f64],
    request: &LobeRequest,
    attended: &Attended,
) -> Option<Result<Lobes, PlanError>> {
    let is_stopped = || attended.stop().load(std::sync::atomic::Ordering::Relaxed);
    let modes = |speed: f64| match is_stopped() {
        // Any error ends it; this one is not told.
        true => Err(PlanError::PathPoints { count: 0 }),
        false => study.modes_of(&study.robot, posture, speed),
    };
    let lobes = diagram(&modes, &study.cut, request, &|part| attended.tell(part));
    (!is_stopped()).then_some(lobes)
}

impl Found {
    fn into_python(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let lobes = &self.lobes;
        let speeds = lobes.spindle_rad_s.len();
        let depths = lobes.depth_m.len();
        let multiplier = DMatrix::from_fn(speeds, depths, |i, j| lobes.multiplier[i][j]);
        let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
        let of_limits = |of: &dyn Fn(usize) -> Option<f64>| -> Vec<f64> {
            (0..speeds).map(|i| or_nan(of(i))).collect()
        };
        let limit_m = of_limits(&|i| lobes.limit[i].map(|limit| limit.depth_m));
        let error_m = of_limits(&|i| lobes.limit_error_m[i]);
        let frequency_hz = of_limits(&|i| lobes.limit[i].map(|limit| limit.frequency_hz));
        let zero_order_m = of_limits(&|i| lobes.zero_order[i].map(|limit| limit.depth_m));
        let found = PyDict::new(py);
        found.set_item("spindle_rad_s", array(py, &lobes.spindle_rad_s)?)?;
        found.set_item("depth_m", array(py, &lobes.depth_m)?)?;
        found.set_item("multiplier", matrix(py, &multiplier)?)?;
        found.set_item("limit_m", array(py, &limit_m)?)?;
        found.set_item("limit_error_m", array(py, &error_m)?)?;
        found.set_item("frequency_hz", array(py, &frequency_hz)?)?;
        found.set_item("zero_order_m", array(py, &zero_order_m)?)?;
        let coupling = lobes.mode_coupling.map(|limit| limit.depth_m);
        found.set_item("mode_coupling_m", coupling)?;
        found.set_item("known_to_rad_s", self.known_to_rad_s)?;
        found.set_item("notes", self.notes)?;
        Ok(found)
    }
}
