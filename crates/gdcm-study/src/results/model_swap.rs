//! Results of a condition after a representative is replaced by another model of its bundle
//! (M13.1).

use std::sync::Arc;

use gdcm_method::uncertainty::scalar::Figures;
use gdcm_method::uncertainty::spread::ConditionSpread;
use gdcm_model::dataset::BundleKind;

/// A model that replaces the representative of its bundle, with the resulting gains and delays.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelSwap {
    pub bundle: BundleKind,
    /// Index of the replacing model in its bundle.
    pub model: usize,
    /// Gains and delays after the swap; `None` where the two models could not be analysed.
    pub figures: Option<Arc<Figures>>,
}

/// Results of a condition after every swap of a representative.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionSwaps {
    /// Spread of the gains and delays over the swaps.
    pub spread: ConditionSpread,
    pub swaps: Vec<ModelSwap>,
}
