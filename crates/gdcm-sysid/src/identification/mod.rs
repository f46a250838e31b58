//! Identified models from flight records (M14).
//!
//! [`identify::identify`] runs the stages in this order:
//!
//! | stage | files |
//! |---|---|
//! | records to segments (M14.1) | [`preparation`], `clock`, `track`, [`gaps`], `channel_quality` |
//! | spectra and measured response (M14.2) | [`spectrum`], [`local_polynomial`], `instrument` |
//! | models of all orders (M14.3) | `laguerre`, `triangular_factor`, [`subspace`], `fast_modes` |
//! | cost and refinement (M14.4) | `blocks`, `likelihood`, `normal_system`, `refinement` |
//! | choice of the order (M14.13) | `search_extent`, `order`, `mode_removal`, `model_selection` |
//! | uncertainty and bundle (M14.5) | [`uncertainty`], [`feedback`], `bundle` |
//! | doubts (M14.10 to M14.18) | [`diagnostics`], [`record_contrast`], [`cautions`] |
//!
//! [`topics`] brings channels with clocks of their own to a common clock beforehand (M14.11).

mod blocks;
mod bundle;
pub mod caution_note;
pub mod cautions;
mod channel_quality;
mod clock;
pub mod cut_off;
pub mod diagnostics;
mod fast_modes;
pub mod feedback;
#[cfg(test)]
mod fresh_flight_tests;
pub mod gaps;
mod gram_matrix;
pub mod identification_error;
pub mod identify;
mod instrument;
mod interpolation;
#[cfg(test)]
mod known_answers_tests;
mod laguerre;
mod likelihood;
pub mod local_polynomial;
mod mode_removal;
mod model_selection;
pub mod noise_covariance;
mod normal_system;
pub mod options;
mod order;
pub mod preparation;
pub mod preparation_settings;
mod prepared_data;
#[cfg(test)]
mod real_flight_tests;
pub mod record_cautions;
pub mod record_contrast;
pub mod record_fault;
pub mod record_fits;
mod refinement;
pub mod response_estimate;
pub mod scales;
mod search_extent;
pub mod spectrum;
pub mod subspace;
pub mod topics;
mod track;
mod triangular_factor;
pub mod uncertainty;

pub use caution_note::CautionNote;
pub use cautions::IdentificationCaution;
pub use identification_error::IdentificationError;
pub use identify::Identification;
pub use options::{Options, SearchSpace};
pub use preparation_settings::{ChannelPreparation, Hold, Preparation};
pub use response_estimate::{ResponseEstimate, TRUSTED_COHERENCE};
pub use spectrum::spectra;

pub use gdcm_model::response::frequency_response::log_spaced;
pub use gdcm_model::response::pole_estimate::PoleEstimate;
pub use gdcm_model::simulation::{
    FirstOrderHold, FlightRecord, LowPass, Segment, Signal, Validation, ValidationError,
    ValidationSettings, ValidationWindow, validate,
};
