//! Identified models from flight records (M14).
mod blocks;
mod cautions;
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
mod validation;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use nalgebra::{Complex, DMatrix, DMatrixView, DVector, DVectorView, dmatrix};

use crate::dataset::{ChannelRemedy, ChannelSide, ModelBands, Pair, PairTable, StateSpace};
use crate::executor::{Executor, each};
#[cfg(test)]
use crate::progress::Unobserved;
use crate::progress::{Cancelled, Progress, Shares};
pub use crate::response::log_spaced;
use crate::response::{SchurForm, median, quantile};

#[cfg(test)]
use self::known_answers_tests::*;
use self::{
    blocks::*, instrument::*, laguerre::*, likelihood::*, mode_removal::*, normal_system::*, order::*, refinement::*,
    sampling::*,
};
pub use self::{
    cautions::*, diagnostics::*, feedback::*, flight_record::*, identify::*, local_polynomial::*, preparation::*,
    prepared_data::*, record_cautions::*, record_contrast::*, spectrum::*, subspace::*, topics::*, uncertainty::*,
    validation::*,
};
