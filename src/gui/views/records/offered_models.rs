//! The identified models that can replace the present models of a condition.

use gdcm_study::decisions::adopted_models::OfferedModels;

/// A choice of models, and its name in a menu.
#[derive(Clone, Copy)]
pub(super) struct Offer {
    pub(super) words: &'static str,
    pub(super) models: OfferedModels,
}

pub(super) const OFFERS: [Offer; 3] = [
    Offer {
        words: "refined models",
        models: OfferedModels::REFINED,
    },
    Offer {
        words: "refined models, and CT-PBSID (unrefined)",
        models: OfferedModels::WITH_UNREFINED,
    },
    Offer {
        words: "measured response",
        models: OfferedModels::MEASURED,
    },
];
