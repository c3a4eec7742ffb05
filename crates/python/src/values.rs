//! Values from Python to the library and back.

use nalgebra::DMatrix;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyString, PyTuple};
use serde::Serialize;

use crate::errors::plain;

/// Keys and values that are changed in a scenario, in TOML.
pub fn overrides(given: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<(String, String)>> {
    let Some(given) = given else {
        return Ok(Vec::new());
    };
    let one = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let key: String = key.extract().map_err(|_| {
            PyTypeError::new_err(format!(
                "overrides: the key {key} is no text, such as \"run.duration_s\""
            ))
        })?;
        let text = toml(&value)?.ok_or_else(|| {
            let kind = value.get_type().name().map(|name| name.to_string());
            PyTypeError::new_err(format!(
                "overrides: \"{key}\" is of type {}, but must be a number, a text, True or False, or a list of these",
                kind.unwrap_or_default()
            ))
        })?;
        Ok((key, text))
    };
    given.iter().map(one).collect()
}

/// `None` for a value that TOML has no form of.
fn toml(value: &Bound<'_, PyAny>) -> PyResult<Option<String>> {
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Some(serde_json::Value::from(text.to_str()?).to_string()));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let mut texts = Vec::new();
        for one in value.try_iter()? {
            match toml(&one?)? {
                Some(text) => texts.push(text),
                None => return Ok(None),
            }
        }
        return Ok(Some(format!("[{}]", texts.join(", "))));
    }
    if let Ok(flag) = value.extract::<bool>() {
        return Ok(Some(flag.to_string()));
    }
    if let Ok(number) = value.extract::<i64>() {
        return Ok(Some(number.to_string()));
    }
    Ok(match value.extract::<f64>() {
        Ok(number) if number.is_nan() => Some("nan".to_owned()),
        Ok(number) => Some(format!("{number:?}")),
        Err(_) => None,
    })
}

/// Numbers as a NumPy array, which is the first use of NumPy.
pub fn array<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyAny>> {
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_ne_bytes())
        .collect();
    let numpy = py.import("numpy")?;
    let flat = numpy.call_method1("frombuffer", (PyBytes::new(py, &bytes), "f8"))?;
    // Of its own, to be written to.
    flat.call_method0("copy")
}

/// A matrix as a NumPy array of rows.
pub fn matrix<'py>(py: Python<'py>, matrix: &DMatrix<f64>) -> PyResult<Bound<'py, PyAny>> {
    let rows = matrix.transpose();
    let shape = (matrix.nrows(), matrix.ncols());
    array(py, rows.as_slice())?.call_method1("reshape", (shape,))
}

/// What serde writes, as Python's own types; what is no number is None.
pub fn of_serde<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| plain(py, &error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}
