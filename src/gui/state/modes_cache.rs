//! Modes and zeros in the displayed condition, cached between frames.

use std::sync::Arc;

use nalgebra::Complex;

use gdcm_method::couplings::PoleShift;
use gdcm_model::dataset::{ModelId, Pair};
use gdcm_study::jobs::curve_jobs::ConditionModes;
use gdcm_study::results::fitted_couplings::FittedCouplings;
use gdcm_words::Table;

/// Modes followed from model to model, the focused response's zeros, and pole shifts due to
/// couplings; cached until their inputs change.
#[derive(Debug, Default)]
pub struct CachedModes {
    /// Inputs from which the other fields were computed; `None` before the first computation.
    pub inputs: Option<ModesInputs>,
    /// Modes by row, models by column.
    pub table: Table,
    /// For each row, the first model whose pole is an outlier from the mode.
    pub outliers: Vec<Option<ModelId>>,
    /// The focused response's zeros, by model.
    pub zeros: Vec<(ModelId, Vec<Complex<f64>>)>,
    /// Shifts that couplings cause in the physics representative's poles.
    pub shifts: Vec<PoleShift>,
}

/// Inputs from which modes, zeros and shifts are computed.
#[derive(Debug)]
pub struct ModesInputs {
    pub modes: Arc<ConditionModes>,
    /// Index of the physics model to whose modes all other models' modes are matched.
    pub reference: usize,
    /// Couplings that shift the poles.
    pub couplings: Option<Arc<FittedCouplings>>,
    /// Response and models whose zeros are shown.
    pub zeros_of: Option<(Pair, Vec<ModelId>)>,
}
