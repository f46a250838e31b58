//! The class `Identification`: models from flight records.

use std::ffi::OsString;
use std::path::PathBuf;

use gdcm::cli::calls::{IdentifiedRecords, identify};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::bytes::response_bytes;
use crate::data::Data;
use crate::error::exception;
use crate::work::carry_out;

/// Models identified from flight records.
#[pyclass(frozen, module = "gdcm._gdcm")]
pub(crate) struct Identification {
    identified: IdentifiedRecords,
    /// Messages that the program reported, as JSON.
    #[pyo3(get)]
    messages: String,
}

#[pymethods]
impl Identification {
    #[new]
    fn new(py: Python<'_>, options: Vec<OsString>, progress: Option<Py<PyAny>>) -> PyResult<Self> {
        let called = carry_out(py, progress, |progress| identify(options, progress))?;
        Ok(Self {
            identified: called.value,
            messages: called.messages.to_string(),
        })
    }

    /// The results, as the text in `identified.json`.
    fn json<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let text = py.detach(|| self.identified.json());
        let text = text.map_err(|error| exception(py, &error))?;
        Ok(PyBytes::new(py, &text))
    }

    fn response<'py>(
        &self,
        py: Python<'py>,
        model: Option<&str>,
        omega: Vec<f64>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let response = py.detach(|| self.identified.response(model, &omega));
        let response = response.map_err(|error| exception(py, &error))?;
        Ok(response_bytes(py, &response))
    }

    fn save(&self, py: Python<'_>, path: PathBuf, is_replaced: bool) -> PyResult<()> {
        let saved = py.detach(|| self.identified.save(&path, is_replaced));
        saved.map_err(|error| exception(py, &error))
    }

    fn put_into(&self, py: Python<'_>, data: &Data, condition: i64, take: &str) -> PyResult<Data> {
        let opened = &data.opened;
        let extended = py.detach(|| self.identified.put_into(opened, condition, take));
        match extended {
            Ok(extended) => Ok(Data::new(extended)),
            Err(error) => Err(exception(py, &error)),
        }
    }
}
