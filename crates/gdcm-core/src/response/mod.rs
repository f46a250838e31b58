//! Frequency responses: the grid, the evaluation of a model on it, magnitude and phase (M2, M3); poles and zeros of a model.

mod discrete_form;
mod elimination;
mod frequency_grid;
mod frequency_response;
mod gain_delay;
mod interpolation;
mod lead_filter;
mod phase;
mod polar;
mod poles;
mod prepared_model;
mod response_shape;
mod s_plane;
mod schur_form;
mod staircase;
mod statistics;
mod structure;
mod zeros;

pub use elimination::{evaluate, evaluate_on};
pub use frequency_grid::FrequencyGrid;
pub use frequency_response::FrequencyResponse;
pub use gain_delay::GainDelay;
pub use interpolation::coherence_at;
pub use lead_filter::{LeadFilter, LeadOrder};
pub use phase::{centred_unwrap, nearest_turn_offset, unwrap, wrap};
pub use polar::{PolarCurve, PolarResponse};
pub use poles::{Mode, ModesError, NearDefective, modes, modes_of};
pub use prepared_model::{LargeEntry, PreparedModel};
pub use response_shape::{ResponseShape, wrapped_deg};
pub use statistics::{mean, median, quantile, weighted_median};
pub use zeros::{TransmissionZeros, ZerosError, finite_zeros, transmission_zeros};
