//! Converts responses to bytes, from which the package makes NumPy arrays.

use gdcm::cli::calls::Responses;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Returns the complex values, real part first, in native byte order; the output index changes
/// slowest, then the input, then the frequency.
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
