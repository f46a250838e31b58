//! From flight records to spectra and the response without a model (M14.1, M14.2).
//!
//! | stage | files |
//! |---|---|
//! | records to segments (M14.1) | [`preparation`], [`preparation_settings`], `record_clock` |
//! | valid samples, and gaps (M14.1) | `valid_samples`, `frozen_outputs`, `gap_search`, [`gap`], `grid_stretches` |
//! | missing samples as unknowns (M14.21) | [`filled_segment`], [`gap_hat`] |
//! | use of each record | [`record_use`] |
//! | doubts about channels (M14.18) | [`record_cautions`], [`caution_note`], `channel_cautions`, `clipping`, `stairs`, `coarse_steps`, `spikes`, `rate_limit` |
//! | helpers of these | `finite_samples`, `fresh_samples`, `value_range`, `signal_names` |
//! | low-pass and scales (M14.1) | [`cut_off`], [`scales`] |
//! | spectra (M14.2) | [`spectrum`] |
//! | measured response (M14.2) | [`local_polynomial`], `polynomial_window`, `polynomial_regression`, [`response_estimate`], `interpolation` |
//! | response through a reference (M14.15) | `reference_response` |

pub mod caution_note;
mod channel_cautions;
pub(crate) mod clipping;
mod coarse_steps;
pub mod cut_off;
pub mod filled_segment;
mod finite_samples;
mod fresh_samples;
mod frozen_outputs;
pub mod gap;
pub mod gap_hat;
mod gap_search;
mod grid_stretches;
pub(crate) mod interpolation;
pub mod local_polynomial;
pub mod local_polynomial_error;
mod polynomial_regression;
mod polynomial_window;
pub mod preparation;
pub mod preparation_settings;
pub(crate) mod rate_limit;
pub mod record_cautions;
mod record_clock;
pub mod record_use;
pub(crate) mod reference_response;
pub mod response_estimate;
pub mod scales;
pub(crate) mod signal_names;
pub mod spectrum;
pub(crate) mod spikes;
mod stairs;
mod valid_samples;
mod value_range;
