//! Programs and tables that compute an exported correction outside of this one.

mod airspeed;
mod c_header;
mod curve;
mod export_fault;
mod matlab_function;
mod number;
mod python_module;
mod quoted;
mod scheduled_correction;
mod table_csv;
mod table_error;

pub use airspeed::CutAirspeed;
pub use c_header::c_header;
pub use curve::Curve;
pub use export_fault::ExportFault;
pub use matlab_function::matlab_function;
pub use python_module::python_module;
pub use scheduled_correction::{ScheduledChannel, ScheduledCorrection};
pub use table_csv::table_csv;
pub use table_error::TableError;
