//! Identified models from flight records (M14).
mod blocks;
mod candidate;
mod cautions;
mod diagnostics;
mod flight_record;
mod identify;
#[cfg(test)]
mod known_answers_tests;
mod laguerre;
mod likelihood;
mod local_polynomial;
mod modal_form;
mod normal_system;
mod options;
mod order;
mod preparation;
mod prepared_data;
mod refinement;
mod response_estimate;
mod sampling;
mod spectrum;
mod subspace;
mod topics;
mod triangular_factor;
mod uncertainty;
mod validation;

use crate::dataset::{ChannelSide, Pair, StateSpace};
#[cfg(test)]
use crate::progress::Unobserved;
use crate::progress::{Cancelled, Progress, Shares};
pub use crate::response::log_spaced;
use crate::response::{median, quantile};

#[cfg(test)]
use self::known_answers_tests::*;
use self::{
    blocks::*, laguerre::*, likelihood::*, modal_form::*, normal_system::*, order::*, refinement::*, sampling::*,
    subspace::*, triangular_factor::*,
};
pub use self::{
    candidate::*, cautions::*, diagnostics::*, flight_record::*, identify::*, local_polynomial::*, options::*,
    preparation::*, prepared_data::*, response_estimate::*, spectrum::*, topics::*, uncertainty::*, validation::*,
};
