//! Frequency responses: the grid, the evaluation of a model on it, magnitude and phase (M2, M3); poles and zeros of a model.

mod elimination;
mod frequency_response;
mod lead_filter;
mod phase;
mod poles;
mod prepared_model;
mod statistics;
mod zeros;

pub use elimination::*;
pub use frequency_response::*;
pub use lead_filter::*;
pub use phase::*;
pub use poles::*;
pub use prepared_model::*;
pub use statistics::*;
pub use zeros::*;
