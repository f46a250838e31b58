//! A condition's figures after swapping a representative for another model in its bundle (M13.1).

use std::sync::Arc;

use gdcm_method::uncertainty::spread::{ConditionSpread, Figures};
use gdcm_model::dataset::BundleKind;

/// A model in place of its bundle's representative, with the resulting correction's figures.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelSwap {
    pub bundle: BundleKind,
    /// The model's index in its bundle.
    pub model: usize,
    /// `None` where the two models could not be analysed.
    pub figures: Option<Arc<Figures>>,
}

/// A condition's swaps.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionSubstitutions {
    /// The figures' spread.
    pub spread: ConditionSpread,
    pub substitutions: Vec<ModelSwap>,
}
