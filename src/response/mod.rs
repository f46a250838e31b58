//! Frequency responses: the grid, the evaluation of a model on it, magnitude and phase (M2, M3).

mod aligned_numbers;
mod complex_lanes;
mod eliminated_rows;
mod frequency_grid;
mod frequency_response;
mod gain_delay;
mod hessenberg_form;
mod householder_reduction;
mod interchange;
mod interpolation;
mod lane_elimination;
mod lane_response;
mod phase;
mod polar;
mod prepared_model;
mod state_space_response;
mod statistics;
mod structure;
mod subdiagonal;
mod system_table;

pub use frequency_grid::FrequencyGrid;
pub use frequency_response::FrequencyResponse;
pub use gain_delay::GainDelay;
pub use phase::{centred_unwrap, nearest_turn_offset, unwrap, wrap};
pub use polar::{PolarCurve, PolarResponse};
pub use prepared_model::PreparedModel;
pub use state_space_response::{evaluate, evaluate_on};
pub use statistics::{mean, median, quantile};
