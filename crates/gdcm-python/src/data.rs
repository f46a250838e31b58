//! The class `Data`: a dataset or a study. The dataset is returned as the text of its file,
//! responses as the bytes of complex numbers.

use std::ffi::OsString;
use std::path::PathBuf;

use gdcm::cli::calls::{CallError, Called, OpenedData, assemble, bundle_named};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::bytes::response_bytes;
use crate::error::exception;
use crate::work::carry_out;

/// A dataset with a study's decisions about it.
#[pyclass(frozen, module = "gdcm._gdcm")]
pub(crate) struct Data {
    pub(crate) opened: OpenedData,
    /// Messages that the program reported, as JSON.
    #[pyo3(get)]
    messages: String,
    /// Rules by which the models were read, as JSON; empty for a dataset that was not assembled.
    #[pyo3(get)]
    rules: Vec<u8>,
}

impl Data {
    pub(crate) fn new(called: Called<OpenedData>) -> Self {
        Self {
            opened: called.value,
            messages: called.messages.to_string(),
            rules: Vec::new(),
        }
    }

    fn from_result(
        py: Python<'_>,
        result: Result<Called<OpenedData>, CallError>,
    ) -> PyResult<Self> {
        match result {
            Ok(called) => Ok(Self::new(called)),
            Err(error) => Err(exception(py, &error)),
        }
    }
}

#[pymethods]
impl Data {
    #[staticmethod]
    fn example(py: Python<'_>, is_real: bool) -> PyResult<Self> {
        Self::from_result(py, py.detach(|| OpenedData::example(is_real)))
    }

    #[staticmethod]
    fn load(
        py: Python<'_>,
        file: PathBuf,
        dataset: Option<PathBuf>,
        is_strict: bool,
    ) -> PyResult<Self> {
        let called = carry_out(py, None, |_| OpenedData::load(&file, dataset, is_strict))?;
        Ok(Self::new(called))
    }

    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str, name: &str) -> PyResult<Self> {
        Self::from_result(
            py,
            py.detach(|| OpenedData::from_json(text.as_bytes(), name)),
        )
    }

    #[staticmethod]
    fn assemble(py: Python<'_>, options: Vec<OsString>) -> PyResult<Self> {
        let called = carry_out(py, None, |_| assemble(options))?;
        let rules = called.value.rules.clone();
        Ok(Self {
            rules,
            ..Self::new(called.map(|assembled| assembled.data))
        })
    }

    /// Path to the dataset file, or the example's name in parentheses.
    #[getter]
    fn source(&self) -> String {
        self.opened.source()
    }

    fn dataset_json<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let text = py.detach(|| self.opened.dataset_json());
        let text = text.map_err(|error| exception(py, &error))?;
        Ok(PyBytes::new(py, &text))
    }

    fn save_dataset(&self, py: Python<'_>, path: PathBuf, is_replaced: bool) -> PyResult<()> {
        let saved = py.detach(|| self.opened.save_dataset(&path, is_replaced));
        saved.map_err(|error| exception(py, &error))
    }

    fn save_study(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let saved = py.detach(|| self.opened.save_study(&path));
        saved.map_err(|error| exception(py, &error))
    }

    fn response<'py>(
        &self,
        py: Python<'py>,
        condition: i64,
        bundle: &str,
        model: &str,
        omega: Vec<f64>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let bundle = bundle_named(bundle);
        let response = py.detach(|| self.opened.response(condition, bundle, model, &omega));
        let response = response.map_err(|error| exception(py, &error))?;
        Ok(response_bytes(py, &response))
    }
}
