//! Frequency responses: the grid, the evaluation of a model on it, magnitude and phase (M2, M3); poles and zeros of a model.

mod curve_values;
mod elimination;
mod frequency_response;
mod hessenberg_form;
mod lead_filter;
mod poles;
mod prepared_model;
mod zeros;

pub use curve_values::*;
pub use elimination::*;
pub use frequency_response::*;
use hessenberg_form::*;
pub use lead_filter::*;
pub use poles::*;
pub use prepared_model::*;
pub use zeros::*;
