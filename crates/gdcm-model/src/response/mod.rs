//! Frequency responses: grid, model evaluation, magnitude and phase (M2, M3); poles and zeros.
//!
//! | question | file |
//! |---|---|
//! | response of a model, of matrices or measured | `prepared_model.rs` |
//! | how matrices are evaluated | `elimination.rs`, `hessenberg_form.rs` and its steps |
//! | phase, interpolation, gain, delay and lead of curves | `phase_unwrapping.rs`, `interpolation.rs`, `gain_delay.rs` |
//! | poles, damping, participation | `mode.rs` |
//! | zeros | `zeros.rs` |

pub mod balancing;
mod complex_lanes;
pub mod connection;
mod eigenvectors;
pub mod elimination;
#[cfg(test)]
mod elimination_tests;
pub mod frequency_grid;
pub mod frequency_response;
mod gain_delay;
mod hessenberg_form;
mod householder_reduction;
pub mod interpolation;
pub mod large_entry;
pub mod lead_filter;
pub mod mode;
pub mod phase_unwrapping;
mod pivot_threshold;
pub mod polar_response;
pub mod pole_estimate;
pub mod prepared_model;
pub mod response_shape;
mod s_plane;
pub mod schur_form;
mod single_response;
pub mod zeros;

pub use elimination::evaluate;
pub use frequency_grid::FrequencyGrid;
pub use frequency_response::FrequencyResponse;
pub use gain_delay::GainDelay;
pub use lead_filter::{LeadFilter, LeadOrder};
pub use mode::{Mode, modes};
pub use phase_unwrapping::wrap;
pub use polar_response::PolarResponse;
pub use prepared_model::PreparedModel;
