//! The class `Analysis`: an analysed study.
//!
//! Texts are returned in the formats of `corrections.json`, `gdcm-models` and the CSV files,
//! responses as the bytes of complex numbers.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use gdcm::cli::calls::{AnalysedStudy, CallError, Called, ModelChoice, analyze};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::bytes::response_bytes;
use crate::data::Data;
use crate::error::exception;
use crate::figure::Figure;
use crate::work::carry_out;

/// An analysed study.
#[pyclass(frozen, module = "gdcm._gdcm")]
pub(crate) struct Analysis {
    /// Locked only while the interpreter's lock is released: otherwise a thread with one lock could
    /// wait for the other while a second thread does the reverse.
    analysed: Mutex<AnalysedStudy>,
    /// Messages that the program reported, as JSON.
    #[pyo3(get)]
    messages: String,
    /// The summary that `gdcm analyze` prints.
    #[pyo3(get)]
    summary: String,
    /// The cautions in the summary, as JSON.
    #[pyo3(get)]
    summary_messages: String,
}

impl Analysis {
    /// Returns the value that `read` takes from the analysis, while the interpreter's lock is
    /// released.
    fn read<T: Send>(
        &self,
        py: Python<'_>,
        read: impl FnOnce(&AnalysedStudy) -> Result<T, CallError> + Send,
    ) -> PyResult<T> {
        py.detach(|| read(&self.lock()))
            .map_err(|error| exception(py, &error))
    }

    fn lock(&self) -> MutexGuard<'_, AnalysedStudy> {
        self.analysed.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Analysis {
    #[new]
    fn new(
        py: Python<'_>,
        data: &Data,
        options: Vec<OsString>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let opened = &data.opened;
        let analysed = carry_out(py, progress, |progress| {
            let analysed = analyze(opened, options, progress)?;
            let summary = analysed.value.summary()?;
            Ok((analysed, summary))
        });
        let (analysed, summary) = analysed?;
        Ok(Self {
            analysed: Mutex::new(analysed.value),
            messages: analysed.messages.to_string(),
            summary: summary.value,
            summary_messages: summary.messages.to_string(),
        })
    }

    /// The study, with the decisions made for this analysis.
    fn data(&self, py: Python<'_>) -> PyResult<Data> {
        let opened = self.read(py, |analysed| Ok(analysed.data().clone()))?;
        Ok(Data::new(Called {
            value: opened,
            messages: serde_json::Value::Null,
        }))
    }

    fn corrections_json(&self, py: Python<'_>) -> PyResult<String> {
        self.read(py, |analysed| Ok(analysed.corrections_json()))
    }

    fn tables<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyBytes>; 2]> {
        let tables = self.read(py, AnalysedStudy::tables)?;
        Ok(tables.map(|table| PyBytes::new(py, &table)))
    }

    fn schedule_at(
        &self,
        py: Python<'_>,
        airspeed_kt: f64,
        second: Option<f64>,
    ) -> PyResult<String> {
        self.read(py, |analysed| analysed.schedule_at(airspeed_kt, second))
    }

    fn response<'py>(
        &self,
        py: Python<'py>,
        condition: i64,
        model: String,
        is_scheduled: bool,
        omega: Vec<f64>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let choice = ModelChoice {
            condition,
            model,
            is_scheduled,
            // Any permitted order: the delays in a response are exact.
            pade: 1,
        };
        let response = self.read(py, |analysed| analysed.response(&choice, &omega))?;
        Ok(response_bytes(py, &response))
    }

    fn model_json<'py>(
        &self,
        py: Python<'py>,
        condition: i64,
        model: String,
        is_scheduled: bool,
        pade: usize,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let choice = ModelChoice {
            condition,
            model,
            is_scheduled,
            pade,
        };
        let text = self.read(py, |analysed| analysed.model_json(&choice))?;
        Ok(PyBytes::new(py, &text))
    }

    fn figure(
        &self,
        py: Python<'_>,
        options: Vec<OsString>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Figure> {
        let drawn = carry_out(py, progress, |progress| {
            self.lock().figure(options, progress)
        })?;
        Ok(Figure { drawn: drawn.value })
    }

    fn save_study(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.read(py, |analysed| analysed.data().save_study(&path))
    }

    fn write_results(&self, py: Python<'_>, folder: PathBuf, is_replaced: bool) -> PyResult<()> {
        self.read(py, |analysed| analysed.write_results(&folder, is_replaced))
    }
}
