//! Frequency responses: grid, evaluation of a model, magnitude and phase (M2, M3); poles and zeros
//! of a model.

mod balancing;
mod complex_lanes;
pub mod connection;
pub mod curve_values;
pub mod elimination;
pub mod frequency_response;
mod hessenberg_form;
mod householder_reduction;
pub mod large_entry;
pub mod lead_filter;
pub mod mode;
pub mod polar_response;
pub mod pole_estimate;
pub mod prepared_model;
pub mod response_shape;
mod s_plane;
pub mod schur_form;
mod single_response;
mod subdiagonal;
pub mod zeros;

pub use curve_values::wrap;
pub use elimination::evaluate;
pub use frequency_response::{FrequencyGrid, FrequencyResponse};
pub use lead_filter::{GainDelay, LeadFilter, LeadOrder};
pub use mode::{Mode, modes};
pub use polar_response::PolarResponse;
pub use prepared_model::PreparedModel;
