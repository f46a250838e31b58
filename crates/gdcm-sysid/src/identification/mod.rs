//! Identified models from flight records (M14).
mod blocks;
mod cautions;
mod diagnostics;
mod feedback;
#[cfg(test)]
mod fresh_flight_tests;
mod gaps;
mod identify;
mod instrument;
#[cfg(test)]
mod known_answers_tests;
mod laguerre;
mod likelihood;
mod local_polynomial;
mod mode_removal;
mod normal_system;
mod order;
mod preparation;
mod prepared_data;
#[cfg(test)]
mod real_flight_tests;
mod record_cautions;
mod record_contrast;
mod refinement;
mod sampling;
mod spectrum;
mod subspace;
mod topics;
mod uncertainty;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use nalgebra::{Complex, DMatrix, DMatrixView, DVector, dmatrix};

use gdcm_model::dataset::{ChannelRemedy, ChannelSide, ModelBands, Pair, PairTable, StateSpace};
use gdcm_model::executor::{Executor, each};
#[cfg(test)]
use gdcm_model::progress::Unobserved;
use gdcm_model::progress::{Cancelled, Progress, Shares};
pub use gdcm_model::response::{PoleEstimate, log_spaced};
use gdcm_model::response::{SchurForm, median, poles, quantile};
use gdcm_model::simulation::centred;
pub use gdcm_model::simulation::{
    FirstOrderHold, FlightRecord, LowPass, Segment, Signal, Validation, ValidationError,
    ValidationSettings, ValidationWindow, validate,
};

#[cfg(test)]
use self::known_answers_tests::*;
use self::{
    blocks::*, instrument::*, laguerre::*, likelihood::*, mode_removal::*, normal_system::*,
    order::*, refinement::*, sampling::*,
};
pub use self::{
    cautions::*, diagnostics::*, feedback::*, gaps::*, identify::*, local_polynomial::*,
    preparation::*, prepared_data::*, record_cautions::*, record_contrast::*, spectrum::*,
    subspace::*, topics::*, uncertainty::*,
};
