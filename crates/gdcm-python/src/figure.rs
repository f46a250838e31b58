//! The class `Figure`: a drawn figure.

use std::path::PathBuf;

use gdcm::cli::calls::{DrawnFigure, figure_format_named};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::exception;

/// A figure as the window draws it.
#[pyclass(frozen, module = "gdcm._gdcm")]
pub(crate) struct Figure {
    pub(crate) drawn: DrawnFigure,
}

#[pymethods]
impl Figure {
    #[getter]
    fn title(&self) -> &str {
        self.drawn.title()
    }

    /// The figure as a file's contents, in the format "svg", "png", "pdf" or "csv".
    fn bytes<'py>(&self, py: Python<'py>, format: &str) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.drawn.bytes(figure_format_named(format)));
        let bytes = bytes.map_err(|error| exception(py, &error))?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn save(&self, py: Python<'_>, path: PathBuf, is_replaced: bool) -> PyResult<()> {
        let saved = py.detach(|| self.drawn.save(&path, is_replaced));
        saved.map_err(|error| exception(py, &error))
    }
}
