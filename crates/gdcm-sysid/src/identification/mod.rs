//! Identified models from flight records (M14).
mod blocks;
pub mod cautions;
pub mod diagnostics;
pub mod feedback;
#[cfg(test)]
mod fresh_flight_tests;
pub mod gaps;
pub mod identify;
mod instrument;
#[cfg(test)]
mod known_answers_tests;
mod laguerre;
mod likelihood;
pub mod local_polynomial;
mod mode_removal;
mod normal_system;
mod order;
pub mod preparation;
pub mod prepared_data;
#[cfg(test)]
mod real_flight_tests;
pub mod record_cautions;
pub mod record_contrast;
mod refinement;
mod sampling;
pub mod spectrum;
pub mod subspace;
pub mod topics;
pub mod uncertainty;

pub use cautions::{CautionNote, IdentificationCaution};
pub use identify::{Identification, IdentificationError, Options, SearchSpace};
pub use local_polynomial::{ResponseEstimate, TRUSTED_COHERENCE};
pub use preparation::{ChannelPreparation, Hold, Preparation};
pub use spectrum::spectra;

#[cfg(test)]
use gdcm_model::progress::Unobserved;
pub use gdcm_model::response::frequency_response::log_spaced;
pub use gdcm_model::response::pole_estimate::PoleEstimate;
pub use gdcm_model::simulation::{
    FirstOrderHold, FlightRecord, LowPass, Segment, Signal, Validation, ValidationError,
    ValidationSettings, ValidationWindow, validate,
};

#[cfg(test)]
use self::likelihood::{Likelihood, SpectralLines};
#[cfg(test)]
use self::refinement::{propose, refine};
