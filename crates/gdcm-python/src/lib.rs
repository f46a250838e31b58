//! Compiled part of the Python package `gdcm`: the program's calls for Python.
//!
//! The package beside it (`python/gdcm`) wraps these types; users see only the package. Results are
//! passed as text in the program's own JSON formats, in which every number is exact, responses as
//! the bytes of complex numbers. Long work releases the interpreter's lock ([`work`]).

mod analysis;
mod bytes;
mod data;
mod error;
mod figure;
mod identification;
mod work;

use std::ffi::OsString;

use pyo3::prelude::*;

use crate::analysis::Analysis;
use crate::data::Data;
use crate::figure::Figure;
use crate::identification::Identification;

/// Module `gdcm._gdcm`.
#[pymodule]
fn _gdcm(module: &Bound<'_, PyModule>) -> PyResult<()> {
    // Record the commit, so that results written through this module state it, as the program's own
    // results do.
    gdcm::version::set_commit();
    module.add("version", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<Data>()?;
    module.add_class::<Analysis>()?;
    module.add_class::<Figure>()?;
    module.add_class::<Identification>()?;
    module.add_function(wrap_pyfunction!(run, module)?)?;
    module.add_function(wrap_pyfunction!(example_records, module)?)?;
    module.add_function(wrap_pyfunction!(options, module)?)?;
    Ok(())
}

/// Runs the program with these arguments, the first being its name; returns the exit status.
#[pyfunction]
fn run(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| gdcm::run(arguments))
}

/// Returns the zip archive with the flight records of the simulated example or, if `is_real`, of
/// the real aircraft.
#[pyfunction]
fn example_records(is_real: bool) -> &'static [u8] {
    gdcm::cli::calls::example_records(is_real)
}

/// Returns the option names of the command "analyze", "figure", "identify" or "assemble"; empty for
/// any other command.
#[pyfunction]
fn options(command: &str) -> Vec<String> {
    gdcm::cli::calls::option_names_of(command)
}
