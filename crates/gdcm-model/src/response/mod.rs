//! Frequency responses: grid, evaluation of a model, magnitude and phase (M2, M3); poles and zeros
//! of a model.

pub mod curve_values;
pub mod eigenvalues;
pub mod elimination;
pub mod frequency_response;
mod hessenberg_form;
pub mod lead_filter;
pub mod pole_estimate;
pub mod prepared_model;
pub mod zeros;

pub use curve_values::{median, wrap};
pub use eigenvalues::{Mode, modes};
pub use elimination::evaluate;
pub use frequency_response::{FrequencyGrid, FrequencyResponse, PolarResponse};
pub use lead_filter::{GainDelay, LeadFilter, LeadOrder};
pub use prepared_model::PreparedModel;
