//! The whole identification (M14): [`identify::identify`] runs the stages in order.
//!
//! | stage | files |
//! |---|---|
//! | records to spectra and noise (M14.1, M14.2) | `prepared_data`, `split_segments`, `measured_lines`, `data_checks`, [`spectra`](crate::spectra) |
//! | models of all orders (M14.3) | `candidates`, [`subspace`](crate::subspace) |
//! | choice of the order (M14.13) | `model_selection`, `order`, [`likelihood`](crate::likelihood) |
//! | uncertainty and doubts (M14.5, M14.10) | `assessment`, [`diagnostics`](crate::diagnostics) |

mod assessment;
pub(crate) mod candidates;
mod data_checks;
#[cfg(test)]
mod efficiency_tests;
#[cfg(test)]
mod feedback_tests;
#[cfg(test)]
mod fresh_flight_tests;
#[cfg(test)]
mod gap_tests;
#[cfg(test)]
mod helicopter_tests;
pub mod identify;
#[cfg(test)]
pub(crate) mod known_answers_tests;
#[cfg(test)]
pub(crate) mod known_flight;
#[cfg(test)]
mod long_record_tests;
mod measured_lines;
pub(crate) mod model_selection;
mod noise_weights;
pub(crate) mod order;
pub(crate) mod prepared_data;
#[cfg(test)]
pub(crate) mod real_flight_tests;
#[cfg(test)]
mod record_caution_tests;
#[cfg(test)]
mod refined_known_answers_tests;
mod search_records;
pub(crate) mod second_start;
mod split_segments;

pub use crate::diagnostics::cautions::IdentificationCaution;
pub use crate::identification_error::IdentificationError;
pub use crate::options::{Options, SearchSpace};
pub use crate::spectra::caution_note::CautionNote;
pub use crate::spectra::preparation_settings::{ChannelPreparation, Hold, Preparation};
pub use crate::spectra::response_estimate::{ResponseEstimate, TRUSTED_COHERENCE};
pub use identify::Identification;
pub use order::OrderFit;
