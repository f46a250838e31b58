//! Figures of a condition after swapping a representative for another model of its bundle (M13.1).

use std::sync::Arc;

use gdcm_method::uncertainty::spread::{ConditionSpread, Figures};
use gdcm_model::dataset::BundleKind;

/// A model in place of its bundle's representative, with the resulting correction's figures.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelSwap {
    pub bundle: BundleKind,
    /// Index of the model in its bundle.
    pub model: usize,
    /// `None` where the pair of models could not be analysed.
    pub figures: Option<Arc<Figures>>,
}

/// Results of a condition's swaps.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionSubstitutions {
    /// Spread of the figures.
    pub spread: ConditionSpread,
    pub substitutions: Vec<ModelSwap>,
}
