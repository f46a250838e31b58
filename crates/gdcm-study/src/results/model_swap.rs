//! A condition's results after another model from the bundle replaces its representative (M13.1).

use std::sync::Arc;

use gdcm_method::uncertainty::scalar::Figures;
use gdcm_method::uncertainty::spread::ConditionSpread;
use gdcm_model::dataset::BundleKind;

/// A model that replaces its bundle's representative, and the resulting gains and delays.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelSwap {
    pub bundle: BundleKind,
    /// Index in the bundle.
    pub model: usize,
    /// Gains and delays after the swap; `None` where the two models could not be analysed.
    pub figures: Option<Arc<Figures>>,
}

/// A condition's results after every swap.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionSwaps {
    /// Spread in gains and delays over the swaps.
    pub spread: ConditionSpread,
    pub swaps: Vec<ModelSwap>,
}
