//! A study's corrections for other tools: programs and tables that compute them outside of this one, corrected models, and all
//! results as variables of MATLAB.

mod airspeed;
mod breakpoint_table;
mod c_header;
mod corrections_variable;
mod curve;
mod export_fault;
mod export_file;
mod exported_model;
mod expression;
mod fields;
mod found_models;
mod gather;
mod heading;
mod lookup_table;
mod matlab_function;
mod model_variables;
mod number;
mod python_module;
mod quoted;
mod scheduled_correction;
mod table_csv;
mod table_error;
mod table_mat;

pub use export_fault::ExportFault;
pub use export_file::{check_export, write_export};
pub use gather::ExportSource;
