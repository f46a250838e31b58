//! Converts errors from calls to the package's exceptions.

use gdcm::cli::calls::CallError;
use pyo3::prelude::*;

/// Creates the exception `gdcm.Error` from a call's error.
pub(crate) fn exception(py: Python<'_>, error: &CallError) -> PyErr {
    let fields = serde_json::Value::Object((*error.fields).clone()).to_string();
    let arguments = (
        error.code,
        error.text.as_str(),
        error.status,
        fields,
        error.messages.to_string(),
    );
    let created = py
        .import("gdcm._error")
        .and_then(|module| module.getattr("Error"))
        .and_then(|class| class.call_method1("_from_call", arguments));
    match created {
        Ok(value) => PyErr::from_value(value),
        Err(error) => error,
    }
}
