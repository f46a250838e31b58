//! Identified models from flight records (M14).
mod blocks;
mod candidate;
mod caution_subject;
mod cautions;
mod channel_check;
mod diagnostics;
mod feedback;
mod flight_record;
#[cfg(test)]
mod fresh_flight_tests;
mod identify;
mod instrument;
#[cfg(test)]
mod known_answers_tests;
mod laguerre;
mod likelihood;
mod local_polynomial;
mod modal_form;
mod mode_removal;
mod normal_system;
mod options;
mod order;
mod point_check;
mod preparation;
mod prepared_data;
#[cfg(test)]
mod real_flight_tests;
mod record_contrast;
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
    blocks::*, channel_check::*, instrument::*, laguerre::*, likelihood::*, modal_form::*, normal_system::*, order::*,
    refinement::*, sampling::*, subspace::*, triangular_factor::*,
};
pub use self::{
    candidate::*, caution_subject::*, cautions::*, diagnostics::*, feedback::*, flight_record::*, identify::*,
    local_polynomial::*, options::*, point_check::*, preparation::*, prepared_data::*, record_contrast::*,
    response_estimate::*, spectrum::*, topics::*, uncertainty::*, validation::*,
};
