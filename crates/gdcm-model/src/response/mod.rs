//! Frequency responses: the grid, the evaluation of a model on it, magnitude and phase (M2, M3); poles and zeros of a model.

mod curve_values;
mod eigenvalues;
mod elimination;
mod frequency_response;
mod hessenberg_form;
mod lead_filter;
mod pole_estimate;
mod prepared_model;
mod zeros;

pub use curve_values::*;
pub use eigenvalues::*;
pub use elimination::*;
pub use frequency_response::*;
use hessenberg_form::*;
pub use lead_filter::*;
pub use pole_estimate::*;
pub use prepared_model::*;
pub use zeros::*;
