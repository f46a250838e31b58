//! Arrays as bytes, of which NumPy makes arrays.

use gdcm::cli::calls::Responses;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Returns the complex values of responses, real part first, in the order output, input,
/// frequency.
pub(crate) fn response_bytes<'py>(py: Python<'py>, responses: &Responses) -> Bound<'py, PyBytes> {
    let mut bytes = Vec::new();
    for (_, curve) in responses.iter() {
        for value in curve {
            bytes.extend(value.re.to_ne_bytes());
            bytes.extend(value.im.to_ne_bytes());
        }
    }
    PyBytes::new(py, &bytes)
}
